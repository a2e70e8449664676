"""Reading heights and slopes between lattice points, against plain NumPy."""

import math

import numpy as np
import pytest
from render_scenes import elfouhaily, one_tile, read

from seaglint.base.errors import DomainError
from seaglint.imaging import wave_surface as surface_module
from seaglint.imaging.launch import surface_of
from seaglint.sea.tiles import Tile, Wander
from seaglint.sea.wave_field import Detail, read_share

SPACING, TURN = np.array([2.0, 0.7]), np.array([0.4, 1.9])


def _reach(sea, x, y):
    """The line through a point and its distance along it."""
    r = math.hypot(x, y) or 1.0
    return surface_module.course(sea, 0, x / r, y / r, (0.0, 0.0)), math.hypot(x, y)


def _height(sea, x, y):
    line, r = _reach(sea, x, y)
    return surface_module.height(sea, line, 0, line.part.shape[0], r)


def _slopes(sea, x, y):
    return surface_module.slopes(sea, *_reach(sea, x, y))


def _tiles(n=16):
    """Lattices of noise, one read as a spline and one with heights to be read linearly: every point around a place counts."""
    noise = np.random.default_rng(5).normal(size=(3, n, n)).astype(np.float32)
    return noise[0, ..., None].copy(), np.stack([noise[1], noise[2]], axis=-1)


@pytest.mark.kernel
@pytest.mark.parametrize("point", [(0.0, 0.0), (3.3, -1.7), (-40.2, 55.1), (1e5 + 0.3, -2e5 - 0.1), (31.999, 32.001)])
def test_points_are_sums_over_tiles_read_between_lattice_points(point):
    tiles = _tiles()
    sea = surface_of(tiles, SPACING, TURN)
    z, east, north = sum(read(t, d, a, *map(np.asarray, point)) for t, d, a in zip(tiles, SPACING, TURN, strict=True))
    # lattices are float32; at 1e5 m the fractions keep 10 digits
    assert _height(sea, *point) == pytest.approx(z, abs=2e-6)
    assert _slopes(sea, *point) == pytest.approx((east, north), abs=2e-6)


@pytest.mark.kernel
def test_points_of_a_linear_lattice_are_met_exactly_and_tiles_are_periodic():
    tiles = _tiles()[1:]
    sea = surface_of(tiles, SPACING[:1], np.zeros(1))
    for row, column in ((0, 0), (3, 9), (15, 15), (4, 3)):
        for wrap in (0.0, 32.0, -64.0):
            x, y = 2.0 * column + wrap, 2.0 * row - wrap
            assert _height(sea, x, y) == pytest.approx(float(tiles[0][row, column, 0]), abs=1e-9)


@pytest.mark.kernel
def test_calm_sea_is_level():
    assert _height(surface_of((), np.zeros(0), np.zeros(0)), 3.0, 4.0) == 0.0
    assert _slopes(surface_of((), np.zeros(0), np.zeros(0)), 3.0, 4.0) == (0.0, 0.0)


@pytest.mark.kernel
def test_the_sensor_stands_over_its_origin():
    tiles, origin = _tiles(), (37.3, -412.8)
    there, moved = surface_of(tiles, SPACING, TURN), surface_of(tiles, SPACING, TURN, origin=origin)
    for x, y in ((0.0, 0.0), (5.2, 1.4), (-80.0, 33.0)):
        assert _height(moved, x, y) == pytest.approx(_height(there, x + origin[0], y + origin[1]), abs=2e-6)


@pytest.mark.kernel
@pytest.mark.parametrize("first", [0.0, 77.7, 2e5])
def test_strips_are_read_like_single_samples(first):
    """In every direction, over many periods, with uneven steps of up to two cells."""
    sea = surface_of(_tiles(), SPACING, TURN)
    arcs = first + np.cumsum(np.random.default_rng(2).uniform(0.1, 1.4, surface_module.STRIP))
    strip = surface_module.new_strip()
    for angle in np.linspace(0.0, 6.0, 9):
        line = surface_module.course(sea, 0, np.sin(angle), np.cos(angle), (0.0, 0.0))
        for count in (surface_module.STRIP - 3, 1):
            strip.height[:] = 0.5
            for j in range(2):
                surface_module.add_heights(sea, line, j, arcs, 3, count, strip)
            expected = [surface_module.height(sea, line, 0, 2, r) for r in arcs[3 : 3 + count]]
            # positions are told in 2**-16 of a cell, and noise changes by several of its deviations from cell to cell
            np.testing.assert_allclose(strip.height[:count] - 0.5, expected, atol=3e-4)
            assert np.all(strip.height[count:] == 0.5)


