r"""Disc of the Sun or the Moon in the sky of an image: uniform with a sharp limb, cut by the skyline of the sea.

At an azimuth ``a`` from the Sun the disc reaches over the elevations ``phi - delta`` to ``phi + delta`` with

.. math:: \tan\phi = \tan e_s / \cos a, \qquad \cos\delta = \cos\epsilon / \sqrt{1 - \cos^2 e_s \sin^2 a}

Chords are added to the rows that they cross, in solid angle, so that the image contains the light of the whole disc for any position
relative to the pixels. Of the Moon's disc the lit part is drawn, between the limb and the terminator: with u towards the middle of the
bright limb and v across, in the plane that touches the sphere at the centre, points with ``u + cos(phase) sqrt(tan^2(eps) - v^2) > 0``.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import DARK_SUN, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DomainError
from seaglint.base.jit import kernel
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import is_dark
from seaglint.facet.sunlight import visible_sun

#: Number of chords of the disc in a column, at even steps of the arc sine of their distance from the middle: within 1e-5 of its area.
CHORDS: Final = 32

_ROUNDING: Final = 1e-9  #: Angle by which the elevations of a limb and of an edge may be rounded [rad].

_LEAST: Final = 1e-12  #: Least solid angle of a lit part [sr]: that of the thinnest crescents, which have hardly any light.

_FLAT: Final = 1e-6  #: Half axis of a terminator, in radii, below which it is a straight line.

_LARGE: Final = 1.5  #: Angle from the Sun of all corners beyond which a pixel does not contain it [rad].


class SunInSky(NamedTuple):
    """Disc in the sky, or its lit part (``seaglint.facet.sea_view.LightDisc``)."""

    radiance: float  #: Radiance of the lit part [W m-2 sr-1]; 0 without a disc.
    azimuth: float  #: Azimuth of the disc's centre [rad].
    elevation: float  #: Apparent elevation of the disc's centre at the sensor [rad].
    radius: float  #: Angular radius [rad].
    #: Half axis of the terminator over the radius, the cosine of the phase [1]; 1 for a full disc, -1 for a dark one.
    terminator: float
    limb_up: float  #: Direction of the middle of the bright limb: its part upwards [1].
    limb_right: float  #: Its part to the right [1].


NO_SUN: Final = SunInSky(0.0, 0.0, 0.0, SOLAR_ANGULAR_RADIUS, 1.0, 1.0, 0.0)


def sun_in_sky(view: SeaView, top: float = 0.5 * math.pi) -> SunInSky:
    """Return the disc in view of a sensor, with the radiance ``E / (pi eps^2)`` for the light E at the sensor's height.

    The radiance of a disc of which a part is lit is higher, so that the lit part has all of the light.

    Its elevation is the apparent elevation at the sensor's height, the centre of the aureole. For air with sunlight at the sea only, a disc
    below the horizon at the sensor's foot has the light of a disc on the horizon. ``NO_SUN`` for a disc below the sensor's horizon, or
    above the elevation ``top`` of a picture's upper edge [rad]: its light at the sensor's height would be computed for nothing.
    """
    disc = view.disc
    zenith, azimuth = disc.centre or (view.solar_zenith, view.solar_azimuth)
    table, elevation = view.scattered.sky, 0.5 * math.pi - zenith
    if not is_dark(table):
        # refraction between the sea and the sensor
        elevation += min(view.solar_zenith, DARK_SUN) - table.solar_zenith
    dip = horizon_depression(view.sensor_height)
    if elevation + disc.radius <= -dip or elevation - disc.radius > top + _ROUNDING:
        return NO_SUN
    # a disc that the horizon cuts has the light of its part above it
    sunlight = view.atmosphere.sunlight_at(view.sensor_height, 0.5 * math.pi - max(elevation, 0.5 * disc.radius - dip))
    if sunlight is not None:
        spectrum = view.above_air(sunlight[view.in_band.grid])
    else:
        spectrum = view.irradiance
        if visible_sun(view.solar_zenith)[0] == 0.0:
            try:
                spectrum = view.above_air(view.atmosphere.solar_irradiance(0.5 * math.pi)[view.in_band.grid])
            except DomainError as error:
                if error.name != "solar_zenith":
                    raise
    radiance = float(spectrum @ view.in_band.weights) / max(disc.solid_angle, _LEAST)
    limb = disc.bright_limb
    return SunInSky(radiance, float(azimuth), float(elevation), disc.radius, 2.0 * disc.lit - 1.0, math.cos(limb), math.sin(limb))


@kernel
def reach(sun: SunInSky) -> float:
    """Return the largest azimuth of the disc from its centre [rad]; pi for a disc that contains the zenith."""
    ratio = math.sin(sun.radius) / max(math.cos(sun.elevation), 1e-9)
    return math.asin(ratio) if ratio < 1.0 else math.pi


@kernel
def chord(sun: SunInSky, azimuth: float) -> tuple[float, float]:
    """Return the elevations of the lower and upper limb at an azimuth from the disc's centre [rad]; equal values beside the disc."""
    across = math.cos(sun.elevation) * math.sin(azimuth)
    radius = math.sin(sun.radius)
    middle = math.atan2(math.sin(sun.elevation), math.cos(sun.elevation) * math.cos(azimuth))
    square = radius * radius - across * across
    half = math.asin(min(math.sqrt(square / (1.0 - across * across)), 1.0)) if square > 0.0 else 0.0
    return middle - half, min(middle + half, 0.5 * math.pi)


