"""Data sets of sequences as public programs read them: one number for an object, frames and pixels from where the layout counts."""

from __future__ import annotations

import configparser
import hashlib
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from public_loaders import CocoVid, deep_pro, dtum, lma_former
from small_scenes import COLUMNS, FRAMES, ROWS, entries, masks

from seaglint.base.errors import DataError
from seaglint.formats.dataset import dataset_writing
from seaglint.formats.dataset.grey_pictures import decoded
from seaglint.formats.dataset.scene_records import SPLITS, DatasetFrame, DatasetObject, DatasetScene, Piece
from seaglint.formats.dataset.sequence_layouts import _centroids, _mot_line
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.records.ensemble_tables import Dataset
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, DatasetPlan, EnsembleSource, ensemble_dataset, make_dataset

PLAN = DatasetPlan("small", 3, Dataset(classes={"speck": "target"}), "[ensemble]\nscenes = 4\n")
SCENES = 4
SPLIT = {0: "train", 1: "val", 2: "test", 3: "train"}
FORMS = ("coco-video", "mot", "nudt-mirsdt")


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    return entries(tmp_path_factory.mktemp("stores"), SCENES, SPLITS, counts=True)


@pytest.fixture(scope="module")
def sets(stores, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sets")
    return {form: make_dataset(folder / form, PLAN, DatasetOptions.of(form), lambda _: stores) for form in FORMS}


def wanted(scene: int, frame: int) -> list[np.ndarray]:
    """Masks of the objects of a frame; the last scene has none."""
    return masks(scene, frame) if scene < SCENES - 1 else []


def digests(folder: Path) -> dict[str, str]:
    paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}


@pytest.mark.parametrize("form", FORMS)
def test_the_same_scenes_give_the_same_bytes(stores, sets, tmp_path, form):
    again = make_dataset(tmp_path / "D", PLAN, DatasetOptions.of(form), lambda _: stores)
    assert digests(again) == digests(sets[form])
    assert list(dataset_writing.problems(again)) == []


def test_mot_counts_frames_objects_and_pixels_from_one(sets):
    folder = sets["mot"]
    for scene, split in SPLIT.items():
        sequence = folder / split / f"{scene:04d}"
        info = configparser.ConfigParser()
        info.read(sequence / "seqinfo.ini")
        about = dict(info["Sequence"])
        assert about == {
            "name": f"{scene:04d}",
            "imdir": "img1",
            "framerate": "30",
            "seqlength": str(FRAMES),
            "imwidth": str(COLUMNS),
            "imheight": str(ROWS),
            "imext": ".png",
        }
        assert sorted(path.name for path in (sequence / about["imdir"]).iterdir()) == [f"{n:06d}.png" for n in range(1, FRAMES + 1)]
        assert (sequence / "gt" / "labels.txt").read_text().split() == ["small-boat", "target"]
        rows = [line.split(",") for line in (sequence / "gt" / "gt.txt").read_text().splitlines()]
        found = {(int(row[0]), int(row[1])): [float(value) for value in row[2:]] for row in rows}
        there = {(frame + 1, n): mask for frame in range(FRAMES) for n, mask in enumerate(wanted(scene, frame), 1) if mask.any()}
        assert set(found) == set(there)
        assert len(rows) == len(found)
        for (frame, number), (left, top, width, height, considered, kind, visible) in found.items():
            y, x = np.nonzero(there[frame, number])
            assert (left, top, width, height) == (x.min() + 1, y.min() + 1, np.ptp(x) + 1, np.ptp(y) + 1)
            assert (considered, kind, visible) == (1, {1: 2, 2: 1}[number], 1.0)
    assert (folder / "seqmaps" / "train.txt").read_text() == "name\n0000\n0003\n"


def test_motmetrics_reads_the_boxes(sets):
    metrics = pytest.importorskip("motmetrics", reason="motmetrics is not installed")
    table = metrics.io.loadtxt(str(sets["mot"] / "train" / "0000" / "gt" / "gt.txt"), fmt="mot16", min_confidence=1)
    assert len(table) == 2 * FRAMES - 1
    y, x = np.nonzero(masks(0, 1)[1])
    row = table.loc[(2, 2)]
    assert (row["X"], row["Y"], row["Width"], row["Height"]) == (x.min(), y.min(), np.ptp(x) + 1, np.ptp(y) + 1)  # it counts from 0
    assert row["Visibility"] == 1.0


