"""Detection in one rendered scene: seas until the wanted precision or the time is reached, objects, detector, and what is shown of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from seaglint.base.conventions import Progress
from seaglint.base.errors import DomainError, SeaglintError
from seaglint.base.free_form import JsonObject
from seaglint.cluster import Workers
from seaglint.detection.interface import Detector
from seaglint.detection.isolated import IsolatedDetector
from seaglint.detection.named_detectors import named_for
from seaglint.detection.sources import FrameSource, Rescaled
from seaglint.detection.spot import GaussianSpot, SpotShape
from seaglint.scenario.model import Scenario
from seaglint.store.detection_results import Judged, Parts
from seaglint.studies.detect.designer import Design, design
from seaglint.studies.detect.injected import SWEEP, Strength, point_shape, seen_object
from seaglint.studies.detect.performance import DetectionOptions, Performance, characteristic, chips, detect, false_alarm_map
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames, frames_key

FIRST_SEAS: Final = 8  #: Seas before the precision is looked at for the first time; twice as many each time after it.

Reason = Literal["precision", "time budget", "frames"]


@dataclass(frozen=True)
class SceneOptions:
    """How scenes are judged."""

    options: DetectionOptions  #: Detector, threshold, and of objects what does not depend on the scene.
    objects: str = "point"  #: "point", "gaussian", or the name of one of the scenario's objects.
    strength: Strength | None = None  #: Contrasts; without them a sweep in standard deviations of the frames, or the named object's own.
    shape: SpotShape | None = None  #: Instead of ``objects``.
    seas: int = 32  #: Independent seas at most.
    precision: float | None = None  #: Half width of the interval of P_d, at every contrast, from which on no further seas are drawn [1].
    precision_fa: float | None = None  #: The same of P_fa, as a share of it [1].
    design: Design | None = None  #: What is found out about needed contrasts.

    def __post_init__(self) -> None:
        if self.seas < 1:
            raise DomainError(f"{self.seas} seas; give at least 1")
        for name, value in (("precision", self.precision), ("precision of P_fa", self.precision_fa)):
            if value is not None and not 0.0 < value < 1.0:
                raise DomainError(f"{name} = {value:g} is not between 0 and 1; give e.g. 0.02")


@dataclass
class Clock:
    """Time that a case may take [s]; None for all that it needs."""

    budget: float | None
    now: Callable[[], float] = time.monotonic

    def __post_init__(self) -> None:
        self.begin = self.now()

    @property
    def over(self) -> bool:
        """Return whether the time of the case is used up."""
        return self.budget is not None and self.now() - self.begin >= self.budget


def lead_of(options: DetectionOptions, shape: SpotShape) -> int:
    """Earlier frames that the detector needs [frames]."""
    if ":" in options.detector:
        mine = IsolatedDetector(options.detector, options.time_limit)
        mine.close()
        return int(mine.lead)
    noise = np.random.default_rng(0).standard_normal((1, 64, 64)).astype(np.float32)
    found: Detector = named_for(options.detector, shape, lambda: noise)
    return found.lead


def injected(scenario: Scenario, wanted: SceneOptions, seas: IndependentSeas) -> tuple[SpotShape, float, float | None]:
    """Shape of the objects, what of a contrast at the aperture they add to their pixel, and their own contrast there."""
    if wanted.shape is not None:
        return wanted.shape, 1.0, None
    match wanted.objects:
        case "point":
            shape, share = point_shape(seas.model)
            return shape, share, None
        case "gaussian":
            return GaussianSpot(0.8), 1.0, None
        case name:
            seen = seen_object(scenario, name)
            return seen.shape, 1.0, seen.contrast


def run_scene(
    scenario: Scenario,
    wanted: SceneOptions,
    parts: Parts,
    *,
    clock: Clock | None = None,
    name: str = "scene",
    progress: Progress | None = None,
    workers: Workers | None = None,
) -> Judged:
    """Judge a detector in one scene, of which ``workers`` render the seas.

    Raises
    ------
    SeaglintError
        A scene that cannot be drawn, or a detector that fails.
    """
    clock = clock or Clock(None)
    seas = IndependentSeas.of(scenario)
    shape, share, own = injected(scenario, wanted, seas)
    length = lead_of(wanted.options, shape) + 1
    source = SceneFrames(seas, parts.frames(frames_key(scenario, length)), length, workers=workers)
    if progress is not None:
        progress(source.count, wanted.seas)
    source.grow(1)
    first = source.read(0, 1)[0].astype(np.float64)
    strength = wanted.strength or Strength((own,) if own is not None else tuple(float(f"{v * first.std():.3g}") for v in SWEEP))
    aperture = strength.at_aperture(seas, float(first.mean()))
    sign = -1.0 if max(aperture) < 0.0 else 1.0
    judged = Rescaled(source, -1.0) if sign < 0.0 else source
    objects = replace(wanted.options.objects, shape=shape, contrasts=tuple(sign * share * c for c in aperture))
    options = replace(wanted.options, objects=objects, frame_rate=scenario.sensor.frame_rate_hz, pixel_deg=seas.pixel_deg, enough=None)
    target = wanted.seas if wanted.precision is None and wanted.precision_fa is None else min(FIRST_SEAS, wanted.seas)

    def go_on(done: int) -> bool:
        if progress is not None:
            progress(done, wanted.seas)
        return not clock.over

    while True:
        source.grow(target, go_on)
        found = detect(judged, options, name=name)
        reason, told = _stopped(found, wanted, source.count, clock)
        if reason is not None:
            break
        target = min(2 * target, wanted.seas)
    result = found.as_dict() | {"units": "W m-2 sr-1", "frame_rate_hz": options.frame_rate, "seas": source.count}
    result |= {"objects": wanted.objects, "contrast_unit": strength.unit, "stopped": reason}
    fill = 1.0 if seas.model is None or wanted.objects != "point" or wanted.shape is not None else seas.model.detector.fill_factor
    result |= {"point_response": share, "point_share": fill * share}
    result["notes"].append(told)
    if sign < 0.0:
        result["notes"].append("objects are darker than what is behind them: the frames are judged with their sign turned")
    rows = found.rows()
    for k, (given, at) in enumerate(zip(strength.values, aperture, strict=True)):
        added = {"contrast": given, "contrast_unit": strength.unit, "contrast_aperture": at, "contrast_pixel": share * at}
        result["sweep"][k] |= added
        rows[k] |= added
    result["contrast"] = strength.values[0]
    if wanted.design is not None:
        inverse = _inverse(strength, seas, float(first.mean()), share)
        found_out = _designed(found, judged, options, wanted.design, lambda pixel: inverse(sign * pixel))
        result["design"] = found_out | {"contrast_unit": strength.unit}
        for row in rows:
            row |= {f"design_{key}": result["design"].get(key) for key in ("contrast", "loss_db", "p_fa", "p_d")}
    alarms = false_alarm_map(found, *seas.directions)
    return Judged(result, rows, characteristic(found, strength.values), alarms, chips(found, judged), reason)


def _stopped(found: Performance, wanted: SceneOptions, seas: int, clock: Clock) -> tuple[Reason | None, str]:
    """Why no further seas are drawn, and the line that says so; None to go on."""
    if wanted.precision is not None or wanted.precision_fa is not None:
        halves = [math.inf if d.low is None or d.high is None else 0.5 * (d.high - d.low) for d in found.detections]
        alarms = found.alarms.per_pixel
        counted = alarms.low is not None and alarms.high is not None and alarms.rate > 0
        share = 0.5 * ((alarms.high or 0.0) - (alarms.low or 0.0)) / alarms.rate if counted else math.inf
        reached = (wanted.precision is None or max(halves) <= wanted.precision) and (
            wanted.precision_fa is None or share <= wanted.precision_fa
        )
        if reached:
            return "precision", f"stopped with {seas} seas: the stated precision is reached (P_d within {max(halves):.2g})"
    if clock.over:
        return "time budget", f"stopped with {seas} seas: the time budget of {clock.budget:.3g} s is reached; go on with --resume"
    if seas >= wanted.seas:
        asked = wanted.precision is not None or wanted.precision_fa is not None
        return "frames", f"{seas} seas drawn, all that were asked for" + ("; the stated precision is not reached" if asked else "")
    return None, ""


def _inverse(strength: Strength, seas: IndependentSeas, mean: float, share: float) -> Callable[[float], float]:
    """From what is added to the pixel to the contrast as it is stated."""

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
                    return float(brentq(beyond, -100.0, 5000.0, xtol=1e-6))
                except (ValueError, SeaglintError):
                    return float("nan")
            case _:
                return at

    return back


def _designed(
    found: Performance, source: FrameSource, options: DetectionOptions, wanted: Design, inverse: Callable[[float], float]
) -> JsonObject:
    """The designer's figures; where they do not exist, why."""
    try:
        return design(found, source, options, wanted).stated_by(inverse).as_dict()
    except SeaglintError as error:
        return {"note": str(error)}