@kernel
def _in_plane(sun: SunInSky, azimuth: float, elevation: float) -> tuple[float, float]:
    """Return a point of the plane that touches the sphere at the disc's centre: towards the middle of the bright limb, and across."""
    sine, cosine = math.sin(sun.elevation), math.cos(sun.elevation)
    height, towards = math.sin(elevation), math.cos(elevation) * math.cos(azimuth)
    per_depth = 1.0 / (height * sine + towards * cosine)
    right, up = math.cos(elevation) * math.sin(azimuth) * per_depth, (height * cosine - towards * sine) * per_depth
    return up * sun.limb_up + right * sun.limb_right, right * sun.limb_up - up * sun.limb_right


@kernel
def lit_parts(sun: SunInSky, azimuth: float, low: float, high: float) -> tuple[float, float, float, float]:
    """Return the lit parts of a chord between the limbs ``low`` and ``high``: lower and upper elevation of two parts [rad].

    The second part, or both, may be empty. The chord is straight in the plane, and elevation is even along it within 1e-5. The terminator
    crosses it twice at most, because either the lit or the dark part of the disc is convex.
    """
    u, v = _in_plane(sun, azimuth, low)
    end_u, end_v = _in_plane(sun, azimuth, high)
    du, dv = end_u - u, end_v - v
    k, square = sun.terminator, math.tan(sun.radius) ** 2
    a, b, c = du * du + k * k * dv * dv, u * du + k * k * v * dv, u * u + k * k * (v * v - square)
    root = math.sqrt(max(b * b - a * c, 0.0)) / max(a, 1e-300)
    first, last = min(max(-b / max(a, 1e-300) - root, 0.0), 1.0), min(max(-b / max(a, 1e-300) + root, 0.0), 1.0)
    cuts = (0.0, first, last, 1.0)
    ends = (low, low, low, low)
    begins, parts = False, 0
    for n in range(3):
        middle = 0.5 * (cuts[n] + cuts[n + 1])
        across = v + middle * dv
        lit = cuts[n + 1] > cuts[n] and u + middle * du + k * math.sqrt(max(square - across * across, 0.0)) > 0.0
        if not lit:
            begins = False
            continue
        lower, upper = low + cuts[n] * (high - low), low + cuts[n + 1] * (high - low)
        if begins:  # goes on from the part below
            ends = (ends[0], upper, ends[2], ends[3]) if parts == 1 else (ends[0], ends[1], ends[2], upper)
        elif parts == 0:
            ends, parts = (lower, upper, upper, upper), 1
        else:
            ends, parts = (ends[0], ends[1], lower, upper), 2
        begins = True
    return ends


