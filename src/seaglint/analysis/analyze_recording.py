"""Analysis of a recording: clutter statistics and false-alarm rates by region.

The first pass over the file surveys its pixels in time, from which the regions are segmented. The second pass counts the exceedances of the
filter and collects values for statistics in space and time; each detector takes one more pass, and thresholds in standard deviations of the
whole sequence one before. Memory does not grow with the recording.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any, Final, Literal, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.given_regions import given_regions
from seaglint.analysis.recording import Passes, Recording, Survey, ahead, survey
from seaglint.analysis.region import FrameArray, Gatherer, Region, region
from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.base.representation import card, notes, table
from seaglint.base.threads import single_threaded_algebra
from seaglint.clutter.correlation import BoolArray
from seaglint.clutter.false_alarms import FalseAlarms, lone_lines
from seaglint.clutter.filters import Filter, Laplacian
from seaglint.clutter.segmentation import Segmentation, segment
from seaglint.clutter.thresholds import Scope, frame_scale, standardise
from seaglint.detection.interface import Detector, statistics

Prepared = TypeVar("Prepared")

ALWAYS: Final = (3.0, 3.5)  #: Thresholds that are always counted, as in the source article's Table 1 [standard deviations].

Border = Literal["auto", "keep", "drop"]

#: Names of the regions where none are given; all of them are in the results, absent ones as None.
REGIONS: Final = ("all", "glint", "background")

_HAZARD: Final = {3.0: 3.2831, 3.5: 3.7513}  #: Ratio of the density of a Gaussian to its tail.

#: Ratio of a Gaussian's tail with 12/20 of the variance to its tail with the whole variance.
_BORDER_TAIL: Final = {3.0: 0.0398, 3.5: 0.0134}

STORED_FRAMES: Final = 24  #: Largest number of frames stored for statistics in space, evenly spaced over the recording.

#: Largest number of values in the stored frames.
#:
#: Ten frames of 512 x 512 give correlation lengths to a per cent, and their transforms stay below 100 MB.
STORED_VALUES: Final = 2_500_000

SLICED_FRAMES: Final = 2000  #: Largest number of frames of which a row and a column are stored, for their picture in time.

FEWEST_PIXELS: Final = 100  #: Least number of pixels of an analysed region.

MOST_THREADS: Final = 8  #: Largest number of regions that are counted at the same time.


@dataclass(frozen=True)
class AnalysisOptions:
    """Options of an analysis.

    Raises
    ------
    DataError
        A scope or border that does not exist, or more than one of ``mask``, ``no_glint`` and ``regions``.
    """

    filter: Filter = field(default_factory=Laplacian)  #: Filter before the thresholds; the article's Laplacian by default.
    thresholds: tuple[float, ...] = ()  #: Further thresholds besides 3.0 and 3.5 [standard deviations].
    scope: Scope = "frame"  #: Standard deviation of the region in each frame, in the whole sequence, or around each pixel.
    #: Part of the rows to analyse, as shares of the height from the top; filters use the whole picture.
    rows: tuple[float, float] = (0.0, 1.0)
    mask: BoolArray | None = None  #: Glinting pixels, instead of the segmentation.
    no_glint: bool = False  #: Flag: no corridor is looked for, all pixels are the only region.
    #: Regions instead of glint and background: numbers (rows, columns), or rectangles or masks by name
    #: (``seaglint.analysis.given_regions``).
    regions: Any = None
    detectors: tuple[Detector, ...] = ()  #: Detectors whose statistics are counted like filtered frames.
    seed: int = 0  #: Seed of all random samples.
    #: Whether sigma and rates include the pixels whose filtered value depends on repeated pixels beyond the border. With "auto" they are
    #: included in a single image, as in the published figures, and not in a sequence, which is long enough to show their bias. They are
    #: dropped only if half of the pixels remain.
    border: Border = "auto"

    def __post_init__(self) -> None:
        for name, value, allowed in (("scope", self.scope, get_args(Scope)), ("border", self.border, get_args(Border))):
            if value not in allowed:
                raise DataError(f"{name} = {value!r} is not one of {', '.join(allowed)}; give one of them or leave it out")
        ways = [
            name
            for name, value in (("mask", self.mask), ("no_glint", self.no_glint or None), ("regions", self.regions))
            if value is not None
        ]
        if len(ways) > 1:
            raise DataError(f"{' and '.join(f'`{name}`' for name in ways)} exclude each other; give one of them")


@dataclass(frozen=True)
class Slices:
    """Row and column of a recording in time: raw, filtered, and above the lowest threshold [(frames, columns or rows)]."""

    row: int
    column: int
    along_row: tuple[FrameArray, FrameArray, BoolArray]
    along_column: tuple[FrameArray, FrameArray, BoolArray]


@dataclass(frozen=True)
class Analysis:
    """Results of an analysis for JSON, text, plots and report."""

    recording: Recording
    options: AnalysisOptions
    segmentation: Segmentation
    image: NDArray[np.float64]  #: Mean in time, in the recording's numbers. Shape (rows, columns).
    regions: dict[str, Region]  #: Regions that exist, by name.
    slices: Slices
    notes: tuple[str, ...]  #: Remarks on the recording.
    border_included: bool = True  #: Whether sigma and rates include pixels that depend on repeated ones beyond the border.
    given: tuple[str, ...] = ("all",)  #: Names of all pixels and of the given regions.

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the regions, also of absent ones: all pixels, then glint and background or the given ones."""
        return REGIONS if self.options.regions is None else tuple(self.given)

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text of all results; absent regions are None."""
        recording, regions = self.recording, self.regions
        return {
            "source": recording.source,
            "frames": recording.frames,
            "rows": recording.rows,
            "columns": recording.columns,
            "units": recording.units,
            "frame_rate_hz": recording.frame_rate,
            "blur_px": recording.blur_px,
            "blur": recording.blur,
            "filter": self.options.filter.name,
            "sigma_of": self.options.scope,
            "border": "kept" if self.border_included else "dropped",
            # A corridor of too few pixels is segmented but has no statistics: it counts as absent.
            "segmentation": self.segmentation.as_dict() | {"found": "glint" in regions},
            "regions": {name: regions[name].as_dict() if name in regions else None for name in self.names},
            "notes": list(self.notes),
        }

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: the regions' moments, and the notes."""
        recording = self.recording
        names = ("pixels", "mean", "std", "skewness", "excess_kurtosis", "correlation_time_s", "stationary")
        regions = {name: region.as_dict() for name, region in self.regions.items()}
        rows = [(name, *(values[key] for key in names)) for name, values in regions.items()]
        size = f"{recording.frames} frames of {recording.columns} x {recording.rows} pixels, {recording.units}"
        known = notes([f"{size}, filter {self.options.filter.name}", f"blur of the frames: {recording.blur}"])
        return card(f"Analysis of {recording.source}", known + table(("region", *names), rows) + notes(self.notes))


