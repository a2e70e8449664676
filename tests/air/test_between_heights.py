"""Air between the sensor and a point at any height: LOWTRAN7's own runs, and what must hold whatever the numbers."""

import csv
from pathlib import Path

import numpy as np
import pytest

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.protocol import DEEPEST_LINE, slant_range
from seaglint.air.sampled_air import PathSamples, SampledAtmosphere, SunSamples
from seaglint.air.sun_and_sky import SkySamples
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.conventions import horizon_range
from seaglint.base.errors import DomainError
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.studies.build.profile_air import model_air

HEIGHT = 100.0

with (Path(__file__).parent / "lowtran7_between_heights.csv").open() as stream:
    ROWS = list(csv.DictReader(line for line in stream if not line.startswith("#")))

# Of transmittance, both ends below 1 km and otherwise; of radiance, in which LOWTRAN7's layers of a kilometre have one temperature each
# and the air has none.
TRANSMITTANCE, RADIANCE = (2e-3, 1e-2), 0.08


def sampled() -> SampledAtmosphere:
    """A table as a file would hold it, for one sensor height."""
    air = model_air("midlatitude-summer", 7.0, (3.5, 5.0))
    arc = np.concatenate([[0.0], np.geomspace(5.0, horizon_range(HEIGHT), 50)])
    one = np.ones((2, air.wavenumber_cm.size))
    return SampledAtmosphere.create(
        air.wavenumber_cm,
        height=HEIGHT,
        path=PathSamples(arc, *air.path(HEIGHT, arc), beyond=True),
        sun=SunSamples(np.array([0.0, 1.5]), one),
        skies=[SkySamples(0.0, np.array([0.0, 1.5]), 1e-4 * one)],
    )


MAKES = {
    "table": lambda: model_air("midlatitude-summer", 7.0, (3.5, 5.0)),
    "isothermal": lambda: IsothermalAtmosphere.for_band(288.0, 3.5, 5.0, extinction_per_m=2e-4),
    "vacuum": lambda: VacuumAtmosphere.for_band(3.5, 5.0),
    "sampled": sampled,
}


@pytest.fixture(scope="module", params=sorted(MAKES))
def any_air(request):
    return MAKES[request.param]()


@pytest.fixture(scope="module")
def table():
    return MAKES["table"]()


@pytest.mark.parametrize("band", [(3.0, 5.0), (3.5, 5.0), (8.0, 12.0)], ids=lambda b: f"{b[0]:g}-{b[1]:g}um")
@pytest.mark.parametrize("row", ROWS, ids=lambda r: f"{r['model']}-{r['sensor_height_m']}-{r['target_height_m']}m")
def test_lowtran7_between_two_heights(row, band):
    wind, height, target, arc = (float(row[k]) for k in ("wind_m_s", "sensor_height_m", "target_height_m", "range_m"))
    air = model_air(row["model"], wind, band, spectroscopy="lowtran7")
    weights = Band.rectangular(*band).weights(air.wavenumber_cm)
    tau, radiance = air.path(height, arc, target)
    label = f"[{band[0]:g}-{band[1]:g}]"
    assert weights @ tau / weights.sum() == pytest.approx(
        float(row["tau" + label]), rel=TRANSMITTANCE[max(height, target) >= 1000.0], abs=2e-5
    )
    assert weights @ radiance == pytest.approx(float(row["radiance" + label]), rel=RADIANCE)


def test_a_line_of_no_length_is_clear_and_dark(any_air):
    assert np.all(any_air.transmittance(HEIGHT, 0.0, HEIGHT) == 1.0)
    assert not any_air.path_radiance(HEIGHT, 0.0, HEIGHT).any()


def test_points_of_the_sea_are_the_sea(any_air):
    arc = np.array([[50.0, 700.0], [9e3, 31e3]])
    for found in (np.zeros(2), 0, np.zeros((2, 2))):
        np.testing.assert_array_equal(any_air.transmittance(HEIGHT, arc, found), any_air.transmittance(HEIGHT, arc))
        np.testing.assert_array_equal(any_air.path_radiance(HEIGHT, arc, found), any_air.path_radiance(HEIGHT, arc))
    mixed = any_air.path_radiance(HEIGHT, arc[0], [0.0, 50.0])
    np.testing.assert_allclose(mixed[0], any_air.path_radiance(HEIGHT, arc[0, 0]), rtol=1e-12)
    np.testing.assert_allclose(mixed[1], any_air.path_radiance(HEIGHT, arc[0, 1], 50.0), rtol=1e-9, atol=1e-300)


