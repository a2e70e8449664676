"""Sequences over local processes, a Dask cluster in another working directory, and shares: the same files each time."""

from __future__ import annotations

import os
import pickle
import sys
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from seaglint.cluster import LocalProcesses
from seaglint.cluster.dask import connected
from seaglint.cluster.job import outgoing
from seaglint.formats.recording import open_recording
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.store.sequence_store import finish_sequence
from seaglint.store.writers import Share
from seaglint.studies.sequence.render_sequence import render
from seaglint.studies.sequence.sense import Reopen, sense
from seaglint.studies.study_requests import ReadingRequest

TOML = """
[sensor.optics]
aperture_m = 0.05
f_number = 2.0
[sensor.detector]
pitch_um = 15
quantum_efficiency_file = "efficiency.csv"
"""


def files(store: Path) -> dict[str, str]:
    found = sorted(path for path in store.rglob("*") if path.is_file())
    return {str(path.relative_to(store)): sha256(path.read_bytes()).hexdigest() for path in found}


@pytest.fixture(scope="module")
def three(tmp_path_factory):
    """Dask workers that stand in another folder."""
    dask, distributed = pytest.importorskip("dask"), pytest.importorskip("distributed")
    path = os.pathsep.join(os.path.abspath(p) for p in sys.path)
    elsewhere = str(tmp_path_factory.mktemp("elsewhere"))
    with (
        dask.config.set({"distributed.nanny.environ.PYTHONPATH": path}),
        distributed.LocalCluster(
            processes=True, n_workers=3, threads_per_worker=1, dashboard_address=None, silence_logs="CRITICAL"
        ) as cluster,
    ):
        with distributed.Client(cluster.scheduler_address, set_as_default=False) as client:
            client.run(os.chdir, elsewhere)
        with connected(cluster.scheduler_address) as workers:
            yield workers


@pytest.mark.validation
def test_frames_of_a_scene(three, tmp_path):
    scene = parse_scenario({"seed": 4, "sensor": {"pixels": [16, 8], "fov_deg": [2.0, 1.0], "elevation_deg": -3.0, "frames": 7}})
    whole = files(render(scene, tmp_path / "one.zarr"))
    assert files(render(scene, tmp_path / "dask.zarr", workers=three)) == whole
    with LocalProcesses(2, threads=1) as two:
        assert files(render(scene, tmp_path / "two.zarr", workers=two)) == whole
        for index in (1, 0):
            render(scene, tmp_path / "shares.zarr", share=Share(index, 2), workers=two)
    finish_sequence(tmp_path / "shares.zarr")
    assert files(tmp_path / "shares.zarr") == whole


@pytest.mark.validation
def test_counts_of_a_recording_named_from_the_working_directory(three, tmp_path, monkeypatch):
    (tmp_path / "efficiency.csv").write_text("wavelength_um,response\n3.0,0.4\n6.0,0.8\n")
    (tmp_path / "scene.toml").write_text(TOML)
    np.save(tmp_path / "in.npy", 1.5 + 0.2 * np.random.default_rng(1).random((5, 12, 20)))
    monkeypatch.chdir(tmp_path)
    scene, name, reading = load_scenario("scene.toml"), Path("in.npy"), ReadingRequest(frame_rate=25.0)

    def counts(output: str, **more: object) -> Path:
        return Path(sense(open_recording(name, frame_rate=25.0), scene, output, reopen=Reopen(name, reading), **more))  # type: ignore[arg-type]

    whole = files(counts("one.zarr"))
    assert len([path for path in whole if path.startswith("signal/c/")]) == 5
    assert files(counts("dask.zarr", workers=three)) == whole
    with LocalProcesses(2, threads=1) as two:
        assert files(counts("two.zarr", workers=two)) == whole
    for index in (1, 0):
        counts("shares.zarr", share=Share(index, 2))
    finish_sequence("shares.zarr")
    assert files(Path("shares.zarr")) == whole


def test_paths_are_sent_whole(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "efficiency.csv").write_text("wavelength_um,response\n3.0,0.4\n6.0,0.8\n")
    (tmp_path / "scene.toml").write_text(TOML)
    monkeypatch.chdir(tmp_path.parent)
    scene = load_scenario(f"{tmp_path.name}/scene.toml")
    assert not scene.sensor.detector.quantum_efficiency_file.is_absolute()
    found, file = pickle.loads(outgoing((scene, Reopen(Path("in.npy")))))
    assert found.sensor.detector.quantum_efficiency_file == tmp_path / "efficiency.csv"
    assert file.path == tmp_path.parent / "in.npy"
