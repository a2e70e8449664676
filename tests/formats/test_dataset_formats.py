"""Data sets as training programs read them: scale, boxes, masks, splits, the same bytes whoever wrote them."""

from __future__ import annotations

import csv
import hashlib
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image
from small_scenes import COLUMNS, FRAMES, LINE, ROWS, entries, masks, values

from seaglint.base.errors import DataError
from seaglint.cluster import ThisProcess
from seaglint.formats.dataset import dataset_writing
from seaglint.formats.dataset.dataset_writing import pieces
from seaglint.formats.dataset.grey_pictures import compressed, decoded, expanded, read_about
from seaglint.formats.dataset.scene_records import SPLITS, splits_of
from seaglint.formats.object_labels import Label, run_lengths
from seaglint.scenario.records.ensemble_tables import Dataset
from seaglint.store.sequence_store import Interrupted
from seaglint.studies.ensemble import ensemble_dataset as module
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, DatasetPlan, make_dataset

PLAN = DatasetPlan("small", 3, Dataset(classes={"speck": "target"}), "[ensemble]\nscenes = 4\n")
SCENES = 4


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stores")
    return {counts: entries(folder / str(counts), SCENES, SPLITS, counts=counts) for counts in (True, False)}


def made(stores, output: Path, form: str, bits=None, image=None, counts=True, **more) -> Path:
    return make_dataset(output, PLAN, DatasetOptions.of(form, bits, image), lambda _: stores[counts], **more)


@pytest.fixture(scope="module")
def coco(stores, tmp_path_factory):
    return made(stores, tmp_path_factory.mktemp("coco") / "D", "coco")


def image_name(scene: int, frame: int) -> str:
    return f"{scene:04d}_{frame:06d}"


def digests(folder: Path) -> dict[str, str]:
    paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}


@pytest.mark.parametrize(("bits", "image", "counts"), [(8, "png", True), (16, "tiff", True), (16, "png", False), (8, "tiff", False)])
def test_pictures_give_radiance_back_within_half_a_step(stores, tmp_path, bits, image, counts):
    folder = made(stores, tmp_path / "D", "coco", bits, image, counts)
    for scene in range(SCENES):
        lines = set()
        for frame in range(FRAMES):
            path = folder / "images" / f"{image_name(scene, frame)}.{image}"
            levels = tifffile.imread(path) if image == "tiff" else np.asarray(Image.open(path))
            assert levels.dtype == (np.uint8 if bits == 8 else np.uint16)
            about = read_about(path)
            scale, offset = float(about["radiance_scale"]), float(about["radiance_offset"])
            lines.add((scale, offset))
            given = np.asarray(values(scene, frame, counts=counts), np.float64)
            radiance = given * LINE[0] + LINE[1] if counts else given
            assert np.abs(scale * levels + offset - radiance).max() <= 0.5 * scale * (1.0 + 1e-9)
            if counts:
                told = float(about["count_scale"]) * levels + float(about["count_offset"])
                assert np.abs(told - given).max() <= 0.5 * float(about["count_scale"])
        assert len(lines) == 1  # of all frames of a scene


def test_sixteen_bits_are_the_counts_themselves(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "coco", 16)
    found = np.asarray(Image.open(folder / "images" / f"{image_name(1, 2)}.png"))
    assert np.array_equal(found, values(1, 2, counts=True))


def test_eight_bits_use_the_whole_range_of_the_scene(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "coco", 8)
    for scene in range(SCENES):
        found = np.stack([np.asarray(Image.open(folder / "images" / f"{image_name(scene, n)}.png")) for n in range(FRAMES)])
        given = np.stack([values(scene, n, counts=True) for n in range(FRAMES)])
        # steps are not finer than a count
        assert (found.min(), found.max()) == (0, min(255, int(np.ptp(given))))