@single_threaded_algebra()
def analyze(recording: Recording, options: AnalysisOptions | None = None, progress: Progress = lambda done, total: None) -> Analysis:
    """Analyse a recording.

    Parameters
    ----------
    recording : Recording
        Recording from a file by ``seaglint.formats.recording.open_recording``, or a user's own.
    options : AnalysisOptions, optional
        Filter, thresholds, mask, detectors.
    progress : callable
        Called with (frames, frames of the recording): the finished share of all passes over it, as whole frames.

    Returns
    -------
    Analysis

    Raises
    ------
    DataError
        A recording without finite values, or a mask that does not fit.

    Notes
    -----
    Memory does not grow with the recording: blocks of some eight megabytes, and maps of the size of a frame.
    """
    given = options or AnalysisOptions()
    rows = _row_mask(recording, given.rows)
    if given.mask is not None and given.mask.shape != rows.shape:
        raise DataError(
            f"the mask has {given.mask.shape[0]} x {given.mask.shape[1]} pixels, the frames have {recording.rows} x {recording.columns}; "
            "give one value per pixel"
        )
    passes = Passes(progress, recording.frames, 2 + (given.scope == "sequence") + len(given.detectors))
    first = survey(recording, passes.read)
    passes.end()
    segmentation, masks, notes, names = _regions(first, recording, rows, given)
    thresholds = tuple(sorted({*ALWAYS, *given.thresholds}))
    counted, border_notes = _interior(recording, given, masks["all"])
    results, slices = _count(recording, given, first, masks, counted, thresholds, passes)
    detector_notes: list[str] = []
    for detector in given.detectors:
        detector_notes += _count_detector(recording, detector, first.dead, results, thresholds, passes)
    notes = [*recording.notes, *first.notes, *notes, *border_notes, *_line_notes(results, given.filter.name), *detector_notes]
    image = first.moments.image + recording.offset
    return Analysis(recording, given, segmentation, image, results, slices, tuple(notes), bool(counted.all()), names)


