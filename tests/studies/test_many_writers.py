"""A rendered sequence is the same files whoever makes it: this process, workers, shares."""

from __future__ import annotations

import shutil
from hashlib import sha256
from pathlib import Path

import pytest

from seaglint.cluster import LocalProcesses, ThisProcess
from seaglint.scenario.load import parse_scenario
from seaglint.store.sequence_store import finish_sequence, open_sequence
from seaglint.store.writers import Share
from seaglint.studies.sequence.render_sequence import render
from seaglint.studies.sequence.sensed_sequence import render as render_counts


def small(frames: int, **sensor):
    return parse_scenario({"sensor": {"pixels": [8, 4], "frames": frames, **sensor}, "sea": {"resolve_waves": False}})


def files(store: Path) -> dict[str, str]:
    found = sorted(path for path in store.rglob("*") if path.is_file())
    return {str(path.relative_to(store)): sha256(path.read_bytes()).hexdigest() for path in found}


@pytest.mark.validation
def test_five_frames_by_a_worker_and_in_shares(tmp_path):
    scenario = small(5)
    whole = files(render(scenario, tmp_path / "whole.zarr"))
    assert len([name for name in whole if name.startswith("radiance/c/")]) == 5
    assert files(render(scenario, tmp_path / "worker.zarr", workers=ThisProcess())) == whole
    for index in (1, 0):
        render(scenario, tmp_path / "shares.zarr", share=Share(index, 2))
    assert finish_sequence(tmp_path / "shares.zarr", scenario.model_dump_json(exclude_none=True))
    assert files(tmp_path / "shares.zarr") == whole


@pytest.mark.validation
def test_many_frames_in_a_shard_by_processes_and_shares(tmp_path):
    scenario = small(600)
    whole = files(render(scenario, tmp_path / "whole.zarr"))
    assert len([name for name in whole if name.startswith("radiance/c/")]) == 200  # ceil(600 / 256) = 3 frames in each
    for count in (2, 4):
        with LocalProcesses(count) as workers:
            made = render(scenario, tmp_path / "workers.zarr", workers=workers)
        assert files(made) == whole
        shutil.rmtree(made)
    for index in (1, 0):
        render(scenario, tmp_path / "shares.zarr", share=Share(index, 2))
    finish_sequence(tmp_path / "shares.zarr")
    assert files(tmp_path / "shares.zarr") == whole


@pytest.mark.validation
def test_counts_by_processes(tmp_path):
    tables = {"optics": {"aperture_m": 0.02, "f_number": 2.0}, "detector": {"pitch_um": 15.0}}
    scenario = small(4, **tables)
    whole = files(render_counts(scenario, tmp_path / "whole.zarr", electrons=True))
    with LocalProcesses(2) as workers:
        made = render_counts(scenario, tmp_path / "workers.zarr", electrons=True, workers=workers)
    assert files(made) == whole
    with open_sequence(made) as found:
        assert found["signal"].shape == (4, 4, 8)
