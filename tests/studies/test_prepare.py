"""A scenario becomes records in SI units; the energy rule decides what is geometry."""

import numpy as np
import pytest

from seaglint.base.errors import DomainError, ScenarioError
from seaglint.base.limits import TABLE_BANDS_UM, TABLE_HEIGHTS
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import spectrum
from seaglint.studies.sequence.render_sequence import prepare_sequence


def _scenario(**tables):
    return parse_scenario({"sensor": {"pixels": [16, 8]}, "render": {"tile_size": 128}} | tables)


def test_angles_and_directions():
    scenario = _scenario(
        sun={"zenith_deg": 60.0, "azimuth_deg": 200.0},
        sensor={"height_m": 40.0, "azimuth_deg": 190.0, "elevation_deg": -5.0, "fov_deg": [16.0, 8.0], "pixels": [16, 8]},
        wind={"speed_m_s": 9.0, "from_deg": 230.0},
    )
    view, eye = scenario_physics.view(scenario), scenario_physics.camera(scenario)
    assert np.degrees([view.solar_zenith, view.solar_azimuth]) == pytest.approx([60.0, 200.0])
    assert np.degrees([eye.azimuths[0], eye.azimuths[-1], eye.elevations[0], eye.elevations[-1]]) == pytest.approx(
        [182.5, 197.5, -1.5, -8.5]
    )
    # waves and the steeper slopes go where the wind blows
    assert np.degrees(view.slopes.wind_to_azimuth) == pytest.approx(50.0)
    assert np.degrees(spectrum(scenario).wind_to_azimuth) == pytest.approx(50.0)
    assert view.sensor_height == eye.height == 40.0


@pytest.mark.parametrize("wind", [1.0, 8.0, *(pytest.param(w, marks=pytest.mark.validation) for w in (3.0, 18.0))])
@pytest.mark.parametrize("shortest", [0.2, 20.0, pytest.param(2.0, marks=pytest.mark.validation)])
def test_geometry_takes_at_most_80_percent_and_facets_the_rest(wind, shortest):
    scenario = _scenario(wind={"speed_m_s": wind, "from_deg": 10.0}, sea={"shortest_wave_m": shortest}, render={"tile_size": 512})
    view = scenario_physics.view(scenario)
    sea = scenario_physics.sea(scenario, view.slopes)
    report = sea.report
    for direction in ("up", "cross"):
        total = getattr(view.slopes, f"mss_{direction}")
        assert report[f"resolved_mss_{direction}"] + report[f"facet_mss_{direction}"] == pytest.approx(total, rel=1e-9)
        # 80 % by the spectrum's integral, of which interpolation loses some; lattice sums of the long waves are good to 1 %
        assert report[f"resolved_mss_{direction}"] <= 0.81 * total
    if sea.waves is None:
        assert "all waves are facets" in report["waves"]
    else:
        assert report["cut_wavenumber_rad_m"] <= 2.0 * np.pi / shortest * (1.0 + 1e-9)


@pytest.mark.parametrize(
    "sea", [{"resolve_waves": False}, {"spectrum": {"kind": "flat"}}, {"spectrum": {"kind": "flat"}, "slopes": {"kind": "flat"}}]
)
def test_no_waves_are_made_where_none_are_wanted(sea):
    scenario = _scenario(sea=sea)
    assert scenario_physics.sea(scenario, scenario_physics.slopes(scenario)).waves is None


def test_calm_air_makes_no_wind_sea():
    scenario = _scenario(wind={"speed_m_s": 0.0})
    assert scenario_physics.sea(scenario, scenario_physics.slopes(scenario)).waves is None


def test_waves_on_a_mirror_are_refused():
    scenario = _scenario(sea={"slopes": {"kind": "flat"}})
    with pytest.raises(DomainError, match="leaves no slopes for waves"):
        scenario_physics.sea(scenario, scenario_physics.slopes(scenario))


