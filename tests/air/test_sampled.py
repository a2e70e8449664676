"""An atmosphere splined between nodes: exact where the physics is simple, and what lies outside the nodes is refused."""

import numpy as np
import pytest

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.protocol import Atmosphere, slant_range
from seaglint.air.sampled_air import PathSamples, SampledAtmosphere, SunSamples
from seaglint.air.sun_and_sky import SkySamples, grazing_coordinate, grazing_share
from seaglint.base.conventions import horizon_depression
from seaglint.base.errors import DataError, DomainError
from seaglint.optics.blackbody import planck_wavenumber

NU = np.arange(2000.0, 2600.0, 50.0)
HEIGHT = 100.0
DIP = horizon_depression(HEIGHT)
ARC = np.geomspace(5.0, 35e3, 24)
ANGLES = np.radians([0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0, 88.0, 90.0])


def grey(extinction=1e-4, temperature=285.0, **change):
    """Samples of grey air at one temperature: optical depth proportional to the slant path and, towards the Sun, to an air mass."""
    depth = extinction * slant_range(HEIGHT, ARC)[:, None] * np.ones(NU.size)
    mass = 1.0 / (np.cos(ANGLES) + 0.03)[:, None]
    source = np.full(NU.size, 1e-2)
    given = {
        "height": HEIGHT,
        "path": PathSamples(ARC, np.exp(-depth), -np.expm1(-depth) * planck_wavenumber(NU, temperature)),
        "sun": SunSamples(ANGLES, source * np.exp(-0.2 * mass), source),
        "skies": [SkySamples(0.0, 0.5 * np.pi - ANGLES[::-1], -np.expm1(-0.5 * mass[::-1]) * planck_wavenumber(NU, temperature))],
    }
    return SampledAtmosphere.create(NU, **(given | change))


def test_it_is_an_atmosphere():
    assert isinstance(grey(), Atmosphere)


def test_grey_air_between_the_nodes():
    """A spline over 24 log-spaced nodes of an optical depth that is a power of the path: 1e-4 of the transmittance."""
    air, arc = grey(), np.geomspace(6.0, 34e3, 37)
    depth = 1e-4 * slant_range(HEIGHT, arc)[:, None] * np.ones(NU.size)
    tau, path = air.path(HEIGHT, arc)
    np.testing.assert_allclose(tau, np.exp(-depth), rtol=1e-4)
    np.testing.assert_allclose(path, -np.expm1(-depth) * planck_wavenumber(NU, 285.0), rtol=1e-3)
    np.testing.assert_array_equal(air.transmittance(HEIGHT, arc), tau)
    np.testing.assert_array_equal(air.path_radiance(HEIGHT, arc), path)


def test_an_isothermal_cavity_is_closed():
    """Path plus transmitted blackbody is the blackbody, at nodes and between them, and the sky is one."""
    cavity = IsothermalAtmosphere(290.0, NU, 1e-4)
    sky = planck_wavenumber(NU, 290.0) * np.ones((ANGLES.size, 1))
    air = grey(
        path=PathSamples(ARC, cavity.transmittance(HEIGHT, ARC), cavity.path_radiance(HEIGHT, ARC)),
        skies=[SkySamples(0.0, 0.5 * np.pi - ANGLES[::-1], sky)],
    )
    tau, path = air.path(HEIGHT, np.geomspace(5.0, 35e3, 50))
    blackbody = planck_wavenumber(NU, 290.0)
    np.testing.assert_allclose(path + tau * blackbody, np.broadcast_to(blackbody, tau.shape), rtol=1e-6)
    np.testing.assert_allclose(
        air.sky_radiance(np.linspace(0.0, 0.5 * np.pi, 31), 0.0), np.broadcast_to(blackbody, (31, NU.size)), rtol=1e-9
    )


def test_sunlight_between_the_nodes_and_none_below_the_horizon():
    air, zenith = grey(), np.radians([7.0, 52.0, 83.0, 86.5])
    expected = 1e-2 * np.exp(-0.2 / (np.cos(zenith) + 0.03))
    np.testing.assert_allclose(air.solar_irradiance(zenith)[:, 0], expected, rtol=0.02)  # ten nodes
    np.testing.assert_allclose(air.solar_irradiance(ANGLES)[:, 0], 1e-2 * np.exp(-0.2 / (np.cos(ANGLES) + 0.03)), rtol=1e-9)
    assert np.all(air.solar_irradiance(0.5 * np.pi + 1e-3) == 0.0)


def test_a_sun_without_a_source_keeps_its_values_at_the_nodes():
    """Within 2e-6: 3.8-5 um has a solar spectrum, what is above it is the file's."""
    given = np.full((ANGLES.size, NU.size), 2.0) * np.cos(0.5 * ANGLES)[:, None]
    air = grey(sun=SunSamples(ANGLES, given))
    np.testing.assert_allclose(air.solar_irradiance(ANGLES), given, rtol=2e-6)


def test_paths_that_touch_the_horizon_go_on_beyond_it_and_others_do_not():
    with pytest.raises(DomainError, match=r"range = 4e\+04 m is outside 5-35000 m of sampled atmosphere"):
        grey().transmittance(HEIGHT, 4e4)
    path = PathSamples(
        ARC, np.exp(-1e-4 * slant_range(HEIGHT, ARC))[:, None] * np.ones(NU.size), np.zeros((ARC.size, NU.size)), beyond=True
    )
    tau = grey(path=path).transmittance(HEIGHT, np.array([35e3, 36e3, 38e3]))[:, 0]
    assert np.all(np.diff(tau) < 0.0)
    assert tau[1] == pytest.approx(np.exp(-3.6), rel=0.01)


