import numpy as np
import pytest

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import horizon_depression, surface_range, view_zenith
from seaglint.base.errors import DomainError
from seaglint.facet.emissivity import facet_nodes
from seaglint.facet.glint import glint
from seaglint.facet.legs import Shadowing
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import turn_at
from seaglint.optics import sea_water
from seaglint.optics.band import Band, apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.mean_radiance import MeanModel, mean_radiance
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.slopes.slope_statistics import flat

BAND = Band.rectangular(3.0, 5.0)
SEAS = {
    "flat": flat(),
    "calm": cox_munk_isotropic(0.0),
    "10 m/s": cox_munk_isotropic(10.0),
    "20 m/s": cox_munk_isotropic(19.0),
    "directional": cox_munk_anisotropic(10.0, 0.4),
    "skewed": cox_munk_gram_charlier(10.0, 0.4),
    "slick": cox_munk_slick(6.0, 0.4),
    "breon-henriot": breon_henriot(10.0, 0.4),
}


class WarmSky(VacuumAtmosphere):
    """No air, a sky whose temperature falls towards the zenith."""

    def sky_radiance(self, zenith, azimuth, height=0.0):
        temperature = 200.0 + 80.0 * np.sin(np.asarray(zenith, dtype=float)) ** 4
        return planck_wavenumber(self.wavenumber_cm, temperature[..., None])


def _view(atmosphere, slopes, **changes):
    inputs = {
        "atmosphere": atmosphere,
        "band": BAND,
        "water": sea_water.hale_querry_sea(),
        "slopes": slopes,
        "sea_temperature": 288.15,
        "sensor_height": 30.0,
        "solar_zenith": np.radians(70.0),
    }
    return SeaView(**(inputs | changes))


@pytest.mark.parametrize("slopes", SEAS.values(), ids=SEAS.keys())
@pytest.mark.parametrize("height", [2.0, 3000.0, pytest.param(100.0, marks=pytest.mark.validation)])
def test_white_furnace_is_flat_from_sky_to_nadir(slopes, height):
    view = _view(IsothermalAtmosphere.for_band(288.15, 3.0, 5.0), slopes, sensor_height=height)
    horizon = horizon_depression(height)
    elevation = np.concatenate([[0.3, 0.0], -horizon - np.array([-1e-6, 1e-7, 1e-5, 1e-3]), -np.radians(np.linspace(2.0, 90.0, 150))])
    total = mean_radiance(view, elevation, np.radians([-40.0, 0.0, 25.0])).total
    np.testing.assert_allclose(total, BAND.radiance(288.15, view.atmosphere.wavenumber_cm), rtol=1e-10)  # weights add to 1: rounding only


@pytest.mark.parametrize("depression", [0.5, 2.0, 10.0, 45.0, 90.0])
def test_flat_sea_is_fresnel_times_sky_plus_emission(depression):
    atmosphere = WarmSky.for_band(3.0, 5.0)
    got = mean_radiance(_view(atmosphere, flat(), solar_zenith=2.0), [-np.radians(depression)], [0.0])
    theta = view_zenith(30.0, np.radians(depression))
    nu = atmosphere.wavenumber_cm
    rho = reflectance(np.cos(theta), sea_water.hale_querry_sea().index(nu))
    expected = BAND.weights(nu) @ (rho * atmosphere.sky_radiance(theta, 0.0) + (1.0 - rho) * planck_wavenumber(nu, 288.15))
    assert got.total == pytest.approx(expected, rel=1e-6)  # series of the reflectance: 2e-8 of grazing light
    assert np.all(got.sun == 0.0)


@pytest.mark.parametrize("depression", [5.0, 30.0, 70.0])
@pytest.mark.parametrize("azimuth", [0.0, 20.0])
def test_sun_in_a_line_of_spectrum_is_eq_8(depression, azimuth):
    """One narrow line, no air: sun = rho E x chance / (pi eps^2) with the numbers put in by hand."""
    atmosphere = VacuumAtmosphere.for_band(3.0, 5.0)
    line = Band.rectangular(1e4 / 2500.5, 1e4 / 2499.5)
    slopes = cox_munk_isotropic(10.0)
    view = _view(atmosphere, slopes, band=line, sun_distance_factor=1.03)
    d, a = np.radians(depression), np.radians(azimuth)
    theta = float(view_zenith(30.0, d))
    cos2w = np.cos(theta) * np.cos(view.solar_zenith) - np.sin(theta) * np.sin(view.solar_zenith) * np.cos(a)
    g = glint(theta, a + np.pi, view.solar_zenith, 0.0, slopes, turn=turn_at(surface_range(30.0, d)))
    cos_w = np.sqrt(0.5 * (1.0 + cos2w))
    rho = reflectance(cos_w, sea_water.hale_querry_sea().index(2500.0))
    irradiance = 1.03 * np.interp(2500.0, atmosphere.wavenumber_cm, atmosphere.solar_irradiance(view.solar_zenith))
    expected = float(rho * irradiance * g.chance / (np.pi * SOLAR_ANGULAR_RADIUS**2))
    assert mean_radiance(view, [-d], [a]).sun[0, 0] == pytest.approx(expected, rel=1e-3)  # the line is 1 cm-1 wide on a 5 cm-1 grid