def _interior(recording: Recording, options: AnalysisOptions, used: BoolArray) -> tuple[BoolArray, list[str]]:
    """Return the pixels whose filtered values are used, and the notes about the border."""
    margin = options.filter.margin
    inner = np.zeros(used.shape, np.bool_)
    inner[margin : max(used.shape[0] - margin, 0), margin : max(used.shape[1] - margin, 0)] = True
    share = 1.0 - float((used & inner).sum()) / max(int(used.sum()), 1)
    everything = np.ones(used.shape, np.bool_)
    if margin == 0 or share == 0.0 or options.scope == "local":
        return everything, []
    # Without the border too little of the picture would be left.
    wide = share > 0.5
    if options.border == "drop" and wide:
        raise DataError(
            f"the border of {margin} px holds {100 * share:.3g} % of the pixels: too little; take a smaller filter or border = 'keep'"
        )
    if options.border == "keep" or (options.border == "auto" and (recording.frames == 1 or wide)):
        return everything, [_border_bias(options.filter, share)]
    return inner, []


def _border_bias(used: Filter, share: float) -> str:
    """Return the note on the border's pixels, with the bias of the rates of white noise where it is known."""
    where = f"{100 * share:.3g} % of the pixels lie within {used.margin} px of the border"
    text = f"{where}, where the filter sees repeated pixels; they are counted"
    if not isinstance(used, Laplacian) or share > 0.5:
        return text
    # Repeated pixels leave the Laplacian 12 instead of 20 times the input's variance: sigma is too small by 0.2 of the share, which raises
    # the rate by the hazard, and the border's own pixels hardly exceed.
    bias = [share * (0.2 * m * _HAZARD[m] - 1.0 + _BORDER_TAIL[m]) for m in ALWAYS]
    return (
        text
        + f": white noise would read {100 * bias[0]:.2g} % high at 3 sigma, {100 * bias[1]:.2g} % at 3.5 (--border drop leaves them out)"
    )


def _line_notes(results: dict[str, Region], filter_name: str) -> list[str]:
    """Return notes on rows and columns with far more exceedances than their neighbours."""
    notes = []
    for name, result in results.items():
        for what, counts in zip(("row", "column"), result.alarms[filter_name].lines(ALWAYS[0]), strict=True):
            for line in lone_lines(counts)[:3]:
                share = f"{100 * counts[line] / counts.sum():.3g} %"
                notes.append(
                    f"{name}: {share} of the exceedances of {ALWAYS[0]:g} sigma lie in {what} {line} alone, a bad line, an object or an "
                    "edge of the picture: the rates hold them, fits, correlation and effective counts leave it out; --regions leaves it "
                    "out of all"
                )
    return notes


def _row_mask(recording: Recording, shares: tuple[float, float]) -> BoolArray:
    low, high = shares
    if not 0.0 <= low < high <= 1.0:
        raise DomainError(f"rows = {low:g}:{high:g}; give shares of the height from the top, 0 <= first < last <= 1")
    mask = np.zeros((recording.rows, recording.columns), np.bool_)
    # A share of 0.7 of 10 rows is 6.9999... in floating point and means 7.
    mask[int(np.floor(low * recording.rows + 1e-9)) : max(int(np.floor(high * recording.rows + 1e-9)), 1)] = True
    return mask


def _regions(
    first: Survey, recording: Recording, rows: BoolArray, options: AnalysisOptions
) -> tuple[Segmentation, dict[str, BoolArray], list[str], tuple[str, ...]]:
    """Return the segmentation, masks by name, notes, and all names; a region that is too small has no mask and is noted."""
    good = (first.moments.count > 0) & ~first.dead & rows
    nothing = np.zeros_like(good)
    required = options.mask is not None
    notes: list[str] = []
    if options.regions is not None:
        parts, notes = given_regions(options.regions, *good.shape)
        segmentation = Segmentation(
            nothing, nothing, nothing, False, method=f"regions given: {', '.join(parts)}", reason="regions are given"
        )
        required = True
    elif options.no_glint:
        segmentation = Segmentation(nothing, nothing, nothing, False, method="no segmentation (no_glint)", reason="none was looked for")
        parts = {}
    else:
        segmentation = _segmented(first, recording, options.mask)
        parts = {"glint": segmentation.glint, "background": segmentation.background}
        if options.mask is not None and (options.mask.all() or not options.mask.any()):
            notes.append(
                f"the mask covers {'every pixel' if options.mask.all() else 'no pixel'}: there is no "
                f"{'background' if options.mask.all() else 'glint'} to compare with; give no_glint for all pixels alone"
            )
            required = False
        elif not segmentation.found:
            notes.append(f"no glint corridor found: {segmentation.reason}")
    masks = {"all": good}
    for name, part in parts.items():
        pixels = part & good
        count = int(pixels.sum())
        if count >= FEWEST_PIXELS:
            masks[name] = pixels
        elif count or required:
            notes.append(f"the {name} region has {count} pixels, too few for statistics (at least {FEWEST_PIXELS})")
    return segmentation, masks, notes, ("all", *parts)


