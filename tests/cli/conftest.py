"""The command line in its own process or in this one, with a stand-in for the slow pipeline."""

from __future__ import annotations

import sys
import types
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from seaglint.cli.app import main
from seaglint.optics.band import Band
from seaglint.scenario.model import Scenario
from seaglint.store.layout import Layout
from seaglint.store.provenance import band_attributes, provenance
from seaglint.store.sequence_store import write_sequence
from seaglint.studies.article.headline import ArticleRow


@dataclass
class Answer:
    """What a command printed and returned."""

    code: int
    out: str
    err: str


@pytest.fixture
def seaglint(capsys, monkeypatch) -> Callable[..., Answer]:
    """Run a command in this process."""

    def run(*arguments: object) -> Answer:
        monkeypatch.setattr(sys, "argv", ["seaglint", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        code = left.value.code
        printed = capsys.readouterr()
        return Answer(code if isinstance(code, int) else 0 if code is None else 1, printed.out, printed.err)

    return run


def _axes(scenario: Scenario) -> tuple[np.ndarray, np.ndarray]:
    (width, height), (nx, ny) = scenario.sensor.fov_deg, scenario.sensor.pixels
    azimuth = scenario.sensor.azimuth_deg - width / 2 + (np.arange(nx) + 0.5) * width / nx
    return azimuth, scenario.sensor.elevation_deg + height / 2 - (np.arange(ny) + 0.5) * height / ny


def _image(scenario: Scenario, number: int) -> np.ndarray:
    nx, ny = scenario.sensor.pixels
    return np.random.default_rng([scenario.seed, number]).gamma(2.0, 0.5, (ny, nx)).astype(np.float32)


def fake_render(scenario, output, *, frames=None, threads=None, resume=False, overwrite=False, progress=None, share=None):
    """Sequence of noise, through the real store."""
    azimuth, elevation = _axes(scenario)
    layout = Layout(
        azimuth, elevation, frames if frames is not None else range(scenario.sensor.frames), scenario.sensor.frame_rate_hz,
        Band.rectangular(3.5, 5.0), attributes=provenance("Noise", scenario.model_dump_json(), scenario.seed),
    )  # fmt: skip
    return write_sequence(
        output, layout, lambda number: {"radiance": _image(scenario, number)}, resume=resume, overwrite=overwrite, progress=progress,
        share=share,
    )  # fmt: skip


def fake_mean(scenario, progress: object = None, *, sea_draws: int | None = None):
    """Map of noise."""
    azimuth, elevation = _axes(scenario)
    attributes = provenance("Noise", scenario.model_dump_json(), scenario.seed, **band_attributes(Band.rectangular(3.5, 5.0)))
    return xr.Dataset(
        {"radiance": (("y", "x"), _image(scenario, 0))}, {"azimuth": ("x", azimuth), "elevation": ("y", elevation)}, attributes
    )


def fake_headline():
    """One row."""
    return {"contrast_mwir": ArticleRow(0.42, 0.4217, "1", {"band": "3-5 um"})}


@pytest.fixture
def pipeline(monkeypatch) -> None:
    """Put the stand-ins where the commands look for the pipeline."""
    for name, function in (
        ("sequence.render_sequence.render", fake_render),
        ("mean.mean_map.mean", fake_mean),
        ("article.headline.headline", fake_headline),
    ):
        room, _, attribute = name.rpartition(".")
        module = types.ModuleType(f"seaglint.studies.{room}")
        setattr(module, attribute, function)
        monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setattr("seaglint.base.kernel_plan.start_helpers", lambda work: 0)


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    """Small scenario file."""
    path = tmp_path / "my.toml"
    path.write_text("[sensor]\nfov_deg = [4, 2]\npixels = [32, 16]\nframes = 4\n")
    return path
