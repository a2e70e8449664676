"""Objects that no frame of a sequence can show, by geometry alone before anything is drawn.

An object is outside if a ball around it is outside the picture in all frames, or if its highest point stays behind the sea's horizon.
Objects that waves, a rocking sensor or the time between two checks may bring into view are not reported.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray, horizon_range
from seaglint.base.reports import REPORTS
from seaglint.imaging.camera.imager import Imager
from seaglint.imaging.camera.pose import Pose, Track
from seaglint.objects.approach import reach_of
from seaglint.objects.body import Body
from seaglint.objects.drawing.eye import image_point, lens, stand
from seaglint.objects.motion import Rest
from seaglint.scenario.model import Scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.bodies import unchecked_bodies
from seaglint.studies.build.scenario_physics import bends_by_profile

MOST_LOOKS: Final = 4000  #: Largest number of places of objects that are checked; of more, frames are left out.

MOST_LINES: Final = 3  #: Largest number of objects with a line each; more objects share one line.

#: Angle by which refraction of a profile may raise or lower an object [rad]: more than in any mirage of a whole ship.
BENT: Final = math.radians(1.0)

ROCKED: Final = math.radians(20.0)  #: Angle by which a floating sensor may be turned from its place on a flat sea [rad].

#: Height by which waves may lift a floating object [m]: a part for swell, and one that grows with the square of the wind [s2 m-1].
HEAVED: Final = (1.0, 0.03)


@dataclass(frozen=True)
class OutOfView:
    """Object that no frame shows, where it comes nearest to the view."""

    name: str  #: Name of the object.
    azimuth: float  #: Azimuth from the sensor [deg].
    elevation: float  #: Elevation from the sensor [deg].
    range: float  #: Distance along the sea [m].
    #: Distance up to which its highest point is above the horizon [m]; None if it is beside the picture.
    seen_to: float | None = None
    time: float | None = None  #: Time of all this [s]; None where neither object nor sensor moves.

    @property
    def place(self) -> str:
        """Direction and distance as text: ``azimuth 0 deg, 2 km away``."""
        far = f"{self.range:.3g} m" if self.range < 1000.0 else f"{self.range / 1000.0:.3g} km"
        return f"azimuth {_degrees(self.azimuth)} deg, {far} away{'' if self.time is None else f' at {self.time:.4g} s'}"


def out_of_view(scenario: Scenario, times: FloatArray) -> tuple[OutOfView, ...]:
    """Return the objects of a scenario that are in view at no time of ``times`` [s].

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> behind = parse_scenario({"objects": [{"preset": "small-boat", "north_m": 2000}]})  # the sensor looks south
    >>> [(one.name, one.azimuth, one.range) for one in out_of_view(behind, np.zeros(1))]
    [('small-boat', 0.0, 2000.0)]
    """
    if not scenario.objects or not len(times):
        return ()
    track, pixels = scenario_physics.track(scenario), scenario_physics.imager(scenario)
    bodies = unchecked_bodies(scenario)
    most = max(MOST_LOOKS // len(bodies), 2)
    checked = np.asarray(times, float)
    checked = checked if checked.size <= most else checked[np.unique(np.linspace(0, checked.size - 1, most).round().astype(int))]
    floats = {item.name for item in scenario.objects if item.floats}
    # Angles by which the picture may differ from this geometry; objects within them are not reported.
    spare = (BENT if bends_by_profile(scenario) else 0.0) + (ROCKED if scenario.platform is not None and scenario.platform.floats else 0.0)
    # Wind waves grow with the square of the wind; swell is included as a constant.
    heave = HEAVED[0] + HEAVED[1] * scenario.wind.speed_m_s**2
    outside = []
    for body in bodies:
        lift = heave if body.name in floats else 0.0
        at = checked[:1]
        if track.moves or not isinstance(body.motion, Rest):
            # rows and columns of scanners, and ends of exposures, are later than their frame
            end = min(float(checked[-1]) + 1.0 / scenario.sensor.frame_rate_hz, track.known[1], body.motion.known[1])
            at = np.append(checked, max(end, float(checked[-1])))
        unseen = _outside_picture(body, lift, spare, at, (track, pixels))
        if unseen is None and not bends_by_profile(scenario):
            unseen = _behind_horizon(body, lift, at, track)
        if unseen is not None:
            outside.append(replace(unseen, time=None) if len(at) == 1 else unseen)
    return tuple(outside)


def _outside_picture(body: Body, lift: float, spare: float, times: FloatArray, camera: tuple[Track, Imager]) -> OutOfView | None:
    """Return the body if it is outside the picture at all times, and cannot cross it in between."""
    track, pixels = camera
    size = reach_of(body) + lift
    gaps, steps, nearest = [], [], None
    before: tuple[float, float] | None = None
    for time in times:
        pose = track.at(float(time))
        place = stand(body.motion.at(float(time)), pose).place
        column, row, gap = _gap(pixels, pose, place, size, spare)
        if gap <= 0.0:
            return None
        if nearest is None or gap < min(gaps):
            nearest = place, pose, float(time)
        gaps.append(gap)
        if before is not None:
            steps.append(_step(before, (column, row), pixels))
        before = column, row
    # between two checks, and in an exposure, it comes nearer by half a step at most
    if nearest is None or (steps and not min(gaps) > max(steps)):
        return None
    return _record_at(body, *nearest)


def _gap(pixels: Imager, pose: Pose, place: FloatArray, size: float, spare: float) -> tuple[float, float, float]:
    """Column and row of a place, and how far a ball around it is outside the picture [px]; below 0 where it may be inside."""
    far = float(np.linalg.norm(place))
    # The angular radius of a ball is the arcsine of radius over distance; a sensor inside it sees it everywhere.
    angle = (math.asin(size / far) if size < far else math.pi) + spare
    view = lens(pixels, pose.attitude)
    column, row, ahead = image_point(view, (float(place[0]), float(place[1]), float(place[2])), 0.5 * pixels.columns)
    if angle >= math.pi:
        return column, row, -1.0
    if pixels.projection == "pinhole":
        wide, high = math.tan(0.5 * pixels.width), math.tan(0.5 * pixels.height_angle)
        # Angle from the optical axis; a plane picture ends at its corner.
        off = math.acos(max(-1.0, min(1.0, float(pose.attitude.axes[2] @ place) / far)))
        if off - angle >= math.atan(math.hypot(wide, high)):
            apart = (off - angle - math.atan(math.hypot(wide, high))) / max(view.across[1], 1e-12)
            return (column, row, max(apart, 1e-9)) if ahead else (math.inf, math.inf, math.inf)
        if off + angle >= 0.5 * math.pi:
            return column, row, -1.0
        spread = math.tan(off + angle) - math.tan(off)
        across, down = spread / view.across[1], spread / -view.down[1]
    else:
        reach = math.cos(view.down[0] + view.down[1] * row)
        # Columns are steps of azimuth, so a ball is wider in azimuth by the cosine of elevation.
        across = math.asin(math.sin(angle) / reach) / view.across[1] if angle < 0.5 * math.pi and math.sin(angle) < reach else math.inf
        down = angle / -view.down[1]
    return column, row, max(-column - across, column - pixels.columns - across, -row - down, row - pixels.rows - down)


def _step(before: tuple[float, float], after: tuple[float, float], pixels: Imager) -> float:
    """Return how far a place moves in the picture between two checks, the shorter distance around a panorama [px]."""
    if not math.isfinite(before[0]) or not math.isfinite(after[0]):
        return 0.0 if math.isinf(before[0]) and math.isinf(after[0]) else math.inf
    across = abs(after[0] - before[0])
    if pixels.projection == "equal-angle":
        across = min(across, abs(2.0 * math.pi / pixels.width * pixels.columns - across))
    return max(across, abs(after[1] - before[1]))


def _behind_horizon(body: Body, lift: float, times: FloatArray, track: Track) -> OutOfView | None:
    """Return the body if its highest point is behind the horizon at all times; it moves little on this scale between two of them."""
    margins = []
    for time in times:
        pose, placement = track.at(float(time)), body.motion.at(float(time))
        top = max(float(placement.position[2]) + reach_of(body) + lift, 0.0)
        arc = math.hypot(placement.position[0] - pose.east, placement.position[1] - pose.north)
        seen_to = horizon_range(pose.height) + (horizon_range(top) if top > 0.0 else 0.0)
        # Horizon of the sensor plus horizon of the object's top: the farthest arc at which it is visible.
        margins.append((arc - seen_to, float(time), seen_to))
    margin, time, seen_to = min(margins)
    if margin <= (0.0 if len(times) == 1 else max(abs(a[0] - b[0]) for a, b in pairwise(margins))):
        return None
    pose = track.at(time)
    return _record_at(body, stand(body.motion.at(time), pose).place, pose, time, seen_to)


def _record_at(body: Body, place: FloatArray, pose: Pose, time: float, seen_to: float | None = None) -> OutOfView:
    at = body.motion.at(time).position
    azimuth = math.degrees(math.atan2(place[0], place[1])) % 360.0
    elevation = math.degrees(math.atan2(place[2], math.hypot(place[0], place[1])))
    return OutOfView(body.name, azimuth, elevation, math.hypot(at[0] - pose.east, at[1] - pose.north), seen_to, time)


def times_of(scenario: Scenario, frames: Sequence[int] | None = None) -> FloatArray:
    """Return the times of some frames, all of the scenario's by default [s]; of very many frames the times that are checked."""
    numbers = range(scenario.sensor.frames) if frames is None else frames
    places = range(len(numbers))
    if len(places) > MOST_LOOKS:
        places = np.unique(np.linspace(0, len(numbers) - 1, MOST_LOOKS).round().astype(int)).tolist()
    return np.array([numbers[place] for place in places], float) / scenario.sensor.frame_rate_hz


