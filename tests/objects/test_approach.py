"""A sensor that runs into objects on its way, against ways sampled densely."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seaglint.base.errors import ScenarioError
from seaglint.objects import solids
from seaglint.objects.approach import CLEARANCE, STRAIGHT, first_contact
from seaglint.objects.body import Body, GasPlume, Placement, PointSource
from seaglint.objects.mesh_checks import inside
from seaglint.objects.motion import Course, Keyframed, rotation
from seaglint.objects.solids import solid
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build.bodies import bodies

LAST = 8.0
DENSE = 1601
KINDS = ("box", "plume", "point")


def made(rng: np.random.Generator, kind: str) -> Body:
    """A body that flies by the sensor's place (0, 0, 30) or through it, on a spline, along lines or straight."""
    if kind == "box":
        part = solid(solids.box(tuple(rng.uniform(0.5, 6.0, 3))), 300.0, 1.0)
    elif kind == "plume":
        part = GasPlume(tuple(rng.uniform(-2.0, 2.0, 3)), tuple(rng.uniform(0.5, 4.0, 3)), 400.0, 0.5)
    else:
        part = PointSource(intensity=1.0)
    miss, wide = (rng.normal(0.0, 0.06, 3), 2.0) if kind == "point" else (rng.normal(0.0, 2.5, 3), 40.0)
    if rng.random() < 0.4:
        velocity = rng.normal(0.0, wide, 3)
        start = np.array([0.0, 0.0, 30.0]) + miss - rng.uniform(0.0, LAST) * velocity
        return Body("it", (part,), Course(Placement(start, rotation(*rng.uniform(-1.0, 1.0, 3))), velocity))
    time = np.array([-1.0, 2.0, 3.0, 5.0, LAST + 1.0])
    place = np.array([0.0, 0.0, 30.0]) + rng.normal(0.0, wide, (5, 3))
    place[rng.integers(1, 4)] = np.array([0.0, 0.0, 30.0]) + miss
    path = "spline" if rng.random() < 0.5 else "straight"
    angles = rng.uniform(-0.7, 0.7, (5, 3))
    return Body("it", (part,), Keyframed.create(time, place, angles, list("abcde"), follows=bool(rng.random() < 0.3), path=path))


def depth(body: Body, eye: np.ndarray, time: float) -> bool:
    """Whether the sensor is in a body at an instant."""
    at, (part,) = body.motion.at(time), body.parts
    place = at.rotation.T @ (eye - at.position)
    if isinstance(part, PointSource):
        return bool(np.linalg.norm(place) < CLEARANCE)
    if isinstance(part, GasPlume):
        return bool((((place - part.centre) / part.semi_axes) ** 2).sum() < 1.0)
    return inside(part, place)


@pytest.mark.parametrize("kind", KINDS)
def test_contacts_are_those_of_a_densely_sampled_way(kind):
    """Random ways; those that only graze are between the two samplings and count for neither."""
    rng = np.random.default_rng(KINDS.index(kind))
    met = missed = 0
    for _ in range(24):
        body, drift = made(rng, kind), rng.normal(0.0, 0.02 if kind == "point" else 1.0, 3)

        def eye(time: float, drift: np.ndarray = drift) -> np.ndarray:
            return np.array([0.0, 0.0, 30.0]) + drift * (time - 0.5 * LAST)

        found = first_contact(body, eye, np.array([0.0, LAST]), LAST)
        times = np.linspace(0.0, LAST, DENSE)
        held = [depth(body, eye(t), t) for t in times]
        if any(held) and found is None:
            # it grazes by less than a piece of the way deviates from a straight line
            least = min(float(np.linalg.norm(eye(t) - body.motion.at(t).position)) for t in times)
            assert least > CLEARANCE - STRAIGHT if kind == "point" else sum(held) <= 2
        elif any(held):
            first = times[held.index(True)]
            assert found.time == pytest.approx(first, abs=0.05)
            at = body.motion.at(found.time)
            assert found.distance == pytest.approx(float(np.linalg.norm(eye(found.time) - at.position)), abs=0.05)
            met += 1
        elif found is None:
            missed += 1
    assert min(met, missed) >= 4


def test_a_contact_between_frames_is_refused_before_anything_is_drawn():
    """A drone of 0.4 m crosses the sensor's place within 5 ms, between frames of 1 s."""
    drone = {
        "name": "drone",
        "shape": {"kind": "sphere", "radius_m": 0.2},
        "temperature_k": 300,
        "height_m": 30,
        "north_m": -150,
        "course_deg": 0,
        "speed_m_s": 100,
    }
    sensor = {"frame_rate_hz": 1.0, "frames": 4}
    told = r"objects \('drone'\): at 1\.49\d+ s the sensor is inside it, 0\.2 m from its origin; move"
    with pytest.raises(ScenarioError, match=told) as error:
        bodies(parse_scenario({"objects": [drone], "sensor": sensor}))
    assert "\n" not in str(error.value)
    beside = {**drone, "east_m": 0.3}
    assert len(bodies(parse_scenario({"objects": [beside], "sensor": sensor}))) == 1
    point = {**drone, "shape": {"kind": "point", "intensity_w_sr": 1.0}, "temperature_k": None, "east_m": 0.05}
    with pytest.raises(ScenarioError, match=r"the sensor is 0\.1 m from it, and a point needs 0\.1 m"):
        bodies(parse_scenario({"objects": [{k: v for k, v in point.items() if v is not None}], "sensor": sensor}))


def test_a_moving_sensor_runs_into_a_mast():
    mast = {"name": "mast", "shape": {"kind": "box", "size_m": [0.3, 0.3, 40]}, "temperature_k": 300, "height_m": 20, "north_m": 500.0}
    keyframes = [{"time_s": 0, "north_m": 0.0}, {"time_s": 10, "north_m": 1000.0}]
    settings = {"objects": [mast], "platform": {"keyframes": keyframes}, "sensor": {"frame_rate_hz": 0.3, "frames": 3}}
    with pytest.raises(ScenarioError, match=r"\('mast'\): at 4\.998\d+ s the sensor is inside it"):
        bodies(parse_scenario(settings))
    assert len(bodies(parse_scenario({**settings, "objects": [{**mast, "east_m": 0.2}]}))) == 1


def test_ways_far_away_cost_next_to_nothing():
    body = Body("far", (solid(solids.sphere(1.0), 300.0, 1.0),), Course(Placement(np.array([0.0, 1e4, 5.0]), np.eye(3)), np.zeros(3)))
    asked = []

    def eye(time: float) -> np.ndarray:
        asked.append(time)
        return np.array([0.0, 0.0, 30.0 + math.sin(0.0)])

    assert first_contact(body, eye, np.zeros(1), 1e6) is None
    assert len(asked) == 4
