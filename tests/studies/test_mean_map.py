"""From a scenario to a mean map: the mode chooses the physics, the components add up."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.presets import PRESETS
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence.render_sequence import prepare_sequence

COMPONENTS = ("path_radiance", "emitted_radiance", "sky_radiance", "glint_radiance")
FLOAT32 = 1e-6  # relative: maps are stored in single precision


def mean_map(mode: str, **tables) -> xr.Dataset:
    """A map of 24 x 12 pixels, the horizon at its top."""
    values = {
        "mean": {"mode": mode},
        "sun": {"zenith_deg": 77.0, "azimuth_deg": 180.0},
        "sensor": {"height_m": 100.0, "fov_deg": [12.0, 6.0], "pixels": [24, 12], "elevation_deg": -2.5},
        "wind": {"speed_m_s": 10.0},
        "sea": {"water": "article", "slopes": {"kind": "cox-munk-isotropic"}},
    }
    return mean(parse_scenario(values | tables))


@pytest.mark.parametrize("mode", ["spectral", "article"])
def test_components_add_up_on_both_sides_of_the_horizon(mode):
    found = mean_map(mode)
    assert found.attrs["mean_mode"] == mode
    assert found["radiance"].dims == ("y", "x")
    total = sum(found[name] for name in COMPONENTS)
    np.testing.assert_allclose(total, found["radiance"], rtol=4 * FLOAT32)
    above = found["elevation"] > 0.0
    assert above.any()
    assert (found["glint_radiance"].where(above, drop=True) == 0.0).all()


@pytest.mark.parametrize("mode", ["spectral", "article"])
def test_a_camera_that_looks_up_sees_the_sky_alone(mode):
    found = mean_map(mode, sensor={"height_m": 100.0, "fov_deg": [12.0, 6.0], "pixels": [24, 12], "elevation_deg": 20.0})
    np.testing.assert_allclose(found.radiance, found.sky_radiance, rtol=FLOAT32)
    assert float(found.radiance.min()) > 0.0
    assert float(found.glint_std.max()) == 0.0


def test_the_articles_mode_is_the_articles_case():
    """Its sea without Sun is a blackbody behind the path, its slopes take the wind as given, whatever the scenario's directional model."""
    found = mean_map("article")
    wind_as_given = 0.003 + 0.00512 * 10.0  # Cox and Munk's total for 10 m/s at the height of their fit
    assert found.attrs["mss_up"] + found.attrs["mss_cross"] == pytest.approx(wind_as_given, rel=1e-9)
    below = found["elevation"] < -0.5
    assert (found["sky_radiance"].where(below, drop=True) == 0.0).all()
    other = mean_map("article", sea={"water": "article", "slopes": {"kind": "cox-munk-anisotropic"}})
    xr.testing.assert_equal(found["radiance"], other["radiance"])
    # Band means miss the lines that sunlight and path have in common: 1.1 to 2.1 times (5-95 % of cases in 3-5 um). The wind at
    # 12.5 m instead of 10 m changes the glint by some per cent more. The article's shadowing is that of the viewer's leg.
    spectral = mean_map("spectral", mean={"shadowing": "viewer"})
    ratio = float((spectral["glint_radiance"].where(below) / found["glint_radiance"].where(below)).median())
    assert 1.1 < ratio < 2.2


def test_the_preset_of_the_article_rises_as_its_figure_does():
    """62 K at 10 m/s in the article (its height is not given), 62-63 K with band means from 50 m; less through the long path from 100 m."""
    quiet = {"zenith_deg": 120.0, "azimuth_deg": 180.0}
    maps = [mean(parse_scenario(PRESETS["article-10ms"].values | extra)) for extra in ({}, {"sun": quiet})]
    sunny, dark = (m["apparent_temperature"].where(m["elevation"] < -0.4).max().item() for m in maps)
    assert 50.0 < sunny - dark < 70.0


