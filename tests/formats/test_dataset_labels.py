"""Labels that target detectors are scored on: ignored objects through COCO's own scores, difficulty, and ``min_snr``."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_scenes import FRAMES, entries, masks

from seaglint.base.errors import DataError
from seaglint.formats.dataset import dataset_writing
from seaglint.formats.dataset.scene_records import DatasetObject, DatasetScene, Piece
from seaglint.scenario.records.ensemble_tables import Dataset
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, DatasetPlan, make_dataset

PLAN = DatasetPlan("small", 3, Dataset(), "[ensemble]\nscenes = 4\n")
SCENES = 4
BETWEEN = 6.0
"""Between the ratios of the boats, 90 counts over noise of 20, and those of the specks, 150 counts in a single pixel."""


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    return entries(tmp_path_factory.mktemp("stores"), SCENES, ("train", "val", "test"))


def made(stores, output: Path, form: str = "coco", plan: DatasetPlan = PLAN, least: float | None = BETWEEN, **more) -> Path:
    return make_dataset(output, plan, DatasetOptions.of(form, min_snr=least), lambda _: stores, **more)


@pytest.fixture(scope="module")
def coco(stores, tmp_path_factory):
    return made(stores, tmp_path_factory.mktemp("coco") / "D")


def truth(folder: Path) -> list[dict[str, str]]:
    with (folder / "truth.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_objects_below_the_least_ratio_are_ignored(coco):
    rows = [row for row in truth(coco) if row["annotated"] == "True"]
    ignored = {(row["image"], row["object"]) for row in rows if row["ignore"] == "True"}
    assert ignored == {(row["image"], row["object"]) for row in rows if float(row["snr"]) < BETWEEN}
    assert 0 < len(ignored) < len(rows)
    whole = json.loads((coco / "annotations.json").read_text())
    images = {image["id"]: Path(image["file_name"]).stem for image in whole["images"]}
    marked = {(images[one["image_id"]], one["object"]) for one in whole["annotations"] if one["iscrowd"]}
    assert marked == ignored
    assert all(one["ignore"] == one["iscrowd"] and (one["difficulty"] is None) == bool(one["ignore"]) for one in whole["annotations"])
    assert list(dataset_writing.problems(coco)) == []
    card = (coco / "README.md").read_text()
    assert f"{len(ignored)} of {len(rows)} annotated objects have an `snr` below 6 and are ignored" in card


@pytest.mark.parametrize("kind", ["bbox", "segm"])
@pytest.mark.parametrize("hits", ["all", "visible", "ignored"])
def test_cocoeval_counts_neither_hits_nor_misses_of_ignored_objects(coco, kind, hits):
    """Detections of all objects or of the visible ones alone are perfect; those of the ignored ones are no false alarms and no hits."""
    api, scores = pytest.importorskip("pycocotools.coco"), pytest.importorskip("pycocotools.cocoeval")
    read = api.COCO(str(coco / "annotations.json"))
    given = [one for one in read.loadAnns(read.getAnnIds()) if hits == "all" or bool(one["ignore"]) == (hits == "ignored")]
    field = "bbox" if kind == "bbox" else "segmentation"
    # Ignored objects have the highest scores: as false alarms they would halve the precision.
    found = [{name: one[name] for name in ("image_id", "category_id", field)} | {"score": 0.5 + 0.4 * one["ignore"]} for one in given]
    judged = scores.COCOeval(read, read.loadRes(found), kind)
    judged.evaluate()
    false_alarms, found_again, visible = 0, 0, 0
    for image in judged.evalImgs:
        if image is None or image["aRng"] != judged.params.areaRng[0]:
            continue
        counted = ~image["dtIgnore"][0].astype(bool)
        matched = image["dtMatches"][0] > 0
        false_alarms += int((counted & ~matched).sum())
        found_again += int((counted & matched).sum())
        visible += int((~np.asarray(image["gtIgnore"], bool)).sum())
    expected = sum(not one["ignore"] for one in read.loadAnns(read.getAnnIds()))
    assert (false_alarms, visible) == (0, expected)
    assert found_again == (0 if hits == "ignored" else expected)
    judged.accumulate()
    precision = judged.eval["precision"][:, :, :, 0, -1]
    assert precision[precision > -1].min() == (0.0 if hits == "ignored" else pytest.approx(1.0))


def test_formats_without_a_field_leave_ignored_objects_out(stores, coco, tmp_path):
    ignored = {(row["image"], row["object"]) for row in truth(coco) if row["ignore"] == "True"}
    sirst, yolo = made(stores, tmp_path / "sirst", "sirst"), made(stores, tmp_path / "yolo", "yolo")
    from PIL import Image

    lines = {path.stem: path.read_text().splitlines() for path in (yolo / "labels").rglob("*.txt")}
    for scene in range(SCENES - 1):
        for frame in range(FRAMES):
            name = f"{scene:04d}_{frame:06d}"
            own = zip(("speck-1", "boat"), masks(scene, frame), strict=True)
            seen = [mask for which, mask in own if mask.any() and (name, which) not in ignored]
            found = np.asarray(Image.open(sirst / "masks" / f"{name}.png")) > 0
            assert np.array_equal(found, np.logical_or.reduce([np.zeros_like(found), *seen]))
            assert len(lines[name]) == len(seen)
    assert {(row["image"], row["object"]) for row in truth(yolo) if row["ignore"] == "True"} == ignored
    assert list(dataset_writing.problems(sirst)) == list(dataset_writing.problems(yolo)) == []


@pytest.mark.parametrize("form", ["coco", "sirst"])
def test_a_ratio_that_leaves_nothing_is_one_line_and_a_lower_one_goes_on_without_rendering(stores, tmp_path, form):
    with pytest.raises(DataError, match=r"^min_snr = 100 leaves no object: the highest signal-to-noise ratio is \d") as error:
        made(stores, tmp_path / "D", form, least=100.0)
    assert "\n" not in str(error.value)
    highest = float(str(error.value).split("ratio is ")[1].split()[0])
    assert not (tmp_path / "D").exists()
    progress: list[int] = []
    again = made(stores, tmp_path / "D", form, resume=True, progress=lambda done, _: progress.append(done))
    assert progress == [SCENES]
    assert highest == pytest.approx(max(float(row["snr"]) for row in truth(again) if row["snr"]), rel=1e-3)
    (tmp_path / "fresh").mkdir()
    fresh = made(stores, tmp_path / "fresh" / "D", form)  # lists of SIRST are named by the folder
    for path in sorted(path.relative_to(fresh) for path in fresh.rglob("*") if path.is_file()):
        assert (again / path).read_bytes() == (fresh / path).read_bytes(), path
    with pytest.raises(DataError, match="made with another min_snr"):
        made(stores, tmp_path / "D", form, least=2.0, resume=True)


def test_a_default_that_leaves_nothing_is_reported_and_the_table_requests_one(stores, tmp_path, monkeypatch, caplog):
    table = replace(PLAN, table=Dataset(min_snr=100.0))
    with pytest.raises(DataError, match="min_snr = 100 leaves no object"):
        made(stores, tmp_path / "D", plan=table, least=None)
    given = made(stores, tmp_path / "other", plan=table, least=0.0)  # an option comes before the table
    assert not any(row["ignore"] == "True" for row in truth(given))
    monkeypatch.setattr("seaglint.studies.ensemble.ensemble_dataset.LEAST_SNR", 100.0)
    with caplog.at_level("WARNING", "seaglint"):
        weak = made(stores, tmp_path / "weak", least=None)
    assert "min_snr = 100 leaves no object" in caplog.text
    assert all(row["ignore"] == row["annotated"] for row in truth(weak))


@pytest.mark.parametrize(("least", "masks"), [(-1.0, "response"), (float("nan"), "response"), (float("inf"), "response"), (1.0, "outline")])
def test_options_that_are_none_are_one_line(least, masks):
    with pytest.raises(DataError, match=r"^(min_snr|masks) = ") as error:
        DatasetOptions.of("coco", min_snr=least, masks=masks)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("snr", "visible", "area", "expected"),
    [
        (7.0, 1.0, 4, "easy"),
        (7.0, 0.85, 4, "easy"),
        (7.0, 0.84, 4, "medium"),
        (7.0, 1.0, 3, "medium"),
        (6.9, 1.0, 90, "medium"),
        (3.0, 0.5, 1, "medium"),
        (2.9, 1.0, 90, "hard"),
        (30.0, 0.4, 90, "hard"),
        (1.0, 1.0, 9, "hard"),
        (0.9, 1.0, 9, None),
        (None, 1.0, 9, None),
        (9.0, None, 9, None),
        (9.0, 1.0, 0, None),
    ],
)
def test_difficulty_has_its_limits(snr, visible, area, expected):
    pieces = (Piece((0, 0, area, 1), area, ""),) if area else ()
    row = DatasetObject(0, 0, {"visible_share": visible}, None, None, snr, pieces)
    part = DatasetScene("0", "train", 1, (9, 99), 1.0, ("a",), ("a",), (), (row,), {}, "geometric", 1.0)
    assert part.difficulty(row) == expected