def _segmented(first: Survey, recording: Recording, mask: BoolArray | None) -> Segmentation:
    """Return the corridor of a mask, or the one that is found in the survey's pictures."""
    if mask is not None:
        return Segmentation(mask, ~mask, np.zeros_like(mask), True, method="mask given")
    # The segmentation needs the whole picture, whatever rows are analysed: it recognises the sky at the top.
    image, std, frame = (np.where(first.dead, np.nan, layer) for layer in (first.moments.image, first.moments.std, first.frame))
    image, frame = image + recording.offset, frame + recording.offset
    radiance = bool(recording.units and recording.units.startswith("W") and "sr-1" in recording.units)
    if int(first.moments.count.max()) < 2:
        return segment(image, radiance=radiance)
    # A frame with gaps says less of the fine structure than the mean.
    return segment(image, std, frame if 2 * np.isfinite(frame).sum() > np.isfinite(image).sum() else None, radiance=radiance)


def _blocks(recording: Recording, dead: BoolArray, prepare: Callable[[FrameArray], Prepared]) -> Iterator[Prepared]:
    """Iterate over prepared blocks; dead pixels are missing in them."""

    def without_dead(block: FrameArray) -> Prepared:
        if dead.any():
            block[:, dead] = np.nan
        return prepare(block)

    return ahead(recording, without_dead)


def _filtered(recording: Recording, options: AnalysisOptions, dead: BoolArray) -> Iterator[tuple[FrameArray, FrameArray]]:
    """Iterate over blocks, raw and filtered."""
    return _blocks(recording, dead, lambda block: (block, options.filter.apply(block)))


