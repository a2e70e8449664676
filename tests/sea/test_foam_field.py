"""Breaking waves on the tiles of a sea: coverage, crest lengths, lives of breakers, and what readers get of their foam."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from seaglint.imaging import foam_surface
from seaglint.sea.foam import foam_field
from seaglint.sea.foam.breaking_crests import BreakingCrests
from seaglint.sea.foam.coverage_laws import coverage
from seaglint.sea.foam.foam_field import Breakers, FoamField
from seaglint.sea.foam.lace import lace_pattern
from seaglint.sea.spectra import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField


def breaking(wind: float, n: int = 256, shortest: float = 4.0, form: str = "melville-matusov-2002", seed: int = 1) -> FoamField:
    """Return the breaking waves of a fully developed sea with the foam of Monahan's law."""
    spectrum = ElfouhailySpectrum(wind)
    waves = WaveField.create(spectrum, plan_tiles(spectrum, shortest, n), seed, wander=True)
    crests = BreakingCrests.create(coverage("monahan-1980", wind, extrapolate=True), wind, form)
    return FoamField.create(waves, crests, wind, spectrum.wind_to_azimuth, seed)


def covered(field: FoamField, time: float) -> float:
    """Return the mean share of foam of all tiles together."""
    return sum(float(pyramid[-1]) for pyramid in field.shares(time).share)


def one_breaker(speed: float = 4.0, heading: float = 0.4, crests: BreakingCrests | None = None) -> Breakers:
    """Return a breaker in the middle of a tile."""
    law = crests or BreakingCrests.create(0.01, 10.0)
    c = np.array([speed])
    fed = law.active(c)
    decay = (law.life(c) - fed * (1.0 - 0.5 * foam_field.RISE)) / foam_field._ENDED
    half = 2.0 / np.pi * law.crest_length(c)
    place, direction = np.array([[30.0, 30.0]]), np.array([[np.cos(heading), np.sin(heading)]])
    return Breakers(place, direction, np.zeros(1), c, half, law.duration(c), fed, decay, np.array([[0.3, 0.6, 0.1, 0.8]]))


def drawn(breaker: Breakers, time: float, cell: float = 0.125, n: int = 512, drift: tuple[float, float] = (0.2, 0.1)) -> np.ndarray:
    """Return the foam of breakers alone."""
    out = np.zeros((n, n), np.float32)
    foam_field.draw_breakers(breaker, time, 0.0, True, cell, drift, out)
    return out


@pytest.mark.parametrize("wind", [5.0, 10.0, 15.0, 20.0])
def test_drawn_coverage_is_the_law_and_the_integral_of_the_crests(wind: float) -> None:
    field = breaking(wind)
    law = coverage("monahan-1980", wind, extrapolate=True)
    found = np.mean([covered(field, 9.0 * i) for i in range(20)])
    assert found == pytest.approx(law, rel=0.1)
    # c T(c) Lambda(c) by quadrature
    c = np.linspace(field.crests.slowest, field.crests.fastest, 4001)
    assert np.trapezoid(c * field.crests.life(c) * field.crests.density(c), c) == pytest.approx(law, rel=1e-4)


@pytest.mark.parametrize(
    ("form", "edges"), [("melville-matusov-2002", [1.0, 1.5, 2.0, 3.0, 4.5, 7.0]), ("phillips-1985", [1.0, 1.2, 1.5, 2.0, 2.7])]
)
def test_lengths_of_breaking_crests_follow_the_distribution(form: str, edges: list[float]) -> None:
    field = breaking(12.0, form=form)
    bins = len(edges) - 1
    length, squares, times = np.zeros(bins), np.zeros(bins), np.arange(24) * 11.0
    for tile, waves in enumerate(field.waves.tiles):
        for time in times:
            here = np.zeros(bins)
            for slot in field._slots_at(tile, time):
                b = field.breakers(tile, slot)
                part = (time - b.begin) / b.duration
                breaks = (part > 0.0) & (part < 1.0)
                crest = 2.0 * b.half * np.sqrt(np.maximum(1.0 - (2.0 * part - 1.0) ** 2, 0.0))
                here += np.histogram(b.speed[breaks], edges, weights=crest[breaks])[0]
                squares += np.histogram(b.speed[breaks], edges, weights=(crest[breaks] / waves.length**2 / times.size) ** 2)[0]
            length += here / waves.length**2 / times.size
    expected = np.array([np.trapezoid(field.crests.density(c := np.linspace(a, b, 401)), c) for a, b in itertools.pairwise(edges)])
    assert np.all(np.abs(length - expected) < 4.0 * np.sqrt(squares) + 0.02 * expected)
    assert np.all(np.sqrt(squares) < 0.25 * expected)  # the comparison says something


