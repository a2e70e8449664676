"""Sweeps: entries are those of single scenarios, by the same route and by others; what is refused, and in which words."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import xarray as xr

import seaglint as sg
from seaglint.base.conventions import view_zenith
from seaglint.base.errors import BackendError, DataError, ScenarioError, SeaglintError
from seaglint.cluster.local import ThisProcess
from seaglint.formats.tables.input_tables import read_cases
from seaglint.optics.band import Band
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.text.option_texts import parse_vary
from seaglint.studies.build import scenario_physics
from seaglint.studies.mean.evaluate_cases import evaluate_mean, parse_bands
from seaglint.studies.sweep import case_results
from seaglint.studies.sweep.sweep_plan import SweepPlan, ViewAngles

BANDS = ["3.5-4.15", [8.0, 12.0]]
AT = {"view_zenith_deg": [0.0, 37.0, 71.0, 88.0], "view_azimuth_deg": [20.0, 200.0]}


@pytest.fixture(scope="module")
def drawn() -> tuple[dict[str, list[float]], xr.Dataset]:
    draw = np.random.default_rng(66)
    vary = {
        "sun.zenith_deg": [float(v) for v in draw.uniform(0.0, 89.0, 3)],
        "wind.speed_m_s": [float(v) for v in draw.uniform(0.5, 20.0, 2)],
        "band": BANDS,
    }
    return vary, sg.sweep({"sensor": {"height_m": 60.0}, "wind": {"from_deg": 130.0}}, vary, at=AT)


@pytest.mark.parametrize("place", [(0, 0, 0), (1, 1, 0), (2, 0, 1), (2, 1, 0)])
def test_entries_are_those_of_single_scenarios(drawn, place):
    vary, swept = drawn
    sun, wind, band = (values[i] for values, i in zip(vary.values(), place, strict=True))
    low, high = (3.5, 4.15) if band == BANDS[0] else (8.0, 12.0)
    alone = parse_scenario(
        {
            "sensor": {"height_m": 60.0},
            "wind": {"from_deg": 130.0, "speed_m_s": wind},
            "sun": {"zenith_deg": sun},
            "band": {"min_um": low, "max_um": high},
        }
    )
    elevation = ViewAngles.of(AT).elevations(60.0)
    seen = mean_radiance(scenario_physics.view(alone), elevation, np.radians(AT["view_azimuth_deg"]))
    # The same sums in the same order: what is shared is equal to what is prepared anew, but for the last bits of matrix products.
    np.testing.assert_allclose(swept.radiance.values[place], seen.total, rtol=1e-12)
    np.testing.assert_allclose(swept.glint_radiance.values[place], np.broadcast_to(seen.sun, seen.total.shape), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("band", ["3.5-4.15", "8-12"])
def test_entries_are_those_of_tables_of_cases(tmp_path, band):
    draw = np.random.default_rng(7)
    winds, suns = draw.uniform(1.0, 20.0, 2).round(3), draw.uniform(5.0, 80.0, 2).round(3)
    zenith = [15.0, 62.0]
    base = {"sensor": {"height_m": 40.0}, "sea": {"slopes": {"kind": "cox-munk-isotropic"}}, "sun": {"azimuth_deg": 90.0}}
    swept = sg.sweep(
        base, {"wind.speed_m_s": winds, "sun.zenith_deg": suns, "band": [band]}, at={"view_zenith_deg": zenith, "view_azimuth_deg": [60.0]}
    )
    depression = -np.degrees(ViewAngles.of({"view_zenith_deg": zenith}).elevations(40.0))
    head = "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,relative_azimuth_deg,sea_temperature_k,ifov_mrad\n"
    rows = [f"midlatitude-summer,{w},40,{d!r},{s},30,288.15,1\n" for w in winds for s in suns for d in depression.tolist()]
    (tmp_path / "cases.csv").write_text(head + "".join(rows))
    table = evaluate_mean(read_cases(tmp_path / "cases.csv"), parse_bands([band]))
    np.testing.assert_allclose(swept.radiance.values.ravel(), table[f"radiance_W_m2_sr[{band}]"], rtol=1e-9)
    np.testing.assert_allclose(swept.apparent_temperature.values.ravel(), table[f"apparent_temperature_K[{band}]"], rtol=1e-10)


def test_a_view_angle_has_what_a_pixel_has_that_looks_that_way():
    sensor = {"height_m": 100.0, "elevation_deg": -25.0, "azimuth_deg": 200.0, "fov_deg": [0.3, 0.3], "pixels": [3, 3]}
    base = {"sensor": sensor, "sun": {"zenith_deg": 55.0, "azimuth_deg": 200.0}}
    picture = sg.mean(sg.load(base))
    zenith = float(np.degrees(view_zenith(100.0, np.radians(25.0))))
    swept = sg.sweep(base, {"wind.speed_m_s": [7.0]}, at={"view_zenith_deg": [zenith], "view_azimuth_deg": [200.0]})
    base_wind = sg.load(base).wind.speed_m_s
    assert base_wind == 7.0
    for name in ("radiance", "emitted_radiance", "sky_radiance", "glint_radiance", "glint_std"):
        # A pixel of 0.1 deg is the mean over itself, in single precision.
        assert float(swept[name].squeeze()) == pytest.approx(float(picture[name][1, 1]), rel=2e-4), name


def test_axes_have_the_names_and_units_of_their_keys(drawn):
    vary, swept = drawn
    assert swept.radiance.dims == ("sun.zenith_deg", "wind.speed_m_s", "band", "view_zenith_deg", "view_azimuth_deg")
    assert swept["wind.speed_m_s"].attrs["units"] == "m s-1"
    assert swept["sun.zenith_deg"].attrs["units"] == "degree"
    assert swept["wind.speed_m_s"].values.tolist() == vary["wind.speed_m_s"]
    assert swept["band"].values.tolist() == ["3.5-4.15", "8-12"]
    assert swept.radiance.attrs["units"] == "W m-2 sr-1"
    assert "sweep" in swept.attrs


def test_units_convert_to_that_of_the_key_and_choices_are_texts():
    made = sg.sweep(
        {"sensor": {"height_m": "100 ft"}},
        {"wind.speed_m_s": ["5 m/s", "10 kn", 7], "sea.slopes.kind": ["cox-munk-isotropic", "flat"]},
        what=lambda scene: {"speed": scene.wind.speed_m_s, "kind": scene.sea.slopes.kind, "height": scene.sensor.height_m},
    )
    np.testing.assert_allclose(made["wind.speed_m_s"], [5.0, 5.144444, 7.0], rtol=1e-6)
    np.testing.assert_array_equal(made.speed, np.repeat(made["wind.speed_m_s"].values[:, None], 2, axis=1))
    assert made.kind.values.tolist() == [["cox-munk-isotropic", "flat"]] * 3
    np.testing.assert_allclose(made.height, 30.48, rtol=1e-12)
    assert "units" not in made.height.attrs  # it is the function's own, not the height of the sea


def test_dates_are_coordinates():
    base = {"place": {"latitude_deg": 40.0, "longitude_deg": 5.0}, "time": {"utc": "2026-06-21T12:00:00Z"}}
    made = sg.sweep(base, {"time.utc": ["2026-06-21T06:00:00Z", "2026-06-21T12:00:00+02:00"]}, what=lambda scene: scene.time.utc.hour)
    assert made["time.utc"].values.astype("datetime64[h]").tolist() == [np.datetime64(t).item() for t in ("2026-06-21T06", "2026-06-21T10")]
    assert made.value.values.tolist() == [6, 10]


def test_pictures_keep_their_dimensions_and_directions():
    base = {"sensor": {"pixels": [6, 4], "fov_deg": [6.0, 4.0]}, "sea": {"resolve_waves": False}}
    made = sg.sweep(base, {"sensor.azimuth_deg": [0.0, 90.0]}, what="image")
    assert made.radiance.dims == ("sensor.azimuth_deg", "y", "x")
    assert made.azimuth.dims == ("sensor.azimuth_deg", "x")
    assert made.elevation.dims == ("y",)
    single = sg.image(sg.load({**base, "sensor": {**base["sensor"], "azimuth_deg": 90.0}}))
    np.testing.assert_array_equal(made.radiance.values[1], single.radiance.values)


def test_air_and_sensor_are_those_of_single_scenarios():
    air = sg.sweep({"sensor": {"height_m": 25.0}}, {"wind.speed_m_s": [2.0, 18.0]}, what="atmosphere", at={"view_zenith_deg": [0.0, 85.0]})
    assert air.transmittance.dims == ("wind.speed_m_s", "view_zenith_deg")
    assert np.all(air.transmittance[:, 1] < air.transmittance[:, 0])
    assert np.all(air.transmittance[1] < air.transmittance[0])  # haze grows with the wind
    base = {"sensor": {"optics": {"aperture_m": 0.05, "f_number": 4.0}, "detector": {"pitch_um": 15.0}}}
    sheet = sg.sweep(base, {"sensor.optics.f_number": [2.0, 4.0]}, what="sensor")
    assert float(sheet.netd_k[0]) < float(sheet.netd_k[1])
    assert sheet["sensor.optics.f_number"].values.tolist() == [2.0, 4.0]


def count_of(scene):
    return {"speed": scene.wind.speed_m_s}


def test_workers_and_lazy_arrays_give_the_same():
    vary = {"sun.zenith_deg": [10.0, 50.0, 70.0], "wind.speed_m_s": [3.0, 9.0]}
    at = {"view_zenith_deg": [20.0, 60.0]}
    alone = sg.sweep({"band": {"min_um": 8.0, "max_um": 12.0}}, vary, at=at)
    shared = sg.sweep({"band": {"min_um": 8.0, "max_um": 12.0}}, vary, at=at, workers=ThisProcess())
    xr.testing.assert_identical(alone.drop_attrs(), shared.drop_attrs())
    pytest.importorskip("dask")
    later = sg.sweep({"band": {"min_um": 8.0, "max_um": 12.0}}, vary, at=at, lazy=True)
    assert later.radiance.chunks is not None
    xr.testing.assert_identical(later.compute().drop_attrs(), alone.drop_attrs())


def test_processes_give_the_same_and_refuse_functions_that_they_cannot_import(monkeypatch):
    scenario, vary = {"band": {"min_um": 8.0, "max_um": 12.0}}, {"sun.zenith_deg": [10.0, 50.0], "wind.speed_m_s": [3.0, 9.0]}
    at = {"view_zenith_deg": [20.0, 60.0]}
    alone, shared = (sg.sweep(scenario, vary, at=at, workers=workers) for workers in (None, 2))
    xr.testing.assert_identical(alone.drop_attrs(), shared.drop_attrs())

    def of_script(scene):
        return scene.wind.speed_m_s

    of_script.__module__, of_script.__qualname__ = "__main__", "of_script"
    monkeypatch.setattr(sys.modules["__main__"], "of_script", of_script, raising=False)
    for function in (of_script, lambda scene: scene.wind.speed_m_s):
        with pytest.raises(BackendError, match="cannot be sent to other processes, which cannot import it; define it in a module"):
            sg.sweep({}, {"wind.speed_m_s": [1.0, 2.0]}, what=function, workers=2)


def test_progress_counts_cases():
    told = []
    sg.sweep({}, {"wind.speed_m_s": [1.0, 2.0, 3.0]}, what=count_of, progress=lambda done, total: told.append((done, total)))
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]


def fails_at_nine(scene):
    if scene.wind.speed_m_s == 9.0:
        raise ValueError("nine is no number\nof mine")
    return scene.wind.speed_m_s


@pytest.mark.parametrize(
    ("vary", "options", "said"),
    [
        ({"wind.speed": [1.0]}, {}, "wind.speed is an unknown key; did you mean wind.speed_m_s?"),
        ({"wind.speed_m_s": [1.0, "5 m"]}, {}, "wind.speed_m_s = '5 m' has a unit of another kind"),
        ({"wind.speed_m_s": [1.0, 30.0, 5.0]}, {}, "sweep, wind.speed_m_s = 30: wind.speed_m_s = 30 is above"),
        ({"wind.speed_m_s": [2.0, "2 m/s"]}, {}, "wind.speed_m_s = 2 is given twice"),
        ({"wind.speed_m_s": []}, {}, "has no values"),
        ({"wind.speed_m_s": 3.0}, {}, "is no list"),
        ({}, {}, "vary has no key"),
        ({"wind": [{"speed_m_s": 3}], "wind.from_deg": [1]}, {}, "wind.from_deg is a part of wind"),
        ({"wind.speed_m_s": [1.0]}, {"what": "median"}, "what = 'median' is not one of mean, image"),
        ({"wind.speed_m_s": [1.0]}, {"what": "image", "at": {"view_zenith_deg": [1]}}, "view angles go with mean and atmosphere"),
        ({"wind.speed_m_s": [1.0]}, {"at": {"view_zenith_deg": [90.0]}}, "view_zenith_deg = 90 is outside the allowed range"),
        ({"wind.speed_m_s": [1.0]}, {"at": {"view_azimuth_deg": [90.0]}}, "view_zenith_deg is missing"),
        ({"wind.speed_m_s": [1.0]}, {"at": {"zenith": [9.0]}}, "zenith is unknown"),
        (
            {"wind.speed_m_s": [1.0, 9.0]},
            {"what": fails_at_nine},
            "wind.speed_m_s = 9: the function fails_at_nine raised ValueError: nine is",
        ),
        ({"wind.speed_m_s": [1.0]}, {"what": lambda scene: [1, 2]}, "return a number, numbers by name, or arrays of xarray"),
        ({"sensor.pixels": [[4, 2], [6, 2]]}, {}, "vary only what leaves the picture's size the same"),
        ({"seed": range(1, 1001), "wind.speed_m_s": [1.0, 2.0]}, {"what": count_of, "most_cases": 100}, "1000 x 2 = 2000 cases, about "),
    ],
)
def test_what_makes_no_sweep_is_refused_in_one_line(vary, options, said):
    with pytest.raises((ScenarioError, DataError)) as refused:
        sg.sweep({}, vary, **options)
    text = str(refused.value)
    assert said in text
    assert "\n" not in text


def test_failed_cases_have_no_values_and_the_others_are_kept():
    made = sg.sweep({}, {"wind.speed_m_s": [1.0, 30.0, 9.0, 4.0]}, what=fails_at_nine, keep_going=True)
    np.testing.assert_array_equal(made.value, [1.0, np.nan, np.nan, 4.0])
    assert made.attrs["failed_cases"] == 2
    assert "wind.speed_m_s = 30" in made.attrs["failures"]
    with pytest.raises(SeaglintError, match="all 1 cases failed"):
        sg.sweep({}, {"wind.speed_m_s": [9.0]}, what=fails_at_nine, keep_going=True)


def test_cases_that_share_their_air_follow_each_other():
    plan = SweepPlan.of({}, {"sun.zenith_deg": [1.0, 2.0, 3.0], "wind.speed_m_s": [4.0, 5.0]})
    assert plan.order() == [0, 2, 4, 1, 3, 5]
    assert plan.together() == 3
    assert plan.named(3) == "sun.zenith_deg = 2, wind.speed_m_s = 5"


def test_what_a_key_does_not_touch_is_made_once(monkeypatch):
    made = []
    standing = scenario_physics.standing_view
    monkeypatch.setattr(scenario_physics, "standing_view", lambda *given: made.append(given) or standing(*given))
    case_results._CACHED_VIEWS.clear()
    sg.sweep(
        {"band": {"min_um": 8.0, "max_um": 12.0}},
        {"sun.zenith_deg": [10.0, 50.0, 70.0], "wind.speed_m_s": [3.3, 9.1]},
        at={"view_zenith_deg": [20.0]},
    )
    assert len(made) == 2


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("k=1:20:1", list(range(1, 21))),
        ("k=0:1:0.1", [i / 10 for i in range(11)]),
        ("k=10:0:-5", [10, 5, 0]),
        ("k=0:1:0.4", [0.0, 0.4, 0.8]),
        ("k=1e1:2e1:5", [10.0, 15.0, 20.0]),
        ("k=3:3:1", [3]),
        ("k=12 kn,5", ["12 kn", 5]),
    ],
)
def test_ranges_include_their_end(text, values):
    assert parse_vary([text]) == [("k", values)]


@pytest.mark.parametrize("text", ["k", "k=", "=1", "k=1:2:0", "k=2:1:1", "k=1,,2", "k=0:1e9:1"])
def test_values_that_are_none_are_refused(text):
    with pytest.raises(DataError, match="vary = "):
        parse_vary([text])


def test_keys_without_effect_are_named(caplog):
    chance = {"band": {"min_um": 3.5, "max_um": 4.15}, "likelihood": {"threshold_w_m2_sr": [1.0], "samples": 1024}}
    found = sg.sweep(chance, {"wind.speed_m_s": [2.0, 9.0]}, what="likelihood")
    assert found.attrs["without_effect"] == "wind.speed_m_s"
    assert "wind.speed_m_s changes nothing" in caplog.text
    assert float(found.probability.sel(threshold=1.0).max()) >= 0.0


def test_values_of_arrays_keep_their_units():
    knots = xr.DataArray([10.0, 20.0], attrs={"units": "kn"})
    found = sg.sweep({}, {"wind.speed_m_s": knots}, what=lambda scene: scene.wind.speed_m_s)
    np.testing.assert_allclose(found["wind.speed_m_s"], [5.1444, 10.2889], rtol=1e-4)
    again = sg.sweep({}, {"wind.speed_m_s": found["wind.speed_m_s"]}, what=lambda scene: scene.wind.speed_m_s)
    np.testing.assert_array_equal(again["wind.speed_m_s"], found["wind.speed_m_s"])


def test_a_range_that_is_not_whole_is_named():
    for text in ("wind.speed_m_s=1:15", "wind.speed_m_s=1:15:2 kn"):
        with pytest.raises(DataError, match="three numbers without a unit"):
            parse_vary([text])


def test_a_file_that_was_written_anew_is_read_anew(tmp_path):
    (tmp_path / "response.csv").write_text("wavelength_um,response\n3.5,1\n4.1,1\n")
    scene = sg.load({"band": {"response": str(tmp_path / "response.csv")}, "sun": {"zenith_deg": 60}})
    angles, keys = {"view_zenith_deg": [40.0]}, {"sun.zenith_deg": [60.0]}
    before = sg.sweep(scene, keys, at=angles)
    (tmp_path / "response.csv").write_text("wavelength_um,response\n8.0,1\n9.0,1\n")
    after = sg.sweep(scene, keys, at=angles)
    assert abs(float(after.radiance.squeeze() / before.radiance.squeeze()) - 1.0) > 0.05


def test_the_air_of_a_sweep_is_that_of_other_functions():
    tables = {"band": {"min_um": 3.5, "max_um": 4.1}, "sun": {"zenith_deg": 50.0, "azimuth_deg": 180.0}, "sensor": {"height_m": 50.0}}
    zenith = [20.0, 70.0]
    air = sg.sweep(tables, {"sun.zenith_deg": [50.0, 75.0]}, what="atmosphere", at={"view_zenith_deg": zenith})
    exported = sg.atmosphere.export(tables)
    nu = exported.wavenumber_cm.to_numpy()
    weights = Band.rectangular(3.5, 4.1).weights(nu)
    sun = exported.sun_irradiance.interp(sun_zenith_deg=[50.0, 75.0], method="cubic").to_numpy() @ weights
    np.testing.assert_allclose(air.sun_irradiance, sun, rtol=2e-3)
    from_sea = exported.sky_radiance.interp(sky_zenith_deg=zenith, method="cubic").to_numpy() @ weights
    np.testing.assert_allclose(air.thermal_sky_radiance.isel({"sun.zenith_deg": 0}), from_sea, rtol=2e-3)


def test_a_moving_sensor_has_the_air_of_its_height():
    high = {"sensor": {"height_m": 1000.0}}
    moving = {"platform": {"keyframes": [{"time_s": 0.0, "height_m": 1000.0}, {"time_s": 9.0, "height_m": 1000.0}]}}
    for function in (
        lambda s: sg.atmosphere.path(s, range_m=5000.0).transmittance,
        lambda s: sg.atmosphere.sky(s, zenith_deg=60.0).radiance,
    ):
        np.testing.assert_allclose(function(moving), function(high), rtol=1e-9)


def test_lazy_cases_with_other_places_are_refused():
    def elsewhere(scene):
        return xr.DataArray([1.0, 2.0], {"r": [scene.wind.speed_m_s, 10.0]}, ("r",), "v")

    lazy = sg.sweep({}, {"wind.speed_m_s": [2.0, 5.0]}, what=elsewhere, lazy=True)
    with pytest.raises(DataError, match="the coordinate r is not that of the first case"):
        lazy.compute()


def test_a_key_that_is_varied_may_be_missing_in_the_scenario():
    place = {"place": {"latitude_deg": 50.0, "longitude_deg": -20.0}}
    dates = ["2026-06-21T12:00Z", "2026-06-21T15:00Z"]
    found = sg.sweep(place, {"time.utc": dates}, what=lambda scene: scene.sensor.height_m)
    assert found.sizes["time.utc"] == 2
    with pytest.raises(ScenarioError, match="time is missing"):
        sg.sweep(place, {"wind.speed_m_s": [2.0]}, what="mean")
