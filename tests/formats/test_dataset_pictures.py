"""Pictures of data sets in the hands of common readers: radiance within half a step, clipped pixels counted, both depths."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from public_loaders import basic_irstd, dnanet
from small_scenes import COLUMNS, FRAMES, LINE, ROWS, entries, masks, values

from seaglint.base.errors import DataError
from seaglint.formats.dataset import dataset_writing
from seaglint.formats.dataset.grey_pictures import read_about
from seaglint.formats.dataset.picture_levels import FrameRange, PictureLevels, PictureOptions
from seaglint.formats.dataset.scene_records import SPLITS
from seaglint.scenario.records.ensemble_tables import Dataset
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, DatasetPlan, make_dataset

PLAN = DatasetPlan("small", 3, Dataset(), "[ensemble]\nscenes = 4\n")
SCENES = 4
WIDE = 1.0 + 1e-9  # half a step and the rounding of the line from level to radiance


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stores")
    return {counts: entries(folder / str(counts), SCENES, SPLITS, counts=counts) for counts in (True, False)}


def made(stores, output: Path, form: str = "coco", counts: bool = True, **options) -> Path:
    return make_dataset(output, PLAN, DatasetOptions.of(form, **options), lambda _: stores[counts])


def name_of(scene: int, frame: int) -> str:
    return f"{scene:04d}_{frame:06d}"


def radiance_of(scene: int, frame: int, counts: bool) -> np.ndarray:
    given = np.asarray(values(scene, frame, counts=counts), np.float64)
    return given * LINE[0] + LINE[1] if counts else given


def with_opencv(path):
    return pytest.importorskip("cv2", reason="OpenCV is not installed").imread(str(path))[..., 0]


def with_pillow(path):
    return np.asarray(Image.open(path).convert("L"))


def in_colours(path):
    return np.asarray(Image.open(path).convert("RGB"))[..., 2]


def as_tensor(path):
    """Levels of 0 to 1 as ``torchvision.transforms.functional.to_tensor`` makes them: bytes over 255, channels first."""
    image = Image.open(path)
    assert image.mode == "L"  # all other modes that it knows are not divided
    tensor = (np.frombuffer(image.tobytes(), np.uint8).reshape(image.size[1], image.size[0], 1) / np.float32(255)).transpose(2, 0, 1)
    return tensor[0] * 255.0


@pytest.mark.parametrize("read", [with_opencv, with_pillow, in_colours, as_tensor])
@pytest.mark.parametrize("counts", [True, False])
def test_common_readers_find_the_radiance_to_half_a_step(stores, tmp_path, counts, read):
    folder = made(stores, tmp_path / "D", counts=counts)
    document = json.loads((folder / "annotations.json").read_text())
    for image in document["images"]:
        levels = np.asarray(read(folder / "images" / image["file_name"]), np.float64)
        radiance = image["radiance_scale"] * levels + image["radiance_offset"]
        error = np.abs(radiance - radiance_of(int(image["scene"]), image["frame"], counts)).max()
        assert error <= image["radiance_error"] * WIDE
        assert image["radiance_error"] == 0.5 * image["radiance_scale"]
        assert (image["bits"], image["radiance_units"], image["clipped_px"]) == (8, "W m-2 sr-1", 0)
    assert "to half a step" in (folder / "README.md").read_text()
    assert "No pixel is clipped" in (folder / "README.md").read_text()


def test_opencv_keeps_the_upper_byte_of_16_bits(stores, tmp_path):
    """The reason for 8 bits by default."""
    folder = made(stores, tmp_path / "D", bits=16)
    path = folder / "images" / f"{name_of(0, 0)}.png"
    given = values(0, 0, counts=True)
    # rounded or cut: at most 20 levels where the counts have some 250
    assert np.abs(with_opencv(path).astype(int) - (given >> 8)).max() <= 1
    assert np.ptp(with_opencv(path)) <= 2 < np.ptp(given)


@pytest.mark.parametrize("form", ["coco", "yolo", "sirst", "coco-video", "mot", "nudt-mirsdt"])
def test_both_depths_have_one_name_each(stores, tmp_path, form):
    folder = made(stores, tmp_path / "D", form, bits="both")
    options = DatasetOptions.of(form, "both")
    assert options.pictures.bits == (8, 16)
    about = dataset_writing.read_about(folder)
    chosen = dataset_writing.format_named(form)
    for scene, one in about["scenes"].items():
        for frame, name in enumerate(one["images"]):
            for beside, kind in zip(dataset_writing.BESIDE, (np.uint8, np.uint16), strict=True):
                path = chosen.image_path(folder, one["split"], name, "png", beside)
                levels, text = np.asarray(Image.open(path)), read_about(path)
                assert levels.dtype == kind
                radiance = float(text["radiance_scale"]) * levels + float(text["radiance_offset"])
                assert np.abs(radiance - radiance_of(int(scene), frame, True)).max() <= float(text["radiance_error"]) * WIDE
        assert (one["bits"], one["count_scale_16"], one["radiance_scale_16"]) == (8, 1.0, LINE[0])
    card = (folder / "README.md").read_text()
    assert "beside them 16 bits" in card
    assert f"--format {form} --bits both --min-snr 1`" in card
    chosen.image_path(folder, one["split"], name, "png", "16").unlink()
    assert any("is missing" in line for line in dataset_writing.problems(folder))


def test_coco_names_the_second_picture(stores, tmp_path):
    folder = made(stores, tmp_path / "D", bits="both")
    for image in json.loads((folder / "annotations.json").read_text())["images"]:
        levels = np.asarray(Image.open(folder / "images16" / image["file_name_16"]))
        assert np.array_equal(levels, values(int(image["scene"]), image["frame"], counts=True))
        assert (image["radiance_scale_16"], image["radiance_offset_16"]) == LINE


def test_frames_have_a_range_each_where_requested(stores, tmp_path):
    folder = made(stores, tmp_path / "D", counts=False, scale="frame")
    lines = set()
    for frame in range(FRAMES):
        path = folder / "images" / f"{name_of(1, frame)}.png"
        levels, text = np.asarray(Image.open(path)), read_about(path)
        assert (levels.min(), levels.max()) == (0, 255)
        lines.add(float(text["radiance_scale"]))
        radiance = float(text["radiance_scale"]) * levels + float(text["radiance_offset"])
        assert np.abs(radiance - radiance_of(1, frame, False)).max() <= float(text["radiance_error"]) * WIDE
    assert len(lines) == FRAMES
    with (folder / "parameters.csv").open(newline="") as file:
        assert "radiance_scale" not in next(csv.DictReader(file))  # frames of a scene share none
    assert "those of the picture" in (folder / "README.md").read_text()


@pytest.mark.parametrize("counts", [True, False])
def test_one_range_for_all_clips_and_counts(stores, tmp_path, counts, caplog):
    low, high = 4980.0, 5240.0  # the noise has an rms of 20 around 5000: a sixth is below
    ends = (low, high) if counts else (low * LINE[0] + LINE[1], high * LINE[0] + LINE[1])
    folder = made(stores, tmp_path / "D", counts=counts, limits=ends)
    document = json.loads((folder / "annotations.json").read_text())
    assert len({(image["radiance_scale"], image["radiance_offset"]) for image in document["images"]}) == 1
    total = 0
    for image in document["images"]:
        levels = np.asarray(Image.open(folder / "images" / image["file_name"]))
        given = radiance_of(int(image["scene"]), image["frame"], counts)
        error = np.abs(image["radiance_scale"] * levels + image["radiance_offset"] - given)
        clipped = error > image["radiance_error"] * WIDE
        assert image["clipped_px"] == clipped.sum() > 0
        assert set(np.unique(levels[clipped])) <= {0, 255}
        total += int(clipped.sum())
    pixels = SCENES * FRAMES * ROWS * COLUMNS
    about = dataset_writing.read_about(folder)
    assert (about["clipped_px"], about["pixels"]) == (total, pixels)
    card = (folder / "README.md").read_text()
    assert f"{total} of {pixels} pixels are beyond the range of 8 bits" in card
    assert "are the same for all pictures" in card
    assert f"--range {ends[0]!r} {ends[1]!r} --min-snr 1`" in card
    assert f"{total} of {pixels} pixels" in caplog.text
    with (folder / "parameters.csv").open(newline="") as file:
        assert sum(int(row["clipped_px"]) for row in csv.DictReader(file)) == total


def test_a_share_of_pixels_is_clipped_at_each_end_at_most(stores, tmp_path):
    whole, clipped = made(stores, tmp_path / "D"), made(stores, tmp_path / "E", counts=False, clip=1.0)
    assert dataset_writing.read_about(whole)["clipped_px"] == 0
    for image in json.loads((clipped / "annotations.json").read_text())["images"]:
        assert image["clipped_px"] <= 2 * 0.01 * ROWS * COLUMNS
    assert dataset_writing.read_about(clipped)["clipped_px"] > 0


def test_labels_that_steps_hide_are_reported(stores, tmp_path, caplog):
    made(stores, tmp_path / "D")
    assert "below one step" not in caplog.text
    # a step of 235 counts; specks have 150, boats 90
    folder = made(stores, tmp_path / "E", limits=(0, 60000))
    seen = (SCENES - 1) * (2 * FRAMES - 1)
    assert dataset_writing.read_about(folder)["labels_below_a_step"] == seen
    assert f"{seen} labels with a signal-to-noise ratio above 1 have a contrast below one step" in caplog.text


def test_a_picture_of_one_value_but_a_pixel_keeps_its_range():
    picture = np.full((20, 20), 3.0)
    picture[4, 5] = 1e4  # glint
    range_ = FrameRange.of(picture, 1.0)
    (levels,) = PictureOptions.of(clip=1.0).levels([range_], None)[0]
    assert levels.of(picture)[1] == 0
    assert levels.of(picture)[0][4, 5] == 255


def test_values_that_are_no_numbers_are_refused():
    with pytest.raises(DataError, match="no numbers"):
        PictureLevels.of_radiance(0.0, 1.0, 8).of(np.array([[0.5, np.nan]]))


@pytest.mark.parametrize(
    "options",
    [
        {"bits": 12},
        {"bits": "eight"},
        {"scale": "set"},
        {"clip": -1.0},
        {"clip": float("nan")},
        {"limits": (3.0, 3.0)},
        {"limits": (1.0, float("inf"))},
        {"limits": (1.0,)},
        {"limits": (1.0, 2.0), "scale": "frame"},
        {"bits": 16, "clip": 1.0},
    ],
    ids=str,
)
def test_options_that_there_are_not_are_one_line(options):
    with pytest.raises(DataError) as error:
        PictureOptions.of(**options)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("split", ["train", "test"])
@pytest.mark.parametrize("image_bits", [8, 16])
def test_sirst_is_read_by_the_loaders_of_basic_irstd(stores, tmp_path, split, image_bits):
    folder = made(stores, tmp_path / "Specks-SIRST", "sirst", bits=image_bits)
    read = basic_irstd(tmp_path, folder.name, split)
    scenes = {"train": (0, 3), "test": (2,)}[split]
    assert [name for name, _, _ in read] == [name_of(scene, frame) for scene in scenes for frame in range(FRAMES)]
    for name, picture, mask in read:
        scene, frame = (int(part) for part in name.split("_"))
        wanted = np.logical_or.reduce(masks(scene, frame)) if scene < SCENES - 1 else np.zeros((ROWS, COLUMNS), bool)
        assert np.array_equal(mask, wanted.astype(np.float32))
        assert picture.shape == mask.shape
        assert 0.5 < picture.std() < 2.0  # normalised by the mean deviation of all pictures
        if wanted.any():
            assert picture[wanted].mean() > picture[~wanted].mean()


def test_sirst_is_read_by_the_loader_of_dnanet(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "sirst")
    for split, scenes in (("train", (0, 3)), ("test", (2,))):
        read = dnanet(folder, "img_idx", split)
        assert [name for name, _, _ in read] == [name_of(scene, frame) for scene in scenes for frame in range(FRAMES)]
        assert all(picture.dtype == np.uint8 and np.isin(mask, (0.0, 1.0)).all() for _, picture, mask in read)


def test_lists_of_two_names_that_differ_are_found(stores, tmp_path):
    folder = made(stores, tmp_path / "D", "sirst")
    path = folder / "img_idx" / "train_D.txt"
    path.write_text(path.read_text().replace(name_of(0, 1), name_of(0, 2)))
    dataset_writing.write_sums(folder)
    assert any("are not one list each with the same names" in line for line in dataset_writing.problems(folder))
