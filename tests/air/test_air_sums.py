"""Sums of LOWTRAN7's band laws along rays: against the program, against finer sums, closed forms, and across their edges."""

from pathlib import Path

import numpy as np
import pytest
from lowtran_lines import differences, draw, of_program, ours
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from seaglint.air.profile import bent_ray
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import AirProfile, model_profile, saturation_density, sounding_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.profile_atmosphere import ProfileAtmosphere
from seaglint.air.protocol import slant_range, wavenumber_grid
from seaglint.base.conventions import horizon_depression
from seaglint.base.errors import BackendError, DomainError
from seaglint.optics.blackbody import planck_wavenumber

LINES = np.loadtxt(Path(__file__).with_name("lowtran7_lines.csv"), delimiter=",", skiprows=2)
MODELS = ("tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "us-standard-1976")
MARITIME = HazeWeather(wind=7.0, wind_24h=7.0)


def band_kelvin(nu, radiance):
    """Temperature of a blackbody with a radiance in a band [K]."""
    return brentq(lambda t: planck_wavenumber(nu, np.array(t)).sum() - radiance.sum(), 60.0, 400.0, xtol=1e-7)


def agree(lines, truth):
    apart = differences(np.array([ours(line) for line in lines]), truth)
    assert np.all(np.nanmedian(apart, axis=0) < (1e-4, 1e-4, 6e-4)), np.nanmedian(apart, axis=0)
    assert np.all(np.nanpercentile(apart, 95, axis=0) < (1e-3, 1e-3, 5e-3)), np.nanpercentile(apart, 95, axis=0)


def test_layers_give_what_the_program_gave():
    """Five hundred lines: models, soundings, hazes, heights, views, bands, direct and scattered sunlight."""
    agree([draw(int(row[0])) for row in LINES], LINES[:, 1:])


def test_layers_give_what_the_program_gives_now():
    """Twenty lines that are not in the file, run here."""
    from seaglint.formats.lowtran.engine import engine, run

    try:
        program = engine()
    except BackendError as error:
        pytest.skip(str(error))
    lines = [draw(seed) for seed in range(10_000, 10_020)]
    apart = differences(np.array([ours(line) for line in lines]), np.array([of_program(run(program.program, line.case)) for line in lines]))
    assert np.all(np.nanmedian(apart, axis=0) < (2e-4, 2e-4, 2e-3)), np.nanmedian(apart, axis=0)


def finer(monkeypatch):
    monkeypatch.setattr(bent_ray, "GROWTH", 1.02)
    monkeypatch.setattr(bent_ray, "FIRST_PIECE", 0.2)
    monkeypatch.setattr(bent_ray, "THICKEST", ((0.0, 10.0), (12e3, 50.0), (30e3, 250.0)))


@pytest.mark.parametrize("seed", range(3))
def test_pieces_are_fine_enough(seed, monkeypatch):
    """Against some two thousand pieces; doubled again they change by 2e-5 K."""
    rng = np.random.default_rng(seed)
    cases = []
    for _ in range(12):
        nu = wavenumber_grid(*((3.5, 5.0), (8.0, 12.0), (10.0, 12.0), (2.0, 5.5))[rng.integers(4)])
        wind = rng.uniform(0.0, 20.0)
        air = AirSums(model_profile(MODELS[rng.integers(6)]), HazeWeather(wind=wind, wind_24h=wind), nu)
        height = float(np.exp(rng.uniform(np.log(2.0), np.log(1e4))))
        dip = air.air.dip(height)
        elevation = -dip + (0.5 * np.pi + dip) * rng.random() ** 3 if rng.random() < 0.6 else -dip - (0.5 * np.pi - dip) * rng.random() ** 3
        cases.append((air, height, 0.5 * np.pi - elevation))
    coarse = [air.along(height, zenith) for air, height, zenith in cases]
    finer(monkeypatch)
    for (air, height, zenith), got in zip(cases, coarse, strict=True):
        fine, nu = air.along(height, zenith), air.laws.wavenumber_cm
        assert band_kelvin(nu, got.emitted) == pytest.approx(band_kelvin(nu, fine.emitted), abs=0.02)
        assert got.transmittance[-1].mean() == pytest.approx(fine.transmittance[-1].mean(), rel=3e-3, abs=1e-6)


def test_the_horizon_of_the_worked_example():
    """Midlatitude summer, 55 m, 5 m/s, 10-12 um: an independent converged sum gives 293.91, 293.84, 293.77 K; layers fall by 1.5 K."""
    nu = wavenumber_grid(10.0, 12.0)
    air = AirSums(model_profile("midlatitude-summer"), HazeWeather(wind=5.0, wind_24h=5.0), nu, spectroscopy="lowtran7")
    zeniths = np.radians(90.0 - np.array([0.1, 0.3, 0.5]))
    assert [band_kelvin(nu, air.along(55.0, z).emitted) for z in zeniths] == pytest.approx([293.91, 293.84, 293.77], abs=0.01)
    assert [band_kelvin(nu, air.in_layers(55.0, z).emitted) for z in zeniths] == pytest.approx([292.41, 292.23, 292.07], abs=0.03)


def isothermal(kelvin):
    """Midlatitude summer with one temperature."""
    base = model_profile("midlatitude-summer")
    same = np.full(base.height.size, kelvin)
    vapour = np.minimum(base.vapour, 0.9 * saturation_density(same))
    return AirProfile("isothermal", base.height, base.pressure, same, vapour, base.gas, base.earth_radius, base.season)


@pytest.mark.parametrize("height", [2.0, 300.0, 9000.0])
def test_air_of_one_temperature_emits_what_it_does_not_pass(height):
    nu = wavenumber_grid(3.0, 5.0)
    air = AirSums(isothermal(280.0), MARITIME, nu)
    for zenith in (0.0, 1.4, 0.5 * np.pi, 0.5 * np.pi + 0.9 * air.air.dip(height), 3.0):
        spectra = air.along(height, zenith)
        glow = (1.0 - spectra.transmittance[-1]) * planck_wavenumber(nu, 280.0)
        np.testing.assert_allclose(spectra.emitted, glow, rtol=1e-7, atol=1e-18)


def test_transmittance_does_not_ask_which_end_is_the_sensor():
    air = AirSums(model_profile("us-standard-1976"), MARITIME, wavenumber_grid(3.5, 5.0))
    for low, high, length in ((0.0, 50.0, 4000.0), (20.0, 3000.0, 30_000.0), (5.0, 5.0, 2000.0)):
        there, back = air.between(low, high, length)[0], air.between(high, low, length)[0]
        assert there.mean() == pytest.approx(back.mean(), rel=1e-4)


@pytest.mark.parametrize("model", MODELS)
def test_straight_lines_between_heights_are_the_bent_rays(model):
    """A path named by its ends over the air's mean curvature against the ray by Snell's law to the same place."""
    nu = wavenumber_grid(3.5, 5.0)
    air = AirSums(model_profile(model), MARITIME, nu)
    for height in (3.0, 60.0, 1200.0, 9000.0):
        for depression in np.geomspace(1.03 * air.air.dip(height), 0.5 * np.pi, 4):
            ray = air.along(height, 0.5 * np.pi + float(depression))
            slant = float(slant_range(height, ray.ray.arc[-1] * air.air.earth_radius))
            tau, light = air.between(height, 0.0, slant)
            assert tau.mean() == pytest.approx(ray.transmittance[-1].mean(), rel=2e-3, abs=2e-6)
            assert band_kelvin(nu, light) == pytest.approx(band_kelvin(nu, ray.emitted), abs=0.02)


def test_many_levels_are_the_same_air_in_the_same_time():
    """Five thousand levels of a model's own profile; nodes of rays do not follow them."""
    base, nu = model_profile("midlatitude-summer"), wavenumber_grid(8.0, 12.0)
    z = np.linspace(0.0, 30e3, 5000)
    part = np.interp(z, base.height, base.temperature), np.interp(z, base.height, base.relative_humidity)
    pressure = np.exp(np.interp(z, base.height, np.log(base.pressure)))
    many = AirSums(sounding_profile("many", "midlatitude-summer", z, pressure, *part), MARITIME, nu)
    thin = np.append(z[::60], z[-1])
    few = AirSums(
        sounding_profile("few", "midlatitude-summer", thin, *(np.interp(thin, z, row) for row in (pressure, *part))), MARITIME, nu
    )
    for zenith in (0.3, 1.5, 0.5 * np.pi + 0.5 * many.air.dip(100.0)):
        a, b = many.along(100.0, zenith), few.along(100.0, zenith)
        assert a.ray.height.size < 300
        assert band_kelvin(nu, a.emitted) == pytest.approx(band_kelvin(nu, b.emitted), abs=0.05)


@pytest.mark.parametrize("height", [3.0, 150.0, 2500.0, 9000.0])
def test_splines_of_the_atmosphere_follow_its_rays(height):
    """Sky and sea paths between the rays that are computed: bands within 0.03 K."""
    rng = np.random.default_rng(int(height))
    nu = wavenumber_grid(8.0, 12.0)
    air = ProfileAtmosphere(model_profile("subarctic-winter"), MARITIME, nu)
    dip = horizon_depression(height)
    bent = air.sums.air.dip(height) / dip
    elevation = np.concatenate([-dip * rng.random(6), (0.5 * np.pi) * rng.random(6) ** 4])
    got = air.sky_radiance(0.5 * np.pi - elevation, 0.0, height)
    for e, spectrum in zip(elevation, got, strict=True):
        ray = air.sums.along(height, 0.5 * np.pi - (e * bent if e < 0.0 else e))
        assert band_kelvin(nu, spectrum) == pytest.approx(band_kelvin(nu, ray.emitted), abs=0.04)
    arc = np.geomspace(1.0, 3e4 * np.sqrt(height), 6) * 0.1
    tau, light = air.path(height, arc)
    for s, t, radiance in zip(slant_range(height, arc), tau, light, strict=True):
        direct = air.sums.between(height, 0.0, float(s))
        assert t.mean() == pytest.approx(direct[0].mean(), rel=2e-3)
        assert band_kelvin(nu, radiance) == pytest.approx(band_kelvin(nu, direct[1]), abs=0.03)


@pytest.mark.parametrize("band", [(3.5, 5.0), (8.0, 12.0)])
@pytest.mark.parametrize("model", MODELS)
def test_no_false_bands_in_the_sky(model, band):
    """Second differences of the sky's temperature over rows of 0.01 deg, farther than 0.06 deg from the sea's horizon, are small.

    From 3 km rays graze the corners that the models' own profiles have at their kilometres: 0.04 K in subarctic winter.
    """
    nu = wavenumber_grid(*band)
    air = ProfileAtmosphere(model_profile(model), HazeWeather(wind=5.0, wind_24h=5.0), nu)
    for height in (5.0, 20.0, 55.0, 420.0, 900.0):
        dip = horizon_depression(height)
        elevation = np.arange(-dip + np.radians(0.06), np.radians(2.0), np.radians(0.01))
        light = air.sky_radiance(0.5 * np.pi - elevation, 0.0, height).sum(axis=-1)
        nodes = np.linspace(150.0, 320.0, 2000)
        table = planck_wavenumber(nu, nodes[:, None]).sum(axis=-1)
        kelvin = CubicSpline(table, nodes)(light)
        assert np.abs(np.diff(kelvin, 2)).max() < 0.005, height


def test_levels_of_the_program_are_there_for_comparison():
    nu = wavenumber_grid(10.0, 12.0)
    layered = ProfileAtmosphere(model_profile("midlatitude-summer"), HazeWeather(wind=5.0, wind_24h=5.0), nu, levels="lowtran")
    sky = layered.sky_radiance(np.radians([89.7, 60.0]), 0.0, 55.0)
    assert band_kelvin(nu, sky[0]) == pytest.approx(292.23, abs=0.1)
    assert layered.provenance["levels"] == "lowtran"


def test_a_channel_that_is_not_held_is_refused():
    with pytest.raises(DomainError, match=r"0\.7-14\.7 um"):
        AirSums(model_profile("tropical"), MARITIME, wavenumber_grid(14.0, 20.0))
