"""Variance of glint against simulated cells and against the two limits of section 'Computing spatial variance' of the article."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seaglint.base.errors import DomainError
from seaglint.facet.glint import glint
from seaglint.facet.legs import VIEWER
from seaglint.radiance.variance import glint_variance, patches, point_variance
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic

CELL = 0.0026  # m


def _relative(chance, solid_angle, *, view_zenith=0.0, solar_zenith=0.0, slant_range=1000.0, cell=CELL):
    """Variance over squared mean for the mirroring facet of a view and a Sun of the same or opposite azimuth (towards the Sun)."""
    cos_incidence = np.cos(0.5 * (view_zenith + solar_zenith))
    return glint_variance(1.0, chance, cos_incidence, view_zenith, solar_zenith, slant_range, solid_angle, cell)


@pytest.mark.parametrize("chance", [0.02, 0.3, 0.9])
@pytest.mark.parametrize("side", [1, 3, 8])
def test_blocks_of_independent_cells_seen_from_above(chance, side):
    # From the zenith with the Sun there the mirroring cells are level: each fills its own share of the view.
    rng = np.random.default_rng(7)
    seen = (rng.random((20_000, side * side)) < chance).mean(axis=1)
    solid_angle = (side * CELL / 1000.0) ** 2
    # Variance of 20,000 means: 5 standard errors, kurtosis of a rare Bernoulli cell 50 at most.
    assert _relative(chance, solid_angle) == pytest.approx(seen.var() / chance**2, rel=5 * np.sqrt(60 / 20_000))


def _facets_along_a_line(view_zenith, solar_zenith, share, rng, cells=4_000_000):
    """Ends of the mirroring facets' pictures across the line of sight, and the whole picture's length; cells of length 1.

    Cells on a line away from the viewer, a share of them tilted to mirror the Sun, the others evenly tilted so that the sea is level.
    A cell of slope s pictures ``cos(theta_v) - s sin(theta_v)``, positive for all: no facet hides.
    """
    mirroring = rng.random(cells) < share
    slope = np.tan(0.5 * (view_zenith - solar_zenith))  # sin/cos of the half angle between, towards the viewer negative
    lengths = np.where(mirroring, np.cos(view_zenith) + slope * np.sin(view_zenith), 0.0)
    lengths[~mirroring] = np.cos(view_zenith) - share / (1 - share) * slope * np.sin(view_zenith)
    ends = np.cumsum(lengths)
    return ends[mirroring] - lengths[mirroring], ends[mirroring], ends[-1], lengths.min() > 0.0


def _share_below(starts, ends, x):
    """Length of mirroring pictures below x."""
    done = np.concatenate([[0.0], np.cumsum(ends - starts)])
    index = np.searchsorted(starts, x)
    inside = np.where(index > 0, np.maximum(ends[np.maximum(index - 1, 0)] - x, 0.0), 0.0)
    return done[index] - inside


@pytest.mark.parametrize("solar_zenith_deg", [50.0, 75.0, pytest.param(60.0, marks=pytest.mark.validation)])
@pytest.mark.parametrize(("width", "tolerance"), [(0.002, 0.04), (100.0, 0.05)])
def test_tilted_cells_seen_at_a_slant_simulated_along_a_line(solar_zenith_deg, width, tolerance):
    # The one-dimensional case of the formula: M is a length over a length. Windows laid at random over simulated facets; ``width`` is
    # in pictures of a mirroring cell. Tolerances: 4 standard errors of 1,000,000 windows, or 3 of the 4,000,000 cells they see, 0.5 % of
    # which mirror; hiding no cell, the line leaves (1 - P)/(1 - share) = 0.99 and a window's edges 1 - 1/(3 M).
    theta, sun, share = np.radians(80.0), np.radians(solar_zenith_deg), 0.005
    rng = np.random.default_rng(11)
    starts, ends, total, all_face = _facets_along_a_line(theta, sun, share, rng)
    assert all_face
    chance = float(np.sum(ends - starts) / total)
    window = width * float(ends[0] - starts[0])
    at = rng.random(1_000_000) * (total - window)
    seen = (_share_below(starts, ends, at + window) - _share_below(starts, ends, at)) / window
    simulated = seen.var() / chance**2
    # A square of the window's side has M^2 where the line has M; both limits are then read from the same function.
    m = float(patches(np.cos(0.5 * (theta + sun)), theta, sun, 1.0, window, 1.0))
    assert m == pytest.approx(width, rel=1e-6)
    assert point_variance(1.0, chance) / max(m, 1.0) == pytest.approx(simulated, rel=tolerance)


@pytest.mark.parametrize("depression_deg", [0.5, 2.0, 10.0, 60.0])
@pytest.mark.parametrize("wind_speed", [3.0, 10.0])
def test_sparse_limit_is_the_share_of_sea_area(depression_deg, wind_speed):
    # l^2 / (A P_h S) with Eq. 12's P_h from the slope density itself, not from the share of the view.
    theta, sun, eps, r, omega = np.radians(90.0 - depression_deg), np.radians(60.0), 4.65e-3, 3000.0, 1e-6
    slopes = cox_munk_isotropic(wind_speed, height=12.5)
    found = glint(theta, np.pi, sun, 0.0, slopes, VIEWER)
    half, beta = 0.5 * (theta + sun), 0.5 * abs(theta - sun)
    variance = slopes.mss_up
    p = np.exp(-0.5 * np.tan(beta) ** 2 / variance) / (2.0 * np.pi * variance)
    nu = 1.0 / np.tan(theta) / np.sqrt(2.0 * variance)
    from scipy.special import erf

    saunders = 2.0 / (1.0 + erf(nu) + np.exp(-(nu**2)) / (nu * np.sqrt(np.pi)))
    sea_share = np.pi * eps**2 * p / (4.0 * np.cos(half) * np.cos(beta) ** 3) * saunders
    area = omega * r**2 / np.cos(theta)
    expected = CELL**2 / (area * sea_share)
    relative = glint_variance(1.0, found.chance, found.cos_incidence, theta, sun, r, omega, CELL)
    # Within P itself (a share below 1 %), the seven points on the disc (1e-3) and the value of the solar radius (2e-3).
    assert float(relative) == pytest.approx(float(expected), rel=0.02)


def test_factor_between_shares_of_view_and_sea_at_two_degrees():
    # cos(omega)/(cos(beta) cos(theta_v)) is 8 at 2 deg depression, Sun 60 deg: what Eq. 18 with the share of the view would lose.
    theta, sun = np.radians(88.0), np.radians(60.0)
    area = 1e-6 * 1000.0**2 / np.cos(theta)
    lost = _relative(1e-6, 1e-6, view_zenith=theta, solar_zenith=sun) / (CELL**2 / (area * 1e-6))
    assert float(lost) == pytest.approx(8.0, rel=0.05)


@pytest.mark.parametrize("share_of_cell", [1e-6, 0.1, 0.99])
@pytest.mark.parametrize("view_zenith_deg", [0.0, 60.0, 88.0])
def test_below_a_cell_it_is_the_points(share_of_cell, view_zenith_deg):
    theta = np.radians(view_zenith_deg)
    omega = share_of_cell * CELL**2 * np.cos(theta) / 1000.0**2  # A = share of l^2
    assert _relative(0.2, omega, view_zenith=theta, solar_zenith=0.0) == pytest.approx(4.0)  # 1/0.2 - 1


@given(st.floats(1e-8, 1.0), st.floats(0.0, 1.57), st.floats(0.0, 1.57), st.floats(1.0, 100.0))
def test_larger_detectors_see_no_more_and_never_more_than_their_number(chance, view_zenith, solar_zenith, larger):
    omega = np.geomspace(1e-14, 1e-2, 50)
    variance = _relative(chance, omega, view_zenith=view_zenith, solar_zenith=solar_zenith)
    wider = _relative(chance, larger * omega, view_zenith=view_zenith, solar_zenith=solar_zenith)
    assert np.all(wider <= variance)
    assert np.all(variance <= wider * larger * (1.0 + 1e-12))


def test_footprint_of_a_rectangular_pixel_and_range_enter_as_an_area():
    square = _relative(1e-3, 1e-6)
    assert _relative(1e-3, 2e-3 * 0.5e-3) == pytest.approx(float(square))
    assert _relative(1e-3, 1e-6, slant_range=2000.0) == pytest.approx(float(square) / 4.0)
    assert _relative(1e-3, 1e-6, cell=2.0 * CELL) == pytest.approx(4.0 * float(square))


def test_no_glint_no_variance_and_a_mirror_has_none():
    assert point_variance(0.0, 0.0) == 0.0
    assert point_variance(3.0, 1.0) == 0.0
    assert point_variance(3.0, 1.0 + 1e-13) == 0.0  # rounding of P


def test_finite_at_the_horizon():
    assert np.isfinite(_relative(1e-4, 1e-6, view_zenith=0.5 * np.pi, solar_zenith=np.radians(89.9)))


@pytest.mark.parametrize(
    ("change", "text"),
    [({"solid_angle": 0.0}, "solid_angle = 0 sr"), ({"cell": -1.0}, "correlation_length = -1 m"), ({"cell": np.nan}, "nan")],
)
def test_no_detector_or_no_cell_is_refused(change, text):
    with pytest.raises(DomainError, match=text):
        _relative(0.1, change.pop("solid_angle", 1e-6), **change)
