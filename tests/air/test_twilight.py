"""Twilight: closed forms of the Earth's shadow, rays followed one by one, published illuminance, and light that fades without a step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scattered_lines import HIGHEST_KM, Only, line_by_line, thin_air
from twilight_sums import twilight

from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.profile_scattering import maritime, scattered_cases, scattering_air
from seaglint.air.protocol import wavenumber_grid
from seaglint.air.scattering.scattered_light import scattered_path, scattered_shares
from seaglint.air.scattering.scattered_tables import ScatteredLight, scattered_in
from seaglint.air.scattering.scattering_laws import scattering_angle
from seaglint.air.scattering.twilight import LOWEST_SUN, fading, refined
from seaglint.base.constants import DARK_SUN
from seaglint.facet.sea_view import BandSum
from seaglint.formats.lowtran.deck import MODELS
from seaglint.optics.band import Band
from seaglint.studies.build.profile_air import model_air

BAND = Band.rectangular(3.5, 4.2)
RADIUS_KM, SCALE_KM = 6371.0, 8.0


def lowest_sunlit(arc, zenith, azimuth, sun):
    """Distances along a straight line from the sea at which it is above the Earth's shadow, on a grid [km], and heights there [km]."""
    s = np.linspace(0.0, arc, 200_001)
    point = np.stack([s * np.sin(zenith), 0.0 * s, RADIUS_KM + s * np.cos(zenith)])
    to_sun = np.array([np.sin(sun) * np.cos(azimuth), np.sin(sun) * np.sin(azimuth), np.cos(sun)])
    along = to_sun @ point
    miss = np.linalg.norm(point - to_sun[:, None] * along, axis=0)
    return s, np.linalg.norm(point, axis=0) - RADIUS_KM, (along > 0.0) | (miss > RADIUS_KM)


@pytest.mark.parametrize(("elevation", "azimuth"), [(90.0, 0.0), (30.0, 0.0), (30.0, 180.0), (10.0, 60.0), (4.0, 180.0), (1.0, 0.0)])
@pytest.mark.parametrize("depression", [1.0, 3.0, 5.5])
def test_thin_air_scatters_from_above_the_shadow(depression, elevation, azimuth):
    """Air that neither attenuates nor bends: its amount on the line above a cylinder of the Earth's radius.

    The program's disc is averaged over its limbs here by Suns on a grid; 3 % of what the line would scatter by day, and of itself.
    """
    zenith, side, sun = np.radians([90.0 - elevation, azimuth, 90.0 + depression])
    air = thin_air(1e-9, 199, 99.0)
    found = air.amplitudes(0.0, np.array([[zenith, side, sun]]))[0][0, -1, 0] / 1e-9
    x = np.linspace(-0.97, 0.97, 15)
    weight = np.sqrt(1.0 - x * x)
    wanted = 0.0
    for offset, w in zip(x * 4.65e-3, weight / weight.sum(), strict=True):
        s, z, lit = lowest_sunlit(3000.0 if elevation < 5.0 else 700.0, zenith, side, sun + offset)
        wanted += w * np.trapezoid(np.where(lit & (z < HIGHEST_KM), np.exp(-z / SCALE_KM) / SCALE_KM, 0.0), s)
    assert found == pytest.approx(wanted, rel=0.04, abs=1e-5)
    if elevation == 90.0:  # overhead the shadow is R (1/cos - 1) high
        assert wanted == pytest.approx(math.exp(-RADIUS_KM * (1.0 / math.cos(math.radians(depression)) - 1.0) / SCALE_KM), rel=0.4)


