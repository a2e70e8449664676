"""Sparkle below a pixel: mean, variance at any size, correlation in time, and a function of (seed, place, time) alone."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from scipy import stats

import seaglint as sg
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import njit
from seaglint.base.keyed_random import SPACING, cell_key, gamma_deviate, last_event, uniform
from seaglint.facet.sunlight import sunlight
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.layers import FEWEST, SPREAD
from seaglint.imaging.layers import SUN as SUN_CHANNEL
from seaglint.imaging.scene import Levels
from seaglint.imaging.sparkle import (
    MOST_CELLS,
    NO_SPARKLE,
    heading,
    piece_variance,
    sparkle_column,
    sparkle_columns,
    sparkle_factor,
    sparkle_of,
    sparkle_rows,
)
from seaglint.imaging.sparkle_settings import relative_variance
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.radiance.variance import glint_variance, sea_variance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics

CELL, TIME = 0.01, 0.07
ROOT = Path(__file__).resolve().parents[2]


@njit
def fill_scattered(sparkle, footprint, stretch, variance, time, out):
    """Footprints of one size far from each other."""
    for i in range(out.shape[0]):
        out[i] = sparkle_factor(sparkle, (i * 3.713, i * 1.317), heading(i * 0.01), footprint, stretch, variance, time)


@njit
def fill_ground(sparkle, place, azimuth, footprint, stretch, variance, time, out):
    """Adjacent footprints on flat ground: rows along the line of sight, columns across it."""
    along_sight = heading(azimuth)
    sine, cosine = math.sin(azimuth), math.cos(azimuth)
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            x, y = (i + 0.5) * footprint[0], (j + 0.5) * footprint[1]
            spot = (place[0] + x * sine + y * cosine, place[1] + x * cosine - y * sine)
            out[i, j] = sparkle_factor(sparkle, spot, along_sight, footprint, stretch, variance, time)


def ground(
    cells: tuple[float, float],
    shape: tuple[int, int],
    *,
    point: float,
    stretch: float = 1.0,
    azimuth: float = 0.1,
    time: float = 0.4,
    seed: int = 1,
    place: tuple[float, float] = (311.3, 1207.7),
) -> FloatArray:
    """Factors of footprints that hold ``cells`` (along, across) of relative variance ``point``."""
    out = np.empty(shape)
    footprint = (cells[0] * CELL * stretch, cells[1] * CELL)
    fill_ground(sparkle_of(seed, CELL, TIME), place, azimuth, footprint, stretch, point / (cells[0] * cells[1]), time, out)
    return out


def box_share(cells: float) -> float:
    """Variance of a box laid at random over a row of cells, over that of a point."""
    return 1.0 - cells / 3.0 if cells < 1.0 else 1.0 / cells - 1.0 / (3.0 * cells**2)


def direction_share(cells: float) -> float:
    """The same as the model has it: beyond some cells half of the border's loss is left to averages over pixels."""
    return box_share(cells) if cells <= MOST_CELLS else 1.0 / (cells + 1.0 / 6.0)


@njit
def fill_gamma(shape, out):
    for i in range(out.shape[0]):
        out[i] = gamma_deviate(shape, cell_key((7, 8), i, -3, 5), 11)


@pytest.mark.parametrize("shape", [0.02, 0.5, 1.0, 3.9, 4.1, 50.0])
def test_gamma_deviates(shape: float) -> None:
    sample = np.empty(100_000)
    fill_gamma(shape, sample)
    # four standard errors of the mean and of the variance of so many gamma deviates, and what the normal's cube leaves
    assert sample.mean() == pytest.approx(1.0, abs=4.0 / math.sqrt(shape * sample.size) + 1e-4)
    assert sample.var() * shape == pytest.approx(1.0, abs=4.0 * math.sqrt((2.0 + 6.0 / shape) / sample.size) + 0.002)
    if shape >= 0.5:
        assert stats.kstest(sample * shape, "gamma", args=(shape,)).statistic < 0.003 + 1.95 / math.sqrt(sample.size)


