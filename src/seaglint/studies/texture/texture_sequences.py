"""Textures fitted to recordings, endless sequences sampled from textures, and comparisons of both."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, DomainError
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
from seaglint.studies.texture.counted_pixels import counted_pixels, like
from seaglint.textures.autobinomial_texture import AutobinomialTexture
from seaglint.textures.autobinomial_texture import fit_texture as fit_autobinomial
from seaglint.textures.gauss_markov import GaussMarkov, Offset
from seaglint.textures.gauss_markov_fit import NoOptimumError
from seaglint.textures.gaussian_texture import FieldsOf, GaussianTexture, TextureLaw
from seaglint.textures.law_choice import UNJUDGED, JudgedLaw, candidates, choose_law, halves, judge_laws, reasons
from seaglint.textures.prediction import predict
from seaglint.textures.quality import Comparison, compare
from seaglint.textures.suitability import SMALLEST_SIDE, PixelRegion, parse_region, require_stationary, require_values, whole_region

if TYPE_CHECKING:
    import xarray as xr

Frames = NDArray[np.float32]
Kind = Literal["autobinomial", "gauss-markov"]

MOST_VALUES: Final = 3_000_000  #: Pixels of a sequence that a texture is fitted to: parameters are then known to a part in a thousand.

FEWEST_JUDGED: Final = 2000  #: Least number of pixels of a half by which laws are judged: some three exceedances of 3 sigma.

STILL: Final = 8  #: Frames from which on correlations in time are fitted.

NOMINAL_RATE: Final = 25.0  #: Frame rate of a sample whose data had none [Hz].

BYTES_PER_PIXEL: Final = 13  #: Memory that a sample takes at most: field, its transform and the noise.


@dataclass(frozen=True)
class HeldOut:
    """Fit of half of the data judged by the other half."""

    log_pseudo_likelihood: float | None  #: Logarithm of the fit's pseudo-likelihood per pixel of the half that the fit has not seen.
    independent_pixels: float | None  #: The same of independent pixels.
    reason: str | None = None  #: Reason of missing numbers.
    gain: float | None = None  #: Log pseudo-likelihood less that of independent pixels of the fitted distribution [nat per pixel].
    outside: float | None = None  #: Share of the other half's pixels that the fitted distribution excludes [1].
    step: float | None = None  #: Step of whole-numbered data, whose probability is evaluated [u]; None for continuous ones.

    @property
    def note(self) -> str | None:
        """Return a sentence if neighbours predict no pixel of the other half.

        Examples
        --------
        >>> HeldOut(-1.1, -1.4).note is None
        True
        """
        value, alone = self.log_pseudo_likelihood, self.independent_pixels
        if value is None or alone is None or (value > alone if self.gain is None else self.gain > 0.0):
            return None
        return (
            "neighbours predict nothing of the half of the data that the fit has not seen (log pseudo-likelihood no larger than that of "
            "independent pixels): use samples for the measures that agree, not for predictions of single pixels"
        )


@dataclass(frozen=True)
class DataLikelihood:
    """Logarithm of the pseudo-likelihood per pixel of data under a model, with the model's file and the number of pixels."""

    log_pseudo_likelihood: float | None  #: [nat, of values in u]; None with a reason.
    model: str
    pixels: int
    gain: float | None = None  #: The same less that of independent pixels of the model's distribution [nat].
    outside: float | None = None  #: Share of the pixels that the model's distribution excludes [1].
    reason: str | None = None  #: Reason of a missing number.


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
    """Return frames without slow changes of the mean, which has its average everywhere; NaN stay NaN.

    Slow changes of contrast remain: they belong to the texture, as its slow scale.
    """
    exist = np.isfinite(frames)
    count = exist.sum(axis=0)
    mean = np.where(exist, frames, 0.0).sum(axis=0, dtype=np.float64) / np.maximum(count, 1)
    # One trend for all frames, so that changes in time remain.
    trend = trend_surface(mean, count > 0)
    return np.asarray(frames - trend + float(trend[count > 0].mean()), np.float32)


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
    two = options.model == "autobinomial" and options.levels == 2
    require_values(np.where(np.isfinite(data), data, np.float32(np.nan)), two=two)
    counted = counted_pixels(data, recording, region, keep_defects=options.keep_defects, mask=options.mask)
    data = counted.frames
    require_values(data, two=two)
    notes = list(counted.notes)
    if len(data) < recording.frames:
        notes.append(f"fitted to {len(data)} of {recording.frames} frames, from the middle")
    if options.detrend:
        data = detrended(data)
        notes.append("slow changes of the mean were taken off")
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
    comparison = compare(data, like(sample, data), ("data", "sample"), consecutive=len(data) >= STILL)
    plain = _plain(texture, data)
    # A Gaussian sample of the same field shows which statistics its tails and modulation add.
    gaussian = None
    if plain is not None:
        drawn = like(sample_like(plain, data, options.seed), data)
        gaussian = compare(data, drawn, ("data", "Gaussian sample"), consecutive=len(data) >= STILL)
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
    # A model of the whole picture as it was recorded has neither key.
    if counted.counts:
        source["left_out"] = counted.counts
    if options.detrend:
        source["detrended"] = True
    return Fitted(StoredTexture(texture, source, fitted, quality, tuple(notes)), data, sample, comparison, gaussian, held_out)