def scores_of_truth(trackeval, dataset) -> dict[str, float]:
    """Scores of a tracker that gives the truth."""
    config = trackeval.Evaluator.get_default_eval_config()
    config |= {"PRINT_CONFIG": False, "PRINT_RESULTS": False, "OUTPUT_SUMMARY": False, "OUTPUT_DETAILED": False, "PLOT_CURVES": False}
    chosen = [trackeval.metrics.HOTA({"PRINT_CONFIG": False}), trackeval.metrics.CLEAR({"PRINT_CONFIG": False})]
    results, _ = trackeval.Evaluator(config | {"LOG_ON_ERROR": None}).evaluate([dataset], chosen)
    (by_tracker,) = results.values()
    combined = by_tracker["truth"]["COMBINED_SEQ"]
    one = combined.get("pedestrian") or combined["target"]
    return {"HOTA": float(np.mean(one["HOTA"]["HOTA"])), "MOTA": one["CLEAR"]["MOTA"], "objects": one["CLEAR"]["CLR_TP"]}


@pytest.mark.parametrize("split", ["train", "test"])
def test_trackeval_scores_the_truth_of_mot_as_perfect(sets, tmp_path, split):
    trackeval = pytest.importorskip("trackeval", reason="TrackEval is not installed")
    folder = sets["mot"]
    data = tmp_path / "truth" / "data"
    data.mkdir(parents=True)
    scenes = [f"{scene:04d}" for scene, name in SPLIT.items() if name == split]
    for scene in scenes:
        rows = [line.split(",")[:6] for line in (folder / split / scene / "gt" / "gt.txt").read_text().splitlines()]
        (data / f"{scene}.txt").write_text("".join(f"{','.join(row)},1,-1,-1,-1\n" for row in rows))
    config = {
        "GT_FOLDER": str(folder / split),
        "SKIP_SPLIT_FOL": True,
        "SEQMAP_FILE": str(folder / "seqmaps" / f"{split}.txt"),
        "TRACKERS_FOLDER": str(tmp_path),
        "TRACKERS_TO_EVAL": ["truth"],
        "DO_PREPROC": False,  # which is for the classes of pedestrians
        "PRINT_CONFIG": False,
    }
    dataset = trackeval.datasets.MotChallenge2DBox(config)
    assert dataset.seq_lengths == dict.fromkeys(scenes, FRAMES)
    seen = sum(mask.any() for scene in scenes for frame in range(FRAMES) for mask in wanted(int(scene), frame))
    assert scores_of_truth(trackeval, dataset) == {"HOTA": 1.0, "MOTA": 1.0, "objects": seen}


@pytest.mark.parametrize("snr", [None, 3.0, 0.5])
def test_centroids_of_nudt_mirsdt_are_of_objects_that_are_not_ignored(snr):
    values = {"visible_share": 1.0, "row_px": 4.2, "column_px": 2.6}
    row = DatasetObject(0, 0, values, None, None, snr, (Piece((2, 3, 2, 3), 6, ""),))
    frames = (DatasetFrame("a", 0, 0.0),)
    part = DatasetScene("0000", "train", 1, (ROWS, COLUMNS), 30.0, ("ship",), ("ship",), frames, (row,), {}, "geometric", 1.0)
    assert np.argwhere(_centroids(part, 0)).tolist() == ([] if snr == 0.5 else [[4, 3]])


@pytest.mark.parametrize(("snr", "considered"), [(None, 1), (3.0, 1), (0.5, 0)])
def test_an_object_over_the_seam_is_once_in_a_frame_of_mot(snr, considered):
    pieces = (Piece((0, 4, 2, 3), 6, ""), Piece((27, 4, 5, 3), 14, ""))
    row = DatasetObject(1, 0, {"visible_share": 0.5}, None, None, snr, pieces)
    frames = (DatasetFrame("a", 0, 0.0),)
    part = DatasetScene("0000", "train", 1, (ROWS, COLUMNS), 30.0, ("ship",), ("ship",), frames, (row,), {}, "geometric", 1.0)
    assert _mot_line(part, row, {"ship": 3}) == f"2,1,28,5,5,3,{considered},3,0.35\n"


