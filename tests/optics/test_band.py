import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from seaglint.base.errors import DataError, DomainError
from seaglint.optics.band import ARTICLE_UNIT, ApparentTemperature, Band, apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber

GRID = np.arange(1980.0, 3361.0, 5.0)
LWIR_GRID = np.arange(710.0, 1430.0, 5.0)


@pytest.mark.parametrize(
    ("band", "grid", "contrast"),
    [(Band.rectangular(3.0, 5.0), GRID, 0.4217), (Band.rectangular(8.0, 12.0), LWIR_GRID, 0.172)],
    ids=["mwir", "lwir"],
)
def test_contrast_of_the_article(band, grid, contrast):
    cold, warm = band.radiance([300.0, 310.0], grid)
    assert (warm - cold) / cold == pytest.approx(contrast, abs=5e-4)  # printed digits of an independent calculation


def test_blackbody_of_the_article_is_293_kelvin():
    band = Band.rectangular(3.0, 5.0)
    assert ARTICLE_UNIT * band.radiance(292.4, GRID) == pytest.approx(140.7, abs=0.05)
    assert apparent_temperature(145.0 / ARTICLE_UNIT, band, GRID) == pytest.approx(293.2, abs=0.05)


@given(st.floats(3.0, 3.9), st.floats(4.0, 5.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_weights_integrate_linear_spectra_exactly_between_any_edges(low, high, a, b):
    nu0, nu1 = 1e4 / high, 1e4 / low
    exact = a * (nu1 - nu0) + b * (nu1**2 - nu0**2) / 5000.0
    assert Band.rectangular(low, high).weights(GRID) @ (a + b * GRID / 2500.0) == pytest.approx(exact, rel=1e-11, abs=1e-9)


@pytest.mark.parametrize("step", [1.0, 5.0, 20.0])
def test_a_response_is_integrated_as_drawn(step):
    wavelength, response = [3.4, 3.7, 4.2, 4.25, 4.9], [0.0, 0.5, 2.0, 1.0, 0.2]
    grid = np.arange(1980.0, 3361.0, step)
    spectrum = planck_wavenumber(grid, 300.0)
    band = Band.from_response(wavelength, response)

    def integrand(nu):
        return np.interp(1e4 / nu, wavelength, np.array(response) / 2.0) * np.interp(nu, grid, spectrum)

    corners = np.unique(np.concatenate([1e4 / np.array(wavelength), grid[(grid > 1e4 / 4.9) & (grid < 1e4 / 3.4)]]))
    exact = sum(quad(integrand, a, b)[0] for a, b in itertools.pairwise(corners))
    assert band.weights(grid) @ spectrum == pytest.approx(exact, rel=1e-10)  # both are Gauss rules on smooth pieces


def test_band_of_a_table_turned_round_is_the_same():
    w, r = np.array([3.0, 3.5, 4.0, 5.0]), np.array([0.1, 0.7, 1.0, 0.0])
    np.testing.assert_array_equal(Band.from_response(w, r).weights(GRID), Band.from_response(w[::-1], 5.0 * r[::-1]).weights(GRID))


def test_dead_ends_of_a_response_need_no_grid():
    band = Band.from_response([1.0, 2.0, 3.2, 4.0, 4.8, 9.0, 12.0], [0, 0, 0, 1, 0, 0, 0])
    assert (band.min_um, band.max_um) == (3.2, 4.8)


@given(st.floats(100.0, 6500.0))
def test_apparent_temperature_of_a_blackbody_is_its_own(temperature):
    band = Band.rectangular(3.5, 5.0)
    assert apparent_temperature(band.radiance(temperature, GRID), band, GRID) == pytest.approx(temperature, abs=1e-4)


def test_no_temperature_is_nan_not_a_guess():
    band = Band.rectangular(3.0, 5.0)
    t = apparent_temperature([[0.0, -1.0], [np.nan, 1e9]], band, GRID)
    assert t.shape == (2, 2)
    assert np.all(np.isnan(t))


def test_all_pixels_are_looked_up_in_one_call():
    """A picture's pixels one by one would take minutes."""
    table = ApparentTemperature.create(Band.rectangular(3.0, 5.0), GRID).spline
    asked = []
    counted = type("Counted", (), {"x": table.x, "__call__": lambda self, x: asked.append(x.shape) or table(x)})()
    temperature = ApparentTemperature(counted)(np.linspace(0.5, 50.0, 10_000).reshape(100, 100))
    assert asked == [(100, 100)]
    assert np.all(np.isfinite(temperature))


def test_band_beyond_the_grid_is_refused_with_the_grid_named():
    with pytest.raises(DomainError, match=r"8-12 um reaches beyond the spectral grid 2\.97.*-5\.0"):
        Band.rectangular(8.0, 12.0).weights(GRID)


@pytest.mark.parametrize(("low", "high"), [(5.0, 3.0), (0.0, 3.0), (3.0, 3.0), (np.nan, 5.0)])
def test_empty_bands_are_refused(low, high):
    with pytest.raises(DomainError, match="0 < min_um < max_um"):
        Band.rectangular(low, high)


@pytest.mark.parametrize(
    ("wavelength", "response", "text"),
    [
        ([3.0, 3.0, 4.0], [0, 1, 0], "all different"),
        ([3.0, 4.0], [0.0, 0.0], "somewhere > 0"),
        ([3.0, 4.0], [1.0, -0.1], ">= 0"),
        ([3.0, 4.0], [1.0, np.nan], "finite"),
        ([3.0], [1.0], "2 rows"),
    ],
)
def test_unusable_responses_are_refused(wavelength, response, text):
    with pytest.raises(DataError, match=text):
        Band.from_response(wavelength, response)


def test_apparent_temperature_keeps_the_coordinates_of_labelled_arrays():
    import xarray as xr

    band, grid = Band.rectangular(3.5, 5.0), np.arange(1995.0, 2865.0, 5.0)
    values = np.array([[1.0, 2.0, 0.5], [0.1, 1.5, 3.0]])
    coordinates = {"elevation": ("y", [1.0, -1.0]), "azimuth": ("x", [3.0, 4.0, 5.0])}
    given = xr.DataArray(values, dims=("y", "x"), coords=coordinates, name="radiance", attrs={"units": "W m-2 sr-1"})
    found = apparent_temperature(given, band, grid)
    assert isinstance(found, xr.DataArray)
    np.testing.assert_array_equal(found, apparent_temperature(values, band, grid))
    assert (found.name, found.attrs["units"], given.attrs["units"]) == ("apparent_temperature", "K", "W m-2 sr-1")
    xr.testing.assert_equal(found.azimuth, given.azimuth)
    xr.testing.assert_equal(found.elevation, given.elevation)