def both(number):
    """Radiance of a random line of sight by the program, and by rays that NumPy follows [W m-2 sr-1 per cm-1]."""
    random = np.random.default_rng([68, number])
    low = [3.9, 2.2, 4.6, 3.5][number % 4]
    air = scattering_air(
        model_profile(list(MODELS)[number % 6]),
        maritime(float(random.uniform(0.5, 18.0))),
        wavenumber_grid(low, low + [0.05, 0.016, 0.06, 0.04][number % 4]),
        continuous=True,
    )
    height = float(np.exp(random.uniform(np.log(2.0), np.log(9000.0))))
    apparent = math.radians(90.0 + float(random.uniform(1.0, 5.0)))
    sun = air.unrefracted_zenith(apparent)
    # above the shadow away from the Sun, else anywhere
    azimuth = float(random.uniform(0.0, np.pi))
    least = 2.0 if azimuth < 1.0 else 2.0 * (math.degrees(apparent) - 90.0)
    zenith = 0.5 * np.pi - math.radians(float(np.exp(random.uniform(np.log(least), np.log(80.0)))))
    angle = scattering_angle(zenith, azimuth, float(air.apparent_zenith(sun, height)))
    amplitude = air.amplitudes(height, np.array([[zenith, azimuth, sun]]))[0][0]
    found = float((air.source * (air.phase(angle) * amplitude).sum(axis=0)).sum())
    return found, float(twilight(air, 1e-3 * height, (zenith, azimuth, sun), angle, strips=3, fine=0.3).sum())


@pytest.mark.parametrize("number", [0, *(pytest.param(n, marks=pytest.mark.validation) for n in range(1, 24))])
def test_lines_are_those_of_rays_followed_one_by_one(number):
    found, wanted = both(number)
    assert wanted > 0.0
    assert found == pytest.approx(wanted, rel=0.1)  # 12 of them: 0.2 to 7 % too dark, as the disc is one ray


@pytest.mark.parametrize("continuous", [True, False])
@pytest.mark.parametrize("line", [(30.0, 0.02, 0.0), (30.0, 0.1, 0.0), (30.0, 0.5, 1.6), (30.0, 0.35, np.pi), (3000.0, -0.01, 0.2)])
def test_light_fades_without_a_step_or_a_rise(line, continuous):
    """Every 0.05 deg from a Sun 1 deg up to 6.7 deg without refraction: down, by a fifth at most, and to nothing."""
    zenith = np.radians(np.arange(89.0, 96.9, 0.05))
    lines = np.array([(7.0, *line, z) for z in zenith])
    seen = scattered_cases("midlatitude-summer", lines, [BAND], continuous=continuous)[0]
    assert seen[0] > 1e-5
    assert seen[-1] == 0.0
    assert np.all(np.diff(seen) <= 0.0)
    before_the_end = seen[zenith < np.radians(95.4)]
    lit = before_the_end[:-1] > 1e-6 * seen[0]
    fall = -np.diff(np.log(np.maximum(before_the_end, 1e-30)))[lit]
    assert fall.max() < 0.2
    # no kink where the disc touches the horizon, at 90.3 deg: the rate of the fall changes by little between neighbours
    assert np.abs(np.diff(fall)).max() < 0.05


@pytest.mark.parametrize("model", list(MODELS))
def test_by_day_nothing_of_it_is_used(model):
    """A Sun on the horizon is nowhere as low, without refraction, as the first whose rays are iterated."""
    air = scattering_air(model_profile(model), maritime(7.0), wavenumber_grid(3.9, 4.0), continuous=True)
    assert refined(air.unrefracted_zenith(LOWEST_SUN)) == 0.0
    assert fading(LOWEST_SUN) == 1.0


@pytest.fixture(scope="module")
def air():
    table = model_air("midlatitude-summer", 7.0, (3.5, 4.2))
    return table.scattering(BandSum.of(BAND, table).grid)


