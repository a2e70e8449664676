"""Many looks at once, from tables, against the model of the mean radiance itself."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval
from scipy.interpolate import RegularGridInterpolator

from seaglint.air.lowtran_table import BandTable
from seaglint.base.conventions import horizon_depression, view_zenith
from seaglint.climate.draws import SamplingPlan
from seaglint.climate.glint_radiance import DetectionCurve, Search, detected, deviation, exceeded_by, looks, passes, sea_at, seas
from seaglint.climate.mirrored_sunlight import (
    MirroredLight,
    between_kernel,
    elevation_kernel,
    height_coordinate,
    light_of,
    mirrored_light,
    place_even,
    place_in_pieces,
    view_elevations,
)
from seaglint.facet.foam import FoamCover
from seaglint.facet.legs import NESTED
from seaglint.facet.sea_view import SeaView
from seaglint.optics.band import Band
from seaglint.optics.foam_reflectance import BUBBLES
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.sea.shadowing.nested import HIGHEST
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier
from seaglint.studies.build.profile_air import model_air

BAND = (3.5, 5.0)
DEPRESSION = (0.02, 0.11)
STATED = 0.005  # of radiance, at the 95th percentile
SLOPES = {"gaussian": cox_munk_anisotropic, "skewed": cox_munk_gram_charlier}


def band_air(model, wind):
    return model_air(model, wind, BAND)


def kinks(*models):
    return [BandTable.read(model, BAND).wind_kinks for model in models]


@pytest.fixture(scope="module")
def light():
    models = ("midlatitude-summer",)
    band = Band.rectangular(*BAND)
    return mirrored_light(band_air, models, (0.0, 20.0), (30.0, 30.0), DEPRESSION, band, hale_querry_sea(), kinks=kinks(*models))


@pytest.fixture(scope="module")
def sea():
    return {name: seas(lambda wind, of=of: of(wind, 0.0), (0.0, 20.0), NESTED) for name, of in SLOPES.items()}


def drawn(count, seed, heights=(30.0, 30.0), suns=(25.0, 89.9), beside=40.0, models=1):
    """Looks drawn evenly over what matters [(count, 9)]."""
    u = np.random.default_rng(seed).random((count, 9))
    azimuth = 2.0 * np.pi * u[:, 4]
    columns = [
        np.floor(models * u[:, 8]),
        20.0 * u[:, 0],
        2.0 * np.pi * u[:, 1],
        heights[0] * (heights[1] / heights[0]) ** u[:, 2],
        np.radians(suns[0] + (suns[1] - suns[0]) * u[:, 3]),
        azimuth,
        np.full(count, 1.02),
        azimuth + np.radians(beside) * (2.0 * u[:, 5] - 1.0),
        DEPRESSION[0] + (DEPRESSION[1] - DEPRESSION[0]) * u[:, 6],
    ]
    return np.column_stack(columns)


def direct(row, slopes_of, model="midlatitude-summer"):
    return SeaView(
        band_air(model, row[1]), Band.rectangular(*BAND), hale_querry_sea(), slopes_of(row[1], row[2]), 288.15, row[3], row[4], row[5],
        sun_distance_factor=row[6], scattering=False, background="blackbody",
    )  # fmt: skip


def errors(rows, found, slopes_of, models=("midlatitude-summer",)):
    """Relative errors of looks that are brighter than 1e-4 W m-2 sr-1."""
    exact = np.array([mean_radiance(direct(r, slopes_of, models[int(r[0])]), [-r[8]], [r[7]]).sun[0, 0] for r in rows])
    bright = exact > 1e-4
    assert bright.sum() > 0.2 * rows.shape[0]
    return np.abs(found.radiance[bright] / exact[bright] - 1.0)


@pytest.mark.parametrize("kind", ["gaussian", "skewed"])
def test_looks_equal_the_model(light, sea, kind):
    rows = drawn(60, 4)
    assert np.quantile(errors(rows, looks(rows, light, sea[kind]), SLOPES[kind]), 0.95) < STATED


@pytest.mark.validation
@pytest.mark.parametrize("kind", ["gaussian", "skewed"])
@pytest.mark.parametrize("heights", [(30.0, 30.0), (5.0, 3000.0)])
def test_looks_equal_the_model_in_all_air(sea, kind, heights):
    models = ("midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "tropical", "us-standard-1976")
    table = mirrored_light(
        band_air, models, (0.0, 20.0), heights, DEPRESSION, Band.rectangular(*BAND), hale_querry_sea(), kinks=kinks(*models)
    )
    rows = drawn(600, 5, heights, models=6)
    found = errors(rows, looks(rows, table, sea[kind]), SLOPES[kind], models)
    assert np.quantile(found, 0.95) < STATED
    assert np.median(found) < 0.001


@pytest.mark.validation
def test_the_aerosol_of_every_model_has_its_own_kink(sea):
    models = ("subarctic-winter", "us-standard-1976", "subarctic-summer")  # 12.33 m/s, none, 13.31 m/s
    table = mirrored_light(
        band_air, models, (0.0, 20.0), (30.0, 30.0), DEPRESSION, Band.rectangular(*BAND), hale_querry_sea(), kinks=kinks(*models)
    )
    rows = drawn(45, 6, suns=(70.0, 88.0), beside=10.0, models=3)
    rows[:, 1] = np.linspace(11.5, 14.0, 45)
    assert errors(rows, looks(rows, table, sea["gaussian"]), SLOPES["gaussian"], models).max() < STATED


def test_wind_from_the_other_side_is_another_sea(light, sea):
    rows = drawn(12, 8, suns=(60.0, 75.0), beside=10.0)
    turned = rows.copy()
    turned[:, 2] += np.pi
    gaussian, skewed = (looks(turned, light, sea[k]).radiance / looks(rows, light, sea[k]).radiance - 1.0 for k in ("gaussian", "skewed"))
    assert np.abs(gaussian).max() < 1e-9  # Gaussian slopes look the same from up and down the wind
    assert np.abs(skewed).max() > 0.02


def test_bubbles_of_foam_mirror_nothing(light, sea):
    """Foam by the wind leaves the share of the sea that mirrors; without foam not one bit changes."""
    rows = drawn(40, 12)

    def slopes_at(wind):
        return SLOPES["gaussian"](wind, 0.0)

    plain = looks(rows, light, sea["gaussian"])
    none = looks(rows, light, seas(slopes_at, (0.0, 20.0), NESTED, lambda wind: FoamCover(0.0)))
    foamy = looks(rows, light, seas(slopes_at, (0.0, 20.0), NESTED, lambda wind: FoamCover(2.95e-6 * wind**3.52)))
    np.testing.assert_array_equal(plain.radiance, none.radiance)
    bright = plain.radiance > 1e-6
    np.testing.assert_allclose(
        foamy.radiance[bright] / plain.radiance[bright], 1.0 - BUBBLES * 2.95e-6 * rows[bright, 1] ** 3.52, rtol=1e-4
    )
    np.testing.assert_allclose(foamy.chance[bright] / plain.chance[bright], foamy.radiance[bright] / plain.radiance[bright], rtol=1e-9)


def test_no_light_without_a_sun_and_above_the_horizon(light, sea):
    rows = drawn(3, 1)
    rows[0, 4] = np.radians(100.0)
    rows[1, 8] = 0.001  # above the horizon of 30 m, 2.8 mrad
    found = looks(rows, light, sea["gaussian"])
    assert found.radiance[:2].tolist() == [0.0, 0.0]
    assert found.radiance[2] > 0.0


def test_trajectory_finds_the_brightest_depression(light, sea):
    rows = drawn(5, 11, suns=(70.0, 88.0), beside=5.0)
    found = looks(rows, light, sea["gaussian"], Search(12, 1, 4))
    fine = np.linspace(*DEPRESSION, 400)
    for row, brightest in zip(rows, found.radiance, strict=True):
        many = np.tile(row, (fine.size, 1))
        many[:, 8] = fine
        assert brightest == pytest.approx(looks(many, light, sea["gaussian"]).radiance.max(), rel=2e-3)


def test_field_of_view_sees_at_least_the_trajectory(light, sea):
    rows = drawn(200, 12)
    along, wide = (looks(rows, light, sea["gaussian"], s).radiance for s in (Search(12, 1, 4), Search(12, 5, 4, 0.035)))
    assert np.all(wide >= along * 0.999)
    assert np.any(wide > 1.5 * along)


def test_deviation_is_that_of_the_mean_map(light, sea):
    rows = drawn(6, 21, suns=(60.0, 80.0), beside=5.0)
    found = deviation(looks(rows, light, sea["gaussian"]), rows[:, 3], 1e-7, 0.0026)
    for row, sigma in zip(rows, found, strict=True):
        view = direct(row, cox_munk_anisotropic)
        seen = mean_radiance(view, [-row[8]], [row[7]])
        assert sigma == pytest.approx(float(np.sqrt(sea_variance(view, seen, [-row[8]], 1e-7, 0.0026)[0, 0])), rel=0.005)


def test_gamma_pixels_pass_as_often_as_drawn_ones():
    # 200 000 draws of chance 0.05: standard error 5e-4, four of them
    mean, sigma, threshold = 2.0, 1.5, 5.0
    sample = np.random.default_rng(3).gamma((mean / sigma) ** 2, sigma**2 / mean, 200_000)
    assert passes(np.array([mean]), np.array([sigma]), threshold)[0] == pytest.approx(np.mean(sample > threshold), abs=2e-3)
    assert passes(np.array([2.0, 2.0]), np.zeros(2), 1.9).tolist() == [1.0, 1.0]


def test_glint_behind_a_target_takes_from_its_contrast():
    curve = DetectionCurve(np.array([0.0, 10.0]), np.array([0.0, 1.0]))
    # half of the time the Sun is hidden: 0.5 * pd(8) + 0.5 * pd(8 - 3)
    assert detected(np.array([3.0]), np.array([0.5]), curve, 8.0)[0] == pytest.approx(0.5 * 0.8 + 0.5 * 0.5)


def test_contrasts_that_glint_exceeds():
    radiance = np.arange(1000.0)
    assert exceeded_by(radiance, np.ones(1000), [0.1])[0] == pytest.approx(900.0)
    assert exceeded_by(radiance, np.full(1000, 0.5), [0.1])[0] == pytest.approx(800.0)


@pytest.mark.validation
def test_even_points_beat_random_ones(light, sea):
    # One Sun: azimuth, depression, wind and its direction vary. 64 scramblings each: a ratio of 5 is told from 3 at 99 %.
    plan = SamplingPlan(64, 1024)

    def means(plain):
        u = plan.uniform(4, 7, plain=plain)
        rows = np.column_stack(
            [np.zeros(plan.total), 15.0 * u[:, 2], 2 * np.pi * u[:, 3], np.full(plan.total, 30.0), np.full(plan.total, 1.3),
             np.zeros(plan.total), np.ones(plan.total), 2 * np.pi * u[:, 0], DEPRESSION[0] + np.ptp(DEPRESSION) * u[:, 1]]
        )  # fmt: skip
        return (looks(rows, light, sea["gaussian"]).radiance > 0.25).reshape(64, -1).mean(axis=1)

    assert np.var(means(True), ddof=1) > 5.0 * np.var(means(False), ddof=1)


@pytest.mark.parametrize("power", [0, 1, 2, 3])
def test_cubics_through_four_nodes_are_exact_for_cubics(power):
    nodes = np.array([0.0, 0.4, 1.0, 1.3, 2.0, 2.1, 3.0, 3.7, 4.0])
    pieces = np.array([0.0, 4.0, 8.0])
    weights = np.empty(4)
    for x in np.linspace(0.0, 4.0, 41):
        start = place_in_pieces(x, nodes, pieces, weights)
        assert weights @ nodes[start : start + 4] ** power == pytest.approx(x**power, abs=1e-12)
        assert start + 3 <= 4 if x <= 2.0 else start >= 4  # never across the kink
        nearest = np.sort(np.argsort(np.abs(nodes[:5] - x))[:2]) if x <= 2.0 else nodes.searchsorted(x) - np.array([1, 0])
        assert set(nearest) <= set(range(start, start + 4))
    for x in np.linspace(0.0, 1.0, 23):
        start = place_even(x, 8, weights)
        assert weights @ (np.arange(start, start + 4) / 7.0) ** power == pytest.approx(x**power, abs=1e-12)
        assert start <= 7.0 * x <= start + 3
    assert place_in_pieces(9.0, nodes, pieces, weights) == 5  # beyond the nodes the last one counts
    assert weights == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-12)


def test_places_between_nodes_are_those_of_linear_interpolation():
    nodes = np.array([0.0, 0.5, 2.0, 2.5])
    x = np.array([-1.0, 0.0, 0.2, 0.5, 1.7, 2.4, 2.5, 9.0])
    assert [between_kernel(one, nodes) for one in x] == pytest.approx(np.interp(x, nodes, np.arange(4.0)), abs=1e-12)


def test_layers_of_air_begin_at_whole_coordinates_of_height():
    coordinate = height_coordinate([1e3, 2e3, 3e3, 7e3])
    assert coordinate == pytest.approx([0.0, 1.0, 2.0, 6.0], abs=1e-12)
    assert height_coordinate([1e3 / np.e, 1e3 / np.e**2]) == pytest.approx([-1.0, -2.0])
    # Within a layer the square of the coordinate grows evenly.
    assert (height_coordinate([3100.0, 3500.0, 3900.0]) - 2.0) ** 2 == pytest.approx([0.1, 0.5, 0.9])


def test_elevations_of_looks_are_those_of_a_round_sea():
    for height, depression in ((30.0, 0.02), (3000.0, 0.04), (3000.0, 1.2)):
        assert elevation_kernel(height, depression) == pytest.approx(0.5 * np.pi - float(view_zenith(height, depression)), abs=1e-9)
    assert elevation_kernel(3000.0, 0.9 * horizon_depression(3000.0)) < 0.0
    shares = np.linspace(0.0, 1.0, 5)
    ends = view_elevations(500.0, (0.03, 0.3), shares)
    assert ends[[0, -1]] == pytest.approx([elevation_kernel(500.0, 0.03), elevation_kernel(500.0, 0.3)], rel=1e-9)
    stretched = np.arcsinh(ends / horizon_depression(500.0))
    assert np.diff(stretched) == pytest.approx(np.full(4, stretched[-1] - stretched[0]) / 4.0)


def test_looks_from_many_heights_equal_the_model(sea):
    """Air of one wind, so that few tables are made: heights of two layers of air and the ground's."""
    still = model_air("midlatitude-summer", 5.0, BAND)
    water, band = hale_querry_sea(), Band.rectangular(*BAND)
    table = mirrored_light(lambda model, wind: still, ["any"], None, (300.0, 2600.0), DEPRESSION, band, water)
    rows = drawn(40, 15, (300.0, 2600.0), suns=(40.0, 80.0), beside=10.0)
    found = looks(rows, table, sea["gaussian"]).radiance
    exact = np.empty(40)
    for n, row in enumerate(rows):
        view = SeaView(
            still, band, water, cox_munk_anisotropic(row[1], row[2]), 288.15, row[3], row[4], row[5], sun_distance_factor=row[6],
            scattering=False, background="blackbody",
        )  # fmt: skip
        exact[n] = mean_radiance(view, [-row[8]], [row[7]]).sun[0, 0]
    bright = exact > 1e-4
    assert bright.sum() > 10
    assert np.quantile(np.abs(found[bright] / exact[bright] - 1.0), 0.95) < STATED


