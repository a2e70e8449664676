"""How far an object of a scenario is detected: bisection over the range, path, size and clutter changing together."""

from __future__ import annotations

import hashlib
import itertools
import math
import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DataError, DomainError
from seaglint.clutter.filters import Unfiltered
from seaglint.detection.design import by_windows
from seaglint.detection.level import Rescaled
from seaglint.files.detection_parts import Parts
from seaglint.files.detection_range import DetectionRange, RangePoint
from seaglint.scenario.middle import middle_of
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import sun_position
from seaglint.studies.detect.designer import Design, rate_threshold
from seaglint.studies.detect.first_estimate import COLUMNS, estimated_p_d
from seaglint.studies.detect.injected import Seen, seen_object
from seaglint.studies.detect.near_object import AROUND, NearRows, background_of
from seaglint.studies.detect.performance import detect
from seaglint.studies.detect.rendered_seas import SceneOptions, lead_of
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames, frames_key

PRECISION: Final = 0.04
"""Share of the range at which the bisection ends."""

ESTIMATED: Final = 0.12
"""Share of the range at which its first estimate ends."""

STEP: Final = 1.25
"""Factor by which the frames look to either side of the first estimate."""

_ROWS: Final = 2 * AROUND + 16
"""Rows that are rendered about an object that is small in them."""

ROWS: Final = 1
"""Rows above and below the object's own in which it is injected: the sea there is as far away."""


@dataclass(frozen=True)
class RangeOptions:
    """Request for a range of detection.

    Attributes
    ----------
    name : str
        Name of the object.
    limits : (float, float)
        Nearest and farthest range tried [m].
    design : Design
        P_d at which the object counts as detected, and at which rate of false alarms.
    precision : float
        Share of the range at which the bisection ends [1].
    """

    name: str
    limits: tuple[float, float] = (500.0, 40_000.0)
    design: Design = field(default_factory=Design)
    precision: float = PRECISION

    def __post_init__(self) -> None:
        near, far = self.limits
        if not 0.0 < near < far:
            raise DomainError(f"ranges from {near:g} to {far:g} m; give two rising numbers above 0")
        if not 0.0 < self.precision < 1.0:
            raise DomainError(f"precision = {self.precision:g} is not between 0 and 1; it is a share of the range, e.g. 0.04")


def placed_at(scenario: Scenario, name: str, range_m: float, bearing_deg: float | None) -> Scenario:
    """The scenario with the object at a range along the line of sight, in the middle of the picture.

    Parameters
    ----------
    scenario : Scenario
        With a sensor that stands.
    name : str
        Of the object; it stays there, whatever its course.
    range_m : float
        Along the sea [m].
    bearing_deg : float, optional
        Of object and line of sight from the Sun's azimuth, clockwise [deg]; the sensor's own azimuth where nothing is said.

    Raises
    ------
    DataError
        No such object, or a sensor that moves.
    """
    if scenario.platform is not None:
        raise DataError("the range of detection is that of a sensor that stands; leave [platform] out")
    found = [item for item in scenario.objects or () if item.name == name]
    if not found:
        names = ", ".join(item.name for item in scenario.objects or ()) or "none"
        raise DataError(f"object '{name}' is not in the scenario; its [[objects]] are {names}")
    sensor = scenario.sensor
    azimuth = sensor.azimuth_deg
    if bearing_deg is not None:
        azimuth = (math.degrees(sun_position(scenario).azimuth) + bearing_deg) % 360.0
    towards = math.radians(azimuth)
    item = found[0]
    height = item.height_m if item.height_m is not None else 0.0
    drop = range_m**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    elevation = math.degrees(math.atan2(height - sensor.height_m - drop, range_m))
    rest = {"track": None, "keyframes": None, "course_deg": None, "speed_m_s": None, "latitude_deg": None, "longitude_deg": None}
    heading = item.heading_deg if item.heading_deg is not None else item.course_deg
    place = {"east_m": range_m * math.sin(towards), "north_m": range_m * math.cos(towards), "heading_deg": heading}
    moved = item.model_copy(update={**rest, **place})
    looking = sensor.model_copy(update={"azimuth_deg": azimuth, "elevation_deg": elevation})
    return scenario.model_copy(update={"objects": (moved,), "sensor": looking})


