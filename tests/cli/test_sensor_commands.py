"""``seaglint sense`` and ``seaglint sensor``: files in, counts and figures out, mistakes in a line."""

from __future__ import annotations

import json

import numpy as np
import pytest
import tifffile
import xarray as xr

import seaglint as sg
from seaglint.store.sequence_store import open_sequence

TOML = """
[band]
min_um = 3.5
max_um = 5.0
[sensor.optics]
aperture_m = 0.05
f_number = 2.0
[sensor.detector]
pitch_um = 15
integration_time_s = 0.002
well_capacity_e = 7e6
read_noise_e = 500
bit_depth = 14
"""


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "S.toml"
    path.write_text(TOML)
    return path


def radiance(frames: int = 2, size: int = 60) -> np.ndarray:
    return np.full((frames, size, size), 1.5) + 0.2 * np.random.default_rng(1).random((frames, size, size))


def written(path, values: np.ndarray):
    """The same radiance in any of the formats."""
    match path.suffix:
        case ".npy":
            np.save(path, values)
        case ".tif":
            tifffile.imwrite(path, values.astype(np.float32))
        case _:
            dataset = xr.Dataset({"radiance": (("time", "y", "x"), values.astype(np.float32), {"units": "W m-2 sr-1"})})
            dataset = dataset.assign_coords(time=("time", np.arange(len(values)) / 25.0, {"units": "s"}))
            if path.suffix == ".nc":
                dataset.to_netcdf(path, engine="h5netcdf")
            else:
                dataset.to_zarr(path, consolidated=False)
    return path


def test_every_format_gives_the_same_counts(seaglint, scenario, tmp_path) -> None:
    found = {}
    for ending in ("npy", "nc", "tif", "zarr"):
        given = written(tmp_path / f"in.{ending}", radiance())
        answer = seaglint("sense", given, scenario, "--oversampling", 5, "-o", tmp_path / f"{ending}_out.zarr", "--electrons")
        assert answer.code == 0, answer.err
        assert "no pixel is saturated" in answer.err
        with open_sequence(tmp_path / f"{ending}_out.zarr") as dataset:
            assert dataset.signal.dtype == np.uint16
            assert dataset.signal.shape == dataset.electrons.shape == (2, 12, 12)
            found[ending] = dataset.signal.to_numpy()
    for counts in found.values():
        np.testing.assert_array_equal(counts, found["npy"])
    again = sg.sense(radiance(), sg.load(str(scenario)), oversampling=5)
    np.testing.assert_array_equal(again.signal, found["npy"])


def test_seeds_change_the_noise_alone(seaglint, scenario, tmp_path) -> None:
    given = written(tmp_path / "in.npy", radiance())
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        assert seaglint("sense", given, scenario, "-o", tmp_path / f"{name}.zarr", "--seed", seed).code == 0
    a, b, c = (open_sequence(tmp_path / f"{name}.zarr").signal.to_numpy().astype(float) for name in "abc")
    np.testing.assert_array_equal(a, b)
    assert not np.array_equal(a, c)
    assert a.mean() == pytest.approx(c.mean(), rel=0.01)


def test_saturated_pixels_are_counted_and_told(seaglint, scenario, tmp_path) -> None:
    bright = np.ones((2, 10, 10))
    bright[1, :5] = 8.0
    answer = seaglint("sense", written(tmp_path / "in.npy", bright), scenario, "-o", tmp_path / "out.zarr")
    assert answer.code == 0
    assert "saturated" in answer.err
    assert "frame 1" in answer.err
    with open_sequence(tmp_path / "out.zarr") as dataset:
        share = dataset.saturated_share.to_numpy()
        assert share[0] == 0.0
        assert 0.4 <= share[1] <= 0.7
        assert int(dataset.signal[1].max()) == dataset.signal.attrs["saturation_counts"] == 16383
    told = seaglint("info", tmp_path / "out.zarr")
    assert "saturated" in told.out


def test_a_rendered_store_tells_its_pixels_and_its_band(seaglint, scenario, tmp_path) -> None:
    step = np.degrees(150e-6)
    fine = sg.load({"sensor": {"pixels": [12, 6], "fov_deg": [4 * step, 2 * step], "frames": 2}, "sea": {"resolve_waves": False}})
    sg.render(fine, tmp_path / "fine.zarr")
    assert seaglint("sense", tmp_path / "fine.zarr", scenario, "-o", tmp_path / "out.zarr").code == 0
    with open_sequence(tmp_path / "out.zarr") as dataset:
        assert dataset.signal.shape == (2, 2, 4)
        assert dataset.attrs["oversampling"] == 3
    other = tmp_path / "other.toml"
    other.write_text(TOML.replace("max_um = 5.0", "max_um = 4.5"))
    answer = seaglint("sense", tmp_path / "fine.zarr", other, "-o", tmp_path / "no.zarr")
    assert answer.code == 2
    assert "band.min_um and band.max_um" in answer.err


