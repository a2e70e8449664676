"""Frames, scalings, probes, regions and thresholds, without a browser."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import zarr

from seaglint.analysis import AnalysisOptions, analyze
from seaglint.base.errors import DataError
from seaglint.formats.recording import open_recording
from seaglint.optics.band import apparent_temperature
from seaglint.store.location import partial_path, place_of
from seaglint.store.sequence_store import write_sequence
from seaglint.store.shards import Shards
from seaglint.store.stored_images import grid_of, stored_band
from seaglint.viewer.dragged_region import exceedances, quick, whole
from seaglint.viewer.frame_source import MOST_CACHED, GoneError, open_source
from seaglint.viewer.over_time import trace
from seaglint.viewer.picture import Scales, Show, scaling_of, tag
from seaglint.viewer.regions import PictureRegion
from seaglint.viewer.routes import probe

from .conftest import COLUMNS, FRAMES, ROWS, images, layout, radiance


def test_probe_tells_the_stores_numbers(store):
    found = probe(open_source(store), 5, 21, 17)
    values = {v["name"]: v for v in found["values"]}
    with xr.open_zarr(store, decode_times=False) as dataset:
        assert values["radiance"]["value"] == float(dataset["radiance"][5, 21, 17])
        assert values["range"]["value"] == float(dataset["range"][5, 21, 17])
        assert found["azimuth_deg"] == float(dataset["azimuth"][17])
        band = stored_band(dataset.attrs)
    kelvin = float(apparent_temperature(radiance(5)[21, 17], band, grid_of(band)))
    assert values["apparent_temperature"]["value"] == pytest.approx(kelvin, rel=1e-6)
    assert (values["radiance"]["unit"], values["range"]["unit"]) == ("W m⁻² sr⁻¹", "m")
    assert found["objects"] == ["boat"]
    assert probe(open_source(store), 5, 0, 0)["objects"] == []
    with pytest.raises(DataError, match="48 rows and 64 columns"):
        probe(open_source(store), 5, 48, 0)


def test_trace_is_the_pixels_course(store):
    found = trace(open_source(store), 3, 4, "radiance", lambda done, total: None)
    assert found["values"] == [float(radiance(n)[3, 4]) for n in range(FRAMES)]
    assert found["times_s"] == pytest.approx([n / 25.0 for n in range(FRAMES)])


def test_trace_has_every_frame_of_a_long_sequence_and_tells_its_progress(tmp_path):
    values = np.arange(1000.0)[:, None, None] * np.ones((1000, 5, 6))
    values[700, 0, 0] = np.inf
    np.save(tmp_path / "long.npy", values)
    told = []
    found = trace(open_source(tmp_path / "long.npy"), 0, 0, None, lambda done, total: told.append((done, total)))
    assert found["frames"] == list(range(1000))
    assert found["values"] == [None if frame == 700 else float(frame) for frame in range(1000)]
    assert told[0] == (0, 1000)
    assert len(told) > 50


@pytest.mark.parametrize("only", [4, pytest.param(None, marks=pytest.mark.validation)])
def test_region_is_what_analyze_tells(store, only):
    where = PictureRegion.rectangle(8, 6, 30, 25)
    mask = np.zeros((ROWS, COLUMNS), bool)
    mask[6:31, 8:38] = True
    recording = open_recording(store)
    if only is not None:
        recording = open_source(store).recording("radiance", only=only)
    expected = analyze(recording, AnalysisOptions(mask=mask)).regions["glint"].as_dict()
    found = whole(open_source(store), where, "radiance", only, lambda done, total: None)
    assert {key: found[key] for key in expected} == expected
    assert (found["blur_px"], found["blur"]) == (recording.blur_px, recording.blur)
    if only is not None:
        at_once = quick(open_source(store), only, where)
        same = ("pixels", "values", "mean", "std", "skewness", "excess_kurtosis", "minimum", "maximum")
        assert {key: at_once[key] for key in same} == {key: expected[key] for key in same}
        for family in ("gamma", "gaussian"):
            for key in ("shape", "loc", "scale"):
                assert at_once["fits"][family][key] == expected["fits"][family][key]
        edges, density = np.array(at_once["histogram"]["edges"]), np.array(at_once["histogram"]["density"])
        assert np.sum(np.diff(edges) * density) == pytest.approx(1.0)


def test_fits_of_a_temperature_do_not_depend_on_the_unit_displayed(store):
    where, source = PictureRegion.rectangle(8, 6, 30, 25), open_source(store)
    layers = ("apparent_temperature", "apparent_temperature_celsius")
    kelvin, celsius = (quick(source, 4, where, layer) for layer in layers)
    assert celsius["mean"] == pytest.approx(kelvin["mean"] - 273.15, abs=1e-4)
    assert (celsius["unit"], celsius["fits_unit"]) == ("°C", "K")
    for family, fitted in kelvin["fits"].items():
        assert celsius["fits"][family]["shape"] == fitted["shape"]
        assert celsius["fits"][family]["density"] == pytest.approx(fitted["density"], rel=1e-3)
    first, second = (whole(source, where, layer, 4, lambda done, total: None) for layer in layers)
    nearest = [min((fit["ks"], name) for name, fit in found["fits"].items() if fit["ks"] is not None) for found in (first, second)]
    assert nearest[0] == nearest[1]
    assert first["units"] == second["units"] == "K"


def test_threshold_counts_as_analyze_does(store):
    source = open_source(store)
    told, above = exceedances(source, 2, 3.0, "laplacian")
    alarms = analyze(source.recording("radiance", only=2)).regions["all"].as_dict()["false_alarms"]
    expected = next(entry for entry in alarms if entry["threshold_sigma"] == 3.0)
    assert told["exceedances"] == expected["exceedances"] == int(above.sum()) > 0
    assert told["rate"] == told["exceedances"] / told["pixels"] == expected["rate"]
    assert told["gaussian_rate"] == expected["gaussian_rate"]


def test_unfiltered_threshold_is_a_level_of_the_image(store):
    told, above = exceedances(open_source(store), 1, 1.5, "none")
    image = radiance(1).astype(np.float64)
    assert told["value"] == pytest.approx(image.mean() + 1.5 * image.std(), rel=1e-6)
    assert np.array_equal(above, image > told["value"])


def test_linear_scaling_spreads_values_evenly():
    image = np.linspace(-1.0, 3.0, 255).reshape(5, 51)
    scaling = scaling_of([image], "linear")
    assert np.array_equal(scaling.levels(image).ravel(), np.arange(1, 256))
    assert scaling.levels(np.array([[np.nan, -9.0, 9.0]])).tolist() == [[0, 1, 255]]
    assert scaling.value(np.array([0.25])).tolist() == [0.0]


def test_percentiles_leave_both_ends_out():
    scaling = scaling_of([np.arange(1001.0).reshape(7, 143)], "percentile")
    assert (scaling.low, scaling.high) == pytest.approx((10.0, 990.0))


def test_plateau_gives_the_many_no_more_than_their_plateau():
    rng = np.random.default_rng(3)
    sky, sea = np.full(90_000, 0.01), rng.uniform(0.0, 1.0, 10_000)
    image = np.concatenate([sky, sea]).reshape(250, 400)
    levels = scaling_of([image], "plateau").levels(image).ravel()
    # With plain equalisation nine tenths of the levels lie below the sky's, and the sea is left with the rest.
    assert np.ptp(levels[90_000:].astype(int)) > 240
    spread = np.histogram(levels[90_000:], bins=8, range=(1, 256))[0]
    assert spread.min() > 0.8 * spread.max()


def test_difference_is_even_about_zero(store):
    source = open_source(store)
    show = Show(source, "radiance", minus=open_source(store), kind="linear")
    assert not show.image(3).any()
    other = Show(source, "range", minus=source)
    scaling = scaling_of([np.array([[-1.0, 4.0]])], "linear", symmetric=True)
    assert (scaling.low, scaling.high) == (-4.0, 4.0)
    assert not other.image(0).any()


def test_fixed_scale_is_of_all_frames_and_a_tag_of_one(store):
    source, scales = open_source(store), Scales()
    fixed, each = Show(source, kind="linear"), Show(source, kind="linear", fixed=False)
    assert scales.of(fixed, 0) is scales.of(fixed, 7)
    assert scales.of(fixed, 0).high == max(float(radiance(n).max()) for n in range(FRAMES))
    assert scales.of(each, 2).high == float(radiance(2).max())
    assert tag(fixed, 0, scales.of(fixed, 0)) != tag(fixed, 1, scales.of(fixed, 1))
    assert tag(fixed, 0, scales.of(fixed, 0)) == tag(fixed, 0, scales.of(fixed, 0))


def test_unfinished_store_is_shown_as_far_as_it_is_and_goes_on(half):
    source = open_source(half)  # its final name, which is not there yet
    assert source.done().tolist() == [0, 1, 2]
    with pytest.raises(DataError, match="not written yet, 3 of 12"):
        source.read(3)
    write_sequence(half, layout(), images, resume=True)
    assert source.done().tolist() == list(range(FRAMES))
    assert np.array_equal(source.read(11), radiance(11))


def test_frames_of_units_of_several_are_all_there(tmp_path):
    def until(number):
        if number == 6:
            raise RuntimeError("stopped")
        return images(number)

    several = replace(layout(), frames_per_unit=4)
    with pytest.raises(RuntimeError):
        write_sequence(tmp_path / "run.zarr", several, until)
    source = open_source(tmp_path / "run.zarr")
    assert source.done().tolist() == [0, 1, 2, 3, 4, 5]
    assert np.array_equal(source.read(5), radiance(5))
    write_sequence(tmp_path / "run.zarr", several, images, resume=True)
    assert source.done().tolist() == list(range(FRAMES))
    assert np.array_equal(source.read(11), radiance(11))


def test_store_that_vanishes_is_told_and_may_come_back(half):
    partial = half.with_name("half.zarr.partial")
    source = open_source(partial)
    partial.rename(half.with_name("elsewhere"))
    with pytest.raises(GoneError, match="not there any more"):
        source.read(0)
    half.with_name("elsewhere").rename(partial)
    assert np.array_equal(source.read(0), radiance(0))


def test_maps_are_one_frame(tmp_path):
    image = radiance(1).astype(np.float64)
    xr.Dataset({"radiance": (("y", "x"), image), "range": (("y", "x"), 2 * image)}).to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    source = open_source(tmp_path / "map.nc")
    assert source.opened.frames == 1
    assert list(source.opened.layers) == ["radiance", "range"]  # no temperature without a band
    assert np.array_equal(source.read(0, "range"), 2 * image)
    assert source.directions(0) is None


@pytest.mark.parametrize(("ending", "unit"), [("png", "counts"), ("npy", "unit not known")])
def test_recordings_without_calibration_have_no_temperature(tmp_path, ending, unit):
    counts = np.random.default_rng(5).integers(0, 2**14, (20, 30)).astype(np.uint16)
    path = tmp_path / f"one.{ending}"
    if ending == "npy":
        np.save(path, counts.astype(np.float64) + 1e9)
    else:
        from PIL import Image

        Image.fromarray(counts).save(path)
    found = probe(open_source(path), 0, 4, 5)["values"]
    assert [(v["name"], v["unit"]) for v in found] == [("value", unit)]
    assert found[0]["value"] == float(counts[4, 5]) + (1e9 if ending == "npy" else 0.0)


def test_counts_come_with_the_radiance_they_stand_for(tmp_path):
    counts = np.arange(12, dtype=np.uint16).reshape(1, 3, 4)
    line = {"radiance_scale": 0.5, "radiance_offset": 2.0, "saturation_counts": 11}
    xr.Dataset({"signal": (("time", "y", "x"), counts, line)}).to_netcdf(tmp_path / "c.nc", engine="h5netcdf")
    found = {v["name"]: v["value"] for v in probe(open_source(tmp_path / "c.nc"), 0, 1, 2)["values"]}
    assert found == {"signal": 6.0, "radiance": 5.0}


def test_memory_does_not_grow_with_the_frames(tmp_path):
    frame = np.zeros((512, 640), np.float32)
    np.save(tmp_path / "long.npy", np.broadcast_to(frame, (60, 512, 640)))
    source = open_source(tmp_path / "long.npy")
    for index in range(60):
        source.read(index)
    assert source._bytes == sum(image.nbytes for image in source._cached.values()) <= MOST_CACHED < 60 * frame.nbytes


@pytest.mark.parametrize("unit", [1, 8])
def test_huge_store_opens_with_few_reads(tmp_path, unit, monkeypatch):
    huge = tmp_path / "huge.zarr"
    (stage := tmp_path / "stage").mkdir()
    place_of(huge).create(replace(layout(80_000, 512, 640, truth=False, layers=()), frames_per_unit=unit), stage)  # 105 GB when whole
    shards = Shards(zarr.open_group(partial_path(huge), mode="r+"))
    block = shards.blank(shards.span(0))
    block["radiance"][0] = radiance(0, 512, 640)
    shards.write(0, block, np.arange(unit) < 1, np.zeros(unit, np.uint64))
    read, get = [], zarr.storage.LocalStore.get

    def noted(self, key, *more, **options):
        read.append(key)
        return get(self, key, *more, **options)

    monkeypatch.setattr(zarr.storage.LocalStore, "get", noted)
    source = open_source(huge)
    assert source.done().tolist() == [0]
    assert np.isfinite(source.read(0)).all()
    print(f"{len(read)} reads")
    assert 0 < len(read) < 200  # what is done of 80 000 frames is not read one by one


@pytest.mark.parametrize("left", [-50, 64])
def test_region_outside_the_picture_is_refused(store, left):
    with pytest.raises(DataError, match="outside the image of 48 rows"):
        quick(open_source(store), 0, PictureRegion.rectangle(left, 0, 10, 10))


def test_nothing_there_is_said_in_the_readers_words(tmp_path: Path):
    with pytest.raises(DataError, match="no such file"):
        open_source(tmp_path / "none.zarr")
