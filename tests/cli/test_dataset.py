"""``seaglint dataset`` from an ensemble's file to a checked data set, on a calm sea of few pixels."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import re
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import seaglint as sg
from seaglint.formats.dataset.grey_pictures import read_about
from seaglint.scenario.ensemble_file import load_ensemble, parse_ensemble
from seaglint.studies.ensemble.render_ensemble import draw
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

ROOT = Path(__file__).resolve().parents[2]

ENSEMBLE = """
[ensemble]
scenes = 4
frames = 2
seed = 3
sampling = "latin_hypercube"  # one of four scenes without specks

[base.sun]
zenith_deg = 60
azimuth_deg = 90

[base.sea]
resolve_waves = false

[base.atmosphere]
source = "isothermal"
temperature_k = 288.15
extinction_per_km = 0.1

[base.sensor]
pixels = [24, 16]
height_m = 20
elevation_deg = -1
optics = { aperture_m = 0.02, f_number = 2.0 }
detector = { pitch_um = 30.0, read_noise_e = 100.0, integration_time_s = 0.001, well_capacity_e = 3e6, bit_depth = 14 }

[base.render]
oversampling = 2

[[vary]]
key = "wind.speed_m_s"
law = "uniform"
min = 2
max = 9

[[objects]]
name = "speck"
count = { law = "choice", values = [0, 2], weights = [1, 3] }
column = { law = "uniform", min = 2, max = 22 }
row = { law = "uniform", min = 6, max = 14 }
height_m = 2
shape = { kind = "point", intensity_w_sr = 30 }
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("ensemble") / "specks.toml"
    path.write_text(ENSEMBLE)
    return path


def digests(folder: Path) -> dict[str, str]:
    paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}


def test_an_ensemble_becomes_a_data_set(seaglint, file, tmp_path):
    folder = tmp_path / "D"
    answer = seaglint("dataset", file, "-o", folder, "--bits", "both", "--progress", "none")
    assert answer.code == 0, answer.err
    assert "8 images with" in answer.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["D"]
    read = pytest.importorskip("pycocotools.coco").COCO(str(folder / "annotations.json"))
    drawn = draw(load_ensemble(file))
    assert {len(scene.objects) for scene in drawn} == {0, 2}  # with negatives
    with (folder / "parameters.csv").open(newline="") as table:
        rows = list(csv.DictReader(table))
    assert [float(row["wind.speed_m_s"]) for row in rows] == [scene.parameters["wind.speed_m_s"] for scene in drawn]
    for scene in drawn:
        sensed = prepare_sensed(scene.scenario)
        for frame in range(2):
            found = sensed.images(frame)
            path = folder / "images" / f"{scene.label}_{frame:06d}.png"
            beside = folder / "images16" / path.name
            assert np.array_equal(np.asarray(Image.open(beside)), found["signal"])
            about, line = read_about(beside), sensed.layout.details["signal"]
            assert (float(about["radiance_scale"]), float(about["radiance_offset"])) == (line["radiance_scale"], line["radiance_offset"])
            about = read_about(path)
            counts = float(about["count_scale"]) * np.asarray(Image.open(path)) + float(about["count_offset"])
            assert np.abs(counts - found["signal"]).max() <= 0.5 * float(about["count_scale"]) * (1.0 + 1e-9)
            image = next(one for one in read.dataset["images"] if one["file_name"] == path.name)
            annotations = read.loadAnns(read.getAnnIds(imgIds=[image["id"]]))
            for one in annotations:
                mask = (found["object_mask"][0] >> np.uint64(one["object_id"] - 1)) & np.uint64(1)
                assert np.array_equal(read.annToMask(one), mask)
                assert one["range_m"] == found["range_m"][one["object_id"] - 1]
            assert len(annotations) == len(scene.objects)
    assert [one["name"] for one in read.dataset["categories"]] == ["point"]
    card = (folder / "README.md").read_text()
    for part in ("specks", "CC-BY-4.0. The ensemble's file names no licence", "seed 3", "| `wind.speed_m_s` |", "examples.png"):
        assert part in card
    assert seaglint("dataset", "--check", folder).code == 0
    spoilt = next((folder / "images").iterdir())
    spoilt.write_bytes(spoilt.read_bytes()[:-9])
    answer = seaglint("dataset", "--check", folder)
    assert answer.code == 2
    assert "its checksum is another" in answer.err


