"""Scenes of data sets that go from memory to pictures: the same files as through a store, and nothing lost by what interrupts."""

from __future__ import annotations

import hashlib
import os
import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from small_scenes import OBJECTS, scene_of, write_scene

from seaglint.base.errors import DataError
from seaglint.formats import object_labels
from seaglint.formats.dataset import dataset_writing, format_named
from seaglint.formats.dataset.dataset_writing import ConversionSettings, convert
from seaglint.formats.dataset.labelled_scene import LabelledScene
from seaglint.formats.dataset.picture_levels import PictureOptions
from seaglint.formats.dataset.scene_records import Entry
from seaglint.formats.object_labels import Labels
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.store.layout import BITS
from seaglint.store.sequence_store import Interrupted
from seaglint.studies.ensemble import dataset_scenes as module
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, EnsembleSource, ensemble_dataset
from seaglint.studies.ensemble.render_ensemble import render_ensemble

CALM: dict[str, Any] = {
    "ensemble": {"scenes": 3, "frames": 2, "seed": 7},
    "base": {
        "sensor": {
            "pixels": [24, 16],
            "elevation_deg": -1,
            "height_m": 20,
            "optics": {"aperture_m": 0.02, "f_number": 2.0},
            "detector": {"pitch_um": 30.0, "well_capacity_e": 3e6, "integration_time_s": 0.001, "read_noise_e": 100, "bit_depth": 14},
        },
        "sea": {"resolve_waves": False},
        "atmosphere": {"source": "none"},
        "render": {"oversampling": 2},
    },
    "vary": [{"key": "wind.speed_m_s", "law": "uniform", "min": 2, "max": 9}],
    "objects": [
        {
            "name": "speck",
            "count": {"law": "choice", "values": [0, 2], "weights": [0.4, 0.6]},
            "shape": {"kind": "point", "intensity_w_sr": 30},
            "height_m": 2,
            "column": {"law": "uniform", "min": 2, "max": 22},
            "row": {"law": "uniform", "min": 6, "max": 14},
        }
    ],
}


def digests(folder: Path) -> dict[str, str]:
    paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}


def made(output: Path, form: str = "coco", **more: Any) -> Path:
    return ensemble_dataset(EnsembleSource(parse_ensemble(CALM), "calm", None), output, DatasetOptions.of(form), **more)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    return digests(made(tmp_path_factory.mktemp("whole") / "D"))


@pytest.mark.parametrize("objects", [True, False])
@pytest.mark.parametrize("counts", [True, False])
@pytest.mark.parametrize("form", ["coco", "coco-video", "mot", "nudt-mirsdt", "sirst", "yolo"])
def test_scenes_in_memory_give_the_files_of_their_stores(tmp_path: Path, form: str, counts: bool, objects: bool) -> None:
    number = int(np.random.default_rng([counts, objects]).integers(1000))
    layout, frame = scene_of(number, counts=counts, objects=objects)
    store = write_scene(tmp_path / "s.zarr", number, counts=counts, objects=objects)
    held = LabelledScene.held(tmp_path / "s.toml", layout, map(frame, layout.frames))
    entry = Entry("0000", str(store), "train", {})
    for name in ("one", "other"):
        for place in format_named(form).folders:
            (tmp_path / name / place).mkdir(parents=True)
        (tmp_path / name / ".parts").mkdir(parents=True)
    settings = [ConversionSettings(str(tmp_path / name), form, PictureOptions(), {}) for name in ("one", "other")]
    with LabelledScene.stored(store) as stored:
        assert convert(entry, stored, settings[0]) == convert(entry, held, settings[1])
    assert digests(tmp_path / "one") == digests(tmp_path / "other") != {}


@pytest.mark.parametrize("block", [1, 2, 3, 100])
def test_labels_do_not_depend_on_how_many_frames_are_read_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, block: int) -> None:
    layout, frame = scene_of(5)
    labels = Labels.of(write_scene(tmp_path / "s.zarr", 5))
    monkeypatch.setattr(object_labels, "BLOCK", block)
    found = list(labels)
    assert [(label.frame, label.number) for label in found] == [(n, k) for n in layout.frames for k in range(len(OBJECTS))]
    for label in found:
        arrays = frame(label.frame)
        assert all(np.array_equal(value, arrays[name][label.number], equal_nan=True) for name, value in label.values.items())
        assert np.array_equal(label.mask, arrays["object_mask"][0] >> np.uint64(label.number) & np.uint64(1) == 1)