@pytest.mark.kernel
def test_numbers_of_keys_are_uniform_and_unrelated() -> None:
    square = np.array([[uniform(cell_key((1, 2), i, j, 0), 0) for j in range(200)] for i in range(200)])
    assert stats.kstest(square.ravel(), "uniform").pvalue > 1e-4
    other = np.array([[uniform(cell_key((1, 2), i, j, 0), 1) for j in range(200)] for i in range(200)])
    for one, two in ((square, other), (square[1:], square[:-1]), (square[:, 1:], square[:, :-1]), (square, square.T)):
        off = one is not square or two is not square.T
        keep = np.ones(one.shape, dtype=bool) if off else ~np.eye(200, dtype=bool)
        assert abs(np.corrcoef(one[keep], two[keep])[0, 1]) < 4.5 / math.sqrt(one.size)


@njit
def fill_shared(lag, out):
    for i in range(out.shape[0]):
        key = cell_key((5, 6), i, 9, 1)
        out[i] = 1.0 if last_event(key, 100.3) == last_event(key, 100.3 + lag) else 0.0


@pytest.mark.parametrize("lag", [0.02, 0.3, 1.0, 2.5, 6.0])
def test_last_events_are_shared_exponentially(lag: float) -> None:
    same = np.empty(100_000)
    fill_shared(lag, same)
    shared = same.mean()
    true = math.exp(-lag)
    # linear between multiples of the spacing: off by at most an eighth of its square
    assert abs(shared - true) < 4.0 * math.sqrt(true * (1.0 - true) / same.size) + SPACING**2 / 8.0


@pytest.mark.parametrize("stretch", [1.0, 1.6, 7.0])
@pytest.mark.parametrize("cells", [(0.07, 0.09), (0.6, 0.5), (2.3, 1.7), (6.1, 7.2), (9.0, 11.0), (40.0, 30.0), (300.0, 0.4), (500.0, 3.3)])
def test_mean_and_variance(cells: tuple[float, float], stretch: float) -> None:
    point = 2.0 * max(1.0, cells[0] * cells[1]) ** 0.7
    factor = np.empty(10_000)
    footprint = (cells[0] * CELL * stretch, cells[1] * CELL)
    fill_scattered(sparkle_of(7, CELL, TIME), footprint, stretch, point / (cells[0] * cells[1]), 0.4, factor)
    expected = point * direction_share(cells[0]) * direction_share(cells[1])
    assert factor.min() >= 0.0
    assert factor.mean() == pytest.approx(1.0, abs=4.5 * math.sqrt(2.0 * expected / factor.size))
    # four standard errors of the variance of gamma deviates, with no other allowance
    assert factor.var() == pytest.approx(expected, rel=4.0 * math.sqrt((2.0 + 6.0 * expected) / factor.size))


@pytest.mark.parametrize("stretch", [1.0, 3.0])
@pytest.mark.parametrize("cells", [0.23, 2.2, 3.5, 40.0, *(pytest.param(c, marks=pytest.mark.validation) for c in (0.9, 9.0))])
def test_averaging_down_is_rendering_coarse(cells: float, stretch: float) -> None:
    # two decades in steps of 4; variances of 10 000 coarse pixels are known to 2 %
    fine = ground((cells, cells), (400, 400), point=0.5 * max(cells, 1.0) ** 2, stretch=stretch)
    down = fine.reshape(100, 4, 100, 4).mean(axis=(1, 3))
    coarse = ground((4.0 * cells, 4.0 * cells), (100, 100), point=0.5 * max(cells, 1.0) ** 2, stretch=stretch, seed=2)
    assert down.mean() == pytest.approx(coarse.mean(), abs=5.0 * coarse.std() / 100.0 + 1e-9)
    assert down.var() == pytest.approx(coarse.var(), rel=0.05 + 0.05)


@pytest.mark.parametrize("cells", [0.5, 3.0, 50.0])
def test_correlation_time(cells: float) -> None:
    lags = np.array([0.0, 0.02, 0.05, 0.07, 0.14])
    series = [ground((cells, cells), (200, 200), point=0.5 * max(cells, 1.0) ** 2, time=12.3 + lag) for lag in lags]
    correlation = np.array([np.corrcoef(series[0].ravel(), later.ravel())[0, 1] for later in series])
    assert correlation[0] == pytest.approx(1.0)
    fitted = -1.0 / np.polyfit(lags, np.log(correlation), 1)[0]
    assert fitted == pytest.approx(TIME, rel=0.1)


def test_tail_is_that_of_a_gamma_density() -> None:
    factor = ground((30.0, 30.0), (200, 200), point=900.0).ravel()  # relative variance 1
    assert stats.skew(factor) == pytest.approx(2.0 * factor.std(), rel=0.1)
    assert stats.kstest(factor, "gamma", args=(1.0 / factor.var(), 0.0, factor.var())).statistic < 0.012


