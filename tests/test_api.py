"""``import seaglint as sg``: the way of a user in Python, through the same scenes, stores and numbers as the command line."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import MISSING, fields
from functools import partial

import numpy as np
import pytest
import xarray as xr

import seaglint as sg
from seaglint.analysis import Analysis, AnalysisOptions
from seaglint.analysis import analyze as run_analysis
from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError, DomainError, ScenarioError
from seaglint.base.schema import LAYERS
from seaglint.cli import ensemble as dataset_command
from seaglint.cluster import ThisProcess
from seaglint.formats import export as export_formats
from seaglint.formats.recording import open_recording
from seaglint.optics.band import Band
from seaglint.plot.video_formats import VIDEO_ENDINGS
from seaglint.studies.detect.detection_requests import DesignRequest, RecordingRequest, SceneRequest
from seaglint.studies.ensemble.ensemble_requests import DatasetRequest, EnsembleRequest
from seaglint.studies.mean.mean_map import mean as pipeline_mean
from seaglint.studies.study_requests import AnalysisRequest, ExportRequest, MeanRequest, RenderRequest, SenseRequest

RATE = 20.0
SCENE = {
    "seed": 5,
    "sun": {"zenith_deg": 70, "azimuth_deg": 240},
    "sensor": {"azimuth_deg": 240, "elevation_deg": -3.0, "fov_deg": [4, 6], "pixels": [32, 40], "frames": 4, "frame_rate_hz": RATE},
    "sea": {"shortest_wave_m": 4.0},
    "render": {"tile_size": 128, "layers": ["glint_radiance"], "apparent_temperature": True},
}


def test_an_ensemble_returns_what_it_drew(tmp_path):
    wind = {"key": "wind.speed_m_s", "law": "uniform", "min": 2, "max": 12}
    rows = sg.ensemble({"base": SCENE, "ensemble": {"scenes": 3}, "vary": [wind]}, tmp_path / "few", draw_only=True)
    assert [row["wind.speed_m_s"] for row in rows] == [sg.load(tmp_path / f"few/scenes/{n:04d}.toml").wind.speed_m_s for n in range(3)]
    with pytest.raises(DataError, match="format = 'voc'"):
        sg.dataset(tmp_path / "few", tmp_path / "D", format="voc")


@pytest.mark.parametrize("workers", [2, ThisProcess()])
def test_a_number_of_workers_is_that_of_processes(tmp_path, monkeypatch, workers):
    class Asked(Exception):
        pass

    def processes(count, *, threads):
        return nullcontext((count, threads))

    def done(*_, workers, **more):
        raise Asked(workers)

    monkeypatch.setattr("seaglint.cluster.LocalProcesses", processes)
    for name in (
        "sequence.sensed_sequence.render",
        "ensemble.render_ensemble.render_ensemble",
        "ensemble.ensemble_dataset.ensemble_dataset",
    ):
        monkeypatch.setattr(f"seaglint.studies.{name}", done)
    few = {"base": SCENE, "ensemble": {"scenes": 2}}
    (tmp_path / "few.toml").write_text("base = { preset = 'glint' }\n[ensemble]\nscenes = 2\n")
    expected = (2, 1) if workers == 2 else workers
    for call in (partial(sg.render, sg.load(SCENE)), partial(sg.ensemble, few), partial(sg.dataset, tmp_path / "few.toml")):
        with pytest.raises(Asked) as asked:
            call(tmp_path / "out", workers=workers, threads=1)
        assert asked.value.args == (expected,)


@pytest.fixture(scope="module")
def still_scene():
    return sg.load(SCENE)


@pytest.fixture(scope="module")
def run(still_scene, tmp_path_factory) -> xr.Dataset:
    return sg.render(still_scene, tmp_path_factory.mktemp("api") / "run.zarr")


def in_new_interpreter(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


@pytest.mark.parametrize("before", ["", "import seaglint.imaging", "import seaglint.studies.sequence.render_sequence", "sg.mean"])
def test_the_functions_are_functions_whatever_was_imported_before(before: str) -> None:
    code = f"import seaglint as sg, inspect\n{before}\nprint(inspect.isfunction(sg.render), inspect.isfunction(sg.sensor))"
    assert in_new_interpreter(code) == "True True"


GROUPS = {name: getattr(sg, name) for name in ("atmosphere", "evaluate", "reproduce", "texture", "weather")}
FUNCTIONS = {
    **{name: getattr(sg, name) for name in sg.__all__ if name != "__version__" and name not in GROUPS},
    **{f"{group}.{name}": getattr(module, name) for group, module in GROUPS.items() for name in module.__all__},
}


def test_every_name_is_there_and_documented() -> None:
    assert set(sg.__all__) <= set(dir(sg))
    for name, function in FUNCTIONS.items():
        assert inspect.isfunction(function), name
        assert "Examples" in function.__doc__
        parameters = inspect.signature(function).parameters
        assert not {p.kind for p in parameters.values()} & {inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD}
        assert all(p.annotation is not inspect.Parameter.empty for p in parameters.values())
        # the text names every parameter
        described = function.__doc__.partition("    Parameters\n")[2].partition("    Returns\n")[0]
        assert [p for p in parameters if not re.search(rf"\b{p}\b", described)] == []
    with pytest.raises(AttributeError, match=r"'rendering'; it has .*render"):
        sg.rendering  # noqa: B018


REQUESTS = {
    "mean": MeanRequest,
    "render": RenderRequest,
    "sense": SenseRequest,
    "export": ExportRequest,
    "ensemble": EnsembleRequest,
    "dataset": DatasetRequest,
    "analyze": AnalysisRequest,
    "detect": (RecordingRequest, DesignRequest),
}
"""Records from which commands make their options and functions their documentation."""

NAMED = {
    "mean": ("scenario",),
    "render": ("frames", "electrons", "radiance", "threads", "workers", "resume", "overwrite"),
    "sense": ("seed", "oversampling", "electrons", "frame_rate", "overwrite"),
    "export": ("variable", "frames", "dtype", "limits", "colours", "rate", "scale", "overwrite"),
    "ensemble": ("workers", "threads", "resume", "overwrite", "draw_only"),
    "dataset": ("format", "bits", "image", "workers", "threads", "resume", "overwrite"),
    "analyze": ("frame_rate", "units", "variable", "filter", "thresholds", "scope", "rows", "mask", "border", "detectors", "seed"),
    "detect": (
        *("source", "contrast", "detector", "filter", "threshold", "threshold_law", "injections", "object_sigma_px", "psf", "objects"),
        *("frames", "precision", "time_budget", "p_fa", "frame_rate", "units", "variable", "placement", "match_radius", "velocity"),
        *("pointing", "duration", "seed"),
    ),
}
"""Parameters of functions that their requests describe."""

RESOLVED = {"detect": {"frames": 32, "objects": "point"}}
"""Defaults that a signature states, and a request finds where nothing is said."""


@pytest.mark.parametrize("name", REQUESTS)
def test_a_function_takes_what_its_request_describes(name: str) -> None:
    parameters = inspect.signature(getattr(sg, name)).parameters
    records = REQUESTS[name] if isinstance(REQUESTS[name], tuple) else (REQUESTS[name],)
    defaults = {field.name: field.default for record in reversed(records) for field in fields(record)} | RESOLVED.get(name, {})
    shared = parameters.keys() & defaults.keys()
    for key in shared:
        assert parameters[key].default == (inspect.Parameter.empty if defaults[key] is MISSING else defaults[key])
    # what is said of a parameter is said once, in the request
    written = inspect.getsource(getattr(sg, name)).partition('"""')[2].partition("    Returns\n")[0]
    assert "    {request}\n" in written
    assert [key for key in shared if re.search(rf"^    ([a-z_, ]*, )?{key}( :|, )", written, flags=re.MULTILINE)] == []
    assert shared >= set(NAMED[name])


