"""Detection in one rendered scene: seas until the requested precision or the time is reached, injected objects and the detector."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from seaglint.base.conventions import Progress
from seaglint.base.errors import SeaglintError
from seaglint.cluster import Workers
from seaglint.detection.interface import Detector
from seaglint.detection.isolated import IsolatedDetector, ended
from seaglint.detection.named_detectors import named_for
from seaglint.detection.sources import Rescaled
from seaglint.detection.spot import GaussianSpot, SpotShape
from seaglint.scenario.model import Scenario
from seaglint.store.detection_results import DetectorResult, StudyParts
from seaglint.studies.detect.designer import design
from seaglint.studies.detect.injected import SWEEP, Strength, object_signal, point_shape
from seaglint.studies.detect.performance import Performance, characteristic, chips, detect, detector_for, false_alarm_map
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames, frames_key

if TYPE_CHECKING:
    from seaglint.studies.detect.detection_requests import SceneRequest

FIRST_SEAS: Final = 8  #: Seas before the precision is looked at for the first time; twice as many each time after it.

Reason = Literal["precision", "time budget", "frames"]


@dataclass
class Clock:
    """Time limit of a case."""

    budget: float | None  #: Longest time [s]; None without a limit.
    now: Callable[[], float] = time.monotonic

    def __post_init__(self) -> None:
        self.begin = self.now()

    @property
    def over(self) -> bool:
        """Return whether the time of the case is used up."""
        return self.budget is not None and self.now() - self.begin >= self.budget


def lead_of(detector: str | Detector, time_limit: float, shape: SpotShape) -> int:
    """Return the number of earlier frames that a detector needs [frames]; a path of a user's detector is imported for it."""
    if not isinstance(detector, str):
        return detector.lead
    if ":" in detector:
        isolated = IsolatedDetector(detector, time_limit)
        isolated.close()
        return int(isolated.lead)
    # Any noise will do for the covariances: the number of frames does not depend on them.
    noise = np.random.default_rng(0).standard_normal((1, 64, 64)).astype(np.float32)
    return named_for(detector, shape, lambda: noise).lead


def injected(scenario: Scenario, request: SceneRequest, seas: IndependentSeas) -> tuple[SpotShape, float, float | None]:
    """Return the shape of the objects, the share of a contrast at the aperture that reaches their pixel, and the object's own contrast."""
    if request.own_shape is not None:
        return request.own_shape, 1.0, None
    match request.kind:
        case "point":
            return *point_shape(seas.model), None
        case "gaussian":
            return GaussianSpot(0.8), 1.0, None
        case name:
            signal = object_signal(scenario, name)
            return signal.shape, 1.0, signal.contrast


