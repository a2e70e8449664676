"""Waves of a scenario: files with where they are from, JONSWAP waves, several systems; what is wrong is told by its key."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import wave_files
import xarray as xr
from wave_files import LATITUDE, LONGITUDE

from seaglint.base.errors import ScenarioError
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.store.netcdf import write_netcdf
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import spectrum, waves
from seaglint.studies.sequence.labelled_frames import image
from seaglint.studies.sequence.sea_export import export_sea

SWELL = {"kind": "jonswap", "significant_height_m": 1.5, "peak_period_s": 8.0, "from_deg": 300.0, "spreading_deg": 15.0}


def scenario(spectrum: dict, **tables):
    wind = {"speed_m_s": 7.0, "from_deg": 200.0}
    return parse_scenario({"wind": wind, "sea": {"spectrum": spectrum}, "render": {"tile_size": 256}} | tables)


def from_deg(sea) -> float:
    """Where the waves at the peak come from [deg]."""
    azimuth = (np.arange(720) + 0.5) * np.pi / 360
    return float(np.degrees(np.angle(-np.sum(sea.spreading(sea.peak_wavenumber, azimuth) * np.exp(1j * azimuth)))) % 360.0)


@pytest.mark.parametrize("kind", ["elfouhaily", "pierson-moskowitz"])
def test_wind_seas_join_a_sea_without_waves(kind: str) -> None:
    """Winds from 0 on have a sea: energy and slopes fall evenly below the models' lightest wind, and pass into it without a step."""
    winds = np.array([1e-6, 0.1, 0.25, 0.4999, 0.5, 0.5001])
    seas = [spectrum(scenario({"kind": kind}, wind={"speed_m_s": wind, "from_deg": 200.0})) for wind in winds]
    for found in ([sea.height_variance() for sea in seas], [sum(sea.mss()) for sea in seas]):
        np.testing.assert_allclose(np.array(found) / found[4], [2e-6, 0.2, 0.5, 0.9998, 1.0, 1.0], rtol=1e-2)
        assert np.diff(found).min() > 0.0
    assert spectrum(scenario({"kind": kind}, wind={"speed_m_s": 0.0, "from_deg": 200.0})) is None
    assert from_deg(seas[1]) == pytest.approx(200.0, abs=0.1)


def test_images_of_light_winds_pass_from_one_to_the_next() -> None:
    sensor = {"pixels": [48, 32], "fov_deg": [6, 4], "elevation_deg": -12, "azimuth_deg": 180}
    winds = [0.0, 1e-3, 0.1, 0.3, 0.49, 0.51]
    scenes = [scenario({"kind": "elfouhaily"}, wind={"speed_m_s": wind, "from_deg": 200.0}, sensor=sensor) for wind in winds]
    images = [image(scene)["radiance"].to_numpy() for scene in scenes]
    steps = np.diff([float(found.mean()) for found in images]) / images[0].mean()
    assert np.abs(steps[[0, -1]]).max() < 0.01
    assert all(np.isfinite(found).all() for found in images)


def test_jonswap_waves_come_from_where_they_are_said_to() -> None:
    sea = spectrum(scenario(SWELL))
    assert from_deg(sea) == pytest.approx(300.0, abs=0.1)
    assert sea.significant_height() == pytest.approx(1.5, rel=1e-6)
    assert np.degrees(sea.wind_to_azimuth) == pytest.approx(20.0)
    with_wind = {key: value for key, value in SWELL.items() if key != "from_deg"}
    assert from_deg(spectrum(scenario(with_wind))) == pytest.approx(200.0, abs=0.1)


def test_systems_add_and_keep_their_directions() -> None:
    both = spectrum(scenario({"kind": "systems", "systems": [SWELL, {"kind": "elfouhaily"}]}))
    wind_sea = spectrum(scenario({"kind": "elfouhaily"}))
    assert both.height_variance() == pytest.approx((1.5 / 4) ** 2 + wind_sea.height_variance(), rel=1e-6)
    assert from_deg(both) == pytest.approx(300.0, abs=3.0)
    calm = scenario({"kind": "systems", "systems": [SWELL, {"kind": "elfouhaily"}]}, wind={"speed_m_s": 0.0})
    assert spectrum(calm).significant_height() == pytest.approx(1.5, rel=1e-6)
    assert spectrum(scenario({"kind": "systems", "systems": [{"kind": "elfouhaily"}]}, wind={"speed_m_s": 0.0})) is None


@pytest.mark.parametrize("turn", [0.0, 45.0, 90.0])
def test_energy_rule_of_several_systems(turn: float) -> None:
    steep = {"kind": "jonswap", "significant_height_m": 2.0, "peak_period_s": 5.0, "from_deg": 200.0 + turn, "spreading_deg": 10.0}
    wanted = scenario({"kind": "systems", "systems": [steep, {"kind": "elfouhaily"}]}, wind={"speed_m_s": 3.0, "from_deg": 200.0})
    slopes = scenario_physics.slopes(wanted)
    report = scenario_physics.sea(wanted, slopes).report
    up, cross, both = report["resolved_mss_up"], report["resolved_mss_cross"], report["resolved_slope_covariance"]
    assert report["cut_by"] == "80 % of the slope variance"
    assert up + report["facet_mss_up"] == pytest.approx(slopes.mss_up, rel=1e-9)
    assert cross + report["facet_mss_cross"] == pytest.approx(slopes.mss_cross, rel=1e-9)
    angle = np.radians(np.arange(0.0, 180.0, 1.0))
    c, s = np.cos(angle), np.sin(angle)
    share = (up * c**2 + 2 * both * s * c + cross * s**2) / (slopes.mss_up * c**2 + slopes.mss_cross * s**2)
    assert 0.6 < share.max() <= 0.81  # interpolation loses some; lattice sums of the long waves are good to 1 %