def test_range_and_height_broadcast(any_air):
    arc, target = np.array([[100.0], [2000.0], [9000.0]]), np.array([3.0, 400.0])
    tau, radiance = any_air.transmittance(HEIGHT, arc, target), any_air.path_radiance(HEIGHT, arc, target)
    assert tau.shape == radiance.shape == (3, 2, any_air.wavenumber_cm.size)
    np.testing.assert_allclose(tau[2, 1], any_air.transmittance(HEIGHT, 9000.0, 400.0), rtol=1e-12)


# Just above the sea, at the sensor's height, on its horizontal (which rises by arc^2 / 2R'), straight below and above.
@pytest.mark.parametrize(
    ("arc", "target"), [(5e3, 1e-6), (20.0, 1e-6), (5e3, HEIGHT), (100.0, HEIGHT), (12e3, HEIGHT + 9.68), (0.0, 50.0), (0.0, 250.0)]
)
def test_nothing_jumps_from_one_point_to_the_next(any_air, arc, target):
    step = 0.01  # metres: optical depth changes by 1e-4 of itself on the shortest line
    tau = any_air.transmittance(HEIGHT, arc, [max(target - step, 0.0), target, target + step])
    radiance = any_air.path_radiance(HEIGHT, arc, [max(target - step, 0.0), target, target + step])
    np.testing.assert_allclose(tau, tau[[1, 1, 1]], rtol=2e-3, atol=1e-9)
    np.testing.assert_allclose(radiance, radiance[[1, 1, 1]], rtol=2e-3, atol=1e-12)


def test_farther_points_are_seen_through_more_air(any_air):
    if isinstance(any_air, VacuumAtmosphere):
        pytest.skip("no air")
    for target in (5.0, HEIGHT, 900.0):
        tau = any_air.transmittance(HEIGHT, np.geomspace(1.0, 30e3, 60), target).mean(axis=1)
        assert np.all(np.diff(tau) < 0.0)
    assert np.all(np.diff(any_air.transmittance(HEIGHT, 8e3, [1.0, 100.0, 400.0, 900.0]).mean(axis=1)) > 0.0) or isinstance(
        any_air, IsothermalAtmosphere
    )


@pytest.mark.parametrize(("one", "other", "arc"), [(30.0, 700.0, 4e3), (2.0, 2500.0, 30e3), (150.0, 160.0, 200.0), (4000.0, 9000.0, 9e3)])
def test_ends_change_places(table, one, other, arc):
    np.testing.assert_allclose(table.transmittance(one, arc, other), table.transmittance(other, arc, one), rtol=1e-3, atol=1e-5)
    cavity = MAKES["isothermal"]()
    np.testing.assert_array_equal(cavity.transmittance(one, arc, other), cavity.transmittance(other, arc, one))


def test_opaque_air_shines_at_the_temperature_before_the_sensor(table):
    """The middle of the CO2 band between 30 m and 900 m, 4.5 K a kilometre, and from 3.5 km, where it falls by 6 K a kilometre."""
    channel = int(np.argmin(np.abs(table.wavenumber_cm - 2345.0)))
    up, down = (table.path_radiance(h, 5e3, z)[channel] for h, z in ((30.0, 900.0), (900.0, 30.0)))
    for seen, kelvin in ((up, 294.2 - 4.5 * 0.03), (down, 294.2 - 4.5 * 0.9)):
        assert seen == pytest.approx(planck_wavenumber(table.wavenumber_cm[channel], kelvin), rel=3e-3)
    down, up = (table.path_radiance(h, 20e3, z)[channel] for h, z in ((3500.0, 30.0), (30.0, 3500.0)))
    assert down == pytest.approx(planck_wavenumber(table.wavenumber_cm[channel], 279.2 - 6.0 * 0.5), rel=0.01)
    assert up == pytest.approx(planck_wavenumber(table.wavenumber_cm[channel], 294.2 - 4.5 * 0.03), rel=3e-3)


def test_the_cavity_is_exact(table):
    cavity = MAKES["isothermal"]()
    blackbody = planck_wavenumber(cavity.wavenumber_cm, 288.0)
    arc, target = np.array([0.0, 100.0, 7e3, 40e3]), np.array([600.0, 20.0, 3000.0, 500.0])
    tau = cavity.transmittance(HEIGHT, arc, target)
    np.testing.assert_allclose(cavity.path_radiance(HEIGHT, arc, target), (1.0 - tau) * blackbody, rtol=1e-12)
    np.testing.assert_allclose(-np.log(tau[0]), 2e-4 * 500.0, rtol=1e-12)
    np.testing.assert_allclose(-np.log(tau), 2e-4 * slant_range(HEIGHT, arc, target)[:, None] * np.ones(blackbody.size), rtol=1e-12)


