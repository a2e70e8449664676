"""Figures 2, 3 and 4 of the article: what its text says of them, and numbers by other routes."""

from __future__ import annotations

import csv

import numpy as np
import pytest
import xarray as xr

from seaglint.formats.tables.table_text import write_columns
from seaglint.optics.band import ApparentTemperature, Band
from seaglint.plot.article_figures import smooth_rows, write_figure
from seaglint.studies.article import figures


@pytest.fixture(scope="module")
def paths():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figures, "PATH_WINDS", (2.0, 14.0))
        return figures.figure_2()


@pytest.fixture(scope="module")
def images():
    """Two winds, detectors of 10 mrad."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figures, "IMAGE_WINDS", (5.0, 10.0))
        patch.setattr(figures, "IMAGE_IFOV", 10e-3)
        return figures.figure_4()


def test_wind_lifts_aerosol_and_the_path_turns_opaque(paths):
    transmittance, path = paths["transmittance"].to_numpy(), paths["path_radiance_W_m2_sr"].to_numpy()
    assert np.all(np.diff(transmittance, axis=1) < 0.0)
    assert np.all(transmittance[1] < transmittance[0])
    assert np.all(path[1] > path[0])
    # "Path radiance approaches the blackbody limit": the air at the sea is 294.2 K in this model atmosphere, colder above.
    band = Band.rectangular(3.0, 5.0)
    limit = ApparentTemperature.create(band, np.arange(2000.0, 3335.1, 5.0))(path[:, -1])
    assert np.all((limit > 292.4) & (limit < 294.2))


def test_sky_and_sun_change_towards_the_horizon_as_the_caption_says(paths):
    sun, sky = paths["solar_irradiance_W_m2"].to_numpy(), paths["sky_radiance_W_m2_sr"].to_numpy()
    assert np.all(np.diff(sun, axis=1) <= 0.0)
    assert np.all(np.diff(sky, axis=1) > 0.0)
    assert np.all(sun[1] < sun[0])
    # Along the horizon the sky is a blackbody of the article's 292.4 K within 2 % (0.5 K).
    np.testing.assert_allclose(sky[:, -1], paths.attrs["blackbody_radiance_W_m2_sr"], rtol=0.02)


def test_boundary_radiance_is_the_sea_close_by_and_the_air_far_off(paths):
    boundary, path = paths["boundary_radiance_W_m2_sr"].to_numpy(), paths["path_radiance_W_m2_sr"].to_numpy()
    sea = float(Band.rectangular(3.0, 5.0).radiance(288.15, np.arange(2000.0, 3335.1, 5.0)))
    assert np.all((boundary > path) & (boundary > sea))  # the air is warmer than the sea
    assert np.all(boundary[:, 0] < 1.08 * sea)
    np.testing.assert_allclose(boundary[1, -1], path[1, -1], rtol=1e-3)


def test_brightest_points_move_as_the_text_says():
    """'With the Sun above the specular direction', 'shifted toward the observer as wind speed increases': coarse grid of Fig. 3."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figures, "SURFACE_WINDS", (1.0, 10.0))
        patch.setattr(figures, "SURFACE_SUNS", np.arange(72.0, 90.0, 2.0))
        patch.setattr(figures, "SURFACE_DEPRESSIONS", 40)
        found = figures.figure_3()
    temperature = found["apparent_temperature_k"]
    peaks = [wind.where(wind == wind.max(), drop=True) for wind in temperature]
    sun, sensor = ([float(peak[name][0]) for peak in peaks] for name in ("solar_zenith_deg", "sensor_zenith_deg"))
    assert sun[0] < sensor[0]
    assert sun[1] < sensor[1] < sensor[0]
    rise = float((temperature - found["background_temperature_k"]).max(("solar_zenith_deg", "sensor_zenith_deg"))[1])
    assert 64.0 < rise < 68.0  # 66-68 K in the independent calculation, less what a grid of 2 deg misses
    with_means = float(found["solar_radiance_W_m2_sr_band_means"][1].max() / found["solar_radiance_W_m2_sr"][1].max())
    assert 1.0 / 2.1 < with_means < 1.0 / 1.1  # lines that Sun and path have in common


def test_winds_along_and_across_the_sun_give_symmetric_images_and_one_between_does_not(images):
    mean = images["solar_radiance_W_m2_sr"].to_numpy()
    for direction in (0, 2):
        np.testing.assert_allclose(mean[:, direction], mean[:, direction, :, ::-1], rtol=1e-4, atol=1e-9)
    oblique = mean[1, 1]
    assert np.max(np.abs(oblique - oblique[:, ::-1])) > 0.02 * oblique.max()