@pytest.mark.parametrize("cells", [0.5, 3.0, 50.0])
def test_seeds_and_neighbours_are_independent(cells: float) -> None:
    one, two = (ground((cells, cells), (150, 150), point=0.5, seed=seed) for seed in (1, 2))
    assert abs(np.corrcoef(one.ravel(), two.ravel())[0, 1]) < 4.5 / math.sqrt(one.size * min(cells, 1.0) ** 2)
    if cells > MOST_CELLS:
        for ahead, behind in ((one[1:], one[:-1]), (one[:, 1:], one[:, :-1])):
            assert abs(np.corrcoef(ahead.ravel(), behind.ravel())[0, 1]) < 4.5 / math.sqrt(one.size)


CAMERA = Camera(25.0, 1.1, -0.09, 0.012, 0.006, 48, 24)
SUN = sunlight(1.05, 1.1, True)


def pixel_variance(camera: Camera, cell: float, chance: float) -> FloatArray:
    """Relative variance of pixels on the mean sea, (rows, columns), from the mean model's formula."""
    rows = sparkle_rows(camera)
    azimuth = camera.azimuths
    theta = np.arccos(rows.grazing)[:, None]
    twice = 1.0 + np.cos(theta) * SUN.up - np.sin(theta) * (np.sin(azimuth) * SUN.east + np.cos(azimuth) * SUN.north)
    slant = rows.along * rows.grazing / camera.row_step
    solid = rows.reach * camera.column_step * camera.row_step / slant
    shape = (camera.rows, camera.columns)
    cosine = np.broadcast_to(np.sqrt(0.5 * twice), shape)
    found = glint_variance(1.0, chance, cosine, theta, math.acos(SUN.up), slant[:, None], solid[:, None], cell)
    return np.asarray(found)


def test_a_piece_has_the_variance_of_the_mean_model() -> None:
    sparkle = sparkle_of(1, 0.0026, TIME)
    mean, chance, cosine, theta, sun, slant, solid = 1.7, 2e-3, 0.6, 1.5, 1.0, 900.0, 1e-7
    found = piece_variance(sparkle, mean, chance, cosine, math.cos(theta) + math.cos(sun), solid * slant**2)
    assert found == pytest.approx(float(glint_variance(mean, chance, cosine, theta, sun, slant, solid, 0.0026)), rel=1e-12)


def sparkle_image(sparkle, camera: Camera, sun, variance: np.ndarray, time: float) -> np.ndarray:
    """Factors of mean 1 on the mirrored Sun of an image, for the relative variance of its pixels (rows, columns)."""
    images = np.ones((camera.columns, 1, FEWEST, camera.rows))
    images[:, 0, SPREAD] = variance.T
    sparkle_columns(sparkle, sparkle_rows(camera), sun, camera.azimuths, (0.0, 0.0), time, images, (0, camera.azimuths.size))
    return np.ascontiguousarray(images[:, 0, SUN_CHANNEL].T)


@pytest.mark.parametrize("cell", [0.002, 1.0])
def test_the_light_of_sparkles_stands_apart_where_pixels_have_many_cells(cell: float) -> None:
    images = np.ones((CAMERA.columns, 1, FEWEST, CAMERA.rows))
    sparkle_columns(sparkle_of(1, cell, TIME), sparkle_rows(CAMERA), SUN, CAMERA.azimuths, (0.0, 0.0), 1.0, images, (0, CAMERA.columns))
    added = images[:, 0, SUN_CHANNEL] - 1.0
    assert added.any()
    np.testing.assert_array_equal(images[:, 0, SPREAD], added if cell < 0.1 else 0.0)


@pytest.mark.parametrize(("chance", "left"), [(0.25, 3.0), (0.97, 1 / 0.97 - 1), (1.0, 0.0), (1.03, 0.0), (4.0, 0.0)])
def test_facets_that_all_mirror_the_sun_do_not_sparkle(chance: float, left: float) -> None:
    """A patch is bright with probability P: variance L^2 (1/P - 1)/M, which never falls below zero where P is rounded above one."""
    patches = 50.0 * 2.0 / (2.0 * 0.8**2 * 0.1**2)
    assert piece_variance(NO_SPARKLE._replace(cell=0.1), 7.0, chance, 0.8, 2.0, 50.0) == pytest.approx(49.0 * left / patches, rel=1e-12)