def test_long_scenes_go_through_a_store_to_the_same_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, whole: dict[str, str]) -> None:
    monkeypatch.setattr(module, "MOST_FRAMES", 1)
    stores: list[list[Path]] = []
    made(tmp_path / "D", progress=lambda *_: stores.append(list((tmp_path / "D.partial").rglob("*.zarr"))))
    assert digests(tmp_path / "D") == whole
    assert not any(stores)  # each is removed when its pictures are written
    render_ensemble(parse_ensemble(CALM), tmp_path / "E")
    ensemble_dataset(EnsembleSource(parse_ensemble(CALM), "calm", tmp_path / "E"), tmp_path / "F", DatasetOptions.of("coco"))
    assert digests(tmp_path / "F") == whole


def test_a_format_of_stores_has_those_of_the_ensemble(tmp_path: Path) -> None:
    folder, rendered = made(tmp_path / "D", "zarr"), render_ensemble(parse_ensemble(CALM), tmp_path / "E")
    for store in (rendered / "scenes").glob("*.zarr"):
        pixels, others = (
            {name: digest for name, digest in digests(place).items() if "/c/" in name} for place in (store, folder / "scenes" / store.name)
        )
        assert pixels == others != {}
    assert sorted(path.name for path in folder.rglob("*.zarr*")) == ["0000.zarr", "0001.zarr", "0002.zarr"]
    assert not list(dataset_writing.problems(folder))


@pytest.mark.parametrize(
    ("frames", "pixels", "objects", "short"),
    [
        (16, [96, 64], 3, True),
        (17, [96, 64], 3, False),
        (3, [640, 512], BITS, True),
        (3, [2048, 1536], BITS, False),
        (1, [4096, 3900], 0, True),
    ],
)
def test_scenes_of_few_frames_and_pixels_are_held(frames: int, pixels: list[int], objects: int, short: bool) -> None:
    items = [{"preset": "buoy", "north_m": 1000 + n} for n in range(objects)]
    scenario = parse_scenario({"sensor": {"frames": frames, "pixels": pixels}, **({"objects": items} if items else {})})
    assert module.is_short(scenario) is short


def test_a_signal_ends_a_scene_in_memory_after_a_frame(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, whole: dict[str, str]) -> None:
    drawn: list[int] = []
    prepared = module.prepared

    def stopping(*settings: Any) -> SimpleNamespace:
        run = prepared(*settings)

        def images(number: int) -> Any:
            drawn.append(number)
            if len(drawn) == 3:
                os.kill(os.getpid(), signal.SIGTERM)
            return run.images(number)

        return SimpleNamespace(layout=run.layout, images=images)

    with monkeypatch.context() as patched:
        patched.setattr(module, "prepared", stopping)
        with pytest.raises(Interrupted, match=r"stopped after 1 of 3 scenes, kept in .*; run the same again with resume"):
            made(tmp_path / "D")
    assert drawn == [0, 1, 0]
    seen: list[int] = []
    made(tmp_path / "D", resume=True, progress=lambda done, _: seen.append(done))
    assert seen == [1, 2, 3]
    assert digests(tmp_path / "D") == whole


def test_scenes_that_fail_have_tracebacks_and_the_rest_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    held = module.held_scene

    def fails_once(scenario: Any, source: Path, *settings: Any) -> LabelledScene:
        if source.stem == "0001":
            raise RuntimeError("no luck")
        return held(scenario, source, *settings)

    with monkeypatch.context() as patched:
        patched.setattr(module, "held_scene", fails_once)
        with pytest.raises(DataError, match=r"0001: RuntimeError: no luck\n1 of 3 scenes failed, their tracebacks are in .*failures"):
            made(tmp_path / "D")
    trace = tmp_path / "D.partial" / ".ensemble" / "failures" / "0001.txt"
    assert "fails_once" in trace.read_text()
    seen: list[int] = []
    assert made(tmp_path / "D", resume=True, progress=lambda done, _: seen.append(done)).is_dir()
    assert seen == [2, 3]