@pytest.mark.parametrize(
    ("height", "depression", "turn"),
    [
        (30.0, 0.1, 0.005),
        *(pytest.param(*p, marks=pytest.mark.validation) for p in ((30.0, 1.0, 0.005), (900.0, 2.5, 0.02), (9000.0, 4.0, 0.06))),
    ],
)
def test_tables_are_the_lines(air, height, depression, turn):
    """Path, sky, and sky over places that have a higher and a lower Sun: typically 1 %, the worst near the shadow's edge."""
    weights, sun = BAND.weights(air.wavenumber_cm), math.radians(90.0 + depression)
    light = ScatteredLight(air, weights, height, sun, turn)
    rng = np.random.default_rng(5)
    azimuth, elevation = np.pi * rng.random(40) ** 2, 0.5 * np.pi * rng.random(40) ** 3
    for place, table in ((None, light.sky), (sun, light.sea_sky), (sun - 0.8 * turn, light.sea_sky), (sun + 0.7 * turn, light.sea_sky)):
        at = sun if place is None else place
        direct, _ = line_by_line(air, weights, height if place is None else 0.0, elevation, azimuth, at)
        direct = fading(at) * direct
        sums = np.ones(1) if place is None else table.spectral @ weights
        found = scattered_shares(elevation, azimuth, table, place) @ sums
        if not direct.any():  # a place whose Sun is more than 6 degrees below its horizon
            assert np.abs(found).max() < 1e-9
            continue
        bright = direct > 1e-3 * direct.max()
        off = np.abs(found / np.where(bright, direct, 1.0) - 1.0)[bright]
        assert np.median(off) < 0.02
        assert np.quantile(off, 0.9) < 0.1
        assert np.abs(found - direct).max() < 0.2 * direct.max()
    down = -np.radians([4.0, 10.0, 30.0])
    direct, arc = line_by_line(air, weights, height, down, 0.3, sun)
    found = scattered_path(arc * 1e3 * air.laws.earth_radius, down, 0.3, light.path)
    np.testing.assert_allclose(found, direct, rtol=0.05, atol=1e-9)


@pytest.mark.validation
def test_tables_join_those_of_the_day(air):
    """A Sun that touches the horizon of the farthest place, just before and after: no step in path, sky or mirrored sky."""
    weights, turn = BAND.weights(air.wavenumber_cm), 0.004
    elevation, azimuth = np.radians([0.5, 5.0, 30.0])[:, None], np.radians([0.0, 20.0, 90.0, 170.0])
    for first, table in ((LOWEST_SUN - turn, "sea_sky"), (LOWEST_SUN, "sky")):
        sides = []
        for sun in (first - 1e-6, first + 1e-6):
            light = ScatteredLight(air, weights, 30.0, sun, turn)
            t = getattr(light, table)
            sides.append(scattered_shares(elevation, azimuth, t, first) @ (t.spectral @ weights if table == "sea_sky" else np.ones(1)))
        # the horizon opposite to the Sun, a thousandth as bright, differs by 7 %
        np.testing.assert_allclose(sides[1], sides[0], rtol=0.02, atol=1e-4 * sides[0].max())


def test_six_degrees_below_the_horizon_nothing_is_scattered(air):
    weights = BAND.weights(air.wavenumber_cm)
    night = scattered_in(Only(air), slice(None), weights, 30.0, DARK_SUN + 0.006, 0.005)
    assert night.is_dark
    # a place towards the Sun has twilight still, the sensor's own sky has none
    edge = ScatteredLight(air, weights, 30.0, DARK_SUN + 0.001, 0.005)
    assert not edge.sky.amplitude.any()
    assert not edge.path.amplitude.any()
    assert edge.sea_sky.amplitude.any()


@pytest.mark.validation
def test_illuminance_falls_as_published():
    """Civil twilight takes a level plane from 585-410 lx to 3.5-2 lx (AMS Glossary of Meteorology), by a factor of 117 to 290.

    Sunlight scattered once at 0.7-0.75 um, where molecules scatter as much as haze does at 3.5 um, from 0 to 6 deg without refraction; the
    fading of the last degree is divided out.
    """
    band = Band.rectangular(0.70, 0.75)
    x, w = np.polynomial.legendre.leggauss(10)
    sine = 0.5 * (1.0 + x)
    azimuth = np.radians([4.0, 15.0, 35.0, 60.0, 90.0, 120.0, 150.0, 175.0])
    share = np.gradient(azimuth)
    plane = []
    for depression in (0.0, 5.9):
        lines = np.array([(3.0, 2.0, math.asin(s), a, math.radians(90.0 + depression)) for s in sine for a in azimuth])
        radiance = scattered_cases("us-standard-1976", lines, [band])[0].reshape(sine.size, -1)
        plane.append(float((0.5 * w * sine) @ radiance @ share))
    ratio = plane[0] / plane[1] * fading(math.radians(95.3))
    assert 100.0 < ratio < 290.0  # 157