def test_coco_video_has_the_frames_of_videos_in_order(sets):
    for split in SPLITS:
        read = CocoVid(sets["coco-video"] / f"annotations_{split}.json")
        assert [video["name"] for video in read.videos.values()] == [f"{scene:04d}" for scene, name in SPLIT.items() if name == split]
        for number, video in read.videos.items():
            scene, frames = int(video["name"]), read.frames(number)
            assert (video["width"], video["height"], video["fps"], video["length"]) == (COLUMNS, ROWS, 30.0, FRAMES)
            assert [image["frame"] for image in frames] == list(range(FRAMES))
            tracks: dict[int, set[int]] = {}
            for frame, image in enumerate(frames):
                assert (sets["coco-video"] / "images" / image["file_name"]).is_file()
                there = {n: mask for n, mask in enumerate(wanted(scene, frame), 1) if mask.any()}
                found = read.of_image[image["id"]]
                assert {one["object_id"] for one in found} == set(there)
                for one in found:
                    assert np.array_equal(decoded(one["segmentation"]["counts"], (ROWS, COLUMNS)), there[one["object_id"]])
                    assert one["instance_id"] == one["track_id"]
                    tracks.setdefault(one["object_id"], set()).add(one["instance_id"])
            # one number for an object through its sequence, and another one for each object
            assert all(len(numbers) == 1 for numbers in tracks.values())
            assert sorted(read.instances[number]) == sorted(set().union(*tracks.values())) if tracks else not read.instances[number]


def test_pycocotools_reads_coco_video(sets):
    read = pytest.importorskip("pycocotools.coco").COCO(str(sets["coco-video"] / "annotations.json"))
    assert len(read.getImgIds()) == SCENES * FRAMES
    assert sum(read.annToMask(one).sum() for one in read.loadAnns(read.getAnnIds())) == sum(
        mask.sum() for scene in range(SCENES) for frame in range(FRAMES) for mask in wanted(scene, frame)
    )


def test_trackeval_scores_the_truth_of_tao_as_perfect(sets, tmp_path):
    trackeval = pytest.importorskip("trackeval", reason="TrackEval is not installed")
    truth, data = tmp_path / "gt", tmp_path / "trackers" / "truth" / "data"
    truth.mkdir()
    data.mkdir(parents=True)
    shutil.copy(sets["coco-video"] / "annotations.json", truth / "all.json")
    given = json.loads((truth / "all.json").read_text())["annotations"]
    names = ("image_id", "video_id", "category_id", "track_id", "bbox")
    (data / "all.json").write_text(json.dumps([{name: one[name] for name in names} | {"score": 1.0} for one in given]))
    config = {"GT_FOLDER": str(truth), "TRACKERS_FOLDER": str(tmp_path / "trackers"), "TRACKERS_TO_EVAL": ["truth"], "PRINT_CONFIG": False}
    scores = scores_of_truth(trackeval, trackeval.datasets.TAO(config))
    assert scores == {"HOTA": 1.0, "MOTA": 1.0, "objects": (SCENES - 1) * FRAMES}  # specks are in all frames


@pytest.mark.parametrize("split", ["train", "test"])
def test_nudt_mirsdt_is_read_by_the_loaders_of_dtum(sets, split):
    folder = sets["nudt-mirsdt"]
    scenes = [scene for scene, name in SPLIT.items() if name == split]
    read = dtum(folder, split)
    assert [line for line, *_ in read] == [f"{scene:04d}/Mix/{frame + 1:05d}.mat" for scene in scenes for frame in range(FRAMES)]
    for line, stack, mask, centroids in read:
        scene, frame = int(line[:4]), int(line[9:14]) - 1
        pictures = [np.asarray(Image.open(folder / line[:4] / "images" / f"{n + 1:05d}.png")) for n in range(FRAMES)]
        assert stack.shape == (5, ROWS, COLUMNS)
        assert all(np.array_equal(stack[-1 - back], pictures[max(frame - back, 0)]) for back in range(5))
        there = [one for one in wanted(scene, frame) if one.any()]
        assert np.array_equal(mask, np.logical_or.reduce([np.zeros((ROWS, COLUMNS), bool), *there]).astype(np.float32))
        assert centroids.sum() == len(there)
        for one in there:
            y, x = np.nonzero(one)
            assert centroids[round(y.mean()), round(x.mean() + 0.25)] == 1.0  # the truth of these scenes is a quarter to the right


