"""Sensors of aircraft and satellites, from 10 km to the top of the air at 100 km: maps, cases and pictures agree with sums by hand."""

import math

import numpy as np
import pytest

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.band_laws import OwnGases, with_gases
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.formats.tables.input_tables import read_cases
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.mean.evaluate_cases import evaluate_mean, parse_bands
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence.labelled_frames import image

HEIGHTS = (20e3, 100e3)
SEA = 290.0


def scenario(height, elevation=-90.0, **tables):
    """Three by three pixels of 0.01 deg over a summer sea with isotropic slopes, in 8-12 um."""
    sensor = {"height_m": height, "elevation_deg": elevation, "pixels": [3, 3], "fov_deg": [0.03, 0.03], "azimuth_deg": 180.0}
    settings = {
        "sensor": sensor | {"projection": "pinhole"},
        "wind": {"speed_m_s": 7.0},
        "band": {"min_um": 8.0, "max_um": 12.0},
        "sea": {"temperature_k": SEA, "slopes": {"kind": "cox-munk-isotropic"}},
        "sun": {"zenith_deg": 30.0, "azimuth_deg": 180.0},
        "atmosphere": {"source": "lowtran", "model": "midlatitude-summer"},
    }
    return parse_scenario(settings | tables)


def sums_of(view):
    """Own sums over the model's profile, and the weights of the band on their channels."""
    nu = view.atmosphere.wavenumber_cm
    return (
        AirSums(with_gases(model_profile("midlatitude-summer"), OwnGases().of("lblrtm")), HazeWeather(wind=7.0, wind_24h=7.0), nu),
        view.band.weights(nu),
        nu,
    )


@pytest.mark.parametrize("height", HEIGHTS)
def test_the_nadir_is_the_sum_of_the_air_before_the_sea(height):
    """The ray straight down, followed by Snell's law: its own light, and the share of the sea's that it lets through."""
    wanted = scenario(height)
    seen = mean(wanted).isel(x=1, y=1)
    sums, weights, nu = sums_of(scenario_physics.standing_view(wanted, height))
    down = sums.along(height, math.pi)
    assert down.ray.height[-1] == 0.0
    assert float(seen.path_radiance) == pytest.approx(float(down.emitted @ weights), rel=2e-4)
    sea = float((down.transmittance[-1] * planck_wavenumber(nu, SEA)) @ weights)
    # what water lacks of a black body straight down it mirrors of the sky
    assert 0.985 * sea < float(seen.emitted_radiance) < 0.995 * sea
    assert float(seen.sky_radiance) < 0.01 * sea


@pytest.mark.parametrize("height", HEIGHTS)
def test_a_slanting_ray_meets_the_sea_where_the_triangle_says(height):
    """Law of cosines about the centre of the effective Earth, 35 deg below the horizontal: the length of the path."""
    wanted = scenario(height, -35.0)
    seen = mean(wanted).isel(x=1, y=1)
    radius, down = EFFECTIVE_EARTH_RADIUS, math.radians(35.0)
    slant = (radius + height) * math.sin(down) - math.sqrt(radius**2 - ((radius + height) * math.cos(down)) ** 2)
    sums, weights, _ = sums_of(scenario_physics.standing_view(wanted, height))
    assert float(seen.path_radiance) == pytest.approx(float(sums.between(height, 0.0, slant)[1] @ weights), rel=2e-4)
    drawn = image(wanted, layers=["range"])
    assert float(drawn.range.mean()) == pytest.approx(slant, rel=1e-4)
    assert float(drawn.radiance.mean()) == pytest.approx(float(seen.radiance), rel=3e-3)


@pytest.mark.parametrize("height", HEIGHTS)
def test_the_suns_light_is_the_same_but_for_the_way_up(height):
    """Glint straight down, against that from 30 m: shares of sunlight that the air above lets through, times what water mirrors of it."""
    low, high = (mean(scenario(at)).isel(x=1, y=1) for at in (30.0, height))
    sums, weights, nu = sums_of(scenario_physics.standing_view(scenario(height), height))
    water = hale_querry_sea().index(nu)
    mirrored = np.abs((water - 1.0) / (water + 1.0)) ** 2  # at 15 deg as at 0
    light = sums.laws.source * sums.passed(0.0, math.radians(30.0)) * weights * mirrored
    below, above = (float((sums.along(at, math.pi).transmittance[-1] * light).sum()) for at in (30.0, height))
    assert float(high.glint_radiance / low.glint_radiance) == pytest.approx(above / below, rel=5e-3)


@pytest.mark.parametrize("height", HEIGHTS)
def test_cases_and_maps_agree(height, tmp_path):
    table = tmp_path / "cases.csv"
    table.write_text(
        "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,relative_azimuth_deg,sea_temperature_k,ifov_mrad\n"
        f"midlatitude-summer,7,{height},50,30,0,{SEA},0.1\n"
    )
    found = evaluate_mean(read_cases(table), parse_bands(["8-12"]))
    seen = mean(scenario(height, -50.0)).isel(x=1, y=1)
    assert float(found["apparent_temperature_K[8-12]"][0]) == pytest.approx(float(seen.apparent_temperature), abs=0.02)


def test_space_is_the_top_of_the_air(caplog):
    with caplog.at_level("WARNING", logger="seaglint.reports"):
        wanted = scenario("space")
    assert wanted.sensor.height_m == 100e3
    assert "100000 m" in caplog.text
    assert mean(wanted).radiance.values == pytest.approx(mean(scenario(100e3)).radiance.values)


def test_air_from_the_top_and_just_below_it_is_the_same():
    """Light of the air above 99 km does not count, so neither does where exactly the sensor is."""
    top, below = (mean(scenario(at)).isel(x=1, y=1) for at in (100e3, 99e3))
    assert float(top.path_radiance) == pytest.approx(float(below.path_radiance), rel=2e-4)
    assert np.isfinite(float(top.radiance))