def test_a_scene_is_judged_alike_with_and_without_the_defaults() -> None:
    assert SceneRequest("my.toml").settings == SceneRequest("my.toml", **RESOLVED["detect"]).settings


def test_documentation_lists_the_formats_that_there_are() -> None:
    """Libraries are not loaded for the documentation, which therefore has its own list."""
    plain = " ".join(sg.dataset.__doc__.replace("``", "").split())
    assert f"{dataset_command._formats()}." in plain
    output = sg.export.__doc__.partition("    output : path\n")[2].partition("\n    variable")[0]
    listed = re.findall(r"``(\.\w+)``", output)
    assert listed == [*(ending for form in export_formats.FORMATS for ending in form.endings), *VIDEO_ENDINGS]


def test_scenarios_come_from_files_and_mappings(tmp_path) -> None:
    path = tmp_path / "my.toml"
    path.write_text("[wind]\nspeed_m_s = 9\n")
    assert sg.load(path) == sg.load(str(path)) == sg.load({"wind": {"speed_m_s": 9.0}})
    with pytest.raises(ScenarioError, match=r"wind\.sped_m_s is an unknown key"):
        sg.load({"wind": {"sped_m_s": 9.0}})


def test_mean_is_that_of_the_pipeline_with_units_at_every_variable(still_scene) -> None:
    found, expected = sg.mean(still_scene), pipeline_mean(still_scene)
    for name in expected.data_vars:
        np.testing.assert_array_equal(found[name], expected[name])
        assert found[name].attrs["units"] == ("K" if name == "apparent_temperature" else "W m-2 sr-1")
    assert found.elevation.attrs["units"] == "degree"