def test_life_of_a_breaker_frame_by_frame() -> None:
    breaker, step = one_breaker(), 1.0 / 30.0
    end = float((breaker.duration + breaker.fed + foam_field.LAST * breaker.decay)[0])
    times = np.arange(0.0, end + 0.5, step)
    frames = [drawn(breaker, t) for t in times]
    area = np.array([frame.sum() for frame in frames]) * 0.125**2
    crest = float((breaker.half * 0.5 * np.pi * breaker.speed * breaker.duration)[0])
    # area of the swath, and the time for which a place is foam
    assert area.max() == pytest.approx(crest, rel=0.2)
    stay = float((breaker.fed * (1 - 0.5 * foam_field.RISE) + breaker.decay * foam_field._ENDED)[0])
    assert area.sum() * step == pytest.approx(crest * stay, rel=0.02)
    assert area[0] == 0.0
    assert area[-1] == 0.0
    # it appears, stays and goes without a jump
    assert np.abs(np.diff(area)).max() < 0.08 * area.max()
    top = int(area.argmax())
    assert np.all(np.diff(area[:top]) > -0.01 * crest)
    assert np.all(np.diff(area[top + 1 :]) < 2e-3 * crest)
    # the front runs with its speed and the drift
    rows, columns = np.nonzero(frames[int(0.9 * breaker.duration[0] / step)] > 0.05)
    heading, drift = breaker.heading[0], np.array([0.2, 0.1])
    age = times[int(0.9 * breaker.duration[0] / step)]
    reach = ((columns + 0.5) * 0.125 - 30.0 - drift[0] * age) * heading[0] + ((rows + 0.5) * 0.125 - 30.0 - drift[1] * age) * heading[1]
    assert reach.max() == pytest.approx(4.0 * age, abs=0.3)


@pytest.mark.parametrize("speed", [1.0, 1.3, 2.0, 4.0, 7.0])
def test_area_does_not_depend_on_the_cells(speed: float) -> None:
    breaker, rng = one_breaker(speed), np.random.default_rng(3)
    time = float(breaker.duration[0] + 0.9 * breaker.fed[0])
    fine = drawn(breaker, time, 0.02, 4096).sum() * 0.02**2
    for cell, n in ((0.1, 1024), (0.25, 512), (1.0, 128)):
        moved = [breaker._replace(place=breaker.place + rng.random((1, 2)) * cell) for _ in range(40)]
        assert np.mean([drawn(one, time, cell, n).sum() for one in moved]) * cell**2 == pytest.approx(fine, rel=0.04)


@pytest.mark.parametrize("heading", [0.0, 0.8, 2.4, -1.3])
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_the_bend_of_a_crest_leaves_its_area(heading: float, share: float) -> None:
    """Its ends lag behind the place where it began, which the bounds of the drawing include."""
    straight = one_breaker(heading=heading)
    straight = straight._replace(half=foam_field.GROUP * straight.half)
    time = share * float(straight.duration[0])
    areas = []
    for bent in (-0.4, 0.3, 1.0):  # no bend, and two
        shape = straight.shape.copy()
        shape[:, 0] = bent
        areas.append(drawn(straight._replace(shape=shape), time).sum())
    assert areas[0] > 50.0
    assert areas[1:] == pytest.approx(2 * [areas[0]], rel=0.02)


