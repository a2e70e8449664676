"""Detection performance by injection: frames without objects become P_d, P_fa, errors of place and the operating characteristic.

Chips are pictures of missed objects and false alarms cut out of the frames; a map has the false alarms over the field.
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
from seaglint.detection.isolated import TIME_LIMIT, ended, running
from seaglint.detection.named_detectors import named_for, require_known
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD, RARE, RareRate, RareTail
from seaglint.detection.scoring import Interval, Roc, Scores, mean_interval, roc
from seaglint.detection.sources import FrameSource, Rescaled, level_shift
from seaglint.detection.spatial import Chain, FilterThreshold
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.stepped_tails import tail_above
from seaglint.detection.trials import InjectedObjects, Trials, run_trials
from seaglint.store.detection_results import Chip, Chips, FalseAlarmMap

COVARIANCE_VALUES: Final = 4_000_000  #: Values of the frames, evenly spaced, from which covariances are estimated.

CHIPS: Final = 6  #: Pictures of each kind.

HALF: Final = 12  #: Pixels from their middle to their edge [px].


@dataclass(frozen=True)
class DetectionOptions:
    """Detector, objects and threshold of an evaluation."""

    objects: InjectedObjects  #: Injected objects.
    #: Name (``seaglint.detection.named_detectors.NAMES``), path of a function, or a detector itself.
    detector: str | Detector = "threshold"
    filter: Filter = field(default_factory=Unfiltered)  #: Filter before the detector.
    threshold: float = 4.0  #: Threshold in the unit of ``law``.
    law: Law = "sigma"  #: Law of the threshold, see ``seaglint.detection.background.Threshold``.
    level: float = 0.95  #: Confidence level of the intervals [1].
    frame_rate: float | None = None  #: Frames per second [Hz], for rates in time.
    #: Angle between rows and between columns [deg], for rates per square degree and errors in angle.
    pixel_deg: tuple[float, float] | None = None
    time_limit: float = TIME_LIMIT  #: Longest time of a call of a user's detector [s], see ``seaglint.detection.isolated.running``.
    #: Condition to stop before all objects are tried (``seaglint.detection.trials.run_trials``).
    enough: Callable[[Sequence[int]], str | None] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.level < 1:
            raise DomainError(f"level = {self.level:g} of the intervals is not between 0 and 1; choose e.g. 0.95")


@dataclass(frozen=True)
class Performance:
    """Performance of a detector, from which JSON, tables and pictures are made."""

    source: str  #: Name of the frames.
    size: tuple[int, int, int]  #: Frames, rows and columns.
    options: DetectionOptions  #: Detector, objects and threshold.
    detector: Detector  #: Detector that was evaluated.
    threshold: Threshold  #: Threshold of the results.
    background: tuple[float, float]  #: Mean and standard deviation of the statistic without objects.
    border: int  #: Width of the masked border [px].
    alarms: FalseAlarmCount  #: False alarms.
    judged: Background  #: Statistic without objects.
    trials: Trials  #: Scores of the objects.
    detections: tuple[Interval, ...]  #: P_d of each contrast with its interval.
    tail: RareTail  #: Tail of the statistic, for rare false alarms.
    notes: tuple[str, ...]  #: Remarks.

    def characteristic(self, number: int = 0) -> Roc:
        """Return the operating characteristic of one of the contrasts."""
        inflation = (self.alarms.per_pixel.inflation, self.detections[number].inflation)
        return roc(self.alarms.alarms.curve(), self.trials.scores[number], inflation, self.options.level)

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows: detection of each contrast, false alarms, and the notes."""
        return shown(self.as_dict(), self.notes)

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; unknown numbers are None."""
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
        scores, detected = self.trials.scores[k], self.detections[k]
        return {
            "contrast": scores.contrast,
            "injections": int(scores.score.size),
            "detected": int(scores.detected(self.threshold.sigma).sum()),
            "saturated": self.trials.saturated[k],
            "p_d": _plain(detected.rate),
            "p_d_interval": detected.ends,
            "p_d_inflation": _plain(detected.inflation),
            "p_d_note": detected.note,
            "pointing_error": self._pointing(scores),
        }

    def _pointing(self, scores: Scores) -> JsonObject:
        """Return errors of place of the detected objects: across rows and columns, and along and across their motion."""
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
        # Solid angle of the valid pixels of a frame.
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

        def described(rare: RareRate) -> JsonObject:
            return {
                "threshold_sigma": rare.threshold_sigma,
                "p_fa": rare.rate,
                "p_fa_interval": [rare.low, rare.high],
                "believed": rare.believed,
                "p_d": [float(s.detected(rare.threshold_sigma).mean()) for s in self.trials.scores],
            }

        rates = [rare for rare in (self.tail.threshold_for(rate) for rate in RARE) if rare is not None]
        return {
            "note": self.tail.note,
            "fitted_above_sigma": None if fit is None else fit.threshold,
            "shape": None if fit is None else fit.fit.shape,
            "shape_interval": None if fit is None else list(fit.shape_interval),
            "events": None if fit is None else fit.events,
            "extremal_index": _plain(self.tail.extremal_index),
            "at_threshold": None if at is None else described(at),
            "rare": [described(rare) for rare in rates],
        }

    def rows(self) -> list[TableRow]:
        """Return a tidy table: a row for each contrast, with every parameter."""
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


def shown(result: Mapping[str, Any], texts: Iterable[str]) -> str:
    """Return HTML of ``Performance.as_dict`` for a notebook: detection of each contrast, false alarms, and notes."""
    names = ("contrast", "injections", "detected", "p_d", "p_d_interval")
    rows = [tuple(line[name] for name in names) for line in result["sweep"]]
    facts = [
        f"detector {result['detector']}, filter {result['filter']}, threshold {result['threshold_sigma']:.4g} sigma",
        f"false alarms per pixel {as_text(result['p_fa'])} ({as_text(result['p_fa_interval'])})",
    ]
    return card(f"Detection in {result['source']}", notes(facts) + table(names, rows) + notes(texts))


def detect(
    source: FrameSource, options: DetectionOptions, *, name: str = "frames", progress: Progress | None = None, locate: bool = True
) -> Performance:
    """Evaluate a detector on frames without objects.

    Parameters
    ----------
    source : FrameSource
        Frames: a recording, or anything that reads like one.
    options : DetectionOptions
        Injected objects, the detector and its threshold.
    name : str
        Name of the source, for the results.
    progress : callable, optional
        Called with (steps done, steps in all): windows of the background, then objects.
    locate : bool
        Whether the places of detected objects are estimated, which takes two thirds of the time of the trials.

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
    total = windows + injections

    def shown(before: int) -> Progress | None:
        return None if progress is None else lambda done, _: progress(before + done, total)

    try:
        with single_threaded_algebra():
            # Objects that find no place are refused before the statistic of all frames is computed.
            options.objects.plan(detector, source) if windows else None
            background = Background(detector, source, shown(0))
            shift = level_shift(detector, source) if options.law == "fixed" else 0.0
            threshold = replace(background.threshold(options.threshold - shift, options.law), given=options.threshold)
            alarms = count_false_alarms(background, threshold, options.level)
            trials = run_trials(background, source, options.objects, threshold, report=shown(windows), enough=options.enough, locate=locate)
            curve, events = alarms.alarms.curve(), alarms.alarms.events(LOWEST_THRESHOLD)
            tail = tail_above(background, threshold.law, curve, events, seed=options.objects.seed)
    finally:
        ended(detector)
    detections = tuple(alarms.cells.detection_interval(s, options.level) for s in trials.scores)
    return Performance(
        source=name,
        size=(source.frames, source.rows, source.columns),
        options=options,
        detector=detector,
        threshold=threshold,
        background=(background.mean, background.sigma),
        border=background.border,
        alarms=alarms,
        judged=background,
        trials=trials,
        detections=detections,
        tail=tail,
        notes=tuple(_notes(detector, options, trials, alarms, detections)),
    )