@pytest.mark.parametrize("cell", [0.002, 0.02])
def test_images_of_a_camera(cell: float) -> None:
    fine_camera = Camera(25.0, 1.1, -0.09, 0.012, 0.006, 8 * 48, 4 * 24)
    coarse_v, fine_v = (pixel_variance(camera, cell, 1e-2) for camera in (CAMERA, fine_camera))
    down, coarse = [], []
    for seed in range(6):
        sparkle = sparkle_of(seed, cell, TIME)
        fine = sparkle_image(sparkle, fine_camera, SUN, fine_v, 0.3)
        down.append(fine.reshape(24, 4, 48, 8).mean(axis=(1, 3)))
        coarse.append(sparkle_image(sparkle, CAMERA, SUN, coarse_v, 0.3))
    deviation = np.sqrt(coarse_v)
    averaged, direct = (np.mean(((np.array(x) - 1.0) / deviation) ** 2) for x in (down, coarse))
    # 6 900 pixels each; rows of 20 cells along and 4 across, or 10 times as many
    assert averaged == pytest.approx(direct, rel=0.1)
    if cell == 0.002:
        assert direct == pytest.approx(1.0, rel=0.07)


@pytest.mark.kernel
def test_order_and_threads_do_not_matter() -> None:
    variance = pixel_variance(CAMERA, CELL, 1e-2)
    sparkle = sparkle_of(3, CELL, TIME)
    before = numba.get_num_threads()
    images = []
    for threads in sorted({1, min(2, numba.config.NUMBA_NUM_THREADS)}):
        numba.set_num_threads(threads)
        images.append(sparkle_image(sparkle, CAMERA, SUN, variance, 7.7).tobytes())
    numba.set_num_threads(before)
    alone = np.ones((CAMERA.columns, 1, 3, CAMERA.rows))
    alone[:, 0, 2] = variance.T
    for column in reversed(range(CAMERA.columns)):
        sparkle_column(sparkle, sparkle_rows(CAMERA), SUN, CAMERA.azimuths[column], (0.0, 0.0), 7.7, alone[column])
    images.append(np.ascontiguousarray(alone[:, 0, 1].T).tobytes())
    assert len(set(images)) == 1


@pytest.mark.parametrize("cells", [3.0, 41.7])
def test_sparkles_stay_with_the_water(cells: float) -> None:
    here = ground((cells, cells), (60, 60), point=0.5 * cells**2, azimuth=0.0)
    # sensor and grid move by three footprints north: the same water is three rows nearer
    there = ground((cells, cells), (60, 60), point=0.5 * cells**2, azimuth=0.0, place=(311.3, 1207.7 + 3.0 * cells * CELL))
    assert np.corrcoef(here[3:].ravel(), there[:-3].ravel())[0, 1] > 0.95
    # a sixth of a footprint on, a sixth of the water is new; a standing cell, of 0.35 to 0.7 of the footprint, loses more
    part = ground((cells, cells), (60, 60), point=0.5 * cells**2, azimuth=0.0, place=(311.3, 1207.7 + cells * CELL / 6.0))
    assert 0.4 < np.corrcoef(here.ravel(), part.ravel())[0, 1] < 0.97


SIMULATED = """
import json, sys
import numba
from numba import cuda
import numpy as np
from seaglint.imaging.sparkle import heading, sparkle_factor, sparkle_of

@cuda.jit
def launch(east, out):
    i = cuda.grid(1)
    if i < out.size:
        cells = (0.4, 5.0, 60.0)[i % 3] * 0.01
        out[i] = sparkle_factor(SEA, (float(east[i]), 55.0), WAY, (2.5 * cells, cells), 2.5, 0.3, 4.2)

SEA, WAY = sparkle_of(9, 0.01, 0.07), heading(0.4)
east, out = np.arange(24) * 1.37, np.zeros(24)
launch[3, 8](east, out)
print(json.dumps([type(sparkle_factor).__name__, type(launch).__module__, out.tolist()]))
"""