def test_a_grazed_level_is_a_corner_of_the_sky():
    """Brightness temperature with square-root corners at a grazed ray and none in between: 0.02 K with nine nodes a piece."""
    kink = -0.4 * DIP
    share = grazing_share(np.linspace(0.0, 1.0, 9))
    elevation = np.unique(np.concatenate([-DIP + (kink + DIP) * share, kink - kink * share, np.linspace(0.0, 0.5 * np.pi, 40)]))
    elevation = elevation[np.concatenate([[True], np.diff(elevation) > 1e-12])]

    def temperature(e):
        below = 280.0 + 6.0 * np.sqrt(np.maximum(kink - e, 0.0) / DIP)
        return below + 3.0 * np.sqrt(np.maximum(e - kink, 0.0) * (e < 0.0) / DIP) * np.sqrt(np.maximum(-e, 0.0) / DIP)

    nearest = float(elevation[np.argmin(np.abs(elevation - kink))])
    sky = planck_wavenumber(NU, temperature(elevation)[:, None])
    flat = planck_wavenumber(NU, 250.0) * np.ones((2, 1))
    air = grey(skies=[SkySamples(0.0, np.array([0.0, 0.5 * np.pi]), flat), SkySamples(HEIGHT, elevation, sky, DIP, (nearest, 0.0))])
    asked = np.linspace(-DIP, 0.0, 101)
    found = air.sky_radiance(0.5 * np.pi - asked, 0.0, HEIGHT)
    np.testing.assert_allclose(found, planck_wavenumber(NU, temperature(asked)[:, None]), rtol=1e-3)


def test_grazing_coordinate_and_its_inverse():
    x = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(grazing_share(grazing_coordinate(x)), x, atol=1e-12)


@pytest.mark.parametrize(
    ("ask", "told"),
    [
        (lambda air: air.transmittance(90.0, 1e3), "sensor height = 90 m: sampled atmosphere holds paths to 100 m only"),
        (lambda air: air.transmittance(HEIGHT, 1.0e5), "outside 5-35000 m"),
        (lambda air: air.transmittance(HEIGHT, -1.0), "range_m holds -1 m"),
        (lambda air: air.solar_irradiance(-0.1), "outside 0-pi rad"),
        (
            lambda air: air.sky_radiance(0.1, 0.0, HEIGHT),
            r"holds the sky from 0 m only; .* down to the sea horizon at a zenith angle of 90\.30 deg",
        ),
        (lambda air: air.sky_radiance(np.radians(90.5), 0.0), "directions below the sea horizon see the sea"),
    ],
)
def test_what_is_outside_is_refused(ask, told):
    with pytest.raises(DomainError, match=told):
        ask(grey())


def test_angles_outside_the_samples_are_refused():
    some = slice(2, 8)
    air = grey(
        sun=SunSamples(ANGLES[some], np.ones((6, NU.size))),
        skies=[SkySamples(0.0, 0.5 * np.pi - ANGLES[some][::-1], np.ones((6, NU.size)))],
    )
    with pytest.raises(DomainError, match="solar zenith = 10 deg is outside 30-85 deg"):
        air.solar_irradiance(np.radians(10.0))
    with pytest.raises(DomainError, match=r"seen from the sea: .* outside 30-85 deg of .* down to 90 deg"):
        air.sky_radiance(np.radians(86.0), 0.0)


def test_the_sky_of_a_sensor_that_ends_at_the_horizontal_is_asked_for_down_to_the_sea_horizon():
    """The angle told, as printed, is enough; from 100 m the horizon is 0.297 deg below the horizontal."""

    def grey_air_from(lowest):
        ends = np.radians([90.0 - lowest, 90.0])
        return grey(
            skies=[SkySamples(0.0, np.radians([0.0, 90.0]), np.ones((2, NU.size))), SkySamples(HEIGHT, ends, np.ones((2, NU.size)), DIP)]
        )

    horizon = 0.5 * np.pi + DIP
    with pytest.raises(DomainError, match=r"sky seen from the sensor at 100 m: zenith angles outside 0-90 deg") as error:
        grey_air_from(90.0).sky_radiance(horizon, 0.0, HEIGHT)
    told = float(str(error.value).split("sea horizon at ")[1].removesuffix(" deg"))
    assert np.radians(told) == pytest.approx(horizon, abs=np.radians(0.005))
    assert np.all(np.isfinite(grey_air_from(told).sky_radiance(horizon, 0.0, HEIGHT)))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"skies": []}, "no sky seen from the sea"),
        ({"path": PathSamples(ARC[:1], np.ones((1, NU.size)), np.ones((1, NU.size)))}, "range_m: 1 nodes"),
        ({"path": PathSamples(ARC[::-1], np.ones((24, NU.size)), np.ones((24, NU.size)))}, "ascending"),
        ({"path": PathSamples(np.array([0.0, 1e-3]), np.ones((2, NU.size)), np.ones((2, NU.size)))}, "all straight below"),
    ],
)
def test_samples_that_cannot_be_splined_are_refused(change, told):
    with pytest.raises(DataError, match=told):
        grey(**change)
