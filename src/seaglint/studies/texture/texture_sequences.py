"""Textures fitted to recordings, endless sequences sampled from textures, and comparisons of both."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.base.schema import VARIABLES
from seaglint.base.threads import single_threaded_algebra
from seaglint.clutter.correlation import trend_surface
from seaglint.store.layout import Layout
from seaglint.store.netcdf import plain_attributes
from seaglint.store.provenance import provenance
from seaglint.store.sequence_store import check_output, write_sequence
from seaglint.store.texture_file import StoredTexture, read_texture
from seaglint.studies.study_requests import CompareRequest, FitRequest, SampleRequest
from seaglint.textures import gauss_markov_fit as estimation
from seaglint.textures.autobinomial_texture import AutobinomialTexture
from seaglint.textures.autobinomial_texture import fit_texture as fit_autobinomial
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.gaussian_texture import GaussianTexture, fit_texture
from seaglint.textures.marginals import Tails, fit_marginal
from seaglint.textures.quality import Comparison, compare
from seaglint.textures.suitability import PixelRegion, parse_region, require_stationary, require_values

if TYPE_CHECKING:
    import xarray as xr

Frames = NDArray[np.float32]
Kind = Literal["autobinomial", "gauss-markov"]

MOST_VALUES: Final = 3_000_000  #: Pixels of a sequence that a texture is fitted to: parameters are then known to a part in a thousand.

STILL: Final = 8  #: Frames from which on correlations in time are fitted.

AVERAGED: Final = 8  #: Part of a side over which the local contrast is averaged before its slow change is taken off.

NOMINAL_RATE: Final = 25.0  #: Frame rate of a sample whose data had none [Hz].

BYTES_PER_PIXEL: Final = 13  #: Memory that a sample takes at most: field, its transform and the noise.


@dataclass(frozen=True)
class HeldOut:
    """Fit of half of the data judged by the other half."""

    log_pseudo_likelihood: float | None  #: Logarithm of the fit's pseudo-likelihood per pixel of the half that the fit has not seen.
    independent_pixels: float | None  #: The same of independent pixels.
    reason: str | None = None  #: Reason of missing numbers.

    @property
    def note(self) -> str | None:
        """Return a sentence if neighbours predict no pixel of the other half.

        Examples
        --------
        >>> HeldOut(-1.1, -1.4).note is None
        True
        """
        value, alone = self.log_pseudo_likelihood, self.independent_pixels
        if value is None or alone is None or value > alone:
            return None
        return (
            "neighbours predict nothing of the half of the data that the fit has not seen (log pseudo-likelihood no larger than that of "
            "independent pixels): use samples for the measures that agree, not for predictions of single pixels"
        )


@dataclass(frozen=True)
class DataLikelihood:
    """Logarithm of the pseudo-likelihood per pixel of data under a model, with the model's file and the number of pixels."""

    log_pseudo_likelihood: float
    model: str
    pixels: int


@dataclass(frozen=True)
class Fitted:
    """A texture with the data and the samples that it was judged by."""

    stored: StoredTexture
    data: Frames
    sample: Frames
    comparison: Comparison
    gaussian: Comparison | None
    held_out: HeldOut