@kernel
def add_disc(sun: SunInSky, top: float, per_radian: float, column: tuple[float, float], skyline: np.ndarray, image: np.ndarray) -> None:
    """Add the disc to the rows ``image`` (rows,) of a column, ``column = (azimuth, width)`` [rad].

    ``skyline``: tangents of the elevations that the sea reaches, at even steps across the column; ``top`` and ``per_radian`` as in
    ``Rows``.
    """
    azimuth, width = column
    limit = reach(sun)
    off = azimuth - sun.azimuth
    off -= 2.0 * math.pi * math.floor(off / (2.0 * math.pi) + 0.5)
    for turn in range(-1, 2):  # a column as wide as the circle sees the disc on both sides
        left, right = off + 2.0 * math.pi * turn - 0.5 * width, off + 2.0 * math.pi * turn + 0.5 * width
        first, last = max(left, -limit), min(right, limit)
        if sun.radiance <= 0.0 or first >= last:
            continue
        # even steps of the arc sine put more chords near the ends, where the length of chords changes fastest
        begin, end = math.asin(max(first / limit, -1.0)), math.asin(min(last / limit, 1.0))
        for n in range(CHORDS):
            t = begin + (n + 0.5) / CHORDS * (end - begin)
            a = limit * math.sin(t)
            share = sun.radiance * limit * math.cos(t) * (end - begin) / CHORDS / width
            low, high = chord(sun, a)
            j = min(max(int((a - left) / width * skyline.shape[0]), 0), skyline.shape[0] - 1)
            skyward = math.atan(skyline[j])
            if sun.terminator >= 1.0:
                _add_chord(share, max(low, skyward), high, top, per_radian, image)
            else:
                parts = lit_parts(sun, a, low, high)
                _add_chord(share, max(parts[0], skyward), parts[1], top, per_radian, image)
                _add_chord(share, max(parts[2], skyward), parts[3], top, per_radian, image)


@kernel
def _add_chord(share: float, low: float, high: float, top: float, per_radian: float, image: np.ndarray) -> None:
    """Add light between two elevations [rad] to the rows that it crosses."""
    row = int(max((top - high) * per_radian, 0.0))
    while row < image.shape[0] and top - row / per_radian > low:
        upper, lower = top - row / per_radian, top - (row + 1) / per_radian
        inside = math.sin(min(high, upper)) - math.sin(max(low, lower))
        if inside > 0.0:
            image[row] += share * inside / (math.sin(upper) - math.sin(lower))
        row += 1


def disc_in_pixels(sun: SunInSky, corner: FloatArray, pixels: NDArray[np.int64]) -> FloatArray:
    """Return the mean radiance of the disc in pixels [W m-2 sr-1, (pixels,)]; flat indices between ``corner`` (rows + 1, columns + 1, 3).

    The disc is not hidden. Great circles through the corners are the sides of pixels; in the plane that touches the sphere at the Sun they
    are straight, and the disc is a circle.
    """
    out = np.zeros(pixels.size)
    if sun.radiance <= 0.0 or pixels.size == 0:
        return out
    se, ce, sa, ca = math.sin(sun.elevation), math.cos(sun.elevation), math.sin(sun.azimuth), math.cos(sun.azimuth)
    axes = np.array([[ca, -sa, 0.0], [-se * sa, -se * ca, ce], [ce * sa, ce * ca, se]])
    row, column = np.divmod(pixels, corner.shape[1] - 1)
    at = np.stack([corner[row + i, column + j] for i, j in ((0, 0), (0, 1), (1, 1), (1, 0))], axis=1)
    in_axes = at @ axes.T
    near = (in_axes[..., 2] > math.cos(_LARGE)).all(axis=1)
    plane = in_axes[near, :, :2] / in_axes[near, :, 2:]
    radius = math.tan(sun.radius)
    sides = [(plane[:, k], plane[:, (k + 1) % 4]) for k in range(4)]
    if sun.terminator >= 1.0:
        area = np.abs(sum(_sector(p, q, radius) for p, q in sides))
    else:
        area = np.abs(sum(_lit_sector(p, q, radius, sun) for p, q in sides))
    # ratio of the disc's solid angle on the sphere to its area in the plane
    scale = 2.0 * (1.0 - math.cos(sun.radius)) / radius**2
    out[near] = sun.radiance * area * scale / _solid_angle(at[near])
    return out