def test_light_of_a_place_is_the_product_of_cubics_times_a_chebyshev_series():
    """Cubics by their weights along each axis, the series by NumPy from coefficients linear along four axes."""
    rng = np.random.default_rng(3)
    heights, coarse = np.linspace(-1.0, 2.0, 5), (1.3, 0.4, 2.7, 3.0)
    table = MirroredLight(
        np.zeros((2, 6)), np.zeros((2, 2)), heights, np.zeros(2), (0.0, 1.0), 0.0, rng.normal(size=(2, 6, 5, 7, 8)),
        np.zeros((2, 3)), heights[:2], rng.random((2, 3, 2, 4, 5, 12)),
    )  # fmt: skip
    weights, place = rng.normal(size=(4, 4)), (2, 1, 3, 4)
    part = table.values[1, 2:6, 1:5, 3:7, 4:8]
    whole = np.einsum("whvs,w,h,v,s->", part, *weights)
    series = RegularGridInterpolator([np.arange(n) for n in (3, 2, 4, 5)], table.shapes[1])(coarse).ravel()
    expected = np.exp(whole) * chebval(2.0 * 0.37 - 1.0, series)
    assert light_of(table, 1, place, weights, 0.37, coarse) == pytest.approx(expected, rel=1e-10)
    one = table._replace(values=table.values[:, :, :1])
    alone = np.einsum("wvs,w,v,s->", table.values[1, 2:6, 0, 3:7, 4:8], weights[0], weights[2], weights[3]) * weights[1, 0]
    assert light_of(one, 1, (2, 0, 3, 4), weights, 0.37, coarse) == pytest.approx(np.exp(alone) * chebval(-0.26, series), rel=1e-10)


