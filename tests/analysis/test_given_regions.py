"""Regions that a user gives: numbers, rectangles, masks, files; what is refused; bad input."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import seaglint as sg
from seaglint.analysis import AnalysisOptions, Recording, analyze
from seaglint.analysis.given_regions import given_regions
from seaglint.base.errors import DataError
from seaglint.formats.region_files import read_regions

ROWS, COLUMNS = 40, 64
FRAMES = np.random.default_rng(5).normal(100.0, 5.0, (3, ROWS, COLUMNS)).astype(np.float32)
FRAMES[:, :20] += 50.0
LABELS = np.zeros((ROWS, COLUMNS), np.int64)
LABELS[:20], LABELS[20:, 30:] = 7, 2


@pytest.fixture(autouse=True)
def few_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    from functools import partial

    from seaglint.clutter.fits import goodness

    monkeypatch.setattr("seaglint.analysis.region.goodness", partial(goodness, replicates=19))


def result(**options: Any) -> Any:
    return analyze(Recording("memory", *FRAMES.shape, lambda a, b: FRAMES[a:b].copy()), AnalysisOptions(**options))


def test_every_number_is_a_region() -> None:
    found = result(regions=LABELS)
    written = json.loads(json.dumps(found.as_dict(), allow_nan=False))
    assert list(written["regions"]) == ["all", "2", "7"]
    assert written["regions"]["7"]["pixels"] == 20 * COLUMNS
    assert written["regions"]["7"]["mean"] - written["regions"]["2"]["mean"] == pytest.approx(50.0, abs=0.5)
    assert len(written["regions"]["2"]["false_alarms"]) == 2
    assert written["segmentation"]["found"] is False
    assert found.names == ("all", "2", "7")


@pytest.mark.parametrize("kind", ["array", "masks", "rectangles", "png", "npy", "json", "float npy"])
def test_all_forms_give_the_same_masks(kind: str, tmp_path: Path) -> None:
    rectangles = {"7": ":20,:", "2": "20:,30:"}
    path = tmp_path / f"regions.{kind.split()[-1]}"
    given: Any = {"array": LABELS, "masks": {name: int(name) == LABELS for name in rectangles}, "rectangles": rectangles}.get(kind, path)
    match kind:
        case "png":
            Image.fromarray(LABELS.astype(np.uint8)).save(path)
        case "npy":
            np.save(path, LABELS)
        case "float npy":
            np.save(path, LABELS.astype(float))
        case "json":
            path.write_text(json.dumps(rectangles))
    masks, notes = given_regions(read_regions(given) if isinstance(given, Path) else given, ROWS, COLUMNS)
    assert set(masks) == {"7", "2"}
    assert all(np.array_equal(masks[name], int(name) == LABELS) for name in masks)
    assert notes == []


def test_overlaps_are_counted_in_both_and_reported() -> None:
    masks, notes = given_regions({"a": "0:10,:", "b": "5:20,:", "c": "30:,:"}, ROWS, COLUMNS)
    assert [int(mask.sum()) for mask in masks.values()] == [10 * COLUMNS, 15 * COLUMNS, 10 * COLUMNS]
    assert notes == [f"regions a and b share {5 * COLUMNS} pixels, which are counted in both"]


def many(count: int) -> np.ndarray:
    return np.minimum(np.arange(ROWS * COLUMNS), count).reshape(ROWS, COLUMNS)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (np.ones((10, 64), int), "10 x 64, the frames have 40 x 64"),
        (np.full((ROWS, COLUMNS), -1), "negative or not whole, the first -1"),
        (np.full((ROWS, COLUMNS), 0.5), "negative or not whole, the first 0.5"),
        (np.full((ROWS, COLUMNS), np.nan), "negative or not whole, the first nan"),
        (np.zeros((ROWS, COLUMNS), int), "no pixel is in any region"),
        (many(51), "51 different numbers"),
        (np.full((ROWS, COLUMNS), "a"), "values of type"),
        ({}, "no pixel is in any region"),
        ({str(k): ":,:" for k in range(51)}, "51 of them; give at most 50"),
        ({"all": ":,:"}, "the name all is in use"),
        ({"glint": ":,:"}, "the name glint is in use"),
        ({"background": ":,:"}, "the name background is in use"),
        ({"a": "0:100,:"}, "regions, a: region = 0:100,:"),
        ({"a": "here"}, "regions, a: region = here"),
        ({"a": np.ones((2, 2), bool)}, "regions, a: 2 x 2"),
        ({"a": None}, "regions, a"),
        ({"": ":,:"}, "the name ''"),
        ({3: ":,:"}, "the name 3"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(given: Any, says: str) -> None:
    with pytest.raises(DataError, match="regions") as told:
        given_regions(given, ROWS, COLUMNS)
    assert says in str(told.value)
    assert "\n" not in str(told.value)


def test_fifty_regions_are_enough() -> None:
    assert len(given_regions(many(50), ROWS, COLUMNS)[0]) == 50


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[1, 2]", "holds no object"),
        ("{}", "holds no object"),
        ('{"a": 3}', "the region a is 3"),
        ('{"a": ":,:", "a": ":,:"}', "is there twice"),
        ("{", "is not JSON"),
    ],
)
def test_other_json_is_refused_in_one_line(text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "regions.json").write_text(text)
    with pytest.raises(DataError, match=r"regions\.json") as told:
        read_regions(tmp_path / "regions.json")
    assert says in str(told.value)
    assert "\n" not in str(told.value)


def test_regions_of_several_frames_are_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "regions.npy", np.ones((3, ROWS, COLUMNS), int))
    with pytest.raises(DataError, match="3 frames"):
        read_regions(tmp_path / "regions.npy")


def test_a_small_region_is_noted() -> None:
    found = result(regions={"near": "20:,:", "tiny": "0:5,0:5"})
    assert set(found.regions) == {"all", "near"}
    assert found.as_dict()["regions"]["tiny"] is None
    assert "the tiny region has 25 pixels, too few for statistics (at least 100)" in found.notes


@pytest.mark.parametrize("pair", [("mask", "no_glint"), ("mask", "regions"), ("no_glint", "regions")])
def test_ways_to_make_regions_exclude_each_other(pair: tuple[str, str]) -> None:
    ways = {"mask": LABELS > 0, "no_glint": True, "regions": LABELS}
    with pytest.raises(DataError, match="exclude each other"):
        AnalysisOptions(**{name: ways[name] for name in pair})


def test_without_glint_there_is_one_region() -> None:
    found = sg.analyze(FRAMES, no_glint=True)
    assert list(found.regions) == ["all"]
    assert found.as_dict()["regions"]["background"] is None
    assert not any("corridor" in note for note in found.notes)


def test_python_takes_a_path(tmp_path: Path) -> None:
    (tmp_path / "regions.json").write_text('{"near": "20:,:"}')
    assert set(sg.analyze(FRAMES, regions=tmp_path / "regions.json").regions) == {"all", "near"}
    assert set(sg.analyze(FRAMES, regions=str(tmp_path / "regions.json")).regions) == {"all", "near"}


@pytest.mark.parametrize(("mask", "says"), [(np.ones((ROWS, COLUMNS), bool), "every pixel"), (np.zeros((ROWS, COLUMNS), bool), "no pixel")])
def test_a_mask_of_all_or_nothing_is_noted_once(mask: np.ndarray, says: str) -> None:
    notes = [note for note in result(mask=mask).notes if note.startswith("the mask") or "region has" in note]
    assert len(notes) == 1
    assert f"the mask covers {says}" in notes[0]


def test_a_picture_of_one_value_has_no_corridor() -> None:
    found = analyze(Recording("one value", 1, 64, 64, lambda a, b: np.full((1, 64, 64), 3.0, np.float32)))
    assert found.segmentation.found is False
    assert any(note.startswith("no glint corridor found: constant picture") for note in found.notes)


def test_a_dead_row_changes_no_verdict() -> None:
    picture = np.random.default_rng(3).normal(100.0, 5.0, (1, 64, 96)).astype(np.float32)
    picture[:, 30] = 0.0
    found = analyze(Recording("dead row", 1, 64, 96, lambda a, b: picture[a:b].copy()))
    assert any("1 rows left out (30)" in note for note in found.notes)
    assert not found.segmentation.found


def test_a_clip_of_two_frames_is_answered() -> None:
    found = analyze(
        Recording("two", 2, 64, 96, lambda a, b: np.random.default_rng(3).normal(1.0, 0.1, (2, 64, 96)).astype(np.float32)[a:b])
    )
    assert set(found.regions) == {"all", "background"}


def test_report_and_pictures_have_every_region(tmp_path: Path) -> None:
    """More regions than panels abreast, than lines of a legend and than colours."""
    from seaglint.plot.analysis_report import report

    regions = {f"part-{k}": f"{4 * (k // 2)}:{4 * (k // 2) + 4},{32 * (k % 2)}:{32 * (k % 2) + 32}" for k in range(14)}
    text = report(result(regions=regions))
    assert all(f"part-{k}" in text for k in range(14))
    assert "given: part-0" in text
