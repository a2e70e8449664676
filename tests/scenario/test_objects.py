"""Tables ``[[objects]]``: what is taken, and errors of one line that name the object."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from seaglint.base.errors import ScenarioError
from seaglint.objects import solids
from seaglint.objects.body import GasPlume, PointSource, Solid
from seaglint.objects.motion import east_north
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.presets import OBJECTS
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.bodies import bodies

BALL = {"name": "ball", "shape": {"kind": "sphere", "radius_m": 2.0}, "temperature_k": 300, "north_m": -500, "height_m": 5}
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def scenario(*objects, **more):
    return parse_scenario({"sensor": {"frames": 101}, "objects": list(objects), **more})


def made(item, **more):
    return bodies(scenario(item, **more))[0]


def volume(body):
    return sum(solids.volume((part.vertices, part.triangles)) for part in body.parts if isinstance(part, Solid))


def test_scenarios_without_objects_are_as_before():
    assert "objects" not in parse_scenario({}).model_dump_json(exclude_none=True)
    assert bodies(parse_scenario({})) == ()


def test_a_sphere_is_where_and_what_it_is_said_to_be():
    body = made({**BALL, "east_m": 30, "emissivity": 0.8})
    (part,) = body.parts
    np.testing.assert_allclose(body.motion.at(2.0).position, [30.0, -500.0, 5.0])
    assert np.linalg.norm(part.vertices, axis=1).mean() == pytest.approx(2.0, rel=2e-3)
    assert (part.temperature[0], part.emissivity[0]) == (300.0, 0.8)


def test_places_count_from_the_start_of_the_sensor():
    way = {"keyframes": [{"time_s": 0, "east_m": 100, "north_m": 40}, {"time_s": 4, "east_m": 120, "north_m": 40}]}
    np.testing.assert_allclose(made(BALL, platform=way).motion.at(1.0).position, [100.0, -460.0, 5.0])


def test_a_course_in_knots():
    motion = made({**BALL, "course_deg": 30, "speed_m_s": "10 kn"}).motion
    speed = 10 * 1852 / 3600
    np.testing.assert_allclose(motion.at(3.0).position, [1.5 * speed, -500 + 3 * np.cos(np.radians(30)) * speed, 5.0])
    np.testing.assert_allclose(motion.at(3.0).rotation[:, 1], [0.5, np.cos(np.radians(30)), 0.0], atol=1e-12)


def test_nested_parts_keep_or_take_their_material():
    inner = {"kind": "union", "temperature_k": 330, "at_m": [0, 10, 0], "parts": [{"kind": "box", "size_m": [1, 1, 1]}]}
    outer = {"kind": "union", "parts": [{"kind": "box", "size_m": [2, 4, 2]}, inner, {"kind": "plume", **PLUME}]}
    body = made({**BALL, "shape": outer})
    assert volume(body) == pytest.approx(17.0)
    far = body.parts[0].vertices[:, 1] > 5.0
    assert set(body.parts[0].temperature[far].round(6)) == {330.0}
    assert set(body.parts[0].temperature[~far].round(6)) == {300.0}
    assert body.parts[1] == GasPlume((0.0, -5.0, 0.0), (1.0, 3.0, 1.0), 600.0, 0.3)


PLUME = {"semi_axes_m": [1, 3, 1], "at_m": [0, -5, 0], "temperature_k": 600, "emissivity": 0.3}


GASES = {key: value for key, value in PLUME.items() if key != "emissivity"}


def test_plumes_of_gases_have_no_emissivity():
    inner = {"kind": "plume", **GASES, "co2_share": 0.1}
    outer = {"kind": "union", "emissivity": 0.9, "parts": [{"kind": "box", "size_m": [2, 4, 2]}, inner]}
    assert made({**BALL, "shape": outer}).parts[1] == GasPlume((0.0, -5.0, 0.0), (1.0, 3.0, 1.0), 600.0, None, 0.1, 0.0)
    turned = {"kind": "plume", **GASES, "heading_deg": 90, "h2o_share": 0.2}
    assert made({**BALL, "shape": turned}).parts == (GasPlume((0.0, -5.0, 0.0), (3.0, 1.0, 1.0), 600.0, None, 0.0, 0.2),)


def test_points():
    hot = {"name": "flare", "shape": {"kind": "point", "intensity_w_sr": 50, "temperature_k": 2200}, "north_m": -900, "height_m": 3}
    assert made(hot).parts == (PointSource(50.0, temperature=2200.0),)
    body = made({"name": "lamp", "shape": {"kind": "point", "intensity_w_sr": "5 kW/sr"}, "north_m": -900, "height_m": 3})
    assert body.parts == (PointSource(5000.0),)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "glb"])
def test_mesh_files_come_back(suffix, tmp_path):
    vertices, triangles = solids.wedge((2.0, 4.0, 3.0))
    path = tmp_path / f"wedge.{suffix}"
    if suffix == "glb":  # y up, z forward, x to port
        vertices = vertices[:, [0, 2, 1]] * (-1.0, 1.0, 1.0)
    mesh = trimesh.Trimesh(vertices * 100.0, triangles, process=False)
    if suffix == "ply":
        mesh.vertex_attributes["temperature"] = np.linspace(290.0, 310.0, 6)
        mesh.vertex_attributes["emissivity"] = np.full(6, 0.7)
    mesh.export(path)
    body = made({**BALL, "shape": {"kind": "mesh", "path": str(path), "units": "cm", "scale": 2.0}})
    part = body.parts[0]
    assert volume(body) == pytest.approx(8.0 * 12.0)
    np.testing.assert_allclose(part.vertices.max(axis=0), [2.0, 4.0, 3.0], rtol=1e-6)
    assert part.vertices[part.vertices[:, 2] > 2.9][:, 1].max() == pytest.approx(-4.0)  # high end aft
    assert np.ptp(part.temperature) == pytest.approx(20.0 if suffix == "ply" else 0.0)
    assert part.emissivity[0] == pytest.approx(0.7 if suffix == "ply" else 0.95)


def test_latitude_and_longitude(tmp_path):
    where = {"place": {"latitude_deg": 36.8, "longitude_deg": -75.9}, "time": {"utc": "2026-06-21T17:30:00Z"}}
    item = {**BALL, "latitude_deg": 36.79, "longitude_deg": -75.89}
    item.pop("north_m")
    wanted = east_north(*np.radians([36.79, -75.89]), tuple(np.radians([36.8, -75.9])))
    np.testing.assert_allclose(made(item, **where).motion.at(0.0).position[:2], wanted)
    track = tmp_path / "way.csv"
    track.write_text("time_s,latitude_deg,longitude_deg,height_m\n0,36.79,-75.89,5\n5,36.791,-75.89,9\n")
    motion = made({**BALL, "track": str(track)}, **where).motion
    np.testing.assert_allclose(motion.at(0.0).position, [*wanted, 5.0])
    np.testing.assert_allclose(motion.at(5.0).position[2], 9.0)
    with pytest.raises(ScenarioError, match=r"'ball'.*need \[place\]"):
        made({**BALL, "track": str(track)})


@pytest.mark.parametrize("name", OBJECTS)
def test_presets_are_closed_and_float_on_their_waterline(name):
    extra = {} if OBJECTS[name].values.get("floats") else {"height_m": 50}
    part = made({"name": name, "preset": name, "north_m": -900, **extra}).parts[0]
    assert volume(made({"name": name, "preset": name, "north_m": -900, **extra})) > 0.005
    assert OBJECTS[name].sources
    if not extra:
        assert part.vertices[:, 2].min() < 0.0 < part.vertices[:, 2].max()


def test_a_panamax_has_its_dimensions():
    part = made({"name": "ship", "preset": "container-ship", "north_m": -5000}).parts[0]
    assert np.ptp(part.vertices, axis=0)[:2] == pytest.approx([32.3, 294.1], rel=1e-9)
    assert part.vertices[:, 2].min() == pytest.approx(-12.0)


KEYFRAMES = [{"time_s": 0, "east_m": 0}, {"time_s": 3, "east_m": 10}, {"time_s": 2, "east_m": 20}]
REFUSED = {
    "emissivity": ({"emissivity": 1.5}, r"objects\[0\] \('ball'\)\.emissivity = 1\.5 is outside .* 0 to 1"),
    "no temperature": ({"temperature_k": None}, r"\('ball'\): temperature_k is missing; give"),
    "order": ({"keyframes": KEYFRAMES}, r"\('ball'\): keyframes\[2\]: time = 2 s is not after 3 s"),
    "too short": ({"keyframes": KEYFRAMES[:2]}, r"\('ball'\): time = 4 s is outside its keyframes.*add keyframes"),
    "under water": ({"height_m": -3}, r"\('ball'\): height_m: at 0 s it is under water.*give a greater height_m"),
    "above the air": ({"height_m": 99_999}, r"\('ball'\): height_m: .*allowed: up to 100000 m"),
    "sensor": ({"north_m": 0, "height_m": 31}, r"\('ball'\): at 0 s the sensor is inside it, 1 m from its origin; move"),
    "no height": ({"height_m": None}, r"\('ball'\): height_m is missing"),
    "degrees": ({"latitude_deg": 36, "longitude_deg": 5}, r"\('ball'\) has metres and degrees; give"),
    "units": ({"shape": {"kind": "mesh", "path": "x.stl", "units": "parsec"}}, r"\('ball'\)\.shape\.units = 'parsec' is not one of"),
    "speed": ({"course_deg": 5}, r"\('ball'\)\.speed_m_s is missing"),
    "dry": ({"floats": True, "height_m": 9}, r"\('ball'\): floats, but the water does not cut it"),
    "point": ({"shape": {"kind": "point"}}, r"\('ball'\): shape of kind 'point' needs intensity_w_sr"),
    "spectrum of nothing": (
        {"shape": {"kind": "point", "temperature_difference_k": 5, "area_m2": 1, "temperature_k": 900}},
        r"\('ball'\): shape of kind 'point' has temperature_k without intensity_w_sr.*; leave it out",
    ),
    "plume": (
        {"shape": {"kind": "plume", "semi_axes_m": [1, 1, 1]}},
        r"\('ball'\): shape\.emissivity is missing: a plume lets.*or co2_share and h2o_share",
    ),
    "two plumes in one": (
        {"shape": {"kind": "plume", "semi_axes_m": [1, 1, 1], "emissivity": 0.3, "co2_share": 0.1}},
        r"\('ball'\): shape of kind 'plume' has an emissivity and shares of gases; give",
    ),
    "too much gas": (
        {"shape": {"kind": "plume", "semi_axes_m": [1, 1, 1], "h2o_share": 0.5, "co2_share": 0.7}},
        r"\('ball'\): shape of kind 'plume' has co2_share \+ h2o_share = 1\.2; give mole fractions",
    ),
    "no gas": (
        {"shape": {"kind": "plume", "semi_axes_m": [1, 1, 1], "h2o_share": 0}},
        r"\('ball'\): shape of kind 'plume' has co2_share \+ h2o_share = 0; give mole fractions",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_bad_objects_are_refused_in_a_line_with_name_key_and_remedy(name):
    change, text = REFUSED[name]
    item = {key: value for key, value in {**BALL, **change}.items() if value is not None}
    with pytest.raises(ScenarioError, match=text) as error:
        made(item)
    assert "ball" in str(error.value).splitlines()[0]


def test_an_open_mesh_is_refused(tmp_path):
    vertices, triangles = solids.box((1.0, 1.0, 1.0))
    trimesh.Trimesh(vertices, triangles[1:], process=False).export(tmp_path / "open.stl")
    with pytest.raises(ScenarioError, match=r"\('ball'\): shape\.path = '.*open\.stl': the mesh is open: 3 edges.*close its holes"):
        made({**BALL, "shape": {"kind": "mesh", "path": str(tmp_path / "open.stl")}})


def test_two_objects_do_not_share_a_name_or_a_place():
    with pytest.raises(ScenarioError, match="'ball' twice"):
        scenario(BALL, BALL)
    other = {**BALL, "name": "other", "east_m": -20, "course_deg": 90, "speed_m_s": 9}
    with pytest.raises(ScenarioError, match=r"objects \('other'\): at 1\.875 s it overlaps 'ball'; move one of them"):
        bodies(scenario(BALL, other))
    assert len(bodies(scenario(BALL, {**other, "course_deg": 270}))) == 2


@pytest.mark.parametrize("name", ["harbour", "approach"])
def test_examples(name):
    example = load_scenario(EXAMPLES / f"{name}.toml")
    found = bodies(example, scenario_physics.sea(example, scenario_physics.slopes(example)).waves)
    assert len(found) >= 2
    for body in found:
        last = body.motion.at((example.sensor.frames - 1) / example.sensor.frame_rate_hz)
        assert np.isfinite(last.position).all()
