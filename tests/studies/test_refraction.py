"""Pictures through air that bends lines of sight: the standard picture where it bends as that, mirages where it does not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from seaglint.air.profile.ray_paths import LayeredIndex
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import ScenarioError
from seaglint.imaging.refraction import FINER, Bending, RefractedScene, RowShift
from seaglint.imaging.upright_scene import SweptScene
from seaglint.instrument.scan import ScanPattern
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.sensor_model import sensor_model
from seaglint.studies.mean import mean_map
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence.exposed_objects import ExposedObjects
from seaglint.studies.sequence.labelled_frames import image
from seaglint.studies.sequence.memory import memory_needed
from seaglint.studies.sequence.render_sequence import Sequence, prepare_sequence

LAYERS = ["range", "coverage", "path_radiance", "emitted_radiance", "sky_radiance", "slope", "glint_share"]

BOAT = {"name": "boat", "shape": {"kind": "box", "size_m": [4, 14, 5]}, "temperature_k": 300, "east_m": 0, "draught_m": 1}
LIGHT = {"name": "light", "shape": {"kind": "point", "intensity_w_sr": 40.0}, "east_m": 12, "height_m": 6}


def scenario(atmosphere=None, objects=(), render=None, **sensor):
    """A small camera over a dark sea, its air by the profile of a model unless said otherwise."""
    grid = {"pixels": [24, 40], "fov_deg": [0.24, 0.4], "elevation_deg": -0.15, "height_m": 20.0, "azimuth_deg": 0.0}
    return parse_scenario(
        {
            "sensor": {**grid, **sensor},
            "wind": {"speed_m_s": 5.0},
            "band": {"min_um": 8.0, "max_um": 12.0},
            "sun": {"zenith_deg": 120.0},
            "atmosphere": atmosphere or {"source": "table"},
            "objects": list(objects),
            "render": render or {},
        }
    )


def without_air(of: Sequence, settings) -> Sequence:
    """The same sequence with refraction worked out ray by ray, over an Earth of the standard picture's radius."""
    index = LayeredIndex(np.array([0.0, 1e5]), np.array([1e-15, 1e-15]), EFFECTIVE_EARTH_RADIUS)
    camera = scenario_physics.swept_camera(settings)
    assert camera is not None
    shift = RowShift.of(Bending(index, camera.height, 285.0), camera)
    view = of.scene.view
    scene = SweptScene.prepare(
        view,
        shift.standard,
        of.scene.waves,
        accuracy=scenario_physics.accuracy(settings),
        layers=of.scene.layers,
        sparkles=scenario_physics.sparkles(settings),
    )
    return replace(of, scene=RefractedScene(scene, shift))


def test_the_standard_picture_comes_back_where_air_bends_as_the_standard():
    settings = scenario(render={"layers": LAYERS})
    bent = without_air(prepare_sequence(settings), settings)
    scene = bent.scene
    assert isinstance(scene, RefractedScene)
    finer = scene.standard.drawn(scene.standard.pose, 0.0)
    own = bent.at(0.0)
    first = round((scene.standard.camera.top - scene.camera.top) / scene.standard.camera.row_step)
    for name in ("radiance", "coverage", "path_radiance", "emitted_radiance"):
        rows = finer[name][first : first + FINER * 40].reshape(40, FINER, 24).mean(axis=1)
        # the row of the horizon: rays tell sea from sky, the standard picture has crests there
        off = np.abs(own[name] - rows).max(axis=1) / np.abs(rows).max()
        assert np.median(off) < 1e-5
        assert np.sort(off)[-4] < 2e-3
        assert off.max() < 0.03 if name != "coverage" else off.max() < 0.4
    assert np.isfinite(own["range"]).mean() == pytest.approx(np.isfinite(finer["range"]).mean(), abs=0.1)


@pytest.mark.parametrize("north", [900.0, 6000.0])
def test_objects_come_back_too(north):
    settings = scenario(objects=[{**BOAT, "north_m": north}, {**LIGHT, "north_m": north}], elevation_deg=-0.2 if north > 5e3 else -1.1)
    straight = prepare_sequence(settings)
    bent = without_air(straight, settings)
    one, other = (run.images(0) for run in (straight, bent))
    for name, bar in (("column_px", 2e-3), ("row_px", 5e-3), ("visible_share", 2e-3), ("range_m", 1e-6), ("contrast_W_m2_sr", 2e-3)):
        assert np.allclose(one[name], other[name], rtol=0.0, atol=bar, equal_nan=True), name
    seen = [np.asarray(run.drawn(0.0).layers.radiance - run.drawn(0.0).sea, float) for run in (straight, bent)]
    assert seen[1].sum() == pytest.approx(seen[0].sum(), rel=2e-3)
    assert np.abs(seen[0]).sum() > 0.0