def test_a_mirror_stays_a_mirror():
    found = mean_map("article", sea={"water": "article", "slopes": {"kind": "flat"}})
    assert found.attrs["mss_up"] == 0.0
    # the Sun at 77 deg is mirrored at 13 deg depression, below this picture
    assert (found["glint_radiance"] == 0.0).all()


@pytest.mark.parametrize("mode", ["spectral", "article"])
def test_one_temperature_is_one_radiance(mode):
    """White furnace, with the scenario's own water: air, sky and sea at 288.15 K."""
    found = mean_map(mode, atmosphere={"source": "isothermal", "temperature_k": 288.15}, sea={"temperature_k": 288.15})
    grid = np.arange(1990.0, 2870.0, 5.0)
    expected = Band.rectangular(3.5, 5.0).radiance(288.15, grid)
    np.testing.assert_allclose(found["radiance"], expected, rtol=1e-5)  # splines of the article's mode, float32
    np.testing.assert_allclose(found["apparent_temperature"], 288.15, atol=1e-3)


def test_the_water_is_the_scenarios():
    """Segelstein's index is lower than Hale and Querry's with salt, so less is mirrored, in the article's mode as well."""
    nu = np.array([2500.0])
    assert sea_water.segelstein().index(nu).real < sea_water.hale_querry_sea().index(nu).real
    maps = [mean_map("article", sea={"water": water})["glint_radiance"].sum().item() for water in ("segelstein", "hale-querry-sea")]
    assert maps[0] < 0.99 * maps[1]


@pytest.mark.parametrize("wind", [0.0, 7.0])
def test_coarse_maps_are_averages_over_their_rows_as_images_are(wind):
    raw = {
        "sensor": {"pixels": [8, 48], "fov_deg": [2, 12], "elevation_deg": -6.6, "frames": 1},
        "sea": {"resolve_waves": False},
        "sun": {"zenith_deg": 70, "azimuth_deg": 180},
        "wind": {"speed_m_s": wind, "from_deg": 180},
    }
    scenario = parse_scenario(raw)
    found = mean(scenario).radiance.to_numpy()
    image = prepare_sequence(scenario).at(0.0).radiance
    # the bound of the image against the model, with slopes along one direction only (no wind) too
    np.testing.assert_allclose(image[2:], found[2:], rtol=5e-3)


@pytest.mark.parametrize("mode", [pytest.param("spectral", marks=pytest.mark.validation), "article"])
def test_glint_of_coarse_pixels_is_that_of_fine_ones_averaged(mode):
    """Cells are independent: the variance of a pixel is the mean of its parts' variances over their number."""
    look, cells = {"height_m": 100.0, "fov_deg": [12.0, 6.0], "elevation_deg": -3.6}, {"glint": {"correlation": "time"}}
    coarse, fine = (mean_map(mode, sensor=look | {"pixels": pixels}, sea=cells) for pixels in ([24, 12], [72, 36]))
    parts = fine["glint_std"].to_numpy().astype(np.float64).reshape(12, 3, 24, 3) ** 2
    # The rows of both are averages over elevation, the columns middles: 1 % of a glitter pattern some degrees wide.
    np.testing.assert_allclose(parts.mean(axis=(1, 3)) / 9.0, coarse["glint_std"].to_numpy().astype(np.float64) ** 2, rtol=0.03)


def test_glint_varies_with_the_area_of_its_cells():
    short, long = (mean_map("spectral", sea={"glint": {"correlation_time_s": t, "dispersion": "article"}}) for t in (0.07, 0.07 * 8.0))
    # Surface tension alone: the length goes as the time to 2/3, the deviation as the length.
    below = short["elevation"] < -1.0
    ratio = long["glint_std"].where(below, drop=True) / short["glint_std"].where(below, drop=True)
    np.testing.assert_allclose(ratio, 4.0, rtol=4 * FLOAT32)
    assert short.attrs["glint_correlation_length_m"] == pytest.approx(2.1e-3, rel=1e-3)
    assert (short["glint_std"].where(short["elevation"] > 0.0, drop=True) == 0.0).all()


