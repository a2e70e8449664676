"""The Sun against the vertical of each place, against vectors in one frame for the whole Earth."""

import numpy as np
import pytest
from shadowing_laws import saunders

from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import surface_range, view_zenith
from seaglint.base.errors import DomainError
from seaglint.facet.glint import glint
from seaglint.facet.legs import VIEWER, Shadowing
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import solar_zenith_at
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.article import article_radiance
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

LINE = 2500.0
WATER = sea_water.hale_querry_sea()


class HazySun(VacuumAtmosphere):
    """Clear paths under haze: sunlight that falls with the way through a flat layer."""

    def solar_irradiance(self, solar_zenith):
        up = np.cos(np.asarray(solar_zenith, dtype=float))[..., None]
        return super().solar_irradiance(solar_zenith) * np.exp(-0.1 / np.maximum(up, 1e-3))


AIR = HazySun.for_band(3.0, 5.0)


def _view(slopes, height, zenith, azimuth=0.0, **changes):
    inputs = {
        "atmosphere": AIR,
        "band": Band.rectangular(1e4 / (LINE + 0.5), 1e4 / (LINE - 0.5)),
        "water": WATER,
        "slopes": slopes,
        "sea_temperature": 288.15,
        "sensor_height": height,
        "solar_zenith": np.radians(zenith),
        "solar_azimuth": np.radians(azimuth),
        "shadowing": VIEWER,
    }
    return SeaView(**(inputs | changes))


