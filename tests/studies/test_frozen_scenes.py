"""Workers that stop in a scene of an ensemble or data set, or in a sea, and continue after the end, change nothing."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import pytest
from frozen_workers import FreezingWorkers, WakingWorkers, tree

from seaglint.cluster import ThisProcess, Workers
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.store.detection_results import parts_folder
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames, frames_key
from seaglint.studies.ensemble import dataset_scenes
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, EnsembleSource, ensemble_dataset
from seaglint.studies.ensemble.render_ensemble import render_ensemble

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="no SIGSTOP here")

BASE = {
    "sensor": {"height_m": 20, "elevation_deg": -2, "fov_deg": [3.2, 1.6], "pixels": [16, 8]},
    "sea": {"resolve_waves": False},
    "atmosphere": {"source": "none"},
}


def tables(seed: int) -> dict[str, Any]:
    wind = {"key": "wind.speed_m_s", "law": "uniform", "min": 2, "max": 12}
    return {"base": BASE, "ensemble": {"scenes": 3, "frames": 2, "seed": seed}, "vary": [wind]}


def ensemble(output: Path, seed: int, workers: Workers | None, **more: bool) -> None:
    render_ensemble(parse_ensemble(tables(seed)), output, workers=workers, **more)


def data_set(output: Path, seed: int, workers: Workers | None, **more: bool) -> None:
    source = EnsembleSource(parse_ensemble(tables(seed)), "sea", None)
    ensemble_dataset(source, output, DatasetOptions.of("sirst"), workers=workers, **more)


def stores(output: Path, seed: int, workers: Workers | None, **more: bool) -> None:
    source = EnsembleSource(parse_ensemble(tables(seed)), "sea", None)
    ensemble_dataset(source, output, DatasetOptions.of("zarr"), workers=workers, **more)


def seas(output: Path, seed: int, workers: Workers | None, *, overwrite: bool = False) -> None:
    """Seas beside a result, removed when the study ends."""
    scene = parse_scenario({**BASE, "seed": seed})
    with parts_folder(output, overwrite=overwrite) as (parts, _):
        source = SceneFrames(IndependentSeas.of(scene), parts.frames(frames_key(scene, 1)), 1, workers=workers)
        assert source.grow(4) == 4
        parts.remove()


#: Work, and the calls at which a worker stops: while it draws, and after its checks when it writes.
CASES = [
    (ensemble, "seaglint.store.shards:frame_checksum", 2),
    (ensemble, "os:rename", 1),
    (data_set, "seaglint.formats.dataset.dataset_writing:write_picture", 2),
    (data_set, "seaglint.formats.dataset.layouts:write_picture", 1),
    (stores, "seaglint.store.staged_store:_write", 3),
    (seas, "seaglint.studies.detect.scene_frames:IndependentSeas.sea", 1),
    (seas, "numpy:save", 1),
]


@pytest.mark.validation
@pytest.mark.parametrize(("make", "call", "nth"), CASES)
@pytest.mark.parametrize("moment", ["end", "overwrite", "second job"])
def test_a_worker_that_wakes_late_changes_nothing(tmp_path: Path, make: Any, call: str, nth: int, moment: str) -> None:
    for name in ("out", "other", "worker"):
        (tmp_path / name).mkdir()
    with FreezingWorkers(tmp_path / "worker", call, nth, place=1) as workers:
        make(tmp_path / "out" / "made", 1, workers)
        assert workers.stopped is not None
        if moment != "end":
            make(tmp_path / "other" / "made", 2, None)
            team = ThisProcess() if moment == "overwrite" else WakingWorkers(workers.stopped.wake)
            make(tmp_path / "out" / "made", 2, team, overwrite=True)
            assert tree(tmp_path / "out") == tree(tmp_path / "other")
        before = tree(tmp_path / "out")
        assert not [name for name in before if "partial" in name or ".stages" in name or ".lock" in name]
        workers.stopped.wake()
        assert tree(tmp_path / "out") == before


@pytest.mark.validation
def test_long_scenes_of_a_data_set(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dataset_scenes, "MOST_FRAMES", 1)
    for name in ("out", "other", "worker"):
        (tmp_path / name).mkdir()
    data_set(tmp_path / "other" / "made", 1, None)
    with FreezingWorkers(tmp_path / "worker", "seaglint.formats.dataset.dataset_writing:write_picture", 1, place=1) as workers:
        data_set(tmp_path / "out" / "made", 1, workers)
        assert tree(tmp_path / "out") == tree(tmp_path / "other")
        workers.stopped.wake()  # type: ignore[union-attr]
        assert tree(tmp_path / "out") == tree(tmp_path / "other")