def test_maps_with_sparkle_from_the_waves_are_written(tmp_path):
    """The attribute names what replaces the length of cells, and NetCDF takes it."""
    waves = mean_map("spectral", sea={"glint": {"correlation": "waves"}})
    assert waves.attrs["glint_correlation"] == "waves"
    assert "glint_correlation_length_m" not in waves.attrs
    waves.to_netcdf(tmp_path / "mean.nc")
    assert (waves["glint_std"].where(waves["elevation"] < -1.0, drop=True) > 0.0).any()


@pytest.mark.parametrize("kind", ["cox-munk-isotropic", "breon-henriot"])
def test_maps_are_shadowed_band_by_band_unless_told_otherwise(kind):
    """The brightest of a low Sun's glint near the horizon: Smith's law shows several times too much of it."""
    sensor = {"pixels": [3, 12], "fov_deg": [1, 1.5], "elevation_deg": -1.4}
    tables = {"sensor": sensor, "sun": {"zenith_deg": 84, "azimuth_deg": 180}, "sea": {"slopes": {"kind": kind}}}
    nested, both = (mean(parse_scenario(tables | {"mean": words})) for words in ({}, {"shadowing": "both"}))
    assert (nested.attrs["mean_shadowing"], both.attrs["mean_shadowing"]) == ("nested", "both")
    assert float(nested.glint_radiance.max()) < 0.6 * float(both.glint_radiance.max())
    assert float(nested.glint_std.max()) < float(both.glint_std.max())


