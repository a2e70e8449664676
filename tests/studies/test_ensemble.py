"""Ensembles: scenes drawn, written, rendered and gone on with."""

import csv
import math
import os
import shutil
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DataError, ScenarioError
from seaglint.cluster import Done, ThisProcess
from seaglint.objects.body import Placement
from seaglint.objects.drawing.eye import stand
from seaglint.scenario.ensemble_file import Ensemble, load_ensemble, parse_ensemble
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.store.sequence_store import Interrupted
from seaglint.studies.build.scenario_physics import imager, track
from seaglint.studies.ensemble import render_ensemble as module
from seaglint.studies.ensemble.ensemble_folder import ensemble_text
from seaglint.studies.ensemble.law_draws import PixelGrid
from seaglint.studies.ensemble.render_ensemble import EnsembleScene, draw, render_ensemble, render_scene
from seaglint.studies.sequence.sensed_sequence import render
from seaglint.studies.sequence.sequence_work import SceneCache

BASE: dict[str, Any] = {
    "sensor": {"height_m": 20, "azimuth_deg": 180, "elevation_deg": -2, "fov_deg": [3.2, 1.6], "pixels": [16, 8], "frames": 1},
    "sea": {"resolve_waves": False},
    "atmosphere": {"source": "none"},
}
WIND = {"key": "wind.speed_m_s", "law": "uniform", "min": 2, "max": 12}
SUN = {"key": "sun.zenith_deg", "law": "normal", "mean": 65, "standard_deviation": 10, "min": 40, "max": 85}
POINTS = {
    "name": "target",
    "count": {"law": "uniform", "min": 0, "max": 3},
    "column": {"law": "uniform", "min": 1, "max": 15},
    "row": {"law": "uniform", "min": 2, "max": 8},
    "height_m": 2,
    "shape": {"kind": "point", "intensity_w_sr": {"law": "log_uniform", "min": 0.5, "max": 50}},
}


def ensemble(*vary: dict[str, Any], scenes: int = 3, objects: tuple[dict[str, Any], ...] = (), **settings: Any) -> Ensemble:
    raw = {"base": BASE, "ensemble": {"scenes": scenes, **settings}, "vary": list(vary), "objects": list(objects)}
    return parse_ensemble(raw, name="e.toml")


def values(scenes: list[EnsembleScene], key: str) -> list[Any]:
    return [scene.parameters[key] for scene in scenes]


@pytest.mark.parametrize("sampling", ["random", "latin_hypercube"])
def test_a_draw_depends_on_seed_scene_and_key_alone(sampling: str) -> None:
    one = draw(ensemble(WIND, sampling=sampling))
    other = draw(ensemble(SUN, WIND, sampling=sampling, objects=(POINTS,)))
    assert values(one, "wind.speed_m_s") == values(other, "wind.speed_m_s")
    assert [scene.seed for scene in one] == [scene.seed for scene in other]
    assert values(draw(ensemble(WIND, sampling=sampling, seed=2)), "wind.speed_m_s") != values(one, "wind.speed_m_s")
    assert len({scene.seed for scene in one}) == 3


def test_random_scenes_stay_when_more_are_drawn() -> None:
    assert values(draw(ensemble(WIND, SUN, scenes=5))[:3], "sun.zenith_deg") == values(draw(ensemble(WIND, SUN)), "sun.zenith_deg")


@pytest.mark.parametrize("sampling", ["latin_hypercube", "sobol"])
def test_draws_are_spread_evenly(sampling: str) -> None:
    found = np.array(values(draw(ensemble(SUN, WIND, scenes=16, sampling=sampling)), "wind.speed_m_s"))
    # one in each sixteenth of 2 to 12 m/s
    assert sorted(np.floor((found - 2.0) / 10.0 * 16.0).astype(int)) == list(range(16))