def test_pycocotools_reads_the_masks_of_the_truth(coco):
    coco_masks = pytest.importorskip("pycocotools.mask")
    read = pytest.importorskip("pycocotools.coco").COCO(str(coco / "annotations.json"))
    assert len(read.getImgIds()) == SCENES * FRAMES
    assert sorted(one["name"] for one in read.loadCats(read.getCatIds())) == ["small-boat", "target"]
    seen = 0
    for image in read.loadImgs(read.getImgIds()):
        assert (coco / "images" / image["file_name"]).is_file()
        assert (image["width"], image["height"]) == (COLUMNS, ROWS)
        scene, frame = int(image["scene"]), image["frame"]
        wanted = {n: mask for n, mask in enumerate(masks(scene, frame), 1) if mask.any()} if scene < SCENES - 1 else {}
        found = read.loadAnns(read.getAnnIds(imgIds=[image["id"]]))
        assert {one["object_id"] for one in found} == set(wanted)
        for one in found:
            mask = wanted[one["object_id"]]
            assert np.array_equal(read.annToMask(one).astype(bool), mask)
            assert one["area"] == mask.sum() == coco_masks.area(one["segmentation"])
            assert one["bbox"] == coco_masks.toBbox(one["segmentation"]).tolist()
            assert one["iscrowd"] == 0
            rows, columns = np.nonzero(mask)
            assert one["centroid"] == [columns.mean() + 0.25, rows.mean()]
            assert one["filled_px"] == 0.25 * mask.sum()
            assert one["attributes"] == {"visible_share": 1.0, "occluded_share": None, "truncated_share": None}
            assert one["snr"] > 0.0
            seen += 1
    assert seen == (SCENES - 1) * (2 * FRAMES - 1)


def test_the_lines_of_the_guide_load_it(coco):
    page = Path(__file__).resolve().parents[2] / "docs" / "guide" / "datasets.md"
    training = page.read_text(encoding="utf-8").partition("## In training")[2]
    (block,) = re.findall(r"```python\n(.*?)```", training, re.DOTALL)
    names = {}
    exec(compile(block.replace("small/", f"{coco}/"), str(page), "exec"), names)
    scene, frame = int(names["image"]["scene"]), names["image"]["frame"]
    assert names["image"]["split"] == "train"
    given = values(scene, frame, counts=True) * LINE[0] + LINE[1]
    assert np.abs(names["radiance"] - given).max() <= names["image"]["radiance_error"] * (1.0 + 1e-9)
    assert names["mask"].any() == bool(names["found"])


def test_pycocotools_takes_the_annotations_as_results(coco):
    read = pytest.importorskip("pycocotools.coco").COCO(str(coco / "annotations.json"))
    given = read.loadAnns(read.getAnnIds())
    boxes = [{"image_id": one["image_id"], "category_id": one["category_id"], "bbox": one["bbox"], "score": 0.5} for one in given]
    shapes = [
        {"image_id": one["image_id"], "category_id": one["category_id"], "segmentation": one["segmentation"], "score": 0.5} for one in given
    ]
    assert len(read.loadRes(boxes).getAnnIds()) == len(given)
    loaded = read.loadRes(shapes)
    assert [one["area"] for one in loaded.loadAnns(loaded.getAnnIds())] == [one["area"] for one in given]


def test_tracks_are_one_object_of_one_scene(coco):
    whole = json.loads((coco / "annotations.json").read_text())
    tracks = {}
    for one in whole["annotations"]:
        assert tracks.setdefault(one["track_id"], (one["scene"], one["object_id"])) == (one["scene"], one["object_id"])
    assert len(set(tracks.values())) == len(tracks) == 2 * (SCENES - 1)


