"""Range up to which an object of a scenario is detected: bisection over the range, where path, size and clutter change together.

The object is placed at a range along the line of sight (``placed_at``). A first estimate takes seconds: the object's contrast, the
deviation of a few small seas, and the Gaussian law (``first_estimate``). Frames refine it (``detection_range``), and
``doubts`` lists the reasons for which the range is unreliable.
"""

from __future__ import annotations

import hashlib
import itertools
import math
import pickle
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.cluster import Workers
from seaglint.detection.design import by_windows
from seaglint.detection.detector_names import TRIED
from seaglint.detection.matched import Matched
from seaglint.detection.sources import FrameSource, Rescaled
from seaglint.scenario.changed_scenario import middle_of
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import sun_position
from seaglint.store.detection_results import DetectionRange, RangePoint, StudyParts, TriedDetector
from seaglint.studies.detect.designer import SMALLEST, Design, best_of, choice_line, rate_threshold, tried_detectors
from seaglint.studies.detect.injected import ObjectSignal, item_of, object_signal
from seaglint.studies.detect.near_object import AROUND, Background, NearRows, background_of, half_height, less_row_means, rows_to_horizon
from seaglint.studies.detect.performance import DetectionOptions, detect
from seaglint.studies.detect.rendered_seas import lead_of
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames, bare, frames_key
from seaglint.studies.sequence.sequence_work import SceneCache
from seaglint.version import __version__

if TYPE_CHECKING:
    from seaglint.detection.spot import SpotShape
    from seaglint.studies.detect.detection_requests import RangeRequest

ESTIMATED: Final = 0.12  #: Share of the range at which its first estimate ends.

ALIKE: Final = 1.6  #: Margin of contrast, or its inverse, up to which a list of detectors is not tried again: 1.2 in range.

ROUNDS: Final = 4  #: Ranges at which a list of detectors is tried at most.

STEP: Final = 1.25  #: Factor by which the frames look to either side of the first estimate.

LOOK_ROWS: Final = 8  #: Rows from one line of sight to the next: ranges of one line of sight share their seas.

_ROWS: Final = 2 * AROUND + 2 * LOOK_ROWS  #: Rows that are rendered about an object that is small in them.

ROWS: Final = 1  #: Rows above and below the object's own in which it is injected: the sea there is as far away.

COLUMNS: Final = 96  #: Columns about the object that are drawn for an estimate.

SEAS: Final = 3  #: Seas of that size that are drawn at each range.

_OFFSETS: Final = (np.arange(5) + 0.5) / 5 - 0.5  #: Places of the object within its pixel [px].

_ROLL = "the mean of each row was removed, so expect less of a camera that rolls"


def placed_at(scenario: Scenario, name: str, range_m: float, bearing_deg: float | None) -> Scenario:
    """Return the scenario with the object at a range along the line of sight, in the middle of the picture.

    Parameters
    ----------
    scenario : Scenario
        Scenario with a sensor at rest.
    name : str
        Name of the object; it stays there, whatever its course.
    range_m : float
        Range along the sea [m].
    bearing_deg : float, optional
        Bearing of object and line of sight from the Sun's azimuth, clockwise [deg]; by default the sensor's azimuth is kept.

    Raises
    ------
    DataError
        No such object, or a sensor that moves.
    """
    if scenario.platform is not None:
        raise DataError("the range of detection is that of a sensor that stands; leave [platform] out")
    item = item_of(scenario, name)
    sensor = scenario.sensor
    azimuth = sensor.azimuth_deg
    if bearing_deg is not None:
        azimuth = (math.degrees(sun_position(scenario).azimuth) + bearing_deg) % 360.0
    towards = math.radians(azimuth)
    height = item.height_m if item.height_m is not None else 0.0
    # The sea falls below the horizontal by the square of the range: the elevation is that of the object over the round Earth.
    drop = range_m**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    elevation = math.degrees(math.atan2(height - sensor.height_m - drop, range_m))
    # Whatever moves the object is taken away: it stays at its place.
    rest = {"track": None, "keyframes": None, "course_deg": None, "speed_m_s": None, "latitude_deg": None, "longitude_deg": None}
    heading = item.heading_deg if item.heading_deg is not None else item.course_deg
    place = {"east_m": range_m * math.sin(towards), "north_m": range_m * math.cos(towards), "heading_deg": heading}
    moved = item.model_copy(update={**rest, **place})
    looking = sensor.model_copy(update={"azimuth_deg": azimuth, "elevation_deg": elevation})
    return scenario.model_copy(update={"objects": (moved,), "sensor": looking})