@pytest.mark.parametrize("key", ["sea.spectrum", "sea.spectrum.systems[1]"])
def test_a_file_is_told_with_its_time_and_place(key: str, tmp_path: Path) -> None:
    pytest.importorskip("wavespectra")
    file = {"kind": "file", "path": str(wave_files.swan(tmp_path)), "time": "2024-03-01T02:50:00Z"}
    file |= {"latitude_deg": LATITUDE, "longitude_deg": LONGITUDE}
    table = file if key == "sea.spectrum" else {"kind": "systems", "systems": [SWELL, file]}
    wanted = scenario(table)
    (told,) = json.loads(scenario_physics.sea(wanted, scenario_physics.slopes(wanted)).report["wave_spectra"])
    assert told["file"] == "swan.spec"
    assert told["format"] == "swan"
    assert told["time"] == "2024-03-01T03:00:00Z"
    assert told["seconds_from_time_wanted"] == 600.0
    assert told["km_from_place_wanted"] == pytest.approx(0.0, abs=0.01)
    assert told["significant_height_m"] == pytest.approx(2.0, rel=0.01)
    missing = {name: value for name, value in file.items() if name not in ("time", "latitude_deg", "longitude_deg")}
    for change, name in (({}, "time"), ({"time": "2024-03-01T03:00:00Z"}, "site")):
        table = missing | change
        with pytest.raises(ScenarioError) as caught:
            waves(scenario(table if key == "sea.spectrum" else {"kind": "systems", "systems": [SWELL, table]}))
        assert str(caught.value).startswith(f"{key}.{name} is missing")
        assert caught.value.mistakes[0].key == f"{key}.{name}"


def test_time_and_place_of_the_scenario_serve_where_the_file_has_none_of_its_own(tmp_path: Path) -> None:
    pytest.importorskip("wavespectra")
    here = {"time": {"utc": "2024-03-01T00:00:00Z"}, "place": {"latitude_deg": LATITUDE, "longitude_deg": LONGITUDE}}
    found = waves(scenario({"kind": "file", "path": str(wave_files.era5(tmp_path))}, **here))
    assert found.spectrum.significant_height() == pytest.approx(1.0, rel=0.01)
    assert found.sources[0]["km_from_place_wanted"] == pytest.approx(0.0, abs=0.01)


def test_directions_that_a_file_lacks_are_asked_for(tmp_path: Path) -> None:
    pytest.importorskip("wavespectra")
    table = {"kind": "file", "path": str(wave_files.triaxys_plain(tmp_path)), "time": "2024-03-01T03:00:00Z"}
    with pytest.raises(ScenarioError, match=r"sea\.spectrum\.from_deg is missing: .*a\.NONDIRSPEC has no directions"):
        waves(scenario(table))
    found = waves(scenario(table | {"from_deg": "4.0 rad", "spreading_deg": 20}))
    assert from_deg(found.spectrum) == pytest.approx(np.degrees(4.0), abs=0.2)


def test_waves_too_steep_are_told_by_their_key() -> None:
    steep = SWELL | {"peak_period_s": 2.0}
    with pytest.raises(
        ScenarioError, match=r"sea\.spectrum\.systems\[0\]\.significant_height_m: height = 1\.5 m .* allowed: up to 0\.437 m"
    ):
        waves(scenario({"kind": "systems", "systems": [steep]}))


def test_the_example_has_two_systems_from_two_sides() -> None:
    example = load_scenario(Path(__file__).parents[2] / "examples" / "swell.toml")
    sea = spectrum(example)
    wind_sea, swell = sea.systems
    assert from_deg(swell) == pytest.approx(310.0, abs=0.1)
    assert from_deg(wind_sea) == pytest.approx(205.0, abs=0.1)
    assert from_deg(sea) == pytest.approx(310.0, abs=3.0)  # the swell is the higher one


def test_an_exported_sea_tells_its_file(tmp_path: Path) -> None:
    pytest.importorskip("wavespectra")
    table = {"kind": "file", "path": str(wave_files.own(tmp_path)), "time": "2024-03-01T03:00:00Z", "site": "2"}
    path = write_netcdf(export_sea(scenario(table), extent=(32.0, 32.0)).dataset(), tmp_path / "sea.nc")
    with xr.open_dataset(path) as found:
        assert json.loads(found.attrs["wave_spectra"])[0]["site"] == "2"


@pytest.mark.parametrize("sea", [{"resolve_waves": False}, {"spectrum": {"kind": "flat"}}])
def test_bound_waves_without_geometry_are_reported_once(sea: dict, caplog: pytest.LogCaptureFixture) -> None:
    scenario_physics._report_no_bound_waves.cache_clear()
    wanted = parse_scenario({"sea": {"nonlinear": "second-order", **sea}})
    for _ in range(2):
        scenario_physics.sea(wanted, scenario_physics.slopes(wanted))
    (line,) = [message for message in caplog.messages if "second-order" in message]
    assert line.startswith("seaglint: sea.nonlinear = 'second-order' has no effect with sea.")