def p_d_at(
    scenario: Scenario, wanted: SceneOptions, asked: RangeOptions, range_m: float, bearing: float | None, parts: Parts
) -> RangePoint:
    """P_d of the object at one range at the threshold of the wanted rate; 0 with a note where nothing of it is seen.

    Waves that are geometry hide some of the object: as many seas as there are frames of say which share is seen, and P_d is the mean over
    them of that at the share's part of the contrast.
    """
    whole = placed_at(scenario, asked.name, range_m, bearing)
    key = hashlib.sha256(pickle.dumps((whole.model_dump_json(), wanted, asked.design), protocol=5)).hexdigest()[:16]
    kept = parts.case(f"range-{key}")
    if kept is not None:
        return RangePoint.of(kept)
    try:
        scene, seen = seen_nearby(whole, asked.name)
    except DataError as error:
        point = RangePoint(range_m, note=str(error))
    else:
        seas = IndependentSeas.of(scene)
        shares = seen.visible_shares(wanted.seas, seas)
        if not shares.any():
            point = RangePoint(range_m, note=f"object '{asked.name}' is hidden behind waves in all of {wanted.seas} seas")
            parts.keep_case(f"range-{key}", point.as_dict())
            return point
        length = lead_of(wanted.options, seen.shape) + 1
        name = frames_key(scene, length)
        source = SceneFrames(seas, parts.frames(name), length)
        source.grow(wanted.seas)
        background, first, end = background_of(seas, round(seen.row), seen.shape.half)
        near = NearRows(source, first, end)
        row = round(seen.row) - first
        levels, weights = levels_of(shares)
        contrasts = tuple(float(abs(seen.contrast) * level) for level in levels)
        objects = replace(wanted.options.objects, shape=seen.shape, contrasts=contrasts, only_rows=(row - ROWS, row + ROWS + 1))
        options = replace(wanted.options, objects=objects, frame_rate=scene.sensor.frame_rate_hz, pixel_deg=seas.pixel_deg)
        found = detect(Rescaled(near, -1.0) if seen.contrast < 0 else near, options, name=asked.name)
        at = rate_threshold(found, asked.design)
        rates = [by_windows(scores, at.sigma, options.level) for scores in found.trials.scores]
        p_d, ends = _over_seas([rate.rate for rate in rates], [rate.ends for rate in rates], weights, shares.size)
        dark = "darker than what is behind it: the detector looks for dark objects"
        point = RangePoint(
            range_m,
            p_d,
            ends,
            visible_share=float(shares.mean()),
            contrast_pixel=seen.contrast,
            threshold_sigma=at.sigma,
            note=dark if seen.contrast < 0 else None,
            believed=at.believed,
            background_sigma=found.background[1],
            background=background,
        )
        parts.forget_frames(name)
    parts.keep_case(f"range-{key}", point.as_dict())
    return point


def seen_nearby(whole: Scenario, name: str) -> tuple[Scenario, Seen]:
    """Return the scenario with the rows about the object alone, and the object as it is seen there.

    Raises
    ------
    DataError
        Nothing of it is seen.
    """
    scene = middle_of(whole, _ROWS)
    seen = seen_object(scene, name)
    if 2 * seen.shape.half < AROUND:
        return scene, seen
    return whole, seen if scene is whole else seen_object(whole, name)


