"""Scattered sunlight: closed forms, symmetries, a Sun that sets, and the tables against the sums line by line."""

import numpy as np
import pytest
from scattered_lines import Only, line_by_line, thin_air

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.profile.profile_scattering import model_scatterers, scattered_cases, scatters_in
from seaglint.air.protocol import slant_range
from seaglint.air.scattering.scattered_light import scattered_path, scattered_path_at, scattered_shares, scattered_sky_at
from seaglint.air.scattering.scattered_line import KINDS, horizon_zenith, local_zenith
from seaglint.air.scattering.scattered_tables import ScatteredLight, scattered_in
from seaglint.air.scattering.scattering_laws import molecular_phase, scattering_angle
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DomainError
from seaglint.facet.sea_view import BandSum
from seaglint.facet.sunlight import solar_zenith_at
from seaglint.optics.band import Band
from seaglint.studies.build.profile_air import model_air

BAND = Band.rectangular(3.5, 4.2)


@pytest.fixture(scope="module")
def scattering_air():
    table = model_air("midlatitude-summer", 7.0, (3.5, 4.2))
    return table.scattering(BandSum.of(BAND, table).grid)


@pytest.fixture(scope="module")
def weights(scattering_air):
    return BAND.weights(scattering_air.wavenumber_cm)


@pytest.mark.parametrize("view", [0.0, 0.7, 1.1])
def test_thin_air_scatters_optical_depth_times_phase_function(view):
    """``L = E P tau / cos(view)`` where nothing attenuates; 2e-3 is for the round Earth at 63 deg, a third of it for the last layer."""
    depth = 1e-5
    air = thin_air(depth)
    radiance, _ = line_by_line(air, np.array([1.0, 0.0]), 0.0, 0.5 * np.pi - view, 0.4, 0.5)
    angle = scattering_angle(view, 0.4, 0.5)
    assert float(radiance[0]) == pytest.approx(depth * float(molecular_phase(angle)) / np.cos(view), rel=5e-3)


def test_attenuation_is_that_of_the_bent_way():
    """Looking straight up to a zenith Sun every point has the whole air on its way, ``J = tau exp(-tau)``; straight down from above it
    lies there twice, ``J = (1 - exp(-2 tau)) / 2``. LOWTRAN7's trapezoid leaves 0.2 %.
    """
    air = thin_air(0.5)
    up, _ = air.amplitudes(0.0, np.array([[0.0, 0.0, 0.0]]))
    assert float(up[0, KINDS - 1, 0]) == pytest.approx(0.5 * np.exp(-0.5), rel=1e-3)
    down, _ = air.amplitudes(99e3, np.array([[np.pi, 0.0, 0.0]]))
    assert float(down[0, KINDS - 1, 0]) == pytest.approx(0.5 * (1.0 - np.exp(-1.0)), rel=2e-3)


def test_molecular_phase_function_is_normalised():
    cosine, weight = np.polynomial.legendre.leggauss(8)
    assert float(2.0 * np.pi * weight @ molecular_phase(np.arccos(cosine))) == pytest.approx(1.0, rel=1e-3)


def test_mie_phase_functions_are_normalised_and_peak_forward(scattering_air):
    angle = np.radians(np.linspace(0.0, 180.0, 3601))
    phase = scattering_air.phase(angle)
    total = 2.0 * np.pi * np.trapezoid(phase * np.sin(angle)[:, None, None], angle, axis=0)
    np.testing.assert_allclose(total, 1.0, rtol=0.06)  # LOWTRAN7's own, on its 34 angles
    assert np.all(phase[0, : KINDS - 2] > 2.0 * phase[1800, : KINDS - 2])


def test_sun_at_a_place_is_the_one_of_the_glint():
    for azimuth, arc in ((0.0, 0.02), (2.0, 0.05), (np.pi, 0.01)):
        assert local_zenith(1.3, azimuth, arc) == pytest.approx(float(solar_zenith_at(1.3, azimuth, arc)), abs=1e-12)


