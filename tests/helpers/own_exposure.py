"""Own integrals of what a detector sees of small moving sources: geometry, blur and exposure without a line of the program."""

from __future__ import annotations

import math

import numpy as np
from scipy.constants import c, h, k
from scipy.special import j1

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

STEP = 60e-6
"""Angle between pixels [rad]."""

PITCH = 15e-6
COLUMNS, ROWS = 64, 48
HEIGHT = 50.0
BAND = (3.5, 5.0)


def sensor(f_number=2.5, exposure=0.005, **more):
    """A plane camera that looks north along the horizontal, without noise."""
    return {
        "pixels": [COLUMNS, ROWS],
        "projection": "pinhole",
        "azimuth_deg": 0.0,
        "elevation_deg": 0.0,
        "height_m": HEIGHT,
        "frames": 1,
        "optics": {"focal_length_m": PITCH / STEP, "f_number": f_number},
        "detector": {"pitch_um": 15.0, "integration_time_s": exposure, "gain_e_per_count": 1e9},
        "noise": {"temporal": False, "fixed_pattern": False},
        **more,
    }


def scene(objects, camera, **more):
    """A calm sea at night in clear air."""
    return parse_scenario(
        {
            "sea": {"resolve_waves": False},
            "band": {"min_um": BAND[0], "max_um": BAND[1]},
            "atmosphere": {"source": "isothermal", "temperature_k": 288.15, "extinction_per_km": 0.0},
            "sun": {"zenith_deg": 95.0, "azimuth_deg": 180.0},
            "sensor": camera,
            "objects": objects,
            **more,
        }
    )


def added(scenario, frame=0):
    """Change of the radiance on the pixels by the objects, the frame's arrays, and electrons per radiance."""
    run = prepare_sensed(scenario)
    arrays = run.images(frame)
    change = run.sensed.seen(frame).astype(float) - prepare_sensed(scenario.model_copy(update={"objects": None})).sensed.seen(frame)
    return change, arrays, run


def way(place, velocity, times):
    """Columns and rows (edges of pixels whole) and distances of a place [m, from the sensor's foot] at times [s] over the round sea."""
    east, north = place[0] + velocity[0] * times, place[1] + velocity[1] * times
    height = place[2] + velocity[2] * times
    arc = np.hypot(east, north)
    psi, radius = arc / EFFECTIVE_EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS + height
    x, y = radius * np.sin(psi) * east / arc, radius * np.sin(psi) * north / arc
    z = radius * np.cos(psi) - EFFECTIVE_EARTH_RADIUS - HEIGHT
    return COLUMNS / 2 + x / y / STEP, ROWS / 2 - z / y / STEP, np.sqrt(x * x + y * y + z * z)


def at(column, row, distance):
    """Place [m] that is seen at a column and a row (edges of pixels whole) from a distance along north [m]."""
    x, z = (column - COLUMNS / 2) * STEP * distance, (ROWS / 2 - row) * STEP * distance
    level = math.hypot(x, distance)
    radius = math.hypot(level, EFFECTIVE_EARTH_RADIUS + HEIGHT + z)
    psi = math.atan2(level, EFFECTIVE_EARTH_RADIUS + HEIGHT + z)
    return (EFFECTIVE_EARTH_RADIUS * psi * x / level, EFFECTIVE_EARTH_RADIUS * psi * distance / level, radius - EFFECTIVE_EARTH_RADIUS)


def pixel(column, row):
    """Solid angle of a pixel of the plane image at a place in it [sr]."""
    return STEP**2 * (1.0 + ((column - COLUMNS / 2) * STEP) ** 2 + ((row - ROWS / 2) * STEP) ** 2) ** -1.5


def optics(f_number):
    """Frequencies [cycles pixel-1] and transfer of diffraction, a mean over the band with the photons of 300 K."""
    wavelength = np.linspace(*BAND, 301) * 1e-6
    weight = wavelength**-4 / np.expm1(h * c / (wavelength * k * 300.0))
    cutoff = PITCH / (f_number * wavelength)
    frequency = np.linspace(0.0, cutoff.max(), 2001)
    v = np.clip(frequency[:, None] / cutoff, 0.0, 1.0)
    return frequency, (2.0 / np.pi * (np.arccos(v) - v * np.sqrt(1.0 - v * v))) @ (weight / weight.sum())


def seen(f_number, columns, rows, radius=0.0, rows_seen=None):
    """Light on all pixels of a disc of a radius [pixels], of 1 in all, that is at several places in turn [(rows, columns)].

    The integral over frequencies, without a Fourier transform on a grid of places.
    """
    known, table = optics(f_number)
    count = int(2 * known[-1] * 160) | 1
    f = np.linspace(-known[-1], known[-1], count)
    total = np.interp(np.hypot(f[None, :], f[:, None]), known, table) * np.sinc(f)[None, :] * np.sinc(f)[:, None]
    if radius > 0.0:
        q = np.maximum(2.0 * np.pi * radius * np.hypot(f[None, :], f[:, None]), 1e-9)
        total = total * 2.0 * j1(q) / q
    across, down = (np.exp(-2j * np.pi * np.outer(places, f)) / math.sqrt(len(columns)) for places in (columns, rows))
    spectrum = down.T @ across * total * (f[1] - f[0]) ** 2
    where = np.arange(ROWS) + 0.5 if rows_seen is None else rows_seen
    return (np.exp(2j * np.pi * np.outer(where, f)) @ spectrum @ np.exp(2j * np.pi * np.outer(f, np.arange(COLUMNS) + 0.5))).real


def planck(kelvin, weight=None):
    """Radiance of a blackbody in the band [W m-2 sr-1], with a weight of the wavelength [m]."""
    nu = 100.0 * np.linspace(1e4 / BAND[1], 1e4 / BAND[0], 8001)
    radiance = 2.0 * h * c**2 * nu**3 / np.expm1(h * c * nu / (k * kelvin))
    return np.trapezoid(radiance * (1.0 if weight is None else weight(1.0 / nu)), nu)