def levels_of(shares: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Visible shares in eighths, each the mean of those in it, and how many seas have them [1]; hidden ones are left out.

    Examples
    --------
    >>> levels, weights = levels_of(np.array([0.0, 0.5, 1.0, 1.0]))
    >>> levels.tolist(), weights.tolist()
    ([0.5, 1.0], [0.25, 0.5])
    """
    seen = shares[shares > 0.0]
    eighth = np.ceil(8.0 * seen)
    kinds = np.unique(eighth)
    levels = np.array([seen[eighth == kind].mean() for kind in kinds])
    return levels, np.array([np.count_nonzero(eighth == kind) / shares.size for kind in kinds])


def _over_seas(
    rates: list[float], ends: list[list[float] | None], weights: NDArray[np.float64], seas: int
) -> tuple[float, list[float] | None]:
    """P_d over all visible shares, and its interval: that of each share, and the seas that happened to be drawn."""
    p_d = float(weights @ np.array(rates))
    if any(end is None for end in ends):
        return p_d, None
    low, high = (np.array([end[k] for end in ends if end is not None]) for k in (0, 1))
    spread = float(weights @ np.array(rates) ** 2) - p_d**2
    drawn = 1.96 * math.sqrt(max(spread, 0.0) / seas) if weights.sum() < 1.0 or weights.size > 1 else 0.0
    below, above = math.hypot(p_d - float(weights @ low), drawn), math.hypot(float(weights @ high) - p_d, drawn)
    return p_d, [max(p_d - below, 0.0), min(p_d + above, 1.0)]


def first_estimate(scenario: Scenario, asked: RangeOptions, bearing: float | None) -> float:
    """Range at which P_d falls below what is wanted, by :func:`~seaglint.studies.detect.first_estimate.estimated_p_d` [m].

    The nearest range tried where P_d is below at once, next to the farthest where it never is.
    """
    near, far = asked.limits

    def detected(at: float) -> bool:
        placed = middle_of(placed_at(scenario, asked.name, at, bearing), _ROWS, COLUMNS)
        try:
            seen = seen_object(placed, asked.name)
            return estimated_p_d(placed, seen, asked.design) >= asked.design.p_d
        except DataError:
            return False

    if not detected(near):
        return near
    while far / near - 1.0 > ESTIMATED:
        middle = math.sqrt(near * far)
        near, far = (middle, far) if detected(middle) else (near, middle)
    return math.sqrt(near * far)


def detection_range(
    scenario: Scenario,
    wanted: SceneOptions,
    asked: RangeOptions,
    parts: Parts,
    *,
    bearing_deg: float | None = None,
    say: Callable[[str], None] = lambda text: None,
) -> DetectionRange:
    """Range up to which an object is detected.

    P_d is taken to fall with the range. A first estimate, by the Gaussian law, says where frames begin to look; from there they go out
    until P_d is above and below what is wanted, and bisect the logarithm of the range between. The ends are the interval told.

    Returns
    -------
    DetectionRange
        Range with its interval, the points tried, and a note where the range is beyond the limits.
    """
    near, far = asked.limits
    points: list[RangePoint] = []

    def rate(at: float) -> float:
        points.append(p_d_at(scenario, wanted, asked, at, bearing_deg, parts))
        say(f"{asked.name} at {at:.0f} m{'' if bearing_deg is None else f', {bearing_deg:g} deg from the Sun'}: P_d {points[-1].p_d:.3g}")
        return points[-1].p_d

    goal = asked.design.p_d
    middle_of_ends, note = None, None
    ends: list[float | None]
    estimate = first_estimate(scenario, asked, bearing_deg)
    about = "below " if estimate == near else ""
    say(
        f"{asked.name}: first estimate {about}{estimate:.0f} m, from mean contrast, deviation of the clutter and the Gaussian law; "
        "frames refine it"
    )
    low, high = max(near, estimate / STEP), min(far, estimate * STEP)
    try:
        while rate(low) < goal and low > near:
            low, high = max(near, low / STEP**2), low
        if points[-1].p_d < goal:
            ends, note = [0.0, near], f"P_d is below {goal:g} at the nearest range of {near:g} m{_why(points[-1])}"
        else:
            if len(points) == 1:
                while rate(high) >= goal and high < far:
                    low, high = high, min(far, high * STEP**2)
            if points[-1].p_d >= goal and high == far:
                ends, note = [far, None], f"P_d is still {goal:g} or more at the farthest range of {far:g} m"
            else:
                while high / low - 1.0 > asked.precision:
                    middle = math.sqrt(low * high)
                    low, high = (middle, high) if rate(middle) >= goal else (low, middle)
                ends, middle_of_ends = [low, high], math.sqrt(low * high)
    except DataError as error:
        # one range that cannot be judged ends its bisection, not the others'
        if not points:
            raise
        ends, note = [low, high], f"between {low:.0f} and {high:.0f} m: {error}"
    tried = sorted(points, key=lambda point: point.range_m)
    doubtful = doubts(tried, ends)
    if middle_of_ends is not None and 2.0 * middle_of_ends <= asked.limits[1]:
        other = "top-hat" if wanted.options.detector != "top-hat" else "matched"
        twice = p_d_at(scenario, with_detector(wanted, other), asked, 2.0 * middle_of_ends, bearing_deg, parts)
        say(f"{asked.name} at {twice.range_m:.0f} m, {other}: P_d {twice.p_d:.3g}")
        if twice.p_d >= goal:
            doubtful.append(f"{other} still detects it with P_d {twice.p_d:.3g} at twice that range, {twice.range_m:.0f} m")
    return DetectionRange(asked.name, bearing_deg, goal, middle_of_ends, note, ends, tried, warnings=doubtful, first_estimate_m=estimate)


def _why(point: RangePoint) -> str:
    """Reason for which an object is not seen at a point: nothing of it is there, or too little contrast."""
    if not point.background_sigma:
        return f": {point.note}" if point.note else ""
    return f", where its contrast is {abs(point.contrast_pixel) / point.background_sigma:.2g} standard deviations of the background"


def with_detector(wanted: SceneOptions, name: str) -> SceneOptions:
    """Return the settings with another detector, and no filter before it."""
    return replace(wanted, options=replace(wanted.options, detector=name, filter=Unfiltered()))


def doubts(tried: Sequence[RangePoint], ends: Sequence[float | None]) -> list[str]:
    """Return why a range is to be doubted: P_d that rises with the range, thresholds beyond belief, what lies behind the object.

    Examples
    --------
    >>> near, far = RangePoint(500.0, 0.2, [0.1, 0.3]), RangePoint(900.0, 0.8, [0.7, 0.9])
    >>> doubts([near, far], [0.0, 500.0])
    ['P_d is 0.2 at 500 m and 0.8 at 900 m: it rises with the range, and the range found is one of several']
    """
    out = []
    for near, far in itertools.pairwise(tried):
        if near.p_d_interval is not None and far.p_d_interval is not None and near.p_d_interval[1] < far.p_d_interval[0]:
            where = f"P_d is {near.p_d:.3g} at {near.range_m:.0f} m and {far.p_d:.3g} at {far.range_m:.0f} m"
            out.append(f"{where}: it rises with the range, and the range found is one of several")
            break
    last = [point for point in tried if point.range_m in ends]
    if any(point.believed is False for point in last):
        out.append("the threshold is extrapolated from too few false alarms, and the range with it; give more frames")
    behind = sorted({point.background for point in last if point.background in ("sky", "horizon")})
    if behind:
        before = " and the ".join(map(str, behind))
        out.append(
            f"at this range the {before} lies behind the object; the mean of each row was removed, so expect less of a camera that rolls"
        )
    return out