def report_out_of_view(scenario: Scenario, frames: Sequence[int] | None = None, *, times: FloatArray | None = None) -> None:
    """Report the objects that are in no frame of ``frames``, all of the scenario's by default, or at no time of ``times`` [s]."""
    if not scenario.objects:
        return
    for line in lines_of(scenario, out_of_view(scenario, times_of(scenario, frames) if times is None else times)):
        REPORTS.warning("%s", line)


def lines_of(scenario: Scenario, unseen: Sequence[OutOfView]) -> list[str]:
    """Return a line for each object out of view with what brings it into view, or one line for many."""
    if len(unseen) <= MOST_LINES:
        return [_line(scenario, one) for one in unseen]
    named = "; ".join(f"'{one.name}' at {one.place}" for one in unseen[:MOST_LINES])
    text = f"{len(unseen)} of {len(scenario.objects or ())} objects never enter the view: {named}; and {len(unseen) - MOST_LINES} more"
    if scenario.platform is not None:
        return [text]
    return [f"{text}{_looks(scenario)}; {_turn(scenario, unseen[0])} looks at the first"]


def _line(scenario: Scenario, one: OutOfView) -> str:
    if one.seen_to is not None:
        return (
            f"object '{one.name}' stays behind the horizon: {one.place}, and it is in view up to {one.seen_to / 1000.0:.3g} km; "
            "bring it nearer, or raise the sensor (sensor.height_m)"
        )
    text = f"object '{one.name}' never enters the view: {one.place}{_looks(scenario)}"
    if scenario.platform is not None:
        return f"{text}; turn the sensor towards it (azimuth_deg of the platform), or move the object"
    return f"{text}; {_turn(scenario, one)} looks at it{'' if one.time is None else ' then'}"


