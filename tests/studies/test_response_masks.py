"""Masks of responses against another route: the difference of two frames of counts without noise, with and without the object."""

from __future__ import annotations

import copy
import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.formats.object_labels import Labels
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.store.layout import unpacked
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, EnsembleSource, ensemble_dataset
from seaglint.studies.sequence.labelled_frames import frame_datasets
from seaglint.studies.sequence.object_counts import response_masks
from seaglint.studies.sequence.sensed_sequence import prepare_sensed, render

DETECTOR = {"pitch_um": 15, "fill_factor": 0.9, "integration_time_s": 0.002, "well_capacity_e": 8e6, "bit_depth": 16}
SENSOR = {
    "pixels": [40, 30],
    "azimuth_deg": 180,
    "elevation_deg": -1.2,
    "height_m": 30,
    "projection": "pinhole",
    "frames": 1,
    "optics": {"focal_length_m": 0.05, "f_number": 3.5},
    "detector": DETECTOR,
    "noise": {"temporal": False},
}
TABLES = {"sensor": SENSOR, "sea": {"resolve_waves": False}, "band": {"min_um": 3.5, "max_um": 5}, "sun": {"azimuth_deg": 0}}
BALL = {"shape": {"kind": "sphere", "radius_m": 1.2}, "temperature_k": 320, "north_m": -1200, "height_m": 2}

POINT = {"name": "point", "shape": {"kind": "point", "intensity_w_sr": 5.0}, "north_m": -1300, "height_m": 3}
LAMP = {**POINT, "name": "lamp", "shape": {"kind": "point", "intensity_w_sr": 4000.0}}
SMALL = {**BALL, "name": "small", "shape": {"kind": "sphere", "radius_m": 0.1}, "east_m": 1.5}
LARGE = {**BALL, "name": "large", "east_m": -2.0}
COLD = {**BALL, "name": "cold", "temperature_k": 265, "east_m": 5.5}
HIDDEN = {**BALL, "name": "hidden", "temperature_k": 340, "north_m": -1250, "east_m": -1.0}
FAST = {**SMALL, "name": "fast", "temperature_k": 420, "course_deg": 90, "speed_m_s": 900, "east_m": -1.0}

CASES = {
    "a point": [POINT],
    "a point that saturates": [LAMP],
    "a small body": [SMALL],
    "a large body": [LARGE],
    "a cold body": [COLD],
    "a body hidden in part": [HIDDEN, LARGE],
    "a streak": [FAST],
    "several": [POINT, SMALL, LARGE, COLD],
}


def scene(objects: list[dict], **changes) -> object:
    tables = copy.deepcopy(TABLES)
    for key, value in changes.items():
        tables[key] = {**tables.get(key, {}), **value}
    return parse_scenario({**tables, **({"objects": objects} if objects else {})})


def counts(objects: list[dict], **changes) -> dict[str, np.ndarray]:
    return prepare_sensed(scene(objects, **changes)).images(0)


@pytest.mark.parametrize("share", [0.05, 0.3])
@pytest.mark.parametrize("case", CASES)
def test_masks_are_thresholds_of_the_difference_that_the_object_makes(case, share):
    objects, render_table = CASES[case], {"mask_share": share}
    whole = counts(objects, render=render_table)
    masks, touched = (list(unpacked(whole[name], len(objects))) for name in ("response_mask", "object_mask"))
    # An object in front of another one has the sea behind it as its background, not the other one: it is not compared.
    compared = objects[:1] if case == "a body hidden in part" else objects
    for n, _ in enumerate(compared):
        others = counts([*objects[:n], *objects[n + 1 :]], render=render_table)
        change = np.abs(whole["signal"].astype(np.int64) - others["signal"].astype(np.int64))
        peak = int(change.max())
        assert peak > 200
        if case == "a point that saturates":
            assert int((whole["signal"] == whole["signal"].max()).sum()) > 1
        # counts are whole numbers: pixels within two of the threshold are undecided
        inside, outside = change > share * peak + 2, change < share * peak - 2
        assert masks[n][inside].all()
        # pixels that a body fills belong to it, whatever its contrast
        assert not (masks[n] & outside & ~touched[n]).any()
        assert int((~inside & ~outside).sum()) <= 2
        rows, columns = np.nonzero(masks[n])
        assert whole["response_pixels"][n] == rows.size
        box = [whole[f"response_{side}_px"][n] for side in ("left", "top", "width", "height")]
        assert box == [columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1]


def test_a_point_has_more_pixels_after_the_optics_and_a_streak_is_long():
    whole = counts([POINT])
    (touched,), (mask,) = unpacked(whole["object_mask"], 1), unpacked(whole["response_mask"], 1)
    assert touched.sum() == 1
    assert mask.sum() >= 4
    streak = counts([FAST])
    assert streak["response_width_px"][0] > 3 + streak["motion_px"][0] * 0.8 > 5