@pytest.mark.parametrize("apart", [True, False])
def test_objects_before_a_detector_come_back_too(apart):
    """Light on the pixels and labels of a boat and a lamp: through standard air ray by ray, and as it is drawn without rays.

    Apart, or with the lamp beside the boat, so that they may meet in the exposure and are drawn at many instants.
    """
    lens = {"aperture_m": 0.05, "focal_length_m": 15e-6 / math.radians(0.01)}
    optics = {"optics": lens, "detector": {"pitch_um": 15, "integration_time_s": 0.002}}
    raft = {**BOAT, "shape": {"kind": "box", "size_m": [1, 1, 1.5]}, "draught_m": 0.2, "east_m": -0.4}
    moving = [
        {**item, "north_m": 900.0, "course_deg": 90.0}
        for item in (raft, {**LIGHT, "east_m": 0.7 if apart else 0.3, "height_m": 4 if apart else 1.0})
    ]
    objects = [{**moving[0], "speed_m_s": 8.0}, {**moving[1], "speed_m_s": 20.0 if apart else 200.0}]
    fine, n = scenario(objects=objects, elevation_deg=-1.1, pixels=[120, 200]), 5
    model = sensor_model(scenario(objects=objects, elevation_deg=-1.1, **optics))
    straight = prepare_sequence(fine)
    found = []
    for run in (straight, without_air(straight, fine)):
        assert run.objects is not None
        exposed = ExposedObjects.of(run.objects, run.scene, run.track, model, ScanPattern(), (n, n))
        found.append(exposed.light(run.scene, 0.0, run.drawn(0.0, compose=False).sea, (0.0, 0.0)))
    one, other = found
    assert np.abs(one.added - other.added).max() < 0.03 * np.abs(one.added).max()
    assert other.added.sum() == pytest.approx(one.added.sum(), rel=5e-3)
    for mine, its in zip(one.sights, other.sights, strict=True):
        assert len(mine.shares) == len(its.shares) == 1
        assert its.across == pytest.approx(mine.across, rel=5e-3, abs=1e-12)
        light = [sum(float(share.radiance.sum()) for share in sight.shares) for sight in (mine, its)]
        assert light[1] == pytest.approx(light[0], rel=5e-3)


def sounding(path, warmer):
    """A sounding of 1 m steps below 60 m, with a warmer layer over the standard lapse."""
    z = np.concatenate([np.arange(0.0, 60.0), np.geomspace(60.0, 15e3, 60)])
    kelvin = np.maximum(283.15 - 0.0065 * z + warmer(z), 216.65)
    p = np.concatenate([[0.0], np.cumsum(-9.80665 * np.diff(z) / (287.05 * 0.5 * (kelvin[1:] + kelvin[:-1])))])
    lines = [f"{a:.3f},{1013.25 * np.exp(b):.5f},{c:.4f},70" for a, b, c in zip(z, p, kelvin, strict=True)]
    path.write_text("\n".join(["height_m,pressure_hpa,temperature_k,relative_humidity_percent", *lines]) + "\n")
    return str(path)


def test_an_inversion_shows_the_lamp_twice_and_a_duct_the_sea_beyond_the_horizon(tmp_path):
    air = {"source": "lowtran", "sounding": sounding(tmp_path / "up.csv", lambda z: 9.0 / (1.0 + np.exp(-(z - 22.0) / 2.0)))}
    lamp = {
        "name": "lamp",
        "shape": {"kind": "sphere", "radius_m": 1.5},
        "temperature_k": 420,
        "east_m": 0,
        "north_m": 13e3,
        "height_m": 14,
    }
    view = {"height_m": 12.0, "pixels": [8, 120], "fov_deg": [0.02, 0.3], "elevation_deg": 0.0}
    hot = {}
    for refraction in ("standard", "profile"):
        run = prepare_sequence(scenario({**air, "refraction": refraction}, [lamp], **view))
        drawn = run.drawn(0.0)
        rows = np.flatnonzero((drawn.layers.radiance - drawn.sea).max(axis=1) > 0.5)
        hot[refraction] = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)
    assert len(hot["standard"]) == 1
    assert len(hot["profile"]) == 2
    duct = {"source": "lowtran", "sounding": sounding(tmp_path / "duct.csv", lambda z: 6.0 * (1.0 - np.exp(-z / 12.0)))}
    far = image(scenario({**duct, "refraction": "profile"}, **view), layers=["range"])
    near = image(scenario(duct, **view), layers=["range"])
    assert float(np.nanmax(far.range)) > 3.0 * float(np.nanmax(near.range))
    assert far.attrs["horizon_elevation_deg"] > 0.0
    assert np.isfinite(far.radiance).all()


