"""Functions ``sg.texture``: statistical textures fitted to recordings, sampled, compared, and laid on the sea of a scenario."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.api.inputs_and_results import ResultRecord, path_of, recording_of, request_of, scenario_of
from seaglint.base.errors import DataError
from seaglint.base.parameters import documented
from seaglint.studies.study_requests import CompareRequest, FitRequest, PlaceRequest, ReadingRequest, SampleRequest, WeightsFile

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Recording
    from seaglint.api.inputs_and_results import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.formats.recording import RawLayout
    from seaglint.store.texture_file import StoredTexture
    from seaglint.studies.texture.texture_sequences import Fitted

    Images = xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording

__all__ = ["compare", "fit", "place", "sample"]


@dataclass(frozen=True)
class FittedTexture:
    """A texture fitted to a recording; :func:`sg.texture.fit` makes it, :func:`sg.texture.sample` and :func:`sg.texture.place` take it."""

    fitted: Fitted  #: Texture, data, and the sample that it is compared with.

    @property
    def stored(self) -> StoredTexture:
        """Return the texture with its source and quality, as its file holds it."""
        return self.fitted.stored

    def as_dict(self) -> dict[str, Any]:
        """Return the contents of the texture's file: model, source, fit and quality."""
        return dict(self.fitted.stored.to_dict())

    def save(self, output: str | Path, *, overwrite: bool = False) -> Path:
        """Write the texture's file, ``.json``."""
        from seaglint.store.outputs import refuse_existing
        from seaglint.store.texture_file import check_name, write_texture

        path = Path(output)
        refuse_existing(check_name(path), overwrite=overwrite)
        write_texture(self.fitted.stored, path, overwrite=overwrite)
        return path

    def plot(self) -> Figure:
        """Draw a frame of the data beside one of the sample, with one scale [units of the data]."""
        from seaglint.plot.texture_report import draw_pictures

        return draw_pictures(self.fitted.comparison, self.fitted.data, self.fitted.sample)

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        from seaglint.base.representation import card, notes

        stored = self.as_dict()
        facts = [f"{name}: {value}" for name, value in stored["model"].items() if isinstance(value, str | int | float)]
        return card(f"Texture of {stored['source']['input']}", notes([*facts, *self.fitted.stored.notes]))


@documented(FitRequest, ReadingRequest)
def fit(
    recording: Images,
    output: str | Path | None = None,
    *,
    model: Literal["autobinomial", "gauss-markov"] = "gauss-markov",
    tails: Literal["auto", "gaussian", "gamma", "lognormal", "k", "empirical", "noise"] = "auto",
    region: str | None = None,
    any_region: bool = False,
    detrend: bool = False,
    mask: ArrayLike | str | Path | None = None,
    keep_defects: bool = False,
    product: bool | None = None,
    order: int = 2,
    isotropic: bool = False,
    levels: int = 16,
    method: Literal["auto", "pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"] = "auto",
    keep_histogram: bool = False,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    missing: Sequence[float] = (),
    raw: RawLayout | None = None,
    seed: int = 0,
    overwrite: bool = False,
) -> FittedTexture:
    """Fit a texture to a recording and report its quality.

    Parameters
    ----------
    recording : xarray.Dataset, xarray.DataArray, ndarray, path or Recording
        Images as for :func:`sg.analyze`.
    output : path, optional
        File of the texture to write too, e.g. ``model.json``.
    {request}

    Returns
    -------
    FittedTexture
        ``as_dict()`` is what its file holds; ``save()``, ``plot()``.

    Raises
    ------
    SeaglintError
        Missing or equal values, too few pixels, a picture that is not stationary, a region outside it.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> noise = np.random.default_rng(1).normal(10.0, 0.5, (64, 64))
    >>> texture = sg.texture.fit(noise)
    >>> sg.texture.sample(texture, size=(32, 16)).texture.shape
    (1, 16, 32)
    """
    from seaglint.formats.region_files import read_mask
    from seaglint.store.outputs import refuse_existing
    from seaglint.store.texture_file import check_name
    from seaglint.studies.texture.texture_sequences import fit as fitted

    if output is not None:
        refuse_existing(check_name(Path(output)), overwrite=overwrite)
    if model == "autobinomial" and tails not in ("auto", "gaussian"):
        raise DataError(f"tails = {tails}: an autobinomial texture has the histogram of its picture; leave tails out")
    opened = recording_of(recording, request_of(ReadingRequest, locals(), missing=tuple(missing)))
    left_out = WeightsFile(Path(mask), partial(read_mask, mask)) if isinstance(mask, str | Path) else mask
    result = FittedTexture(fitted(opened, request_of(FitRequest, locals(), mask=left_out)))
    if output is not None:
        result.save(output, overwrite=overwrite)
    return result