def test_the_store_comes_back_opened_and_is_read_frame_by_frame(still_scene, run) -> None:
    assert dict(run.radiance.sizes) == {"time": 4, "y": 40, "x": 32}
    assert set(run.data_vars) >= {"radiance", "apparent_temperature", "glint_radiance"}
    assert not run.radiance.variable._in_memory
    with pytest.raises(DataError, match="exists already"):
        sg.render(still_scene, run.encoding["source"])


@pytest.mark.parametrize("number", [0, 3])
def test_image_is_the_frame_of_its_time(still_scene, run, number: int) -> None:
    found = sg.image(still_scene, time=number / RATE, layers=["range", "glint_radiance"])
    frame = run.isel(time=number)
    for name in ("radiance", "glint_radiance"):
        np.testing.assert_array_equal(found[name], frame[name])
    assert list(found.data_vars) == ["radiance", "glint_radiance", "range"]
    np.testing.assert_array_equal(found.azimuth, frame.azimuth)
    np.testing.assert_array_equal(found.elevation, frame.elevation)
    assert float(found.time) == number / RATE


def test_parts_of_an_image_add_up(still_scene) -> None:
    found = sg.image(still_scene, layers=LAYERS)
    parts = sum(found[name] for name in ("path_radiance", "emitted_radiance", "sky_radiance", "glint_radiance"))
    np.testing.assert_allclose(parts, found.radiance, rtol=1e-6)
    assert bool(np.isnan(found["range"]).equals(found.coverage == 0.0))


def test_image_of_a_turning_sensor_names_the_directions_of_its_time() -> None:
    keyframes = [{"time_s": 0, "azimuth_deg": 170, "east_m": 0}, {"time_s": 2, "azimuth_deg": 190, "east_m": 20}]
    sensor = {"pixels": [8, 6], "frames": 2}
    scene = sg.load({"sensor": sensor, "sea": {"resolve_waves": False}, "platform": {"keyframes": keyframes}})
    first, later = sg.image(scene), sg.image(scene, time=1.0)
    np.testing.assert_allclose(later.azimuth - first.azimuth, 10.0, atol=1e-9)  # half of 20 degrees
    assert float(later.sensor_east) == pytest.approx(10.0)
    with pytest.raises(DomainError, match="keyframes"):
        sg.image(scene, time=3.0)


@pytest.mark.parametrize(
    ("more", "match"), [({"time": float("nan")}, "seconds from the start"), ({"layers": ["rnage"]}, "'rnage' is not one of")]
)
def test_images_that_there_are_not_are_refused(still_scene, more, match: str) -> None:
    with pytest.raises(DomainError, match=match):
        sg.image(still_scene, **more)


def test_apparent_temperature_is_that_of_the_store(run) -> None:
    """Same band, same spectral grid: equal to rounding in single precision."""
    stored = run.apparent_temperature
    for given in (run, run.radiance):
        found = sg.apparent_temperature(given)
        np.testing.assert_array_equal(found, stored)
        assert (found.dtype, found.name, found.attrs["units"]) == (np.float32, "apparent_temperature", "K")
        assert found.attrs["standard_name"] == "brightness_temperature"
        xr.testing.assert_equal(found.azimuth, run.azimuth)
    frame = sg.apparent_temperature(run.radiance.isel(time=2))
    np.testing.assert_array_equal(frame, stored.isel(time=2))
    assert frame.attrs["band_wavelength_um"] == [3.5, 5.0]
    # A blackbody of a known temperature, by another grid.
    grid = np.arange(1990.0, 2870.0, 1.0)
    warm = Band.rectangular(3.5, 5.0).radiance(np.array([[280.0, 300.0]]), grid)
    assert sg.apparent_temperature(warm, (3.5, 5.0)).dims == ("y", "x")
    np.testing.assert_allclose(sg.apparent_temperature(warm, Band.rectangular(3.5, 5.0)), [[280.0, 300.0]], atol=1e-3)