def test_a_buoy_without_a_time_is_refused(tmp_path):
    path = tmp_path / "41010.data_spec"
    path.write_text("#YY MM DD hh mm\n")
    scenario = _scenario(sun={"zenith_deg": 60.0}, sea={"spectrum": {"kind": "file", "path": str(path)}})
    with pytest.raises(ScenarioError, match=r"sea\.spectrum\.time"):
        spectrum(scenario)


def test_a_response_outside_the_air_table_is_told_by_its_key(tmp_path):
    path = tmp_path / "wide.csv"
    path.write_text("wavelength_um,response\n3,0\n5,1\n7,0\n")
    scenario = _scenario(band={"response": str(path)})
    with pytest.raises(ScenarioError, match=r"^band\.response = '.*wide\.csv' reaches from 3 to 7 um.*2 to 5\.5 um or 7\.5 to 14 um"):
        scenario_physics.atmosphere(scenario, scenario_physics.band(scenario))


@pytest.mark.parametrize(("region", "height"), zip(TABLE_BANDS_UM, TABLE_HEIGHTS, strict=True))
def test_what_the_scenario_allows_is_in_the_air_tables(region, height):
    scenario = _scenario(band={"min_um": region[0], "max_um": region[1]}, sensor={"height_m": height, "pixels": [16, 8]})
    path = scenario_physics.view(scenario).atmosphere.transmittance(height, 1.1 * height)
    assert np.all((path >= 0.0) & (path <= 1.0))


@pytest.mark.parametrize(
    ("air", "kind"),
    [
        ({"source": "table"}, "ProfileAtmosphere"),
        ({"source": "lowtran", "haze": "rural-23km"}, "ProfileAtmosphere"),
        ({"source": "isothermal"}, "IsothermalAtmosphere"),
        ({"source": "none"}, "VacuumAtmosphere"),
    ],
)
def test_every_source_of_air_covers_the_band(air, kind):
    scenario = _scenario(atmosphere=air)
    over = scenario_physics.band(scenario)
    made = scenario_physics.atmosphere(scenario, over)
    assert type(made).__name__ == kind
    assert over.weights(made.wavenumber_cm).sum() > 0.0


@pytest.mark.parametrize("kind", ["cox-munk-gram-charlier", "cox-munk-slick", "breon-henriot"])
def test_slope_models_with_skewness_follow_the_wind(kind):
    slopes = scenario_physics.slopes(_scenario(wind={"speed_m_s": 9.0, "from_deg": 230.0}, sea={"slopes": {"kind": kind}}))
    assert not slopes.is_gaussian
    assert np.degrees(slopes.wind_to_azimuth) == pytest.approx(50.0)
    if kind != "cox-munk-slick":  # lee faces are steep: they fall to where the wind blows
        east, north = -0.4 * np.sin(np.radians(50.0)), -0.4 * np.cos(np.radians(50.0))
        assert slopes.density(east, north) > 1.3 * slopes.density(-east, -north)


@pytest.mark.parametrize("kind", ["elfouhaily", "pierson-moskowitz"])
def test_slopes_of_the_waves_themselves(kind):
    scenario = _scenario(sea={"slopes": {"kind": "spectrum"}, "spectrum": {"kind": kind}})
    slopes = scenario_physics.slopes(scenario)
    assert (slopes.mss_up, slopes.mss_cross) == pytest.approx(spectrum(scenario).mss(), rel=1e-12)
    assert scenario_physics.slopes(_scenario(sea={"slopes": {"kind": "spectrum"}, "spectrum": {"kind": "flat"}})).is_flat
    # the source article's mode has a slope model of its own
    assert scenario_physics.article_view(scenario).slopes.is_isotropic


def test_an_image_says_which_density_its_facets_have():
    gaussian, series = (_scenario(sea={"slopes": {"kind": f"cox-munk-{kind}"}}) for kind in ("anisotropic", "gram-charlier"))
    told = [scenario_physics.sea(s, scenario_physics.slopes(s)).report["facet_density"] for s in (gaussian, series)]
    assert told[0] == "Gaussian"
    assert "skewness" in told[1]
    assert scenario_physics.slopes(series).gaussian() == scenario_physics.slopes(gaussian)


