"""Scenes that several tests of the renderer look at."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.interpolate import BSpline

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.protocol import slant_range
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.attitude_scene import TurnedScene
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.layers import Layers
from seaglint.imaging.scene import Accuracy, Scene, image
from seaglint.imaging.sparkle_settings import NO_SPARKLES
from seaglint.imaging.upright_scene import SweptScene
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.sea_water import WaterIndex
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import Tile, plan_tiles
from seaglint.sea.wave_field import WaveField
from seaglint.studies.build.profile_air import model_air

BAND = Band.rectangular(3.5, 5.0)
SEA_TEMPERATURE = 288.15
CUBIC = BSpline(np.arange(-5.0, 6.0), np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]), 3)
SLOPE = CUBIC.derivative()


class Furnace(IsothermalAtmosphere):
    """Air, sky and sea at one temperature, with an extinction that changes over the band, so that the path needs several spectral terms."""

    def transmittance(self, height, range_m, target_height=0.0):
        path = slant_range(height, np.asarray(range_m, dtype=float))[..., None]
        return np.exp(-path * 1e-3 * np.abs(np.sin(self.wavenumber_cm / 60.0)))


class WarmSky(VacuumAtmosphere):
    """No air, the Sun, and a sky whose temperature falls towards the zenith."""

    def sky_radiance(self, zenith, azimuth, height=0.0):
        temperature = 200.0 + 80.0 * np.sin(np.asarray(zenith, dtype=float)) ** 4
        return planck_wavenumber(self.wavenumber_cm, temperature[..., None])


class RangeFog(VacuumAtmosphere):
    """Cold air whose transmittance tells the range: ``exp(-arc/SCALE)``; a black sky and no Sun."""

    SCALE = 2000.0

    def transmittance(self, height, range_m, target_height=0.0):
        tau = np.exp(-np.asarray(range_m, dtype=float) / self.SCALE)[..., None]
        return np.broadcast_to(tau, (*tau.shape[:-1], self.wavenumber_cm.size)).copy()

    def solar_irradiance(self, solar_zenith):
        return np.zeros((*np.shape(solar_zenith), self.wavenumber_cm.size))


def black_water() -> WaterIndex:
    """A liquid that reflects nothing: what is seen is where it is, not how it is tilted."""
    return WaterIndex("black", np.array([2.0, 15.0]), np.ones(2), np.full(2, 1e-300))


def furnace() -> Furnace:
    return Furnace.for_band(SEA_TEMPERATURE, BAND.min_um, BAND.max_um)


def table_air(wind, model="midlatitude-summer"):
    return model_air(model, wind, (BAND.min_um, BAND.max_um))


def sea_view(air, slopes, height=30.0, sun_zenith=60.0, sun_azimuth=0.0, **changes) -> SeaView:
    """View with the Sun's angles in degrees."""
    inputs = {
        "atmosphere": air,
        "band": BAND,
        "water": sea_water.hale_querry_sea(),
        "slopes": slopes,
        "sea_temperature": SEA_TEMPERATURE,
        "sensor_height": height,
        "solar_zenith": np.radians(sun_zenith),
        "solar_azimuth": np.radians(sun_azimuth),
    }
    return SeaView(**(inputs | changes))


def camera(height, top, bottom, rows, *, azimuth=0.0, width=1.0, columns=1) -> Camera:
    """Camera whose rows reach from elevation ``top`` to ``bottom``; all angles in degrees."""
    return Camera(height, np.radians(azimuth), np.radians(0.5 * (top + bottom)), np.radians(width), np.radians(top - bottom), columns, rows)


def swept_scene(view, camera, waves=None, *, layers=(), sparkles=NO_SPARKLES, **accuracy) -> SweptScene:
    """Scene of an upright camera; further settings are those of its accuracy."""
    return SweptScene.prepare(view, camera, waves, accuracy=Accuracy(**accuracy), layers=layers, sparkles=sparkles)


def turned_scene(view_at, imager, track, waves=None, *, layers=(), **accuracy) -> TurnedScene:
    """Scene of a camera in any attitude."""
    return TurnedScene.prepare(view_at, imager, track, waves, accuracy=Accuracy(**accuracy), layers=layers)


def shown(scene: Scene, time: float) -> Layers:
    """What the camera sees at a time [s], from where it is then."""
    return image(scene, scene.track.at(time) if isinstance(scene, TurnedScene) else scene.pose, time)


@cache
def elfouhaily(wind, travel_deg=30.0, shortest_wave=2.0, seed=1, wander=False) -> WaveField:
    """Small, quick field of a fully developed sea; ``elfouhaily.__wrapped__`` makes another one."""
    spectrum = ElfouhailySpectrum(wind, np.radians(travel_deg))
    return WaveField.create(spectrum, plan_tiles(spectrum, shortest_wave, 128 if wind < 12.0 else 256), seed, wander=wander)


@cache
def one_tile(wind=4.0, seed=3, *, points=128, length=64.0, shortest_wave=3.0, turn=0.4) -> WaveField:
    """One tile of short steep waves: small enough for plain Python to march over."""
    spectrum = ElfouhailySpectrum(wind, 0.5)
    return WaveField.create(spectrum, (Tile(length, points, turn, 2.0 * np.pi * 6.0 / length, 2.0 * np.pi / shortest_wave),), seed)


def bilinear(tile, spacing, turn, x, y):
    """Components of one periodic tile at points (x, y): rows along v, columns along u."""
    n = tile.shape[0]
    u = (np.cos(turn) * x + np.sin(turn) * y) / spacing
    v = (-np.sin(turn) * x + np.cos(turn) * y) / spacing
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    fu, fv = (u - i)[..., None], (v - j)[..., None]
    low = (1 - fu) * tile[j % n, i % n] + fu * tile[j % n, (i + 1) % n]
    high = (1 - fu) * tile[(j + 1) % n, i % n] + fu * tile[(j + 1) % n, (i + 1) % n]
    return (1 - fv) * low + fv * high


def spline(coefficients, spacing, turn, x, y):
    """Height and slopes towards east and north of a cubic B-spline on one periodic tile at points (x, y), by SciPy's basis functions."""
    n = coefficients.shape[0]
    c, s = np.cos(turn) / spacing, np.sin(turn) / spacing
    u, v = c * x + s * y, c * y - s * x
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    out = np.zeros((3, *np.shape(u)))
    for m in range(-1, 3):
        for k in range(-1, 3):
            z = coefficients[(j + m) % n, (i + k) % n]
            a, b = u - i - k, v - j - m
            out += z * np.stack([CUBIC(a) * CUBIC(b), SLOPE(a) * CUBIC(b), CUBIC(a) * SLOPE(b)])
    return np.stack([out[0], c * out[1] - s * out[2], s * out[1] + c * out[2]], axis=-1)


def read(lattice, spacing, turn, x, y):
    """Height and slopes of one tile as the renderer reads a lattice of its ``coefficients``."""
    found = spline(lattice[..., -1], spacing, turn, x, y)
    if lattice.shape[2] == 2:
        found[..., 0] = bilinear(lattice, spacing, turn, x, y)[..., 0]
    return found
