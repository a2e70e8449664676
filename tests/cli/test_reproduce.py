"""``seaglint reproduce fig2``: picture and numbers, refused where they stand."""

import numpy as np
import pytest
import xarray as xr

from seaglint.plot import article_figures as article
from seaglint.studies.article import figures

DIMS = ("wind_speed_m_s", "solar_zenith_deg", "sensor_zenith_deg")


def _small(report):
    report(0, 1)
    report(1, 1)
    return xr.Dataset({"a": ("x", [1.0, 2.0])}, coords={"x": [0.0, 1.0]})


@pytest.fixture
def small(monkeypatch):
    """A figure of two points in place of Fig. 3."""

    def draw(dataset):
        from matplotlib.figure import Figure

        figure = Figure()
        figure.subplots().plot(dataset["x"].to_numpy(), dataset["a"].to_numpy())
        return figure

    monkeypatch.setitem(figures.FIGURES, "fig3", _small)
    monkeypatch.setitem(article.DRAW, "fig3", draw)


def test_writes_picture_and_numbers_and_refuses_to_do_it_twice(seaglint, small, tmp_path):
    answer = seaglint("reproduce", "fig3", "-o", tmp_path)
    assert answer.code == 0
    assert "fig3.png written" in answer.err
    assert answer.out == ""
    assert (tmp_path / "fig3.csv").read_text() == "x,a\n0,1\n1,2\n"
    again = seaglint("reproduce", "fig3", "-o", tmp_path)
    assert again.code == 2
    assert "exists already" in again.err
    assert "winds" not in again.err  # nothing was computed
    assert seaglint("reproduce", "fig3", "-o", tmp_path, "--overwrite").code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fig3.csv", "fig3.png"]


def test_one_file_that_stands_is_enough_to_refuse(seaglint, small, tmp_path):
    (tmp_path / "fig3.csv").write_text("mine\n")
    assert seaglint("reproduce", "fig3", "-o", tmp_path).code == 2
    assert [path.name for path in tmp_path.iterdir()] == ["fig3.csv"]


def test_a_folder_that_is_not_there_is_made(seaglint, small, tmp_path):
    assert seaglint("reproduce", "fig3", "-o", tmp_path / "new" / "one").code == 0
    assert (tmp_path / "new" / "one" / "fig3.csv").is_file()


def test_a_file_in_the_folders_place_is_named(seaglint, small, tmp_path):
    (tmp_path / "taken").write_text("")
    answer = seaglint("reproduce", "fig3", "-o", tmp_path / "taken")
    assert answer.code != 0
    assert len(answer.err.strip().splitlines()) == 1
    assert "taken" in answer.err


def test_dark_maps_draw_and_equal_numbers_draw_equal_bytes(tmp_path):
    """A Sun that has set leaves a picture, no warning; nothing in the file tells when it was made."""
    dark = np.full((1, 3, 4), 1e-6)
    dark[0, 0] = 1.0
    dataset = xr.Dataset(
        {
            "solar_radiance_W_m2_sr": (DIMS, dark),
            "apparent_temperature_k": (DIMS, 290.0 + 30.0 * dark),
            "background_temperature_k": (("wind_speed_m_s", "sensor_zenith_deg"), np.full((1, 4), 290.0)),
        },
        coords={"wind_speed_m_s": [5.0], "solar_zenith_deg": [70.0, 80.0, 90.0], "sensor_zenith_deg": [80.0, 84.0, 88.0, 90.0]},
        attrs={"band_um": (3.5, 5.0), "sensor_height_m": 100.0, "sea_temperature_k": 288.15, "atmosphere": "air"},
    )
    first, second = (article.write_figure("fig3", dataset, tmp_path / f"{i}.png").read_bytes() for i in (1, 2))
    assert first.startswith(b"\x89PNG")
    assert first == second


@pytest.fixture
def small_table1(monkeypatch):
    """Table 1 from two frames of few pixels."""
    from seaglint.studies.article import table1

    whole = table1.table1
    monkeypatch.setattr(table1, "PIXELS", (96, 32))
    monkeypatch.setattr(table1, "SHORTEST_WAVE", 8.0)
    monkeypatch.setattr(table1, "table1", lambda report: whole(report, frames=2))


@pytest.mark.validation
def test_table_1_is_printed_and_written_once(seaglint, small_table1, tmp_path):
    answer = seaglint("reproduce", "table1", "-o", tmp_path)
    assert answer.code == 0
    assert "rate_glint_3_sigma " in answer.out
    assert "solar_zenith_deg = 60" in answer.out
    assert "frames: 4/4" in answer.err  # with both sparkles
    assert (tmp_path / "table1.csv").read_text().startswith("threshold_sigma,gaussian_rate,glint_article_rate")
    again = seaglint("reproduce", "table1", "-o", tmp_path)
    assert again.code == 2
    assert "exists already" in again.err
    assert "frames" not in again.err  # nothing was rendered
