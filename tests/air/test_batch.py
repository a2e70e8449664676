"""Many cases at once, from tables, against sums along single rays, which are checked against LOWTRAN7 elsewhere."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from seaglint.air.lowtran_table import BatchAtmosphere, Stencil, table_models, with_slopes
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.base.errors import DomainError
from seaglint.optics.band import Band

# Band quantities of the tables, whose nodes and components leave 0.2 % in the median, against sums along single rays.
TABLES = 0.01


def cases(air, count=12):
    """Random winds, heights and angles with the table's edges and kinks among them; some rays nearly on the horizon."""
    random = np.random.default_rng(5)
    wind = random.uniform(0.0, 20.0, count)
    height = np.exp(random.uniform(np.log(2.0), np.log(1e4), count))
    wind[:2], height[2:6] = (0.0, 20.0), (2.0, 1e4, 1000.0, 3000.0)
    wind[-len(air._table.wind_kinks) :] = air._table.wind_kinks
    depression = air.dip(height) + np.radians(10.0 ** random.uniform(-4.0, 1.5, count))
    solar, sky = random.uniform(0.0, 0.5 * np.pi, (2, count))
    depression[4], solar[:3], sky[:2] = 0.5 * np.pi, (0.0, 0.5 * np.pi, 1.7), (0.0, 0.5 * np.pi)
    return wind, height, depression, solar, sky


@pytest.mark.parametrize("band", [(3.0, 5.0), (8.0, 12.0)])
@pytest.mark.parametrize("model", ["midlatitude-summer", "us-standard-1976"])
def test_every_case_is_that_of_sums_along_its_ray(model, band):
    batch = BatchAtmosphere.load(model, band)
    wind, height, depression, solar, sky = cases(batch)
    tau, path = batch.path(wind, height, depression)
    light, above = batch.solar_irradiance(wind, solar), batch.sky_radiance(wind, sky)
    weights = Band.rectangular(*band).weights(batch.wavenumber_cm)
    for i in range(wind.size):
        sums = AirSums(model_profile(model), HazeWeather(wind=wind[i], wind_24h=wind[i]), batch.wavenumber_cm, spectroscopy="lowtran7")
        ray = sums.in_layers(height[i], 0.5 * np.pi + depression[i])
        assert weights @ tau[i] == pytest.approx(weights @ ray.transmittance[-1], rel=TABLES, abs=1e-3 * weights.sum())
        assert weights @ path[i] == pytest.approx(weights @ ray.emitted, rel=TABLES, abs=1e-4)
        sun = sums.laws.source * sums.in_layers(0.0, solar[i]).transmittance[-1] if solar[i] <= 0.5 * np.pi else 0.0 * sums.laws.source
        assert weights @ light[i] == pytest.approx(weights @ sun, rel=TABLES, abs=1e-3)
        assert weights @ above[i] == pytest.approx(weights @ sums.in_layers(0.0, sky[i]).emitted, rel=TABLES)


def test_stencils_of_cubics_keep_the_kink():
    nodes = np.arange(8.0)

    def kinked(x):
        return np.where(x < 3.0, x**3, 27.0 - 5.0 * (x - 3.0) + (x - 3.0) ** 3)

    x = np.array([0.3, 2.9, 3.0, 3.1, 6.5, 7.0])
    np.testing.assert_allclose(Stencil.between_kinks(nodes, (3.0,), x).of(kinked(nodes)), kinked(x), rtol=0.0, atol=1e-9)


def test_stencils_do_not_reach_across_a_kink():
    found = Stencil.between_kinks(np.arange(8.0), (3.0,), np.array([1.5]))
    assert not found.weight[found.index >= 4].any()
    assert found.weight.sum() == pytest.approx(1.0)


def test_stencils_between_kinks_are_splines_of_their_parts():
    random = np.random.default_rng(1)
    nodes = np.sort(random.uniform(0.0, 9.0, 12))
    kinks = (float(nodes[4]), float(nodes[5]), float(nodes[9]))
    x = np.concatenate([random.uniform(nodes[0], nodes[-1], 40), nodes])
    values = random.normal(size=(12, 3))
    expected = np.empty((x.size, 3))
    for first, last in ((0, 4), (4, 5), (5, 9), (9, 11)):
        inside = (x >= nodes[first]) & (x <= nodes[last])
        expected[inside] = CubicSpline(nodes[first : last + 1], values[first : last + 1])(x[inside])
    np.testing.assert_allclose(Stencil.between_kinks(nodes, kinks, x).of(values), expected, rtol=1e-10, atol=1e-12)