def as_given(source: FrameSource, options: DetectionOptions) -> FrameSource:
    """Return the source in the file's own numbers where the detector's statistic depends on their level in an unknown way.

    A recording subtracts a level from its frames for the sake of precision (``seaglint.analysis.Recording.offset``). Fixed thresholds
    of statistics that are not linear, a user's function and the ratio of exponential clutter need the level.
    """
    given = options.detector
    needs_level = (":" in given or "exponential" in given) if isinstance(given, str) else not given.linear
    plain = isinstance(options.filter, Unfiltered)
    return Rescaled(source, level=source.offset) if source.offset and plain and needs_level else source


def detector_for(source: FrameSource, options: DetectionOptions) -> Detector:
    """Return the detector of the options, with the covariances of the source where it needs them."""

    def background() -> Frames:
        # Whole frames, as many as give that number of values, evenly spread over the source.
        most = max(int(COVARIANCE_VALUES / (source.rows * source.columns)), 1)
        chosen = np.unique(np.linspace(0, source.frames - 1, min(most, source.frames)).astype(int))
        return options.filter.apply(np.concatenate([source.read(int(k), int(k) + 1) for k in chosen]))

    detector: Detector
    if isinstance(options.detector, str) and ":" not in options.detector:
        detector = named_for(options.detector, options.objects.shape, background)
    else:
        detector = running(options.detector, options.time_limit)
    if isinstance(options.filter, Unfiltered):
        return detector
    # A filter before the plain threshold is that detector's own filter, and the result has its linearity.
    if isinstance(detector, FilterThreshold) and isinstance(detector.filter, Unfiltered):
        return FilterThreshold(options.filter)
    return Chain(options.filter, detector)