def test_nudt_mirsdt_is_read_by_the_loaders_of_deep_pro(sets):
    for split in ("train", "test"):
        read = deep_pro(sets["nudt-mirsdt"], split)
        assert list(read) == [f"{scene:04d}" for scene, name in SPLIT.items() if name == split]
        for name, (pictures, mask, centroids) in read.items():
            assert pictures.shape == mask.shape == centroids.shape == (FRAMES, ROWS, COLUMNS)
            assert mask.sum() == 255 * sum(one.sum() for frame in range(FRAMES) for one in wanted(int(name), frame))


def test_links_make_the_folders_of_lma_former(sets, tmp_path):
    """As the guide says: a folder of pictures and one of masks, each with a folder for a sequence."""
    folder = sets["nudt-mirsdt"]
    for kind in ("images", "masks"):
        (tmp_path / kind).mkdir()
        for sequence in sorted(folder.glob(f"*/{kind}")):
            (tmp_path / kind / sequence.parent.name).symlink_to(sequence)
    names = list(dict.fromkeys(line.split("/")[0] for line in (folder / "train.txt").read_text().splitlines()))
    read = lma_former(tmp_path / "images", tmp_path / "masks", names)
    assert {name: len(frames) for name, frames in read.items()} == {"0000": FRAMES, "0003": FRAMES}
    assert all(picture.shape == (*mask.shape, 3) for frames in read.values() for picture, mask in frames)


def spoil_box(folder):
    path = folder / "train" / "0000" / "gt" / "gt.txt"
    path.write_text(path.read_text().replace("1,2,21,", "1,2,31,", 1))


def spoil_line(folder):
    path = folder / "train" / "0000" / "gt" / "gt.txt"
    path.write_text(path.read_text() + "1,2,3\n")


def spoil_info(folder):
    path = folder / "val" / "0001" / "seqinfo.ini"
    path.write_text(path.read_text().replace(f"seqLength={FRAMES}", "seqLength=9"))


def spoil_map(folder):
    (folder / "seqmaps" / "test.txt").write_text("name\n0001\n")


def spoil_stack(folder):
    shutil.copy(folder / "0000" / "Mix" / "00002.mat", folder / "0000" / "Mix" / "00001.mat")


def cut_stack(folder):
    path = folder / "0000" / "Mix" / "00001.mat"
    path.write_bytes(path.read_bytes()[:200])


def spoil_list(folder):
    (folder / "train.txt").write_text("0000/Mix/00001.mat\n")


def spoil_mask(folder):
    path = folder / "0000" / "masks" / "00001.png"
    Image.fromarray(np.roll(np.asarray(Image.open(path)), 9, axis=0)).save(path)


@pytest.mark.parametrize(
    ("form", "spoil", "told"),
    [
        ("mot", spoil_box, "is no box within the picture"),
        ("mot", spoil_line, "is not nine numbers"),
        ("mot", spoil_info, "does not state the frames and pixels"),
        ("mot", spoil_map, "does not list the sequences of its split"),
        ("nudt-mirsdt", spoil_stack, "is not 5 frames that end with its picture"),
        ("nudt-mirsdt", cut_stack, "cannot be read as a stack"),
        ("nudt-mirsdt", spoil_list, "does not list the frames of its split"),
        ("nudt-mirsdt", spoil_mask, "has nothing in the box"),
    ],
)
def test_what_is_spoilt_is_found(sets, tmp_path, form, spoil, told):
    folder = shutil.copytree(sets[form], tmp_path / "D")
    spoil(folder)
    dataset_writing.write_sums(folder)
    assert any(told in line for line in dataset_writing.problems(folder))


@pytest.mark.parametrize("form", FORMS)
def test_scenes_of_one_frame_are_refused_before_anything_is_written(tmp_path, form):
    raw = {
        "ensemble": {"scenes": 2, "frames": 1},
        "base": {"sensor": {"pixels": [16, 8]}, "sea": {"resolve_waves": False}, "atmosphere": {"source": "none"}},
        "vary": [{"key": "wind.speed_m_s", "law": "uniform", "min": 2, "max": 9}],
    }
    with pytest.raises(DataError, match=f"format = '{form}' is for sequences, and 2 of 2 scenes have one frame") as error:
        ensemble_dataset(EnsembleSource(parse_ensemble(raw), "one", None), tmp_path / "D", DatasetOptions.of(form))
    assert "\n" not in str(error.value)
    assert not any(tmp_path.iterdir())
