"""Measured seas in scenarios: slope variances by band against the tables, directions, levels of detail, what is reported and refused."""

from __future__ import annotations

import csv
import itertools
import logging
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import seaglint as sg
from seaglint.base.errors import DomainError, ScenarioError
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.text.toml_writing import differing, scenario_toml, stated
from seaglint.sea.spectra.campaigns import CAMPAIGNS, campaign_winds
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.wave_field import Detail
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.measured_waves import measured_waves
from seaglint.studies.build.waves_and_slopes import slopes, spectrum, waves
from seaglint.studies.mean.slope_bands import slope_bands

EDGES = (5.0, 10.0, 20.0, 50.0, 100.0, 300.0, 1000.0)

WITHIN = 0.02  # share by which a band's slope variance may differ from the table's

SEAS = [(name, float(wind)) for name in CAMPAIGNS for wind in campaign_winds(name)]


def scene(kind: str, wind: float, **sea: object) -> dict[str, object]:
    """Tables of a scenario with a measured sea."""
    return {"wind": {"speed_m_s": wind}, "sea": {"shortest_wave_m": 0.05, **sea, "spectrum": {"kind": kind}}}


def rows_of(name: str) -> list[dict[str, float]]:
    """Rows of a campaign's table, read here by other means than the program's."""
    text = files("seaglint.sea").joinpath("data", f"{name.replace('-', '_')}.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def expected(name: str, wind: float) -> dict[tuple[float, float], float]:
    """Slope variance of the bands that the table has, by trapezoids in log k or as sums of the table's own bands."""
    rows = [row for row in rows_of(name) if row["wind_speed_m_s"] == wind]
    out = {}
    for low, high in itertools.pairwise(EDGES):
        if name == "radyo-2008":
            parts = [row["slope_variance"] for row in rows if low <= row["min_rad_m"] and row["max_rad_m"] <= high]
            if parts:
                out[low, high] = sum(parts)
            continue
        k, b = (np.array([row[key] for row in rows]) for key in ("wavenumber_rad_m", "saturation"))
        x = np.unique(np.concatenate([np.log(k[(k > low) & (k < high)]), np.log([low, high])]))
        out[low, high] = float(np.trapezoid(np.interp(x, np.log(k), b), x))
    return out


@pytest.mark.validation
@pytest.mark.parametrize(("name", "wind"), SEAS)
def test_slope_variance_by_band_is_the_tables(name: str, wind: float) -> None:
    """Drawn waves plus facets have the table's slope variance in every band that it covers, at all its winds."""
    result = slope_bands(parse_scenario(scene(name, wind)), EDGES)
    bands = {(band.k_min_rad_m, band.k_max_rad_m): band for band in result.bands}
    for edges, variance in expected(name, wind).items():
        band = bands[edges]
        total = band.drawn_up + band.drawn_cross + band.facets_up + band.facets_cross
        assert total == pytest.approx(variance, rel=WITHIN), edges
    # geometry takes a share; the waves of 5 cm and shorter are the facets'
    assert 5.0 < result.cut_wavenumber_rad_m <= 2.0 * np.pi / 0.05 * (1.0 + 1e-9)
    assert bands[300.0, 1000.0].drawn_up == 0.0


@pytest.mark.validation
@pytest.mark.parametrize(("name", "wind"), [("asit-2019", 7.065), ("asit-2019", 15.748), ("radyo-2008", 7.0), ("radyo-2008", 1.73)])
def test_drawn_waves_have_the_bands_of_the_ensemble(name: str, wind: float) -> None:
    """The plane waves that are drawn, over 12 seeds, have the ensemble's slope variance in every band, up and across the wind."""
    scenario = parse_scenario(scene(name, wind))
    field = scenario_physics.sea(scenario, slopes(scenario)).waves
    assert field is not None
    to = field.spectrum.wind_to_azimuth
    edges = [*EDGES[:-1], field.tiles[-1].k_max]
    edges = sorted(edge for edge in edges if edge <= field.tiles[-1].k_max)
    drawn = []
    for seed in range(12):
        waves_of = np.concatenate(field.reseeded(seed).plane_waves())
        east, north, power = waves_of[:, 0], waves_of[:, 1], 0.5 * (waves_of[:, 3] ** 2 + waves_of[:, 4] ** 2)
        up, cross, k = east * np.sin(to) + north * np.cos(to), east * np.cos(to) - north * np.sin(to), np.hypot(east, north)
        drawn.append([np.histogram(k, edges, weights=power * way**2)[0] for way in (up, cross)])
    mean = np.mean(drawn, axis=0)
    error = np.std(drawn, axis=0) / np.sqrt(12)
    for i, (low, high) in enumerate(itertools.pairwise(edges)):
        ensemble = np.array(field.band_mss(low, high))
        # waves of a cell on an edge are counted by its centre here: 2 % of the longest bands; 4 standard errors of 12 seeds
        assert np.all(np.abs(mean[:, i] - ensemble) <= 0.02 * ensemble + 4.0 * error[:, i]), (low, high)


@pytest.mark.parametrize(("name", "wind"), [("asit-2019", 7.0), ("radyo-2008", 5.0)])
@pytest.mark.parametrize("from_deg", [None, 250.0, 300.0])
def test_directions_of_drawn_waves(name: str, wind: float, from_deg: float | None) -> None:
    """The principal axis of the drawn slopes is the stated one, and their widths are the spectrum's, within 2 degrees."""
    tables = scene(name, wind)
    if from_deg is not None:
        tables["sea"]["spectrum"]["from_deg"] = from_deg  # type: ignore[index]
    scenario = parse_scenario(tables)
    field = scenario_physics.sea(scenario, slopes(scenario)).waves
    assert field is not None
    (up, cross), both = field.resolved_mss(), field.resolved_covariance()
    axis = np.degrees(0.5 * np.arctan2(2.0 * both, up - cross))  # to the right of the wind, which blows TO 50 deg
    stated_axis = 0.0 if from_deg is None else from_deg - 230.0
    assert (axis - stated_axis + 90.0) % 180.0 - 90.0 == pytest.approx(0.0, abs=2.0)
    sea = field.spectrum
    k = field.tiles[-1].k_max
    (su, sc), sb = sea.mss(k), sea.slope_covariance(k)

    def ratio(up: float, cross: float, both: float) -> float:
        """Angle whose tangent is the ratio of the slopes' widths along the minor and the major axis [deg]."""
        half = np.hypot(0.5 * (up - cross), both)
        return float(np.degrees(np.arctan(np.sqrt((0.5 * (up + cross) - half) / (0.5 * (up + cross) + half)))))

    assert ratio(up, cross, both) == pytest.approx(ratio(su, sc, sb), abs=2.0)


@pytest.mark.validation
@pytest.mark.parametrize(("name", "wind"), SEAS)
def test_energy_rule_at_every_level_of_detail(name: str, wind: float) -> None:
    """Waves of every level and its facets add up to the spectrum, and the level's waves are the spectrum's up to its cut."""
    scenario = parse_scenario(scene(name, wind))
    statistics = slopes(scenario)
    field = scenario_physics.sea(scenario, statistics).waves
    assert field is not None
    whole = np.array(field.spectrum.mss())
    np.testing.assert_allclose([statistics.mss_up, statistics.mss_cross], whole, rtol=1e-12)
    for level in Detail.of(field).levels:
        # facets are what the level leaves, never negative: 80 % of either direction at most is geometry
        assert np.all(np.array(level.mss) <= 0.81 * whole)
        up, cross = field.spectrum.mss(2.0 * np.pi / level.shortest_wave)
        # the longest levels have few lattice waves: 4.5 % at 9.24 m/s above 84 m, waves of Elfouhaily's spectrum, as in its own seas
        assert level.mss == pytest.approx((up, cross), rel=0.05)


@pytest.mark.parametrize("kind", CAMPAIGNS)
def test_measured_seas_bring_their_slopes(kind: str) -> None:
    """Slopes are the spectrum's unless stated, alone and among systems, and a written scenario reads the same."""
    for table in ({"kind": kind}, {"kind": "systems", "systems": [{"kind": kind, "from_deg": 200.0}]}):
        scenario = parse_scenario({"sea": {"spectrum": table}})
        assert scenario.sea.slopes.kind == "spectrum"
        assert "slopes" not in differing(scenario)["sea"]
        assert parse_scenario(stated(scenario)) == scenario
        explicit = parse_scenario({"sea": {"spectrum": table, "slopes": {"kind": "cox-munk-anisotropic"}}})
        assert explicit.sea.slopes.kind == "cox-munk-anisotropic"
        assert parse_scenario(differing(explicit)) == explicit
    assert parse_scenario({"sea": {"spectrum": {"kind": "elfouhaily"}}}).sea.slopes.kind == "cox-munk-anisotropic"


def test_a_copied_spectrum_does_not_keep_the_slopes_of_another(tmp_path: Path) -> None:
    """The slopes that a measured sea brings are not stated: a file with another spectrum has the default law again."""
    text = scenario_toml(parse_scenario({"sea": {"spectrum": {"kind": "asit-2019"}}}))
    (tmp_path / "a.toml").write_text(text.replace("asit-2019", "elfouhaily"))
    assert load_scenario(tmp_path / "a.toml").sea.slopes.kind == "cox-munk-anisotropic"


@pytest.mark.parametrize("kind", CAMPAIGNS)
def test_presets_run(tmp_path: Path, kind: str) -> None:
    """The preset is written, read, and its mean map made of its slopes."""
    path = sg.init(tmp_path / "sea.toml", preset=kind)
    scenario = load_scenario(path)
    assert (scenario.sea.spectrum.kind, scenario.sea.slopes.kind) == (kind, "spectrum")
    small = scenario.model_copy(update={"sensor": scenario.sensor.model_copy(update={"pixels": (4, 8)})})
    assert sg.mean(small).attrs["measured_sea"] == kind


def sea_file(tmp_path: Path, level: float = 0.008, last: float = 900.0, wind: float | None = None) -> Path:
    """File of an even saturation from 5 rad/m."""
    k = np.geomspace(5.0 if last > 5.0 else 0.05, last, 9)
    more = ("", "") if wind is None else (",wind_speed_m_s", f",{wind}")
    rows = "".join(f"{one},{level}{more[1]}\n" for one in k)
    path = tmp_path / "sea.csv"
    path.write_text(f"wavenumber_rad_m,saturation{more[0]}\n{rows}")
    return path


def file_scene(path: Path, wind: float = 7.0, **keys: object) -> dict[str, object]:
    """Tables of a scenario with a file of waves."""
    return {"wind": {"speed_m_s": wind}, "sea": {"spectrum": {"kind": "wavenumber-file", "path": str(path), **keys}}}


def test_joins_are_reported_once_and_in_the_provenance(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """One line says where the table is joined to what, with both saturations; the file's digest is kept."""
    scenario = parse_scenario(file_scene(sea_file(tmp_path), shorter_waves="elfouhaily"))
    with caplog.at_level(logging.INFO, logger="seaglint"):
        first = waves(scenario)
        assert waves(scenario) is first
    (line,) = [message for message in caplog.messages if "measured 5-900 rad/m" in message]
    modelled = 5.0**3 * float(ElfouhailySpectrum(7.0).omnidirectional(5.0))
    assert f"with Elfouhaily's spectrum below (saturation 0.008 measured, {modelled:.3g} modelled) and Elfouhaily's spectrum above" in line
    (source,) = first.sources
    assert (source["file"], source["format"], len(str(source["sha256"]))) == ("sea.csv", "wavenumber-file", 64)
    sea_file(tmp_path, level=0.004)
    changed = waves(scenario).spectrum
    assert changed is not None
    assert sum(changed.mss(900.0, 5.0)) == pytest.approx(0.004 * np.log(180.0), rel=1e-6)


@pytest.mark.parametrize(
    ("kind", "wind", "text"),
    [
        (
            "asit-2019",
            3.0,
            "measured 0.003212-1378 rad/m at 2.69 and 3.953 m/s, with no waves below (Elfouhaily's spectrum has none there either) and no "
            "waves above",
        ),
        ("radyo-2008", 6.0, "measured 20-1000 rad/m at 5.34 and 7 m/s, with Elfouhaily's spectrum below (saturation "),
    ],
)
def test_joins_of_two_winds_are_one_sentence(kind: str, wind: float, text: str) -> None:
    """What both interpolated winds have in common is stated once."""
    (source,) = waves(parse_scenario(scene(kind, wind))).sources
    assert str(source["joins"]).startswith(text)
    assert ";" not in str(source["joins"])


@pytest.mark.parametrize(
    ("made", "keys", "wind", "text"),
    [
        ({"last": 1.0}, {}, 7.0, r'sea.spectrum.shorter_waves = "cut" leaves no waves beyond 1 rad/m.*set shorter_waves = "elfouhaily"'),
        ({"wind": 6.0}, {}, 7.0, "wind.speed_m_s: a wind of 7 m/s is outside the 6 m/s of sea.csv; set that wind, or leave the wind out"),
    ],
)
def test_seas_that_do_not_fit_are_refused(tmp_path: Path, made: dict, keys: dict, wind: float, text: str) -> None:
    """One line with the key and the remedy."""
    with pytest.raises(ScenarioError, match=text) as error:
        spectrum(parse_scenario(file_scene(sea_file(tmp_path, **made), wind, **keys)))
    assert "\n" not in str(error.value)


def test_a_width_beside_directions_of_the_file_is_refused(tmp_path: Path) -> None:
    """A file with directions refuses another width, and takes a mean direction."""
    path = tmp_path / "sea.csv"
    path.write_text("wavenumber_rad_m,saturation,half_width_deg\n5,0.01,40\n50,0.01,50\n500,0.01,60\n")
    assert spectrum(parse_scenario(file_scene(path, from_deg=10.0))) is not None
    with pytest.raises(ScenarioError, match=r"sea.spectrum.spreading_deg does not go with sea.csv, which has directions"):
        spectrum(parse_scenario(file_scene(path, spreading_deg=30.0)))


@pytest.mark.parametrize(("times", "warned"), [(10.0, True), (3.1, True), (2.0, False)])
def test_far_too_many_slopes_are_reported(tmp_path: Path, caplog: pytest.LogCaptureFixture, times: float, warned: bool) -> None:
    """A slope variance of 3 times Cox and Munk's or more gives a warning with both numbers."""
    cox_munk = 0.003 + 0.00512 * 7.0 * np.log(12.5 / 1e-4) / np.log(10.0 / 1e-4)  # to 1 %: converted to 12.5 m
    path = sea_file(tmp_path, level=times * cox_munk / np.log(180.0))
    with caplog.at_level(logging.WARNING, logger="seaglint"):
        spectrum(parse_scenario(file_scene(path, longer_waves="cut")))
    lines = [message for message in caplog.messages if "times Cox and Munk's" in message]
    assert len(lines) == int(warned)
    if warned:
        assert "check the units" in lines[0]


def test_name_of_a_ready_sea_as_path_names_the_kind() -> None:
    """The ready seas are kinds, not files."""
    with pytest.raises(ScenarioError, match=r"is a measured sea of the package and no file; set kind = 'asit-2019'"):
        parse_scenario({"sea": {"spectrum": {"kind": "wavenumber-file", "path": "asit-2019"}}})


def test_two_wind_seas_are_reported(caplog: pytest.LogCaptureFixture) -> None:
    """A measured sea joined to Elfouhaily's beside Elfouhaily's counts its long waves twice."""
    systems = [{"kind": "radyo-2008"}, {"kind": "elfouhaily"}]
    with caplog.at_level(logging.WARNING, logger="seaglint"):
        assert spectrum(parse_scenario({"sea": {"spectrum": {"kind": "systems", "systems": systems}}})) is not None
    assert any("their energies add; set longer_waves = 'cut'" in message for message in caplog.messages)


def test_light_winds_with_another_law_have_a_calm_without_measured_waves() -> None:
    """Slopes of a fit below its lightest directed wind nest in the waves without the measured wind sea, whose table has no calm."""
    table = {"wind": {"speed_m_s": 1.8}, "sea": {"spectrum": {"kind": "radyo-2008"}, "slopes": {"kind": "cox-munk-anisotropic"}}}
    assert slopes(parse_scenario(table)).nesting


@pytest.mark.parametrize("kind", [*CAMPAIGNS, "elfouhaily"])
def test_bands_side_by_side_add_up_to_the_whole(kind: str) -> None:
    """Bands from no waves to all add up to the whole sea, whatever the slope law; the dataset holds the same numbers."""
    scenario = parse_scenario({"sea": {"spectrum": {"kind": kind}}})
    bands = (0.0, 2.0, 40.0, 1e4)
    result = slope_bands(scenario, bands)
    for name in ("drawn_up", "drawn_cross", "facets_up", "facets_cross", "spectrum_up", "spectrum_cross"):
        total = sum(getattr(band, name) for band in result.bands)
        # the lattice is summed anew with cells cut at the edges
        assert total == pytest.approx(getattr(result.whole, name), rel=2e-3, abs=1e-6), name
    # the facets of pictures are those that the provenance of a picture has
    report = scenario_physics.sea(scenario, slopes(scenario)).report
    assert (result.whole.facets_up, result.whole.facets_cross) == (report["facet_mss_up"], report["facet_mss_cross"])
    data = sg.evaluate.slopes(scenario, bands=bands)
    assert data.drawn_up.values.tolist() == [band.drawn_up for band in result.bands]
    assert data.attrs["whole_facets_up"] == result.whole.facets_up


@pytest.mark.parametrize("sea", [{}, {"slopes": {"kind": "spectrum"}}, {"slopes": {"kind": "cox-munk-gram-charlier"}}])
def test_bands_of_a_drawn_sea_are_those_of_its_waves(sea: dict[str, object]) -> None:
    """Facets and drawn waves of every band are the drawn spectrum's, whatever ``sea.slopes`` is, and the header has the levels."""
    scenario = parse_scenario({"sea": {"uncertainty": "campaigns", "short_wave_levels": [0.22, 0.93], **sea}})
    result = slope_bands(scenario, EDGES)
    for band in result.bands:
        assert band.drawn_up + band.facets_up == pytest.approx(band.spectrum_up, rel=1e-12)
        assert band.drawn_cross + band.facets_cross == pytest.approx(band.spectrum_cross, rel=1e-12)
    assert result.slopes == "drawn between the campaigns, levels 0.22, 0.93"
    assert result.slopes in result.lines()[0]
    assert result.as_dict()["slopes"] == result.dataset().attrs["slopes"] == result.slopes


def test_bands_of_a_drawn_sea_without_geometry_are_its_slopes() -> None:
    """Without waves in ``sea.spectrum`` the facets have all slopes of the drawn sea, band by band."""
    scenario = parse_scenario({"sea": {"uncertainty": "campaigns", "spectrum": {"kind": "flat"}}})
    result = slope_bands(scenario, (0.0, 5.0, 100.0, 1e4))
    assert sum(band.facets_up for band in result.bands) == pytest.approx(result.whole.facets_up, rel=1e-6)
    # the same waves, with Elfouhaily's longer ones as geometry
    other = slope_bands(scenario.model_copy(update={"sea": parse_scenario({"sea": {"uncertainty": "campaigns"}}).sea}), (5.0, 100.0, 1e4))
    assert [band.facets_up for band in result.bands[1:]] == pytest.approx([band.spectrum_up for band in other.bands], rel=1e-9)


@pytest.mark.parametrize(
    "bands", [(5.0,), (5.0, 4.0), (-1.0, 4.0), (5.0, 5.0), (5.0, float("nan")), 5, "5", "5,x", ["a", 3], [[1, 2]], [[1], 2], None, ""]
)
def test_bad_bands_are_refused(bands: object) -> None:
    """Edges ascend from 0; other things are refused by the same line."""
    with pytest.raises(DomainError, match="give two or more ascending edges") as error:
        sg.evaluate.slopes({}, bands=bands)
    assert "\n" not in str(error.value)


def test_bands_as_a_text_are_those_of_numbers() -> None:
    """A text as on the command line."""
    assert sg.evaluate.slopes({}, bands="5, 20").identical(sg.evaluate.slopes({}, bands=[5, 20]))


def test_waves_are_built_once() -> None:
    """The same scenario has the same spectrum object, so that what is cached by a spectrum is found again."""
    system = parse_scenario({"sea": {"spectrum": {"kind": "asit-2019"}}}).sea.spectrum
    assert measured_waves(system, 7.0, 1.0, "sea.spectrum").spectrum is measured_waves(system, 7.0, 1.0, "sea.spectrum").spectrum


@pytest.mark.parametrize("wind", [3.0, 7.065, 16.0])
def test_a_campaigns_table_as_a_file_is_its_sea(tmp_path: Path, wind: float) -> None:
    """The table of the package, read as a user's file with several winds, gives the same spectrum as the ready sea."""
    path = tmp_path / "asit.csv"
    path.write_text((files("seaglint.sea") / "data" / "asit_2019.csv").read_text(encoding="utf-8"), encoding="utf-8")
    read, ready = spectrum(parse_scenario(file_scene(path, wind))), spectrum(parse_scenario(scene("asit-2019", wind)))
    assert read is not None
    assert ready is not None
    k = np.geomspace(1e-3, 2e3, 300)
    np.testing.assert_array_equal(read.omnidirectional(k), ready.omnidirectional(k))
    np.testing.assert_array_equal(read.second_harmonic(k), ready.second_harmonic(k))
