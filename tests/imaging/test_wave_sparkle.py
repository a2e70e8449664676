"""Sparkle from the waves: pixels have the variance and time of the closed form at any size, and finer pixels averaged down agree."""

from __future__ import annotations

import math

import numpy as np
import pytest

import seaglint as sg
from seaglint.base.errors import ScenarioError
from seaglint.base.jit import njit
from seaglint.imaging.sparkle import NO_CLUSTERS, STEEPNESS_STEP, Heading, cluster_fields, clustered_factor, heading, kept_share, sparkle_of
from seaglint.imaging.wave_sparkle import FIELDS, _of_pixels
from seaglint.scenario.load import parse_scenario
from seaglint.sea.glitter.lit_share import Clusters
from seaglint.sea.glitter.short_waves import ShortWaves
from seaglint.sea.spectra import ElfouhailySpectrum

SUN = 2.3e-3
TIMES = 0.2


def sparkle(shares, top, *, seed=1, times=TIMES):
    """Parameters of one stretch with fields of these variances, largest first."""
    rows = np.broadcast_to(np.array(shares, np.float64), (1, FIELDS, np.shape(shares)[-1])).copy()
    table = NO_CLUSTERS._replace(begins=np.zeros(1), shares=rows, times=np.full((1, rows.shape[2] + 1), times), top=top)
    return sparkle_of(seed, 1.0, 1.0)._replace(clusters=table)


@njit
def fill_scattered(one, footprint, variance, tabulated, time, out):
    for i in range(out.shape[0]):
        out[i] = clustered_factor(one, (i * 73.713, i * 41.317), heading(i * 0.01), footprint, variance, tabulated, 0, time)


@njit
def fill_ground(one, way, footprint, variance, tabulated, time, out):
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            x, y = (i + 0.5) * footprint[0], (j + 0.5) * footprint[1]
            place = (311.3 + x * way.sine + y * way.cosine, 1207.7 + x * way.cosine - y * way.sine)
            out[i, j] = clustered_factor(one, place, way, footprint, variance, tabulated, 0, time)


@pytest.mark.parametrize("variance", [0.01, 0.5, 3.0])
@pytest.mark.parametrize("footprint", [(0.1, 0.1), (5.0, 0.1), (0.3, 2.0), (30.0, 0.7), (8.0, 8.0)])
@pytest.mark.parametrize("shares", [(), (0.3,), (0.1, 0.2, 0.4)])
@pytest.mark.parametrize("ratio", [0.3, 1.0, 4.0])
def test_mean_and_variance_of_pixels(variance: float, footprint: tuple[float, float], shares: tuple[float, ...], ratio: float) -> None:
    out = np.empty(60_000)
    fill_scattered(sparkle(shares, 2), footprint, variance, (1.0, variance / ratio), 0.4, out)
    # four standard errors of a product of gamma deviates; a row of cells as one has half a cell's variance too much at its ends
    kurtosis = 3.0 + 12.0 * variance
    assert out.mean() == pytest.approx(1.0, abs=4.0 * math.sqrt(variance / out.size))
    assert out.var() == pytest.approx(variance, rel=4.0 * math.sqrt(kurtosis / out.size) * (1.0 + variance) + 0.04)
    assert out.min() >= 0.0


@pytest.mark.parametrize("cells", [0.2, 0.7, 1.0, 1.6, 5.0])
def test_kept_share(cells: float) -> None:
    """Mean over a length at a random place of a row of independent cells."""
    rng = np.random.default_rng(4)
    values = np.concatenate([[0.0], np.cumsum(rng.standard_normal(400_000))])
    start = np.sort(rng.random(200_000) * 399_000)
    at = [np.interp(start + end, np.arange(values.size), values) for end in (0.0, cells)]
    assert kept_share(cells, 1.0) == pytest.approx(float(np.var((at[1] - at[0]) / cells)), rel=0.03)


@pytest.mark.parametrize("lag", [0.05, 0.2, 0.5])
def test_time(lag: float) -> None:
    one, then = np.empty(40_000), np.empty(40_000)
    for time, out in ((3.0, one), (3.0 + lag, then)):
        fill_scattered(sparkle((0.2,), 2), (0.5, 0.5), 0.4, (0.0, 0.4), time, out)
    # of a product of fields with one time the correlation is less by the product of both
    expected = math.exp(-lag / TIMES)
    assert float(np.corrcoef(one, then)[0, 1]) == pytest.approx(expected, abs=0.04)


