"""Band products along the path against spectral sums without a basis."""

import numpy as np
import pytest
from render_scenes import BAND, furnace, table_air

from seaglint.facet.path_basis import path_basis
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.studies.build.profile_air import model_air


def _spectra(air, grid):
    """Emission of the sea, a sky, the Sun: smooth, banded, and cut by the same absorption as the path."""
    nu = air.wavenumber_cm[grid]
    return {"sea": planck_wavenumber(nu, 288.15), "sky": air.sky_radiance(1.4, 0.0)[grid], "sun": air.solar_irradiance(1.2)[grid]}


@pytest.mark.parametrize("height", [2.0, 30.0, 1000.0])
@pytest.mark.parametrize("band", [BAND, Band.rectangular(3.0, 5.0)], ids=["3.5-5", "3-5"])
def test_products_are_the_direct_spectral_integrals(height, band):
    air = model_air("midlatitude-summer", 9.0, (band.min_um, band.max_um))
    arcs = np.geomspace(0.3 * height, 4000.0 * np.sqrt(height), 77)
    basis = path_basis(air, band, height, arcs)
    weights = band.weights(air.wavenumber_cm)
    tau = air.transmittance(height, arcs)
    for name, spectrum in _spectra(air, slice(None)).items():
        got = basis.coefficients @ basis.project(spectrum[basis.grid])
        expected = tau @ (weights * spectrum)
        # twice the module's stated error, which is for 3.5-5 um; where less than 1e-4 comes through nothing is asked
        np.testing.assert_allclose(got, expected, rtol=1.6e-3, atol=1e-6 * expected.max(), err_msg=name)
    np.testing.assert_allclose(basis.path_radiance, air.path_radiance(height, arcs) @ weights, rtol=1.5e-3)


def test_grey_air_needs_one_term_and_more_colours_more():
    nu = furnace()
    grey = path_basis(type(nu).__mro__[1](288.15, nu.wavenumber_cm), BAND, 30.0, np.geomspace(10.0, 1e4, 9))
    assert grey.coefficients.shape[1] == 1
    assert path_basis(nu, BAND, 30.0, np.geomspace(10.0, 1e4, 9)).coefficients.shape[1] > 2


def test_a_range_at_the_foot_and_a_single_range_are_valid():
    air = table_air(5.0)
    at_foot = path_basis(air, BAND, 30.0, np.array([0.0, 0.5]))
    assert np.all(np.isfinite(at_foot.coefficients))
    alone = path_basis(air, BAND, 30.0, np.array([500.0]))
    several = path_basis(air, BAND, 30.0, np.array([400.0, 500.0, 600.0]))
    flat = np.ones(alone.wavenumber_cm.size)
    assert alone.coefficients[0] @ alone.project(flat) == pytest.approx(several.coefficients[1] @ several.project(flat), rel=2e-3)