@documented(SampleRequest)
def sample(
    model: FittedTexture | str | Path,
    output: str | Path | None = None,
    *,
    size: tuple[int, int] = (512, 512),
    frames: int = 1,
    seed: int = 0,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Draw a sample, periodic in rows, columns and time.

    Parameters
    ----------
    model : FittedTexture or path
        Result of :func:`fit`, or its file.
    output : path, optional
        Zarr store to write, and to open; without it the sample is made in memory.
    {request}
    progress : callable, optional
        Called with (frames written, frames in all).

    Returns
    -------
    xarray.Dataset
        ``texture`` over ``time, y, x`` in the units of the recording.

    Raises
    ------
    SeaglintError
        A size that does not fit the model, or the memory; a store that is there.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> noise = np.random.default_rng(1).normal(10.0, 0.5, (32, 32))
    >>> sample = sg.texture.sample(sg.texture.fit(noise), size=(32, 16))
    >>> dict(sample.texture.sizes)
    {'time': 1, 'y': 16, 'x': 32}
    """
    from seaglint.store.sequence_store import open_sequence
    from seaglint.studies.texture.texture_sequences import loop
    from seaglint.studies.texture.texture_sequences import sample as written

    request = request_of(SampleRequest, locals())
    stored = _stored(model)
    if output is None:
        return loop(stored, request)
    return open_sequence(written(stored, output, request, progress=progress))


@documented(CompareRequest, ReadingRequest)
def compare(
    first: Images,
    second: Images | FittedTexture,
    *,
    regions: Sequence[str] = (),
    detrend: bool = False,
    keep_defects: bool = False,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    missing: Sequence[float] = (),
    raw: RawLayout | None = None,
    seed: int = 0,
) -> ResultRecord:
    """Compare two textures in numbers.

    Parameters
    ----------
    first : xarray.Dataset, xarray.DataArray, ndarray, path or Recording
        The data.
    second : the same, FittedTexture, or path of a texture ``.json``
        Recording to judge, or a texture, of which a sample is drawn.
    {request}

    Returns
    -------
    ResultRecord
        Values that ``seaglint texture compare --json`` prints; ``plot()`` draws a frame of each.

    Raises
    ------
    SeaglintError
        Two models, values that are missing, pictures that are too small.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> frames = np.random.default_rng(1).normal(10.0, 0.5, (2, 4, 64, 64))
    >>> sg.texture.compare(frames[0], frames[1])["fails"]
    []
    """
    from seaglint.studies.texture.texture_sequences import compare_textures

    if len(regions) > 2:
        raise DataError(f"regions has {len(regions)} entries; give one for the first and one for the second")
    reading = request_of(ReadingRequest, locals(), missing=tuple(missing))
    judged = second.stored if isinstance(second, FittedTexture) else second
    request = request_of(CompareRequest, locals(), regions=tuple(regions), overwrite=False)
    comparison, one, other, likelihood, notes = compare_textures(first, judged, lambda given: recording_of(given, reading), request)

    def draw() -> Figure:
        from seaglint.plot.texture_report import draw_pictures

        return draw_pictures(comparison, one, other)

    values = {**comparison.as_dict(), "likelihood": None if likelihood is None else asdict(likelihood), "notes": list(notes)}
    return ResultRecord(values, draw=draw, title="comparison of textures")


@documented(PlaceRequest)
def place(
    model: FittedTexture | str | Path,
    scenario: SceneInput,
    output: str | Path,
    *,
    frames: range | None = None,
    size: tuple[int, int] = (512, 512),
    cell: tuple[float, float] | None = None,
    contrast: Literal["auto", "glint", "model"] = "auto",
    seed: int | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Lay a texture on the sea of a scenario, instead of rendering.

    Parameters
    ----------
    model : FittedTexture or path
        Gauss-Markov texture: result of :func:`fit`, or its file.
    scenario : Scenario, path or mapping
        Camera, horizon, mean and contrast.
    output : path
        Zarr store to write.
    {request}
    progress : callable, optional
        Called with (frames written, frames in all).

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1, (time, y, x)].

    Raises
    ------
    SeaglintError
        A texture without a Gaussian field, or without time for several frames; a turned or moving sensor; a store that is there.

    Examples
    --------
    >>> import numpy as np, seaglint as sg, tempfile
    >>> texture = sg.texture.fit(np.random.default_rng(1).normal(10.0, 0.5, (32, 32)))
    >>> scene = {"sensor": {"pixels": [16, 8], "frames": 1}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.texture.place(texture, scene, f"{folder}/placed.zarr").radiance.shape
    (1, 8, 16)
    """
    from seaglint.api.inputs_and_results import with_band
    from seaglint.store.sequence_store import check_output, open_sequence
    from seaglint.studies.texture.perspective import place as placed

    loaded, stored = scenario_of(scenario), _stored(model)
    check_output(output, overwrite=overwrite)
    request = request_of(PlaceRequest, locals(), frames=range(loaded.sensor.frames) if frames is None else frames)
    return with_band(open_sequence(placed(stored, loaded, output, request, progress=progress)))


def _stored(model: FittedTexture | str | Path) -> StoredTexture:
    """Return the texture of a result or of a file."""
    from seaglint.store.texture_file import read_texture

    return model.stored if isinstance(model, FittedTexture) else read_texture(path_of(model, "model"))