def test_samples_of_air_thinning_with_the_scale_height_are_exact():
    """Extinction ``k exp(-z / 2 km)``: the law of equal amounts is then the physics, for steep lines of any length."""
    nu, k, height = np.arange(2000.0, 2100.0, 25.0), 4e-4, 1500.0
    arc = np.concatenate([[0.0], np.geomspace(50.0, 20e3, 80)])

    def depth(arc, target):
        rise = (np.exp(-target / 2e3) - np.exp(-height / 2e3)) * 2e3 / (height - target)
        return k * slant_range(height, arc, target) * rise

    samples = np.exp(-depth(arc, 0.0))[:, None] * np.ones(nu.size)
    one = np.ones((2, nu.size))
    air = SampledAtmosphere.create(
        nu,
        height=height,
        path=PathSamples(arc, samples, (1.0 - samples) * planck_wavenumber(nu, 280.0)),
        sun=SunSamples(np.array([0.0, 1.5]), one),
        skies=[SkySamples(0.0, np.array([0.0, 1.5]), one)],
    )
    arc, target = np.array([10.0, 300.0, 3e3, 6e3]), np.array([1400.0, 900.0, 30.0, 2500.0])
    tau, radiance = air.path(height, arc, target)
    np.testing.assert_allclose(-np.log(tau[:, 0]), depth(arc, target), rtol=3e-3)  # the round Earth, and the spline
    np.testing.assert_allclose(radiance, (1.0 - tau) * planck_wavenumber(nu, 280.0), rtol=2e-3)


def test_samples_of_low_air_agree_with_the_table(table):
    arc, target = np.array([30.0, 500.0, 5e3, 20e3, 800.0]), np.array([20.0, 60.0, 150.0, 15.0, 300.0])
    found = sampled().path(HEIGHT, arc, target)
    for ours, theirs in zip(found, table.path(HEIGHT, arc, target), strict=True):
        np.testing.assert_allclose(ours.sum(axis=1), theirs.sum(axis=1), rtol=0.03)  # 1.5 and 1.8 % in 95 of 100 cases below 300 m


def test_a_file_without_the_path_refuses_the_point():
    nu, one = np.arange(2000.0, 2100.0, 25.0), np.ones((2, 4))
    air = SampledAtmosphere.create(
        nu,
        height=HEIGHT,
        path=PathSamples(np.array([100.0, 2000.0]), 0.5 * one, 1e-5 * one),
        sun=SunSamples(np.array([0.0, 1.5]), one),
        skies=[SkySamples(0.0, np.array([0.0, 1.5]), one)],
    )
    assert np.all(air.transmittance(HEIGHT, 20.0, HEIGHT) > 0.5)
    with pytest.raises(DomainError, match="leave the point out or add longer paths"):
        air.transmittance(HEIGHT, 9e3, 50.0)
    with pytest.raises(DomainError, match="holds paths to 100 m only"):
        air.transmittance(50.0, 500.0, 50.0)


def test_points_behind_the_bulge_are_taken_down_to_a_depth(any_air):
    # From 100 m the sea horizon is at 39 km; the straight line to a point 1 m high at 60 km passes 20 m below the sea, at 100 km 121 m.
    assert np.all(np.isfinite(any_air.transmittance(HEIGHT, 60e3, 1.0)))
    with pytest.raises(DomainError, match=rf"more than {DEEPEST_LINE:g} m; leave out points that the sea hides"):
        any_air.transmittance(HEIGHT, 100e3, 1.0)
    with pytest.raises(DomainError, match="passes 300 m below the mean sea"):
        any_air.path_radiance(HEIGHT, [10.0, 10.0], [5.0, -300.0])
    assert any_air.transmittance(HEIGHT, 500.0, -2.0).mean() <= any_air.transmittance(HEIGHT, 500.0, 0.0).mean()


@pytest.mark.parametrize(("target", "names"), [(np.nan, "finite heights"), (np.inf, "finite heights"), (100.1e3, "above 100000 m")])
def test_impossible_points_are_refused(table, target, names):
    with pytest.raises(DomainError, match=names):
        table.transmittance(HEIGHT, 500.0, target)


def test_many_points_are_the_single_ones(table):
    """More points than are worked on at once."""
    random = np.random.default_rng(4)
    arc, target = random.uniform(10.0, 20e3, 700), random.uniform(0.5, 900.0, 700)
    tau, radiance = table.path(HEIGHT, arc, target)
    np.testing.assert_allclose(
        tau[[0, 511, 512, 699]], [table.transmittance(HEIGHT, arc[i], target[i]) for i in (0, 511, 512, 699)], rtol=1e-9
    )
    np.testing.assert_allclose(radiance[650], table.path_radiance(HEIGHT, arc[650], target[650]), rtol=1e-9)