def looking_near(placed: Scenario) -> Scenario:
    """Return a placed scenario whose line of sight is the nearest of a fixed series, and which has a single frame.

    Objects at most ranges are within a few rows of one line of sight, as the elevation of the sea changes little beyond some kilometres.
    Scenes of one line of sight differ in the object alone. The series has steps of ``LOOK_ROWS`` rows, in pictures of fewer than 48
    rows of a sixth of the picture, so that the object remains within half a step of the middle row.
    """
    sensor = placed.sensor
    rows = sensor.pixels[1]
    step = min(LOOK_ROWS, rows // 6) * sensor.fov_deg[1] / rows
    elevation = step * round(sensor.elevation_deg / step) if step > 0.0 else sensor.elevation_deg
    looking = sensor.model_copy(update={"elevation_deg": min(max(elevation, -90.0), 90.0), "frames": 1})
    return placed.model_copy(update={"sensor": looking})


@dataclass(eq=False)
class RangeScenes:
    """Scenes that the ranges of one search share: the seas of a line of sight, their frames on disk, and the calm sea under the object.

    The latest of each is cached. Results do not depend on the cache.
    """

    parts: StudyParts  #: Store of frames, and of P_d at each range.
    workers: Workers | None = None  #: Workers that render the seas; this process by default.
    calm: SceneCache = field(default_factory=SceneCache)  #: Calm sea over which the object is drawn.
    _seas: tuple[str, IndependentSeas] | None = field(default=None, repr=False)
    _visible: tuple[str, VisibleObject] | None = field(default=None, repr=False)
    _stored: set[str] = field(default_factory=set, repr=False)

    def seas(self, scene: Scenario) -> IndependentSeas:
        """Return the prepared seas of a scenario; they do not depend on its objects."""
        key = bare(scene).model_dump_json()
        if self._seas is None or self._seas[0] != key:
            self._seas = None  # two scenes would take twice the memory
            self._seas = key, IndependentSeas.of(scene)
        return self._seas[1]

    def frames(self, scene: Scenario, length: int, count: int) -> SceneFrames:
        """Return the frames of ``count`` seas of a scenario, ``length`` of each; those not stored are rendered."""
        key = frames_key(scene, length)
        self._stored.add(key)
        source = SceneFrames(self.seas(scene), self.parts.frames(key), length, workers=self.workers)
        source.grow(count)
        return source

    def visible(self, whole: Scenario, name: str, count: int) -> VisibleObject:
        """Return an object of a scenario with its visible share in ``count`` seas.

        Raises
        ------
        DataError
            Nothing of the object is visible.
        """
        key = f"{name} {count} {whole.model_dump_json()}"
        if self._visible is None or self._visible[0] != key:
            scene, target = seen_nearby(whole, name, self.calm)
            self._visible = key, VisibleObject(scene, target, target.visible_shares(count, self.seas(scene)))
        return self._visible[1]

    def forget_frames(self) -> None:
        """Remove the frames that were stored."""
        for key in self._stored:
            self.parts.forget_frames(key)


@dataclass(frozen=True)
class VisibleObject:
    """An object at one range, among the seas before it."""

    scene: Scenario  #: Scenario with only the rows about the object, where it is small in them.
    target: ObjectSignal  #: The object.
    shares: FloatArray  #: Visible share of the object in each sea [1].


def doubts(tried: Sequence[RangePoint], ends: Sequence[float | None]) -> list[str]:
    """Return the reasons why a range is unreliable: P_d that rises with the range, an unreliable threshold, the horizon or the sky behind.

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
    behind = next((text for text in map(horizon_note, reversed(last)) if text is not None), None)
    if behind is not None:
        out.append(behind)
    return out


def horizon_note(point: RangePoint) -> str | None:
    """Return the place of the horizon where it matters: behind the object, in the detector's window, or in the rows of the statistics.

    Examples
    --------
    >>> print(horizon_note(RangePoint(5e3, background="horizon", horizon_rows=12, window_rows=4, detector="top-hat")))
    at 5000 m the horizon is 12 rows above the object, beyond the 4 rows that top-hat looks at; rows about it count in the false alarms
    >>> horizon_note(RangePoint(5e3, background="sea", horizon_rows=30, window_rows=4)) is None
    True
    """
    at, rows, window = f"at {point.range_m:.0f} m", point.horizon_rows, point.window_rows
    if point.background == "sky" and (rows is None or window is None or abs(rows) > window):
        return f"{at} the sky lies behind the object; {_ROLL}"
    if rows is None:
        return None
    if rows == 0:
        return f"{at} the horizon lies behind the object; {_ROLL}"
    where = f"{at} the horizon is {abs(rows)} row{'s' * (abs(rows) != 1)} {'above' if rows > 0 else 'below'} the object"
    if window is None or abs(rows) <= window:
        looks = "whole frames" if window is None else f"the {window} rows"
        return f"{where}, within {looks} that {point.detector} looks at; {_ROLL}"
    if point.background == "horizon":
        return f"{where}, beyond the {window} rows that {point.detector} looks at; rows about it count in the false alarms"
    return None


def estimated_p_d(placed: Scenario, target: ObjectSignal, design: Design, scenes: RangeScenes) -> float:
    """Return P_d of a matched filter by the Gaussian law, without any search in frames.

    ``P_d = < Q(Q^-1(P_fa) - v c g / sigma) >`` over the places in the pixel and the seas, with the contrast ``c``, the share ``v`` of the
    object that waves leave in view, the filter's answer ``g`` and the standard deviation ``sigma`` of the filtered rows near the object.

    Parameters
    ----------
    placed : Scenario
        Scenario with the object in the middle of the picture.
    target : ObjectSignal
        Signal of the object there.
    design : Design
        Rate of false alarms.
    scenes : RangeScenes
        Scenes that ranges share.
    """
    seas = scenes.seas(placed)
    _, first, end = background_of(seas, round(target.row), target.shape.half)
    detector = Matched(target.shape.stamps(np.zeros((1, 2)))[0])
    frames = scenes.frames(placed, 1, SEAS).read(0, SEAS)
    rows, columns = frames.shape[1:]
    statistic = detector(less_row_means(frames[:, first:end]))
    # Rows and columns near the border repeat pixels; a third of the picture remains in any case.
    reach = min(detector.reach, (end - first) // 3, columns // 3)
    sigma = float(np.std(statistic[:, reach : end - first - reach, reach : columns - reach], dtype=np.float64))
    if not sigma > 0.0:
        return 1.0
    rate = design.p_fa
    if rate is None:
        # Each pixel counts as a separate alarm here; a rate near one half has no threshold above the mean.
        rate = min(design.alarms_per_hour / (3600.0 * placed.sensor.frame_rate_hz * rows * columns), 0.4)
    signal = np.multiply.outer(target.visible_shares(SEAS, seas), answers(target.shape, detector)) * abs(target.contrast) / sigma
    return float(np.where(signal > 0.0, ndtr(signal + ndtri(rate)), 0.0).mean())


def answers(shape: SpotShape, detector: Matched) -> FloatArray:
    """Return the largest answer of the filter among the pixels of an object of contrast 1, for places within its pixel [1]."""
    down, right = np.meshgrid(_OFFSETS, _OFFSETS, indexing="ij")
    stamps = np.asarray(shape.stamps(np.stack([down.ravel(), right.ravel()], axis=1)), np.float32)
    wide = np.pad(stamps, ((0, 0), (detector.reach,) * 2, (detector.reach,) * 2))
    return np.asarray(detector(wide).max(axis=(1, 2)), np.float64)


@dataclass(frozen=True)
class _Placed:
    """An object at one range, and the frames of the rows near it."""

    near: FrameSource  #: Frames without the object, with their sign turned where it is dark.
    options: DetectionOptions  #: With the object's shape, in its rows.
    target: ObjectSignal  #: The object.
    shares: FloatArray  #: Visible share of the object in each sea [1].
    background: Background  #: Rows whose statistics are taken.
    horizon_rows: int | None  #: Rows from the object to the horizon [px].


def _placed(whole: Scenario, request: RangeRequest, scenes: RangeScenes, in_view: float = 0.0) -> _Placed:
    """Draw the object of a request, and the seas about it unless they are stored.

    Raises
    ------
    DataError
        Nothing of the object is visible, or it is hidden in all seas, or visible in less than a share ``in_view`` of them.
    """
    name = request.object or ""
    visible = scenes.visible(whole, name, request.seas)
    scene, target, shares = visible.scene, visible.target, visible.shares
    if not shares.any():
        raise DataError(f"object '{name}' is hidden behind waves in all of {request.seas} seas")
    if np.count_nonzero(shares) < in_view * shares.size:
        raise DataError(f"object '{name}' is hidden behind waves in {np.count_nonzero(shares == 0.0)} of {request.seas} seas")
    length = lead_of(request.stated_detector, request.time_limit, target.shape) + 1
    seas, source = scenes.seas(scene), scenes.frames(scene, length, request.seas)
    background, first, end = background_of(seas, round(target.row), target.shape.half)
    near: FrameSource = NearRows(source, first, end)
    row = round(target.row) - first
    options = request.detection((1.0,), scene.sensor.frame_rate_hz, seas.pixel_deg, target.shape)
    options = replace(options, objects=replace(options.objects, only_rows=(row - ROWS, row + ROWS + 1)))
    return _Placed(
        near=Rescaled(near, -1.0) if target.contrast < 0 else near,
        options=options,
        target=target,
        shares=shares,
        background=background,
        horizon_rows=rows_to_horizon(seas, round(target.row), half_height(target.shape)),
    )


def _key(kind: str, whole: Scenario, *settings: object) -> str:
    """Return the name of a stored part: its kind, and a digest of the scenario and of the settings on which it depends."""
    content = (__version__, whole.model_dump_json(), *settings)
    return f"{kind}-{hashlib.sha256(pickle.dumps(content, protocol=5)).hexdigest()[:16]}"


def p_d_at(scenario: Scenario, request: RangeRequest, range_m: float, bearing: float | None, scenes: RangeScenes) -> RangePoint:
    """Return P_d of the object at one range, at the threshold of the requested rate; 0 with a note where nothing of it is visible.

    Resolved waves hide some of the object. As many seas as there are frames give its visible share, and P_d is the mean over these seas of
    P_d at that share of the contrast.
    """
    whole, parts = looking_near(placed_at(scenario, request.object or "", range_m, bearing)), scenes.parts
    key = _key("range", whole, *request.settings)
    if (stored := parts.case(key)) is not None:
        return RangePoint.of(stored)
    try:
        placed = _placed(whole, request, scenes)
    except DataError as error:
        point = RangePoint(range_m, note=str(error))
    else:
        levels, weights = levels_of(placed.shares)
        contrasts = tuple(float(abs(placed.target.contrast) * level) for level in levels)
        options = replace(placed.options, objects=replace(placed.options.objects, contrasts=contrasts))
        performance = detect(placed.near, options, name=request.object or "", locate=False)
        at = rate_threshold(performance, request.design())
        rates = [by_windows(scores, at.sigma, options.level) for scores in performance.trials.scores]
        p_d, ends = _over_seas([rate.rate for rate in rates], [rate.ends for rate in rates], weights, placed.shares.size)
        dark = "darker than what is behind it: the detector looks for dark objects"
        point = RangePoint(
            range_m=range_m,
            p_d=p_d,
            p_d_interval=ends,
            visible_share=float(placed.shares.mean()),
            contrast_pixel=placed.target.contrast,
            threshold_sigma=at.sigma,
            note=dark if placed.target.contrast < 0 else None,
            believed=at.believed,
            background_sigma=performance.background[1],
            background=placed.background,
            horizon_rows=placed.horizon_rows,
            window_rows=performance.detector.reach,
            detector=request.detector_name,
        )
    parts.keep_case(key, point.as_dict())
    return point


def tried_at(
    scenario: Scenario, request: RangeRequest, range_m: float, bearing: float | None, scenes: RangeScenes, names: Sequence[str] = TRIED
) -> list[TriedDetector]:
    """Return the margins of contrast of some detectors at one range; the frames stay stored for its P_d.

    Raises
    ------
    DataError
        Nothing of the object is visible.
    """
    whole, parts = looking_near(placed_at(scenario, request.object or "", range_m, bearing)), scenes.parts
    key = _key("choice", whole, *request.settings, names)
    if (stored := parts.case(key)) is not None:
        return [TriedDetector(**one) for one in stored["tried"]]
    design = request.design()
    placed = _placed(whole, replace(request, detector=names[0]), scenes, design.p_d)
    # The share that is visible in as many seas as the object is to be detected in: the mean share is too large where waves hide the object.
    contrast = abs(placed.target.contrast) * float(np.quantile(placed.shares, 1.0 - design.p_d, method="higher"))
    tried = tried_detectors(names, placed.near, placed.options, contrast, design, range_m)
    parts.keep_case(key, {"tried": [asdict(one) for one in tried]})
    return tried


def seen_nearby(whole: Scenario, name: str, calm: SceneCache) -> tuple[Scenario, ObjectSignal]:
    """Return the scenario with only the rows about the object, and the signal of the object there, over the ``calm`` sea of other ranges.

    Raises
    ------
    DataError
        Nothing of the object is visible.
    """
    scene = middle_of(whole, _ROWS)
    target = object_signal(scene, name, calm)
    if 2 * target.shape.half < AROUND:
        return scene, target
    return whole, target if scene is whole else object_signal(whole, name, calm)


def levels_of(shares: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return visible shares in eighths, each the mean of its members, and the share of the seas in each [1], without hidden objects.

    Examples
    --------
    >>> levels, weights = levels_of(np.array([0.0, 0.5, 1.0, 1.0]))
    >>> levels.tolist(), weights.tolist()
    ([0.5, 1.0], [0.25, 0.5])
    """
    target = shares[shares > 0.0]
    eighth = np.ceil(8.0 * target)
    kinds = np.unique(eighth)
    levels = np.array([target[eighth == kind].mean() for kind in kinds])
    return levels, np.array([np.count_nonzero(eighth == kind) / shares.size for kind in kinds])


def _over_seas(
    rates: list[float], ends: list[list[float] | None], weights: NDArray[np.float64], seas: int
) -> tuple[float, list[float] | None]:
    """Return P_d over all visible shares, and its interval from the interval of each share and the scatter of the drawn seas."""
    p_d = float(weights @ np.array(rates))
    if any(end is None for end in ends):
        return p_d, None
    low, high = (np.array([end[k] for end in ends if end is not None]) for k in (0, 1))
    variance = float(weights @ np.array(rates) ** 2) - p_d**2
    # Scatter between seas counts only where some hide the object.
    drawn = 1.96 * math.sqrt(max(variance, 0.0) / seas) if weights.sum() < 1.0 or weights.size > 1 else 0.0
    below, above = math.hypot(p_d - float(weights @ low), drawn), math.hypot(float(weights @ high) - p_d, drawn)
    return p_d, [max(p_d - below, 0.0), min(p_d + above, 1.0)]


def first_estimate(scenario: Scenario, request: RangeRequest, bearing: float | None, scenes: RangeScenes) -> float:
    """Return the range at which P_d of ``estimated_p_d`` falls below the requested P_d [m].

    It is the nearest range where P_d is below at once, and close to the farthest where P_d is never below.
    """
    name, design = request.object or "", request.design()
    near, far = request.limits

    def detected(at: float) -> bool:
        placed = middle_of(looking_near(placed_at(scenario, name, at, bearing)), _ROWS, COLUMNS)
        try:
            return estimated_p_d(placed, object_signal(placed, name, scenes.calm), design, scenes) >= design.p_d
        except DataError:
            return False

    if not detected(near):
        return near
    # Contrast falls by about a power of the range: bisection halves its logarithm.
    while far / near - 1.0 > ESTIMATED:
        middle = math.sqrt(near * far)
        near, far = (middle, far) if detected(middle) else (near, middle)
    return math.sqrt(near * far)


@dataclass(frozen=True)
class DetectorChoice:
    """Chosen detector, the range that its margin gives [m], and all detectors that were tried."""

    detector: str
    range_m: float
    tried: list[TriedDetector]


def choose(
    scenario: Scenario, request: RangeRequest, estimate: float, bearing: float | None, scenes: RangeScenes, report: Callable[[str], None]
) -> DetectorChoice:
    """Choose a detector by its margin of contrast at an estimate of the range.

    Where even the best has a margin beyond ``ALIKE``, its range is elsewhere and others may be better there: the contrast is taken to
    fall with the 2.5th power of the range, and the list is tried again at the range that follows, three times at most. Where waves hide
    the object in more seas than it may be missed in, the list is tried again at half the range.
    """
    near, far = request.limits
    at = estimate
    tried: list[TriedDetector] = []
    best = TriedDetector(TRIED[0], at, None)
    rounds = 0
    for _ in range(2 * ROUNDS):
        try:
            latest = tried_at(scenario, request, at, bearing, scenes)
        except DataError:
            margin = SMALLEST
        else:
            report(f"{request.object}: {choice_line(latest, request.design().p_d)}")
            tried, rounds = [*tried, *latest], rounds + 1
            best = best_of(latest)
            margin = best.contrast_margin or SMALLEST
        near, far = (max(near, at), far) if margin > 1.0 else (near, min(far, at))
        following = at * min(max(margin**0.4, 0.5), 2.0)  # 0.4 is one over the power of the range
        if not near < following < far:
            following = math.sqrt(near * far)
        if 1.0 / ALIKE <= margin <= ALIKE or rounds == ROUNDS or far < STEP * near:
            break  # the frames of this range stay stored: its P_d is counted in them
        at = following
    return DetectorChoice(best.detector, at, tried)


def detection_range(
    scenario: Scenario,
    request: RangeRequest,
    parts: StudyParts,
    *,
    bearing_deg: float | None = None,
    report: Callable[[str], None] = lambda text: None,
    workers: Workers | None = None,
) -> DetectionRange:
    """Return the range up to which an object is detected.

    P_d is taken to fall with the range. Frames are first searched near an estimate by the Gaussian law; from there the range is changed
    until P_d is above and below the requested P_d, and the logarithm of the range between is bisected. The ends are the interval reported.
    Where the request states no detector, the best of ``TRIED`` at the estimate is taken, and the
    search begins where it was chosen. Seas are rendered by ``workers``, by default in this process; results do not depend on them.

    Returns
    -------
    DetectionRange
        Range with its interval, the points tried, and a note where the range is beyond the limits.
    """
    scenes = RangeScenes(parts, workers)
    result = _searched(scenario, request, scenes, bearing_deg, report)
    scenes.forget_frames()
    return result


def _searched(
    scenario: Scenario, request: RangeRequest, scenes: RangeScenes, bearing_deg: float | None, report: Callable[[str], None]
) -> DetectionRange:
    near, far = request.limits
    name, goal = request.object or "", request.design().p_d
    points: list[RangePoint] = []

    def rate(at: float) -> float:
        points.append(p_d_at(scenario, request, at, bearing_deg, scenes))
        report(f"{name} at {at:.0f} m{'' if bearing_deg is None else f', {bearing_deg:g} deg from the Sun'}: P_d {points[-1].p_d:.3g}")
        return points[-1].p_d

    middle_of_ends, note = None, None
    ends: list[float | None]
    estimate = first_estimate(scenario, request, bearing_deg, scenes)
    about = "below " if estimate == near else ""
    report(
        f"{name}: first estimate {about}{estimate:.0f} m, from mean contrast, deviation of the clutter and the Gaussian law; "
        "frames refine it"
    )
    low, high = max(near, estimate / STEP), min(far, estimate * STEP)
    tried_first: list[TriedDetector] = []
    if request.detector is None:
        choice = choose(scenario, request, estimate, bearing_deg, scenes, report)
        request, tried_first, low = replace(request, detector=choice.detector), choice.tried, choice.range_m
        high = min(far, low * STEP)
    try:
        # Outwards by a factor of the range; the first step from the range at which a detector was chosen is half as wide in the logarithm.
        while rate(low) < goal and low > near:
            low, high = max(near, low / (STEP if tried_first and len(points) == 1 else STEP**2)), low
        if points[-1].p_d < goal:
            ends, note = [0.0, near], f"P_d is below {goal:g} at the nearest range of {near:g} m{_why(points[-1])}"
        else:
            if len(points) == 1:
                while rate(high) >= goal and high < far:
                    low, high = high, min(far, high * STEP**2)
            if points[-1].p_d >= goal and high == far:
                ends, note = [far, None], f"P_d is still {goal:g} or more at the farthest range of {far:g} m"
            else:
                while high / low - 1.0 > request.share:
                    middle = math.sqrt(low * high)
                    low, high = (middle, high) if rate(middle) >= goal else (low, middle)
                ends, middle_of_ends = [low, high], math.sqrt(low * high)
    except DataError as error:
        # A range that cannot be evaluated ends this bisection; the other cases and bearings go through.
        if not points:
            raise
        ends, note = [low, high], f"between {low:.0f} and {high:.0f} m: {error}"
    in_order = sorted(points, key=lambda point: point.range_m)
    warnings = doubts(in_order, ends)
    # A stated detector may fail where another does not: one range twice as far tells.
    if not tried_first and middle_of_ends is not None and 2.0 * middle_of_ends <= far:
        other = "top-hat" if request.detector != "top-hat" else "matched"
        try:
            twice = p_d_at(scenario, with_detector(request, other), 2.0 * middle_of_ends, bearing_deg, scenes)
        except DataError:
            twice = RangePoint(2.0 * middle_of_ends)  # a check that fails leaves the range unchanged
        report(f"{name} at {twice.range_m:.0f} m, {other}: P_d {twice.p_d:.3g}")
        if twice.p_d >= goal:
            warnings.append(f"{other} still detects it with P_d {twice.p_d:.3g} at twice that range, {twice.range_m:.0f} m")
    return DetectionRange(
        object=name,
        bearing_deg=bearing_deg,
        p_d=goal,
        range_m=middle_of_ends,
        note=note,
        range_interval_m=ends,
        points=in_order,
        warnings=warnings,
        first_estimate_m=estimate,
        detector=request.detector_name,
        tried=tried_first,
    )


def _why(point: RangePoint) -> str:
    """Return the reason why an object is not detected at a point: nothing of it is visible, or its contrast is small."""
    if not point.background_sigma:
        return f": {point.note}" if point.note else ""
    return f", where its contrast is {abs(point.contrast_pixel) / point.background_sigma:.2g} standard deviations of the background"


def with_detector(request: RangeRequest, name: str) -> RangeRequest:
    """Return the request with another detector, and no filter before it."""
    return replace(request, detector=name, filter="none", kernel=None)
