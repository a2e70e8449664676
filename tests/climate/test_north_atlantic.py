"""The table in the package: that it is what its tool makes, and that it has the means that the tool states."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import build_north_atlantic as made
from seaglint.formats.weather.weather_file import read_weather, shipped


def test_the_file_is_what_the_tool_makes(tmp_path: Path) -> None:
    made.main(tmp_path / "north-atlantic.csv")
    assert (tmp_path / "north-atlantic.csv").read_bytes() == shipped("north-atlantic").read_bytes()


def test_every_month_has_the_means_stated() -> None:
    table = read_weather("north-atlantic").table
    assert table.months == tuple(range(1, 13))
    for month in range(12):
        part = table.take(table["month"] == month + 1)
        assert part.mean("wind_speed_m_s") == pytest.approx(made.WIND_MEAN_M_S[month], rel=1e-4)
        # Rounding to eighths moves the mean of a lopsided law by less than a fortieth of a step.
        assert part.mean("cloud_cover") == pytest.approx(made.CLOUD_MEAN[month], abs=0.004)
        assert table.probability[table["month"] == month + 1].sum() == pytest.approx(made.DAYS[month] / 365.25, rel=1e-5)


def test_classes_of_wind_are_those_of_a_sampled_weibull_law() -> None:
    """Means of the classes of 400 000 draws, each within five standard errors."""
    draws = np.sort(np.random.default_rng(4).weibull(made.WIND_SHAPE, 400_000))
    draws *= 8.0 / draws.mean()
    parts = np.split(draws, np.round(np.cumsum(made.CLASSES)[:-1] * draws.size).astype(int))
    for part, expected in zip(parts, made.wind_classes(8.0), strict=True):
        assert part.mean() == pytest.approx(expected, rel=0.01)


def test_the_notes_say_what_is_not_measured() -> None:
    notes = " ".join(read_weather("north-atlantic").notes)
    assert "not a measurement" in notes
    assert "independent within a month, which they are not" in notes
