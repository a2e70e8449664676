"""The air of profiles obeys physics: nothing here compares with LOWTRAN7's numbers."""

import numpy as np
import pytest

from seaglint.air.protocol import Atmosphere
from seaglint.base.conventions import horizon_depression, horizon_range
from seaglint.base.errors import DomainError
from seaglint.formats.lowtran.deck import MODELS
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance
from seaglint.studies.build.profile_air import model_air

# Temperatures of the model atmospheres at 0 and 1 km [K], AFGL-TR-86-0110 Table 1; the subarctic winter lies under an inversion.
LEVELS = {
    "tropical": (299.7, 293.7),
    "midlatitude-summer": (294.2, 289.7),
    "midlatitude-winter": (272.2, 268.7),
    "subarctic-summer": (287.2, 281.7),
    "subarctic-winter": (257.2, 259.1),
    "us-standard-1976": (288.2, 281.7),
}
BAND = Band.rectangular(3.0, 5.0)
HEIGHTS = [
    *(2.0, 101.0, 1001.0, 3000.0, 10000.0),
    *(pytest.param(h, marks=pytest.mark.validation) for h in (3.3, 18.0, 640.0, 1000.0, 2480.0, 2999.9, 7300.0)),
]
NOISE = 2e-5  # what 16-bit scores may add to a transmittance


@pytest.fixture(scope="module", params=sorted(LEVELS))
def any_air(request) -> Atmosphere:
    return model_air(request.param, 7.0, (3.0, 5.0))


def band(air, spectrum):
    return spectrum @ BAND.weights(air.wavenumber_cm)


def opaque(air):
    """The middle of the CO2 band at 4.26 um: the air is black within metres."""
    return int(np.argmin(np.abs(air.wavenumber_cm - 2345.0)))


def arcs(height):
    return np.concatenate([[0.0], np.geomspace(0.03 * height, horizon_range(height), 60)])


def test_shipped_models():
    assert set(LEVELS) == set(MODELS)


@pytest.mark.parametrize("height", HEIGHTS)
def test_transmittance_lies_between_0_and_1_and_falls_with_range(any_air, height):
    tau = any_air.transmittance(height, arcs(height))
    assert np.all((tau >= 0.0) & (tau <= 1.0))
    assert np.all(np.diff(tau, axis=0) <= NOISE)
    assert np.all(np.diff(band(any_air, tau)) < 0.0)


@pytest.mark.parametrize("height", HEIGHTS)
def test_curves_have_no_bands_over_range(any_air, height):
    # Curvature of log transmittance per step of log range changes smoothly: a kink or a stair would stand out as a spike.
    x = np.linspace(np.log(0.05 * height), np.log(0.98 * horizon_range(height)), 3000)
    y = np.log(band(any_air, any_air.transmittance(height, np.exp(x))))
    curvature = np.diff(y, 2) / (x[1] - x[0]) ** 2
    assert np.abs(np.diff(curvature)).max() < 0.05 * np.abs(curvature).max()


@pytest.mark.parametrize("height", [2.0, 30.0, 640.0])
def test_the_first_kilometre_emits_between_its_temperatures(any_air, height):
    cold, warm = sorted(LEVELS[any_air.name])
    arc = arcs(height)
    emitted = any_air.path_radiance(height, arc) / (1.0 - any_air.transmittance(height, arc))
    assert np.all(emitted <= planck_wavenumber(any_air.wavenumber_cm, warm + 0.1))
    assert np.all(emitted >= planck_wavenumber(any_air.wavenumber_cm, cold - 0.1))


@pytest.mark.parametrize("zenith_deg", [0.0, 60.0, 85.0, 90.0])
def test_kirchhoff_opaque_sky_shines_like_a_blackbody_at_air_temperature(any_air, zenith_deg):
    cold, warm = sorted(LEVELS[any_air.name])
    i = opaque(any_air)
    sky = any_air.sky_radiance(np.radians(zenith_deg), 0.0)[i]
    assert planck_wavenumber(any_air.wavenumber_cm[i], cold - 0.1) < sky < planck_wavenumber(any_air.wavenumber_cm[i], warm + 0.1)


def test_opaque_paths_shine_like_a_blackbody(any_air):
    i = opaque(any_air)
    cold, warm = sorted(LEVELS[any_air.name])
    assert any_air.transmittance(100.0, 8000.0)[i] < 1e-6
    glow = any_air.path_radiance(100.0, 8000.0)[i]
    assert planck_wavenumber(any_air.wavenumber_cm[i], cold - 0.1) < glow < planck_wavenumber(any_air.wavenumber_cm[i], warm + 0.1)


def test_sunlight_falls_with_zenith_angle_and_ends_at_the_horizon(any_air):
    sun = any_air.solar_irradiance(np.radians(np.linspace(0.0, 90.0, 181)))
    assert np.all(sun <= exoatmospheric_irradiance(any_air.wavenumber_cm) * (1.0 + 1e-9))
    assert np.all(np.diff(band(any_air, sun)) < 0.0)
    assert band(any_air, sun[-1]) > 0.0
    assert not any_air.solar_irradiance(np.radians(90.1)).any()