def test_corridor_is_wider_across_a_wind_that_blows_along_the_line_of_glint(images):
    """Slopes are larger along the wind: from the side, the wind widens the corridor (10 m/s, rms width at 10 deg depression)."""
    row = images.sel(wind_speed_m_s=10.0).sel(elevation_deg=-10.0, method="nearest")["solar_radiance_W_m2_sr"]
    azimuth = row["azimuth_from_sun_deg"]
    width = np.sqrt((row * azimuth**2).sum("azimuth_from_sun_deg") / row.sum("azimuth_from_sun_deg"))
    assert float(width.sel(wind_from_sun_deg=90.0)) > 1.05 * float(width.sel(wind_from_sun_deg=0.0))


def test_standard_deviation_is_eq_18_with_the_share_of_sea_area(images):
    # One pixel by hand: sigma^2 = mean^2 l^2 / (A P_h S), looking towards the Sun, wind along the line of sight.
    column = int(np.argmin(np.abs(images["azimuth_from_sun_deg"].to_numpy())))
    pixel = (
        images.sel(wind_speed_m_s=10.0, wind_from_sun_deg=0.0).isel(azimuth_from_sun_deg=column).sel(elevation_deg=-20.0, method="nearest")
    )
    depression, sun, eps = np.radians(-float(pixel["elevation_deg"])), np.radians(65.0), 4.65e-3
    theta = 0.5 * np.pi - depression  # 100 m high, 290 m away: the Earth's curvature is nothing
    half, beta = 0.5 * (theta + sun), 0.5 * (sun - theta)
    up, across = 0.00316 * 10.0, 0.003 + 0.00192 * 10.0
    density = np.exp(-0.5 * np.tan(beta) ** 2 / up) / (2.0 * np.pi * np.sqrt(up * across))
    sea_share = np.pi * eps**2 * density / (4.0 * np.cos(half) * np.cos(beta) ** 3)  # S is 1 within 1e-3 at 20 deg depression
    distance = 100.0 / np.sin(depression)
    area = 1e-4 * np.cos(depression) * distance**2 / np.cos(theta)
    expected = 2.098e-3 / np.sqrt(area * sea_share)
    # The nearest column is up to 0.3 deg off the Sun: 1 % of the density; P itself 1 %.
    assert float(pixel["glint_std_W_m2_sr"] / pixel["solar_radiance_W_m2_sr"]) == pytest.approx(expected, rel=0.02)


def test_table_spreads_coordinates_and_leaves_blanks(tmp_path):
    dataset = xr.Dataset(
        {"a": (("x", "y"), [[1.0, 2.0], [3.0, 4.0]]), "b": ("x", [5.0, 6.0]), "c": ("z", [7.0])},
        coords={"x": [10.0, 20.0], "y": [0.1, 0.2], "z": [9.0], "twice_y": ("y", [0.2, 0.4])},
    )
    output = write_columns(figures.table("any", dataset), tmp_path / "t.csv")
    with output.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows[2] == {"x": "20", "y": "0.1", "z": "", "twice_y": "0.2", "a": "3", "b": "6", "c": ""}
    assert rows[4] == {"x": "", "y": "", "z": "9", "twice_y": "", "a": "", "b": "", "c": "7"}
    assert len(rows) == 5


@pytest.mark.validation
@pytest.mark.parametrize(("name", "made"), [("fig2", "paths"), ("fig4", "images")])
def test_equal_numbers_draw_equal_bytes(name, made, request, tmp_path):
    dataset = request.getfixturevalue(made)
    first, second = (write_figure(name, dataset, tmp_path / f"{i}.png").read_bytes() for i in (1, 2))
    assert first.startswith(b"\x89PNG")
    assert first == second
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1.png", "2.png"]


def test_rows_between_the_suns_of_figure_3_bend_everywhere_and_not_at_the_suns():
    """Rows 1 deg apart of a curve like the mirrored Sun's logarithm: straight lines between them are bent at the nodes, seen as stripes."""
    sun = np.concatenate([np.arange(70.0, 80.0, 1.0), np.arange(80.0, 90.01, 0.5)])
    coarse = -0.01 * (sun - 79.0)[:, None] ** 2 * np.ones(3)
    fine, values = smooth_rows(sun, coarse)
    np.testing.assert_allclose(values[np.isin(fine, sun)], coarse, atol=1e-12)
    rising = (fine > 71.0) & (fine < 78.0)
    bend = np.abs(np.diff(values[rising, 0], 2))
    straight = np.abs(np.diff(np.interp(fine, sun, coarse[:, 0])[rising], 2))
    assert bend.max() < 0.25 * straight.max()
