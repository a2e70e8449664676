"""Scales, numbers of bars and labels of previews: of the sea at night, of glint, and straight down."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr

from seaglint.base.brightness import Scale
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.optics.band import Band
from seaglint.plot.preview import draw
from seaglint.plot.scale import number_decades, round_ticks, scale_of
from seaglint.store.provenance import band_attributes
from seaglint.store.stored_images import below_horizon

BAND = Band.rectangular(8.0, 12.0)
ELEVATION = np.linspace(2.0, -4.0, 121)


def night(sky: float = 34.0, seed: int = 0) -> np.ndarray:
    """A sea of 30.4 +- 0.1 that takes the sky's radiance within a degree of the horizon."""
    sea = 30.4 + 0.1 * np.random.default_rng(seed).standard_normal((ELEVATION.size, 64))
    share = np.exp(np.minimum(ELEVATION, 0.0) / 0.3)[:, np.newaxis]
    return np.asarray(share * sky + (1.0 - share) * sea)


def as_map(radiance: np.ndarray, height: float = 20.0) -> xr.Dataset:
    return xr.Dataset(
        {"radiance": (("y", "x"), radiance)},
        {"azimuth": ("x", np.linspace(174.0, 186.0, radiance.shape[1])), "elevation": ("y", ELEVATION)},
        {**band_attributes(BAND), "scenario": json.dumps({"sensor": {"height_m": height}})},
    )


def taken(scale: Scale, values: np.ndarray) -> float:
    """Share of a scale between the fifth and the 95th percentile of values."""
    return float(np.ptp(scale.share(np.percentile(values, (5.0, 95.0)))))


def test_pixels_below_the_horizon_are_known():
    found = below_horizon(as_map(night()))
    # dip of 20 m: arccos(R / (R + h)), 0.1436 deg without air and 0.124 where it bends lines by a quarter of the Earth's curvature
    assert found is not None
    assert found[:, 0] == pytest.approx(-ELEVATION - 0.134, abs=0.011)
    assert below_horizon(as_map(night()).assign_attrs(scenario="{}")) is None


@pytest.mark.parametrize("sky", [25.0, 34.0, 45.0])
def test_a_sky_that_is_warmer_or_colder_leaves_the_sea_its_scale(sky):
    image, depression = night(sky), -ELEVATION[:, np.newaxis] - 0.14
    near = image[ELEVATION < -2.0]
    own, whole = scale_of(image, "auto", depression), scale_of(image, "linear", depression)
    assert (whole.low, whole.high) == (scale_of(image, "linear").low, scale_of(image, "linear").high)
    assert taken(whole, near) < 0.15
    assert taken(own, near) > 0.3
    assert (own.high < sky) == (sky > 30.0)
    assert (own.low > sky) == (sky < 30.0)


def test_the_picture_of_a_night_says_that_the_sky_is_beyond_the_scale():
    figure = draw(as_map(night()))
    radiance, kelvin = (axes.images[0] for axes in figure.axes[:2])
    assert radiance.colorbar.extend in ("max", "both")
    assert kelvin.colorbar.extend in ("max", "both")
    assert radiance.norm.vmax < 32.0
    assert kelvin.norm.vmax - kelvin.norm.vmin < 3.0  # of 8 K from sea to sky
    (line,) = figure.axes[0].lines
    assert line.get_ydata()[0] == pytest.approx(-0.134, abs=0.011)
    assert "sky and sea near the horizon beyond the scale" in figure.axes[0].get_title()
    assert "beyond" not in draw(as_map(night()), "linear").axes[0].get_title()


def test_titles_of_a_high_picture_do_not_cover_each_other():
    high = as_map(night()[:, :8])
    high["azimuth"] = np.linspace(179.0, 181.0, 8)
    figure = draw(high)
    figure.canvas.draw()
    one, other = (axes.title.get_window_extent() for axes in figure.axes[:2])
    assert "horizon dotted" in figure.axes[0].get_title()
    assert 0.0 < one.x0 < one.x1 < other.x0 < other.x1 < figure.bbox.width