def require_detector(given: str | Detector | None, time_limit: float) -> None:
    """Check before any work that a detector is known, or that a user's can be imported.

    Raises
    ------
    SeaglintError
        It is unknown or fails.
    """
    if isinstance(given, str) and ":" not in given:
        require_known(given)
    elif given is not None:
        ended(running(given, time_limit))


def _notes(
    detector: Detector, options: DetectionOptions, trials: Trials, alarms: FalseAlarmCount, detections: tuple[Interval, ...]
) -> list[str]:
    notes = [] if trials.stopped is None else [trials.stopped]
    if detector.reach is None:
        notes.append("the detector looks at whole frames: objects injected into one frame may disturb each other")
    for contrast, number in zip(options.objects.contrasts, trials.saturated, strict=True):
        if number:
            notes.append(f"contrast {contrast:g}: {number} objects go beyond saturation and are cut there")
    for scores in trials.scores:
        if silent := int(np.isneginf(scores.score).sum()):
            notes.append(f"contrast {scores.contrast:g}: the detector returns NaN at {silent} objects; they count as missed")
    if min(options.objects.contrasts) < 0:
        notes.append("a contrast below 0 makes dark objects; thresholds are for bright ones")
    # One line for all contrasts of the same note.
    by_note: dict[str, list[str]] = {}
    for contrast, detected in zip(options.objects.contrasts, detections, strict=True):
        if detected.note:
            by_note.setdefault(detected.note, []).append(f"{contrast:.3g}")
    notes += [f"P_d of contrast {', '.join(contrasts)}: {note}" for note, contrasts in by_note.items()]
    notes += [f"P_fa: {alarms.per_pixel.note}"] if alarms.per_pixel.note else []
    return notes


def _plain(value: float) -> float | None:
    """Return a number for JSON; None for NaN and infinity."""
    return float(value) if np.isfinite(value) else None


def _ends(middle: float, half: float) -> list[float] | None:
    return [middle - half, middle + half] if np.isfinite(middle) and np.isfinite(half) else None


