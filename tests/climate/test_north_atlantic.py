"""The region of the climatology in the package: that it is what its tool makes, and that it has the climatology's means."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import build_north_atlantic as made
from seaglint.climate.weather_laws import WIND_CLASSES, class_means, wind_shape
from seaglint.climate.world_weather import DAYS
from seaglint.formats.weather.weather_file import read_weather, shipped

#: Means of an earlier table of the package, estimates of the size of atlases for 40-60 N, 10-50 W (Young 1999; Warren and others 1988).
ESTIMATED_WIND = (11.5, 11.0, 10.5, 9.0, 8.0, 7.5, 7.0, 7.0, 8.5, 9.5, 10.5, 11.0)
ESTIMATED_CLOUD = (0.75, 0.75, 0.75, 0.70, 0.70, 0.70, 0.70, 0.70, 0.70, 0.70, 0.75, 0.75)


def test_the_file_is_what_the_tool_makes(tmp_path: Path) -> None:
    made.main(tmp_path / "north-atlantic.csv")
    assert (tmp_path / "north-atlantic.csv").read_bytes() == shipped("north-atlantic").read_bytes()


def test_every_month_has_the_means_of_the_cells() -> None:
    table, means = read_weather("north-atlantic").table, made.means()
    assert table.months == tuple(range(1, 13))
    for month in range(12):
        part = table.take(table["month"] == month + 1)
        assert part.mean("wind_speed_m_s") == pytest.approx(means.wind_speed_m_s[month], rel=1e-4)
        assert part.mean("cloud_cover") == pytest.approx(means.cloud_cover[month], abs=2e-4)
        assert part.mean("sea_temperature_k") == pytest.approx(means.sea_temperature_k[month], abs=0.006)
        assert table.probability[table["month"] == month + 1].sum() == pytest.approx(DAYS[month] / 365.25, rel=1e-5)


def test_the_means_are_near_independent_estimates() -> None:
    means = made.means()
    np.testing.assert_allclose(means.wind_speed_m_s, ESTIMATED_WIND, atol=0.6)
    np.testing.assert_allclose(means.cloud_cover, ESTIMATED_CLOUD, atol=0.06)


def test_classes_of_wind_are_those_of_a_sampled_weibull_law() -> None:
    """Means of the classes of 400 000 draws, each within five standard errors."""
    shape = float(wind_shape(50.0, 8.0))
    draws = np.sort(np.random.default_rng(4).weibull(shape, 400_000))
    draws *= 8.0 / draws.mean()
    parts = np.split(draws, np.round(np.cumsum(WIND_CLASSES)[:-1] * draws.size).astype(int))
    for part, expected in zip(parts, class_means(8.0, shape), strict=True):
        assert part.mean() == pytest.approx(expected, rel=0.01)


def test_the_notes_say_what_is_estimated() -> None:
    notes = " ".join(read_weather("north-atlantic").notes)
    assert "Esbensen and Kushnir 1981" in notes
    assert "are estimates" in notes