def test_mirrored_sun_of_a_flat_sea_has_the_suns_own_radiance_times_rho():
    atmosphere = VacuumAtmosphere.for_band(3.0, 5.0)
    view = _view(atmosphere, flat(), sensor_height=10.0, solar_zenith=float(view_zenith(10.0, np.radians(30.0))))
    nu = atmosphere.wavenumber_cm
    rho = reflectance(np.cos(view.solar_zenith), sea_water.hale_querry_sea().index(nu))
    disc = BAND.weights(nu) @ (rho * atmosphere.solar_irradiance(view.solar_zenith)) / (np.pi * SOLAR_ANGULAR_RADIUS**2)
    assert mean_radiance(view, [-np.radians(30.0)], [0.0]).sun[0, 0] == pytest.approx(disc, rel=2e-3)  # Gauss points on the disc's chords


def test_glint_is_bright_where_the_sun_is_and_nowhere_else():
    view = _view(VacuumAtmosphere.for_band(3.0, 5.0), cox_munk_isotropic(5.0), solar_azimuth=np.radians(120.0))
    azimuth = np.radians(np.arange(0.0, 360.0, 5.0))
    sun = mean_radiance(view, [-np.radians(15.0)], azimuth).sun[0]
    assert np.degrees(azimuth[np.argmax(sun)]) == pytest.approx(120.0)
    assert sun[np.abs(azimuth - np.radians(120.0)) > 1.5].max() < 1e-3 * sun.max()


@pytest.mark.parametrize("zenith", [90.5, 120.0, 180.0])
def test_sun_below_the_horizon_is_valid_and_dark(zenith):
    view = _view(VacuumAtmosphere.for_band(3.0, 5.0), cox_munk_isotropic(5.0), solar_zenith=np.radians(zenith))
    radiance = mean_radiance(view, -np.radians([1.0, 10.0]), [0.0])
    assert np.all(radiance.sun == 0.0)
    assert np.all(radiance.emission > 0.0)


@pytest.mark.parametrize("slopes", [cox_munk_isotropic(3.0), cox_munk_anisotropic(14.0, 1.0)], ids=["isotropic", "directional"])
@pytest.mark.parametrize("depression", [0.3, 3.0, 30.0])
@pytest.mark.parametrize("azimuth", [-70.0, 10.0])
def test_background_is_the_plain_sum_over_facets(slopes, depression, azimuth):
    """Independent route: Fresnel and sky at every facet, without series, sky table and harmonics."""
    atmosphere = WarmSky.for_band(3.0, 5.0)
    view = _view(atmosphere, slopes)
    got = mean_radiance(view, [-np.radians(depression)], np.radians([azimuth, 33.0]))
    theta = view_zenith(30.0, np.radians(depression))
    nodes = facet_nodes(theta, slopes, np.radians(azimuth) + np.pi, view.hiding.law_bands(slopes))
    nu = atmosphere.wavenumber_cm
    rho = reflectance(nodes.cos_incidence[:, None], view.water.index(nu))
    sky = atmosphere.sky_radiance(np.minimum(nodes.reflected_zenith, np.pi / 2), 0.0)
    sea = planck_wavenumber(nu, 288.15)
    seen = np.where(nodes.meets_sea[:, None], sea, rho * sky + (1.0 - rho) * sea)
    expected = BAND.weights(nu) @ (nodes.weight @ seen)
    assert (got.emission + got.sky)[0, 0] == pytest.approx(expected, rel=1e-5)  # sky table 1e-6, azimuth harmonics 1e-7


def test_apparent_temperature_of_the_furnace_is_its_own():
    atmosphere = IsothermalAtmosphere.for_band(300.0, 3.0, 5.0)
    radiance = mean_radiance(_view(atmosphere, cox_munk_isotropic(8.0), sea_temperature=300.0), -np.radians([0.5, 5.0]), [0.0])
    assert apparent_temperature(radiance.total, BAND, atmosphere.wavenumber_cm) == pytest.approx(300.0, abs=1e-4)


def test_an_article_background_is_a_blackbody_behind_air():
    atmosphere = IsothermalAtmosphere.for_band(288.15, 3.0, 5.0)
    view = _view(atmosphere, cox_munk_isotropic(8.0), background="blackbody")
    total = mean_radiance(view, -np.radians([0.5, 5.0]), [0.0]).total
    np.testing.assert_allclose(total, BAND.radiance(288.15, atmosphere.wavenumber_cm), rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"sensor_height": 0.0}, "height > 0 m"),
        ({"sea_temperature": -1.0}, "kelvin"),
        ({"solar_zenith": 4.0}, r"0\.\.pi"),
        ({"solar_zenith": np.nan}, r"0\.\.pi"),
    ],
)
def test_views_that_make_no_sense_are_refused(changes, text):
    with pytest.raises(DomainError, match=text):
        _view(VacuumAtmosphere.for_band(3.0, 5.0), flat(), **changes)


