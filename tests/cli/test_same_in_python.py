"""Functions of ``sg`` and their commands give the same numbers, bytes and files."""

from __future__ import annotations

import csv
import itertools
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import seaglint as sg
from seaglint.base.conventions import horizon_depression, horizon_range
from seaglint.base.errors import DataError, ScenarioError
from seaglint.formats.object_labels import Labels
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.scenario.presets import OBJECTS

CAMERA = {
    "optics": {"aperture_m": 0.005, "f_number": 2.0},
    "detector": {"pitch_um": 15.0, "well_capacity_e": 7e6, "integration_time_s": 2e-3},
}
BOAT = {"name": "boat", "preset": "small-boat", "east_m": 4.0, "north_m": 300.0, "speed_m_s": 8.0, "course_deg": 90.0}
LAMP = {"name": "lamp", "shape": {"kind": "point", "intensity_w_sr": 40.0}, "east_m": -3.0, "north_m": 320.0, "height_m": 3.0}
SEA = {
    "seed": 4,
    "sensor": {
        **{"azimuth_deg": 0.0, "elevation_deg": -3.0, "height_m": 15.0, "fov_deg": [2.4, 1.6], "pixels": [24, 16]},
        **{"frames": 3, "frame_rate_hz": 20.0},
    },
    "sea": {"shortest_wave_m": 4.0},
    "render": {"tile_size": 128},
    "objects": [BOAT, LAMP],
}


def with_camera(camera: dict[str, object]) -> dict[str, object]:
    tables = {**SEA["sensor"], **camera}
    if camera:
        tables.pop("fov_deg")
    return {**SEA, "sensor": tables}


def toml(tables: dict[str, object], path: Path) -> Path:
    scene = sg.load(tables).model_dump(mode="json", exclude_none=True)
    lines: list[str] = []

    def value(v: object) -> str:
        if isinstance(v, dict):
            return "{" + ", ".join(f"{key} = {value(inner)}" for key, inner in v.items()) + "}"
        return "[" + ", ".join(map(value, v)) + "]" if isinstance(v, list) else json.dumps(v)

    lines += [f"{key} = {value(v)}" for key, v in scene.items()]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("camera", [{}, CAMERA], ids=["aperture", "detector"])
def test_frames_are_those_of_the_store_and_of_its_labels(tmp_path, camera):
    scene = sg.load(with_camera(camera))
    run = sg.render(scene, tmp_path / "run.zarr")
    frames = list(sg.frames(scene))
    variable = "signal" if camera else "radiance"
    assert [int(frame.frame) for frame in frames] == [0, 1, 2]
    truth = sg.labels(tmp_path / "run.zarr")
    for number, frame in enumerate(frames):
        stored = run.isel(time=number)
        assert frame[variable].to_numpy().tobytes() == stored[variable].to_numpy().tobytes()
        assert frame[variable].attrs == {key: v for key, v in stored[variable].attrs.items() if key != "coordinates"}
        assert frame.attrs["scenario"] == run.attrs["scenario"]
        assert frame.names.to_numpy().tolist() == ["boat", "lamp"]
        assert frame.classes.to_numpy().tolist() == ["small-boat", "point"]
        for name in ("column_px", "range_m", "visible_share", *(("counts_peak",) if camera else ())):
            np.testing.assert_array_equal(frame[name].to_numpy(), truth[name].isel(frame=number).to_numpy())
        for side in ("left", "top", "width", "height"):
            np.testing.assert_array_equal(frame.boxes.sel(side=side).to_numpy(), frame[f"bbox_{side}_px"].to_numpy())
    for kind, name in (("geometric", "masks"), *((("response", "response_masks"),) if camera else ())):
        for label in Labels.of(tmp_path / "run.zarr", kind):
            np.testing.assert_array_equal(frames[label.frame][name].isel(object=label.number).to_numpy(), label.mask)
    assert int(frames[0].masks.isel(object=0).sum()) > 0


def test_frames_alone_and_with_radiance_are_the_same():
    scene = sg.load(with_camera(CAMERA))
    alone = next(sg.frames(scene, range(2, 3), radiance=True))
    last = list(sg.frames(scene))[2]
    np.testing.assert_array_equal(alone.signal.to_numpy(), last.signal.to_numpy())
    assert alone.radiance.dims == ("y", "x")
    with pytest.raises(DataError, match="need a detector"):
        sg.frames(sg.load(SEA), electrons=True)


@pytest.mark.parametrize("numbers", [itertools.count(), 5, range(0), range(-2, 2), range(2, 10**12)])
def test_frames_that_there_are_not_are_refused_before_any_work(numbers):
    with pytest.raises(DataError, match="frames ="):
        sg.frames(SEA, numbers)