def _gauss_markov(data: Frames, options: FitRequest) -> tuple[GaussianTexture, JsonObject, tuple[str, ...]]:
    """Fit the law that agrees best with the rates of halves that its fit has not seen."""
    fields = FieldsOf(data)
    laws = candidates(options.tails, options.product)
    parts = halves(data)
    if parts is not None and min(np.count_nonzero(np.isfinite(part)) for part in parts) < FEWEST_JUDGED:
        parts = None
    judged: list[JudgedLaw] = []
    notes: tuple[str, ...] = ()
    if parts is None:
        law = laws[0] if len(laws) == 1 else UNJUDGED
        notes = (f"{_size(data)} has too few pixels that count for two halves: no law could be judged, {law.name} fitted",)
    else:
        offsets = _offsets(fields, laws)
        judged = judge_laws(parts, laws, offsets, options.seed)
        chosen = choose_law(judged)
        law, notes = chosen.law, reasons(chosen, judged)
    result = fields.fit(law)
    field = result.field
    values = {
        "law": result.texture.law.name,
        "laws": [one.as_dict() for one in judged],
        "standard_errors": list(field.standard_errors),
        "variance_error": field.variance_error,
        "log_likelihood": field.log_likelihood,
        "bic": field.bic,
        "pixels": field.pixels,
        "likelihood": "Whittle's, covariances corrected for the border",
        "correlation_error": result.correlation_error,
    }
    return result.texture, values, (*notes, *result.notes)


def _offsets(fields: FieldsOf, laws: Sequence[TextureLaw]) -> tuple[Offset, ...]:
    """Return the neighbours that the first law with a field needs: of the Gaussian one where it exists."""
    for law in (TextureLaw("gaussian"), *laws[:-1]):
        try:
            return fields.fit(law).texture.field.offsets
        except NoOptimumError:
            continue
    return fields.fit(laws[-1]).texture.field.offsets


def _size(data: Frames) -> str:
    return f"a region of {data.shape[1]} x {data.shape[2]} pixels"