@pytest.mark.validation
def test_bytes_depend_neither_on_the_workers_nor_on_which_file_tells_the_ensemble(seaglint, file, tmp_path):
    # Lists of SIRST have the name of the folder.
    one, two, three = (tmp_path / name / "D" for name in ("one", "two", "three"))
    for folder in (one, two, three):
        folder.parent.mkdir()
    assert seaglint("dataset", file, "-o", one, "--format", "sirst", "--progress", "none").code == 0
    written = shutil.copy(one / "ensemble.toml", tmp_path / file.name)
    assert seaglint("dataset", written, "-o", two, "--format", "sirst", "--progress", "none", "--workers", 2).code == 0
    rows = sg.ensemble(written, tmp_path / "specks")
    assert [row["scene"] for row in rows] == [0, 1, 2, 3]
    assert sg.dataset(tmp_path / "specks", three, format="sirst") == three
    assert digests(one) == digests(two) == digests(three)


@pytest.mark.parametrize(
    ("arguments", "table", "told"),
    [
        (("--format", "voc"), "", "--format 'voc': is not one of coco, yolo, sirst, coco-video, mot, nudt-mirsdt, zarr"),
        (("--bits", "12"), "", "--bits 12: is not 8, 16 or both"),
        (("--image", "jpg"), "", "--image 'jpg': is not one of png, tiff"),
        (("--scale", "set"), "", "--scale 'set': is not one of scene, frame; give one of them, or --range for all pictures"),
        (("--clip", "60"), "", "--clip 60: is not a share of 0 to 10 %"),
        (("--range", "9", "3"), "", "--range 9 3: is no range; give two numbers, the lower one first"),
        (("--range", "3", "9", "--clip", "1"), "", "--range and --clip both set the range of 8 bits"),
        (("--bits", "16", "--scale", "frame"), "", "--scale applies to pictures of 8 bits, and --bits 16"),
        (("--format", "zarr", "--clip", "1"), "", "--clip: for pictures only, and --format 'zarr' keeps the scenes' stores"),
        ((), "[dataset]\nsplit = [0.7, 0.2, 0.2]", r"dataset.split = \[0.7, 0.2, 0.2\] adds up to 1.1"),
        ((), "[dataset]\nlicense = 'MIT'", "dataset.license is an unknown key; did you mean licence"),
        (
            (),
            "[[base.objects]]\nname = 'buoy'\npreset = 'small-boat'\neast_m = 0\nnorth_m = 500\n[dataset]\nclasses = { spek = 'x' }",
            "names no object of the ensemble; correct the name; objects are buoy, speck$",
        ),
        (
            (),
            "[dataset]\nclasses = { spek = 'x' }",
            "dataset.classes.spek names no object of the ensemble; correct the name; objects are speck",
        ),
    ],
)
def test_mistakes_are_told_in_one_line(seaglint, tmp_path, arguments, table, told):
    (tmp_path / "e.toml").write_text(f"{ENSEMBLE}\n{table}\n")
    answer = seaglint("dataset", tmp_path / "e.toml", "-o", tmp_path / "D", "--progress", "none", *arguments)
    assert answer.code == 2
    assert len(answer.err.strip().splitlines()) == 1
    assert re.search(told, answer.err), answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["e.toml"]


def test_an_output_that_is_not_empty_is_left_alone(seaglint, file, tmp_path):
    (tmp_path / "D").mkdir()
    (tmp_path / "D" / "mine").write_text("")
    answer = seaglint("dataset", file, "-o", tmp_path / "D", "--progress", "none")
    assert (answer.code, answer.err.count("\n")) == (2, 1)
    assert "is not empty" in answer.err
    assert os.listdir(tmp_path / "D") == ["mine"]


def test_a_folder_without_its_scenes_is_told_before_anything_is_written(seaglint, file, tmp_path):
    assert seaglint("ensemble", file, "-o", tmp_path / "E", "--draw-only").code == 0
    answer = seaglint("dataset", tmp_path / "E", "-o", tmp_path / "D", "--progress", "none")
    assert (answer.code, answer.err.count("\n")) == (2, 1)
    assert "4 of 4 scenes are not rendered; render the ensemble" in answer.err
    assert os.listdir(tmp_path) == ["E"]
    (tmp_path / "E" / "dataset.json").touch()
    answer = seaglint("dataset", tmp_path / "E", "-o", tmp_path / "D", "--progress", "none")
    assert "is a data set, whose scenes are gone; give the file" in answer.err


def test_the_example_draws_scenes_of_all_kinds():
    raw = tomllib.loads((ROOT / "examples" / "small-objects.toml").read_text(encoding="utf-8"))
    assert raw["ensemble"]["scenes"] == 200
    raw["ensemble"]["scenes"] = 16
    drawn = draw(parse_ensemble(raw, name="small-objects.toml"))
    off = [abs(scene.scenario.sun.azimuth_deg - scene.scenario.sensor.azimuth_deg) for scene in drawn]
    assert min(off) < 10.0  # the corridor
    assert max(off) > 30.0  # the open sea
    assert {name.rpartition("-")[0] for scene in drawn for name in (item["name"] for item in scene.objects)} == {"source", "float", "flier"}
    assert json.dumps([scene.tables for scene in drawn], default=str)