def test_the_sea_under_a_look_is_between_those_of_the_tables(sea):
    """Linear in the wind; beyond the tables the nearest. The ratio of visible areas is linear in wind, edge and turn."""
    table = sea["skewed"]
    table = table._replace(area=1.0 + np.random.default_rng(4).random((9, 6, 5)))
    winds = table.first + table.step * np.arange(len(table.slopes))
    for wind in (-1.0, 0.37 * table.step, winds[3] + 0.2 * table.step, winds[-1] + 4.0):
        row, coefficients = np.array([0.0, wind, 0.8, 30.0, 1.2, 2.5, 1.0, 2.4, 0.05]), np.empty(5)
        state = sea_at(table, row, coefficients)
        between = np.array([np.interp(wind, winds, column) for column in table.slopes.T])
        assert coefficients == pytest.approx(between[2:7], abs=1e-12)
        assert (state.density.mss_up, state.density.mss_cross) == pytest.approx(tuple(between[:2]))
        assert state.wave_azimuth == pytest.approx(0.8 + between[8])
        assert state.law == pytest.approx((between[7] - table.first_deviation) / table.deviation_step)
        turn = 2.5 - state.wave_azimuth
        assert state.sun_deviation == pytest.approx(np.linalg.norm(np.sqrt(between[:2]) * [np.cos(turn), np.sin(turn)]))
        assert (state.density.wind_sine, state.density.wind_cosine) == pytest.approx((np.sin(0.8 + between[8]), np.cos(0.8 + between[8])))
        edge = 1.0 / (np.tan(1.2) * state.sun_deviation)
        axes = np.linspace(winds[0], winds[-1], 9), np.linspace(0.0, HIGHEST, 6), np.linspace(0.0, np.pi, 5)
        folded = abs(np.angle(np.exp(1j * turn)))
        place = np.clip(wind, winds[0], winds[-1]), np.clip(edge, 0.0, HIGHEST), folded
        assert state.series == pytest.approx(RegularGridInterpolator(axes, table.area)(place).item(), rel=1e-9)
