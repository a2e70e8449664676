"""Glint against the size of pixels: docs/figures/sparkle_sizes.py and its numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import gamma, norm

import sparkle_sizes as made

PAIRS = [(sparkle, scale) for sparkle in made.SPARKLES for scale in made.SCALES]


def test_statistics_of_gamma_deviates() -> None:
    """Relative variance and rates of a known density: 2e6 values, 3.5 sigma in 2e4 of them."""
    shape = 3.0
    values = np.random.default_rng(4).gamma(shape, 2.0, (8, 512, 512))
    found, error = made.with_errors(values)
    assert found[0] == pytest.approx(1.0 / shape, rel=0.01)
    for rate, m in zip(found[1:3], made.THRESHOLDS, strict=True):
        assert rate == pytest.approx(gamma.sf(shape + m * np.sqrt(shape), shape), rel=0.03)
    assert error[0] < 0.01 * found[0]
    assert found[3] > 2.0 * norm.sf(3.0)  # a weighted sum of skewed values is skewed


def test_averages_of_four_have_a_quarter_of_the_variance() -> None:
    values = 5.0 + np.random.default_rng(5).standard_normal((4, 128, 128))
    assert made.averaged(values).var() == pytest.approx(0.25 * values.var(), rel=0.05)
    assert made.averaged(values).shape == (4, 64, 64)


@pytest.mark.parametrize(("sparkle", "scale"), [pair for pair in PAIRS if pair[1] > made.SCALES[0]])
def test_finer_pictures_averaged_down_have_the_coarse_variance(sparkle: str, scale: float) -> None:
    """Within 6 %; pictures without sparkle, and with independent cells, within 3 %."""
    assert made.read()[sparkle, scale]["finer_averaged_over_this"] == pytest.approx(1.0, abs=0.06 if sparkle == "waves" else 0.03)


@pytest.mark.parametrize("scale", made.SCALES[:4])
@pytest.mark.parametrize(("sparkle", "least"), [("waves", 0.75), ("time", 0.90)])
def test_variance_of_sparkle_is_near_the_closed_form(sparkle: str, least: float, scale: float) -> None:
    """The mean model averages over waves that pictures resolve: up to a fifth less, of cells less than a tenth."""
    rows = made.read()
    added = rows[sparkle, scale]["variance"] - rows["off", scale]["variance"]
    assert least < rows[sparkle, scale]["closed_form"] / added < 1.02


@pytest.mark.parametrize("scale", made.SCALES[1:4])
def test_waves_sparkle_more_than_cells_in_larger_pixels(scale: float) -> None:
    rows = made.read()
    assert rows["waves", scale]["variance"] > rows["time", scale]["variance"] > rows["off", scale]["variance"]
    assert rows["waves", scale]["rate_filtered_3_sigma"] > rows["time", scale]["rate_filtered_3_sigma"]


def test_scenes_differ_in_sparkle_alone() -> None:
    plain = made.scenario(1.0, "off")
    for sparkle in ("waves", "time"):
        one = made.scenario(1.0, sparkle)
        assert one.sea.glint.correlation == sparkle
        assert one.render.subpixel_glint == "on"
        assert one.model_copy(update={"sea": plain.sea, "render": plain.render}) == plain
    assert made.scenario(0.5, "waves").sensor.pixels == (256, 128)
    assert plain.sensor.fov_deg[0] / plain.sensor.pixels[0] == pytest.approx(16.0 / 512)  # the default scene's pixels


@pytest.mark.validation
@pytest.mark.parametrize("sparkle", ["waves", "time"])
def test_rendered_pictures_have_the_numbers_of_the_file(sparkle: str) -> None:
    """Three frames of the default pixels: variances of single frames scatter by 5 %, rates behind the filter by a quarter."""
    values, expected = made.relative_glint(1.0, sparkle, 3)
    row = made.read()[sparkle, 1.0]
    found = made.statistics(values)
    assert expected == pytest.approx(row["closed_form"], rel=5e-3)  # digits of the file, and steps of its table of variances
    assert found[0] == pytest.approx(row["variance"], rel=0.1)
    assert found[3] == pytest.approx(row["rate_filtered_3_sigma"], rel=0.4)