@pytest.mark.parametrize(("kind", "most"), [("cox-munk-slick", 14), ("breon-henriot", 15), ("cox-munk-gram-charlier", 20)])
def test_winds_above_a_slope_fit_are_told_with_its_range(kind, most):
    sea, air = {"slopes": {"kind": kind}}, {"source": "none"}
    with pytest.raises(ScenarioError, match=rf"above the {kind} slope fit; allowed: 0 to {most} m/s"):
        _scenario(wind={"speed_m_s": most + 0.5}, sea=sea, atmosphere=air)
    asked = _scenario(wind={"speed_m_s": most + 0.5}, sea={"slopes": {"kind": kind, "extrapolate": True}}, atmosphere=air)
    assert scenario_physics.slopes(asked).mss > 0.0


def test_slope_models_that_facets_cannot_draw_are_refused_unless_asked_for():
    from seaglint.studies.sequence.render_sequence import prepare_sequence

    small = {"sensor": {"pixels": [8, 4], "frames": 1}, "sea": {"resolve_waves": False, "slopes": {"kind": "breon-henriot"}}}
    with pytest.raises(ScenarioError, match=r"breon-henriot.*render.gaussian_facets = true"):
        prepare_sequence(parse_scenario(small))
    drawn = prepare_sequence(parse_scenario(small | {"render": {"gaussian_facets": True}}))
    assert drawn.at(0.0).radiance.shape == (4, 8)


GLIDING = {"keyframes": [{"time_s": 0, "east_m": 0}, {"time_s": 1, "east_m": 50}]}


def glide(**tables):
    sensor = {"pixels": [12, 8], "frames": 2, "height_m": 30.0, **tables.pop("sensor", {})}
    return parse_scenario({"sensor": sensor, "platform": GLIDING, "sea": {"resolve_waves": False}, **tables})


@pytest.mark.parametrize(
    ("tables", "swept"),
    [
        ({}, True),
        ({"sensor": {"roll_deg": 5.0}}, False),
        ({"sensor": {"projection": "pinhole"}}, False),
        ({"platform": {"keyframes": [{"time_s": 0, "height_m": 30}, {"time_s": 1, "height_m": 31}]}}, False),
        ({"platform": {"keyframes": [{"time_s": 0, "azimuth_deg": 0}, {"time_s": 1, "azimuth_deg": 9}]}}, False),
        ({"platform": {"floats": True}}, False),
    ],
    ids=["level", "rolled", "plane", "rising", "turning", "floating"],
)
def test_what_glides_level_is_swept(tables, swept):
    assert (scenario_physics.swept_camera(glide(**tables)) is not None) is swept


def test_a_calm_sea_is_the_same_from_everywhere_on_the_way():
    moving, standing = prepare_sequence(glide()), prepare_sequence(glide(platform=None))
    assert moving.layout.poses["sensor_east"].tolist() == [0.0, 50.0 / 25.0]
    assert moving.images(1)["radiance"].tobytes() == standing.images(1)["radiance"].tobytes()
    assert np.ndim(moving.layout.azimuth_deg) == 1


@pytest.mark.parametrize("seed", range(6))
def test_a_spectrum_without_short_waves_is_told_once(seed, caplog):
    rng = np.random.default_rng(seed)
    speed, height, period = rng.uniform(8.0, 18.0), rng.uniform(0.5, 2.0), rng.uniform(8.0, 14.0)
    swell = {"kind": "jonswap", "significant_height_m": height, "peak_period_s": period}
    few = _scenario(wind={"speed_m_s": speed}, sea={"slopes": {"kind": "spectrum"}, "spectrum": swell})
    for _ in range(2):
        mss = scenario_physics.slopes(few).mss
    told = [record.getMessage() for record in caplog.records]
    assert len(told) == 1
    assert f"{mss:.2g}" in told[0]
    assert "short waves are missing" in told[0]
    whole = _scenario(wind={"speed_m_s": speed}, sea={"slopes": {"kind": "spectrum"}})
    scenario_physics.slopes(whole)
    assert len(caplog.records) == 1
