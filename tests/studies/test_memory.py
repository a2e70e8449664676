"""Memory of mean maps and of ensembles is looked at before the work, and the estimate is that of the work."""

from __future__ import annotations

import tracemalloc

import pytest

from seaglint.base.errors import ScenarioError
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.studies.ensemble.render_ensemble import render_ensemble
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence import memory

WIDEST = {"sensor": {"pixels": [65536, 65536], "fov_deg": [16, 16]}}


def test_a_mean_map_larger_than_any_memory_is_refused_in_a_line():
    with pytest.raises(
        ScenarioError, match=r"^sensor.pixels = \[65536, 65536\] needs about 687.5 GB of memory for a mean map, and .* are free"
    ) as refused:
        mean(parse_scenario(WIDEST))
    assert "\n" not in str(refused.value)


def test_the_pixels_recommended_fit(monkeypatch):
    monkeypatch.setattr(memory, "memory_available", lambda: 2 << 30)
    scenario = parse_scenario({"sensor": {"pixels": [8000, 4000]}})
    with pytest.raises(ScenarioError, match=r"e.g. sensor.pixels = \[4096, 2048\]"):
        memory.require_mean_memory(scenario)
    memory.require_mean_memory(parse_scenario({"sensor": {"pixels": [4096, 2048]}}))


@pytest.mark.parametrize("tables", [{}, {"mean": {"mode": "article"}}], ids=["spectral", "article"])
def test_the_estimate_holds_the_arrays_of_a_map(tables, monkeypatch):
    side = 320
    scenario = parse_scenario(
        {**tables, "atmosphere": {"source": "none"}, "sensor": {"pixels": [side, side], "fov_deg": [8, 8], **tables.get("sensor", {})}}
    )
    mean(parse_scenario({**scenario.model_dump(exclude_none=True, mode="json"), "sensor": {"pixels": [8, 8]}}))  # kernels and tables
    tracemalloc.start()
    mean(scenario)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    each = memory.BYTES_PER_MEAN_PIXEL + memory.BYTES_PER_MEAN_SIGHT[scenario.mean.mode]
    fixed = 60 << 20  # blocks of lines of sight, which do not grow with the picture
    assert peak < each * side**2 + fixed
    assert peak > 0.4 * each * side**2


def test_an_ensemble_is_refused_before_anything_is_written(tmp_path):
    ensemble = parse_ensemble({"ensemble": {"scenes": 3}, "base": WIDEST})
    with pytest.raises(ScenarioError, match="GB of memory"):
        render_ensemble(ensemble, tmp_path / "set")
    assert list(tmp_path.iterdir()) == []