@pytest.mark.parametrize("change", [-8.0, 5.0])
def test_the_mean_map_has_the_horizon_of_the_picture(change):
    settings = scenario({"source": "table", "air_minus_sea_k": change, "refraction": "profile"}, pixels=[64, 40], fov_deg=[0.64, 0.4])
    mapped, drawn = mean(settings), image(settings)
    rows = np.abs(mapped.radiance.mean("x") - drawn.radiance.mean("x")) / mapped.radiance.mean()
    assert float(rows.median()) < 2e-3
    assert float(np.sort(rows)[-2]) < 4e-3
    assert float(rows.max()) < 0.03  # the row of the horizon, where pictures have crests


def test_more_air_takes_as_much_from_the_deviation_of_glint_as_from_its_mean(monkeypatch):
    """Half of the light left: half of every part and half of the deviation, which is the root of a variance."""
    day = parse_scenario(
        {
            "sensor": {"pixels": [8, 12], "fov_deg": [4.0, 6.0], "elevation_deg": -2.0, "height_m": 20.0, "azimuth_deg": 180.0},
            "sun": {"zenith_deg": 70.0, "azimuth_deg": 180.0},
            "atmosphere": {"refraction": "profile"},
        }
    )
    whole = mean(day)
    real = mean_map.air_beyond
    monkeypatch.setattr(mean_map, "air_beyond", lambda *given: (0.5 * real(*given)[0], real(*given)[1]))
    half = mean(day)
    assert float(whole.glint_std.max()) > 0.0
    for name in ("glint_std", "glint_radiance", "emitted_radiance", "sky_radiance"):
        np.testing.assert_allclose(half[name], 0.5 * whole[name], rtol=1e-6, err_msg=name)


def test_what_cannot_be_refracted_is_refused_in_one_line():
    profile = {"source": "table", "refraction": "profile"}
    for wrong, text in (
        (scenario(profile, projection="pinhole"), "equal-angle"),
        (scenario(profile, roll_deg=5.0), "roll_deg"),
        (scenario(profile, [{**BOAT, "north_m": 2000.0}], render={"object_shadows": True}), "object_shadows"),
    ):
        with pytest.raises(ScenarioError, match=text):
            prepare_sequence(wrong)
    with pytest.raises(ScenarioError, match="refraction"):
        scenario({"source": "isothermal", "refraction": "profile"})
    assert memory_needed(scenario(profile)) > memory_needed(scenario())


CHANGES = (-20.0, -6.0, 4.0, 9.0, 20.0)
PLACES = ((20.0, (3.5, 5.0)), (2.0, (3.5, 5.0)), (900.0, (3.0, 5.0)), (60.0, (8.0, 12.0)))
LOWEST = [
    pytest.param(change, *place, marks=() if place is PLACES[0] and change in (-20.0, 9.0) else pytest.mark.validation)
    for place in PLACES
    for change in CHANGES
]


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(("change", "height", "band"), LOWEST)
def test_any_lowest_air_has_pictures_by_day(change, height, band):
    """Scattered sunlight, direct sunlight and thermal radiance, over air that bends rays more than the Earth is round and less."""
    for refraction in ("standard", "profile"):
        settings = parse_scenario(
            {
                "sensor": {"pixels": [6, 12], "fov_deg": [1.0, 2.0], "elevation_deg": -0.5, "height_m": height},
                "sun": {"zenith_deg": 70.0},
                "wind": {"speed_m_s": 3.0},
                "band": {"min_um": band[0], "max_um": band[1]},
                "sea": {"resolve_waves": False},
                "atmosphere": {"source": "table", "air_minus_sea_k": change, "refraction": refraction},
            }
        )
        for light in (mean(settings), image(settings)):
            values = light.radiance.values
            assert np.isfinite(values).all()
            assert values.min() > 0.0
