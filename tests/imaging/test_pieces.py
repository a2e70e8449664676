"""Pieces of one slope, nearly: merged pieces send what their parts send together."""

import numpy as np
import pytest

from seaglint.facet import facet_sunlight as facet
from seaglint.facet import solar_disc
from seaglint.facet.legs import SMITHS, FacetLaw
from seaglint.facet.roughness import line_of_sight, roughness_of
from seaglint.facet.sunlight import sunlight
from seaglint.imaging import wave_surface as surface
from seaglint.imaging.launch import surface_of
from seaglint.imaging.sweep import walk
from seaglint.sea.slopes.slope_statistics import gaussian_slopes

SLOPES = gaussian_slopes(0.02, 0.015, 0.003, 0.4)


def _found(count, seed=3, spread=0.03):
    """Pieces of random slopes and extents at neighbouring samples."""
    rng = np.random.default_rng(seed)
    made = walk.new_pieces(3)
    made.sample[:count] = 7 + np.arange(count)
    made.extent[:count, 0] = rng.uniform(0.2, 1.0, count)
    made.extent[:count, 1] = -0.05 + 1e-4 * np.cumsum(rng.uniform(0.2, 1.0, count))
    made.arc[:count] = 600.0 + np.arange(count)
    made.slope[:count] = rng.normal(0.02, spread, (count, 2))
    return made


@pytest.mark.kernel
def test_a_merged_piece_has_the_moments_of_its_parts():
    """The first stays alone."""
    made, count = _found(5), 5
    weight = np.diff(made.extent[:count, 1])
    slope, arc, length, top = made.slope[1:count].copy(), made.arc[1:count].copy(), made.extent[1:count, 0].sum(), made.extent[4, 1]
    left = walk.merge(made, count, -0.05, roughness_of(SLOPES, 0.0, SMITHS), (10.0, 1.0, np.inf, 0.5))
    assert left == 2
    assert (made.begin[0], made.sample[0], made.begin[1], made.sample[1]) == (7, 7, 8, 11)
    assert made.extent[1] == pytest.approx((length, top), rel=1e-12)
    assert made.slope[1] == pytest.approx(np.average(slope, axis=0, weights=weight), rel=1e-12)
    covariance = np.cov(slope.T, aweights=weight, ddof=0)
    assert made.spread[1] == pytest.approx((covariance[0, 0], covariance[0, 1], covariance[1, 1]), rel=1e-9)
    assert made.arc[1] == pytest.approx(np.average(arc, weights=weight), rel=1e-12)


@pytest.mark.kernel
@pytest.mark.parametrize(
    ("limits", "left"),
    [((0.0, 1.0, np.inf, 0.5), 4), ((10.0, 1e5, np.inf, 0.5), 4), ((10.0, 1.0, -1.0, 0.5), 4), ((10.0, 1.0, np.inf, 0.5), 2)],
)
def test_limits_keep_pieces_apart(limits, left):
    """Of slope variance, extent and elevation."""
    assert walk.merge(_found(4), 4, -0.05, roughness_of(SLOPES, 0.0, SMITHS), limits) == left


@pytest.mark.kernel
def test_gaps_and_mirrors_are_not_merged():
    made = _found(4)
    made.sample[2:4] += 1
    assert walk.merge(made, 4, -0.05, roughness_of(SLOPES, 0.0, SMITHS), (10.0, 1.0, np.inf, 0.5)) == 3
    calm = roughness_of(gaussian_slopes(0.0, 0.0, 0.0, 0.0), 0.0, SMITHS)
    assert walk.merge(_found(4), 4, -0.05, calm, (10.0, 1.0, np.inf, 0.5)) == 4


