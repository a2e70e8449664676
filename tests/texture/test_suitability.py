"""What a texture is not fitted to, and the region that is named instead."""

from __future__ import annotations

import re

import numpy as np
import pytest

from seaglint.errors import DataError
from seaglint.texture.suitability import parse_region, require_stationary, require_values

NOISE = np.random.default_rng(3).normal(size=(1, 96, 96)).astype(np.float32)


def with_hole() -> np.ndarray:
    image = NOISE.copy()
    image[0, 5, 7] = np.nan
    return image


@pytest.mark.parametrize(
    ("image", "told"),
    [
        (NOISE[:, :20], "20 x 96 pixels are too few"),
        (with_hole(), "1 values are missing .* row 5, column 7"),
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
    with pytest.raises(DataError, match=r"mean .* variance .* choose --region") as told:
        require_stationary(image)
    region = parse_region(re.search(r"--region (\S+),", str(told.value) + ",")[1].rstrip(","), 96, 96)
    assert region.right <= 60 or region.left >= 60
    assert region.pixels >= 24 * 24
    assert require_stationary(region.of(image)) == ()


@pytest.mark.parametrize("text", ["5", "0:10", "a:b,0:5", "50:10,:", ":200,:"])
def test_regions_of_another_form_are_refused(text: str) -> None:
    with pytest.raises(DataError, match=r"--region .* give"):
        parse_region(text, 96, 96)