def chips(performance: Performance, source: FrameSource) -> Chips:
    """Return pictures of missed objects, with the object in them, and of the highest false alarms.

    The missed objects are the nearest to the threshold and the farthest from it, of the contrast that is missed most nearly half the time.
    """
    threshold = performance.threshold.sigma
    events = performance.alarms.alarms.events(threshold)
    false = []
    for k in np.argsort(-events.peak, kind="stable")[:CHIPS]:
        window = performance.judged.place.of_event(int(events.first[k]))
        frame = _last(performance, source, min(window, performance.judged.windows - 1))
        place = (int(events.row[k]), int(events.column[k]))
        false.append(Chip(float(events.peak[k]), window, *place, _cut(frame, *place)))
    rates = [float((~s.detected(threshold)).mean()) for s in performance.trials.scores]
    with_misses = [k for k, rate in enumerate(rates) if rate > 0.0]
    missed: list[Chip] = []
    contrast = None
    if with_misses:
        scores = performance.trials.scores[min(with_misses, key=lambda k: abs(rates[k] - 0.5))]
        contrast = scores.contrast
        below = np.flatnonzero(~scores.detected(threshold))
        order = below[np.argsort(-scores.score[below], kind="stable")]
        for k in [*order[: CHIPS // 2], *order[max(order.size - CHIPS // 2, CHIPS // 2) :]]:
            window, row, column = (int(v[k]) for v in (scores.window, scores.row, scores.column))
            batch = Batch(window, np.array([row]), np.array([column]), scores.offset[k : k + 1])
            frame = _with_object(performance, source, batch, contrast)
            score = float(scores.score[k])
            score = score if np.isfinite(score) else -99.0  # JSON has no infinity
            missed.append(Chip(score, window, row, column, _cut(frame, row, column)))
    return Chips(tuple(missed), tuple(false), contrast)


def characteristic(performance: Performance, contrasts: Sequence[float]) -> dict[str, list[float]]:
    """Return the operating characteristics one after the other, with the contrasts in their stated unit."""
    curves = [performance.characteristic(k) for k in range(len(contrasts))]
    out = {"contrast": np.repeat(contrasts, [c.threshold.size for c in curves]).tolist()}
    for column in ("threshold_sigma", "p_fa", "p_fa_low", "p_fa_high", "p_d", "p_d_low", "p_d_high"):
        out[column] = np.concatenate([c.columns()[column] for c in curves]).tolist()
    return out


def _last(performance: Performance, source: FrameSource, window: int) -> Frames:
    last = performance.judged.place.start(window) + performance.judged.lead
    return np.asarray(source.read(last, last + 1)[0], np.float32)


def _with_object(performance: Performance, source: FrameSource, batch: Batch, contrast: float) -> Frames:
    """Return the last frame of a window with an object as in the trials: counted by the sensor, cut at saturation."""
    frame = _last(performance, source, batch.window)
    light = np.zeros_like(frame)[None]
    objects = performance.options.objects
    inject(light, batch, objects.shape, contrast)
    if (counting := source.counting) is not None:
        last = performance.judged.place.start(batch.window) + performance.judged.lead
        light = counting.added(light, counting.draws(objects.seed, last, light.shape))
    lit: Frames = frame + light[0]
    if source.saturation is not None:
        np.minimum(lit, np.maximum(frame, np.float32(source.saturation)), out=lit)
    return lit


def _cut(frame: Frames, row: int, column: int) -> list[list[float | None]]:
    part = np.pad(frame, HALF, constant_values=np.nan)[row : row + 2 * HALF + 1, column : column + 2 * HALF + 1]
    return [[float(f"{v:.6g}") if np.isfinite(v) else None for v in line] for line in part]


def false_alarm_map(performance: Performance, azimuth_deg: FloatArray, elevation_deg: FloatArray) -> FalseAlarmMap:
    """Return false alarms and pixels of each tile of the field, with the tiles' edges as azimuth and elevation.

    The edges are in pixels where the field is no grid of azimuth and elevation.
    """
    cells = performance.alarms.cells
    sums = cells.sums[:, :2].sum(axis=0)
    rows, columns = performance.size[1:]
    edges = [np.minimum(np.arange(n + 1) * cells.tile, size) for n, size in zip(sums.shape[1:], (rows, columns), strict=True)]
    grid = azimuth_deg.ndim == 1
    axes = [_at_edges(e, values) if grid else e for e, values in zip(edges, (elevation_deg, azimuth_deg), strict=True)]
    down, right = (np.asarray(axis, float).tolist() for axis in axes)
    return FalseAlarmMap(sums[1].astype(int).tolist(), sums[0].astype(int).tolist(), down, right, grid)


def _at_edges(edges: np.ndarray, centres: FloatArray) -> FloatArray:
    """Return the angles of the edges of tiles, evenly spaced between the first and the last centre."""
    # Azimuths may pass from 360 to 0 within the field.
    unwrapped = np.unwrap(centres, period=360.0)
    return (
        np.interp(edges - 0.5, np.arange(centres.size), unwrapped)
        if centres.size < 2
        else (unwrapped[0] + (edges - 0.5) * (unwrapped[-1] - unwrapped[0]) / (centres.size - 1))
    )
