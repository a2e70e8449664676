"""Solar disc in slope space: its covariance transformed to slopes by the mirror's Jacobian, and its sharp edge.

The density of a facet's slopes is convolved with the disc, whose covariance is ``eps^2/4`` in every direction.

Averages over slope statistics are in :mod:`seaglint.facet.glint`; each quadrature is the other's check.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.jit import kernel, njit
from seaglint.facet.roughness import Roughness, Sight
from seaglint.facet.sunlight import Sunlight

DISC_ROWS = (17, 6)  #: Number of rows of a ``DiscLine``, for an error of the glint below 1.5e-3, and number of their fields.

#: Ratio of the Sun's image to the slope variance above which its sharp edge counts: below it the glint's peak moves by less than 0.4 %.
SHARP_DISC = 0.1


class Disc(NamedTuple):
    """Solar disc in slope space, convolved with the facets' roughness, at one grazing angle.

    ``east, north``: its middle, from the slope that mirrors the Sun's centre; ``ee, en, nn``: halves of the inverse covariance of facet and
    disc together (``en`` twice); ``peak``: logarithm of a quarter of their density at the middle.
    """

    east: float
    north: float
    ee: float
    en: float
    nn: float
    peak: float


class DiscLine(NamedTuple):
    """Table of ``Disc`` along a line of sight at even steps of ``1/(sin(grazing) + sin(Sun's elevation))``.

    ``rows[i]`` are its fields.

    Without rows it is not tabled: facets are so smooth that the shape of the disc counts, or it is for single rays.
    """

    rows: np.ndarray
    first: float
    per_step: float


@kernel
def sharp(rough: Roughness, disc: tuple[float, float, float]) -> bool:
    """True where the disc's covariance of slopes is so large relative to the facet's that its edge counts."""
    return disc[0] + disc[2] > SHARP_DISC / (1.0 - SHARP_DISC) * (rough.east_east + rough.north_north)


@kernel
def disc_of(sun: Sunlight, rough: Roughness, mz: float, se: float, sn: float) -> tuple[Disc, tuple[float, float, float]]:
    """Disc about a mirroring slope, and its own covariance of slopes (ee, en, nn); ``mz`` as in ``disc_in_slopes``."""
    disc_ee, disc_en, disc_nn, shift_e, shift_n = disc_in_slopes(sun, mz, se, sn)
    # the weight 1/cos^4(beta), growing as exp(4 s/(1+s^2) . ds) across the disc's image, moves its centre
    lean = 4.0 / (1.0 + se * se + sn * sn)
    east, north = shift_e + lean * (disc_ee * se + disc_en * sn), shift_n + lean * (disc_en * se + disc_nn * sn)
    ee, en, nn = disc_ee + rough.east_east, disc_en + rough.east_north, disc_nn + rough.north_north
    det = ee * nn - en * en
    peak = math.log(0.125 / (math.pi * math.sqrt(det)))
    return Disc(east, north, 0.5 * nn / det, -en / det, 0.5 * ee / det, peak), (disc_ee, disc_en, disc_nn)


@kernel
def disc_at(line: DiscLine, per_mz: float) -> Disc:
    """Disc interpolated between two rows of a line's table."""
    x = (per_mz - line.first) * line.per_step
    # unsigned indices spare the compiler's check for negative ones
    i = np.uint64(min(max(int(x), 0), line.rows.shape[0] - 2))
    f = x - float(i)
    a, b = line.rows[i], line.rows[np.uint64(i + np.uint64(1))]
    return Disc(
        a[0] + f * (b[0] - a[0]),
        a[1] + f * (b[1] - a[1]),
        a[2] + f * (b[2] - a[2]),
        a[3] + f * (b[3] - a[3]),
        a[4] + f * (b[4] - a[4]),
        a[5] + f * (b[5] - a[5]),
    )


@kernel
def broadened(disc: Disc, spread: tuple[float, float, float]) -> Disc:
    """Disc with a covariance of slopes (ee, en, nn) added to the covariance of facet and disc: ``(P^-1 + V)^-1 = (1 + P V)^-1 P``."""
    p, q, r = 2.0 * disc.ee, disc.en, 2.0 * disc.nn
    a, b = 1.0 + p * spread[0] + q * spread[1], p * spread[1] + q * spread[2]
    c, d = q * spread[0] + r * spread[1], 1.0 + q * spread[1] + r * spread[2]
    det = a * d - b * c
    per_det = 1.0 / det
    ee, en, nn = (d * p - b * q) * per_det, (d * q - b * r) * per_det, (a * r - c * q) * per_det
    return Disc(disc.east, disc.north, 0.5 * ee, en, 0.5 * nn, disc.peak - 0.5 * math.log(det))


@njit
def no_disc_line() -> DiscLine:
    """Empty table for single rays."""
    return DiscLine(np.empty((0, DISC_ROWS[1])), 0.0, 0.0)


@njit
def disc_line(sun: Sunlight, rough: Roughness, sight: Sight, sines: tuple[float, float], rows: np.ndarray, turn: float = 0.0) -> DiscLine:
    """Fill ``rows`` with the ``DiscLine`` of a line of sight, over grazing angles with the sines ``sines``.

    The Sun's direction is taken at the sensor's foot. Places where the vertical is turned by up to ``turn`` [rad] look it up at their own
    ``1/(sin(grazing) + sin(Sun's elevation))``: a covariance so taken is off by about ``turn``, and the glint by that times the disc's
    share of the slopes.
    """
    low, high = sines
    none = DiscLine(rows[:0], 0.0, 0.0)
    if not sun.shining or rough.east_east + rough.north_north <= 0.0 or low + sun.up < 1e-3:
        return none
    lowest = low + sun.up
    # a Sun behind the sensor is lower farther away
    first, last = 1.0 / (high + sun.up), 1.0 / max(lowest - turn, 0.5 * lowest)
    step = max((last - first) / (rows.shape[0] - 1), 1e-9)
    for i in range(rows.shape[0]):
        mz = 1.0 / (first + i * step)
        sine = min(max(mz - sun.up, 0.0), 1.0)
        horizontal = math.sqrt(1.0 - sine * sine)
        disc, covariance = disc_of(sun, rough, mz, -(sight.east * horizontal + sun.east) / mz, -(sight.north * horizontal + sun.north) / mz)
        if sharp(rough, covariance):
            return none
        rows[i, 0], rows[i, 1], rows[i, 2] = disc.east, disc.north, disc.ee
        rows[i, 3], rows[i, 4], rows[i, 5] = disc.en, disc.nn, disc.peak
    return DiscLine(rows, first, 1.0 / step)


@kernel
def disc_in_slopes(sun: Sunlight, mz: float, se: float, sn: float) -> tuple[float, float, float, float, float]:
    """Covariance (ee, en, nn) and mean offset (e, n) of the slopes that mirror points of the solar disc, about the slope for its centre.

    With ``s = -(v+l)_h/(v+l)_z`` and ``l`` moved by ``d`` on the sphere, to second order
    ``ds = -(d_h + s d_z)/m_z + (d_h + s d_z) d_z/m_z^2 + |d|^2 (l_h + s l_z)/(2 m_z)``; the disc has ``<d d> = eps^2/4`` in every
    direction.
    """
    # eps^2/4 is the variance of a uniform disc of radius eps along any direction
    scale = 0.25 * sun.radius * sun.radius / (mz * mz)
    along_e, along_n = sun.t_east + se * sun.t_up, sun.t_north + sn * sun.t_up
    ee = scale * (sun.c_east * sun.c_east + along_e * along_e)
    en = scale * (sun.c_east * sun.c_north + along_e * along_n)
    nn = scale * (sun.c_north * sun.c_north + along_n * along_n)
    shift_e = scale * (along_e * sun.t_up + mz * (sun.east + se * sun.up))
    shift_n = scale * (along_n * sun.t_up + mz * (sun.north + sn * sun.up))
    return ee, en, nn, shift_e, shift_n


@kernel
def disc_edge(disc: tuple[float, float, float], rough: Roughness, offset: tuple[float, float]) -> float:
    """Contribution of the disc's sharp edge to the exponent of the Gaussian that approximates its convolution with the facet's slopes.

    A uniform disc has the fourth cumulants ``-(E_ij E_kl + E_ik E_jl + E_il E_jk)/3`` with ``E`` its covariance (``disc``). The Edgeworth
    factor is ``1 - H/24`` with ``H = (u.Eu)^2 - 2 tr(E/C) u.Eu - 4 u.E/C.Eu + tr(E/C)^2 + 2 tr((E/C)^2)``, ``u = C^-1 offset`` and ``C``
    the covariance of disc and facet; it is taken as ``exp(-H/24)``, which stays positive in the tails.
    """
    ee, en, nn = disc
    both_ee, both_en, both_nn = ee + rough.east_east, en + rough.east_north, nn + rough.north_north
    det = both_ee * both_nn - both_en * both_en
    i_ee, i_en, i_nn = both_nn / det, -both_en / det, both_ee / det
    ue, un = i_ee * offset[0] + i_en * offset[1], i_en * offset[0] + i_nn * offset[1]
    we, wn = ee * ue + en * un, en * ue + nn * un
    # E/C, row by row
    a, b = ee * i_ee + en * i_en, ee * i_en + en * i_nn
    c, d = en * i_ee + nn * i_en, en * i_en + nn * i_nn
    trace = a + d
    once = ue * we + un * wn
    twice = we * (i_ee * we + i_en * wn) + wn * (i_en * we + i_nn * wn)
    return (once * once - 2.0 * trace * once - 4.0 * twice + trace * trace + 2.0 * (a * a + 2.0 * b * c + d * d)) / 24.0


@kernel
def mirror_factor(sun: Sunlight, ve: float, vn: float, vz: float, slope_east: float, slope_north: float) -> float:
    """Factor ``1/(pi eps^2)`` where a smooth facet mirrors a point of the solar disc to the viewer ``v``, else 0."""
    norm = 1.0 / math.sqrt(1.0 + slope_east * slope_east + slope_north * slope_north)
    ne, nn, nz = -slope_east * norm, -slope_north * norm, norm
    twice = 2.0 * (ve * ne + vn * nn + vz * nz)
    re, rn, rz = twice * ne - ve - sun.east, twice * nn - vn - sun.north, twice * nz - vz - sun.up
    if re * re + rn * rn + rz * rz > sun.radius * sun.radius:
        return 0.0
    return 1.0 / (math.pi * sun.radius * sun.radius)
