"""From a scenario to a store: the same frame alone and in its sequence, for any number of threads."""

import numba
import numpy as np
import pytest

from seaglint.base.errors import BackendError, SeaglintError
from seaglint.scenario.load import parse_scenario
from seaglint.store.sequence_store import open_sequence
from seaglint.studies.sequence.render_sequence import prepare_sequence, render

SMALL = {
    "seed": 4,
    "sun": {"zenith_deg": 75.0, "azimuth_deg": 180.0},
    "sensor": {"fov_deg": [4.0, 2.0], "pixels": [16, 8], "elevation_deg": -3.0, "frames": 40, "frame_rate_hz": 25.0},
    "wind": {"speed_m_s": 7.0, "from_deg": 230.0},
    "sea": {"shortest_wave_m": 4.0},
    "render": {"tile_size": 128, "apparent_temperature": True},
}


@pytest.fixture(scope="module")
def scenario():
    return parse_scenario(SMALL)


def test_frame_37_alone_is_frame_37_of_the_sequence(scenario, tmp_path):
    many = numba.config.NUMBA_NUM_THREADS
    whole = open_sequence(render(scenario, tmp_path / "whole.zarr", threads=1))
    alone = open_sequence(render(scenario, tmp_path / "alone.zarr", frames=range(37, 38), threads=min(2, many)))
    assert whole.sizes["time"] == 40
    assert alone.sizes["time"] == 1
    assert float(alone.time[0]) == pytest.approx(37 / 25.0)
    for name in ("radiance", "apparent_temperature"):
        assert whole[name].values[37].tobytes() == alone[name].values[0].tobytes()
    assert whole.radiance.values[36].tobytes() != whole.radiance.values[37].tobytes()


def test_what_is_stored_is_what_the_renderer_makes(scenario, tmp_path):
    stored = open_sequence(render(scenario, tmp_path / "run.zarr", frames=range(2, 3)))
    run = prepare_sequence(scenario)
    np.testing.assert_array_equal(stored.radiance.values[0], run.at(2 / 25.0).radiance)
    np.testing.assert_allclose(stored.azimuth, np.degrees(run.scene.camera.azimuths))
    np.testing.assert_allclose(stored.elevation, np.degrees(run.scene.camera.elevations))
    assert run.layout.frame_rate == 25.0


def test_threads_beyond_the_machine_are_refused_and_put_back(scenario, tmp_path):
    before = numba.get_num_threads()
    with pytest.raises(BackendError, match="NUMBA_NUM_THREADS"):
        render(scenario, tmp_path / "run.zarr", threads=10_000)
    assert numba.get_num_threads() == before
    assert not list(tmp_path.iterdir())


def test_a_sensor_under_the_waves_leaves_no_store(tmp_path):
    scenario = parse_scenario(
        SMALL | {"sensor": SMALL["sensor"] | {"height_m": 2.0}, "wind": {"speed_m_s": 18.0, "from_deg": 0.0}, "render": {"tile_size": 512}}
    )
    with pytest.raises(SeaglintError, match="within reach of the waves"):
        render(scenario, tmp_path / "run.zarr")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("zenith", [95.0, pytest.param(180.0, marks=pytest.mark.validation)])
def test_night_is_a_valid_scenario(tmp_path, zenith):
    scenario = parse_scenario(SMALL | {"sun": {"zenith_deg": zenith}})
    image = open_sequence(render(scenario, tmp_path / "run.zarr", frames=range(1))).radiance.values
    assert np.all(np.isfinite(image))
    assert image.min() > 0.0


def test_isothermal_scenario_is_flat_to_the_apparent_temperature(tmp_path):
    scenario = parse_scenario(
        SMALL | {"atmosphere": {"source": "isothermal", "temperature_k": 290.0}, "sea": {"temperature_k": 290.0, "shortest_wave_m": 4.0}}
    )
    stored = open_sequence(render(scenario, tmp_path / "run.zarr", frames=range(1)))
    # float32 kelvin near 290: 3e-5
    np.testing.assert_allclose(stored.apparent_temperature.values, 290.0, atol=2e-3)


def test_provenance_names_cut_and_energies(scenario, tmp_path):
    stored = open_sequence(render(scenario, tmp_path / "run.zarr", frames=range(1)))
    text = str(stored.attrs)
    for word in ("cut_wavenumber_rad_m", "resolved_mss_up", "facet_mss_cross", "sweep_step_m", "solar_zenith_deg", "atmosphere_table"):
        assert word in text


DATED = {key: value for key, value in SMALL.items() if key != "sun"} | {
    "time": {"utc": "2026-06-21T05:30:00.25Z"},
    "place": {"latitude_deg": 40.0, "longitude_deg": 0.0},
    "sensor": SMALL["sensor"] | {"azimuth_deg": 65.0, "frames": 4, "frame_rate_hz": 0.01},
}


@pytest.mark.parametrize(
    "more", [{}, pytest.param({"projection": "pinhole", "roll_deg": 5.0}, marks=pytest.mark.validation)], ids=["swept", "turned"]
)
def test_the_sun_of_a_dated_sequence_goes_on_and_any_frame_alone_is_its_own(tmp_path, more):
    """300 s later, frame 1 has the Sun of its own date: what a scenario that begins 25 steps of 11.97 s later sees of the same waves."""
    scenario = parse_scenario(DATED | {"sensor": DATED["sensor"] | {"frames": 2, "frame_rate_hz": 1.0 / 300.0} | more})
    whole = open_sequence(render(scenario, tmp_path / "whole.zarr"))
    alone = open_sequence(render(scenario, tmp_path / "alone.zarr", frames=range(1, 2)))
    assert whole.radiance.values[1].tobytes() == alone.radiance.values[0].tobytes()
    run = prepare_sequence(scenario)
    first, later = run.scene.view, run.scene_at(300.0).view
    turned = np.degrees(np.arccos(_along(first) @ _along(later)))
    # the Earth turns by 1.254 deg in 300 s, which shows as cos(declination 23.4 deg) on the sky, less one step
    assert turned == pytest.approx(0.05 * 25 * np.cos(np.radians(23.44)), abs=0.02)
    held = run.scene_at(250.0)
    assert run.scene_at(251.0) is held
    assert run.scene_at(263.0) is not held
    assert run.scene_at(11.9) is run.scene


def _along(view):
    sine = np.sin(view.solar_zenith)
    return np.array([sine * np.sin(view.solar_azimuth), sine * np.cos(view.solar_azimuth), np.cos(view.solar_zenith)])


def test_a_sun_given_by_angles_stands(scenario):
    run = prepare_sequence(scenario)
    assert run.scene_at(1e5) is run.scene


def test_dated_sequences_carry_utc(tmp_path, scenario):
    import xarray as xr

    stored = open_sequence(render(parse_scenario(DATED), tmp_path / "run.zarr", frames=range(1, 3)))
    assert stored.utc.attrs["units"] == "seconds since 2026-06-21 05:30:00.250000"
    assert stored.utc.attrs["standard_name"] == "time"
    np.testing.assert_allclose(stored.time, [100.0, 200.0])
    decoded = xr.decode_cf(stored).utc.values
    np.testing.assert_array_equal(decoded, np.array(["2026-06-21T05:31:40.250", "2026-06-21T05:33:20.250"], "datetime64[ns]"))
    assert "utc" not in open_sequence(render(scenario, tmp_path / "undated.zarr", frames=range(1)))