def test_labels_are_the_same_to_the_last_bit_each_time():
    """A moving boat before a detector: all numbers of its truth, prepared anew three times."""
    scene = sg.load(with_camera(CAMERA))
    made = [next(sg.frames(scene, range(2, 3))) for _ in range(3)]
    for name in made[0].data_vars:
        assert len({frame[name].to_numpy().tobytes() for frame in made if frame[name].dtype != object}) <= 1, name


def test_labels_are_written_as_the_command_writes_them(tmp_path, seaglint):
    sg.render(SEA, tmp_path / "run.zarr", frames=range(1))
    for kind in ("csv", "json"):
        assert seaglint("labels", tmp_path / "run.zarr", "-o", tmp_path / f"command.{kind}").code == 0
        sg.labels(tmp_path / "run.zarr", tmp_path / f"python.{kind}")
        assert (tmp_path / f"python.{kind}").read_bytes() == (tmp_path / f"command.{kind}").read_bytes()


def test_functions_take_files_tables_and_scenarios(tmp_path):
    path = toml({**SEA, "objects": []}, tmp_path / "sea.toml")
    same = [sg.mean(given) for given in (path, str(path), sg.load(path), {**SEA, "objects": []})]
    for other in same[1:]:
        np.testing.assert_array_equal(other.radiance.to_numpy(), same[0].radiance.to_numpy())
    with pytest.raises(ScenarioError, match="nobody"):
        sg.sensor(path, sensor="nobody")


def test_beginning(tmp_path, seaglint):
    assert seaglint("init", tmp_path / "command.toml", "--preset", "calm").code == 0
    assert sg.init(tmp_path / "python.toml", preset="calm").read_bytes() == (tmp_path / "command.toml").read_bytes()
    assert sg.schema() == json.loads(seaglint("schema").out)
    assert sg.info(tmp_path / "python.toml").as_dict() == json.loads(seaglint("info", tmp_path / "python.toml", "--json").out)
    np.save(tmp_path / "clip.npy", np.ones((3, 8, 8)))
    assert sg.info(tmp_path / "clip.npy").as_dict() == json.loads(seaglint("info", tmp_path / "clip.npy", "--json").out)


CASES = {
    "atmosphere": ["tropical", "midlatitude-winter"],
    "wind_speed_m_s": [3.0, 9.0],
    "sensor_height_m": [20.0, 400.0],
    "depression_deg": [3.0, 20.0],
    "solar_zenith_deg": [50.0, 70.0],
    "sky_zenith_deg": [10.0, 80.0],
}


def test_cases_from_columns_are_those_of_a_file(tmp_path, seaglint):
    rows = zip(*CASES.values(), strict=True)
    (tmp_path / "cases.csv").write_text("\n".join([",".join(CASES), *(",".join(map(str, row)) for row in rows)]) + "\n")
    answer = seaglint("evaluate", "atmosphere", tmp_path / "cases.csv", "-o", tmp_path / "out.csv", "--band", "3.5-4.1", "--band", "8-12")
    assert answer.code == 0, answer.err
    found = sg.evaluate.atmosphere(CASES, bands=["3.5-4.1", (8, 12)], output=tmp_path / "python.csv")
    # the same columns; the numbers of the cases are written as Python has them
    assert (tmp_path / "python.csv").read_text() == (tmp_path / "out.csv").read_text()
    assert found.tau_mean.dims == ("case", "band")
    assert found.band.to_numpy().tolist() == ["3.5-4.1", "8-12"]
    written = list(csv.DictReader((tmp_path / "out.csv").open()))
    for name in ("tau_mean", "path_radiance_W_m2_sr", "sky_radiance_W_m2_sr"):
        for band in ("3.5-4.1", "8-12"):
            ours = found[name].sel(band=band).to_numpy()
            np.testing.assert_allclose(ours, [float(row[f"{name}[{band}]"]) for row in written], rtol=1e-5)
    assert found.path_radiance_W_m2_sr.attrs["units"] == "W m-2 sr-1"
    assert found.sensor_height_m.to_numpy().tolist() == [20.0, 400.0]
    with pytest.raises(DataError, match="different numbers of values"):
        sg.evaluate.emissivity({"wavelength_um": [4.0, 5.0], "wind_speed_m_s": [4.0], "zenith_deg": [0.0]})