def test_split_files_have_the_scenes_of_their_split_and_all_are_in_one(coco):
    whole = json.loads((coco / "annotations.json").read_text())
    parts = {split: json.loads((coco / f"annotations_{split}.json").read_text()) for split in SPLITS}
    scenes = {split: {image["scene"] for image in part["images"]} for split, part in parts.items()}
    assert scenes == {"train": {"0000", "0003"}, "val": {"0001"}, "test": {"0002"}}
    for name in ("images", "annotations"):
        together = [one for part in parts.values() for one in part[name]]
        assert sorted(together, key=lambda one: one["id"]) == whole[name]
    with (coco / "parameters.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["scene"], row["split"], row["wind.speed_m_s"]) for row in rows][:2] == [("0000", "train", "5.0"), ("0001", "val", "6.0")]
    assert float(rows[0]["radiance_scale"]) == LINE[0]


def test_the_truth_table_has_objects_out_of_view(coco):
    with (coco / "truth.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == (SCENES - 1) * 2 * FRAMES
    hidden = [row for row in rows if row["annotated"] == "False"]
    assert {(row["object"], row["frame"], row["visible_share"]) for row in hidden} == {("boat", "2", "0.0")}


def test_the_ratio_is_of_the_delivered_picture(coco):
    """A speck 150 counts above noise of 20 counts rms is 7.5 above it, less the noise of 450 pixels and that of its own."""
    with (coco / "truth.csv").open(newline="") as file:
        row = next(row for row in csv.DictReader(file) if row["object"] == "boat" and row["annotated"] == "True")
    assert float(row["snr"]) == pytest.approx(90.0 / 20.0, rel=0.1)  # 22 pixels: 0.05 of the noise, and its rms to 4 %
    assert float(row["local_contrast_W_m2_sr"]) == pytest.approx(90.0 * LINE[0], rel=0.1)


def test_yolo_labels_are_the_boxes_of_the_masks(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "yolo")
    lines = (folder / "data.yaml").read_text().splitlines()
    names = {int(line.split(":")[0]): line.split(": ")[1].strip('"') for line in lines if line.startswith("  ")}
    assert names == {0: "small-boat", 1: "target"}
    assert lines[:3] == [f"{split}: images/{split}" for split in SPLITS]
    count = 0
    for split in SPLITS:
        for path in sorted((folder / "images" / split).glob("*.png")):
            scene, frame = (int(part) for part in path.stem.split("_"))
            assert np.asarray(Image.open(path)).dtype == np.uint8
            wanted = masks(scene, frame) if scene < SCENES - 1 else []
            rows = [line.split() for line in (folder / "labels" / split / f"{path.stem}.txt").read_text().splitlines()]
            assert len(rows) == sum(mask.any() for mask in wanted)
            for number, *box in rows:
                x, y, width, height = (float(v) * side for v, side in zip(box, (COLUMNS, ROWS, COLUMNS, ROWS), strict=True))
                mask = wanted[0] if names[int(number)] == "target" else wanted[1]
                inside = np.zeros((ROWS, COLUMNS), bool)
                inside[round(y - height / 2) : round(y + height / 2), round(x - width / 2) : round(x + width / 2)] = True
                assert not (mask & ~inside).any()
                assert inside.any(axis=0).sum() == mask.any(axis=0).sum()
                assert inside.any(axis=1).sum() == mask.any(axis=1).sum()
            count += 1
    assert count == SCENES * FRAMES


def test_sirst_masks_and_lists(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "sirst")
    lists = {split: (folder / "img_idx" / f"{split}.txt").read_text().split() for split in SPLITS}
    assert lists["val"] == [image_name(1, frame) for frame in range(FRAMES)]
    for name in (name for names in lists.values() for name in names):
        scene, frame = (int(part) for part in name.split("_"))
        mask = np.asarray(Image.open(folder / "masks" / f"{name}.png"))
        wanted = np.logical_or.reduce(masks(scene, frame)) if scene < SCENES - 1 else np.zeros((ROWS, COLUMNS), bool)
        assert np.array_equal(mask, np.where(wanted, 255, 0))
        assert np.asarray(Image.open(folder / "images" / f"{name}.png")).shape == mask.shape


def test_zarr_keeps_the_stores(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "zarr")
    assert digests(folder / "scenes" / "0001.zarr") == digests(Path(stores[True][1].store))
    assert list(dataset_writing.problems(folder)) == []


def test_a_data_set_taken_up_again_has_the_same_bytes(stores, tmp_path):
    form = "coco"
    whole = made(stores, tmp_path / "whole", form)

    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="stopped after 2 of 4 scenes"):
        made(stores, tmp_path / "D", form, progress=stop)
    assert not (tmp_path / "D").exists()
    with pytest.raises(DataError, match="continue it with resume"):
        made(stores, tmp_path / "D", form)
    seen = []
    again = made(stores, tmp_path / "D", form, resume=True, progress=lambda done, _: seen.append(done))
    assert seen == [2, 3, 4]  # finished scenes are not written again
    assert digests(again) == digests(whole)
    assert made(stores, tmp_path / "D", form, resume=True) == again


class Backwards:
    """Workers who do the last scene first."""

    count = 3

    def map(self, job, units):
        return ThisProcess().map(job, list(units)[::-1])


@pytest.mark.validation
@pytest.mark.parametrize("form", ["yolo", "zarr"])
def test_bytes_do_not_depend_on_the_order_of_work(stores, tmp_path, form):
    assert digests(made(stores, tmp_path / "one", form)) == digests(made(stores, tmp_path / "other", form, workers=Backwards()))


def test_scenes_that_fail_are_named_and_the_rest_is_kept(stores, tmp_path):
    lost = {True: [*stores[True][:2], replace(stores[True][2], store=str(tmp_path / "gone.zarr")), stores[True][3]]}
    with pytest.raises(DataError, match=r"scene 0002: .*no such sequence(.|\n)*1 of 4 scenes failed"):
        made(lost, tmp_path / "D", "coco")
    assert not (tmp_path / "D").exists()
    seen = []
    made(stores, tmp_path / "D", "coco", resume=True, progress=lambda done, _: seen.append(done))
    assert seen == [3, 4]


def test_a_data_set_killed_as_it_gets_its_name_is_not_made_again(stores, tmp_path, monkeypatch):
    def killed(partial, output):
        shutil.rmtree(partial / ".parts")
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(module, "_give_name", killed)
        with pytest.raises(KeyboardInterrupt):
            made(stores, tmp_path / "D", "coco")
    with pytest.raises(DataError, match=r"D.partial: was made with another ensemble.scenes"):
        make_dataset(tmp_path / "D", replace(PLAN, source="[ensemble]\nscenes = 5\n"), DatasetOptions.of("coco"), lambda _: [], resume=True)
    again = make_dataset(tmp_path / "D", PLAN, DatasetOptions.of("coco"), lambda _: pytest.fail("rendered again"), resume=True)
    assert not list(dataset_writing.problems(again))
    assert [path.name for path in tmp_path.iterdir()] == ["D"]


def test_a_data_set_killed_as_it_begins_is_begun_again(stores, tmp_path):
    (tmp_path / "D.partial" / ".parts").mkdir(parents=True)
    (tmp_path / "D.partial" / ".parts" / "settings.json.partial").write_text("{")
    with pytest.raises(DataError, match="continue it with resume"):
        made(stores, tmp_path / "D", "coco")
    assert made(stores, tmp_path / "D", "coco", resume=True).is_dir()


def test_resuming_with_other_settings_says_which(stores, tmp_path):
    made(stores, tmp_path / "D", "coco")
    with pytest.raises(DataError, match=r"D: was made with another ensemble.scenes, ensemble.seed; resume"):
        make_dataset(
            tmp_path / "D", replace(PLAN, source="[ensemble]\nscenes = 5\nseed = 2\n"), DatasetOptions.of("coco"), lambda _: [], resume=True
        )
    with pytest.raises(DataError, match="made with another bits"):
        made(stores, tmp_path / "D", "coco", 16, resume=True)


def test_a_folder_of_somebody_else_is_not_emptied(stores, tmp_path):
    made(stores, tmp_path / "D", "coco")
    (tmp_path / "D.partial").mkdir()
    (tmp_path / "D.partial" / "mine.txt").write_text("mine")
    for more in ({"overwrite": True}, {"resume": False}):
        with pytest.raises(DataError):
            made(stores, tmp_path / "D", "coco", **more)
    assert (tmp_path / "D.partial" / "mine.txt").is_file()


def test_what_is_there_is_not_replaced_unasked(stores, tmp_path):
    (tmp_path / "D").mkdir()
    (tmp_path / "D" / "mine.txt").write_text("mine")
    with pytest.raises(DataError, match="is not empty"):
        made(stores, tmp_path / "D", "coco")
    with pytest.raises(DataError, match="is no data set of seaglint"):
        made(stores, tmp_path / "D", "coco", overwrite=True)
    (tmp_path / "D" / "mine.txt").unlink()
    (tmp_path / "D.old").mkdir()
    assert made(stores, tmp_path / "D", "coco").is_dir()
    assert made(stores, tmp_path / "D", "yolo", overwrite=True).is_dir()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["D", "D.old"]  # that is somebody's own
    assert not (tmp_path / "D" / ".replaced").exists()


@pytest.mark.parametrize("arguments", [("voc",), ("coco", 12), ("coco", 8, "jpeg"), ("zarr", 8)])
def test_formats_that_there_are_not_are_one_line(arguments):
    with pytest.raises(DataError, match=r"^`?(format|bits|image)\b") as error:
        DatasetOptions.of(*arguments)
    assert "\n" not in str(error.value)


def spoil_picture(folder):
    path = next(folder.glob("images/*.png"))
    path.write_bytes(path.read_bytes()[:200])


def spoil_size(folder):
    path = next(folder.glob("images/*.png"))
    Image.fromarray(np.zeros((5, 6), np.uint16)).save(path)


def edited(change):
    def spoil(folder):
        for path in folder.glob("annotations*.json"):
            whole = json.loads(path.read_text())
            change(whole, path.name)
            path.write_text(json.dumps(whole))

    return spoil


def move_box(whole, _):
    for one in whole["annotations"]:
        one["bbox"][0] += 1


def push_out(whole, _):
    for one in whole["annotations"]:
        one["bbox"][0] = COLUMNS


def double(whole, name):
    if name == "annotations_val.json":
        whole["images"].append({**whole["images"][0], "id": 1})


def spoil_table(folder):
    path = folder / "parameters.csv"
    path.write_text(path.read_text().replace(",val,", ",train,"))


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda folder: next(folder.glob("images/*.png")).unlink(), "is missing"),
        (lambda folder: (folder / "new.txt").write_text(""), "is not in SHA256SUMS"),
        (spoil_picture, "cannot be read as a picture"),
        (spoil_size, "has 6 x 5 pixels"),
        (edited(move_box), "is not that of its mask"),
        (edited(push_out), "is not within 32 x 24"),
        (edited(double), "each once"),
        (spoil_table, "is in 'train' and in 'val'"),
    ],
)
def test_what_is_spoilt_is_found(coco, tmp_path, spoil, told):
    folder = shutil.copytree(coco, tmp_path / "D")
    assert list(dataset_writing.problems(folder)) == []
    spoil(folder)
    if "SHA256SUMS" not in told and "missing" not in told:
        assert any("checksum" in line for line in dataset_writing.problems(folder))
        dataset_writing.write_sums(folder)
    assert any(told in line for line in dataset_writing.problems(folder))