def test_values_reach_the_scenario() -> None:
    scenes = draw(ensemble(WIND, {"key": "sensor.fov_deg.0", "law": "choice", "values": [3.2, 3.4]}, frames=4, scenes=8))
    for scene in scenes:
        assert scene.scenario.wind.speed_m_s == scene.parameters["wind.speed_m_s"] == scene.row["wind.speed_m_s"]
        assert scene.scenario.sensor.fov_deg == (scene.parameters["sensor.fov_deg.0"], 1.6)
        assert (scene.scenario.sensor.frames, scene.scenario.seed) == (4, scene.row["seed"])
    assert {s.scenario.sensor.fov_deg[0] for s in scenes} == {3.2, 3.4}
    assert BASE["sensor"]["fov_deg"] == [3.2, 1.6]


def test_a_table_that_is_drawn_is_not_changed_by_a_law_of_a_key_in_it() -> None:
    whole = {"key": "wind", "law": "choice", "values": [{"speed_m_s": 3}]}
    speed = {"key": "wind.speed_m_s", "law": "uniform", "min": 5, "max": 9}
    found = draw(ensemble(whole, speed))
    assert [scene.parameters["wind"] for scene in found] == 3 * [{"speed_m_s": 3}]
    assert all(scene.scenario.wind.speed_m_s == scene.parameters["wind.speed_m_s"] >= 5 for scene in found)
    with pytest.raises(ScenarioError, match=r"= 'wind' would replace what was drawn for wind.speed_m_s; put it before that law"):
        ensemble(speed, whole)


def test_rows_of_weather_are_drawn_whole(tmp_path: Path) -> None:
    (tmp_path / "w.csv").write_text(
        "wind_speed_m_s,wind_from_deg,cloud_cover,sea_temperature_k,weight\n4,90,0,280,1\n8,180,0,290,3\n18,270,0,300,9\n"
    )
    law = {"law": "weather", "table": str(tmp_path / "w.csv"), "max_wind_m_s": 15}
    law["columns"] = ["wind_speed_m_s", "wind_from_deg", "sea_temperature_k"]
    scenes = draw(ensemble(law, scenes=40, sampling="latin_hypercube"))
    found = [(s.scenario.wind.speed_m_s, s.scenario.wind.from_deg, s.scenario.sea.temperature_k) for s in scenes]
    # weights 1 to 3; the strongest wind is left out
    assert {row: found.count(row) for row in set(found)} == {(4.0, 90.0, 280.0): 10, (8.0, 180.0, 290.0): 30}
    with pytest.raises(ScenarioError, match="no column significant_height_m"):
        draw(ensemble({**law, "columns": ["significant_height_m"]}))


def test_the_packaged_weather_has_no_direction_which_is_drawn() -> None:
    scenes = draw(ensemble({"law": "weather", "max_wind_m_s": 20}, scenes=30))
    directions = values(scenes, "wind.from_deg")
    assert len(set(directions)) == 30
    assert 0 <= min(directions) < 90 < 270 < max(directions) <= 360


