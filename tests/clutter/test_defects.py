"""What is no sea is found, and the extremes of the sea are not: lines, still pixels, dark corners, objects; fields with long tails."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from scipy import ndimage, special

from data_folders import data_folder
from seaglint.base.errors import DataError
from seaglint.clutter.defects import LARGEST_OBJECT, find_defects, gap_probability
from seaglint.textures.long_tails import interior


def correlated(rng: np.random.Generator, side: int, sigma: float, columns: float = 1.0) -> np.ndarray:
    field = ndimage.gaussian_filter(rng.normal(size=(side, side)), (sigma, columns * sigma), mode="wrap")
    return field / field.std()


def sea(seed: int) -> np.ndarray:
    """Return a field without objects: Gaussian, gamma, lognormal, K or a product with a slow field, of either sign, smooth or rounded."""
    rng = np.random.default_rng([11, seed])
    side, sigma = int(rng.choice([64, 96, 128, 192, 256])), rng.uniform(0.3, 2.5)
    g = correlated(rng, side, sigma, rng.choice([1.0, 1.6]))
    uniform, shape = special.ndtr(g), float(np.exp(rng.uniform(np.log(0.5), np.log(5.0))))
    match seed % 5:
        case 0:
            x = g
        case 1:
            x = special.gammaincinv(shape, uniform)
        case 2:
            x = np.exp(rng.uniform(0.2, 1.0) * g)
        case 3:
            x = special.gammaincinv(shape, uniform) * rng.exponential(size=g.shape)
        case _:
            x = np.sqrt(special.gammaincinv(shape, special.ndtr(correlated(rng, side, rng.uniform(3.0, 15.0))))) * g
    x = x if rng.random() < 0.7 else -x
    return np.round(255.0 * (x - x.min()) / np.ptp(x)) if rng.random() < 0.3 else x


def spoilt(seeds: range) -> tuple[int, float]:
    """Return the number of fields with any pixel left out, and the ratio of the exceedances of 3.5 sigma with and without."""
    number, before, after = 0, 0, 0
    for seed in seeds:
        x = sea(seed).astype(np.float32)
        mask = find_defects(x).mask
        number += bool(mask.any())
        before += np.count_nonzero(interior(x[None]) > 3.5)
        after += np.count_nonzero(interior(np.where(mask, np.float32(np.nan), x)[None]) > 3.5)
    return number, after / before


def test_the_sea_keeps_its_tail() -> None:
    """Fields that are left out happen in 2 %: of 20, four or more with a probability of 0.001."""
    number, ratio = spoilt(range(20))
    assert number <= 3
    assert ratio == pytest.approx(1.0, abs=0.05)


@pytest.mark.validation
def test_two_hundred_seas_keep_their_tails() -> None:
    number, ratio = spoilt(range(200))
    assert number <= 10
    assert ratio == pytest.approx(1.0, abs=0.05)


SEA = 50.0 + 4.0 * correlated(np.random.default_rng(1), 128, 1.0)


def test_sparse_glints_are_no_objects() -> None:
    """Glints of random strength, one in 300 pixels, over a smooth sea; in every frame at another place."""
    rng = np.random.default_rng(5)
    glints = np.where(rng.random((12, 96, 128)) < 1.0 / 300.0, rng.exponential(40.0, (12, 96, 128)), 0.0)
    frames = ndimage.gaussian_filter(glints, (0, 0.6, 0.6)) + rng.normal(5.0, 0.3, glints.shape)
    assert find_defects(frames).notes == ()
    assert [find_defects(frame).notes for frame in frames] == [()] * 12


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (3, 5), (9, 20)])
def test_objects_are_found(sign: float, rows: int, columns: int) -> None:
    x = SEA.copy()
    inside = slice(60, 60 + rows), slice(30, 30 + columns)
    x[inside] += sign * 80.0
    found = find_defects(x, origin=(100, 200))
    assert found.objects[inside].all()
    assert found.counts == {"objects": np.count_nonzero(found.mask)}
    assert np.count_nonzero(found.objects) < 3 * (rows + 4) * (columns + 4)
    assert f"rows {100 + np.argwhere(found.objects)[0][0]}:" in found.notes[0]


def test_two_objects_of_unlike_strength_are_found() -> None:
    x = SEA.copy()
    x[20:23, 20:26] += 200.0
    x[90:92, 70:74] += 60.0
    found = find_defects(x)
    assert found.objects[20:23, 20:26].all()
    assert found.objects[90:92, 70:74].all()


def test_a_coast_is_no_object() -> None:
    x = SEA.copy()
    x[:40, 60:110] += 100.0
    assert np.count_nonzero(find_defects(x).objects) < LARGEST_OBJECT


@pytest.mark.parametrize("line", [0, 1, 50, 126, 127])
@pytest.mark.parametrize("value", [48.0, 200.0])
def test_even_lines_are_found(line: int, value: float) -> None:
    x = SEA.copy()
    x[line] = value
    found = find_defects(x)
    assert np.flatnonzero(found.rows.all(axis=1)).tolist() == [line]
    assert not found.columns.any()
    assert f"1 row left out ({line})" in found.notes[0]
    found = find_defects(x.T, origin=(0, 300))
    assert np.flatnonzero(found.columns.all(axis=0)).tolist() == [line]
    assert f"1 column left out ({300 + line})" in found.notes[0]


def test_lines_of_another_level_are_found_at_the_border_of_the_picture_and_inside() -> None:
    x = SEA.copy()
    x[:, :2] += 25.0
    x[77] -= 25.0
    found = find_defects(x)
    assert np.flatnonzero(found.columns.all(axis=0)).tolist() == [0, 1]
    assert np.flatnonzero(found.rows.all(axis=1)).tolist() == [77]
    # A border of the region inside the picture is no border of the sensor.
    assert not find_defects(x, borders=(True, True, False, True)).columns.any()


def test_pixels_that_never_change() -> None:
    frames = np.random.default_rng(2).normal(10.0, 1.0, (9, 40, 50))
    frames[:, 12, 13] = 11.0
    found = find_defects(frames)
    assert np.argwhere(found.still).tolist() == [[12, 13]]
    assert found.notes == ("1 pixel left out: the same value in all frames",)
    assert not find_defects(frames[:7]).still.any()
    frames[:, 10:] = frames[0, 10:]
    found = find_defects(frames)
    assert not found.still.any()
    assert "75 % of the pixels never change" in found.notes[0]


@pytest.mark.parametrize("corner", [(0, 0), (0, 127), (127, 0), (127, 127)])
def test_dark_corners_are_found(corner: tuple[int, int]) -> None:
    distance = np.hypot(*(np.indices(SEA.shape) - np.array(corner)[:, None, None]))
    dark = np.clip((distance - 20.0) / 8.0, 0.0, 1.0)  # black up to 20 px
    found = find_defects(5.0 + (SEA - 5.0) * dark)
    assert found.dark[distance < 18.0].all()
    assert not found.dark[distance > 34.0].any()
    assert "dark corner or border" in found.notes[0]


def test_a_dark_border_is_found_and_a_dark_patch_of_sea_is_not() -> None:
    x = SEA.copy()
    x[:, 115:] = 8.0 + 0.2 * (x[:, 115:] - 50.0)
    found = find_defects(x)
    assert found.mask[:, 115:].all()
    assert not found.mask[:, :110].any()
    calm = SEA.copy()
    calm[50:80, 50:80] -= 15.0
    assert not find_defects(calm).dark.any()


def test_missing_values_and_constants() -> None:
    x = SEA.copy()
    x[10:20, 10:90] = np.nan
    assert not find_defects(x).mask.any()
    assert not find_defects(np.full((30, 30), 3.0)).mask.any()
    assert not find_defects(np.full((30, 30), np.nan)).mask.any()
    with pytest.raises(DataError, match="shape"):
        find_defects(np.zeros(5))


def test_gaps_have_the_probability_of_the_tail() -> None:
    """Of exponential excesses with a known scale, the largest exceeds the next by more than t with the probability exp(-t)."""
    excesses = np.sort(np.random.default_rng(3).exponential(size=250))[::-1]
    for gap in (1.0, 3.0):
        assert gap_probability(excesses, 1, gap) == pytest.approx(np.exp(-gap), rel=1.0)
        assert gap_probability(excesses, 2, gap) < gap_probability(excesses, 1, gap)
        assert gap_probability(7.0 * excesses, 1, 7.0 * gap) == pytest.approx(gap_probability(excesses, 1, gap))
    with pytest.raises(DataError, match="all 0"):
        gap_probability(np.zeros(30), 1, 1.0)


PICTURES = {
    107: (0, 220, 0, 297), 2: (125, 270, 0, 348), 20: (145, 274, 0, 302), 25: (0, 260, 0, 345), 26: (0, 261, 0, 345),
    28: (118, 256, 0, 300), 38: (135, 255, 0, 200), 4: (134, 278, 0, 348), 44: (80, 197, 0, 311),
}  # fmt: skip
"""Sea parts of measured pictures with a boat (top, bottom, left, right)."""


@pytest.mark.parametrize("number", PICTURES)
def test_boats_in_measured_pictures_are_found(number: int) -> None:
    from seaglint.formats.recording import open_recording

    data = data_folder("SEAGLINT_DATA_DIR")
    if data is None or not (data / "imagery" / f"Misc_{number}.png").is_file():
        pytest.skip("the measured pictures are not at hand")
    folder = data / "imagery"
    top, bottom, left, right = PICTURES[number]
    picture = open_recording(folder / f"Misc_{number}.png", channel="mean").read(0, 1)[0]
    borders = (top == 0, bottom == picture.shape[0], left == 0, right == picture.shape[1])
    found = find_defects(picture[top:bottom, left:right], borders=borders)
    for box in ET.parse(folder / f"Misc_{number}.xml").iter("bndbox"):
        x0, y0, x1, y1 = (int(box.findtext(name)) for name in ("xmin", "ymin", "xmax", "ymax"))
        assert found.objects[max(y0 - top, 0) : y1 - top, x0 - left : x1 - left].mean() > 0.8


def test_an_even_row_that_crosses_an_even_column_is_found() -> None:
    x = np.random.default_rng(4).normal(1000.0, 30.0, (1, 90, 120)).astype(np.float32)
    x[0, 40:42] = 20_000.0
    x[0, :, 0] = 0.0
    found = find_defects(x, borders=(True, True, True, True))
    assert np.flatnonzero(found.rows.all(axis=1)).tolist() == [40, 41]
    assert np.flatnonzero(found.columns.all(axis=0)).tolist() == [0]


@pytest.mark.parametrize("turns", range(4))
@pytest.mark.parametrize("depth", [12.0, 16.0])
def test_a_dark_corner_is_far_darker_than_the_darkest_patch_of_sea(depth: float, turns: int) -> None:
    """The same corner, with its waves, beside a patch of half of its depth and beside one of 0.8 of it."""
    for patch, found in ((0.5, True), (0.8, False)):
        x = SEA.copy()
        x[:24, :24] -= depth
        x[60:84, 60:84] -= patch * depth
        dark = np.rot90(find_defects(np.rot90(x, turns)).dark, -turns)
        assert dark[:20, :20].all() == found
        assert not dark[40:, 40:].any()