def _autobinomial(data: Frames, options: FitRequest) -> tuple[AutobinomialTexture, JsonObject, tuple[str, ...]]:
    image, notes = _whole(data[len(data) // 2][None])
    result = fit_autobinomial(
        image[0],
        options.levels,
        options.order,
        isotropic=options.isotropic,
        method=options.method,
        keep_histogram=options.keep_histogram,
        seed=options.seed,
    )
    values = {name: value for name, value in result.found.as_dict().items() if name not in ("model", "notes")}
    return result.texture, {**values, "asked": result.tried}, (*notes, *result.notes)


def _whole(frames: Frames) -> tuple[Frames, tuple[str, ...]]:
    """Return the largest part of frames without a gap, for fields of grey levels, and a note on it."""
    if not np.isnan(frames).any():
        return frames, ()
    region = whole_region(frames)
    if region is None or min(region.bottom - region.top, region.right - region.left) < SMALLEST_SIDE:
        raise DataError(
            f"an autobinomial field needs {SMALLEST_SIDE} x {SMALLEST_SIDE} pixels without a gap, and pixels that are left out divide the "
            "picture into smaller parts; choose another region, or fit gauss-markov"
        )
    note = f"an autobinomial field has no gaps: rows and columns {region} of the region, the largest part without one, were used"
    return np.asarray(region.of(frames), np.float32), (note,)


def _plain(texture: GaussianTexture | AutobinomialTexture, data: Frames) -> GaussianTexture | None:
    """Return the Gaussian texture of the same neighbourhood, for comparison."""
    if not isinstance(texture, GaussianTexture) or texture.law == TextureLaw("gaussian"):
        return None
    try:
        return FieldsOf(data, offsets=texture.field.offsets).fit(TextureLaw("gaussian")).texture
    except NoOptimumError:
        # The neighbours of the values' field need not have the covariances of the values.
        return None


def _held_out(data: Frames, options: FitRequest, texture: GaussianTexture | AutobinomialTexture) -> HeldOut:
    """Return the pseudo-likelihood of the half of the data that a fit has not seen, and of independent Gaussian pixels there."""
    parts = halves(data)
    if parts is None:
        return HeldOut(None, None, f"{_size(data)} is too small for two halves")
    fitted_half, other_half = parts
    try:
        if isinstance(texture, GaussianTexture):
            found = predict(FieldsOf(fitted_half, offsets=texture.field.offsets).fit(TextureLaw(texture.law.values)).texture, other_half)
            if found.log_pseudo_likelihood is None:
                return HeldOut(None, None, found.reason, None, found.outside, found.step)
            known, other = (half if np.isfinite(half).all() else half[np.isfinite(half)] for half in (fitted_half, other_half))
            mean, variance = known.mean(), known.var()
            independent = float(-0.5 * np.log(2.0 * np.pi * variance) - 0.5 * np.mean((other - mean) ** 2) / variance)
            return HeldOut(found.log_pseudo_likelihood, independent, None, found.gain, found.outside, found.step)
        half_fit = _autobinomial(fitted_half, replace(options, method="pseudo-likelihood"))[0]
        other_half = _whole(other_half)[0]
        value = half_fit.pseudo_log_likelihood(other_half)
        # A level that the half does not have would have the logarithm of 0.
        shares = np.maximum(half_fit.histogram, 0.5 / fitted_half.size)
        independent = float(np.mean(np.log(shares)[half_fit.grey.to_levels(other_half)]))
    except (DataError, ValueError) as error:
        return HeldOut(None, None, str(error))
    return HeldOut(value, independent, None, value - independent)


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


#: Note of files from before the key ``detrended``, whose data were also divided by their slow contrast.
OLDER_NOTE: Final = "slow changes of mean and contrast were taken off"


class ComparedTextures(NamedTuple):
    """Comparison of two textures."""

    comparison: Comparison  #: Measures of both.
    first: Frames  #: Compared frames of the first [u]; NaN where a pixel does not count.
    second: Frames  #: Compared frames of the second [u].
    likelihood: DataLikelihood | None  #: Pseudo-likelihood of the data under the model, where one of the two is one.
    notes: tuple[str, ...]  #: Sentences on pixels that are left out and slow changes that are taken off.


def compare_textures(first: Any, second: Any, opened: Callable[[Any], Recording], request: CompareRequest) -> ComparedTextures:
    """Compare two recordings, or a recording and a model, of which a sample as large as the recording is drawn.

    Parameters
    ----------
    first, second : object
        Recordings, or textures or their files (``.json``), at most one of them.
    opened : callable
        ``opened(first)`` is the recording.
    request : CompareRequest
        Regions, treatment of both, and seed of the sample.

    Returns
    -------
    ComparedTextures
        Both are treated alike: the same search for pixels that are no sea, slow changes taken off both or neither. A sample has the
        gaps of the data.

    Raises
    ------
    DataError
        Two models, more than half of a picture missing, pictures that are too small.
    """
    given = (first, second)
    models = [isinstance(one, StoredTexture) or (isinstance(one, str | Path) and Path(one).suffix.lower() == ".json") for one in given]
    if all(models):
        raise DataError(f"{_name(first)}, {_name(second)}: are two models; compare each with the data, or draw samples of both")
    # Inputs without a region use the whole picture.
    regions = [*request.regions, "", ""]
    frames: list[Frames | None] = [None, None]
    names = [_name(one) for one in given]
    notes: list[str] = []
    # A field of two grey levels has data of two values.
    textures = [(one if isinstance(one, StoredTexture) else read_texture(one)) if models[i] else None for i, one in enumerate(given)]
    detrend = request.detrend
    for i, stored in enumerate(textures):
        if stored is not None and "mask" in stored.source.get("left_out", {}):
            notes.append(f"{names[i]} was fitted with a mask, which is not used here: set the masked pixels to NaN, or select a region")
        if stored is not None and _was_detrended(stored) and not detrend:
            detrend = True
            notes.append(f"slow changes of the mean are taken off both: {names[i]} was fitted to data without them")
            if OLDER_NOTE in stored.notes:
                notes.append(f"{names[i]} was fitted to data without slow changes of contrast, which remain in the data: fit it anew")
    if request.detrend:
        notes.append("slow changes of the mean were taken off both")
    for i, one in enumerate(given):
        if not models[i]:
            recording = opened(one)
            names[i] = names[i] or recording.source
            frames[i], left_out = _compared(recording, regions[i], request, names[i], detrend=detrend)
            notes += [f"{names[i]}: {note}" for note in left_out]
    likelihood = None
    for i, stored in enumerate(textures):
        if stored is not None:
            data = frames[1 - i]
            assert data is not None
            drawn = like(sample_like(stored.texture, data, request.seed), data)
            frames[i] = detrended(drawn) if detrend else drawn
            likelihood = _data_likelihood(stored, data, names[i])
    data, other = frames
    assert data is not None
    assert other is not None
    # Correlations in time need consecutive frames in both.
    timed = min(len(data), len(other)) >= STILL
    if names[0] == names[1] and not _name(first):
        names = [f"first {names[0]}", f"second {names[1]}"]
    return ComparedTextures(compare(data, other, (names[0], names[1]), consecutive=timed), data, other, likelihood, tuple(notes))


def _was_detrended(stored: StoredTexture) -> bool:
    return bool(stored.source.get("detrended")) or OLDER_NOTE in stored.notes


def _compared(recording: Recording, region: str, request: CompareRequest, name: str, *, detrend: bool) -> tuple[Frames, tuple[str, ...]]:
    """Return the frames of a recording that are compared, and notes on the pixels that are left out."""
    inside = parse_region(region or ":,:", recording.rows, recording.columns)
    data = frames_of(recording, inside)
    try:
        require_values(np.where(np.isfinite(data), data, np.float32(np.nan)), two=True)
        counted = counted_pixels(data, recording, inside, keep_defects=request.keep_defects)
        require_values(counted.frames, two=True)
    except DataError as error:
        raise DataError(f"{name}: {error}") from error
    return detrended(counted.frames) if detrend else counted.frames, counted.notes


def _data_likelihood(stored: StoredTexture, data: Frames, name: str) -> DataLikelihood:
    """Return the pseudo-likelihood of data under a texture, or the reason why there is none."""
    texture, pixels = stored.texture, int(np.count_nonzero(np.isfinite(data)))
    try:
        if isinstance(texture, AutobinomialTexture):
            return DataLikelihood(texture.pseudo_log_likelihood(_whole(data)[0]), name, pixels)
        found = predict(texture, data)
    except (DataError, DomainError) as error:
        return DataLikelihood(None, name, pixels, reason=str(error))
    return DataLikelihood(found.log_pseudo_likelihood, name, pixels, found.gain, found.outside, found.reason)


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