@pytest.mark.parametrize(
    ("law", "text"),
    [
        ({**WIND, "max": 24, "min": 21}, "e.toml, scene 0: wind.speed_m_s = 2"),
        (
            {**WIND, "key": "wind.sped_m_s"},
            "scene 0: wind.sped_m_s is an unknown key; did you mean wind.speed_m_s? (drawn: wind.sped_m_s = ",
        ),
        ({**WIND, "key": "wind.sped_m_s", "max": "9 kn"}, "did you mean wind.speed_m_s?"),
        ({**WIND, "key": "wind.speed_m_s.x"}, "e.toml, scene 0: wind.speed_m_s = "),
        ({**WIND, "key": "objects.ferry.heading_deg"}, "e.toml, scene 0: objects"),
        ({"key": "atmosphere.visibility_km", "law": "uniform", "min": 5, "max": 9}, "does not go with this source of atmosphere"),
        ({**WIND, "min": 5, "max": 2}, "e.toml: vary[0] (wind.speed_m_s): min = 5 is above max = 2"),
    ],
)
def test_laws_that_do_not_go_are_one_line(law: dict[str, Any], text: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        draw(ensemble(law))
    assert text in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_draw_that_leaves_the_range_is_named_with_its_scene() -> None:
    wide = {"key": "sea.temperature_k", "law": "uniform", "min": 262, "max": 322}
    with pytest.raises(ScenarioError, match=r"e\.toml, scene \d+: sea\.temperature_k = 32[0-2]\.\d+ is outside the allowed range"):
        draw(ensemble(wide, scenes=200))


def test_objects_stand_where_their_pixels_are_and_apart() -> None:
    scenes = draw(ensemble(WIND, scenes=30, objects=({**POINTS, "apart_px": 2},)))
    counts = values(scenes, "objects.target.count")
    assert set(counts) == {0, 1, 2, 3}
    assert [len(scene.objects) for scene in scenes] == counts == [len(scene.scenario.objects or ()) for scene in scenes]
    intensities = [item["shape"]["intensity_w_sr"] for scene in scenes for item in scene.objects]
    assert 0.5 <= min(intensities) < 2 < 12 < max(intensities) <= 50
    for scene in scenes:
        places = [pixel_of(scene, item) for item in scene.objects]
        assert all(1 <= column <= 15 and 2 <= row <= 8 for column, row in places)
        assert all(math.dist(a, b) >= 2 - 1e-6 for i, a in enumerate(places) for b in places[:i])


def pixel_of(scene: EnsembleScene, item: dict[str, Any]) -> tuple[float, float]:
    """Where the renderer's own geometry has an object."""
    pose = track(scene.scenario).at(0.0)
    at = stand(Placement(np.array([item["east_m"], item["north_m"], item["height_m"]]), np.eye(3)), pose).place
    azimuth, elevation = math.degrees(math.atan2(at[0], at[1])) % 360, math.degrees(math.asin(at[2] / np.linalg.norm(at)))
    (width, height), (nx, ny) = scene.scenario.sensor.fov_deg, scene.scenario.sensor.pixels
    return (azimuth - 180 + width / 2) / width * nx, (-2 + height / 2 - elevation) / height * ny


@pytest.mark.parametrize(
    ("row", "given"), [(6.0, {"height": 3.0}), (3.0, {"range_m": 400.0}), (1.0, {"range_m": 4000.0}), (0.5, {"height": 30.0})]
)
def test_places_are_on_the_line_of_sight(row: float, given: dict[str, float]) -> None:
    scenario = parse_scenario({**BASE, "sensor": {**BASE["sensor"], "elevation_deg": -2 if row > 1 else 2}})
    east, north, height = PixelGrid(scenario).place(11.0, row, **given)
    assert given.get("height", height) == height
    assert given.get("range_m", math.hypot(east, north)) == pytest.approx(math.hypot(east, north), rel=1e-12)
    place = stand(Placement(np.array([east, north, height]), np.eye(3)), track(scenario).at(0.0)).place
    sight = imager(scenario).directions(track(scenario).at(0.0).attitude, 11.0, row)
    assert place / np.linalg.norm(place) == pytest.approx(sight, abs=1e-9)
    assert height < EFFECTIVE_EARTH_RADIUS


def test_lines_of_sight_that_do_not_come_there() -> None:
    scenario = parse_scenario({**BASE, "sensor": {**BASE["sensor"], "elevation_deg": -0.5}})
    with pytest.raises(ScenarioError, match="never comes to height_m = 1 from 20 m"):
        PixelGrid(scenario).place(3.0, 0.0, height=1.0)
    with pytest.raises(ScenarioError, match="under the sea at range_m = 9000"):
        PixelGrid(scenario).place(3.0, 8.0, range_m=9000.0)
    crowd = {**POINTS, "count": 40, "apart_px": 5}
    with pytest.raises(ScenarioError, match=r"e\.toml, scene 0: objects \('target-\d+'\): no place 5 px from the others"):
        draw(ensemble(objects=(crowd,)))


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("ensemble") / "run"
    told: list[tuple[int, int]] = []
    render_ensemble(drawn(), folder, progress=lambda *done: told.append(done))
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]
    return folder


def drawn() -> Ensemble:
    return ensemble(WIND, SUN, objects=(POINTS,), seed=5)


def pixels(store: Path) -> dict[str, bytes]:
    """Content of a store by file, without the metadata, in which the date is."""
    return {str(path.relative_to(store)): path.read_bytes() for path in sorted(store.rglob("*")) if path.is_file() and "/c/" in str(path)}