@pytest.mark.parametrize("band", [(3.5, 4.1), (8.0, 12.0)])
def test_paths_and_sky_are_those_of_the_mean_and_of_the_exported_air(band):
    tables = {
        "band": {"min_um": band[0], "max_um": band[1]},
        "sun": {"zenith_deg": 55.0, "azimuth_deg": 200.0},
        "sensor": {"height_m": 30.0, "azimuth_deg": 150.0, "elevation_deg": 6.0, "fov_deg": [8.0, 8.0], "pixels": [4, 4]},
    }
    scene = sg.load(tables)
    air = sg.atmosphere.export(scene)
    some = air.isel(range_m=[5, 20, 40])
    paths = sg.atmosphere.path(scene, range_m=some.range_m.to_numpy())
    for ours, theirs in (("spectral_transmittance", "path_transmittance"), ("spectral_path_radiance", "path_radiance")):
        np.testing.assert_allclose(paths[ours].isel(target_height_m=0), some[theirs], rtol=1e-12)
    nu = paths.wavenumber_cm.to_numpy()
    weights = Band.rectangular(*band).weights(nu)
    glow = planck_wavenumber(nu, scene.sea.temperature_k) * weights
    np.testing.assert_allclose(
        paths.transmittance, paths.spectral_transmittance @ xr.DataArray(glow, dims="wavenumber_cm") / glow.sum(), rtol=1e-12
    )
    np.testing.assert_allclose(paths.path_radiance, paths.spectral_path_radiance @ xr.DataArray(weights, dims="wavenumber_cm"), rtol=1e-12)
    # the straight line over the Earth with refraction: close to the root of the squares, and below the water beyond the horizon
    np.testing.assert_allclose(paths.slant_range[0], np.hypot(paths.range_m, 30.0), rtol=1e-3)
    far = sg.atmosphere.path(scene, range_m=[20e3, 45e3], target_height_m=10.0)
    assert [float(low) > 0.0 for low in far.lowest_height[0]] == [horizon_range(30.0) + horizon_range(10.0) > at for at in (20e3, 45e3)]
    # an object as high as the sensor is seen through as much air as the sea is, or less
    level = sg.atmosphere.path(scene, range_m=[2000.0], target_height_m=[0.0, 30.0])
    assert float(level.transmittance[1, 0]) == pytest.approx(float(level.transmittance[0, 0]), abs=0.01)
    mean = sg.mean(scene)
    sky = sg.atmosphere.sky(scene, zenith_deg=90.0 - mean.elevation.to_numpy(), azimuth_deg=mean.azimuth.to_numpy())
    np.testing.assert_allclose(sky.radiance, mean.radiance, rtol=2e-3)  # the map interpolates a table of the sky
    np.testing.assert_allclose(sky.thermal_radiance + sky.scattered_radiance, sky.radiance, rtol=1e-12)
    kelvin = sg.apparent_temperature(sky.radiance, band)
    np.testing.assert_allclose(sky.apparent_temperature, kelvin, rtol=1e-9)
    np.testing.assert_allclose(sky.thermal_radiance, sky.spectral_thermal_radiance.to_numpy() @ weights, rtol=1e-12)
    assert float(sky.scattered_radiance.max() / sky.radiance.max()) > (0.05 if band[0] < 5.0 else -1.0)


def test_even_air_is_the_homogeneous_path():
    air = {"temperature_k": 290.0, "pressure_hpa": 1000.0, "vapour_pressure_hpa": 12.0, "length_km": 3.0, "band_um": (3.7, 4.2)}
    mean, spectrum = sg.homogeneous_path(**air, co2_ppmv=425.0, return_spectrum=True)
    found = sg.atmosphere.path(**air, co2_ppmv=425.0)
    assert float(found.transmittance) == mean
    np.testing.assert_array_equal(found.spectral_transmittance, spectrum)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "temperature_k, pressure_hpa.* missing"),
        ({"range_m": [100.0]}, "needs a scenario"),
        ({"scenario": {}}, "range_m is missing"),
        ({"scenario": {}, "range_m": 100.0, "length_km": 1.0}, "length_km: describe even air"),
        ({"scenario": {}, "range_m": "far"}, "is no number"),
        ({"scenario": {}, "range_m": [-1.0]}, "0 m or more"),
    ],
)
def test_paths_of_both_kinds_are_not_mixed(given, message):
    with pytest.raises(Exception, match=message):
        sg.atmosphere.path(**given)


def test_sky_ends_at_the_horizon():
    below = 91.0 + np.degrees(horizon_depression(sg.load({}).sensor.height_m))
    with pytest.raises(DataError, match="is not in the sky"):
        sg.atmosphere.sky({}, zenith_deg=[10.0, below])


