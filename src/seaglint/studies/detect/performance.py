"""Detection performance by injection: frames without objects become P_d, P_fa, errors of place and the operating characteristic.

Pictures of a judged detector: its characteristic, misses and false alarms cut out of the frames, where in the field they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject, TableRow
from seaglint.base.representation import as_text, card, notes, table
from seaglint.base.threads import single_threaded_algebra
from seaglint.clutter.filters import Filter, Unfiltered
from seaglint.clutter.thresholds import gaussian_rate
from seaglint.detection.background import Background, FalseAlarmCount, Law, Threshold, Windows, count_false_alarms
from seaglint.detection.injection import Batch, inject
from seaglint.detection.interface import Detector, Frames
from seaglint.detection.isolated import TIME_LIMIT, IsolatedDetector
from seaglint.detection.named_detectors import named_for
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD, RARE, RareRate, RareTail
from seaglint.detection.scoring import Interval, Roc, Scores, mean_interval, roc
from seaglint.detection.sources import FrameSource, Rescaled, level_shift
from seaglint.detection.spatial import Chain, FilterThreshold
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.stepped_tails import tail_above
from seaglint.detection.trials import InjectedObjects, Trials, run_trials
from seaglint.store.detection_results import Chip, Chips, FalseAlarmMap

COVARIANCE_VALUES: Final = 4_000_000  #: Values of the frames, evenly spaced, from which covariances are estimated.


@dataclass(frozen=True)
class DetectionOptions:
    """How to judge."""

    objects: InjectedObjects  #: What is injected.
    detector: str = "threshold"  #: Name (:data:`seaglint.detection.named_detectors.NAMES`), or ``package.module:function``.
    filter: Filter = field(default_factory=Unfiltered)  #: Before the detector.
    threshold: float = 4.0  #: In the unit of ``law``.
    law: Law = "sigma"  #: See :class:`seaglint.detection.background.Threshold`.
    level: float = 0.95  #: Of the intervals [1].
    frame_rate: float | None = None  #: Frames per second [Hz], for rates in time.
    #: Angle between rows and between columns [deg], for rates per square degree and errors in angle.
    pixel_deg: tuple[float, float] | None = None
    time_limit: float = TIME_LIMIT  #: Of a call of a user's detector [s].
    #: When to stop before all objects are tried (:func:`seaglint.detection.trials.run_trials`).
    enough: Callable[[Sequence[int]], str | None] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.level < 1:
            raise DomainError(f"level = {self.level:g} of the intervals is not between 0 and 1; choose e.g. 0.95")


@dataclass(frozen=True)
class Performance:
    """Everything that JSON, tables and pictures are made of."""

    source: str
    size: tuple[int, int, int]
    options: DetectionOptions
    detector: Detector
    threshold: Threshold
    background: tuple[float, float]
    border: int
    alarms: FalseAlarmCount
    judged: Background
    trials: Trials
    detections: tuple[Interval, ...]
    tail: RareTail
    notes: tuple[str, ...]

    def characteristic(self, number: int = 0) -> Roc:
        """Operating characteristic of one of the contrasts."""
        inflation = (self.alarms.per_pixel.inflation, self.detections[number].inflation)
        return roc(self.alarms.alarms.curve(), self.trials.scores[number], inflation, self.options.level)

    def _repr_html_(self) -> str:
        """What a notebook shows: detection of each contrast, false alarms, and the notes."""
        return shown(self.as_dict(), self.notes)

    def as_dict(self) -> JsonObject:
        """Plain numbers and text; what is not known is None."""
        o, fa = self.options, self.alarms.per_pixel
        sweep = [self._contrast(k) for k in range(len(self.detections))]
        first = sweep[0]
        shape = o.objects.shape
        return {
            "source": self.source,
            "frames": self.size[0],
            "rows": self.size[1],
            "columns": self.size[2],
            "detector": self.detector.name,
            "null_law": self.detector.null_law,
            "frames_needed": self.detector.lead + 1,
            "filter": o.filter.name,
            "object_sigma_px": shape.sigma if isinstance(shape, GaussianSpot) else None,
            "placement": o.objects.placement,
            "match_radius_px": o.objects.match_radius,
            "velocity_px_per_frame": list(o.objects.velocity),
            "duration_frames": o.objects.duration or None,
            "pointing": o.objects.pointing,
            "seed": o.objects.seed,
            "threshold_law": self.threshold.law,
            "threshold": self.threshold.given,
            "threshold_sigma": self.threshold.sigma,
            "border_px": self.border,
            "background_mean": self.background[0],
            "background_sigma": self.background[1],
            "level": o.level,
            **{key: first[key] for key in ("contrast", "injections", "detected", "p_d", "p_d_interval")},
            "p_fa": _plain(fa.rate),
            "p_fa_interval": fa.ends,
            "false_alarms": self._false_alarms(),
            "pointing_error": first["pointing_error"],
            "sweep": sweep,
            "tail": self._tail(),
            "notes": list(self.notes),
        }

    def _contrast(self, k: int) -> JsonObject:
        scores, found = self.trials.scores[k], self.detections[k]
        return {
            "contrast": scores.contrast,
            "injections": int(scores.score.size),
            "detected": int(scores.detected(self.threshold.sigma).sum()),
            "saturated": self.trials.saturated[k],
            "p_d": _plain(found.rate),
            "p_d_interval": found.ends,
            "p_d_inflation": _plain(found.inflation),
            "p_d_note": found.note,
            "pointing_error": self._pointing(scores),
        }

    def _pointing(self, scores: Scores) -> JsonObject:
        """Errors of place of the detected objects: across rows and columns, and along and across their motion."""
        known = scores.error[np.isfinite(scores.error).all(axis=1)]
        axes: dict[str, NDArray[np.float64]] = {"row": known[:, 0], "column": known[:, 1]}
        speed = float(np.hypot(*self.options.objects.velocity))
        if speed > 0:
            down, right = (v / speed for v in self.options.objects.velocity)
            axes |= {"along": known @ np.array([down, right]), "across": known @ np.array([-right, down])}
        pixel = self.options.pixel_deg
        out: JsonObject = {"objects": int(known.shape[0])}
        for name, values in axes.items():
            bias, deviation, half_bias, half_deviation = mean_interval(values, self.options.level)
            entry = {
                "bias_px": _plain(bias),
                "bias_interval_px": _ends(bias, half_bias),
                "std_px": _plain(deviation),
                "std_interval_px": _ends(deviation, half_deviation),
            }
            if pixel is not None and name in ("row", "column"):
                mrad = float(np.radians(pixel[name == "column"])) * 1e3
                entry |= {"bias_mrad": _plain(bias * mrad), "std_mrad": _plain(deviation * mrad)}
            out[name] = entry
        return out

    def _false_alarms(self) -> JsonObject:
        o, count = self.options, self.alarms
        windows = self.judged.windows
        events = count.alarms.events(self.threshold.sigma)
        per_frame, per_frame_events = count.cells.exceedances / windows, len(events) / windows
        area = None if o.pixel_deg is None else o.pixel_deg[0] * o.pixel_deg[1] * count.cells.pixels / windows
        rate = o.frame_rate
        gaussian = float(gaussian_rate(self.threshold.sigma))
        return {
            "pixels": count.cells.pixels,
            "exceedances": count.cells.exceedances,
            "inflation": _plain(count.per_pixel.inflation),
            "note": count.per_pixel.note,
            "gaussian": gaussian,
            "ratio_to_gaussian": _plain(count.per_pixel.rate / gaussian),
            "pixels_per_frame": per_frame,
            "events_per_frame": per_frame_events,
            "p_frame": _plain(count.per_frame.rate),
            "p_frame_interval": count.per_frame.ends,
            "pixels_per_deg2_s": None if area is None or rate is None else per_frame * rate / area,
            "events_per_deg2_s": None if area is None or rate is None else per_frame_events * rate / area,
            "events_per_hour": None if rate is None else per_frame_events * rate * 3600.0,
        }

    def _tail(self) -> JsonObject:
        fit, at = self.tail.fit, self.tail.at(self.threshold.sigma)

        def told(found: RareRate) -> JsonObject:
            return {
                "threshold_sigma": found.threshold_sigma,
                "p_fa": found.rate,
                "p_fa_interval": [found.low, found.high],
                "believed": found.believed,
                "p_d": [float(s.detected(found.threshold_sigma).mean()) for s in self.trials.scores],
            }

        rare = [found for found in (self.tail.threshold_for(rate) for rate in RARE) if found is not None]
        return {
            "note": self.tail.note,
            "fitted_above_sigma": None if fit is None else fit.threshold,
            "shape": None if fit is None else fit.fit.shape,
            "shape_interval": None if fit is None else list(fit.shape_interval),
            "events": None if fit is None else fit.events,
            "extremal_index": _plain(self.tail.extremal_index),
            "at_threshold": None if at is None else told(at),
            "rare": [told(found) for found in rare],
        }

    def rows(self) -> list[TableRow]:
        """Tidy table: a row a contrast, with every parameter."""
        whole = self.as_dict()
        parameters = (
            *("source", "frames", "rows", "columns", "detector", "filter", "object_sigma_px", "placement", "match_radius_px", "pointing"),
            *("seed", "threshold_law", "threshold", "threshold_sigma"),
        )
        out = []
        for entry in whole["sweep"]:
            row = {name: whole[name] for name in parameters}
            row |= {name: entry[name] for name in ("contrast", "injections", "detected", "saturated", "p_d")}
            for name, ends in (("p_d", entry["p_d_interval"]), ("p_fa", whole["p_fa_interval"])):
                row |= {f"{name}_low": None if ends is None else ends[0], f"{name}_high": None if ends is None else ends[1]}
            row["p_fa"] = whole["p_fa"]
            for axis in ("row", "column"):
                row |= {f"{axis}_{what}_px": entry["pointing_error"][axis][f"{what}_px"] for what in ("bias", "std")}
            out.append(row)
        return out


def shown(found: Mapping[str, Any], texts: Iterable[str]) -> str:
    """HTML of :meth:`Performance.as_dict` for a notebook: detection of each contrast, false alarms, and notes."""
    names = ("contrast", "injections", "detected", "p_d", "p_d_interval")
    rows = [tuple(line[name] for name in names) for line in found["sweep"]]
    facts = [
        f"detector {found['detector']}, filter {found['filter']}, threshold {found['threshold_sigma']:.4g} sigma",
        f"false alarms per pixel {as_text(found['p_fa'])} ({as_text(found['p_fa_interval'])})",
    ]
    return card(f"Detection in {found['source']}", notes(facts) + table(names, rows) + notes(texts))


def detect(
    source: FrameSource, options: DetectionOptions, *, name: str = "frames", progress: Progress | None = None, locate: bool = True
) -> Performance:
    """Judge a detector on frames without objects.

    Parameters
    ----------
    source : FrameSource
        Frames: a recording, or anything that reads like one.
    options : DetectionOptions
        What is injected, the detector, its threshold.
    name : str
        Of the source, for the results.
    progress : callable, optional
        Called with (steps done, steps in all): windows of the background, then objects.
    locate : bool
        Whether the places of detected objects are estimated: two thirds of the time of the trials.

    Raises
    ------
    DataError
        Frames that are too few or do not vary, a detector that fails, or no place for an object.
    DomainError
        Numbers that are not allowed.
    """
    source = as_given(source, options)
    detector = detector_for(source, options)
    windows, injections = Windows.of(source, detector.lead).count, options.objects.injections
    in_all = windows + injections

    def shown(before: int) -> Progress | None:
        return None if progress is None else lambda done, _: progress(before + done, in_all)

    try:
        with single_threaded_algebra():
            options.objects.plan(detector, source) if windows else None
            background = Background(detector, source, shown(0))
            shift = level_shift(detector, source) if options.law == "fixed" else 0.0
            threshold = replace(background.threshold(options.threshold - shift, options.law), given=options.threshold)
            alarms = count_false_alarms(background, threshold, options.level)
            trials = run_trials(background, source, options.objects, threshold, report=shown(windows), enough=options.enough, locate=locate)
            curve, events = alarms.alarms.curve(), alarms.alarms.events(LOWEST_THRESHOLD)
            tail = tail_above(background, threshold.law, curve, events, seed=options.objects.seed)
    finally:
        if isinstance(detector, IsolatedDetector):
            detector.close()
    detections = tuple(alarms.cells.detection_interval(s, options.level) for s in trials.scores)
    size = (source.frames, source.rows, source.columns)
    notes = tuple(_notes(detector, options, trials, alarms, detections))
    scale = (background.mean, background.sigma)
    return Performance(
        name, size, options, detector, threshold, scale, background.border, alarms, background, trials, detections, tail, notes
    )


def as_given(source: FrameSource, options: DetectionOptions) -> FrameSource:
    """The source in the file's own numbers where the detector's statistic depends on their level and no line tells how.

    A recording takes a level off its frames for the sake of precision (:attr:`seaglint.analysis.Recording.offset`). Fixed thresholds
    of statistics that are not linear, a user's function and the ratio of exponential clutter want it back.
    """
    wants = ":" in options.detector or "exponential" in options.detector
    plain = isinstance(options.filter, Unfiltered)
    return Rescaled(source, level=source.offset) if source.offset and plain and wants else source


def detector_for(source: FrameSource, options: DetectionOptions) -> Detector:
    """The detector of the options, with the covariances of the source where it takes them."""

    def background() -> Frames:
        most = max(int(COVARIANCE_VALUES / (source.rows * source.columns)), 1)
        chosen = np.unique(np.linspace(0, source.frames - 1, min(most, source.frames)).astype(int))
        frames = np.concatenate([source.read(int(k), int(k) + 1) for k in chosen])
        return options.filter.apply(frames)

    if ":" in options.detector:
        found: Detector = IsolatedDetector(options.detector, options.time_limit)
    else:
        found = named_for(options.detector, options.objects.shape, background)
    if isinstance(options.filter, Unfiltered):
        return found
    if isinstance(found, FilterThreshold) and isinstance(found.filter, Unfiltered):
        return FilterThreshold(options.filter)
    return Chain(options.filter, found)


def _notes(
    detector: Detector, options: DetectionOptions, trials: Trials, alarms: FalseAlarmCount, detections: tuple[Interval, ...]
) -> list[str]:
    notes = []
    if trials.stopped is not None:
        notes.append(trials.stopped)
    if detector.reach is None:
        notes.append("the detector looks at whole frames: objects injected into one frame may disturb each other")
    for contrast, number in zip(options.objects.contrasts, trials.saturated, strict=True):
        if number:
            notes.append(f"contrast {contrast:g}: {number} objects go beyond saturation and are cut there")
    for scores in trials.scores:
        silent = int(np.isneginf(scores.score).sum())
        if silent:
            notes.append(f"contrast {scores.contrast:g}: the detector returns NaN at {silent} objects; they count as missed")
    if min(options.objects.contrasts) < 0:
        notes.append("a contrast below 0 makes dark objects; thresholds are for bright ones")
    said: dict[str, list[str]] = {}
    for contrast, found in zip(options.objects.contrasts, detections, strict=True):
        if found.note:
            said.setdefault(found.note, []).append(f"{contrast:.3g}")
    notes += [f"P_d of contrast {', '.join(contrasts)}: {note}" for note, contrasts in said.items()]
    notes += [f"P_fa: {alarms.per_pixel.note}"] if alarms.per_pixel.note else []
    return notes


def _plain(value: float) -> float | None:
    """A number for JSON; None where there is none."""
    return float(value) if np.isfinite(value) else None


def _ends(middle: float, half: float) -> list[float] | None:
    return [middle - half, middle + half] if np.isfinite(middle) and np.isfinite(half) else None


CHIPS: Final = 6  #: Pictures of each kind.

HALF: Final = 12  #: Pixels from their middle to their edge [px].


def chips(found: Performance, source: FrameSource) -> Chips:
    """Pixels about missed objects, with the object in them, and about the highest false alarms.

    Missed ones are the nearest to the threshold and the farthest from it in turn, of the contrast that is missed most nearly half the time.
    """
    threshold = found.threshold.sigma
    events = found.alarms.alarms.events(threshold)
    false = []
    for k in np.argsort(-events.peak, kind="stable")[:CHIPS]:
        window = found.judged.place.of_event(int(events.first[k]))
        frame = _last(found, source, min(window, found.judged.windows - 1))
        place = (int(events.row[k]), int(events.column[k]))
        false.append(Chip(float(events.peak[k]), window, *place, _cut(frame, *place)))
    rates = [float((~s.detected(threshold)).mean()) for s in found.trials.scores]
    lost = [k for k, rate in enumerate(rates) if rate > 0.0]
    missed: list[Chip] = []
    contrast = None
    if lost:
        number = min(lost, key=lambda k: abs(rates[k] - 0.5))
        scores = found.trials.scores[number]
        contrast = scores.contrast
        below = np.flatnonzero(~scores.detected(threshold))
        order = below[np.argsort(-scores.score[below], kind="stable")]
        for k in [*order[: CHIPS // 2], *order[max(order.size - CHIPS // 2, CHIPS // 2) :]]:
            window, row, column = (int(v[k]) for v in (scores.window, scores.row, scores.column))
            batch = Batch(window, np.array([row]), np.array([column]), scores.offset[k : k + 1])
            frame = _with_object(found, source, batch, contrast)
            score = float(scores.score[k])
            score = score if np.isfinite(score) else -99.0
            missed.append(Chip(score, window, row, column, _cut(frame, row, column)))
    return Chips(tuple(missed), tuple(false), contrast)


def characteristic(found: Performance, contrasts: Sequence[float]) -> dict[str, list[float]]:
    """Operating characteristics below each other, with the contrasts as they were stated."""
    curves = [found.characteristic(k) for k in range(len(contrasts))]
    out = {"contrast": np.repeat(contrasts, [c.threshold.size for c in curves]).tolist()}
    for column in ("threshold_sigma", "p_fa", "p_fa_low", "p_fa_high", "p_d", "p_d_low", "p_d_high"):
        out[column] = np.concatenate([c.columns()[column] for c in curves]).tolist()
    return out


def _last(found: Performance, source: FrameSource, window: int) -> Frames:
    last = found.judged.place.start(window) + found.judged.lead
    return np.asarray(source.read(last, last + 1)[0], np.float32)


def _with_object(found: Performance, source: FrameSource, batch: Batch, contrast: float) -> Frames:
    """Last frame of a window with an object as it was judged: counted by the sensor, cut at saturation."""
    frame = _last(found, source, batch.window)
    light = np.zeros_like(frame)[None]
    objects = found.options.objects
    inject(light, batch, objects.shape, contrast)
    counting = source.counting
    if counting is not None:
        last = found.judged.place.start(batch.window) + found.judged.lead
        light = counting.added(light, counting.draws(objects.seed, last, light.shape))
    lit: Frames = frame + light[0]
    if source.saturation is not None:
        np.minimum(lit, np.maximum(frame, np.float32(source.saturation)), out=lit)
    return lit


def _cut(frame: Frames, row: int, column: int) -> list[list[float | None]]:
    padded = np.pad(frame, HALF, constant_values=np.nan)
    part = padded[row : row + 2 * HALF + 1, column : column + 2 * HALF + 1]
    return [[float(f"{v:.6g}") if np.isfinite(v) else None for v in line] for line in part]


def false_alarm_map(found: Performance, azimuth_deg: FloatArray, elevation_deg: FloatArray) -> FalseAlarmMap:
    """False alarms and pixels of each tile of the field, with the tiles' edges as azimuth and elevation; in pixels where the field is no
    grid of them.
    """
    cells = found.alarms.cells
    sums = cells.sums[:, :2].sum(axis=0)
    rows, columns = found.size[1:]
    edges = [np.minimum(np.arange(n + 1) * cells.tile, size) for n, size in zip(sums.shape[1:], (rows, columns), strict=True)]
    grid = azimuth_deg.ndim == 1
    axes = [_at_edges(e, values) if grid else e for e, values in zip(edges, (elevation_deg, azimuth_deg), strict=True)]
    down, right = (np.asarray(axis, float).tolist() for axis in axes)
    return FalseAlarmMap(sums[1].astype(int).tolist(), sums[0].astype(int).tolist(), down, right, grid)


def _at_edges(edges: np.ndarray, centres: FloatArray) -> FloatArray:
    """Angles of the edges of pixels."""
    unwrapped = np.unwrap(centres, period=360.0)
    return (
        np.interp(edges - 0.5, np.arange(centres.size), unwrapped)
        if centres.size < 2
        else (unwrapped[0] + (edges - 0.5) * (unwrapped[-1] - unwrapped[0]) / (centres.size - 1))
    )