def _mirrored(view, depression, azimuth):
    """Mirrored Sun [W m-2 sr-1] by the point formula (Eq. 8), place by place, and the facet's slope in rms slopes.

    x, y, z: east, north and up at the sensor's foot, for view, Sun and normals alike.
    """
    out = np.array([np.sin(azimuth), np.cos(azimuth), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    # where the straight ray meets the effective Earth
    eye, ray = (EFFECTIVE_EARTH_RADIUS + view.sensor_height) * up, np.cos(depression) * out - np.sin(depression) * up
    b = eye @ ray
    place = eye + (-b - np.sqrt(b * b - eye @ eye + EFFECTIVE_EARTH_RADIUS**2)) * ray
    normal = place / EFFECTIVE_EARTH_RADIUS
    theta = np.arccos(-ray @ normal)
    # the same arc on the Earth itself
    psi = EFFECTIVE_EARTH_RADIUS * np.arctan2(normal @ out, normal @ up) / EARTH_RADIUS
    zenith, onward = np.cos(psi) * up + np.sin(psi) * out, np.cos(psi) * out - np.sin(psi) * up
    aside = np.cross(out, up)
    v = np.cos(theta) * zenith - np.sin(theta) * onward
    z, a = view.solar_zenith, view.solar_azimuth
    sun = np.array([np.sin(z) * np.sin(a), np.sin(z) * np.cos(a), np.cos(z)])
    facet = (v + sun) / np.linalg.norm(v + sun)
    cos_beta, cos_w = facet @ zenith, facet @ v
    slope = -(facet @ onward * out + facet @ aside * aside) / cos_beta
    slopes = view.slopes
    w = slopes.wind_to_azimuth
    along, cross = slope @ [np.sin(w), np.cos(w), 0.0], slope @ [np.cos(w), -np.sin(w), 0.0]
    q = along**2 / slopes.mss_up + cross**2 / slopes.mss_cross
    p = np.exp(-0.5 * q) / (2.0 * np.pi * np.sqrt(slopes.mss_up * slopes.mss_cross))
    seen = saunders(theta, slopes.mss_along(azimuth + np.pi))
    e = np.interp(LINE, AIR.wavenumber_cm, AIR.solar_irradiance(float(np.arccos(sun @ zenith))))
    rho = reflectance(cos_w, WATER.index(LINE))
    return float(rho * e * p * seen / (4.0 * cos_beta**4 * np.cos(theta))), np.sqrt(q)


@pytest.mark.parametrize("sun", [30.0, 45.0, 60.0, 75.0, 85.0])
@pytest.mark.parametrize(("height", "depressions"), [(10_000.0, [3.5, 4.0, 6.0, 12.0, 30.0, 60.0]), (900.0, [1.2, 2.0, 4.0, 12.0, 45.0])])
def test_mirrored_sun_is_that_of_each_places_own_sun(height, depressions, sun):
    view = _view(cox_munk_anisotropic(15.0, 0.4), height, sun, 70.0)
    azimuth = np.radians(70.0 + np.array([0.0, 10.0, -40.0, 90.0, -140.0, 180.0]))
    found = mean_radiance(view, -np.radians(depressions), azimuth).sun
    compared = []
    for row, depression in zip(found, np.radians(depressions), strict=True):
        for got, a in zip(row, azimuth, strict=True):
            expected, deviations = _mirrored(view, depression, a)
            # the disc's width counts in the far tails, and no point formula has it
            if deviations < 4.0:
                compared.append(a)
                assert got == pytest.approx(expected, rel=0.01)
    assert len(compared) >= 7
    assert len(set(compared)) >= (6 if sun == 30.0 else 2)


def test_one_sun_for_all_places_would_be_far_off():
    """The size of what is at stake at 4 deg from 10 km."""
    view = _view(cox_munk_anisotropic(10.0, 0.4), 10_000.0, 60.0)
    theta, arc = view_zenith(10_000.0, np.radians(4.0)), surface_range(10_000.0, np.radians(4.0))
    here = float(glint(theta, np.pi, view.solar_zenith, 0.0, view.slopes, VIEWER, arc / EARTH_RADIUS).chance)
    foot = float(glint(theta, np.pi, view.solar_zenith, 0.0, view.slopes, VIEWER).chance)
    assert abs(here / foot - 1.0) > 0.05


@pytest.mark.parametrize("law", ["nested", "both"])
@pytest.mark.parametrize("zenith", [60.0, 80.0, 87.0, 89.9])
@pytest.mark.parametrize("slopes", [cox_munk_anisotropic(8.0, 0.4), cox_munk_gram_charlier(8.0, 0.4)], ids=["gaussian", "skewed"])
@pytest.mark.parametrize("away", [0.0, np.pi])
def test_towards_the_sun_and_away_from_it_the_place_has_the_sun_of_another_zenith(law, zenith, slopes, away):
    """In the Sun's vertical plane the azimuth stays: shadows of the Sun's leg, and a disc cut by the horizon, are those of that zenith."""
    theta, z, psi = np.radians(80.0), np.radians(zenith), 0.03
    shadowing = Shadowing.of(law)
    turned = float(glint(theta, np.pi + away, z, 0.0, slopes, shadowing, psi).chance)
    plain = float(glint(theta, np.pi + away, z - psi * np.cos(away), 0.0, slopes, shadowing).chance)
    # the area of skewed slopes is changed as that of Gaussian ones: 2 % where the Sun stands at the horizon
    assert turned == pytest.approx(plain, rel=1e-4 if slopes.is_gaussian else 0.03, abs=1e-12)


def test_a_sun_below_the_horizon_at_the_foot_may_be_up_towards_it():
    view = _view(SlopeStatistics(0.03, 0.03), 10_000.0, 91.0)
    depression = np.radians([3.2, 3.5, 5.0, 20.0])
    found = mean_radiance(view, -depression, [0.0, np.pi])
    psi = surface_range(10_000.0, depression) / EARTH_RADIUS
    theta = view_zenith(10_000.0, depression)
    zenith = view.solar_zenith - psi
    expected = np.array([float(glint(t, np.pi, z, 0.0, view.slopes, VIEWER).chance) for t, z in zip(theta, zenith, strict=True)])
    assert expected[0] > 0.0
    np.testing.assert_allclose(found.chance[:, 0], expected, rtol=1e-6)
    assert not found.chance[3:, 0].any()
    assert not found.chance[:, 1].any()
    rho = reflectance(found.cos_incidence[0, 0], WATER.index(LINE))
    irradiance = np.interp(LINE, AIR.wavenumber_cm, AIR.solar_irradiance(zenith[0]))
    shown = float(rho * irradiance * expected[0] / (np.pi * SOLAR_ANGULAR_RADIUS**2))
    assert found.sun[0, 0] == pytest.approx(shown, rel=5e-3)  # sunlight in steps of the table


def test_the_articles_mode_has_each_places_sun_too():
    view = _view(cox_munk_anisotropic(10.0, 0.4), 5000.0, 65.0, band=Band.rectangular(3.9, 4.0))
    elevation, azimuth = -np.radians([2.6, 4.0, 20.0]), np.radians([0.0, 15.0])
    means, integral = article_radiance(view, elevation, azimuth), mean_radiance(view, elevation, azimuth)
    np.testing.assert_allclose(means.chance, integral.chance, rtol=1e-6)
    np.testing.assert_allclose(means.sun, integral.sun, rtol=3e-3)


def test_zenith_angle_at_a_place_by_vectors():
    psi, a, z = 0.05, 1.1, 0.9
    up = np.array([np.sin(psi), 0.0, np.cos(psi)])
    sun = np.array([np.sin(z) * np.cos(a), np.sin(z) * np.sin(a), np.cos(z)])
    assert float(solar_zenith_at(z, a, psi)) == pytest.approx(np.arccos(up @ sun), abs=1e-12)


def test_an_atmosphere_with_few_suns_serves_the_nearest():
    class FewSuns(VacuumAtmosphere):
        def solar_irradiance(self, solar_zenith):
            zenith = np.asarray(solar_zenith, dtype=float)
            if np.any(np.abs(zenith - 1.0) > 0.0101):
                raise DomainError("no sunlight there", name="solar_zenith", value=float(zenith.ravel()[0]), allowed=(0.99, 1.01))
            return super().solar_irradiance(zenith)

    view = _view(cox_munk_anisotropic(10.0, 0.4), 10_000.0, np.degrees(1.0), atmosphere=FewSuns.for_band(3.0, 5.0))
    assert mean_radiance(view, [-np.radians(4.0)], [0.0]).sun[0, 0] > 0.0
    with pytest.raises(DomainError, match="no sunlight there"):
        mean_radiance(_view(view.slopes, 10_000.0, 40.0, atmosphere=view.atmosphere), [-np.radians(4.0)], [0.0])