@pytest.mark.parametrize("apparent", [0.0, 0.5, 1.4, 1.55, 0.5 * np.pi + 0.003])
def test_refraction_there_and_back(scattering_air, apparent):
    true = scattering_air.unrefracted_zenith(apparent)
    assert float(scattering_air.apparent_zenith(true)) == pytest.approx(apparent, abs=1e-8)
    assert apparent <= true < apparent + np.radians(0.7)


def test_azimuth_is_symmetric_and_periodic():
    rows = [(7.0, 30.0, -0.03, a, 1.4) for a in (0.7, -0.7, 2.0 * np.pi - 0.7)]
    one, other, third = scattered_cases("us-standard-1976", np.array(rows), [BAND])[0]
    assert other == pytest.approx(one, rel=1e-12)
    assert third == pytest.approx(one, rel=1e-12)


def test_more_air_scatters_more_and_the_aureole_is_brightest(scattering_air, weights):
    elevation = -np.radians([60.0, 20.0, 5.0, 2.0, 1.0])
    path, _ = line_by_line(scattering_air, weights, 30.0, elevation, 0.5, 1.3)
    assert np.all(np.diff(path) > 0.0)
    aside, _ = line_by_line(scattering_air, weights, 0.0, 0.2, np.radians([0.0, 3.0, 10.0, 30.0, 90.0]), 1.4)
    assert np.all(np.diff(aside) < 0.0)


def test_sun_sets_without_a_step():
    """Down to nothing 6 deg below the horizon, in steps that shrink with the angle; LOWTRAN7's angle is half a degree more."""
    zenith = np.radians([*np.arange(89.0, 91.5, 0.02), *np.arange(91.5, 97.0, 0.1)])
    for elevation, least in ((0.1, 0.01), (-0.02, 1e-3)):  # sky and path
        lines = np.array([(7.0, 30.0, elevation, 0.2, z) for z in zenith])
        seen = scattered_cases("midlatitude-summer", lines, [BAND])[0]
        assert seen[0] > least
        assert seen[-1] == 0.0
        assert np.abs(np.diff(seen)).max() < 0.06 * seen[0]
        assert np.all(np.diff(seen) <= 0.0)


@pytest.mark.validation
def test_tables_of_a_setting_sun_have_no_step(scattering_air, weights):
    """Path, sky and mirrored sky from 1.5 deg above the horizon: every 0.1 deg a fifth of the first less at most, down to darkness."""
    seen = []
    for zenith in np.radians([*np.arange(88.5, 90.41, 0.1), 91.0, 92.0, 94.0, 96.0]):
        light = scattered_in(Only(scattering_air), slice(None), weights, 30.0, float(zenith), 0.002)
        shapes = light.sea_sky.spectral @ weights
        mirrored = [scattered_shares(0.1, 0.2, light.sea_sky, place) @ shapes for place in (None, float(zenith) - 0.001)]
        seen.append([scattered_path_at(3e3, -0.01, 0.2, light.path), scattered_sky_at(0.1, 0.2, light.sky), *np.maximum(mirrored, 0.0)])
    seen = np.array(seen)
    assert np.all(seen[0] > 1e-4)
    assert not seen[-1, :3].any()
    assert np.all(np.abs(np.diff(seen, axis=0)) < 0.2 * seen[0])
    assert np.all(np.diff(seen, axis=0) <= 0.0)
    np.testing.assert_allclose(seen[:-1, 2], seen[:-1, 1], rtol=0.2, atol=1e-12)  # the same sky, 30 m apart