def _count(
    recording: Recording,
    options: AnalysisOptions,
    first: Survey,
    masks: dict[str, BoolArray],
    interior: BoolArray,
    thresholds: tuple[float, ...],
    passes: Passes,
) -> tuple[dict[str, Region], Slices]:
    """Run the second pass: false alarms of the filter, and the values for statistics in space and time."""
    most = min(max(STORED_VALUES // (recording.rows * recording.columns), 4), STORED_FRAMES, recording.frames)
    stored_frames = np.unique(np.linspace(0, recording.frames - 1, most).astype(np.int64))
    stored = np.empty((stored_frames.size, recording.rows, recording.columns), np.float32)
    gatherers = {name: Gatherer(mask, recording.frames, stored_frames, options.seed, recording.offset) for name, mask in masks.items()}
    # A local standard deviation is hardly that of the counted pixels together.
    alarms = {name: FalseAlarms(thresholds, estimated=options.scope != "local") for name in masks}
    counted = {name: mask & interior for name, mask in masks.items()}
    scales = _sequence_scales(recording, options, first.dead, counted, passes) if options.scope == "sequence" else {}
    slicer = _Slicer(masks.get("glint", masks["all"]), recording)
    done = 0

    def count(name: str, block: FrameArray, filtered: FrameArray, start: int) -> None:
        z = standardise(filtered, counted[name], scope=options.scope, scale=scales.get(name))
        alarms[name].add(z)
        if name == "all":
            slicer.add(block, filtered, z)
        gatherers[name].add(block, start)

    def summarise(name: str) -> Region:
        moments, image = first.moments.region(masks[name]), first.moments.image
        bad = _bad_lines(alarms[name], masks[name])
        result = region(name, gatherers.pop(name), moments, image, stored, max(spacing, 1.0), recording.frame_rate, options.seed, bad)
        share = _saturated_share(first, masks[name])
        cut = (f"{100 * share:.3g} % saturated at {first.ceiling:.7g}",) if share > 0.0 else ()
        result = replace(result, alarms={options.filter.name: alarms[name]}, notes=(*result.notes, *cut), saturated=share)
        result.tail(options.filter.name)  # fitted here, where regions run in parallel
        return result

    # Regions are independent, and their kernels release the interpreter.
    with ThreadPoolExecutor(min(len(masks), MOST_THREADS)) as workers:
        for block, filtered in _filtered(recording, options, first.dead):
            for task in [workers.submit(count, name, block, filtered, done) for name in masks]:
                task.result()
            inside = (stored_frames >= done) & (stored_frames < done + block.shape[0])
            stored[inside] = block[stored_frames[inside] - done]
            done += block.shape[0]
            passes.read(done)
    passes.end()
    spacing = float(recording.frames - 1) / max(stored_frames.size - 1, 1)
    # Two at a time, for the sake of memory.
    with ThreadPoolExecutor(2) as workers:
        results = dict(zip(masks, workers.map(summarise, list(masks)), strict=True))
        # The accumulators store the variances behind the intervals of the rates, so that later calls are quick.
        list(workers.map(lambda accumulator: accumulator.rates(), alarms.values()))
    return results, slicer.result()


def _bad_lines(alarms: FalseAlarms, mask: BoolArray) -> BoolArray | None:
    """Return the pixels of rows and columns with far more exceedances than their neighbours.

    None without such lines, or where they hold half of the region or more.
    """
    rows, columns = (lone_lines(counts) for counts in alarms.lines(ALWAYS[0])) if alarms.pixels else (np.empty(0, np.int64),) * 2
    if not rows.size and not columns.size:
        return None
    bad = np.zeros(mask.shape, np.bool_)
    bad[rows] = True
    bad[:, columns] = True
    return bad if 2 * int((mask & ~bad).sum()) > int(mask.sum()) else None


def _saturated_share(first: Survey, mask: BoolArray) -> float:
    if first.ceiling is None:
        return 0.0
    return float(first.saturated[mask].sum()) / max(float(first.moments.count[mask].sum()), 1.0)


def _sequence_scales(
    recording: Recording, options: AnalysisOptions, dead: BoolArray, masks: dict[str, BoolArray], passes: Passes
) -> dict[str, tuple[float, float]]:
    """Return mean and deviation of the filtered sequence in each region, in a separate pass."""
    sums = {name: np.zeros(3) for name in masks}
    done = 0
    for _, filtered in _filtered(recording, options, dead):
        done += filtered.shape[0]
        passes.read(done)
        for name, mask in masks.items():
            mean, std = frame_scale(filtered, mask)
            count = np.isfinite(filtered[:, mask]).sum(axis=1)
            with np.errstate(invalid="ignore"):
                sums[name] += np.nansum([count, count * mean, count * (std**2 + mean**2)], axis=1)
    passes.end()
    scales = {}
    for name, (count, total, squares) in sums.items():
        level = float(total) / float(count) if count else 0.0
        scales[name] = (level, float(np.sqrt(max(float(squares) / float(count) - level**2 if count else 0.0, 0.0))))
    return scales


def _count_detector(
    recording: Recording, detector: Detector, dead: BoolArray, results: dict[str, Region], thresholds: tuple[float, ...], passes: Passes
) -> list[str]:
    """Run one pass of a detector through the same counting; return notes where its statistics have no usable numbers."""
    alarms = {name: FalseAlarms(thresholds, estimated=not detector.calibrated) for name in results}
    done = detector.lead
    for statistic in statistics(detector, _blocks(recording, dead, lambda block: block)):
        done += statistic.shape[0]
        passes.read(done)
        for name, result in results.items():
            # A calibrated statistic is in standard deviations already.
            z = np.where(result.mask, statistic, np.nan).astype(np.float32) if detector.calibrated else standardise(statistic, result.mask)
            alarms[name].add(z)
    passes.end()
    for name, result in results.items():
        result.alarms[detector.name] = alarms[name]
    if alarms["all"].pixels:
        return []
    return [
        f"detector {detector.name} gave no pixel with a number that varies within its frame: it must return a finite statistic where the "
        "frames it gets have values; look at what it returns for one frame"
    ]


class _Slicer:
    """Accumulator of the row and the column through the middle of a region."""

    def __init__(self, mask: BoolArray, recording: Recording) -> None:
        rows, columns = np.nonzero(mask)
        self._row = int(np.median(rows)) if rows.size else recording.rows // 2
        self._column = int(np.median(columns[rows == self._row])) if (rows == self._row).any() else recording.columns // 2
        self._parts: list[tuple[FrameArray, ...]] = []
        self._room = SLICED_FRAMES

    def add(self, block: FrameArray, filtered: FrameArray, z: FrameArray) -> None:
        """Add a block."""
        if self._room > 0:
            n = min(self._room, block.shape[0])
            cuts = (a[:n, self._row].copy() for a in (block, filtered, z)), (a[:n, :, self._column].copy() for a in (block, filtered, z))
            self._parts.append((*cuts[0], *cuts[1]))
            self._room -= n

    def result(self) -> Slices:
        """Return the joined blocks."""
        joined = [np.concatenate(parts) for parts in zip(*self._parts, strict=True)]
        along_row, along_column = ((raw, filtered, z > min(ALWAYS)) for raw, filtered, z in (joined[:3], joined[3:]))
        return Slices(self._row, self._column, along_row, along_column)