def frames_of(recording: Recording, region: PixelRegion, most: int = MOST_VALUES) -> Frames:
    """Return consecutive frames of a region, as many as hold ``most`` values, from the middle of the recording [u]."""
    count = max(min(recording.frames, most // region.pixels), 1)
    first = (recording.frames - count) // 2
    frames = np.ascontiguousarray(region.of(recording.read(first, first + count)), np.float32)
    if recording.offset:
        frames += np.float32(recording.offset)
    return frames


def detrended(frames: Frames) -> Frames:
    """Return frames without slow changes of mean and contrast: both have their average everywhere; NaN stay NaN."""
    from scipy.ndimage import uniform_filter

    if np.isnan(frames).any():
        return _detrended_with_gaps(frames)
    trend = trend_surface(frames.mean(axis=0, dtype=np.float64))
    # One trend for all frames, so that changes in time remain.
    remainder = frames - trend
    power = (remainder**2).mean(axis=0)
    # Logarithms of means over some pixels: a surface through powers themselves passes 0 beside a bright edge.
    local = uniform_filter(power, size=[max(n // AVERAGED, 1) for n in power.shape])
    flat = remainder / np.exp(0.5 * trend_surface(np.log(np.maximum(local, 1e-6 * power.mean())), degree=2))
    return np.asarray(trend.mean() + math.sqrt(float(power.mean())) * flat / flat.std(), np.float32)


def _detrended_with_gaps(frames: Frames) -> Frames:
    """Return ``detrended`` of the pixels that are not NaN."""
    from scipy.ndimage import uniform_filter

    exist = np.isfinite(frames)
    count = exist.sum(axis=0)
    pixels = count > 0

    def mean_in_time(values: NDArray[np.floating]) -> NDArray[np.float64]:
        return np.asarray(np.where(exist, values, 0.0).sum(axis=0, dtype=np.float64) / np.maximum(count, 1))

    trend = trend_surface(mean_in_time(frames), pixels)
    remainder = frames - trend
    power = mean_in_time(remainder**2)
    size = [max(n // AVERAGED, 1) for n in power.shape]
    # Means over the pixels near by that have a value.
    local = uniform_filter(power, size=size) / np.maximum(uniform_filter(pixels.astype(np.float64), size=size), 1e-12)
    average = float(power[pixels].mean())
    flat = remainder / np.exp(0.5 * trend_surface(np.log(np.maximum(local, 1e-6 * average)), pixels, degree=2))
    return np.asarray(float(trend[pixels].mean()) + math.sqrt(average) * flat / float(flat[exist].std()), np.float32)


@single_threaded_algebra()
def fit(recording: Recording, options: FitRequest) -> Fitted:
    """Fit a texture to a recording and judge it.

    Raises
    ------
    DataError, DomainError
        Missing or equal values, too few pixels, a picture that is not stationary, a region outside it.
    """
    region = parse_region(options.region or ":,:", recording.rows, recording.columns)
    data = frames_of(recording, region)
    # Two grey levels are enough for an autobinomial field of two levels.
    require_values(data, two=options.model == "autobinomial" and options.levels == 2)
    notes: list[str] = []
    if len(data) < recording.frames:
        notes.append(f"fitted to {len(data)} of {recording.frames} frames, from the middle")
    if options.detrend:
        data = detrended(data)
        notes.append("slow changes of mean and contrast were taken off")
    if not options.any_region:
        notes += require_stationary(data, region, detrended=options.detrend)
    if 1 < len(data) < STILL:
        notes.append(f"{len(data)} frames are too few for correlations in time (at least {STILL}): frames count as pictures of their own")
    texture: GaussianTexture | AutobinomialTexture
    if options.model == "autobinomial":
        texture, fitted, more_notes = _autobinomial(data, options)
    else:
        texture, fitted, more_notes = _gauss_markov(data, options)
    notes += more_notes
    sample = sample_like(texture, data, options.seed)
    comparison = compare(data, sample, ("data", "sample"), consecutive=len(data) >= STILL)
    plain = _plain(texture, data)
    # A Gaussian sample of the same field shows which statistics its tails and modulation add.
    gaussian = None
    if plain is not None:
        gaussian = compare(data, sample_like(plain, data, options.seed), ("data", "Gaussian sample"), consecutive=len(data) >= STILL)
    held_out = _held_out(data, options, texture)
    if held_out.note is not None:
        notes.append(held_out.note)
    quality = comparison.as_dict() | {"held_out": asdict(held_out)}
    if gaussian is not None:
        quality["gaussian_filtered_rates"] = gaussian.as_dict()["filtered_rates"]
    source = {
        "input": recording.source,
        "region": str(region),
        "frames": len(data),
        "rows": data.shape[1],
        "columns": data.shape[2],
        "units": recording.units,
        "frame_rate_hz": recording.frame_rate,
        "seed": options.seed,
    }
    return Fitted(StoredTexture(texture, source, fitted, quality, tuple(notes)), data, sample, comparison, gaussian, held_out)


def _gauss_markov(data: Frames, options: FitRequest) -> tuple[GaussianTexture, JsonObject, tuple[str, ...]]:
    result = fit_texture(data, options.tails, product=options.product, seed=options.seed)
    field = result.field
    values = {
        "standard_errors": list(field.standard_errors),
        "variance_error": field.variance_error,
        "log_likelihood": field.log_likelihood,
        "bic": field.bic,
        "pixels": field.pixels,
        "likelihood": "Whittle's, covariances corrected for the border",
        "correlation_error": result.correlation_error,
    }
    return result.texture, values, result.notes


def _autobinomial(data: Frames, options: FitRequest) -> tuple[AutobinomialTexture, JsonObject, tuple[str, ...]]:
    result = fit_autobinomial(
        data[len(data) // 2],
        options.levels,
        options.order,
        isotropic=options.isotropic,
        method=options.method,
        keep_histogram=options.keep_histogram,
        seed=options.seed,
    )
    values = {name: value for name, value in result.found.as_dict().items() if name not in ("model", "notes")}
    return result.texture, {**values, "asked": result.tried}, result.notes


def _plain(texture: GaussianTexture | AutobinomialTexture, data: Frames) -> GaussianTexture | None:
    """Return the Gaussian texture of the same neighbourhood, for comparison."""
    if not isinstance(texture, GaussianTexture) or (texture.marginal.kind == "gaussian" and texture.modulation is None):
        return None
    return _refit(texture, data, "gaussian")


def _refit(texture: GaussianTexture, data: Frames, tails: Tails) -> GaussianTexture:
    covariances = estimation.covariances(data, texture.reach)
    marginal = fit_marginal(data, tails)
    # The field has unit variance; the marginal turns the data's correlations into those of the field.
    known = replace(covariances, values=marginal.latent_correlation(covariances.values / covariances.at((0, 0, 0))), mean=0.0)
    try:
        field = estimation.fit(known, texture.field.offsets).model
    except estimation.NoOptimumError:
        field = estimation.fit(known.damped(), texture.field.offsets).model
    return GaussianTexture(field, marginal)


def _held_out(data: Frames, options: FitRequest, texture: GaussianTexture | AutobinomialTexture) -> HeldOut:
    """Return the pseudo-likelihood of the half of the data that a fit has not seen, and of independent Gaussian pixels there."""
    # Long sequences are split in time, short ones into left and right halves.
    half = len(data) // 2
    if len(data) >= 2 * STILL:
        fitted_half, other_half = data[:half], data[half:]
    else:
        middle = data.shape[2] // 2
        fitted_half, other_half = data[:, :, :middle], data[:, :, middle:]
    try:
        if isinstance(texture, GaussianTexture):
            value = _refit(texture, fitted_half, texture.marginal.kind).pseudo_log_likelihood(other_half)
            mean, variance = fitted_half.mean(), fitted_half.var()
            independent = float(-0.5 * np.log(2.0 * np.pi * variance) - 0.5 * np.mean((other_half - mean) ** 2) / variance)
        else:
            half_fit = _autobinomial(fitted_half, replace(options, method="pseudo-likelihood"))[0]
            value = half_fit.pseudo_log_likelihood(other_half)
            # A level that the half does not have would have the logarithm of 0.
            shares = np.maximum(half_fit.histogram, 0.5 / fitted_half.size)
            independent = float(np.mean(np.log(shares)[half_fit.grey.to_levels(other_half)]))
    except (DataError, ValueError) as error:
        return HeldOut(None, None, str(error))
    return HeldOut(value, independent)


def sample_like(texture: GaussianTexture | AutobinomialTexture, data: Frames, seed: int) -> Frames:
    """Return a sample of the size of the data, cut from a torus so large that opposite borders are independent."""
    frames, rows, columns = data.shape
    if isinstance(texture, AutobinomialTexture):
        return texture.sample((1, rows, columns), seed)
    far = texture.reach
    # The torus is larger than the sample, so that opposite borders of the cut sample are independent.
    deep = max(2 * frames if frames >= STILL else frames, 4 * far[0] + 1)
    wide = [max(math.ceil(1.25 * n), 4 * r + 1) for n, r in zip((rows, columns), far[1:], strict=True)]
    return np.ascontiguousarray(texture.sample((min(deep, frames + 32), *wide), seed)[:frames, :rows, :columns])


def sample(stored: StoredTexture, output: str | Path, request: SampleRequest, *, progress: Progress | None = None) -> Path | str:
    """Sample a texture and store it: rows, columns and frames are periodic, so that the sequence can be shown for ever.

    Parameters
    ----------
    stored : StoredTexture
    output : path
        Store to make, customarily ``*.zarr``.
    request : SampleRequest
        Size, number of frames and seed.
    progress : callable, optional
        Called with (frames written, frames in all).

    Raises
    ------
    DataError, DomainError, StorageError
        A size that does not fit the model, or the memory; a store that exists; no room.
    """
    check_output(output, overwrite=request.overwrite)
    field = draw(stored, request.size, request.frames, request.seed)
    layout = _layout(stored, request)
    return write_sequence(output, layout, lambda number: {"texture": field[number]}, overwrite=request.overwrite, progress=progress)


def _layout(stored: StoredTexture, request: SampleRequest) -> Layout:
    return Layout(
        azimuth_deg=np.zeros(request.size[0]),
        elevation_deg=np.zeros(request.size[1]),
        frames=range(request.frames),
        frame_rate=stored.frame_rate or NOMINAL_RATE,
        band=None,
        variables=("texture",),
        turning=True,  # the pixels of a texture have no known direction
        details={"texture": {"units": stored.units} if stored.units else {}},
        attributes=provenance(
            "Statistical texture, periodic in rows, columns and time",
            "{}",
            request.seed,
            texture_model=stored.texture.to_dict()["kind"],
            texture_source=str(stored.source.get("input", "")),
            loop_frames=request.frames,
            **({} if stored.frame_rate else {"frame_rate_note": f"the data had no frame rate; {NOMINAL_RATE:g} Hz is nominal"}),
        ),
    )


def loop(stored: StoredTexture, request: SampleRequest) -> xr.Dataset:
    """Sample a texture in memory, with the labels of a store; arguments and errors of ``sample``."""
    import xarray as xr

    size, frames = request.size, request.frames
    field = draw(stored, size, frames, request.seed)
    layout = _layout(stored, request)
    numbers = np.arange(frames)
    return xr.Dataset(
        {"texture": (("time", "y", "x"), field, {**VARIABLES["texture"].attributes, **layout.details["texture"]})},
        {"time": ("time", numbers / layout.frame_rate, VARIABLES["time"].attributes), "frame": ("time", numbers)},
        plain_attributes(layout.all_attributes),
    )


def draw(stored: StoredTexture, size: tuple[int, int], frames: int, seed: int) -> Frames:
    """Return frames of a texture on a torus [u, (frames, rows, columns)].

    Raises
    ------
    DataError
        More frames than a model without time has, fewer than its neighbours in time reach, or more pixels than memory holds.
    DomainError
        A picture too small for the neighbourhood.
    """
    columns, rows = size
    texture = stored.texture
    far = texture.reach
    if frames < 1:
        raise DataError(f"frames = {frames}: give 1 or more")
    if frames > 1 and far[0] == 0:
        kind = "an autobinomial field" if isinstance(texture, AutobinomialTexture) else f"a texture fitted to {_what(stored)}"
        raise DataError(f"frames = {frames}: {kind} has no time; give 1 frame, or fit gauss-markov to a sequence of {STILL} frames or more")
    from seaglint.studies.sequence.memory import require_room

    # A single frame of a field in time is one of a loop.
    loop_frames = frames if frames > 1 or far[0] == 0 else 4 * far[0] + 1
    needed, what = BYTES_PER_PIXEL * loop_frames * rows * columns, f"a loop of {frames} frames of {columns} x {rows} pixels"
    require_room(needed, what, "give fewer frames or a smaller size")
    return texture.sample((loop_frames, rows, columns), seed)[:frames]


def _what(stored: StoredTexture) -> str:
    frames = int(stored.source.get("frames", 1))
    return "a single picture" if frames == 1 else f"{frames} frames, in which time changes nothing"


def compare_textures(
    first: Any, second: Any, opened: Callable[[Any], Recording], request: CompareRequest
) -> tuple[Comparison, Frames, Frames, DataLikelihood | None]:
    """Compare two recordings, or a recording and a model, of which a sample as large as the recording is drawn.

    Parameters
    ----------
    first, second : object
        Recordings, or textures or their files (``.json``), at most one of them.
    opened : callable
        ``opened(first)`` is the recording.
    request : CompareRequest
        Regions, and seed of the sample.

    Returns
    -------
    comparison : Comparison
    first, second : ndarray
        Compared frames [u].
    likelihood : DataLikelihood or None
        Pseudo-likelihood of the data under the model, where one of the two is one.

    Raises
    ------
    DataError
        Two models, values that are missing, pictures that are too small.
    """
    given = (first, second)
    models = [isinstance(one, StoredTexture) or (isinstance(one, str | Path) and Path(one).suffix.lower() == ".json") for one in given]
    if all(models):
        raise DataError(f"{_name(first)}, {_name(second)}: are two models; compare each with the data, or draw samples of both")
    # Inputs without a region use the whole picture.
    regions = [*request.regions, "", ""]
    frames: list[Frames | None] = [None, None]
    names = [_name(one) for one in given]
    for i, one in enumerate(given):
        if not models[i]:
            recording = opened(one)
            names[i] = names[i] or recording.source
            frames[i] = frames_of(recording, parse_region(regions[i] or ":,:", recording.rows, recording.columns))
    likelihood = None
    for i, one in enumerate(given):
        if models[i]:
            stored, data = one if isinstance(one, StoredTexture) else read_texture(one), frames[1 - i]
            assert data is not None
            require_values(data)
            frames[i] = sample_like(stored.texture, data, request.seed)
            likelihood = DataLikelihood(stored.texture.pseudo_log_likelihood(data), names[i], int(data.size))
    data, other = frames
    assert data is not None
    assert other is not None
    # Correlations in time need consecutive frames in both.
    timed = min(len(data), len(other)) >= STILL
    if names[0] == names[1] and not _name(first):
        names = [f"first {names[0]}", f"second {names[1]}"]
    return compare(data, other, (names[0], names[1]), consecutive=timed), data, other, likelihood


def _name(given: Any) -> str:
    """Return the name of a file or a texture in results; empty for images in memory."""
    return "texture" if isinstance(given, StoredTexture) else str(given) if isinstance(given, str | Path) else ""


def latent_model(stored: StoredTexture) -> tuple[GaussMarkov, GaussianTexture]:
    """Return the Gaussian field of a texture that can be laid on the sea.

    Raises
    ------
    DataError
        An autobinomial texture.
    """
    texture = stored.texture
    if not isinstance(texture, GaussianTexture):
        raise DataError("an autobinomial texture has no Gaussian field to lay on the sea; fit one with model = 'gauss-markov'")
    return texture.field, texture