@pytest.mark.parametrize("jit", ["0", pytest.param("1", marks=pytest.mark.validation)], ids=["compiled", "plain"])
def test_the_kernel_runs_unchanged_on_a_simulated_gpu(jit: str) -> None:
    environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": jit}
    done = subprocess.run([sys.executable, "-c", SIMULATED], capture_output=True, text=True, check=False, cwd=ROOT, env=environment)
    assert done.returncode == 0, done.stderr
    kind, launcher, values = json.loads(done.stdout)
    assert (kind == "function") == (jit == "1")
    assert "simulator" in launcher
    cells = [0.4 * CELL, 5.0 * CELL, 60.0 * CELL]
    here = [
        sparkle_factor(sparkle_of(9, 0.01, 0.07), (i * 1.37, 55.0), heading(0.4), (2.5 * cells[i % 3], cells[i % 3]), 2.5, 0.3, 4.2)
        for i in range(24)
    ]
    # logarithms and exponentials of different libraries may differ in the last bit
    assert values == pytest.approx(here, rel=1e-12)
    assert len(set(values)) > 20


@pytest.mark.parametrize(
    ("scene", "word"),
    [
        ({}, "gamma field"),
        ({"sea": {"glint": {"correlation": "time"}}}, "gamma field"),
        ({"render": {"subpixel_glint": "off"}}, "off"),
        ({"sun": {"zenith_deg": 95.0}}, "no mirrored Sun"),
        ({"sea": {"glint": {"cell_m": 1e-4}}}, "left out"),
        ({"sea": {"glint": {"cell_m": 1e-4}}, "render": {"subpixel_glint": "on"}}, "gamma field"),
    ],
    ids=["default", "time", "off", "night", "fine cells", "fine cells, asked for"],
)
def test_scenarios_choose_sparkles(scene: dict, word: str) -> None:
    scenario = parse_scenario(scene)
    view = scenario_physics.view(scenario)
    sparkle, report = scenario_physics.sparkles(scenario).of(view, scenario_physics.camera(scenario), Levels.calm())
    assert word in report["subpixel_glint"]
    assert (sparkle.cell == 0.0) == (word != "gamma field")
    if word == "gamma field":
        by_waves = scenario.sea.glint.correlation == "waves"
        assert (sparkle.clusters.begins.size > 0) == by_waves == ("subpixel_glint_from" in report)
        assert by_waves or sparkle.cell == scenario_physics.glint_length(scenario) == report["subpixel_glint_cell_m"]


def test_survey_of_an_image_is_the_mean_models() -> None:
    scenario = parse_scenario({"atmosphere": {"source": "none"}})
    view, camera = scenario_physics.view(scenario), scenario_physics.camera(scenario)
    elevations = camera.elevations[::4]
    found = mean_radiance(view, elevations, camera.azimuths[::4])
    variance = sea_variance(view, found, elevations, camera.row_step * camera.column_step * np.cos(elevations), 0.0026)
    # weighted by the square of P, not of the radiance: the reflectance, 0.75 of it here, is left out; other rows and columns
    relative = np.divide(variance, found.sun**2, out=np.zeros(variance.shape), where=found.sun > 0.0)
    expected = (relative * found.chance**2).sum() / (found.chance**2).sum()
    assert relative_variance(view, camera, 0.0026) == pytest.approx(expected, rel=0.06)


@pytest.mark.parametrize("height", [30.0, 300.0])
@pytest.mark.parametrize("body", ["sun", "moon"])
@pytest.mark.parametrize("zenith", [89.6, 90.0, 90.2, 90.3, 90.6, 91.0])
def test_a_disc_cut_by_the_horizon_sparkles_finitely(body, zenith, height):
    """Along the view to a setting Sun or Moon, cells are stretched by a difference of numbers near 1."""
    low = {"zenith_deg": zenith, "azimuth_deg": 200.0}
    bodies = {"sun": low} if body == "sun" else {"sun": {"zenith_deg": 130.0}, "moon": low | {"phase_deg": 20.0}}
    eye = {"height_m": height, "azimuth_deg": 200.0, "elevation_deg": -0.3, "fov_deg": [0.25, 1.0], "pixels": [4, 32], "frames": 1}
    sea = {"band": {"min_um": 3.5, "max_um": 5.0}, "wind": {"speed_m_s": 4.0}, "render": {"tile_size": 128}}
    picture = sg.image(parse_scenario(bodies | {"sensor": eye} | sea), layers=["glint_radiance"])
    for values in (picture.radiance, picture.glint_radiance):
        assert np.all(np.isfinite(values))
        assert np.all(values >= 0.0)