def test_sirst_masks_that_are_not_of_their_boxes_are_found(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "sirst")
    path = folder / "masks" / f"{image_name(0, 0)}.png"
    Image.fromarray(np.roll(np.asarray(Image.open(path)), 9, axis=0)).save(path)
    dataset_writing.write_sums(folder)
    found = list(dataset_writing.problems(folder))
    assert any("has nothing in the box" in line for line in found)
    assert any("outside of the boxes" in line for line in found)


def test_run_lengths_are_those_of_pycocotools():
    coco_masks = pytest.importorskip("pycocotools.mask")
    for seed in range(5):
        mask = np.random.default_rng(seed).random((37, 41)) < 0.3 * seed
        text = compressed(run_lengths(mask))
        assert text.encode() == coco_masks.encode(np.asfortranarray(mask.astype(np.uint8)))["counts"]
        assert expanded(text) == run_lengths(mask)
        assert np.array_equal(decoded(text, mask.shape), mask)


def test_an_object_over_the_seam_of_a_panorama_has_two_boxes():
    mask = np.zeros((4, 10), bool)
    mask[1:3, [0, 1, 8, 9]] = True
    found = pieces(Label(0, 0, "ship", {"bbox_left_px": 8.0, "bbox_width_px": 4.0}, mask))
    assert sorted(piece.box for piece in found) == [(0, 1, 2, 2), (8, 1, 2, 2)]
    assert sum(piece.area for piece in found) == mask.sum()


