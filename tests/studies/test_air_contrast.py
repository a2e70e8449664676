"""Air over the water, and what it leaves of a contrast."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from seaglint.optics.blackbody import planck_wavenumber
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.mean.air_contrast import BEYOND, RANGES, air_contrast, air_line
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.mean.sensor_figures import describe_sensor

BANDS = [(3.5, 5.0), (8.0, 12.0)]


def scenario(band: tuple[float, float] = BANDS[0], **tables: Any) -> Any:
    sensor = {"height_m": 20.0, "elevation_deg": -1.0, "pixels": [8, 6]}
    return parse_scenario({"sensor": sensor, "band": {"min_um": band[0], "max_um": band[1]}} | tables)


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("extinction", [0.05, 0.4])
def test_even_air_leaves_what_its_extinction_says(band: tuple[float, float], extinction: float) -> None:
    air = {"source": "isothermal", "temperature_k": 285.0, "extinction_per_km": extinction}
    found = air_contrast(scenario(band, atmosphere=air), RANGES)
    slant = 1e-3 * np.hypot(RANGES, 20.0)
    # the chord over the round Earth differs from the plane's by less than 1e-5
    np.testing.assert_allclose(found.contrast_left, np.exp(-extinction * slant), rtol=1e-4)
    assert found.air_minus_water_k == pytest.approx(285.0 - 288.15)


@pytest.mark.parametrize("band", BANDS)
def test_the_share_is_the_contrast_of_two_bodies_through_the_path(band: tuple[float, float]) -> None:
    scene = scenario(band)
    over = scenario_physics.band(scene)
    air = scenario_physics.atmosphere(scene, over)
    nu, weights = air.wavenumber_cm, over.weights(air.wavenumber_cm)
    difference = planck_wavenumber(nu, 291.15) - planck_wavenumber(nu, 285.15)
    through = air.transmittance(20.0, np.array([5000.0]))[0]
    # six kelvin instead of one: the third derivative of Planck's law changes the weights a little
    assert air_contrast(scene, (5000.0,)).contrast_left[0] == pytest.approx(
        (weights * difference * through).sum() / (weights * difference).sum(), rel=3e-3
    )


@pytest.mark.parametrize(
    ("atmosphere", "sea", "names"),
    [
        ({}, {}, ["atmosphere.air_minus_sea_k", "sea.temperature_k"]),
        ({}, {"temperature_k": 290.0}, ["atmosphere.air_minus_sea_k"]),
        ({"model": "tropical"}, {"temperature_k": 290.0}, ["atmosphere.air_minus_sea_k"]),
        ({"air_minus_sea_k": -2.0}, {}, ["sea.temperature_k"]),
        ({"air_minus_sea_k": -2.0}, {"temperature_k": 290.0}, []),
        ({"source": "isothermal", "temperature_k": 288.0}, {"temperature_k": 290.0}, []),
        ({"source": "none"}, {}, []),
    ],
)
def test_the_line_names_what_is_not_stated(atmosphere: dict[str, Any], sea: dict[str, Any], names: list[str]) -> None:
    scene = scenario(atmosphere=atmosphere, sea=sea)
    line = air_line(scene)
    assert (line is None) == (not names)
    for key in ("atmosphere.air_minus_sea_k", "sea.temperature_k"):
        assert (key in (line or "")) == (key in names)
    if "air_minus_sea_k" in atmosphere:
        assert air_contrast(scene).air_minus_water_k == pytest.approx(-2.0, abs=0.05)


def test_the_distance_is_the_nearest_objects_or_the_middle_of_the_picture() -> None:
    boats = [{"name": name, "preset": "small-boat", "north_m": north} for name, north in (("far", 3000.0), ("near", -1500.0))]
    assert air_contrast(scenario(objects=boats)).place == "near"
    assert air_contrast(scenario(objects=boats)).ranges_m == (1500.0,)
    down = air_contrast(scenario())
    # 20 m above the sea, one degree down; the Earth's curvature adds a few per cent
    assert down.ranges_m[0] == pytest.approx(20.0 / math.tan(math.radians(1.0)), rel=0.06)
    assert "middle of the picture" in down.line
    up = air_contrast(scenario(sensor={"height_m": 20.0, "elevation_deg": 5.0, "pixels": [8, 6]}))
    assert up.ranges_m == (BEYOND,)


def test_python_gives_the_same_as_the_commands() -> None:
    tables = {"optics": {"aperture_m": 0.05, "f_number": 4.0}, "detector": {"pitch_um": 15.0}}
    sensor, night = {"height_m": 20.0, "elevation_deg": -1.0, "pixels": [8, 6]}, {"zenith_deg": 120.0}
    scene = scenario(BANDS[1], sun=night, sensor=sensor | tables)
    described = describe_sensor(scene)
    assert described.air == air_contrast(scene)
    assert described.as_dict()["air"]["contrast_left"] == list(described.air.contrast_left)
    assert mean(scene).attrs["air_note"] == air_line(scene)
    stated = scenario(BANDS[1], sun=night, atmosphere={"air_minus_sea_k": 1.0}, sea={"temperature_k": 290.0})
    assert "air_note" not in mean(stated).attrs
