"""Emissivity of the rough sea: Wu and Smith's table, a brute-force sum over slopes, and conservation."""

import csv

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.facet.emissivity import emissivity, facet_nodes
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.sea.shadowing.smith import projected_area
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, flat

# Wu and Smith 1997 with sea-to-sea reflection, as distributed with NOAA's CRTM coefficients (WuSmith_CM_HQS):
# wavelength um, wind m/s at 12.5 m, then emissivity at 30, 45, 55, 65 deg.
WU_SMITH = [
    (3.4, 0.0, (0.96767, 0.95961, 0.94127, 0.89245)),
    (3.4, 3.0, (0.96732, 0.95848, 0.93926, 0.89198)),
    (3.4, 15.0, (0.96594, 0.95610, 0.93959, 0.90729)),
    (4.0, 10.0, (0.97478, 0.96595, 0.94936, 0.91431)),
    (5.0, 10.0, (0.97769, 0.96935, 0.95346, 0.91950)),
]
WU_SMITH_TOLERANCE = 1e-3  # what the project promises; the table has five digits


@pytest.mark.parametrize(("wavelength_um", "wind", "expected"), WU_SMITH)
def test_wu_smith_rows(wavelength_um, wind, expected):
    slopes = cox_munk_isotropic(wind, height=12.5)
    ours = emissivity(np.radians([30.0, 45.0, 55.0, 65.0]), slopes, hale_querry_sea(), 1e4 / wavelength_um)[:, 0]
    assert ours == pytest.approx(expected, abs=WU_SMITH_TOLERANCE)


def test_wu_smith_table(reference_dir):
    lines = (reference_dir / "emissivity_wu_smith.csv").read_text().splitlines()
    worst = 0.0
    for row in csv.DictReader(line for line in lines if not line.startswith("#")):
        slopes = cox_munk_isotropic(float(row["wind_m/s"]), height=12.5)
        angles = [int(key[2:]) for key, value in row.items() if key.startswith("e_") and value and int(key[2:]) <= 65]
        ours = emissivity(np.radians(angles), slopes, hale_querry_sea(), 1e4 / float(row["wavelength_um"]))[:, 0]
        worst = max(worst, float(np.max(np.abs(ours - [float(row[f"e_{a}"]) for a in angles]))))
    assert worst < WU_SMITH_TOLERANCE


def brute_force(theta, view_azimuth, slopes, index):
    """Midpoint sum over a fine slope plane, directions from vectors: none of the quadrature's frames or splits.

    Emissivities with sea-to-sea reflection and without.
    """
    s = (np.arange(1400) + 0.5) / 1400 * 3.0 - 1.5
    east, north = np.meshgrid(s, s)
    v = np.array([np.sin(theta) * np.sin(view_azimuth), np.sin(theta) * np.cos(view_azimuth), np.cos(theta)])
    normal = np.stack([-east, -north, np.ones_like(east)])
    length = np.sqrt((normal**2).sum(axis=0))
    c = np.tensordot(v, normal, 1) / length
    up = 2.0 * c / length - v[2]
    weight = slopes.density(east, north) * np.maximum(c * length, 0.0)
    mirrored = [weight * reflectance(np.clip(c, 0.0, 1.0), n) for n in index]
    return [np.array([1.0 - m[lit].sum() / weight.sum() for m in mirrored]) for lit in (up >= 0.0, np.s_[:])]


@pytest.mark.parametrize("zenith_deg", [70.0, 90.0, *(pytest.param(z, marks=pytest.mark.validation) for z in (0.0, 50.0, 85.0))])
@pytest.mark.parametrize("slopes", [cox_munk_isotropic(10.0), cox_munk_anisotropic(14.0, np.radians(70.0))])
def test_average_equals_a_brute_force_sum(slopes, zenith_deg):
    """At 4 um, and at 8.5 and 11 um, where there is no published table at hand."""
    theta, azimuth, wavenumber = np.radians(zenith_deg), np.radians(20.0), 1e4 / np.array([4.0, 8.5, 11.0])
    expected = brute_force(theta, azimuth, slopes, hale_querry_sea().index(wavenumber))
    for sea_to_sea, sums in zip((True, False), expected, strict=True):
        ours = emissivity(theta, slopes, hale_querry_sea(), wavenumber, view_azimuth=azimuth, sea_to_sea=sea_to_sea)
        assert ours == pytest.approx(sums, abs=5e-5)  # the grid's own error at its two edges