@pytest.mark.parametrize("part", [0.1, 0.5, 0.9])
def test_aged_foam_within_a_step_is_that_drawn_at_the_instant(part: float) -> None:
    field = breaking(12.0)
    step = 20
    time = (step + part) * foam_field.AGED_STEP
    for tile, pyramid in enumerate(field.shares(time).share):
        n = foam_field.CELLS_PER_POINT * field.waves.tiles[tile].n
        whole = np.zeros((n, n), np.float32)
        for young in (True, False):
            field._add(tile, time, step, whole, young=young)
        # in total: edges drift by parts of a cell in between
        assert float(pyramid[: n * n].sum()) == pytest.approx(float(np.minimum(whole, 1.0).sum()), rel=3e-3)


def test_waves_break_where_they_are_steep_and_forwards() -> None:
    field = breaking(12.0)
    for tile in range(len(field.waves.tiles)):
        deviation = field.waves.steepness_deviation(tile)
        slot = 7
        b = field.breakers(tile, slot)
        assert b.begin.size > 3
        spacing, n = field.waves.tiles[tile].spacing, field.waves.tiles[tile].n
        middle = (slot + 0.5) * field._bands[tile].slot
        steep = field.waves.steepness(tile, middle)
        assert np.std(steep) == pytest.approx(deviation, rel=0.1)
        # followed to the middle of the slot, with the speed of their waves
        at = b.place - b.heading * (b.speed * foam_field.PHASE_SPEED * (b.begin - middle))[:, None]
        column, row = (np.round(at / spacing).astype(int) % n).T
        assert steep[row, column].mean() > 1.4 * deviation
        assert np.all(b.heading @ np.array(field._forwards(tile)) >= 0.0)
        assert np.mean(b.heading @ np.array(field._forwards(tile))) > 0.75


def test_swell_breaks_where_it_goes() -> None:
    towards = 2.0
    swell = JonswapSpectrum(3.0, 9.0, towards)
    waves = WaveField.create(swell, plan_tiles(swell, 8.0, 128), 1)
    field = FoamField.create(waves, BreakingCrests.create(0.03, 12.0), 12.0, towards + np.pi, 1)
    east, north = np.sin(towards), np.cos(towards)
    assert waves.direction(0) == pytest.approx((east, north), abs=0.1)
    b, turn = field.breakers(0, 3), waves.tiles[0].rotation
    along = b.heading @ np.array([np.cos(turn) * east + np.sin(turn) * north, np.cos(turn) * north - np.sin(turn) * east])
    assert along.min() > 0.6


