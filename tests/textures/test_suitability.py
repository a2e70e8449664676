"""What a texture is not fitted to, and the region that is named instead."""

from __future__ import annotations

import re

import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.marginals import Marginal
from seaglint.textures.suitability import (
    REFUSED,
    Changes,
    PixelRegion,
    even_region,
    examine,
    parse_region,
    require_stationary,
    require_values,
)
from seaglint.textures.synthesis import latent

NOISE = np.random.default_rng(3).normal(size=(1, 96, 96)).astype(np.float32)


def infinite() -> np.ndarray:
    image = NOISE.copy()
    image[0, 5, 7] = np.inf
    return image


def missing(rows: int) -> np.ndarray:
    image = NOISE.copy()
    image[0, :rows] = np.nan
    return image


@pytest.mark.parametrize(
    ("image", "told"),
    [
        (NOISE[:, :20], "20 x 96 pixels are too few"),
        (infinite(), "values are infinite .* row 5, column 7"),
        (missing(96), "all pixels of the region are masked or missing"),
        (missing(60), "62 % of the region is masked or missing"),
        (np.full((1, 40, 40), 3.0), "all values are 3"),
        ((NOISE > 0.0).astype(np.float32), "two values only, 0 and 1"),
    ],
)
def test_unusable_pictures_are_named(image: np.ndarray, told: str) -> None:
    with pytest.raises(DataError, match=told):
        require_values(image)


def test_a_stationary_picture_passes() -> None:
    assert require_stationary(NOISE) == ()


def test_a_picture_that_is_not_stationary_is_named_with_a_region_that_is() -> None:
    image = NOISE.copy()
    image[:, :, 60:] *= 3.0
    image[:, :, 60:] += 2.0
    with pytest.raises(DataError, match=r"mean .* variance .* choose region") as told:
        require_stationary(image)
    region = parse_region(re.search(r"region = '(\S+)',", str(told.value))[1], 96, 96)
    assert region.right <= 60 or region.left >= 60
    assert region.pixels >= 24 * 24
    assert require_stationary(region.of(image)) == ()


@pytest.mark.parametrize("text", ["5", "0:10", "a:b,0:5", "50:10,:", ":200,:"])
def test_regions_of_another_form_are_refused(text: str) -> None:
    with pytest.raises(DataError, match=r"region = .* give"):
        parse_region(text, 96, 96)


def test_effects_count_and_not_levels() -> None:
    """A ramp of 3 % of the variance is sure in 400 x 400 pixels and changes no texture; 20 % are told; 60 % are refused."""
    noise = np.random.default_rng(5).normal(size=(1, 400, 400))
    ramp = np.sqrt(12.0) * np.linspace(-0.5, 0.5, 400)  # of variance 1

    def with_share(share: float) -> np.ndarray:
        return np.sqrt(1.0 - share) * noise + np.sqrt(share) * ramp

    assert examine(with_share(0.2)).mean == pytest.approx(0.2, abs=0.01)
    assert require_stationary(with_share(0.03)) == ()
    (told,) = require_stationary(with_share(0.2))
    assert re.search(r"mean .* \(20 % of the variance\); --region \S+ is even, and --detrend takes", told)
    with pytest.raises(DataError, match=r"60 % of the variance.*take slow changes off with detrend=True"):
        require_stationary(with_share(0.6))


def test_deviations_of_parts_are_told() -> None:
    noise = np.random.default_rng(6).normal(size=(1, 192, 192))
    noise[:, :, 128:] *= 1.8
    # Lowered by what chance does, here 15 % at most.
    assert 1.8 * 0.8 < examine(noise).spread < 1.8 * 1.05
    assert "variance differs from place to place" in require_stationary(noise)[0]


@pytest.mark.parametrize("shape", [None, 0.3], ids=["gaussian", "gamma"])
def test_correlated_stationary_fields_are_not_refused(shape: float | None) -> None:
    """Correlation lengths of some 10 px in 100 x 140 px, long tails too: none of six is refused."""
    field = GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.2495, 0.2495), 1.0)
    for seed in range(6):
        x = latent(field, (1, 256, 256), seed)[:, :100, :140].astype(float)
        seen = x if shape is None else Marginal("gamma", 0.0, 1.0, shape)(x)
        assert not examine(seen).beyond(REFUSED)


def test_the_part_is_named_in_rows_and_columns_of_the_picture() -> None:
    image = NOISE.copy()
    image[:, :, 60:] *= 3.0
    with pytest.raises(DataError) as told:
        require_stationary(image, PixelRegion(100, 196, 200, 296))
    region = parse_region(re.search(r"region = '(\S+)',", str(told.value))[1], 196, 296)
    assert region.top >= 100
    assert 200 <= region.left < region.right <= 260