@pytest.mark.parametrize("zenith_deg", [0.0, 30.0, 65.0, 88.0, 90.0, 90.5])
@pytest.mark.parametrize("wind", [0.0, 0.5, 20.0])
def test_weights_add_up_and_directions_are_consistent(zenith_deg, wind):
    nodes = facet_nodes(np.radians(zenith_deg), cox_munk_isotropic(wind))
    assert nodes.weight.sum() == pytest.approx(1.0, abs=1e-12)
    assert np.all(nodes.weight >= 0.0)
    assert np.array_equal(nodes.meets_sea, nodes.reflected_zenith > np.pi / 2)


def test_the_normalising_area_is_zeisses():
    """Mean of 1/(projection of a facet) over visible area is the visible share of slopes over A+."""
    slopes, theta = cox_munk_isotropic(10.0), np.radians(80.0)
    nodes = facet_nodes(theta, slopes)
    # projection on the horizontal = cos(incidence)/cos(tilt); the tilt follows from incidence and reflected zenith
    cos_tilt = (np.cos(theta) + np.cos(nodes.reflected_zenith)) / (2.0 * nodes.cos_incidence)
    visible_share = (nodes.weight * cos_tilt / nodes.cos_incidence).sum() * projected_area(theta, slopes.mss / 2)
    s = np.random.default_rng(3).normal(0.0, np.sqrt(slopes.mss / 2), 1_000_000)
    assert visible_share == pytest.approx(np.mean(s < 1.0 / np.tan(theta)), abs=2.5e-3)  # five standard errors


def test_a_flat_sea_is_fresnel():
    theta = np.radians([0.0, 40.0, 80.0])
    wavenumber = np.array([2100.0, 2900.0])
    expected = 1.0 - reflectance(np.cos(theta)[:, None], hale_querry_sea().index(wavenumber))
    assert emissivity(theta, flat(), hale_querry_sea(), wavenumber) == pytest.approx(expected, abs=1e-8)  # Chebyshev series of 16 terms


def test_the_limit_of_calm_is_the_flat_sea():
    theta = np.radians([20.0, 60.0])
    almost = emissivity(theta, SlopeStatistics(1e-7, 1e-7), hale_querry_sea(), [2500.0])
    assert almost == pytest.approx(emissivity(theta, flat(), hale_querry_sea(), [2500.0]), abs=1e-5)


def test_continuous_through_the_horizon():
    theta = np.radians(np.linspace(85.0, 91.0, 241))
    e = emissivity(theta, cox_munk_isotropic(8.0), hale_querry_sea(), [2500.0])[:, 0]
    assert np.all(np.isfinite(e))
    assert np.max(np.abs(np.diff(e, 2))) < 2e-4  # no kink at 90 deg


def test_rougher_along_the_view_lifts_grazing_emissivity():
    """Facets turned to a grazing viewer reflect less; swapping upwind and crosswind fails here."""
    slopes = cox_munk_anisotropic(15.0, 0.0)
    view = np.radians(80.0)
    along = emissivity(view, slopes, hale_querry_sea(), [2500.0], view_azimuth=0.0)
    across = emissivity(view, slopes, hale_querry_sea(), [2500.0], view_azimuth=np.pi / 2)
    assert along > across + 0.005


@pytest.mark.parametrize("zenith", [-0.1, np.nan, 4.0])
def test_impossible_angles_are_refused(zenith):
    with pytest.raises(DomainError, match="zenith"):
        facet_nodes(zenith, cox_munk_isotropic(5.0))


def test_a_flat_sea_past_its_horizon_is_refused():
    with pytest.raises(DomainError, match="visible"):
        facet_nodes(np.radians(91.0), flat())