def test_the_scale_of_glint_spans_it_whether_it_reaches_the_horizon_or_ends_there():
    """Glint is no sky: neither a corridor over the whole sea nor glint near the horizon alone goes beyond the scale."""
    draws = np.random.default_rng(3).gamma(1.0, 1.0, (ELEVATION.size, 64))
    corridor = np.exp(-0.5 * (np.arange(64) - 32.0) ** 2 / 8.0**2) * (ELEVATION < 0.0)[:, np.newaxis]
    depression = -ELEVATION[:, np.newaxis] - 0.14
    for where in (corridor, corridor * (ELEVATION > -1.0)[:, np.newaxis]):
        for sky in (2.2, 0.8, 30.0):
            image = np.where(ELEVATION[:, np.newaxis] > 0.0, sky, 1.0 + 20.0 * where * draws)
            with_sky, without = scale_of(image, "auto", depression), scale_of(image)
            assert with_sky.high == without.high


def test_without_sky_or_without_sea_the_scale_is_that_of_all_pixels():
    image = night()
    for depression in (np.full((ELEVATION.size, 1), 1.0), np.full((ELEVATION.size, 1), -1.0)):
        for kind in ("auto", "linear"):
            assert (scale_of(image, kind, depression).low, scale_of(image, kind, depression).high) == (
                scale_of(image, kind).low,
                scale_of(image, kind).high,
            )


@pytest.mark.parametrize(("low", "high", "width"), [(0.8, 250.0, 1.0), (0.05, 30.0, 0.02), (3.0, 4e4, 3.0)])
def test_numbers_of_a_logarithmic_bar_are_one_two_and_five(low, high, width):
    scale = Scale(low, high, width)
    ticks = round_ticks(scale.share, scale.value)
    mantissas = ticks / 10.0 ** np.floor(np.log10(ticks) + 1e-9)
    assert {round(float(m), 6) for m in mantissas} <= {1.0, 2.0, 5.0}
    assert ticks.size >= 6


@pytest.mark.parametrize("low", [-3.0, 0.0, 0.7, 28.013, 285.2])
@pytest.mark.parametrize("span", [0.03, 2.0, 900.0])
@pytest.mark.parametrize("part", [1.0, 0.1, 1e-3])
def test_numbers_of_any_logarithmic_bar_are_inside_it_rising_and_not_far_apart(low, span, part):
    scale = Scale(low, low + span, part * span)
    ticks = round_ticks(scale.share, scale.value)
    shares = scale.share(ticks)
    assert 4 <= ticks.size <= 20
    assert np.all(np.diff(shares) > 0.02)
    assert shares[0] > -1e-9
    assert shares[-1] < 1.0 + 1e-9
    assert np.max(np.diff([0.0, *shares, 1.0])) < 0.3


def test_a_bar_of_decades_is_numbered_in_full():
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    figure = Figure()
    axes = figure.subplots()
    for low, high, expected in ((0.3, 30.0, ["0.5", "1", "2", "5", "10", "20"]), (1.0, 1e5, ["1", "10", "100", "1000", "10000", "100000"])):
        bar = figure.colorbar(axes.imshow(np.array([[low, high]]), norm=LogNorm(low, high)), ax=axes)
        number_decades(bar)
        figure.canvas.draw()
        assert [text.get_text() for text in bar.ax.get_yticklabels()] == expected


@pytest.mark.parametrize(("elevation", "field"), [(-90.0, 50.0), (-85.0, 60.0)])
def test_labels_straight_down_are_apart_inside_and_outlined(elevation, field):
    pixels = 96
    imager = Imager("pinhole", np.radians(field), np.radians(field), pixels, pixels)
    azimuth, up = (np.degrees(angle) for angle in imager.centres(Attitude(0.0, float(np.radians(elevation)), 0.0)))
    image = np.random.default_rng(5).gamma(2.0, 1.0, (pixels, pixels))
    dataset = xr.Dataset(
        {"radiance": (("y", "x"), image)},
        {"azimuth": (("y", "x"), azimuth), "elevation": (("y", "x"), up)},
        {**band_attributes(BAND), "scenario": json.dumps({"sensor": {"height_m": 150.0}})},
    )
    figure = draw(dataset)
    axes = figure.axes[0]
    figure.canvas.draw()
    boxes = {text.get_text(): text.get_window_extent() for text in axes.texts}
    assert len(boxes) == len(axes.texts) >= 8
    assert any(name.endswith("az") for name in boxes)
    assert sum(not name.endswith("az") for name in boxes) >= 3
    frame = axes.get_window_extent()
    for name, box in boxes.items():
        assert frame.x0 - 1 <= box.x0
        assert box.x1 <= frame.x1 + 1, name
        assert not any(box.overlaps(other) for label, other in boxes.items() if label != name), name
    assert all(text.get_path_effects() and text.get_color() == "white" for text in axes.texts)