@pytest.mark.parametrize(("height", "sun", "turn"), [(30.0, 76.0, 0.004), (2.0, 30.0, 0.0), (900.0, 85.0, 0.02), (9000.0, 60.0, 0.055)])
def test_tables_against_line_by_line(scattering_air, weights, height, sun, turn):
    """0.3 %: path and sky from the horizontal up; twice that among Suns of places in view."""
    sun = np.radians(sun)
    light = ScatteredLight(scattering_air, weights, height, sun, turn)
    rng = np.random.default_rng(3)
    azimuth = np.pi * rng.random(24) ** 2
    elevation = 0.5 * np.pi * rng.random(24) ** 3
    direct, _ = line_by_line(scattering_air, weights, height, elevation, azimuth, sun)
    tabled = [scattered_sky_at(e, a, light.sky) for e, a in zip(elevation.tolist(), azimuth.tolist(), strict=True)]
    np.testing.assert_allclose(tabled, direct, rtol=3e-3)
    np.testing.assert_allclose(scattered_shares(elevation, azimuth, light.sky)[:, 0], direct, rtol=3e-3)
    dip = horizon_zenith(scattering_air.laws, 1e-3 * height) - 0.5 * np.pi
    down = -dip - (0.5 * np.pi - dip) * (1e-3 + 0.999 * rng.random(24) ** 4)
    direct, arc = line_by_line(scattering_air, weights, height, down, azimuth, sun)
    arc *= 1e3 * scattering_air.laws.earth_radius
    np.testing.assert_allclose(scattered_path(arc, down, azimuth, light.path), direct, rtol=3e-3)
    assert scattered_path_at(float(arc[0]), float(down[0]), float(azimuth[0]), light.path) == pytest.approx(float(direct[0]), rel=3e-3)
    for there in (sun - turn, sun, sun + 0.5 * turn):
        direct, _ = line_by_line(scattering_air, weights, 0.0, elevation, azimuth, there)
        spectra = scattered_shares(elevation, azimuth, light.sea_sky, there) @ light.sea_sky.spectral
        np.testing.assert_allclose(spectra @ weights, direct, rtol=6e-3)


def test_spectral_shapes_hold_the_spectrum(scattering_air, weights):
    """Products with a reflectance that doubles through the band are as good as the band's own sums."""
    light = ScatteredLight(scattering_air, weights, 30.0, 1.3)
    slope = np.linspace(1.0, 2.0, weights.size) * weights
    direct, _ = line_by_line(scattering_air, slope, 0.0, 0.3, 0.5, 1.3)
    assert float(scattered_shares(0.3, 0.5, light.sea_sky) @ (light.sea_sky.spectral @ slope)) == pytest.approx(float(direct[0]), rel=3e-3)


def test_tables_are_kept_for_the_same_air_and_sun_alone(scattering_air, weights):
    first = scattered_in(Only(scattering_air), slice(None), weights, 30.0, 1.2)
    assert scattered_in(Only(scattering_air), slice(None), weights.copy(), 30.0, 1.2) is first
    for other in ((2.0 * weights, 30.0, 1.2), (weights, 31.0, 1.2), (weights, 30.0, 1.21), (weights, 30.0, 1.2, 0.01)):
        assert scattered_in(Only(scattering_air), slice(None), *other) is not first


def test_paths_beyond_the_horizon_stay_those_of_the_horizon(scattering_air, weights):
    light = ScatteredLight(scattering_air, weights, 30.0, 1.3)
    edge = np.sqrt(light.path.longest**2 - 900.0) * EFFECTIVE_EARTH_RADIUS / (EFFECTIVE_EARTH_RADIUS + 15.0)
    assert float(slant_range(30.0, edge)) == pytest.approx(light.path.longest, rel=1e-6)
    ends = scattered_path([edge, 1.3 * edge], -0.003, 0.1, light.path)
    assert ends[1] == pytest.approx(ends[0], rel=1e-4)


@pytest.mark.parametrize("nothing", [VacuumAtmosphere.for_band(3.5, 4.2), IsothermalAtmosphere.for_band(290.0, 3.5, 4.2)])
def test_air_without_scatterers_is_dark(nothing):
    over = BandSum.of(BAND, nothing)
    light = scattered_in(nothing, over.grid, over.weights, 30.0, 1.3, 0.01)
    assert scattered_sky_at(0.2, 0.1, light.sky) == 0.0
    assert scattered_path_at(1000.0, -0.03, 0.1, light.path) == 0.0
    assert not np.any(scattered_shares([0.2, 1.0], 0.1, light.sea_sky) @ light.sea_sky.spectral)