@pytest.mark.parametrize(
    ("mean", "spread", "verdict"),
    [
        (0.098, 1.38, "passes"),
        (0.102, 1.0, "told"),
        (0.0, 1.42, "told"),
        (0.49, 1.0, "told"),
        (0.0, 1.97, "told"),
        (0.51, 1.0, "refused"),
        (0.0, 2.03, "refused"),
    ],
)
def test_small_changes_are_told_and_gross_ones_refused(monkeypatch: pytest.MonkeyPatch, mean: float, spread: float, verdict: str) -> None:
    monkeypatch.setattr("seaglint.textures.suitability.examine", lambda frames: Changes(mean, spread))
    if verdict == "refused":
        with pytest.raises(DataError, match="not stationary"):
            require_stationary(NOISE)
    else:
        notes = require_stationary(NOISE)
        assert len(notes) == (verdict == "told")
        assert all(("mean changes" in note) is (mean > 0.1) and ("variance differs" in note) is (spread > 1.4) for note in notes)


def test_chance_alone_shows_in_one_picture_of_twenty() -> None:
    """White noise: upper 95 % of both measures; of 200 pictures 10 are expected, standard error 3."""
    found = [examine(picture) for picture in np.random.default_rng(9).normal(size=(200, 1, 48, 48))]
    assert 2 <= sum(changes.mean > 0.0 for changes in found) <= 20
    assert 2 <= sum(changes.spread > 1.0 for changes in found) <= 20


def test_the_share_of_a_slope_is_its_share_of_the_variance() -> None:
    ramp = np.sqrt(12.0 * 0.6) * np.linspace(-0.5, 0.5, 64)[:, None] + np.zeros(64)
    noise = np.random.default_rng(10).normal(size=(64, 64))
    # What chance does is taken off, 14 * 1.7 independent values' worth of 4096; the surface holds 14 of them.
    assert examine((ramp + noise)[None]).mean == pytest.approx(0.6 / 1.6, abs=0.02)


def test_a_constant_picture_does_not_change() -> None:
    assert examine(np.full((1, 40, 40), 3.0)) == Changes(0.0, 1.0)


def test_pixels_of_a_region_are_those_inside() -> None:
    assert PixelRegion(3, 10, 5, 9).pixels == PixelRegion(3, 10, 5, 9).of(NOISE).size


@pytest.mark.parametrize(("least", "share"), [(0.0, 0.75), (30.0, 0.5), (60.0, 0.375), (70.0, 0.25)])
def test_the_most_even_of_the_largest_regions_is_named(monkeypatch: pytest.MonkeyPatch, least: float, share: float) -> None:
    """Of five places each way, by the sum of both changes over their limits; columns above ``least`` alone pass."""
    image = (1000.0 * np.arange(120)[:, None] + np.arange(100))[None]

    def told(frames: np.ndarray) -> Changes:
        top, left = divmod(frames[0, 0, 0], 1000.0)
        return (
            Changes(0.09 if left >= least else 0.11, 1.0)
            if (top, left) == (0.0, 0.0)
            else Changes(0.02 + 0.0007 * abs(top - 20.0) + (0.0 if left >= least else 0.2), 1.35 - 0.002 * left - 0.001 * top)
        )

    monkeypatch.setattr("seaglint.textures.suitability.examine", told)
    height, width = max(int(120 * share), 24), max(int(100 * share), 24)
    tops, lefts = (np.linspace(0, size - side, 5).astype(int) for size, side in ((120, height), (100, width)))
    passing = {}
    for top in tops:
        for left in lefts:
            changes = told(image[:, top:, left:])
            if changes.mean <= 0.1 and changes.spread <= 1.4:
                passing[changes.mean * 14.0 + changes.spread] = PixelRegion(top, top + height, left, left + width)
    assert even_region(image) == passing[min(passing)]


def test_no_region_is_named_where_none_is_even_or_large_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    assert even_region(NOISE[:, :23]) is None
    monkeypatch.setattr("seaglint.textures.suitability.examine", lambda frames: Changes(0.2, 1.0))
    assert even_region(NOISE) is None


def test_at_most_eight_frames_are_examined_from_the_first_to_the_last() -> None:
    """A slope in frames that are left out, and one in a frame that is not."""
    noise = np.random.default_rng(12).normal(size=(40, 36, 48))
    seen = np.linspace(0, 39, 8).astype(int)
    left_out = noise.copy()
    left_out[np.setdiff1d(np.arange(40), seen)] += np.linspace(-9.0, 9.0, 48)
    assert examine(left_out) == examine(noise)
    for frame in seen:
        changed = noise.copy()
        changed[frame] += np.linspace(-9.0, 9.0, 48)
        assert examine(changed) != examine(noise)