def test_the_commands_of_paths_and_sky_print_and_write_them(tmp_path, seaglint):
    scene = tmp_path / "my.toml"
    sg.init(scene)
    answer = seaglint("atmosphere", "path", scene, "--range-m", "1000,3000", "--target-height-m", "0,10", "-o", tmp_path / "path.nc")
    assert answer.code == 0, answer.err
    ours = sg.atmosphere.path(scene, range_m=[1000, 3000], target_height_m=[0, 10])
    with xr.open_dataset(tmp_path / "path.nc") as written:
        np.testing.assert_array_equal(written.transmittance, ours.transmittance)
    assert len(answer.out.splitlines()) == 5
    told = seaglint("info", tmp_path / "path.nc")
    assert told.code == 0, told.err
    assert "range_m 2" in told.out
    assert sg.info(tmp_path / "path.nc")["variables"]["transmittance"] == "1"
    far = seaglint("atmosphere", "path", scene, "--range-m", "100000")
    assert "behind the horizon" in far.out
    answer = seaglint("atmosphere", "sky", scene, "--zenith-deg", "0:80:40", "-o", tmp_path / "sky.csv")
    assert answer.code == 0, answer.err
    assert len(answer.out.splitlines()) == 4
    assert (tmp_path / "sky.csv").read_text().splitlines()[0].startswith("zenith_deg,azimuth_deg,radiance")


def test_weather_of_python_is_that_of_the_command(tmp_path, seaglint):
    assert sg.weather.info().as_dict() == json.loads(seaglint("weather", "info", "north-atlantic", "--json").out)
    command = ("weather", "build", "north-atlantic.csv", "--months", "6,7", "--fill", "cloud_cover=0.5", "-o", tmp_path / "command.csv")
    source = Path(sg.__file__).parent / "climate/data/north-atlantic.csv"
    answer = seaglint(*(source if part == "north-atlantic.csv" else part for part in command))
    assert answer.code == 0, answer.err
    table = sg.weather.build(source, tmp_path / "python.csv", months=[6, 7], fill={"cloud_cover": 0.5})
    assert (tmp_path / "python.csv").read_bytes() == (tmp_path / "command.csv").read_bytes()
    assert set(np.unique(table.month)) == {6.0, 7.0}
    assert "selected" in table.attrs["notes"]


def test_textures_of_python_are_those_of_the_command(tmp_path, seaglint):
    noise = np.random.default_rng(3).normal(10.0, 0.5, (4, 64, 64))
    np.save(tmp_path / "clip.npy", noise)
    clip = tmp_path / "clip.npy"
    answer = seaglint("texture", "fit", clip, "-o", tmp_path / "command.json", "--seed", "2")
    assert answer.code == 0, answer.err
    fitted = sg.texture.fit(clip, tmp_path / "python.json", seed=2)
    assert (tmp_path / "python.json").read_bytes() == (tmp_path / "command.json").read_bytes()
    told = seaglint("texture", "compare", clip, tmp_path / "command.json", "--json")
    assert sg.texture.compare(clip, tmp_path / "command.json").as_dict() == json.loads(told.out)
    drawn = sg.texture.sample(fitted, size=(32, 16), seed=5)
    again = sg.texture.sample(tmp_path / "command.json", tmp_path / "loop.zarr", size=(32, 16), seed=5)
    np.testing.assert_array_equal(drawn.texture, again.texture)
    assert fitted.plot().axes
    assert fitted.stored.source["columns"] == 64


def test_detection_of_python_is_that_of_the_command(tmp_path, seaglint):
    noise = np.random.default_rng(1).normal(10.0, 0.5, (8, 64, 64))
    np.save(tmp_path / "clip.npy", noise)
    clip, options = tmp_path / "clip.npy", ("--contrast", "1,3", "--detector", "matched", "--threshold", "3", "--injections", "200")
    told = json.loads(seaglint("detect", "recording", clip, *options, "--velocity", "0.5,0.25", "--json").out)
    ours = {"contrast": [1, 3], "detector": "matched", "threshold": 3.0, "injections": 200, "velocity": (0.5, 0.25)}
    found = sg.detect_recording(clip, **ours)
    assert found["sweep"] == told["sweep"]
    assert sg.detect(clip, **ours)["sweep"] == told["sweep"]
    assert "P_d" in found._repr_html_() or "p_d" in found._repr_html_()
    assert found.plot()._repr_png_().startswith(b"\x89PNG")  # notebooks show it without pyplot
    # right and down differ
    assert sg.detect_recording(clip, **{**ours, "velocity": (0.25, 0.5)})["sweep"] != told["sweep"]
    several = sg.detect_recording(noise, **ours | {"detector": None}, vary={"detector": ["matched", "log"]})
    assert [case["parameters"]["detector"] for case in several["cases"]] == ["matched", "log"]


