"""Rendering fine and averaging down is rendering coarse, over two decades of pixel size."""

import numpy as np
import pytest

from seaglint.pipeline.render import prepare_sequence
from seaglint.scenario.load import parse_scenario

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
