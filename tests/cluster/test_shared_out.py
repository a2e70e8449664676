"""Commands that share their work out: the same bytes whoever does it."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from seaglint.base.errors import BackendError, DataError, DomainError
from seaglint.cli.app import app
from seaglint.cli.terminal.record_options import chosen
from seaglint.cluster import Done, Failed, LocalProcesses
from seaglint.cluster.job import record_of
from seaglint.scenario.load import parse_scenario
from seaglint.store.detection_results import sea_path
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames
from seaglint.studies.likelihood.chance_map import likelihood_map


@pytest.fixture(scope="module")
def two():
    with LocalProcesses(2) as workers:
        yield workers


@pytest.mark.validation
def test_a_map_is_the_same_from_workers(two):
    region = {"latitudes_deg": [0, 60], "longitudes_deg": [-30, -10], "threshold_w_m2_sr": [0.25, 1.0], "months": [3, 6, 9]}
    scene = parse_scenario({"atmosphere": {"source": "none"}, "likelihood": region})
    told: list[tuple[int, int]] = []
    alone = likelihood_map(scene, step=10.0, samples=32)
    shared = likelihood_map(scene, step=10.0, samples=32, workers=two, progress=lambda *done: told.append(done))
    assert float(alone.probability.max()) > 0.0
    assert shared.probability.values.tobytes() == alone.probability.values.tobytes()
    assert shared.observations.equals(alone.observations)
    assert told == [(k, 3) for k in range(4)]


@pytest.mark.validation
def test_seas_of_a_scene_are_the_same_from_workers(two, tmp_path: Path):
    scene = parse_scenario({"seed": 3, "sensor": {"pixels": [16, 8], "fov_deg": [0.4, 0.2], "elevation_deg": -3.0}})
    seas = IndependentSeas.of(scene)
    told: list[int] = []

    def go_on(done: int) -> bool:
        told.append(done)
        return True

    for name, workers in (("alone", None), ("shared", two)):
        (tmp_path / name).mkdir()
        source = SceneFrames(seas, tmp_path / name, 2, workers=workers)
        assert source.grow(1) == 1
        assert source.grow(5, go_on) == 5
    files = [[sea_path(tmp_path / name, k).read_bytes() for k in range(5)] for name in ("alone", "shared")]
    assert files[0] == files[1]
    assert len(set(files[0])) == 5
    assert sorted(told[4:]) == [2, 3, 4]
    sea_path(tmp_path / "shared", 2).unlink()
    again = SceneFrames(seas, tmp_path / "shared", 2, workers=two)
    assert again.grow(5) == 5
    assert sea_path(tmp_path / "shared", 2).read_bytes() == files[0][2]


def test_a_result_that_needs_a_failed_unit_says_so():
    assert record_of(Done(4, "record", 1.0, "here")) == "record"
    with pytest.raises(BackendError, match=r"ValueError: no waves; a unit of the work \(4\) was tried 3 times") as caught:
        record_of(Failed(4, "ValueError: no waves", "where", 3))
    assert caught.value.__notes__ == ["where"]


def test_work_is_shared_out_in_one_way():
    with (
        pytest.raises(DataError, match=r"--workers and --dask-slurm: work is shared out in one way"),
        chosen(2, None, Path("cluster.toml")),
    ):
        pass
    with pytest.raises(DomainError, match="give 1 to 1024"), chosen(5000, None, None):
        pass
    with chosen(None, None, None) as nobody:
        assert nobody is None
    with chosen(2, None, None, threads=3) as processes:
        assert isinstance(processes, LocalProcesses)
        assert (processes.count, processes.threads) == (2, 3)


def test_frames_for_other_machines_need_a_place(tmp_path: Path):
    scene = tmp_path / "scene.toml"
    scene.write_text("[sensor]\npixels = [8, 8]\n")
    found = CliRunner().invoke(app, ["detect", str(scene), "--dask", "tcp://127.0.0.1:9"])
    assert found.exit_code == 2
    assert "give -o RESULT" in found.output