def test_chance_and_incidence_come_with_the_sun_and_only_there():
    atmosphere = VacuumAtmosphere.for_band(3.0, 5.0)
    view = _view(atmosphere, cox_munk_isotropic(6.0))
    elevation, azimuth = np.radians([2.0, -1.0, -20.0]), np.radians([0.0, 15.0])
    seen = mean_radiance(view, elevation, azimuth)
    theta = view_zenith(30.0, -elevation[1:])
    turn = turn_at(surface_range(30.0, -elevation[1:]))[:, None]
    direct = glint(theta[:, None], azimuth + np.pi, view.solar_zenith, 0.0, view.slopes, turn=turn)
    np.testing.assert_allclose(seen.chance[1:], direct.chance, rtol=1e-3)  # tables of the view zenith
    np.testing.assert_allclose(seen.cos_incidence[1:], direct.cos_incidence, rtol=1e-9)
    assert not seen.chance[0].any()
    assert not seen.cos_incidence[0].any()
    dark = mean_radiance(_view(atmosphere, cox_munk_isotropic(6.0), solar_zenith=2.0), elevation, azimuth)
    assert not dark.chance.any()


@pytest.mark.parametrize("slopes", [SEAS["10 m/s"], SEAS["directional"], SEAS["calm"]], ids=["10 m/s", "directional", "calm"])
def test_white_furnace_of_a_nested_sea(slopes):
    view = _view(IsothermalAtmosphere.for_band(288.15, 3.0, 5.0), slopes, shadowing=Shadowing.of("nested"))
    total = mean_radiance(view, -np.radians(np.geomspace(0.17, 90.0, 60)), np.radians([-40.0, 0.0, 25.0])).total
    np.testing.assert_allclose(total, BAND.radiance(288.15, view.atmosphere.wavenumber_cm), rtol=1e-10)


@pytest.mark.parametrize("name", ["flat", "10 m/s", "directional", "skewed"])
def test_white_furnace_of_a_prepared_model(name):
    view = _view(IsothermalAtmosphere.for_band(288.15, 3.0, 5.0), SEAS[name])
    total = MeanModel.prepare(view).map(-np.radians(np.geomspace(0.17, 90.0, 60)), np.radians([-40.0, 0.0, 25.0])).total
    np.testing.assert_allclose(total, BAND.radiance(288.15, view.atmosphere.wavenumber_cm), rtol=1e-10)


@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("flat", "both"),
        ("10 m/s", "nested"),
        ("directional", "nested"),
        ("skewed", "both"),
        *(pytest.param(n, "both", marks=pytest.mark.validation) for n in ("calm", "directional")),
    ],
)
@pytest.mark.parametrize("height", [5000.0, pytest.param(2.0, marks=pytest.mark.validation)])
def test_prepared_maps_are_the_rows_computed_one_by_one(name, law, height):
    view = _view(WarmSky.for_band(3.0, 5.0), SEAS[name], sensor_height=height, shadowing=Shadowing.of(law))
    elevation = 0.1 - horizon_depression(height) - np.concatenate([[0.0], np.geomspace(0.1 + 1e-6, 1.5, 30)])
    azimuth = np.radians(np.arange(-170.0, 190.0, 17.0))
    one, model = mean_radiance(view, elevation, azimuth), MeanModel.prepare(view).map(elevation, azimuth)
    np.testing.assert_allclose(model.total, one.total, rtol=1e-5)
    np.testing.assert_allclose(model.sun, one.sun, rtol=1e-4, atol=1e-9 * one.sun.max())
    np.testing.assert_array_equal(model.chance, one.chance)


def test_a_map_does_not_depend_on_the_number_of_threads():
    numba = pytest.importorskip("numba")
    model = MeanModel.prepare(_view(WarmSky.for_band(3.0, 5.0), SEAS["directional"]))
    elevation, azimuth = -np.linspace(0.01, 0.3, 50), np.linspace(-0.2, 0.2, 40)
    before = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        one = model.map(elevation, azimuth)
    finally:
        numba.set_num_threads(before)
    np.testing.assert_array_equal(one.sun, model.map(elevation, azimuth).sun)


def test_nested_waves_darken_a_low_sun_and_change_the_background_near_the_horizon_alone():
    atmosphere = WarmSky.for_band(3.0, 5.0)
    both, nested = (
        mean_radiance(
            _view(atmosphere, SEAS["10 m/s"], solar_zenith=np.radians(82.0), shadowing=Shadowing.of(law)), -np.radians([1.0, 45.0]), [0.0]
        )
        for law in ("both", "nested")
    )
    assert nested.sun[0, 0] < 0.8 * both.sun[0, 0]
    assert nested.sky[0, 0] != pytest.approx(both.sky[0, 0], rel=0.01)
    assert (nested.sky + nested.emission)[1, 0] == pytest.approx((both.sky + both.emission)[1, 0], rel=1e-6)
