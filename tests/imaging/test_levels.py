"""Where levels of detail begin and lines part, against the lattices averaged over pixels by their spectra."""

from dataclasses import replace

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Accuracy, Levels
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import Detail, WaveField

CAMERA = Camera(30.0, 0.0, np.radians(-10.0), np.radians(4.0), np.radians(3.0), 64, 48)
LAST = 20000.0


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
    accuracy = Accuracy()
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
    levels = Levels.of(waves, coarse(), Accuracy(shortest_wave_columns=columns), LAST)
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
    levels = Levels.of(waves, coarse(), Accuracy(), LAST)
    assert levels.steps == pytest.approx(levels.shortest / Accuracy().steps_per_wave)
    stated = Levels.of(waves, coarse(), Accuracy(step=0.2), LAST)
    assert stated.steps[0] == pytest.approx(0.2)
    assert stated.steps / stated.shortest == pytest.approx(np.full(stated.steps.size, 0.2 / stated.shortest[0]))
    cell = waves.tiles[-1].spacing  # steps of less than 256 cells are said to be allowed
    assert Levels.of(waves, CAMERA, Accuracy(step=255.0 * cell, shortest_wave_columns=0.0), LAST).steps.size == 1
    with pytest.raises(DomainError, match="less than 256 cells"):
        Levels.of(waves, CAMERA, Accuracy(step=257.0 * cell, shortest_wave_columns=0.0), LAST)


def test_levels_beyond_the_last_arc_are_left_out(waves):
    every = Levels.of(waves, coarse(), Accuracy(), LAST)
    fewer = Levels.of(waves, coarse(), Accuracy(), 0.5 * (every.begins[1] + every.begins[2]))
    assert fewer.begins.size == 2
    assert fewer.begins[1] == pytest.approx(every.begins[1], rel=0.01)


def test_bounds_hold_the_finest_sea(waves):
    levels = Levels.of(waves, CAMERA, Accuracy(), LAST)
    lattices = levels.lattices(2.0)
    bounds = levels.bounds(lattices)
    finest = [lattices[p] for p in levels.detail.levels[0].parts]
    assert bounds[0] == pytest.approx(sum(part[..., 0].max() for part in finest), rel=1e-6)
    assert bounds[1] >= max(np.hypot(part[..., 1], part[..., 2]).max() for part in waves.surfaces(2.0))
    assert bounds[2] == min(tile.spacing for tile in waves.tiles)
    assert Levels.calm().bounds(()) == (0.0, 0.0, 1.0)


@pytest.mark.parametrize(("oversampling", "lines"), [(1, 16), (2, 8), (3, 8), (4, 4), (64, 1)])
def test_cells_of_a_turned_camera_share_its_lines(oversampling, lines):
    """As many lines in a pixel as before at least, of cells that waves are as many pixels long in."""
    made = Accuracy(oversampling=oversampling).of_cells()
    assert made.lines_per_column == lines
    assert made.shortest_wave_columns == 2.0 * oversampling