def run_scene(
    scenario: Scenario,
    request: SceneRequest,
    parts: StudyParts,
    *,
    clock: Clock | None = None,
    name: str = "scene",
    progress: Progress | None = None,
    workers: Workers | None = None,
) -> DetectorResult:
    """Evaluate a detector in one scene, of which ``workers`` render the seas.

    Raises
    ------
    SeaglintError
        A scene that cannot be drawn, or a detector that fails.
    """
    clock = clock or Clock(None)
    seas = IndependentSeas.of(scenario)
    shape, share, own = injected(scenario, request, seas)
    length = lead_of(request.stated_detector, request.time_limit, shape) + 1
    source = SceneFrames(seas, parts.frames(frames_key(scenario, length)), length, workers=workers)
    if progress is not None:
        progress(source.count, request.seas)
    source.grow(1)
    # Contrasts in kelvin or in standard deviations refer to the first sea.
    first = source.read(0, 1)[0].astype(np.float64)
    strength = request.strength() or Strength((own,) if own is not None else tuple(float(f"{v * first.std():.3g}") for v in SWEEP))
    aperture = strength.at_aperture(seas, float(first.mean()))
    # Detectors look for bright objects: where all are dark, the sign of the frames is turned.
    sign = -1.0 if max(aperture) < 0.0 else 1.0
    judged = Rescaled(source, -1.0) if sign < 0.0 else source
    contrasts = tuple(sign * share * c for c in aperture)
    options = request.detection(contrasts, scenario.sensor.frame_rate_hz, seas.pixel_deg, shape)
    if not isinstance(options.detector, str) or ":" in options.detector:
        # A user's detector that fails is reported before all seas are rendered.
        tried = detector_for(judged, options)
        try:
            tried(judged.read(0, length))
        finally:
            ended(tried)
    precise = request.precision is not None or request.precision_fa is not None
    target = min(FIRST_SEAS, request.seas) if precise else request.seas

    def proceed(done: int) -> bool:
        if progress is not None:
            progress(done, request.seas)
        return not clock.over

    while True:
        source.grow(target, proceed)
        performance = detect(judged, options, name=name)
        reason, message = _stopped(performance, request, source.count, clock)
        if reason is not None:
            break
        target = min(2 * target, request.seas)
    result = performance.as_dict() | {"units": "W m-2 sr-1", "frame_rate_hz": options.frame_rate, "seas": source.count}
    result |= {"objects": request.kind, "contrast_unit": strength.unit, "stopped": reason}
    fill = 1.0 if seas.model is None or request.kind != "point" or request.own_shape is not None else seas.model.detector.fill_factor
    result |= {"point_response": share, "point_share": fill * share}
    result["notes"].append(message)
    if sign < 0.0:
        result["notes"].append("objects are darker than what is behind them: the frames are judged with their sign turned")
    rows = performance.rows()
    for k, (given, at) in enumerate(zip(strength.values, aperture, strict=True)):
        added = {"contrast": given, "contrast_unit": strength.unit, "contrast_aperture": at, "contrast_pixel": share * at}
        result["sweep"][k] |= added
        rows[k] |= added
    result["contrast"] = strength.values[0]
    if (design_request := request.design()) is not None:
        inverse = _inverse(strength, seas, float(first.mean()), share)
        try:
            figures = design(performance, judged, options, design_request).stated_by(lambda pixel: inverse(sign * pixel)).as_dict()
        except SeaglintError as error:
            figures = {"note": str(error)}
        result["design"] = figures | {"contrast_unit": strength.unit}
        for row in rows:
            row |= {f"design_{key}": result["design"].get(key) for key in ("contrast", "loss_db", "p_fa", "p_d")}
    alarms = false_alarm_map(performance, *seas.directions)
    return DetectorResult(result, rows, characteristic(performance, strength.values), alarms, chips(performance, judged), reason)


def _stopped(performance: Performance, request: SceneRequest, seas: int, clock: Clock) -> tuple[Reason | None, str]:
    """Return the reason why no further seas are drawn, and its note; None and an empty note where more are drawn."""
    precise = request.precision is not None or request.precision_fa is not None
    if precise:
        halves = [math.inf if d.low is None or d.high is None else 0.5 * (d.high - d.low) for d in performance.detections]
        alarms = performance.alarms.per_pixel
        counted = alarms.low is not None and alarms.high is not None and alarms.rate > 0
        share = 0.5 * ((alarms.high or 0.0) - (alarms.low or 0.0)) / alarms.rate if counted else math.inf
        detections_known = request.precision is None or max(halves) <= request.precision
        if detections_known and (request.precision_fa is None or share <= request.precision_fa):
            return "precision", f"stopped with {seas} seas: the stated precision is reached (P_d within {max(halves):.2g})"
    if clock.over:
        return "time budget", f"stopped with {seas} seas: the time budget of {clock.budget:.3g} s is reached; go on with --resume"
    if seas >= request.seas:
        return "frames", f"{seas} seas drawn, all that were asked for" + ("; the stated precision is not reached" if precise else "")
    return None, ""


def _inverse(strength: Strength, seas: IndependentSeas, mean: float, share: float) -> Callable[[float], float]:
    """Return the function from a contrast in the pixel to the contrast in its stated unit."""

    def back(pixel: float) -> float:
        at = pixel / share
        match strength.unit:
            case "W/sr":
                return at / replace(strength, values=(1.0,)).at_aperture(seas, mean)[0]
            case "K":
                from scipy.optimize import brentq

                def beyond(kelvin: float) -> float:
                    return (replace(strength, values=(kelvin,)).at_aperture(seas, mean)[0] if kelvin else 0.0) - at

                try:
                    # From 100 K colder to 5000 K warmer than the mean of the field.
                    return float(brentq(beyond, -100.0, 5000.0, xtol=1e-6))
                except (ValueError, SeaglintError):
                    return float("nan")
            case _:
                return at

    return back