def test_radiance_without_a_band_is_refused(run) -> None:
    for given in (np.ones((2, 2)), run.radiance.drop_attrs()):
        with pytest.raises(DataError, match=r"no band given.*give band=\(min_um, max_um\)"):
            sg.apparent_temperature(given)
    with pytest.raises(DataError, match="no variable 'radiance'"):
        sg.apparent_temperature(run[["frame"]])


def numbers(found: Analysis) -> dict:
    # What made the frames is known of a file of ours alone.
    return {name: value for name, value in found.as_dict().items() if name not in ("source", "blur", "blur_px")}


def test_analysis_is_the_same_of_a_path_a_dataset_a_variable_and_an_array(run) -> None:
    path = run.encoding["source"]
    expected = numbers(run_analysis(open_recording(path)))
    assert expected["frame_rate_hz"] == RATE
    assert numbers(sg.analyze(path)) == expected
    assert numbers(sg.analyze(run)) == expected
    found = numbers(sg.analyze(run.radiance.transpose("y", "x", "time")))
    assert found.pop("frame_rate_hz") == pytest.approx(RATE, rel=1e-12)
    array = numbers(sg.analyze(run.radiance.to_numpy(), frame_rate=RATE, units="W m-2 sr-1"))
    assert array == expected
    given = Recording("mine", 4, 40, 32, lambda a, b: run.radiance[a:b].to_numpy(), RATE, "W m-2 sr-1")
    assert numbers(sg.analyze(given)) == expected


def test_every_other_frame_has_half_the_rate(run) -> None:
    """The attribute still says that of the whole sequence."""
    assert sg.analyze(run.isel(time=slice(None, None, 2))).recording.frame_rate == pytest.approx(0.5 * RATE)
    assert sg.analyze(run.isel(time=slice(None, None, 2)), frame_rate=3.0).recording.frame_rate == 3.0


def test_options_go_by_the_fields_of_the_record(run) -> None:
    mask = run.radiance.isel(time=0) > float(run.radiance.mean())
    seen = []
    found = sg.analyze(
        run, filter="top-hat", thresholds=[4.0], detectors=["ca-cfar"], mask=mask, seed=3, progress=lambda done, total: seen.append(done)
    )
    options = AnalysisOptions()
    assert (found.options.filter.name, found.options.thresholds, found.options.seed) == ("top_hat", (4.0,), 3)
    assert found.options.scope == options.scope
    np.testing.assert_array_equal(found.regions["glint"].mask, mask)
    assert list(found.regions["all"].alarms) == ["top_hat", "ca-cfar"]
    assert seen[-1] == 4


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"scope": "frames"}, "scope = 'frames' is not one of frame, sequence, local"),
        ({"border": "cut"}, "border = 'cut' is not one of auto, keep, drop"),
        ({"filter": "laplace"}, "'laplace' is unknown"),
        ({"variable": "radiance_"}, "no image variable 'radiance_'"),
    ],
)
def test_options_that_there_are_not_are_refused(run, options, match: str) -> None:
    with pytest.raises(DataError, match=match):
        sg.analyze(run, **options)


@pytest.mark.parametrize("resolve", [True, False])
def test_results_can_be_saved_by_xarray(tmp_path, resolve):
    scene = sg.load(
        {"sensor": {"pixels": [8, 4], "frames": 1}, "sea": {"resolve_waves": resolve, "shortest_wave_m": 8}, "render": {"tile_size": 64}}
    )
    for name, dataset in (("mean", sg.mean(scene)), ("image", sg.image(scene)), ("run", sg.render(scene, tmp_path / "run.zarr"))):
        dataset.to_netcdf(tmp_path / f"{name}.nc", engine="h5netcdf")
        assert (tmp_path / f"{name}.nc").exists()