@pytest.mark.kernel
@pytest.mark.parametrize("sun_zenith", [0.7, 1.3])
@pytest.mark.parametrize(("depression", "worst"), [(0.03, 0.03), (0.2, 5e-4)])
@pytest.mark.parametrize("turn", [0.0, 0.15])
def test_the_glint_of_a_merged_piece_is_that_of_its_parts(sun_zenith, depression, worst, turn):
    """Gaussian slopes about a mean, by quadrature: of a tenth of the facets' variance, as the renderer allows by default."""
    sun, rough = sunlight(sun_zenith, 0.3, True), roughness_of(SLOPES, 0.3, FacetLaw(4.0, 0.15))
    sight, none = line_of_sight(sun, rough, 0.3 + turn), solar_disc.no_disc_line()
    grazing, mean = (np.sin(depression), np.cos(depression)), np.array([-0.05, 0.02])
    q = np.array([[rough.east_east, rough.east_north], [rough.east_north, rough.north_north]])
    spread = 0.05 * q + 0.04 * np.array([[0.5, 0.2], [0.2, 1.0]]) * q.max() / 2.0
    nodes, weights = np.polynomial.hermite_e.hermegauss(9)
    root = np.linalg.cholesky(spread)
    total = (
        sum(
            a * b * facet.sun_factor(sun, rough, none, sight, grazing, tuple(mean + root @ (x, y)))[0]
            for x, a in zip(nodes, weights, strict=True)
            for y, b in zip(nodes, weights, strict=True)
        )
        / weights.sum() ** 2
    )
    got, _ = facet.sun_factor(sun, rough, none, sight, grazing, tuple(mean), (spread[0, 0], spread[0, 1], spread[1, 1]))
    plain, _ = facet.sun_factor(sun, rough, none, sight, grazing, tuple(mean))
    # grazing facets hide each other, and the law has kinks where they turn away: third order and more
    assert got == pytest.approx(total, rel=worst)
    if depression > 0.1:
        assert abs(plain / total - 1.0) > 0.04  # what is left out without the spread


@pytest.mark.kernel
def test_slopes_of_pieces_are_those_of_single_reads():
    """Near and far apart, over tiles of noise."""
    rng = np.random.default_rng(8)
    tiles = tuple(rng.normal(size=(n, n, k)).astype(np.float32) for n, k in ((16, 1), (32, 2)))
    sea = surface_of(tiles, np.array([2.0, 0.7]), np.array([0.3, 1.1]))
    line = surface.course(sea, 0, np.sin(0.4), np.cos(0.4), (0.0, 0.0))
    arcs = 50.0 + np.cumsum(np.concatenate([rng.uniform(0.1, 1.0, 100), rng.uniform(10.0, 3e3, 30), rng.uniform(0.1, 1.0, 20)]))
    made, count = walk.new_pieces(3), arcs.size
    made.sample[:count], made.extent[:count, 0] = np.arange(count), 0.0
    walk.read_slopes(sea, line, arcs, made, count, surface.new_strip())
    expected = [surface.slopes(sea, line, r) for r in arcs]
    # positions are told in single precision: 3e-4 of a cell at the end of the longest strips
    np.testing.assert_allclose(made.slope[:count], expected, atol=4e-3)
    np.testing.assert_allclose(made.slope[:64], expected[:64], atol=3e-4)


@pytest.mark.kernel
def test_pieces_are_read_in_their_middle():
    """Half way between both ends of each."""
    rng = np.random.default_rng(9)
    sea = surface_of((rng.normal(size=(16, 16, 1)).astype(np.float32),), np.array([2.0]), np.array([0.3]))
    line = surface.course(sea, 0, np.sin(0.4), np.cos(0.4), (0.0, 0.0))
    near = 50.0 + np.cumsum(rng.uniform(0.5, 1.0, 20))
    far = near + rng.uniform(0.1, 0.5, 20)
    made = walk.new_pieces(3)
    made.sample[:20], made.extent[:20, 0] = np.arange(20), far - near
    walk.read_slopes(sea, line, far, made, 20, surface.new_strip())
    assert made.arc[:20] == pytest.approx(0.5 * (near + far), rel=1e-12)
    np.testing.assert_allclose(made.slope[:20], [surface.slopes(sea, line, r) for r in 0.5 * (near + far)], atol=4e-3)