def test_large_bodies_have_all_that_they_fill_whatever_is_hottest():
    hot = {"name": "ship", "preset": "fishing-vessel", "north_m": -1400, "heading_deg": 30}
    whole = counts([hot], render={"mask_share": 0.9})
    (touched,), (mask,) = unpacked(whole["object_mask"], 1), unpacked(whole["response_mask"], 1)
    assert touched.sum() > 100
    assert (touched & ~mask).sum() < 0.35 * touched.sum()  # its border alone, of pixels less than half full
    assert not (mask & ~touched).sum() > 0.2 * touched.sum()


def test_a_mask_across_the_seam_of_a_panorama_continues():
    sensor = {
        **{key: value for key, value in SENSOR.items() if key not in ("optics", "detector", "projection")},
        "pixels": [360, 12],
        "fov_deg": [360, 12],
        "azimuth_deg": 0,
    }
    detector = {**DETECTOR, "pitch_um": 30}
    optics = {"focal_length_m": 30e-6 / np.radians(1.0), "f_number": 1.0}
    item = {**POINT, "north_m": -300, "east_m": 0.0, "shape": {"kind": "point", "intensity_w_sr": 500.0}}
    whole = counts([item], sensor={**sensor, "optics": optics, "detector": detector, "projection": "equal-angle"})
    (mask,) = unpacked(whole["response_mask"], 1)
    assert mask.any()
    left, width = whole["response_left_px"][0], whole["response_width_px"][0]
    columns = np.flatnonzero(mask.any(axis=0))
    assert set((int(left) + np.arange(int(width))) % 360) >= set(columns.tolist())
    assert width <= 6


def test_stores_frames_and_labels_have_both_masks_and_a_scene_without_optics_one(tmp_path):
    store = render(scene([POINT, SMALL]), tmp_path / "run.zarr")
    (frame,) = frame_datasets(scene([POINT, SMALL]))
    for kind, name in (("response", "response_masks"), ("geometric", "masks")):
        labels = Labels.of(store, kind)
        assert labels.masks == kind
        for label in labels:
            assert np.array_equal(label.mask, frame[name].to_numpy()[label.number])
            columns = np.flatnonzero(label.mask.any(axis=0))
            assert (label.side("left"), label.side("width")) == (columns.min(), np.ptp(columns) + 1)
    with pytest.raises(DataError, match=r"^masks = 'outline': is not one of response, geometric"):
        Labels.of(store, "outline")
    plain = {key: value for key, value in SENSOR.items() if key not in ("optics", "detector", "noise")} | {"fov_deg": [0.7, 0.5]}
    bare = render(parse_scenario({**TABLES, "sensor": plain, "objects": [POINT]}), tmp_path / "plain.zarr")
    assert Labels.of(bare).masks == "geometric"


def test_data_sets_have_the_chosen_masks(tmp_path, caplog):
    """Boxes and masks of a data set are those of the response, or geometric where requested or without optics."""
    table = {"ensemble": {"scenes": 3}, "base": {**copy.deepcopy(TABLES), "objects": [POINT, LARGE]}}
    sizes: dict[str, list[int]] = {}
    for masks in ("response", "geometric"):
        source = EnsembleSource(parse_ensemble(table), "few", None)
        folder = ensemble_dataset(source, tmp_path / masks, DatasetOptions.of("sirst", masks=masks))
        with Path(folder / "truth.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        sizes[masks] = [int(row["mask_pixels"]) for row in rows]
        if masks == "response":
            assert sizes[masks] == [float(row["response_pixels"]) for row in rows]
    assert sizes["geometric"][::2] == [1, 1, 1]
    assert min(sizes["response"][::2]) >= 4
    assert "geometric masks" not in caplog.text
    bare = copy.deepcopy(table)
    sensor = bare["base"]["sensor"]
    for key in ("optics", "detector", "noise"):
        del sensor[key]
    sensor["fov_deg"] = [0.7, 0.5]
    with caplog.at_level("WARNING", "seaglint"):
        ensemble_dataset(EnsembleSource(parse_ensemble(bare), "bare", None), tmp_path / "bare", DatasetOptions.of("sirst"))
    assert caplog.text.count("3 of 3 scenes with objects have geometric masks") == 1


def test_an_object_before_saturated_pixels_has_the_pixels_that_it_touches():
    """Its brightest pixel changes by nothing; a ring around it is no mask."""
    added = np.array([[0.0, 3.0, 0.0], [3.0, 0.0, 3.0], [0.0, 3.0, 0.0]])
    light = np.array([[1.0, 5.0, 1.0], [5.0, 9.0, 5.0], [1.0, 5.0, 1.0]])
    grid = np.arange(3)
    touched, full = np.zeros((3, 3), bool), np.zeros((3, 3), bool)
    touched[1, 1] = True
    change = SimpleNamespace(added=added, light=light, rows=grid[:, None], columns=grid[None, :], width=3)
    (mask,) = response_masks([change], [touched], [full], 0.05)
    assert np.array_equal(mask, touched)
    change.added = light
    (mask,) = response_masks([change], [touched], [full], 0.05)
    assert mask.all()
