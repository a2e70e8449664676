import numpy as np
import pytest

from seaglint.errors import DomainError
from seaglint.optics import sea_water
from seaglint.optics.fresnel import reflectance

# Hale & Querry 1973, Table I (pure water): wavelength [um], n, k.
HALE_QUERRY = [
    (3.0, 1.371, 0.272),
    (3.2, 1.478, 0.0924),
    (3.5, 1.400, 0.0094),
    (4.0, 1.351, 0.0046),
    (4.6, 1.330, 0.0147),
    (5.0, 1.325, 0.0124),
]
# Wu & Smith 1997 (Hale-Querry index), nadir emissivity of a calm sea as distributed with NOAA's CRTM: wavelength, 15 deg emissivity.
WU_SMITH_15_DEG = [(3.4, 0.96901), (4.0, 0.97698), (4.5, 0.97901)]


@pytest.mark.parametrize(("wavelength", "n", "k"), HALE_QUERRY)
def test_default_is_the_published_table_plus_salt(wavelength, n, k):
    m = sea_water.hale_querry_sea().index(1e4 / wavelength)
    assert m.real == pytest.approx(n + 0.006, abs=1e-9)
    assert m.imag == pytest.approx(k, rel=1e-9)


@pytest.mark.parametrize(("wavelength", "emissivity"), WU_SMITH_15_DEG)
def test_flat_sea_emits_as_wu_and_smith_say(wavelength, emissivity):
    rho = reflectance(np.cos(np.radians(15.0)), sea_water.hale_querry_sea().index(1e4 / wavelength))
    assert 1.0 - rho == pytest.approx(emissivity, abs=5e-4)  # their salt correction varies with wavelength, ours does not


def test_segelstein_costs_a_twelfth_of_the_reflectance():
    nu = np.array([2500.0])
    default, other = sea_water.hale_querry_sea().index(nu), sea_water.segelstein().index(nu)
    assert (default - other).real == pytest.approx(0.018, abs=0.002)
    assert reflectance(1.0, other) / reflectance(1.0, default) == pytest.approx(0.92, abs=0.01)


def test_article_index_at_four_micrometres():
    m = sea_water.article().index(np.array([2500.0, 2000.0]))
    np.testing.assert_array_equal(m.real, 1.33)
    np.testing.assert_allclose(m.imag, 200.0 / (4.0 * np.pi * np.array([2500.0, 2000.0])), rtol=1e-5)


@pytest.mark.parametrize("model", [sea_water.hale_querry_sea, sea_water.segelstein])
def test_tables_reach_from_two_to_fourteen_micrometres(model):
    m = model().index(1e4 / np.linspace(0.7, 14.0, 500))
    assert np.all((m.real > 1.0) & (m.real < 1.6) & (m.imag > 0.0))


def test_outside_the_table_is_refused_with_the_range():
    with pytest.raises(DomainError, match=r"0\.6-20 um of the water index 'hale-querry-sea'"):
        sea_water.hale_querry_sea().index([400.0])