def test_a_folder_holds_scenes_and_tables(rendered: Path) -> None:
    scenes = draw(drawn())
    assert sorted(path.name for path in (rendered / "scenes").iterdir()) == [f"000{i}.{e}" for i in range(3) for e in ("toml", "zarr")]
    with (rendered / "parameters.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["scene", "seed", "wind.speed_m_s", "sun.zenith_deg", "objects.target.count"]
    for row, scene in zip(rows, scenes, strict=True):
        assert {name: float(value) for name, value in row.items()} == pytest.approx(
            {k: float(v) for k, v in scene.row.items()}, rel=0, abs=0
        )
        told = load_scenario(rendered / "scenes" / f"{scene.label}.toml")
        assert told == scene.scenario
    with (rendered / "objects.csv").open(newline="") as file:
        assert len(list(csv.DictReader(file))) == sum(len(scene.objects) for scene in scenes) > 0
    parquet = pytest.importorskip("pyarrow.parquet")
    assert parquet.read_table(rendered / "parameters.parquet").column("wind.speed_m_s").to_pylist() == values(scenes, "wind.speed_m_s")


def test_a_scene_alone_has_the_same_bytes(rendered: Path, tmp_path: Path) -> None:
    shutil.copy(rendered / "scenes" / "0002.toml", tmp_path / "alone.toml")
    render(load_scenario(tmp_path / "alone.toml"), tmp_path / "alone.zarr")
    assert pixels(tmp_path / "alone.zarr") == pixels(rendered / "scenes" / "0002.zarr") != {}
    one, other = (zarr.open_group(path, mode="r").attrs.asdict() for path in (tmp_path / "alone.zarr", rendered / "scenes" / "0002.zarr"))
    assert {k: v for k, v in one.items() if k != "history"} == {k: v for k, v in other.items() if k != "history"}


def test_the_ensemble_in_the_folder_draws_the_same(rendered: Path) -> None:
    assert [scene.text for scene in draw(load_ensemble(rendered / "ensemble.toml"))] == [scene.text for scene in draw(drawn())]


def test_resume_does_what_is_missing_and_nothing_else(rendered: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(rendered, folder)
    shutil.rmtree(folder / "scenes" / "0001.zarr")
    units: list[str] = []

    class Counted(ThisProcess):
        def map(self, job: Any, wanted: Any) -> Any:
            units.extend(wanted)
            return super().map(job, units)

    render_ensemble(drawn(), folder, resume=True, workers=Counted())
    assert units == ["0001"]
    assert pixels(folder / "scenes" / "0001.zarr") == pixels(rendered / "scenes" / "0001.zarr")


@pytest.mark.parametrize(
    ("other", "text"),
    [
        (ensemble(WIND, SUN, objects=(POINTS,), seed=6), "another ensemble.seed;"),
        (ensemble({**WIND, "max": 11}, SUN, objects=(POINTS,), seed=5), r"another vary\[0\].max;"),
        (ensemble(WIND, SUN, objects=({**POINTS, "height_m": 3},), seed=5), r"another objects\[0\].height_m;"),
    ],
)
def test_another_ensemble_is_told_by_its_keys(rendered: Path, other: Ensemble, text: str) -> None:
    with pytest.raises(DataError, match=text):
        render_ensemble(other, rendered, resume=True)


def test_what_stands_there_is_not_lost(rendered: Path, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="holds an ensemble already; continue it with resume"):
        render_ensemble(drawn(), rendered)
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(DataError, match="is not empty and holds no ensemble"):
        render_ensemble(drawn(), tmp_path, overwrite=True)
    (tmp_path / "new").mkdir()
    (tmp_path / "new" / "ensemble.toml.partial").write_text("[ens")  # of a process that was killed
    render_ensemble(drawn(), tmp_path / "new", draw_only=True)
    (tmp_path / "new" / "mine.txt").write_text("mine")
    render_ensemble(ensemble(WIND), tmp_path / "new", overwrite=True, draw_only=True)
    left = sorted(path.name for path in (tmp_path / "new").iterdir() if path.suffix != ".parquet")
    assert left == ["ensemble.toml", "mine.txt", "parameters.csv", "scenes"]
    assert "objects" not in ensemble_text(ensemble(WIND))


def test_scenes_that_fail_are_named_while_the_rest_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails_once(scenario: Any, output: Path, *options: Any) -> None:
        if output.name == "0001.zarr":
            raise RuntimeError("no luck")
        output.mkdir()

    with monkeypatch.context() as patched:
        patched.setattr(module, "render_scene", fails_once)
        with pytest.raises(DataError, match=r"1 of 3 scenes failed, the others are there; scene 0001: RuntimeError: no luck; trace"):
            render_ensemble(ensemble(WIND), tmp_path / "run")
    assert (tmp_path / "run" / "scenes" / "0002.zarr").is_dir()
    assert "fails_once" in (tmp_path / "run" / "failures" / "0001.txt").read_text()
    render_ensemble(ensemble(WIND), tmp_path / "run", resume=True)
    assert not (tmp_path / "run" / "failures" / "0001.txt").exists()


def test_a_request_to_stop_leaves_what_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(scenario: Any, output: Path, *options: Any) -> None:
        if output.name == "0001.zarr":
            raise Interrupted("between two frames")
        output.mkdir()

    monkeypatch.setattr(module, "render_scene", stopped)
    with pytest.raises(Interrupted, match=r"stopped after 1 of 3 scenes, kept in .*run; run the same again with resume"):
        render_ensemble(ensemble(WIND), tmp_path / "run")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_does_not_wait_for_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    class Slow(ThisProcess):
        @contextmanager
        def map(self, job: Any, units: Any) -> Iterator[Any]:
            def outcomes() -> Iterator[Any]:
                yield Done(units[0], job.start(job.settings)(units[0]), 0.0, "slow")
                os.kill(os.getpid(), number)
                raise AssertionError("waited")

            yield outcomes()

    with pytest.raises(Interrupted, match=r"stopped after 1 of 3 scenes"):
        render_ensemble(ensemble(WIND), tmp_path / "run", workers=Slow())


def test_scenes_that_share_have_the_same_bytes(tmp_path: Path) -> None:
    """Waves, objects and a seed of their own, after another scene was made ready."""
    base = {**BASE, "sea": {"resolve_waves": True}}
    scenes = draw(parse_ensemble({"base": base, "ensemble": {"scenes": 2}, "objects": [POINTS | {"count": 2}]}))
    kept = SceneCache()
    for scene in scenes:
        render_scene(scene.scenario, tmp_path / f"{scene.label}.zarr", 1, kept)
    render(scenes[1].scenario, tmp_path / "alone.zarr", threads=1)
    assert pixels(tmp_path / "alone.zarr") == pixels(tmp_path / "0001.zarr") != pixels(tmp_path / "0000.zarr")
    one, other = (zarr.open_group(tmp_path / name, mode="r").attrs.asdict() for name in ("alone.zarr", "0001.zarr"))
    assert {k: v for k, v in one.items() if k != "history"} == {k: v for k, v in other.items() if k != "history"}


@pytest.mark.validation
def test_a_thousand_scenes_are_drawn_and_checked() -> None:
    found = draw(ensemble(WIND, SUN, scenes=1000, sampling="latin_hypercube", objects=(POINTS | {"apart_px": 1},)))
    assert len({scene.scenario.model_dump_json() for scene in found}) == 1000


@pytest.mark.validation
def test_memory_stays_over_many_small_scenes(tmp_path: Path) -> None:
    """64 x 64 pixels, one frame: after the first ten."""
    psutil = pytest.importorskip("psutil")
    sensor = {**BASE["sensor"], "pixels": [64, 64], "fov_deg": [3.2, 3.2]}
    turn = {"key": "wind.from_deg", "law": "uniform", "min": 0, "max": 360}
    raw = {"base": {"sensor": sensor}, "ensemble": {"scenes": 42}, "vary": [WIND, SUN, turn], "objects": [POINTS]}
    used: list[int] = []

    def note(*_: int) -> None:
        used.append(psutil.Process().memory_info().rss)

    render_ensemble(parse_ensemble(raw), tmp_path / "run", threads=1, progress=note)
    grown = (used[-1] - used[12]) / 2**20
    print(f"{used[-1] / 2**20:.0f} MiB, of which {grown:.0f} grew over the last 30 scenes")
    assert grown < 60.0