def test_a_stored_frame_alone_has_the_noise_of_its_sequence(seaglint, scenario, tmp_path) -> None:
    fine = sg.load({"sensor": {"pixels": [12, 6], "fov_deg": [0.1, 0.05], "frames": 3}, "sea": {"resolve_waves": False}})
    for name, frames in (("all", range(3)), ("last", range(2, 3))):
        sg.render(fine, tmp_path / f"{name}.zarr", frames=frames)
        assert seaglint("sense", tmp_path / f"{name}.zarr", scenario, "-o", tmp_path / f"{name}_out.zarr", "--oversampling", 1).code == 0
    with open_sequence(tmp_path / "all_out.zarr") as whole, open_sequence(tmp_path / "last_out.zarr") as last:
        assert last.frame.values.tolist() == [2]
        assert last.time.values[0] == whole.time.values[2]
        np.testing.assert_array_equal(last.signal[0], whole.signal[2])


@pytest.mark.parametrize(
    ("values", "options", "said"),
    [
        (np.full((1, 8, 8), np.nan), (), "not finite"),
        (np.full((1, 8, 8), -1.0), (), "negative"),
        (np.ones((1, 8, 8)), ("--oversampling", 3), "--oversampling 3 does not divide"),
        (np.ones((1, 8, 8)), ("--sensor", "nix"), "is not one of"),
        (np.ones((1, 8, 8)), ("--frame-rate", 1000), "integration_time_s"),
    ],
    ids=["nan", "negative", "not divided", "no preset", "fast frames"],
)
def test_bad_radiance_is_one_line(seaglint, scenario, tmp_path, values, options, said) -> None:
    answer = seaglint("sense", written(tmp_path / "in.npy", values), scenario, "-o", tmp_path / "out.zarr", *options)
    assert answer.code == 2
    assert said in answer.err
    assert len([line for line in answer.err.splitlines() if line.startswith("seaglint:")]) == 1
    assert not list(tmp_path.glob("out.zarr*"))


def test_bad_radiance_of_a_later_frame_names_file_and_frame(seaglint, scenario, tmp_path) -> None:
    values = np.ones((3, 8, 8))
    values[2, 5, 6] = np.nan
    answer = seaglint("sense", written(tmp_path / "in.npy", values), scenario, "-o", tmp_path / "out.zarr")
    assert answer.code == 2
    assert "in.npy" in answer.err
    assert "frame 2: radiance: 1 of 64 pixels are not finite (first in row 5, column 6)" in answer.err


def test_a_budget_above_saturation_says_so(seaglint, scenario) -> None:
    # the default scene looks into the Sun's glint
    assert "above saturation" in seaglint("sensor", scenario).out
    short = scenario.with_name("short.toml")
    short.write_text(TOML.replace("integration_time_s = 0.002", "integration_time_s = 0.0001"))
    assert "above saturation" not in seaglint("sensor", short).out


def test_a_scenario_without_a_sensor_is_refused(seaglint, tmp_path) -> None:
    path = tmp_path / "plain.toml"
    path.write_text("")
    for arguments in (("sensor", path), ("sense", written(tmp_path / "in.npy", radiance()), path, "-o", tmp_path / "out.zarr")):
        answer = seaglint(*arguments)
        assert answer.code == 2
        assert "[sensor.optics] and [sensor.detector]" in answer.err


def test_figures_as_json_as_text_and_as_a_picture(seaglint, scenario, tmp_path) -> None:
    answer = seaglint("sensor", scenario, "--json", "--plot", tmp_path / "f.png")
    assert answer.code == 0
    found = json.loads(answer.out)
    assert 0.005 < found["netd_k"] < 0.05
    assert found["electrons_per_count"] == pytest.approx(7e6 / 16383)
    mtf = found["mtf"]
    assert len(mtf["frequency_cycles_per_mrad"]) == len(mtf["along"]) == len(mtf["across"])
    assert mtf["along"][0] == pytest.approx(1.0)
    assert (tmp_path / "f.png").stat().st_size > 10_000
    two = json.loads(seaglint("sensor", scenario, "--json", "--frequency", 1.0, "--frequency", 2.5).out)["mtf"]
    assert two["frequency_cycles_per_mrad"] == [1.0, 2.5]
    np.testing.assert_allclose(two["along"], np.interp([1.0, 2.5], mtf["frequency_cycles_per_mrad"], mtf["along"]), atol=0.002)
    text = seaglint("sensor", scenario).out
    for word in ("NETD", "SiTF", "NEI", "NEP", "MTF", "noise budget", "dynamic range", "saturates", "3-D noise"):
        assert word in text
    assert found == {**sg.sensor(sg.load(str(scenario))), "scenario": found["scenario"]}
    # a picture is not replaced unasked
    assert seaglint("sensor", scenario, "--plot", tmp_path / "f.png").code == 2


def test_presets_are_listed_and_taken(seaglint, scenario) -> None:
    listed = seaglint("sensor", scenario, "--presets").out
    assert {"mwir-insb-640", "lwir-mct-640", "lwir-microbolometer-640", "mwir-panoramic"} <= set(listed.split())
    thermal = json.loads(seaglint("sensor", scenario, "--sensor", "lwir-microbolometer-640", "--json").out)
    assert thermal["detector"] == "thermal"
    assert thermal["electrons_per_count"] is None
    assert thermal["netd_k"] == pytest.approx(0.04, rel=0.01)
