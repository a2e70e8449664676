"""Rendering fine and averaging down is rendering coarse, over two decades of pixel size."""

import numpy as np
import pytest

from seaglint.base.conventions import surface_range
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence

PIXELS = (640, 320)


def _renderer(elevation_deg, factor):
    sensor = {
        "pixels": [PIXELS[0] // factor, PIXELS[1] // factor],
        "fov_deg": [8, 4],
        "elevation_deg": elevation_deg,
        "azimuth_deg": 180,
        "height_m": 30,
        "pixel_shape": "any",
    }
    render = {"tile_size": 256, "subpixel_glint": "off"} | ({"shortest_wave_columns": 0} if factor == 1 else {})
    scenario = {
        "sun": {"zenith_deg": 60, "azimuth_deg": 180},
        "sensor": sensor,
        "wind": {"speed_m_s": 7, "from_deg": 200},
        "sea": {"shortest_wave_m": 0.5},
        "render": render,
    }
    return prepare_sequence(parse_scenario(scenario))


@pytest.mark.validation
@pytest.mark.parametrize(("elevation", "factors", "mean"), [(-12.0, (4, 16, 64), 5e-3), (-2.5, (2, 4), 5e-3), (-2.5, (16, 64), 15e-3)])
def test_averaging_down_is_rendering_coarse(elevation, factors, mean):
    """Means and variances about the mean of each row; near the horizon facets stand for waves a little less well."""
    images = {factor: [] for factor in (1, *factors)}
    for factor, found in images.items():
        first = _renderer(elevation, factor)
        for seed in range(8):
            run = first.reseeded(seed)
            found.append(run.at(0.0).radiance.astype(float))
    fine = np.array(images[1])
    for factor in factors:
        down = fine.reshape(len(fine), PIXELS[1] // factor, factor, PIXELS[0] // factor, factor).mean(axis=(2, 4))
        coarse = np.array(images[factor])
        spread = [float(((a - a.mean(axis=(0, 2), keepdims=True)) ** 2).mean()) for a in (coarse, down)]
        print(f"{elevation:g} deg, {factor} times: mean {coarse.mean() / down.mean():.4f}, variance {spread[0] / spread[1]:.3f}")
        assert coarse.mean() == pytest.approx(down.mean(), rel=mean)
        assert spread[0] == pytest.approx(spread[1], rel=0.05)


def _far(factor, height, mrad, band, top, bottom, seed=1):
    """A strip of columns ``mrad`` wide and its like ``factor`` times finer, with many lines and all but the shortest waves as geometry."""
    step = np.degrees(1e-3 * mrad) / factor
    rows = round((bottom - top) / step / factor) * factor
    scenario = {
        "seed": seed,
        "sun": {"zenith_deg": 75, "azimuth_deg": 180},
        "wind": {"speed_m_s": 8, "from_deg": 225},
        "sensor": {
            "height_m": height,
            "azimuth_deg": 180,
            "elevation_deg": -(top + 0.5 * rows * step),
            "fov_deg": [16 * factor * step, rows * step],
            "pixels": [16 * factor, rows],
            "pixel_shape": "any",
        },
        "band": {"min_um": band[0], "max_um": band[1]},
        "render": {"subpixel_glint": "off"} | ({"shortest_wave_columns": 1.0, "variance_error": 0.019} if factor > 1 else {}),
    }
    return prepare_sequence(parse_scenario(scenario))


@pytest.mark.parametrize(
    ("height", "mrad", "band", "top", "bottom", "seas"),
    [
        pytest.param(*case, marks=pytest.mark.validation, id=f"{case[0]:g} m, {case[1]:g} mrad, {case[2]}")
        for case in (
            (10.0, 1.0, (3.5, 5.0), 0.15, 4.0, 24),
            (30.0, 0.5, (3.5, 5.0), 0.25, 3.0, 24),
            (100.0, 1.0, (3.5, 5.0), 0.4, 4.0, 24),
            (900.0, 1.0, (3.5, 5.0), 1.0, 9.0, 10),
            (900.0, 1.75, (8.0, 12.0), 1.0, 9.0, 10),
            (3000.0, 1.0, (8.0, 12.0), 1.8, 9.0, 8),
        )
    ],
)
def test_far_pixels_vary_as_fine_ones_averaged_down(height, mrad, band, top, bottom, seas):
    """Waves that far columns hold unresolved count: deviations of rows in eighths of the picture."""
    coarse, fine = (_far(factor, height, mrad, band, top, bottom) for factor in (1, 4))
    seen, down = [], []
    for seed in range(seas):
        seen.append(coarse.reseeded(seed).at(0.0).radiance.astype(float))
        image = fine.reseeded(seed).at(0.0).radiance.astype(float)
        down.append(image.reshape(image.shape[0] // 4, 4, image.shape[1] // 4, 4).mean(axis=(1, 3)))
    spread = [np.array(a).var(axis=(0, 2)) for a in (seen, down)]
    parts = np.array_split(np.arange(spread[0].size), 8)
    ratio = np.array([np.sqrt(spread[0][part].mean() / spread[1][part].mean()) for part in parts])
    print(f"{height:g} m, {mrad:g} mrad, {band}: " + " ".join(f"{r:.3f}" for r in ratio))
    np.testing.assert_allclose(ratio, 1.0, atol=0.05)
    # means change by 1.5 % at most in the last rows above the horizon, where facets stand for waves
    mean = np.array(seen).mean() / np.array(down).mean()
    assert mean == pytest.approx(1.0, abs=0.01)


@pytest.mark.validation
@pytest.mark.parametrize(
    ("height", "mrad", "band", "top", "bottom"),
    [(100.0, 0.5, (3.5, 5.0), 0.5, 3.0), (900.0, 0.5, (3.5, 5.0), 1.2, 8.0), (900.0, 0.5, (8.0, 12.0), 1.2, 8.0)],
)
def test_no_step_shows_where_a_level_of_detail_begins(height, mrad, band, top, bottom):
    """Means and deviations of rows over 64 seas: lines through eight rows on either side meet within 3 % where a level begins."""
    run = _far(1, height, mrad, band, top, bottom)
    scene = run.scene
    seen = np.array([run.reseeded(seed).at(0.0).radiance.astype(float) for seed in range(64)])
    depression = -np.asarray(scene.camera.elevations)
    arcs = surface_range(height, depression)
    begins = [*scene.levels.begins[1:], *scene.levels.parts]
    per_sea = np.stack([seen.mean(axis=2), seen.std(axis=2)], axis=1)
    for name, values in zip(("mean", "deviation"), np.moveaxis(per_sea, 1, 0), strict=True):
        for begin in begins:
            edge = int(np.argmin(np.abs(arcs - begin)))
            if not 8 <= edge <= depression.size - 9:
                continue
            rows = np.arange(-8, 8) + 0.5

            def step(profile, edge=edge, rows=rows):
                logs = np.log(profile[edge - 8 : edge + 8])
                return np.polyval(np.polyfit(rows[8:], logs[8:], 1), 0.0) - np.polyval(np.polyfit(rows[:8], logs[:8], 1), 0.0)

            groups = [np.sqrt((values[i::8] ** 2).mean(axis=0)) for i in range(8)]
            found = [step(g) for g in groups]
            error = np.std(found, ddof=1) / np.sqrt(8.0)
            print(f"{height:g} m, {band}: {name} steps by {np.mean(found):+.3f} +- {error:.3f} at {begin:.0f} m")
            assert abs(np.mean(found)) < 0.03 + 2.0 * error
