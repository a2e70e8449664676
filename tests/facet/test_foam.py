"""Light of foam on a facet against plain spectral sums."""

from dataclasses import replace

import numpy as np
import pytest
from render_scenes import SEA_TEMPERATURE, Furnace, sea_view

from seaglint.base.errors import DomainError
from seaglint.facet.foam import NO_FOAM, FoamCover, foam_emission, foam_sunlight, foam_thermal
from seaglint.facet.foam_light import FoamLight, foam_tables, mean_sky
from seaglint.facet.path_basis import path_basis
from seaglint.facet.sunlight import sunlight, sunlight_at
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.foam_reflectance import BUBBLES
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.studies.build.profile_air import model_air

BANDS = {"3.5-5 um": Band.rectangular(3.5, 5.0), "8-12 um": Band.rectangular(8.0, 12.0)}
ARCS = np.geomspace(30.0, 12e3, 200)


@pytest.fixture(scope="module", params=BANDS.values(), ids=BANDS.keys())
def view(request):
    air = model_air("midlatitude-summer", 8.0, (request.param.min_um, request.param.max_um))
    return sea_view(air, cox_munk_isotropic(8.0), height=20.0, sun_zenith=62.0, sun_azimuth=35.0, band=request.param)


@pytest.fixture(scope="module")
def tables(view):
    return foam_tables(view, path_basis(view.atmosphere, view.band, view.sensor_height, ARCS))


def _diffuse(nu):
    """Diffuse reflectance of foam, put in by hand from its published numbers and the water's absorption."""
    water = sea_view(None, cox_munk_isotropic(8.0)).water
    return 0.22 * np.exp(-np.sqrt(4.0 * np.pi * water.index(nu).imag * nu * 100.0 * 0.77e-3))


def _sky(view):
    """Mean sky over the hemisphere by the midpoint rule: the thermal one, and sunlight scattered once, line by line."""
    cosine, azimuth = (np.arange(60) + 0.5) / 60, np.pi * ((np.arange(40) + 0.5) / 40) ** 2
    share = ((np.arange(40) + 1.0) ** 2 - np.arange(40) ** 2) / 40**2
    thermal = view.atmosphere.sky_radiance(np.arccos(cosine), 0.0)[:, view.in_band.grid]
    scattered = np.einsum("j,ijn->in", share, view.scattered.sky_spectra(np.arccos(cosine), azimuth, 0.0))
    return 2.0 / cosine.size * (cosine @ thermal), 2.0 / cosine.size * (cosine @ scattered)


def test_emission_of_bubbles_is_the_spectral_sum(view, tables):
    nu, black = view.in_band.wavenumber_cm, planck_wavenumber(view.in_band.wavenumber_cm, SEA_TEMPERATURE)
    rng = np.random.default_rng(1)
    for i in rng.integers(0, ARCS.size, 40):
        seen = view.atmosphere.transmittance(view.sensor_height, ARCS[i])[view.in_band.grid] * view.in_band.weights
        expected = seen @ ((BUBBLES - _diffuse(nu)) * black)
        assert foam_emission(tables, (int(i), 0.0), 0.0) == pytest.approx(expected, rel=1e-3)


def test_reflected_sky_is_the_mean_over_the_hemisphere(view, tables):
    thermal, scattered = _sky(view)
    nu, weights = view.in_band.wavenumber_cm, view.in_band.weights
    # both quadratures are good to 0.2 % of the thermal sky; the aureole's tables to 1 %
    assert weights @ mean_sky(view) == pytest.approx(weights @ (thermal + scattered), rel=5e-3)
    for i in (0, 90, 199):
        seen = view.atmosphere.transmittance(view.sensor_height, ARCS[i])[view.in_band.grid] * weights
        reflected = foam_thermal(tables, (i, 0.0), 0.0) - foam_emission(tables, (i, 0.0), 0.0)
        assert reflected == pytest.approx(seen @ (_diffuse(nu) * (thermal + scattered)), rel=1e-2)


@pytest.mark.parametrize("slope", [(0.2, 0.1), (-0.2, -0.1), (0.0, 0.0), (-0.3, 0.25), (0.3, -0.25)])
def test_diffuse_sunlight_is_irradiance_on_the_tilted_facet(view, tables, slope):
    nu, normal = view.in_band.wavenumber_cm, np.array([-slope[0], -slope[1], 1.0])
    z, a = view.solar_zenith, view.solar_azimuth
    direction = np.array([np.sin(z) * np.sin(a), np.sin(z) * np.cos(a), np.cos(z)])
    cosine = direction @ normal / np.linalg.norm(normal)
    for i in (3, 120, 180):
        seen = view.atmosphere.transmittance(view.sensor_height, ARCS[i])[view.in_band.grid] * view.in_band.weights
        expected = cosine * (seen @ (_diffuse(nu) * view.irradiance)) / np.pi
        got = foam_sunlight(tables, (i, 0.0), sunlight(z, a, True), slope)
        assert got == pytest.approx(expected, rel=1e-3)


def test_facets_turned_from_the_sun_are_dark(view, tables):
    sun = sunlight(np.radians(85.0), 0.0, True)
    assert foam_sunlight(tables, (5, 0.0), sun, (0.0, 0.2)) == 0.0
    assert foam_sunlight(tables, (5, 0.0), sun, (0.0, -0.2)) > 0.0
    assert foam_sunlight(tables, (5, 0.0), sunlight(1.0, 0.0, False), (0.0, 0.0)) == 0.0
    assert foam_sunlight(tables, (5, 0.0), sunlight_at(sunlight(1.65, 0.0, True), 0.0, 1.0, 100.0), (0.0, -0.3)) == 0.0


def test_places_between_two_nodes_are_interpolated(tables):
    between = foam_thermal(tables, (40, 0.25), 1.0)
    assert between == pytest.approx(0.75 * foam_thermal(tables, (40, 0.0), 1.0) + 0.25 * foam_thermal(tables, (41, 0.0), 1.0), rel=1e-12)


@pytest.mark.parametrize("band", BANDS.values(), ids=BANDS.keys())
def test_white_furnace_is_planck(band):
    """Sky, sea and foam at one temperature: foam shows what water shows, a blackbody behind the path."""
    air = Furnace.for_band(SEA_TEMPERATURE, band.min_um, band.max_um)
    view = sea_view(air, cox_munk_isotropic(8.0), band=band, sun_zenith=100.0)
    basis = path_basis(air, band, view.sensor_height, ARCS)
    tables = foam_tables(view, basis)
    black = basis.coefficients @ basis.project(planck_wavenumber(basis.wavenumber_cm, SEA_TEMPERATURE))
    for i in range(0, ARCS.size, 9):
        assert foam_thermal(tables, (i, 0.0), black[i]) == pytest.approx(black[i], rel=1e-10)


def test_night_has_no_sunlight(view):
    light = FoamLight.of(replace(view, solar_zenith=np.radians(120.0)))
    assert not light.sun.any()
    assert np.all(light.sky <= FoamLight.of(view).sky)


def test_a_sea_without_foam_has_empty_tables():
    assert NO_FOAM.emitted.size == 0
    assert NO_FOAM.mirroring == 1.0


@pytest.mark.parametrize("share", [-0.1, 1.1, np.nan])
def test_shares_beyond_one_are_refused(share):
    with pytest.raises(DomainError, match="share of foam"):
        FoamCover(share)