def shares_of(seed: int) -> tuple[float, float, float]:
    """Random shares of the splits; of every fourth seed one of them is 0, and of every fifth they are those of the example."""
    train, val, test = np.random.default_rng(seed).dirichlet([2.0, 0.5, 0.5]).tolist()
    if seed % 5 == 0:
        return 0.7, 0.15, 0.15
    return (train + test, val, 0.0) if seed % 4 == 0 else (train, val, test)


@pytest.mark.parametrize("seed", range(60))
def test_splits_keep_their_shares_however_few_scenes_there_are(seed):
    fractions = shares_of(seed)
    whole = splits_of(seed, 200, fractions)
    for count in [*range(1, 51), 100, 200]:
        found = splits_of(seed, count, fractions)
        assert found == whole[:count]  # scenes added later move none
        numbers = [found.count(split) for split in SPLITS]
        used = [number for number, fraction in zip(numbers, fractions, strict=True) if fraction > 0.0]
        assert sum(numbers) == sum(used) == count
        if count >= 2:
            assert numbers[1] > 0
        if count >= len(used):
            assert min(used) > 0
        shares = [fraction * count for fraction in fractions if fraction > 0.0]
        if min(shares) >= 1.0:
            assert max(abs(number - share) for number, share in zip(used, shares, strict=True)) < 1.0


def test_splits_are_of_the_seed_and_have_no_period():
    fractions = (0.75, 0.25, 0.0)
    found = [splits_of(seed, 400, fractions) for seed in (5, 6)]
    assert found[0] != found[1]
    # points of Sobol with one remainder are in one part of their interval: a split must have scenes of all remainders
    for period in (2, 4, 8, 16):
        places = {n % period for n, split in enumerate(found[0]) if split == "val"}
        assert places == set(range(period))


@pytest.mark.parametrize(("fractions", "count", "told"), [((0.7, 0.15, 0.15), 2, "test has none; draw 3"), ((0.9, 0.1, 0.0), 1, "val has")])
def test_a_share_that_cannot_be_kept_is_one_line(caplog, fractions, count, told):
    with caplog.at_level("WARNING", "seaglint"):
        module.report_splits(splits_of(1, count, fractions), fractions)
        module.report_splits(splits_of(1, 3, fractions), fractions)
    (line,) = caplog.messages
    assert told in line
