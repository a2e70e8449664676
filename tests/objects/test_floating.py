"""What floats follows long waves, lies on their slope, and averages short ones; the same for the sensor."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.imaging.camera.imager import Attitude
from seaglint.imaging.camera.pose import Track
from seaglint.objects.body import Placement
from seaglint.objects.floating import Afloat, FloatingTrack, Swell
from seaglint.objects.motion import Course, Rest, heading_of, rotation
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.tiles import Tile
from seaglint.sea.wave_field import WaveField

AMPLITUDE, FREQUENCY = 0.5, 0.6


def plane_wave(length: float, azimuth: float = 0.6) -> Swell:
    k = 2.0 * np.pi / length
    return Swell((np.array([[k * np.sin(azimuth), k * np.cos(azimuth), FREQUENCY, AMPLITUDE, 0.0]]),), ())


def height(length: float, place, time: float, azimuth: float = 0.6) -> float:
    along = place[0] * np.sin(azimuth) + place[1] * np.cos(azimuth)
    return AMPLITUDE * np.cos(2.0 * np.pi / length * along - FREQUENCY * time)


def box_on(swell: Swell, heading: float = 0.0) -> Afloat:
    return Afloat(Rest(Placement(np.array([30.0, -20.0, 1.0]), rotation(heading))), swell, np.zeros(2), np.array([1.5, 5.0]))


def test_a_long_wave_lifts_by_its_height_and_tilts_by_its_slope():
    length, k = 2000.0, 2.0 * np.pi / 2000.0
    found = box_on(plane_wave(length), heading=0.6)
    for time in (0.0, 1.7, 4.0):
        at = found.at(time)
        assert at.position[2] - 1.0 == pytest.approx(height(length, (30.0, -20.0), time), abs=1e-4)
        slope = -AMPLITUDE * k * np.sin(k * (30 * np.sin(0.6) - 20 * np.cos(0.6)) - FREQUENCY * time)
        forward = at.rotation[:, 1]
        assert forward[2] / np.hypot(*forward[:2]) == pytest.approx(slope, rel=1e-3)  # wave and bow go the same way
        assert heading_of(at.rotation) == pytest.approx(0.6)


def test_the_plane_is_the_best_one_over_the_waterline():
    length, heading, time = 14.0, 0.25, 2.0
    lift = plane_wave(length).under(np.array([30.0, -20.0]), heading, np.array([1.5, 5.0]), time)
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1.5, 1.5, 61), np.linspace(-5, 5, 201)))
    east, north = 30 + x * np.cos(heading) + y * np.sin(heading), -20 - x * np.sin(heading) + y * np.cos(heading)
    plane, *_ = np.linalg.lstsq(np.column_stack([np.ones_like(x), x, y]), height(length, (east, north), time), rcond=None)
    # sums over points with their borders are coarser than integrals by some per cent of the side's end
    np.testing.assert_allclose([lift.height, lift.starboard, lift.forward], plane, rtol=0.03, atol=2e-4)


def test_waves_much_shorter_than_the_waterline_are_averaged_out():
    # a phase at which the wave would lift and tilt a point by 0.35 m and 1.6
    swell, place, half = plane_wave(1.37), np.array([30.1, -20.2]), np.array([15.0, 100.0])
    lifts = np.array([swell.under(place, 0.1, half, t) for t in np.linspace(0.0, 10.0, 23)])
    assert np.abs(lifts[:, 0]).max() < 0.003 * AMPLITUDE
    assert np.abs(lifts[:, 2:]).max() < 0.01
    points = np.array([swell.under(place, 0.1, np.zeros(2), t) for t in np.linspace(0.0, 10.0, 23)])
    assert np.abs(points[:, 0]).max() == pytest.approx(AMPLITUDE, rel=0.02)


def test_velocity_is_the_derivative_of_the_place():
    start = Placement(np.array([30.0, -20.0, 1.0]), rotation(0.4))
    found = Afloat(Course(start, np.array([3.0, 4.0, 0.0])), plane_wave(25.0), np.zeros(2), np.array([1.0, 1.0]))
    level = Afloat(found.base, found.swell, found.centre, found.half_sides)
    step = 1e-4
    rise = (level.at(2.0 + step).position[2] - level.at(2.0 - step).position[2]) / (2 * step)
    # the origin stands 1 m above the waterline: its height changes by the cosine of the tilt too
    lift = [found.swell.under(found.base.at(t).position[:2], 0.4, found.half_sides, t).height for t in (2.0 - step, 2.0 + step)]
    assert found.velocity(2.0)[2] == pytest.approx((lift[1] - lift[0]) / (2 * step), rel=1e-5)
    assert found.velocity(2.0)[2] == pytest.approx(rise, abs=0.05)


@pytest.fixture(scope="module")
def sea() -> WaveField:
    spectrum = JonswapSpectrum(1.0, 6.0, 0.4)
    return WaveField.create(spectrum, [Tile(400.0, 128, 0.3, 0.03, 0.5)], 5, wander=True)


def test_a_small_buoy_is_on_the_sea_that_pictures_show(sea):
    still = WaveField.create(sea.spectrum, sea.tiles, 5)
    surface = still.surfaces(3.0)[0]
    tile, swell = still.tiles[0], Swell.of(still)
    c, s, step = np.cos(tile.rotation), np.sin(tile.rotation), tile.length / tile.n
    for ix, iy in ((0, 0), (17, 100), (90, 31)):
        place = np.array([c * ix - s * iy, s * ix + c * iy]) * step
        lift = swell.under(place, 0.0, np.zeros(2), 3.0)
        # waves of a millionth of the variance are left out
        np.testing.assert_allclose([lift.height, lift.starboard, lift.forward], surface[iy, ix], atol=2e-3)
    # with wandering tiles the place is read aside, and slopes are the derivative of what is read
    swell, place, h = Swell.of(sea), np.array([800.0, -1500.0]), 1e-2
    lift = swell.under(place, 0.0, np.zeros(2), 3.0)
    steps = [swell.under(place + d, 0.0, np.zeros(2), 3.0).height for d in ((h, 0), (-h, 0), (0, h), (0, -h))]
    assert lift.starboard == pytest.approx((steps[0] - steps[1]) / (2 * h), rel=1e-4)
    assert lift.forward == pytest.approx((steps[2] - steps[3]) / (2 * h), rel=1e-4)
    assert lift == swell.under(place, 0.0, np.zeros(2), 3.0)


def test_heave_has_the_variance_of_the_sea(sea):
    heights = [
        Swell.of(sea).under(np.array([x, y]), 0.0, np.zeros(2), 0.0).height for x in range(0, 40000, 1700) for y in range(0, 9000, 900)
    ]
    # 240 places some waves apart: a standard error of 5 %
    assert np.var(heights) == pytest.approx(sea.height_variance, rel=0.2)


def test_a_floating_sensor_heaves_pitches_and_rolls():
    base = Track.standing(20.0, Attitude(0.6, -0.05, 0.0))
    found = FloatingTrack.create(base, plane_wave(400.0), (3.0, 10.0), None, np.linspace(0.0, 10.0, 101))
    k = 2.0 * np.pi / 400.0
    for time in (0.0, 3.3, 8.0):
        pose = found.at(time)
        slope = AMPLITUDE * k * np.sin(FREQUENCY * time)
        assert pose.height == pytest.approx(20.0 * np.cos(np.arctan(slope)) + AMPLITUDE * np.cos(FREQUENCY * time), abs=1e-3)
        # looking the way the wave goes the camera pitches by the slope, and the mast leans back
        assert pose.attitude.elevation == pytest.approx(-0.05 + np.arctan(slope), abs=1e-4)
        lean = pose.east * np.sin(0.6) + pose.north * np.cos(0.6)
        assert lean == pytest.approx(-20.0 * np.sin(np.arctan(slope)), abs=1e-3)
    across = FloatingTrack.create(base, plane_wave(400.0, 0.6 + np.pi / 2), (3.0, 10.0), None, np.linspace(0.0, 10.0, 101))
    # the sea rises to starboard: the right side goes up
    assert across.at(1.0).attitude.roll == pytest.approx(-np.arctan(AMPLITUDE * k * np.sin(FREQUENCY)), rel=1e-2)
    assert found.turns
    assert found.moves
    (_, _), (low, high), _ = found.reach()
    assert low < -0.05 - 0.99 * AMPLITUDE * k
    assert high > -0.05 + 0.99 * AMPLITUDE * k
    assert found.lowest < 19.5 < 20.5 < found.highest


@pytest.mark.parametrize("time", [0.0, 1.7, 40.0])
def test_the_waterline_is_fixed_to_the_body(time):
    """The plane of the flat sea, 1 m below the origin, heaves and leans with the hull."""
    at = box_on(plane_wave(60.0), heading=0.4).at(time)
    normal, point = at.water
    np.testing.assert_allclose(at.rotation.T @ normal, [0.0, 0.0, 1.0], atol=1e-12)
    assert normal @ (point - at.position) == pytest.approx(-1.0, abs=1e-12)
    assert abs(normal[2] - 1.0) > 1e-9