def averaged(field: xr.DataArray, rows: int, columns: int) -> np.ndarray:
    """Means over blocks of so many pixels."""
    values = field.to_numpy().astype(float)
    return values.reshape(values.shape[0] // rows, rows, values.shape[1] // columns, columns).mean(axis=(1, 3))


@pytest.mark.parametrize(
    ("zenith", "wind", "fov", "elevation"), [(85.0, 7.0, 80.0, -3.0), (60.0, 0.5, 80.0, -25.0), (88.0, 3.0, 45.0, -2.0)]
)
def test_wide_columns_are_the_mean_of_narrow_ones(zenith, wind, fov, elevation):
    """In the middle of their columns the three have 0.005, 0.7 and 4.8 times the glint."""

    def glint(columns):
        values = {"height_m": 30.0, "fov_deg": [fov, 2.0], "pixels": [columns, 4], "elevation_deg": elevation, "pixel_shape": "any"}
        sun, sea = (
            {"zenith_deg": zenith, "azimuth_deg": 180.0},
            {"slopes": {"kind": "cox-munk-isotropic"}, "glint": {"correlation": "time"}},
        )
        return mean(parse_scenario({"sensor": values, "sun": sun, "wind": {"speed_m_s": wind}, "sea": sea}))

    wide, narrow = glint(8), glint(8 * 128)
    fine = averaged(narrow["glint_radiance"], 1, 128)
    np.testing.assert_allclose(wide["glint_radiance"], fine, atol=0.003 * fine.max())
    np.testing.assert_allclose(wide["emitted_radiance"], averaged(narrow["emitted_radiance"], 1, 128), rtol=1e-3)
    # a pixel 128 times as wide averages over as many more cells
    variance = averaged(narrow["glint_std"] ** 2, 1, 128) / 128.0
    np.testing.assert_allclose(wide["glint_std"] ** 2, variance, atol=0.01 * variance.max())


@pytest.mark.validation
def test_the_row_that_the_horizon_cuts_has_its_share_of_sea():
    """With eighths of a row the four were up to 17 % off."""
    for elevation in (-0.83, -0.71, -0.62, -0.55):
        values = {"height_m": 30.0, "pixel_shape": "any", "elevation_deg": elevation}
        coarse, fine = (
            mean(parse_scenario({"sensor": values | {"fov_deg": [0.5, 1.5], "pixels": [1, 3 * parts]}, "wind": {"speed_m_s": 5.0}}))
            for parts in (1, 500)
        )
        for name in ("emitted_radiance", "radiance"):
            np.testing.assert_allclose(coarse[name].to_numpy(), averaged(fine[name], 500, 1), rtol=0.02)


def test_pictures_of_wide_columns_without_waves_are_the_map():
    """A third of the glint is seen from the middle of the columns, and more of the aureole than they hold."""
    values = {"height_m": 30.0, "fov_deg": [360.0, 5.0], "pixels": [36, 4], "elevation_deg": -6.0, "pixel_shape": "any"}
    tables = {"sensor": values, "sun": {"zenith_deg": 80.0, "azimuth_deg": 185.0}, "sea": {"resolve_waves": False}}
    names = ["glint_radiance", "path_radiance", "sky_radiance"]
    scenario = parse_scenario(tables | {"render": {"layers": names}})
    map_, picture = mean(scenario), prepare_sequence(scenario).at(0.0)
    for name in names:
        found = map_[name].to_numpy()
        np.testing.assert_allclose(picture[name], found, atol=0.004 * found.max(), err_msg=name)


@pytest.mark.parametrize(
    "tables",
    [
        {"sensor": {"height_m": 100.0, "fov_deg": [30.0, 20.0], "pixels": [6, 200], "elevation_deg": -4.0, "pixel_shape": "any"}},
        {
            "sensor": {"height_m": 100.0, "fov_deg": [3.0, 8.0], "pixels": [5, 170], "pixel_shape": "any"},
            "atmosphere": {"refraction": "profile"},
        },
        {"sensor": {"pixels": [6, 40], "pixel_shape": "any"}, "mean": {"mode": "article"}},
        {"sensor": {"pixels": [48, 24], "roll_deg": 10.0}},
    ],
    ids=["wide columns", "refraction by the profile", "article", "turned"],
)
def test_blocks_of_rows_give_the_whole_map_and_report_progress(tables, monkeypatch):
    scenario, reports = parse_scenario(tables), []
    whole = mean(scenario)
    monkeypatch.setattr("seaglint.studies.mean.mean_map.BLOCK", 60)
    monkeypatch.setattr("seaglint.studies.mean.mean_map.PIXEL_BLOCK", 24**2)  # pixels on the horizon have so many lines of sight
    blocks = mean(scenario, lambda done, total: reports.append((done, total)))
    xr.testing.assert_allclose(blocks, whole, rtol=1e-6)
    done, totals = zip(*reports, strict=True)
    assert done[0] == 0
    assert done[-1] == totals[0]
    assert len(done) > 5
    assert list(done) == sorted(set(done))
    assert len(set(totals)) == 1


def test_foam_is_mixed_by_the_law():
    sea = {"water": "hale-querry-sea", "slopes": {"kind": "cox-munk-isotropic"}}
    wind = {"speed_m_s": 15.0}
    plain, foamy = (mean_map("spectral", wind=wind, sea=sea | foam) for foam in ({}, {"foam": {}}))
    share = 2.95e-6 * 15.0**3.52
    assert foamy.attrs["foam_share"] == pytest.approx(share)
    assert "foam_share" not in plain.attrs
    below = (plain["elevation"] < -0.02).values
    # foam emits more than the rough sea and mirrors less: up to some 0.4 of the mirrored part of its share
    more = (foamy["emitted_radiance"] / plain["emitted_radiance"]).values[below]
    assert more.min() > 1.0
    assert more.max() < 1.0 + share
    assert (foamy["glint_std"].values[below] <= plain["glint_std"].values[below]).all()
    np.testing.assert_array_equal(foamy["path_radiance"], plain["path_radiance"])
