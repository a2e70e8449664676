"""Where levels of detail begin and lines part, against the lattices averaged over pixels by their spectra."""

from dataclasses import replace

import numpy as np
import pytest
from render_scenes import furnace, sea_view, swept_scene

from seaglint.base.conventions import horizon_range
from seaglint.base.errors import DomainError
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import AVERAGED_ASIDE, AVERAGED_SHARE, AVERAGED_WIDTH, LEAST_SHARE, Accuracy, Levels, averaged_share, averages
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import Detail, WaveField

CAMERA = Camera(30.0, 0.0, np.radians(-10.0), np.radians(4.0), np.radians(3.0), 64, 48)
LAST = 20000.0

#: Accuracy with many lines of sight in place of averaged seas, just below the least error for these.
LINES = Accuracy(variance_error=0.0199)


@pytest.fixture(scope="module")
def waves():
    spectrum = ElfouhailySpectrum(8.0, 0.7)
    return WaveField.create(spectrum, plan_tiles(spectrum, 1.0, 128), 5)


@pytest.fixture(scope="module")
def detail(waves):
    return Detail.of(waves)


def coarse(of=CAMERA):
    return replace(of, columns=of.columns // 4, rows=of.rows // 4)


def footprint(camera, arc):
    """Width and length of a pixel on the mean sea [m]."""
    return arc * camera.column_step, camera.row_step * (arc**2 + camera.height**2) / camera.height


def variances(detail, camera, arc):
    """Slope variance of each level's lattices averaged over pixels, along and across the look, mean of both ways to lay pixels [1]."""
    sides, parts = footprint(camera, arc), []
    for part in detail.parts:
        tile = part.tiles[0]
        k = np.fft.fftfreq(tile.n, tile.spacing)
        power = np.abs(np.fft.fft2(part.surfaces(0.0)[0][..., 1:], axes=(0, 1)) / tile.n**2).sum(axis=-1) ** 2
        box = [np.sinc(k[:, None] * a) * np.sinc(k[None, :] * b) for a, b in (sides, sides[::-1])]
        parts.append(np.mean([(power * one**2).sum() for one in box]))
    return np.array([sum(parts[p] for p in level.parts) for level in detail.levels])


@pytest.mark.parametrize(
    "camera",
    [CAMERA, coarse(), coarse(coarse()), replace(coarse(coarse()), height=100.0), replace(coarse(coarse()), height=200.0)],
    ids=["fine", "coarse", "coarsest", "high", "higher"],
)
def test_levels_leave_out_what_pixels_average_anyway(waves, detail, camera):
    """Share of the pixels' variance that a level leaves out: near the error where it begins, above it at a quarter of the way."""
    accuracy = LINES
    levels = Levels.of(waves, camera, accuracy, 4000.0)
    assert levels.begins[0] == 0.0
    assert levels.begins.size > 1
    assert np.all(np.diff(levels.begins) > 0.0)
    for k, begin in enumerate(levels.begins[1:], 1):
        before, there = (variances(detail, camera, share * begin) for share in (0.25, 1.0))
        assert 1.0 - there[k] / there[0] < 2.0 * accuracy.variance_error
        assert 1.0 - before[k] / before[0] > accuracy.variance_error


@pytest.mark.parametrize("columns", [0.1, 0.07])
def test_waves_that_span_the_columns_asked_for_stay(waves, columns):
    """With so few columns the error no longer decides: each level begins where its shortest wave spans them."""
    levels = Levels.of(waves, coarse(), replace(LINES, shortest_wave_columns=columns), LAST)
    width = np.array([footprint(coarse(), begin)[0] for begin in levels.begins[1:]])
    assert width.size >= 1
    assert columns * width == pytest.approx(levels.shortest[1:], rel=0.01)


def test_lines_part_where_three_no_longer_fit_a_wave(waves):
    """One level, whose last octave is reckoned as waves of twice the shortest: each doubling serves pixels twice as wide."""
    accuracy = Accuracy(shortest_wave_columns=0.0)
    levels = Levels.of(waves, CAMERA, accuracy, LAST)
    assert levels.begins.tolist() == [0.0]
    lines = 2.0 ** np.arange(levels.parts.size)
    wide = np.array([footprint(CAMERA, arc)[0] for arc in levels.parts])
    assert wide.size == accuracy.lines_per_column.bit_length() - 1
    assert 4.0 * wide / lines == pytest.approx(np.full(wide.size, 2.0 * levels.shortest[0] * (1.0 + accuracy.variance_error)), rel=0.01)
    assert Levels.of(waves, CAMERA, replace(accuracy, lines_per_column=1), LAST).parts.size == 0


def test_steps_follow_the_shortest_wave_of_each_level(waves):
    levels = Levels.of(waves, coarse(), LINES, LAST)
    assert levels.steps == pytest.approx(levels.shortest / Accuracy().steps_per_wave)
    stated = Levels.of(waves, coarse(), replace(LINES, step=0.2), LAST)
    assert stated.steps[0] == pytest.approx(0.2)
    assert stated.steps / stated.shortest == pytest.approx(np.full(stated.steps.size, 0.2 / stated.shortest[0]))
    cell = waves.tiles[-1].spacing  # steps of less than 256 cells are said to be allowed
    assert Levels.of(waves, CAMERA, Accuracy(step=255.0 * cell, shortest_wave_columns=0.0), LAST).steps.size == 1
    with pytest.raises(DomainError, match="less than 256 cells"):
        Levels.of(waves, CAMERA, Accuracy(step=257.0 * cell, shortest_wave_columns=0.0), LAST)


def test_levels_beyond_the_last_arc_are_left_out(waves):
    every = Levels.of(waves, coarse(), LINES, LAST)
    fewer = Levels.of(waves, coarse(), LINES, 0.5 * (every.begins[1] + every.begins[2]))
    assert fewer.begins.size == 2
    assert fewer.begins[1] == pytest.approx(every.begins[1], rel=0.01)


@pytest.mark.parametrize("accuracy", [LINES, Accuracy()], ids=["lines", "averages"])
def test_levels_before_the_first_arc_are_left_out_but_the_finest(waves, accuracy):
    """Rays and the sea under the sensor are read from the finest level, whatever the view."""
    every = Levels.of(waves, coarse(), accuracy, LAST)
    fewer = Levels.of(waves, coarse(), accuracy, LAST, 0.5 * (every.begins[2] + every.begins[3]))
    assert fewer.begins.tolist() == [0.0, *every.begins[2:]]
    assert fewer.numbers == (0, *every.numbers[2:])
    assert fewer.widths == (0.0, *every.widths[2:])
    assert [level.mss for level in fewer.detail.levels[1:]] == [level.mss for level in every.detail.levels[2:]]


def removed(waves, detail, number, width):
    """Share of a level's slope variance that an average over a width removes [1], from its plane waves in all directions."""
    whole = kept = 0.0
    for p in detail.levels[number].parts:
        east, north, _, real, imaginary = detail.parts[p].plane_waves()[0].T
        power = (real**2 + imaginary**2) * (east**2 + north**2)
        angles = np.linspace(0.0, np.pi, 16, endpoint=False)
        across = np.hypot(east, north) * np.cos(np.arctan2(east, north) + angles[:, None])
        whole += power.sum()
        kept += (power * (np.sinc(across * width / (2.0 * np.pi)) ** 2).mean(axis=0)).sum()
    return 1.0 - kept / whole


@pytest.mark.parametrize(
    "camera", [CAMERA, coarse(), coarse(coarse()), replace(coarse(), height=300.0)], ids=["fine", "coarse", "coarsest", "high"]
)
def test_averages_follow_the_distance_of_lines_and_leave_most_slopes(waves, detail, camera):
    """Widths are powers of the root of two next to a share of the distance; few levels lose more of their slopes than allowed."""
    levels = Levels.of(waves, camera, Accuracy(), LAST)
    ends = np.append(levels.begins[1:], LAST)
    averaged = np.array(levels.widths) > 0.0
    assert averaged.any()
    assert not averaged[0]
    assert np.all(np.diff(averaged.astype(int)) >= 0)
    for number, width, begin, end in np.array([levels.numbers, levels.widths, levels.begins, ends]).T[averaged]:
        lines = 2.0 ** np.count_nonzero(levels.parts <= begin * 1.0001)
        for arc in (begin, end):
            assert 2.0**-0.26 < AVERAGED_WIDTH * arc * camera.column_step / lines / width < 2.0**0.27
        row = camera.row_step * (begin**2 + camera.height**2) / camera.height
        if lines < Accuracy().lines_per_column and begin + row < horizon_range(camera.height):
            assert removed(waves, detail, int(number), width) < AVERAGED_SHARE + 0.12
    assert 2.0 * np.log2(np.array(levels.widths)[averaged]) == pytest.approx(np.round(2.0 * np.log2(np.array(levels.widths)[averaged])))


def test_averages_are_for_narrow_views_of_ordinary_accuracy(waves):
    assert averages(CAMERA, Accuracy())
    assert averages(replace(CAMERA, width=2.0 * AVERAGED_ASIDE), Accuracy(variance_error=0.1))
    for camera, accuracy in (
        (replace(CAMERA, width=2.01 * AVERAGED_ASIDE), Accuracy()),
        (CAMERA, Accuracy(variance_error=0.019)),
        (CAMERA, Accuracy(shortest_wave_columns=0.0)),
    ):
        assert not averages(camera, accuracy)
        assert set(Levels.of(waves, camera, accuracy, LAST).widths) == {0.0}


def test_under_a_low_sun_averages_remove_less(waves, detail):
    """The share falls steadily from 15 degrees down; lines are closer, and levels keep that much more of their slopes."""
    zeniths = np.radians(np.linspace(0.0, 90.2, 400))
    shares = np.array([averaged_share(z) for z in zeniths])
    assert np.all(np.diff(shares) <= 0.0)
    assert np.abs(np.diff(shares)).max() < 0.01
    assert (shares[0], shares[-1]) == (averaged_share(np.radians(74.9)), averaged_share(np.radians(89.9))) == (AVERAGED_SHARE, LEAST_SHARE)
    assert averaged_share(np.radians(95.0)) == AVERAGED_SHARE  # at night nothing glints
    most = []
    for share in (AVERAGED_SHARE, LEAST_SHARE):
        levels = Levels.of(waves, coarse(), Accuracy(), LAST, share=share)
        lost = [removed(waves, detail, n, w) for n, w, b in zip(levels.numbers, levels.widths, levels.begins, strict=True) if w and b < 2e3]
        most.append((max(lost), levels.parts.size))
    assert most[1][0] < 0.6 * most[0][0]
    assert most[1][1] > most[0][1]


def test_lines_of_a_scene_are_closer_under_a_low_sun_only(waves):
    """Scenes plan their lines for their own Sun: high, 5 degrees high, and well below the horizon."""
    eye = Camera(30.0, 0.0, np.radians(-4.3), np.radians(16.0), np.radians(8.0), 40, 40)
    views = (sea_view(furnace(), cox_munk_isotropic(8.0), eye.height, zenith) for zenith in (60.0, 85.0, 110.0))
    high, low, night = (swept_scene(view, eye, waves).levels for view in views)
    assert low.parts.size > high.parts.size
    assert low.parts[0] < 0.9 * high.parts[0]
    assert night.parts.tolist() == high.parts.tolist()


def test_another_seed_has_the_levels_of_a_sea_made_for_it(waves):
    made = Levels.of(waves, coarse(), Accuracy(), LAST).reseeded(waves.reseeded(8))
    other = Levels.of(waves.reseeded(8), coarse(), Accuracy(), LAST)
    assert [z.tobytes() for z in made.lattices(1.0)] == [z.tobytes() for z in other.lattices(1.0)]


def test_bounds_hold_the_finest_sea(waves):
    levels = Levels.of(waves, CAMERA, Accuracy(), LAST)
    lattices = levels.lattices(2.0)
    bounds = levels.bounds(lattices)
    finest = [lattices[p] for p in levels.detail.levels[0].parts]
    assert bounds[0] == pytest.approx(sum(part[..., 0].max() for part in finest), rel=1e-6)
    assert bounds[1] >= max(np.hypot(part[..., 1], part[..., 2]).max() for part in waves.surfaces(2.0))
    assert bounds[2] == min(tile.spacing for tile in waves.tiles)
    assert Levels.calm().bounds(()) == (0.0, 0.0, 1.0)


@pytest.mark.parametrize("finer", [2, 3, 6])
def test_lines_of_a_finer_picture_average_their_own_distance(waves, finer):
    """Waves are those that the large pixel needs; widths follow the columns that are drawn, and these count as lines."""
    levels, coarser = (Levels.of(waves, coarse(), Accuracy(), LAST, 0.0, n) for n in (finer, 1))
    averaged = np.array(levels.widths) > 0.0
    assert averaged.any()
    for width, begin in np.array([levels.widths, levels.begins]).T[averaged]:
        distance = begin * coarse().column_step / finer / 2.0 ** np.count_nonzero(levels.parts <= begin * 1.0001)
        assert 2.0**-0.27 < AVERAGED_WIDTH * distance / width < 2.0**0.27
    assert levels.begins[averaged][0] > coarser.begins[np.array(coarser.widths) > 0.0][0]
    assert set(levels.numbers) == set(coarser.numbers)
    strict, many = (Levels.of(waves, coarse(), LINES, LAST, 0.0, n) for n in (finer, 1))
    assert strict.begins.tolist() == many.begins.tolist()
    assert strict.parts.tolist() == many.parts[finer.bit_length() - 1 :].tolist()