def _wander():
    """Displacements of the two tiles of noise, as those of a sea."""
    return tuple(Wander.of(Tile(16 * d, 16, a, 0.0, 0.5 * np.pi / d), 7, i) for i, (d, a) in enumerate(zip(SPACING, TURN, strict=True)))


@pytest.mark.kernel
@pytest.mark.parametrize("origin", [(0.0, 0.0), (371.3, -4128.6)])
def test_lines_read_tiles_where_they_have_wandered_to(origin):
    """At the knots of a line; between them its displacement is within 2e-4 of a period."""
    tiles, wander, angle, first = _tiles(), _wander(), 2.1, 55.0
    sea = surface_of(tiles, SPACING, TURN, origin=origin, wander=wander)
    line = surface_module.course(sea, 0, np.sin(angle), np.cos(angle), (first, 400.0))
    for m in (0, 1, 7, 40):
        for j in range(2):
            knot = first + m * 16 * SPACING[j] / surface_module.KNOTS_PER_PERIOD
            for r, near in ((knot, 1e-5), (knot + 0.4 * SPACING[j], 2e-4 * 16)):
                east, north = origin[0] + r * np.sin(angle), origin[1] + r * np.cos(angle)
                shift = wander[j](np.array([east]), np.array([north]))
                c, s = np.cos(TURN[j]), np.sin(TURN[j])
                x, y = float(east + shift[0][0]), float(north + shift[1][0])
                expected = np.array([c * x + s * y, c * y - s * x]) / SPACING[j]
                off = np.array(surface_module.position(line, j, r)) - expected
                assert np.abs(off - 16 * np.round(off / 16)).max() < near


@pytest.mark.kernel
def test_heights_and_slopes_are_read_at_one_place():
    """Along a line that wanders, and in strips with uneven steps: slopes are those of the heights beside it, both ways."""
    tiles = tuple(t[..., :1].copy() for t in _tiles())
    sea = surface_of(tiles, SPACING, TURN, wander=_wander())
    arcs = 90.0 + np.cumsum(np.random.default_rng(2).uniform(0.1, 1.4, 900))
    line = surface_module.course(sea, 0, np.sin(1.3), np.cos(1.3), (float(arcs[0]), float(arcs[-1])))
    strip, first = surface_module.new_strip(), 0
    while first < arcs.size:
        count = min(surface_module.STRIP, arcs.size - first)
        strip.height[:] = 0.0
        for j in range(2):
            surface_module.add_heights(sea, line, j, arcs, first, count, strip)
        single = [surface_module.height(sea, line, 0, 2, r) for r in arcs[first : first + count]]
        np.testing.assert_allclose(strip.height[:count], single, atol=3e-4)  # as above
        for r in arcs[first : first + count : 7]:
            east, north = np.zeros(2), np.zeros(2)
            for j, (d, a) in enumerate(zip(SPACING, TURN, strict=True)):
                u, v = surface_module.position(line, j, r)
                x, y = d * (np.cos(a) * u - np.sin(a) * v), d * (np.sin(a) * u + np.cos(a) * v)
                _, east[j], north[j] = read(tiles[j], d, a, np.asarray(x), np.asarray(y))
            assert surface_module.slopes(sea, line, r) == pytest.approx((east.sum(), north.sum()), abs=2e-6)
        first += count


@pytest.mark.kernel
def test_a_line_for_one_arc_is_straight_and_displaced_as_there():
    sea, direction = surface_of(_tiles(), SPACING, TURN, wander=_wander()), (np.sin(0.4), np.cos(0.4))
    whole = surface_module.course(sea, 0, *direction, (100.0, 300.0))
    one = surface_module.course(sea, 0, *direction, (100.0, 100.0))
    still = surface_module.course(surface_of(_tiles(), SPACING, TURN), 0, *direction, (0.0, 0.0))
    for j in range(2):
        assert surface_module.position(one, j, 100.0) == pytest.approx(surface_module.position(whole, j, 100.0), abs=1e-9)
        moved = np.subtract(surface_module.position(one, j, 170.0), surface_module.position(one, j, 100.0))
        expected = np.subtract(surface_module.position(still, j, 170.0), surface_module.position(still, j, 100.0))
        np.testing.assert_allclose(moved, expected, atol=1e-9)


def test_crests_are_what_the_lattices_of_a_level_can_still_add():
    tiles = _tiles()
    sea = surface_of(tiles, SPACING, TURN, levels=((0, 1), (0,)))
    highest = [float(t[..., 0].max()) for t in tiles]
    np.testing.assert_allclose(sea.crest, [[sum(highest), highest[1]], [highest[0], 0.0]])


