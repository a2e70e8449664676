import numpy as np
import pytest

from seaglint.base.errors import DomainError
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
    (8.0, 1.291, 0.0343),
    (10.0, 1.218, 0.0508),
    (11.0, 1.153, 0.0968),
    (12.0, 1.111, 0.199),
    (14.0, 1.210, 0.370),
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


@pytest.mark.parametrize(
    ("wavelength", "segelstein", "article"), [(4.0, -0.080, -0.125), (5.0, -0.097, -0.006), (8.5, -0.142, 0.28), (11.0, -0.189, 1.71)]
)
def test_the_choice_of_an_index_costs_what_the_docs_say(wavelength, segelstein, article):
    """Change of reflectance at nadir against the default; the table in the physics page."""
    default, *others = (
        float(reflectance(1.0, i().index(1e4 / wavelength))) for i in (sea_water.hale_querry_sea, sea_water.segelstein, sea_water.article)
    )
    assert [o / default - 1.0 for o in others] == pytest.approx([segelstein, article], abs=6e-3)  # printed in per cent


def test_article_index_at_four_micrometres():
    m = sea_water.article().index(np.array([2500.0, 2000.0]))
    np.testing.assert_array_equal(m.real, 1.33)
    np.testing.assert_allclose(m.imag, 200.0 / (4.0 * np.pi * np.array([2500.0, 2000.0])), rtol=1e-5)


@pytest.mark.parametrize(("model", "low"), [(sea_water.hale_querry_sea, 0.7), (sea_water.segelstein, 0.7), (sea_water.article, 2.0)])
def test_tables_reach_to_fourteen_micrometres(model, low):
    m = model().index(1e4 / np.linspace(low, 14.0, 500))
    assert np.all((m.real > 1.0) & (m.real < 1.6) & (m.imag > 0.0))


def test_outside_the_table_is_refused_with_the_range():
    with pytest.raises(DomainError, match=r"0\.6-20 um of the water index 'hale-querry-sea'"):
        sea_water.hale_querry_sea().index([400.0])