def test_scenes_are_judged_as_by_the_command(tmp_path, seaglint):
    tables = with_camera(CAMERA)
    sensor = {**tables["sensor"], "frames": 1, "pixels": [32, 24]}
    path = toml({**tables, "sensor": sensor, "objects": []}, tmp_path / "sea.toml")
    options = ("--frames", "2", "--contrast", "0.05", "--injections", "50", "--vary", "wind.speed_m_s=3,6")
    answer = seaglint("detect", "scene", path, *options, "--json", "--progress", "none")
    assert answer.code == 0, answer.err
    told = json.loads(answer.out)
    for source in (path, sg.load(path)):
        found = sg.detect_scene(source, frames=2, contrast=0.05, injections=50, vary={"wind.speed_m_s": [3, 6]})
        assert [case["sweep"] for case in found["cases"]] == [case["sweep"] for case in told["cases"]]


def test_likelihood_of_python_is_that_of_the_command(tmp_path, seaglint):
    table = {"threshold_w_m2_sr": [0.5], "samples": 1024}
    path = toml({"likelihood": table}, tmp_path / "chance.toml")
    told = json.loads(seaglint("likelihood", path, "--json", "--progress", "none").out)
    found = sg.likelihood(path)
    assert found["results"] == told["results"]
    assert found.plot().axes
    assert "probability" in found._repr_html_()


def test_the_best_looks_of_python_are_those_of_the_command(tmp_path, seaglint):
    (tmp_path / "s.toml").write_text(
        '[atmosphere]\nsource = "none"\n[place]\nlatitude_deg = 40\nlongitude_deg = -30\n[time]\nutc = "2026-06-21T12:00:00Z"\n'
        "[likelihood]\nhours_utc = [8, 10]\nthreshold_w_m2_sr = [0.25]\n"
    )
    answer = seaglint("likelihood", tmp_path / "s.toml", "--best", "-o", tmp_path / "out", "--progress", "none")
    assert answer.code == 0, answer.err
    assert "least at" in answer.out
    values = sg.likelihood(tmp_path / "s.toml", best=True)
    assert json.loads((tmp_path / "out/best_looks.json").read_text()) == values.as_dict()
    with open(tmp_path / "out/best_looks.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    chances = np.array(values["probability"])
    assert chances.shape == (1, 3, 7, 36)
    assert [float(row["probability"]) for row in rows] == pytest.approx(chances.ravel().tolist(), rel=1e-5)  # six digits
    assert (tmp_path / "out/best_looks.png").stat().st_size > 10_000
    assert values.plot().axes
    refused = seaglint("likelihood", tmp_path / "s.toml", "--best", "--map")
    assert refused.code == 2
    assert "--map and --best are given" in refused.err


def test_the_sea_of_python_is_that_of_the_command(tmp_path, seaglint):
    path = toml({"seed": 4, "sea": {"shortest_wave_m": 4.0}}, tmp_path / "sea.toml")
    options = ("--extent", "32", "16", "--spacing", "2", "-o", tmp_path / "command.ply")
    assert seaglint("export-sea", path, *options).code == 0
    found = sg.export_sea(path, tmp_path / "python.ply", extent=(32.0, 16.0), spacing=2.0)
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "command.ply").read_bytes()
    assert found.height.shape == (9, 17)


def test_a_share_and_its_end(tmp_path):
    scene = {**SEA, "objects": []}
    for share in ("0/2", "1/2"):
        part = sg.render(scene, tmp_path / "run.zarr", shard=share)
    assert part.sizes["time"] == 3
    whole = sg.render(scene, tmp_path / "run.zarr", finish=True)
    np.testing.assert_array_equal(whole.radiance[1], next(sg.frames(scene, range(1, 2))).radiance)


@pytest.mark.parametrize("preset", OBJECTS)
def test_a_scenario_with_a_preset_is_the_same_when_it_is_written_out(preset):
    scene = sg.load({"objects": [{"name": "it", "preset": preset, "north_m": 900.0}]})
    assert sg.load(scene.model_dump(mode="json", exclude_none=True)) == scene
    with pytest.raises(ScenarioError, match="preset and shape"):
        sg.load({"objects": [{"name": "it", "preset": preset, "north_m": 9.0, "shape": {"kind": "sphere", "radius_m": 0.1}}]})


def test_a_record_shows_numbers_and_no_curves():
    shown = sg.sensor({"sensor": {**CAMERA, "pixels": [8, 8]}})._repr_html_()
    assert "netd_k" in shown
    assert "frequency_cycles_per_mrad" not in shown
    assert len(shown) < 20_000