def test_night_and_the_far_infrared_are_dark():
    air = model_air("us-standard-1976", 7.0, (3.5, 4.2))
    over = BandSum.of(BAND, air)
    night = scattered_in(air, over.grid, over.weights, 30.0, np.radians(96.3), 0.004)
    assert scattered_sky_at(0.2, 0.1, night.sky) == 0.0
    far = model_air("us-standard-1976", 7.0, (8.0, 12.0))
    assert far.scattering(slice(None)) is None
    assert not scatters_in((8.0, 12.0))


def test_places_in_view_see_their_own_sun(scattering_air, weights):
    """Sky over a place towards the Sun is that under a Sun so much higher, and away from it under one that is below its horizon."""
    sun, turn = 0.5 * np.pi - 0.01, 0.02
    light = ScatteredLight(scattering_air, weights, 1000.0, sun, turn)
    for there in (sun - turn, sun + turn):
        direct, _ = line_by_line(scattering_air, weights, 0.0, 0.1, 0.3, there)
        found = scattered_shares(0.1, 0.3, light.sea_sky, there) @ (light.sea_sky.spectral @ weights)
        assert float(found) == pytest.approx(float(direct[0]), rel=2e-2)


def test_cut_air_is_the_air_of_the_cut_band(scattering_air):
    some = scattering_air.cut(slice(20, 60))
    lines = np.array([[1.2, 0.3, 1.0]])
    np.testing.assert_allclose(some.amplitudes(30.0, lines)[0], scattering_air.amplitudes(30.0, lines)[0][..., 20:60], rtol=1e-12)


def test_unknown_models_and_channels_are_refused():
    with pytest.raises(DomainError, match="is not one of tropical"):
        model_scatterers("martian", (2500.0,))
    with pytest.raises(DomainError, match="choose a band inside"):
        model_scatterers("tropical", (100.0,))


@pytest.mark.parametrize(("zenith", "turn"), [(45.0, 0.44), (83.0, 0.41), (88.5, 0.3), (70.0, 1.5)])
def test_few_tabulated_suns_are_suns_of_the_whole_table(scattering_air, weights, zenith, turn):
    """Two Suns, the ends, and the Sun at the foot alone, against thirteen."""
    light = ScatteredLight(scattering_air, weights, 60.0, np.radians(zenith), np.radians(turn))
    whole = light.sea_sky
    first, last = whole.suns[0], whole.suns[0] + (whole.amplitude.shape[0] - 1) / whole.suns[1]
    elevation, azimuth = np.radians([0.0, 1.0, 8.0, 40.0, 90.0])[:, None], np.radians([0.0, 4.0, 30.0, 100.0, 180.0])
    two = light.sea_sky_within(light.farthest_turn, 2)
    assert two.amplitude.shape[0] == 2
    for few, at, tolerance in (
        (two, first, 1e-9),
        (two, last, 1e-9),
        (light.sea_sky_within(light.farthest_turn, 1), np.radians(zenith), 1e-3),
    ):
        found, wanted = (scattered_shares(elevation, azimuth, t, at) @ (t.spectral @ weights) for t in (few, whole))
        np.testing.assert_allclose(found, wanted, rtol=tolerance)


def test_below_the_horizontal_low_sensors_see_the_horizontals_sky(scattering_air, weights):
    light = ScatteredLight(scattering_air, weights, 60.0, np.radians(75.0))
    amplitude = light.sky.amplitude
    assert np.all(amplitude[:, : light.sky.dip_rows] == amplitude[:, light.sky.dip_rows : light.sky.dip_rows + 1])
    computed, azimuth = (
        light.sky_spectra(np.array([0.5 * np.pi]), np.radians([0.0, 40.0, 170.0]), 60.0) @ weights,
        np.radians([0.0, 40.0, 170.0]),
    )
    np.testing.assert_allclose(scattered_shares(0.0, azimuth, light.sky)[:, 0], computed[0], rtol=3e-3)