@pytest.mark.parametrize("cut", [3.0, 12.0])
@pytest.mark.parametrize(("azimuth", "steepness"), [(0.0, 1.0), (0.7, 1.0), (0.7, 0.0), (0.7, 1.5), (0.7, 2.5)])
def test_finer_pixels_averaged_down(cut: float, azimuth: float, steepness: float) -> None:
    """Squares of ever more fine pixels have the variance of the closed form at their own size, over two decades of area."""
    clusters = Clusters(ShortWaves.of_spectrum(ElfouhailySpectrum(7.0), cut))
    fine, n = 0.35 / cut, 512
    top = math.floor(math.log2(2.0 * math.pi / cut))
    exponents = tuple(range(top, top - 8, -1))
    area, shares, times = _of_pixels(clusters, ((fine, fine), (fine, fine), (fine, fine)), SUN, exponents, fine)
    variance, *steps = (clusters.variance(u, SUN, (fine, fine)) for u in (steepness, math.floor(steepness), math.floor(steepness) + 1.0))
    step = math.floor(steepness) + (variance - steps[0]) / (steps[1] - steps[0])
    # the table holds the same number
    assert math.exp(area[0, :, round(steepness / STEEPNESS_STEP)].mean()) / fine**2 == pytest.approx(variance, rel=0.05)
    assert np.all(times > 0.0)
    ratios = {1: [], 2: [], 4: [], 8: [], 16: []}
    for seed in range(8):
        out = np.empty((n, n))
        fill_ground(sparkle(shares, top, seed=seed), heading(azimuth), (fine, fine), variance, (step, variance), 0.4, out)
        for size, found in ratios.items():
            found.append(out.reshape(n // size, size, n // size, size).mean((1, 3)).var())
    for size, found in ratios.items():
        expected = clusters.variance(steepness, SUN, (size * fine, size * fine))
        # beyond half a wave the closed form falls faster than one over the area, which no field of independent cells does
        if size * fine < math.pi / cut:
            assert np.mean(found) == pytest.approx(expected, rel=0.15), size


def test_place_of_a_pixel_among_the_steps_of_the_fields() -> None:
    """A table in which steepness u has the variance times area ``2 exp(u^2)``, at all arcs and in all directions."""
    steepness = STEEPNESS_STEP * np.arange(13)
    area = np.broadcast_to(math.log(2.0) + steepness**2, (1, 3, 2, 13)).copy()
    table = NO_CLUSTERS._replace(begins=np.zeros(1), nodes=np.array([[0.0, 1.0]]), area=area, shares=np.zeros((1, FIELDS, 1)))

    def steps(value: float) -> tuple[float, float]:
        return cluster_fields(table, 0, 10.0, value, 0.3)

    at = [2.0 * math.exp(u**2) for u in range(FIELDS)]
    for u in range(FIELDS - 1):
        assert steps(1.000001 * at[u]) == pytest.approx((u, at[u]), abs=1e-4, rel=1e-4)
        middle = 0.5 * (at[u] + at[u + 1])
        assert steps(middle) == pytest.approx((u + 0.5, middle))
    assert steps(0.1) == pytest.approx((0.0, at[0]))
    assert steps(10.0 * at[-1]) == pytest.approx((FIELDS - 1.0, at[-1]))


@pytest.mark.parametrize("ratio", [0.25, 3.0])
def test_beyond_the_steps_shared_fields_change_with_the_variance(ratio: float) -> None:
    """Averaged over 4 x 4 pixels, of a sixteenth of their own variance and all of what they share with their neighbours."""
    shares, variance, footprint, n = (0.04, 0.03), 0.2, (0.1, 0.1), 512
    found = []
    for one in (1.0, ratio):
        whole = []
        for seed in range(12):
            out = np.empty((n, n))
            fill_ground(sparkle(shares, 1, seed=seed), heading(0.0), footprint, one * variance, (2.0, variance), 0.4, out)
            whole.append(out.reshape(n // 4, 4, n // 4, 4).mean((1, 3)).var())
        found.append(np.mean(whole))
    assert found[1] / found[0] == pytest.approx(ratio, rel=0.1)


def test_a_pixel_is_a_function_of_seed_place_and_time() -> None:
    way = Heading(*heading(0.3))
    whole, again, other = (np.empty((20, 20)) for _ in range(3))
    fill_ground(sparkle((0.2, 0.1), 1), way, (0.4, 0.4), 0.9, (1.5, 0.9), 1.0, whole)
    fill_ground(sparkle((0.2, 0.1), 1), way, (0.4, 0.4), 0.9, (1.5, 0.9), 1.0, again)
    fill_ground(sparkle((0.2, 0.1), 1, seed=2), way, (0.4, 0.4), 0.9, (1.5, 0.9), 1.0, other)
    np.testing.assert_array_equal(whole, again)
    assert np.all(whole != other)


BASE = {"sensor": {"pixels": [48, 32], "fov_deg": [3.0, 2.0], "elevation_deg": -4.0, "frames": 1}, "wind": {"speed_m_s": 6.0}}


@pytest.mark.parametrize(
    ("given", "kind"),
    [
        ({}, "waves"),
        ({"correlation_time_s": 0.07}, "time"),
        ({"dispersion": "article"}, "time"),
        ({"cell_m": 0.01}, "time"),
        ({"correlation": "waves", "correlation_time_s": 0.07}, "waves"),
    ],
)
def test_scenarios_that_state_a_time_keep_their_cells(given: dict, kind: str) -> None:
    scenario = parse_scenario(BASE | {"sea": {"glint": given}})
    assert scenario.sea.glint.correlation == kind
    assert parse_scenario(scenario.model_dump(mode="json", exclude_none=True)).sea.glint == scenario.sea.glint


@pytest.mark.parametrize("key", [{"correlation_time_s": 0.3}, {"dispersion": "article"}, {"cell_m": 0.01}])
def test_both_are_refused(key: dict) -> None:
    with pytest.raises(ScenarioError, match="is for correlation = 'time'; leave one of them out"):
        parse_scenario({"sea": {"glint": {"correlation": "waves"} | key}})


SEAS = {
    "Elfouhaily": {},
    "swell": {"sea": {"spectrum": {"kind": "jonswap", "significant_height_m": 2.0, "peak_period_s": 12.0}}},
    "wind sea of a stated height": {"sea": {"spectrum": {"kind": "jonswap", "significant_height_m": 1.5, "peak_period_s": 6.0}}},
    "no waves drawn": {"sea": {"spectrum": {"kind": "flat"}}},
    "no waves resolved": {"sea": {"resolve_waves": False}},
    "measured": {"sea": {"spectrum": {"kind": "asit-2019"}}},
    "Sun at 80 deg": {"sun": {"zenith_deg": 80.0}},
    "Sun at 85 deg": {"sun": {"zenith_deg": 85.0}},
    "8-12 um": {"band": {"min_um": 8.0, "max_um": 12.0}},
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in ("swell", "Sun at 80 deg") else pytest.mark.validation) for name in SEAS]
)
def test_mean_maps_have_the_variance_of_images(name: str) -> None:
    """Pictures with and without sparkle: the mean square of their difference is the map's variance, whatever the sea and the Sun."""
    base = {
        "sensor": {"elevation_deg": -3.0, "fov_deg": [4.0, 2.0], "pixels": [128, 64], "frames": 1, "azimuth_deg": 180.0},
        "sun": {"zenith_deg": 75.0, "azimuth_deg": 180.0},
    }
    tables = base | {key: base.get(key, {}) | value for key, value in SEAS[name].items()}
    on, off = (
        np.asarray(sg.image(parse_scenario(tables | {"render": {"subpixel_glint": use}})).radiance, np.float64) for use in ("on", "off")
    )
    by_mean = sg.mean(parse_scenario(tables))
    glint = by_mean.glint_radiance.to_numpy()
    lit = glint > 0.1 * glint.max()
    found = float(np.mean((on - off)[lit] ** 2) / np.mean(by_mean.glint_std.to_numpy()[lit] ** 2))
    # one picture of some 100 independent patches of waves: 10 %; a lower Sun is hidden by nested bands, not by one law
    assert found == pytest.approx(1.0, rel=0.3 if name == "Sun at 85 deg" else 0.2)
