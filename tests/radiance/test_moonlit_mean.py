"""Mirrored moonlight beside a sum over the points of the lit disc, the slope density, Fresnel's equations and the air, made here."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.conventions import surface_range, view_zenith
from seaglint.base.errors import DomainError
from seaglint.facet.legs import NESTED, VIEWER
from seaglint.facet.sea_view import LightDisc, Moonlight, SeaView
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.optics.moonlight import moon_radius, moon_to_sun
from seaglint.radiance.mean_radiance import MeanModel, mean_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import flat
from seaglint.studies.build.profile_air import model_air

HEIGHT = 20.0
BANDS = {"3.5-5": (3.5, 5.0), "8-12": (8.0, 12.0)}
SUN_DOWN = 2.2  #: Zenith angle of a Sun that is down everywhere [rad].


def moonlight(zenith_deg, azimuth_deg, phase_deg, limb_deg=0.0, distance_m=3.844e8):
    """A Moon from its angles in degrees."""
    phase = np.radians(phase_deg)
    ratio = partial(moon_to_sun, phase=phase, distance_m=distance_m)
    return Moonlight(
        np.radians(zenith_deg), np.radians(azimuth_deg), LightDisc(moon_radius(distance_m), ratio, phase, np.radians(limb_deg))
    )


def view_of(edges, slopes, moon, solar_zenith=SUN_DOWN, shadowing=VIEWER, air=None, **changes):
    inputs = {
        "atmosphere": model_air("midlatitude-summer", 5.0, edges) if air is None else air,
        "band": Band.rectangular(*edges),
        "water": sea_water.hale_querry_sea(),
        "slopes": slopes,
        "sea_temperature": 288.15,
        "sensor_height": HEIGHT,
        "solar_zenith": solar_zenith,
        "shadowing": shadowing,
        "moon": moon,
    }
    return SeaView(**(inputs | changes))


def fresnel(cosine, index):
    """Reflectance of unpolarised light, by the complex index."""
    inside = np.sqrt(index**2 - 1.0 + cosine**2 + 0j)
    across, along = (cosine - inside) / (cosine + inside), (index**2 * cosine - inside) / (index**2 * cosine + inside)
    return 0.5 * (np.abs(across) ** 2 + np.abs(along) ** 2)


def lit_points(moon, n=61):
    """Directions of the lit points of the disc (east, north, up), and their solid angle [sr]."""
    disc = moon.disc
    x, y = np.meshgrid(*2 * [(np.arange(n) + 0.5) / n * 2.0 - 1.0])
    right, up = np.sin(disc.bright_limb), np.cos(disc.bright_limb)
    towards, across = x * right + y * up, x * up - y * right
    inside = (x**2 + y**2 < 1.0) & (towards > -np.cos(disc.phase) * np.sqrt(np.maximum(1.0 - across**2, 0.0)))
    x, y = disc.radius * x[inside], disc.radius * y[inside]
    sz, cz, sa, ca = np.sin(moon.zenith), np.cos(moon.zenith), np.sin(moon.azimuth), np.cos(moon.azimuth)
    points = np.stack([sz * sa + x * ca - y * cz * sa, sz * ca - x * sa - y * cz * ca, cz + y * sz])
    return points / np.linalg.norm(points, axis=0), np.full(x.size, np.pi * disc.radius**2 * 0.5 * (1.0 + np.cos(disc.phase)) / x.size)


def own_glint(view, moon, depression, azimuth):
    """Mirrored moonlight of one line of sight [W m-2 sr-1], with the viewer's leg in Smith's shadow."""
    nu = view.atmosphere.wavenumber_cm
    theta, arc = float(view_zenith(HEIGHT, depression)), float(surface_range(HEIGHT, depression))
    v = np.array([-np.sin(theta) * np.sin(azimuth), -np.sin(theta) * np.cos(azimuth), np.cos(theta)])
    points, solid = lit_points(moon)
    both = v[:, None] + points
    slope = -both[:2] / both[2]
    # the waves' own axes: towards where the wind blows, and across
    to = view.slopes.wind_to_azimuth
    axes = np.array([[np.sin(to), np.cos(to)], [np.cos(to), -np.sin(to)]])
    mss = np.array([view.slopes.mss_up, view.slopes.mss_cross])
    along = axes @ slope
    density = np.exp(-0.5 * np.sum(along**2 / mss[:, None], axis=0)) / (2.0 * np.pi * np.sqrt(mss.prod()))
    # visible area of Gaussian slopes, by their own integral along the line of sight
    sigma = np.sqrt(np.sum(mss * (axes @ v[:2] / np.sin(theta)) ** 2))
    s = np.linspace(-8.0, 8.0, 20001) * sigma
    weight = np.exp(-0.5 * (s / sigma) ** 2) / (np.sqrt(2.0 * np.pi) * sigma) * np.maximum(np.cos(theta) - np.sin(theta) * s, 0.0)
    area = np.trapezoid(weight, s)
    share = density * (1.0 + np.sum(slope**2, axis=0)) ** 2 / (4.0 * area) * solid
    rho = fresnel(np.sqrt(0.5 * (1.0 + v @ points))[:, None], view.water.index(nu))
    # sunlight changes over the disc as the zenith angle of its points
    ends = moon.zenith + moon.disc.radius * np.array([-1.0, 1.0])
    low, high = view.atmosphere.solar_irradiance(ends)
    part = ((np.arccos(points[2]) - ends[0]) / (ends[1] - ends[0]))[:, None]
    light = share @ (rho * (low + part * (high - low))) * moon.disc.ratio(nu) / solid.sum()
    return float((view.atmosphere.transmittance(HEIGHT, arc) * light) @ view.band.weights(nu))


def drawn(seed):
    """A random case: band, wind, Moon and line of sight."""
    rng = np.random.default_rng(seed)
    wind, height = rng.uniform(1.0, 12.0), rng.uniform(12.0, 70.0)
    moon = moonlight(90.0 - height, rng.uniform(0.0, 360.0), rng.uniform(0.0, 120.0), rng.uniform(0.0, 360.0), rng.uniform(3.56e8, 4.07e8))
    slopes = cox_munk_isotropic(wind) if seed % 2 else cox_munk_anisotropic(wind, rng.uniform(0.0, 6.0))
    band = list(BANDS.values())[seed % 3 % 2]
    return (
        band,
        slopes,
        moon,
        np.radians(height * min(rng.uniform(0.6, 1.4), 85.0 / height)),
        moon.azimuth + np.radians(rng.uniform(-12.0, 12.0)),
    )


@pytest.mark.parametrize("seed", range(12))
def test_mirrored_moonlight_is_the_sum_over_disc_and_slopes(seed):
    edges, slopes, moon, depression, azimuth = drawn(seed)
    view = view_of(edges, slopes, moon)
    assert mean_radiance(view, [-depression], [azimuth]).sun[0, 0] == pytest.approx(own_glint(view, moon, depression, azimuth), rel=5e-3)


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("phase_deg", [0.0, 45.0, 90.0, 120.0])
@pytest.mark.parametrize("wind", [1.0, 12.0])
@pytest.mark.parametrize("height_deg", [12.0, 35.0])
def test_the_corridor_of_every_phase_is_the_sum(band, phase_deg, wind, height_deg):
    moon = moonlight(90.0 - height_deg, 40.0, phase_deg, 60.0)
    view = view_of(BANDS[band], cox_munk_isotropic(wind), moon)
    # three degrees aside, the light of a low Moon on a sea of 1 m/s is two standard deviations of the slopes from the corridor's middle
    depression, azimuth = np.radians(0.8 * height_deg), moon.azimuth + 0.05
    assert mean_radiance(view, [-depression], [azimuth]).sun[0, 0] == pytest.approx(own_glint(view, moon, depression, azimuth), rel=5e-3)


ROWS, COLUMNS = -np.radians([0.7, 3.0, 10.0, 40.0]), np.radians([20.0, 40.0, 60.0])


@pytest.mark.parametrize("many", [False, True], ids=["few rows", "interpolated"])
def test_sun_and_moon_add_up(many):
    moon, slopes = moonlight(75.0, 40.0, 60.0), cox_munk_isotropic(6.0)
    both = view_of(BANDS["8-12"], slopes, moon, 1.2, NESTED)
    sun, night = replace(both, moon=None), replace(both, solar_zenith=SUN_DOWN)

    def radiance(view):
        return MeanModel.prepare(view).map(ROWS, COLUMNS) if many else mean_radiance(view, ROWS, COLUMNS)

    # the number of bands of the nested law differs with the azimuth of the light: the same light twice
    of_both, of_sun, of_night = radiance(both), radiance(sun), radiance(night)
    np.testing.assert_allclose(of_both.sun, of_sun.sun + of_night.sun, rtol=1e-12)
    for name in ("path", "emission", "sky"):
        np.testing.assert_array_equal(getattr(of_both, name), getattr(of_sun, name))
    variances = [sea_variance(view, light, ROWS, 1e-7, 0.0026) for view, light in ((both, of_both), (sun, of_sun), (night, of_night))]
    np.testing.assert_allclose(variances[0], variances[1] + variances[2], rtol=1e-9)


def test_a_thin_light_fluctuates_more():
    """Of two Moons with one irradiance the half one has half the chance that a point mirrors it."""
    full = moonlight(60.0, 0.0, 0.0)
    half = replace(full, disc=replace(full.disc, phase=0.5 * np.pi))
    views = [view_of(BANDS["8-12"], cox_munk_isotropic(4.0), moon) for moon in (full, half)]
    spreads = []
    for view in views:
        light = mean_radiance(view, [-0.5], [0.0])
        spreads.append((sea_variance(view, light, [-0.5], 1e-12, 0.01) / light.sun**2).item())
    # (1 - P)/P of points, P far below 1
    assert spreads[1] / spreads[0] == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize(("zenith_deg", "lit"), [(89.0, True), (91.0, False)])
def test_a_moon_below_the_horizon_gives_no_light(zenith_deg, lit):
    view = view_of(BANDS["3.5-5"], cox_munk_isotropic(6.0), moonlight(zenith_deg, 0.0, 10.0))
    assert np.any(mean_radiance(view, ROWS, [0.0]).sun > 0.0) == lit
    assert (view.lights[0].disc.ratio is not None) == lit


def test_a_mirror_sea_has_all_moonlight():
    """The pixels of the mirrored disc have the Moon's irradiance times the reflectance."""
    air = VacuumAtmosphere.for_band(3.5, 5.0)
    moon = moonlight(70.0, 0.0, 0.0, distance_m=3.6e8)
    view = view_of((3.5, 5.0), flat(), moon, air=air, sensor_height=2.0)
    rows, columns = -np.radians(np.linspace(19.6, 20.4, 161)), np.radians(np.linspace(-0.45, 0.45, 161))
    light = mean_radiance(view, rows, columns).sun
    solid = np.radians(0.8 / 160) * np.radians(0.9 / 160) * np.cos(rows)[:, None]
    nu = air.wavenumber_cm
    rho = fresnel(np.cos(moon.zenith), view.water.index(nu))
    expected = float((rho * air.solar_irradiance(moon.zenith) * moon.disc.ratio(nu)) @ view.band.weights(nu))
    assert (light * solid).sum() == pytest.approx(expected, rel=0.01)  # pixels of 0.005 deg at the limb


def test_air_of_one_sun_refuses_a_moon_elsewhere():
    class OneSun(VacuumAtmosphere):
        def solar_irradiance(self, solar_zenith):
            if np.any(np.abs(np.asarray(solar_zenith) - 0.5) > 0.1):
                raise DomainError("solar zenith is not that of the samples", name="solar_zenith", value=0.0, allowed=(0.4, 0.6))
            return super().solar_irradiance(solar_zenith)

    view = view_of((3.5, 5.0), cox_munk_isotropic(6.0), moonlight(60.0, 0.0, 0.0), 0.5, air=OneSun.for_band(3.5, 5.0))
    with pytest.raises(DomainError, match="Moon"):
        mean_radiance(view, ROWS, [0.0])