def test_stencils_of_slopes_are_the_spline():
    random = np.random.default_rng(1)
    nodes, values = np.sort(random.uniform(0.0, 9.0, 12)), random.normal(size=(12, 3))
    x = np.concatenate([random.uniform(nodes[0], nodes[-1], 40), nodes])
    spline = CubicSpline(nodes, values)
    found = Stencil.hermite(nodes, x).of(with_slopes(nodes, values))
    np.testing.assert_allclose(found, spline(x), rtol=1e-10, atol=1e-10)
    beyond = Stencil.hermite(nodes, nodes[-1:] + 2.0).of(with_slopes(nodes, values))[0]
    np.testing.assert_allclose(beyond, values[-1] + 2.0 * spline(nodes[-1], 1), rtol=1e-10)


def test_a_product_of_stencils_is_the_spline_of_both_directions():
    random = np.random.default_rng(2)
    nodes, values, x = np.arange(6.0), random.normal(size=(6, 6)), random.uniform(0.0, 5.0, (2, 9))
    both = Stencil.between_kinks(nodes, (), x[0]).times(Stencil.hermite(nodes, x[1]))
    found = both.of(with_slopes(nodes, values[..., None]).reshape(-1))
    expected = [CubicSpline(nodes, CubicSpline(nodes, values)(a))(b) for a, b in x.T]
    np.testing.assert_allclose(found, expected, rtol=1e-11)


def test_outside_the_table_is_refused_or_sees_the_air_of_its_edge():
    air, wide = (BatchAtmosphere.load("midlatitude-summer", (3.5, 5.0), extrapolate=e) for e in (False, True))
    with pytest.raises(DomainError, match=r"25 m/s is outside 0-20 m/s"):
        air.path([25.0], [10.0], [0.1])
    with pytest.raises(DomainError, match=r"sensor height = 1 m is outside 2-10000 m"):
        air.path([5.0], [1.0], [0.1])
    with pytest.raises(DomainError, match="misses the sea"):
        air.path([5.0], [100.0], [1e-3])
    with pytest.raises(DomainError, match="zenith"):
        air.sky_radiance([5.0], [1.6])
    np.testing.assert_array_equal(wide.path([25.0], [10.0], [0.1])[0], air.path([20.0], [10.0], [0.1])[0])
    # Near the sea the air is the same at every height: paths of 25 m from 1 m and from 2 m, and 1 m straight down as half of 2 m.
    near, far = (wide.path([5.0], [h], [np.arcsin(h / 25.0)]) for h in (1.0, 2.0))
    np.testing.assert_allclose(np.log(near[0]), np.log(far[0]), rtol=1e-3)  # the sphere's curvature: 0.05 mm in 25 m
    np.testing.assert_allclose(near[1], far[1], rtol=1e-3)
    near, far = (wide.path([5.0], [h], [0.5 * np.pi])[0] for h in (1.0, 2.0))
    np.testing.assert_allclose(2.0 * np.log(near), np.log(far), rtol=1e-12)
    # Above 10 km there is hardly any air left in this band: a look straight down loses nothing more.
    above, top = (wide.path([5.0], [h], [0.5 * np.pi])[0] for h in (12e3, 10e3))
    np.testing.assert_allclose(above, top, rtol=1e-12)


def test_bands_and_models_outside_are_refused_with_what_there_is():
    with pytest.raises(DomainError, match=r"reaches beyond the tables of .* and .* um"):
        BatchAtmosphere.load("midlatitude-summer", (5.0, 8.0))
    with pytest.raises(DomainError, match=r"choose one of .*midlatitude-summer"):
        BatchAtmosphere.load("mars", (3.0, 5.0))
    assert {"midlatitude-summer", "us-standard-1976"} <= set(table_models())