def _looks(scenario: Scenario) -> str:
    """Return the view of a standing sensor, as a clause."""
    sensor = scenario.sensor
    if scenario.platform is not None:
        return ""
    (width, height), middle, level = sensor.fov_deg, sensor.azimuth_deg, sensor.elevation_deg
    across = "all around" if width >= 360.0 else f"at {_degrees(middle - 0.5 * width)} to {_degrees(middle + 0.5 * width)} deg"
    return f", and the sensor looks {across}, elevation {level - 0.5 * height:.3g} to {level + 0.5 * height:.3g} deg"


def _turn(scenario: Scenario, one: OutOfView) -> str:
    """Return the keys that point a standing sensor at an object."""
    sensor = scenario.sensor
    keys = []
    if abs((one.azimuth - sensor.azimuth_deg + 180.0) % 360.0 - 180.0) > 0.45 * sensor.fov_deg[0]:
        keys.append(f"sensor.azimuth_deg = {_degrees(one.azimuth)}")
    if abs(one.elevation - sensor.elevation_deg) > 0.45 * sensor.fov_deg[1]:
        most = 90.0 if sensor.projection == "pinhole" else 90.0 - 0.5 * sensor.fov_deg[1]
        keys.append(f"sensor.elevation_deg = {max(-most, min(most, one.elevation)):.4g}")
    return " with ".join(keys) or f"sensor.azimuth_deg = {_degrees(one.azimuth)}"


def _degrees(angle: float) -> str:
    """Return an azimuth from 0 to 360 as text with at most four figures."""
    return f"{round(angle % 360.0, 2) % 360.0:.4g}"