def _lit_sector(p: FloatArray, q: FloatArray, radius: float, sun: SunInSky) -> FloatArray:
    """Return the signed area between the centre and sides p-q (n, 2), inside the lit part of the disc [unit squared, (n,)].

    The lit part is the half of the disc at the bright limb, and half of an ellipse, which is added to it or, of a crescent, left out. The
    line between both halves passes through the centre, so that it has no area with it.
    """
    turn = np.array([[sun.limb_right, sun.limb_up], [sun.limb_up, -sun.limb_right]])
    p, q = p @ turn.T, q @ turn.T
    half = _sector(*_beside(p, q, 1.0), radius)
    k = abs(sun.terminator)
    if k < _FLAT:
        return half
    squeeze = np.array([1.0 / k, 1.0])
    first, last = _beside(p, q, -1.0 if sun.terminator > 0.0 else 1.0)
    return np.asarray(half + sun.terminator * _sector(first * squeeze, last * squeeze, radius))


def _beside(p: FloatArray, q: FloatArray, sign: float) -> tuple[FloatArray, FloatArray]:
    """Return the parts of sides p-q (n, 2) where the first coordinate has a sign; sides without such a part shrink to a point."""
    a, b = sign * p[:, 0], sign * q[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = np.where((a > 0.0) != (b > 0.0), a / (a - b), 0.0)[:, None]
    at = p + crossing * (q - p)
    first, last = np.where((a > 0.0)[:, None], p, at), np.where((b > 0.0)[:, None], q, at)
    dark = ((a <= 0.0) & (b <= 0.0))[:, None]
    return np.where(dark, p, first), np.where(dark, p, last)


def _sector(p: FloatArray, q: FloatArray, radius: float) -> FloatArray:
    """Return the signed area between the centre of the circle, the origin, and sides p-q (n, 2), inside the circle [unit squared, (n,)]."""
    d = q - p
    a, b, c = np.sum(d * d, axis=1), np.sum(p * d, axis=1), np.sum(p * p, axis=1) - radius**2
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    size = np.maximum(a, 1e-300)
    first, last = np.clip((-b - root) / size, 0.0, 1.0)[:, None], np.clip((-b + root) / size, 0.0, 1.0)[:, None]
    into, out = p + first * d, p + last * d

    def cross(u: FloatArray, v: FloatArray) -> FloatArray:
        return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    def arc(u: FloatArray, v: FloatArray) -> FloatArray:
        return np.asarray(0.5 * radius**2 * np.arctan2(cross(u, v), np.sum(u * v, axis=1)))

    return arc(p, into) + 0.5 * cross(into, out) + arc(out, q)


def _solid_angle(at: FloatArray) -> FloatArray:
    """Return solid angles of quadrilaterals of unit vectors [sr, (n, 4, 3) to (n,)], as two triangles (Van Oosterom and Strackee 1983)."""

    def triangle(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
        volume = np.abs(np.sum(a * np.cross(b, c), axis=1))
        below = 1.0 + np.sum(a * b, axis=1) + np.sum(b * c, axis=1) + np.sum(c * a, axis=1)
        return np.asarray(2.0 * np.arctan2(volume, below))

    return np.asarray(triangle(at[:, 0], at[:, 1], at[:, 2]) + triangle(at[:, 0], at[:, 2], at[:, 3]))
