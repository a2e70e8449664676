"""Beyond the table: refused, or taken from its edge the way the documentation says, and said so."""

import numpy as np
import pytest

from seaglint.air.table.lowtran7 import TableAtmosphere
from seaglint.base.conventions import horizon_range, view_zenith_of_range
from seaglint.base.errors import DomainError
from seaglint.optics.band import Band

MODEL, BAND = "us-standard-1976", (8.0, 12.0)


@pytest.fixture(scope="module")
def extrapolated_air() -> TableAtmosphere:
    return TableAtmosphere.load(MODEL, 8.0, BAND, extrapolate=True)


def band(air, spectrum):
    return spectrum @ Band.rectangular(*BAND).weights(air.wavenumber_cm)


def test_inside_nothing_changes_and_nothing_is_marked(extrapolated_air):
    plain = TableAtmosphere.load(MODEL, 8.0, BAND)
    np.testing.assert_array_equal(extrapolated_air.transmittance(50.0, 4000.0), plain.transmittance(50.0, 4000.0))
    assert extrapolated_air.extrapolated == ()
    assert extrapolated_air.extrapolated_at(50.0) == ()


def test_stronger_winds_are_the_strongest():
    strong = TableAtmosphere.load(MODEL, 25.0, BAND, extrapolate=True)
    edge = TableAtmosphere.load(MODEL, 20.0, BAND)
    np.testing.assert_array_equal(strong.transmittance(50.0, 4000.0), edge.transmittance(50.0, 4000.0))
    assert strong.extrapolated == ("wind_speed",)
    assert strong.extrapolated_at(0.5) == ("wind_speed", "sensor_height")


def test_heights_beyond_are_marked(extrapolated_air):
    assert [extrapolated_air.extrapolated_at(h) for h in (1.9, 2.0, 10000.0, 10001.0)] == [("sensor_height",), (), (), ("sensor_height",)]


def test_from_below_two_metres_the_path_of_equal_length_counts(extrapolated_air):
    # At 3 km a height of 0.5 or 2 m changes the length by less than a metre.
    np.testing.assert_allclose(extrapolated_air.transmittance(0.5, 3000.0), extrapolated_air.transmittance(2.0, 3000.0), rtol=1e-3)


def test_from_above_ten_kilometres_the_part_of_the_ray_below_counts(extrapolated_air):
    # The sea point sees 12 km and 10 km in the same direction at different ranges.
    arc = {h: np.interp(np.radians(70.0), view_zenith_of_range(h, r := np.linspace(1.0, 60e3, 4000)), r) for h in (10e3, 12e3)}
    np.testing.assert_allclose(extrapolated_air.transmittance(12e3, arc[12e3]), extrapolated_air.transmittance(10e3, arc[10e3]), rtol=1e-4)


@pytest.mark.parametrize("height", [0.5, 2.0, 10e3, 14e3])
def test_the_horizon_stays_the_darkest_path(extrapolated_air, height):
    tau = band(extrapolated_air, extrapolated_air.transmittance(height, np.linspace(0.0, horizon_range(height), 50)))
    assert np.all(np.isfinite(tau))
    assert np.all(np.diff(tau) < 1e-9)


def test_the_sky_from_above_is_that_of_ten_kilometres(extrapolated_air):
    np.testing.assert_array_equal(
        extrapolated_air.sky_radiance([0.0, 1.0], 0.0, 12e3), extrapolated_air.sky_radiance([0.0, 1.0], 0.0, 10e3)
    )


@pytest.mark.parametrize(
    ("bad", "names"),
    [
        (lambda: TableAtmosphere.load(MODEL, -1.0, BAND, extrapolate=True), "wind_speed = -1"),
        (lambda: TableAtmosphere.load(MODEL, np.nan, BAND, extrapolate=True), "wind_speed = nan"),
        (lambda: TableAtmosphere.load(MODEL, 5.0, (5.0, 6.0), extrapolate=True), "beyond the table of 2-5.51 um"),
        (lambda: TableAtmosphere.load(MODEL, 5.0, BAND, extrapolate=True).transmittance(-1.0, 10.0), "height = -1"),
        (lambda: TableAtmosphere.load(MODEL, 21.0, BAND), "outside 0-20 m/s"),
        (lambda: TableAtmosphere.load(MODEL, 5.0, BAND).transmittance(1.0, 10.0), "outside 2-10000 m"),
    ],
)
def test_the_rest_is_refused(bad, names):
    with pytest.raises(DomainError, match=names):
        bad()