def test_two_air_masses_hold_between_one_and_two_times_the_optical_depth(any_air):
    # Band models grow between the square root (strong lines) and linearly (weak lines, aerosol) with the amount of air.
    solar = exoatmospheric_irradiance(any_air.wavenumber_cm)
    depth = -np.log(any_air.solar_irradiance([0.0, np.pi / 3]) / solar)
    seen = depth[0] < 5.0
    ratio = depth[1, seen] / depth[0, seen]
    assert np.all((ratio > 1.3) & (ratio < 2.02))


def test_sky_brightens_towards_the_horizon(any_air):
    ground, above = LEVELS[any_air.name]
    lowest = 90.0 if ground > above else 88.0  # under an inversion the last degree looks through the colder air at the sea
    sky = band(any_air, any_air.sky_radiance(np.radians(np.linspace(0.0, lowest, 91)), 0.0))
    assert np.all(np.diff(sky) > 0.0)


@pytest.mark.parametrize("winds", [11, pytest.param(41, marks=pytest.mark.validation)])
def test_wind_adds_aerosol(any_air, winds):
    tau = [band(any_air, model_air(any_air.name, w, (3.0, 5.0)).transmittance(20.0, 8000.0)) for w in np.linspace(0.0, 20.0, winds)]
    assert np.all(np.diff(tau) < 1e-4 * tau[0])
    assert tau[-1] < 0.75 * tau[0]


def test_shorter_columns_absorb_less(any_air):
    down = (
        band(any_air, any_air.transmittance(2.0, 0.0)),
        band(any_air, any_air.transmittance(200.0, 0.0)),
        band(any_air, any_air.transmittance(3000.0, 0.0)),
    )
    assert down[0] > down[1] > down[2]


@pytest.mark.parametrize("height", [5.0, 100.0, 640.0, 2480.0])
def test_the_sky_just_above_the_sea_horizon_continues_through_the_tangent_point(any_air, height):
    # The line of sight that grazes the sea: air up to the horizon, and behind it the sky that the horizon itself sees.
    # Band models do not multiply exactly (20 cm-1 averages): 5 %.
    arc = horizon_range(height)
    behind = any_air.transmittance(height, arc) * any_air.sky_radiance(0.5 * np.pi, 0.0)
    seen = any_air.sky_radiance(0.5 * np.pi + horizon_depression(height), 0.0, height)
    assert band(any_air, seen) == pytest.approx(band(any_air, any_air.path_radiance(height, arc) + behind), rel=0.05)


def test_sky_from_two_metres_is_the_sky_from_the_sea(any_air):
    zenith = np.radians([0.0, 30.0, 60.0, 80.0])
    np.testing.assert_allclose(
        band(any_air, any_air.sky_radiance(zenith, 0.0, 2.0)), band(any_air, any_air.sky_radiance(zenith, 0.0)), rtol=2e-3
    )


def test_wave_crests_beyond_the_horizon_are_looked_up_smoothly(any_air):
    horizon = horizon_range(20.0)
    tau = band(any_air, any_air.transmittance(20.0, horizon * np.array([0.98, 1.0, 1.02, 1.2, 1.5])))
    slope = np.diff(np.log(tau[:3]))
    assert slope[1] == pytest.approx(slope[0], rel=0.15)
    assert np.all(np.diff(tau) < 0.0)


def test_it_answers_the_protocol_with_the_shapes_it_promises(any_air):
    n = any_air.wavenumber_cm.size
    assert isinstance(any_air, Atmosphere)
    assert any_air.transmittance(10.0, np.full((3, 2), 500.0)).shape == (3, 2, n)
    assert any_air.path_radiance(10.0, 5.0).shape == (n,)
    assert any_air.solar_irradiance(np.ones(4)).shape == (4, n)
    assert any_air.sky_radiance(np.ones((2, 2)), 0.0, height=3.0).shape == (2, 2, n)
    tau, glow = any_air.path(10.0, [5.0, 500.0])
    np.testing.assert_array_equal(tau, any_air.transmittance(10.0, [5.0, 500.0]))
    np.testing.assert_array_equal(glow, any_air.path_radiance(10.0, [5.0, 500.0]))


def test_provenance_says_where_the_numbers_come_from(any_air):
    assert {"table", "levels", "fortran_sha256", "built", "sha256"} <= set(any_air.provenance)


@pytest.mark.parametrize(
    ("bad", "names"),
    [
        (lambda: model_air("arctic", 5.0, (3.0, 5.0)), "midlatitude-summer"),
        (lambda: model_air("midlatitude-summer", 5.0, (3.0, 5.0)).transmittance(1e-3, 10.0), "height"),
        (lambda: model_air("midlatitude-summer", 5.0, (3.0, 5.0)).transmittance(10.0, np.nan), "range_m"),
        (lambda: model_air("midlatitude-summer", 5.0, (3.0, 5.0)).sky_radiance(1.7, 0.0), "zenith"),
        (lambda: model_air("midlatitude-summer", 5.0, (3.0, 5.0)).solar_irradiance(60.0), "radians"),
    ],
)
def test_what_there_is_not_is_refused(bad, names):
    with pytest.raises(DomainError, match=names):
        bad()