@pytest.mark.parametrize("n", [2, 12, 100])
def test_tiles_that_are_no_power_of_two_are_refused(n):
    with pytest.raises(DomainError, match="power of two"):
        surface_of((np.zeros((n, n, 3), np.float32),), np.ones(1), np.zeros(1))


@pytest.mark.parametrize("wind", [3.0, 8.0])
def test_heights_and_slopes_that_are_read_have_the_variance_of_the_spectrum(wind):
    """Read at random points of 16 seas, whole and of a coarser level: the spectrum's height, and the slopes that facets are told."""
    waves = elfouhaily(wind, travel_deg=50.0)
    rng, to = np.random.default_rng(11), waves.spectrum.wind_to_azimuth
    for level in Detail.of(waves).levels[:3:2]:
        squares = []
        for seed in range(16):
            parts = [Detail.of(waves.reseeded(seed)).parts[p] for p in level.parts]
            x, y = rng.uniform(-2e4, 2e4, (2, 10_000))
            z, east, north = sum(read(part.coefficients(0.0)[0], part.tiles[0].spacing, part.tiles[0].rotation, x, y) for part in parts).T
            squares.append([np.mean(s**2) for s in (z, east * np.sin(to) + north * np.cos(to), east * np.cos(to) - north * np.sin(to))])
        mean, error = np.mean(squares, axis=0), np.std(squares, axis=0) / np.sqrt(len(squares))
        assert np.all(error[1:] < 0.02 * mean[1:])  # so that a wrong share of interpolation, 5 % of the variance, is seen
        expected = (sum(part.height_variance for part in parts), *level.mss)
        np.testing.assert_array_less(np.abs(mean - expected), 4.0 * error)  # four standard errors


def test_one_tile_is_steep_enough_to_hide_parts_of_itself():
    """The small sea of the ray-marching test has slopes that a grazing view can hide."""
    assert max(one_tile().resolved_mss()) > 1e-3


@pytest.mark.kernel
@pytest.mark.parametrize(("step", "bits", "worst"), [(0.02, 4, 3e-6), (0.06, 3, 3e-6), (0.12, 2, 3e-6), (0.25, 1, 3e-6), (0.5, 0, 1e-6)])
def test_smooth_lattices_are_read_at_some_samples(step, bits, worst):
    """A long wave read at every sixteenth to every sample: cubic between the readings, the same beyond a strip's end."""
    n, spacing = 64, 1.0
    phase = 2.0 * np.pi * np.arange(n) / n
    tile = np.zeros((n, n, 1), np.float32)
    tile[..., 0] = np.sin(phase)[None, :] + 0.5 * np.cos(phase)[:, None]
    sea = surface_of((tile,), np.array([spacing]), np.zeros(1))
    line = surface_module.course(sea, 0, np.sin(0.7), np.cos(0.7), (0.0, 0.0))
    strip, count = surface_module.new_strip(), surface_module.STRIP
    arcs = 1000.0 + step * np.arange(2 * count)
    for first in (0, 5):
        strip.height[:] = 0.25
        surface_module.add_heights(sea, line, 0, arcs, first, count, strip)
        expected = [surface_module.height(sea, line, 0, 1, r) for r in arcs[first : first + count]]
        np.testing.assert_allclose(strip.height - 0.25, expected, atol=worst + 3e-6)
    span = (arcs[count - 1] - arcs[0], step, step)
    assert surface_module.stride(line, 0, span, count) == bits
    assert surface_module.stride(line, 0, (span[0], step, 1.6 * step), count) == 0


@pytest.mark.kernel
def test_strips_keep_the_variance_of_the_shortest_waves():
    """Four cells long, along the line and read as seldom as it may be: cubic between readings keeps what is promised."""
    n = 64
    wave = np.cos(0.5 * np.pi * np.arange(n)) / float(read_share(np.array(0.5 * np.pi), "cubic")) ** 0.5
    sea = surface_of((np.ascontiguousarray(np.tile(wave, (n, 1))[..., None].astype(np.float32)),), np.ones(1), np.zeros(1))
    line = surface_module.course(sea, 0, 1.0, 0.0, (0.0, 0.0))
    strip, count = surface_module.new_strip(), surface_module.STRIP
    step = 1.0 / (2.0 * surface_module.READS_PER_CELL) * (count - 1) / count
    arcs = np.arange(0.0, 5e3, step)
    found = []
    for first in range(0, arcs.size - count, count):
        strip.height[:] = 0.0
        surface_module.add_heights(sea, line, 0, arcs, first, count, strip)
        found.append(strip.height.copy())
    assert surface_module.stride(line, 0, ((count - 1) * step, step, step), count) == 1
    assert 2.0 * np.mean(np.square(found)) == pytest.approx(1.0, abs=0.03)
