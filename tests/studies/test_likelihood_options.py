"""Options of the likelihood through the command, as a user meets them: smoothing, looks, curves of detection, winds, Fig. 5."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from seaglint.base.errors import ScenarioError
from seaglint.cli.app import app
from seaglint.climate.draws import estimate
from seaglint.climate.weather_table import WeatherTable
from seaglint.scenario.load import parse_scenario
from seaglint.studies.article.figures_5_and_12 import AZIMUTHS, CASES, PRINTED, THRESHOLDS, figure_5
from seaglint.studies.likelihood.chance_map import likelihood_map
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import draw, draw_values, likelihood

CALM_AND_FRESH = "wind_speed_m_s,cloud_cover,weight\n4,0.25,0.4\n9,0.5,0.6\n"


@pytest.fixture
def run(tmp_path):
    """Chances of ``seaglint likelihood`` by threshold, of a scenario's own lines in [likelihood] and more tables."""

    def chances(wanted, weather=CALM_AND_FRESH, more="", sun=72):
        (tmp_path / "w.csv").write_text(weather)
        (tmp_path / "s.toml").write_text(
            f'{more}\n[sun]\nzenith_deg = {sun}\n[atmosphere]\nsource = "none"\n[sensor]\nheight_m = 30\n'
            f'[likelihood]\nweather = "w.csv"\nsamples = 1024\n{wanted}\n'
        )
        found = CliRunner().invoke(app, ["likelihood", str(tmp_path / "s.toml"), "--json", "--progress", "none"])
        assert found.exit_code == 0, found.output
        return {row["threshold_w_m2_sr"]: row["probability"] for row in json.loads(found.stdout)["results"]}

    return chances


def test_rows_of_looks_are_drawn_by_their_weights(run, tmp_path):
    # Only looks towards the Sun glint at all; 0.4 * 0.75 + 0.6 * 0.5 of the Suns are free.
    (tmp_path / "looks.csv").write_text("depression_deg,azimuth_from_sun_deg,height_m,weight\n4,0,30,3\n4,180,30,1\n")
    found = run('looks = "looks.csv"\nthreshold_w_m2_sr = [0.0, 0.01]')
    assert found == {0.0: pytest.approx(0.6, abs=2e-3), 0.01: pytest.approx(0.75 * 0.6, abs=3e-3)}


def test_smoothing_spreads_the_wind_and_keeps_clear_skies_clear(run):
    one_sky = "wind_speed_m_s,cloud_cover\n6,0\n6.2,0\n6.4,0\n12,0\n"
    look = "depression_deg = [3, 3]\nazimuth_from_sun_deg = [8, 8]\nthreshold_w_m2_sr = [0.0, {}]"
    levels = np.geomspace(1.0, 60.0, 24)
    text = ", ".join(f"{level:.6g}" for level in levels)
    steady = "[wind]\nfrom_deg = 200"
    plain, smooth = (run(look.format(text) + more, one_sky, steady) for more in ("", "\nsmooth = true"))
    assert plain[0.0] == smooth[0.0] == 1.0
    # Four rows give chances in quarters; noise of a bandwidth fills the steps between.
    quarters = [abs(4.0 * p - round(4.0 * p)) for p in plain.values()]
    between = [abs(4.0 * p - round(4.0 * p)) for p in smooth.values()]
    assert max(quarters) < 0.02
    assert max(between) > 0.1


def test_a_curve_of_detection_is_averaged_over_glint(run, tmp_path):
    # A step at 2: a target of contrast c is seen where glint takes less than c - 2 from it.
    (tmp_path / "pd.csv").write_text("contrast_w_m2_sr,pd\n1.999999,0.1\n2.000001,0.9\n")
    look = "depression_deg = [2, 6]\nazimuth_from_sun_deg = [-20, 20]\n"
    above = run(look + "threshold_w_m2_sr = [1.0, 3.0]\nazimuths = 'drawn'")
    seen = run(look + 'threshold_w_m2_sr = [1.0, 3.0, 5.0]\nquantity = "detection"\ndetection_curve = "pd.csv"')
    assert seen[1.0] == pytest.approx(0.1)
    assert seen[3.0] == pytest.approx(0.9 - 0.8 * above[1.0], abs=1e-6)
    assert seen[5.0] == pytest.approx(0.9 - 0.8 * above[3.0], abs=1e-6)


def test_a_wind_that_turns_round_and_one_in_knots_change_the_chance(run):
    sea = '[sea.slopes]\nkind = "cox-munk-gram-charlier"'
    look = "depression_deg = [2, 6]\nthreshold_w_m2_sr = [1.0]"
    table = "wind_speed_m_s,cloud_cover,wind_from_deg\n{},0,{}\n"
    towards, away, faster = (run(look, table.format(*row), sea)[1.0] for row in ((8, 0), (8, 180), (8 / 0.514444, 0)))
    # The Sun stands in the north (azimuth 0 by default): a wind from it has its steep sides turned away.
    assert abs(away / towards - 1.0) > 0.01
    assert abs(faster / towards - 1.0) > 0.1