@pytest.mark.parametrize("towards", [0.4, 2.9])
def test_aged_foam_drifts_downwind(towards: float) -> None:
    spectrum = ElfouhailySpectrum(15.0, towards)
    waves = WaveField.create(spectrum, plan_tiles(spectrum, 4.0, 256), 1)
    field = FoamField.create(waves, BreakingCrests.create(0.04, 15.0), 15.0, towards, 1)
    tile, turn = len(waves.tiles) - 1, waves.tiles[-1].rotation
    n = foam_field.CELLS_PER_POINT * waves.tiles[tile].n
    before, after = np.zeros((2, n, n), np.float32)
    for time, cells in ((10.0, before), (13.0, after)):  # the same breakers, which only decay
        field._add(tile, time, 20, cells, young=False)
    match = np.fft.ifft2(np.conj(np.fft.fft2(before)) * np.fft.fft2(after)).real
    v, u = (np.array(np.unravel_index(match.argmax(), match.shape)) + n // 2) % n - n // 2
    cell, way = waves.tiles[tile].length / n, 3.0 * foam_field.DRIFT * 15.0
    east, north = cell * (np.cos(turn) * u - np.sin(turn) * v), cell * (np.sin(turn) * u + np.cos(turn) * v)
    assert (east, north) == pytest.approx((way * np.sin(towards), way * np.cos(towards)), abs=0.75 * cell)


def test_foam_of_an_instant_depends_on_nothing_but_the_instant() -> None:
    one, other = breaking(10.0), breaking(10.0)
    for time in (0.0, 30.0, 3.0, -20.0, 1e4):
        one.shares(time)
    for time in (3.0, 0.0, 31.0):
        for a, b in zip(one.shares(time).share, other.shares(time).share, strict=True):
            assert np.array_equal(a, b)
    again = one.reseeded(one.waves, 1)
    assert np.array_equal(again.shares(3.0).share[0], other.shares(3.0).share[0])


def test_slots_do_not_pile_up() -> None:
    field = breaking(10.0)
    for time in np.arange(0.0, 200.0, 5.0):
        field.shares(float(time))
    assert len(field._slots) < 150


def test_holes_keep_the_share() -> None:
    rng = np.random.default_rng(8)
    foam = foam_surface.even_foam(0.3)._replace(lace=lace_pattern(3), drifted=(0.37, -5.2))
    places = rng.random((20_000, 2)) * np.array([64.0, 2.0 * np.pi])
    for share in (0.0, 0.02, 0.1, 0.3, 0.5, 0.77, 0.9, 0.99, 1.0):
        for width in (0.05, 0.5, 3.0):
            found = np.array(
                [foam_surface.with_holes(foam, share, (np.sin(a), np.cos(a)), r, width) for r, a in places[:: 1 if width < 0.1 else 5]]
            )
            assert found.mean() == pytest.approx(share, abs=0.02 * min(share, 1.0 - share) + 4.0 * found.std() / np.sqrt(found.size / 30.0))
            assert found.min() >= 0.0
            assert found.max() <= 1.0
    # the holes drift with the water
    still = foam._replace(drifted=(0.0, 0.0))
    for r in (1.0, 20.3):
        moved = foam_surface.with_holes(still._replace(drifted=(0.0, 2.5)), 0.4, (0.0, 1.0), r + 2.5, 0.1)
        assert moved == pytest.approx(foam_surface.with_holes(still, 0.4, (0.0, 1.0), r, 0.1), abs=1e-9)
    # a small reading is mostly foam or water, a large one the share
    small = np.array([foam_surface.with_holes(foam, 0.4, (0.0, 1.0), r, 0.02) for r in np.linspace(0.0, 60.0, 2000)])
    assert small.std() > 0.35
    assert foam_surface.with_holes(foam, 0.4, (0.0, 1.0), 5.0, 2.5) == 0.4


def test_readings_keep_the_mean_and_change_without_a_jump() -> None:
    field = breaking(15.0)
    tiles = field.waves.tiles
    foam = foam_surface.foam_surface(field.shares(5.0), tiles, field.waves.wander, np.full((1, len(tiles)), -1, np.int64), (12.0, -7.0))
    rng = np.random.default_rng(5)
    for t, tile in enumerate(tiles):
        mean = float(field.shares(5.0).share[t][-1])
        places = rng.random((4000, 2)) * foam.tile[t, 1]
        for width in (0.1, 1.4, 5.6, 32.0):
            found = np.array([foam_surface.tile_share(foam, t, u, v, width) for u, v in places])
            assert found.mean() == pytest.approx(mean, abs=5.0 * found.std() / np.sqrt(4000) + 1e-6)
        assert foam_surface.tile_share(foam, t, 3.0, 4.0, 1e12) == pytest.approx(mean, rel=1e-4)
        u, v = places[np.argmax([foam_surface.tile_share(foam, t, u, v, 2.0) for u, v in places])]
        along = np.array([foam_surface.tile_share(foam, t, u, v, width) for width in np.geomspace(0.5, 2048.0, 2401)])
        assert np.abs(np.diff(along)).max() < 0.02
        assert tile.length == pytest.approx(foam.tile[t, 1] / foam.grid[t, 0])