def test_integrated_azimuths_have_the_chance_of_drawn_ones_and_narrower_intervals():
    weather = WeatherTable({"wind_speed_m_s": np.array([3.0, 8.0]), "cloud_cover": np.array([0.2, 0.6])})
    base = {"place": {"latitude_deg": 45, "longitude_deg": -30}, "atmosphere": {"source": "none"}}
    found = {}
    for kind in ("integrated", "drawn"):
        wanted = {"azimuths": kind, "threshold_w_m2_sr": [0.25, 2.5], "samples": 16_384}
        found[kind] = likelihood(parse_scenario(base | {"likelihood": wanted}), weather=weather)
    for one, other in zip(found["integrated"].estimates, found["drawn"].estimates, strict=True):
        # 1.5 half-widths are 3.2 standard errors of 16 scramblings: by chance in 1 of 160 seeds, and this one is fixed.
        assert abs(one.value - other.value) < 0.75 * (other.high - other.low)
        assert one.high - one.low < 0.6 * (other.high - other.low)
    whole = [s for s in found["integrated"].strata[0] if s.by == "bearing_deg"]
    assert sum(s.share for s in whole) == pytest.approx(1.0)
    assert sum(s.share * s.value for s in whole) == pytest.approx(found["integrated"].estimates[0].value, rel=0.2)  # single looks


def test_trajectories_refuse_integrated_azimuths():
    with pytest.raises(ScenarioError, match="is for quantity = 'mean', case = 'single-look'"):
        parse_scenario({"likelihood": {"case": "trajectory", "azimuths": "integrated"}})


def test_cells_of_a_map_have_the_chance_of_their_region():
    # Longitude matters to neither of these tables; one has places, so that each cell draws for itself, and errs by a tenth with 2048 draws.
    columns = {"wind_speed_m_s": np.array([3.0, 8.0]), "cloud_cover": np.array([0.2, 0.6])}
    places = {"latitude_deg": np.full(2, 45.0), "longitude_deg": np.full(2, -20.0)}
    base = {"atmosphere": {"source": "none"}}
    region = {"latitudes_deg": [40, 50], "longitudes_deg": [-30, -10], "months": [3], "threshold_w_m2_sr": [0.25], "samples": 4096}
    wanted = parse_scenario(base | {"likelihood": region})
    exact = likelihood(wanted, weather=WeatherTable(columns)).estimates[0].value
    alike = likelihood_map(wanted, step=10.0, weather=WeatherTable(columns)).probability.values.ravel()
    own = likelihood_map(wanted, step=10.0, samples=2048, weather=WeatherTable(columns | places)).probability.values.ravel()
    assert alike[0] == alike[1]
    assert alike[0] == pytest.approx(exact, rel=0.1)
    assert own == pytest.approx([exact, exact], rel=0.1)


@pytest.mark.validation
@pytest.mark.parametrize("region", [{"latitudes_deg": [35, 65], "longitudes_deg": [-70, 0]}, {}], ids=["region", "place"])
def test_sobol_points_beat_random_ones_five_times(region):
    # The same integrand at the default draws; the variance of 16 scramblings has a standard error of 0.37 of itself, of six runs 0.15.
    base = {} if region else {"place": {"latitude_deg": 45, "longitude_deg": -30}}
    model = LikelihoodModel.of(parse_scenario(base | {"band": {"min_um": 3.0, "max_um": 5.0}, "likelihood": region}))
    for threshold in (0.25, 2.5):
        between = []
        for seed in range(6):
            drawn = draw(model, seed=seed)
            shape = (drawn.plan.scramblings, drawn.plan.points)
            means = np.average(draw_values(model, drawn, threshold).reshape(shape), axis=1, weights=drawn.weight.reshape(shape))
            between.append(np.var(means, ddof=1))
        plain = draw(model, seed=1, plain=True)
        values = draw_values(model, plain, threshold)
        alone = np.mean((plain.weight * (values - estimate(values, plain.plan, weight=plain.weight).value)) ** 2) / plain.plan.points
        assert alone / np.mean(between) > 5.0


@pytest.mark.validation
def test_figure_5_has_its_cases_thresholds_and_azimuths():
    found = figure_5(samples=256)
    columns = found.columns
    assert columns["case"].size == len(CASES) * len(THRESHOLDS) * AZIMUTHS.size
    at = {(c, t): (columns["case"] == c) & (columns["threshold_w_m2_sr"] == t) for c in range(3) for t in THRESHOLDS}
    for here in at.values():
        assert np.all(np.diff(columns["probability_within"][here]) >= 0.0)
        averaged = columns["probability_averaged"][here]
        assert averaged[0] == columns["probability"][here][0]
        # looks anywhere meet glint within some 10 deg of the Sun: a share of the half circle
        assert averaged[-1] == pytest.approx(np.trapezoid(columns["probability"][here], AZIMUTHS) / 180.0)
        assert averaged[-1] < 0.2 * averaged[0]
        assert columns["probability"][here][0] > 5.0 * columns["probability"][here][-4]  # 30 deg from the Sun
    for threshold in THRESHOLDS:
        single, way, field = (columns["probability"][at[c, threshold]] for c in range(3))
        assert single[0] < way[0] <= field[0]
        assert np.mean(field) > 1.1 * np.mean(way)
    for c in range(3):
        assert np.all(columns["probability"][at[c, 2.5]] <= columns["probability"][at[c, 0.25]])
    assert found.printed == 0.0
    assert found.brightest < PRINTED


def test_glint_of_a_calm_does_not_depend_on_where_no_wind_comes_from(run):
    """The same draws of Suns and looks in a calm whatever the direction, and next to them in the lightest wind."""
    wanted = "depression_deg = [2, 30]\nthreshold_w_m2_sr = [1.0, 20.0]"
    found = [
        run(
            wanted,
            f"wind_speed_m_s,wind_from_deg,cloud_cover,weight\n{wind},{wind_from},0,1\n",
            '[sea.slopes]\nkind = "cox-munk-anisotropic"',
        )
        for wind, wind_from in ((0, 90), (0, 230), (0.01, 230))
    ]
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    assert found[0][1.0] > 0.01
    assert found[2] == pytest.approx(found[0], abs=5e-3)
