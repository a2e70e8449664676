"""Sunlight scattered once above the Earth's shadow, by rays that NumPy follows in small steps; no kernel of the program is used."""

from __future__ import annotations

import numpy as np

from seaglint.air.scattering.lowtran_ray import AEROSOLS, MOLECULES, SELF, SELF_COLD
from seaglint.air.scattering.scattered_line import HUMIDITIES
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS

MOST_BENT = 0.03  #: More than any ray through all of the air and out again is bent [rad].


class Shells:
    """Densities, refraction and humidity of an atmosphere's levels at any height [km], exponential between them."""

    def __init__(self, laws):
        self.laws = laws

    def at(self, z, of, exponential=True):
        """Values of levels at heights: exponential between two that are not 0, else linear."""
        height = self.laws.height
        i = np.clip(np.searchsorted(height, z, side="right") - 1, 0, height.size - 2)
        f = np.clip((z - height[i]) / (height[i + 1] - height[i]), 0.0, 1.0)
        a, b = of[..., i], of[..., i + 1]
        linear = (1.0 - f) * a + f * b
        if not exponential:
            return linear
        both = (a > 0.0) & (b > 0.0)
        return np.where(both, np.where(both, a, 1.0) ** (1.0 - f) * np.where(both, b, 1.0) ** f, linear)

    def density(self, z):
        """Scaled densities [per km, (columns, ...)]; 0 above the last level."""
        laws = self.laws
        out = self.at(z, laws.density)
        kelvin, scale = self.at(z, laws.temperature, exponential=False), laws.cold_kelvin
        cold = (
            np.clip((296.0 - kelvin) / 36.0, 0.0, 1.0)
            if scale == 0.0
            else np.expm1(scale * (1.0 / kelvin - 1.0 / 296.0)) / np.expm1(scale * (1.0 / 260.0 - 1.0 / 296.0))
        )
        out[SELF_COLD] = out[SELF] * cold
        return out * (z <= laws.height[-1])

    def bend(self, z):
        """Relative gradient of the refractive index [per km], by a difference."""
        step = 1e-3
        low, high = (self.at(np.maximum(z + d, 0.0), self.laws.refractivity + 1e-20) for d in (-step, step))
        span = np.where(z > step, 2.0 * step, np.maximum(z, 0.0) + step)
        return (high - low) / span * (z <= self.laws.height[-1])

    def follow(self, z, zenith, step, steps, every=False):
        """Follow rays from heights [km] at zenith angles [rad] by steps [km] (midpoint rule), until they leave the air or meet the sea.

        Returns amounts (columns, rays), the turn of the vertical, and True for rays that meet the sea; of one ray ``every`` place of it.
        """
        radius, top = self.laws.earth_radius, self.laws.height[-1]
        z, zenith = np.array(z, dtype=float), np.array(zenith, dtype=float)
        turn, amount, hit = np.zeros_like(z), np.zeros((self.laws.density.shape[0], *z.shape)), np.zeros(z.shape, dtype=bool)
        track = [(z.copy(), turn.copy(), amount.copy(), zenith.copy())]
        for n in range(steps):
            alive = (z < top) & ~hit
            if not alive.any():
                break
            ds = np.where(alive, step(z, n), 0.0)
            # a last step ends at the sea or at the top
            rate = np.cos(zenith)

            def slopes(h, a):
                return np.cos(a), np.sin(a) / (radius + h), -np.sin(a) * (1.0 / (radius + h) + self.bend(h))

            k = slopes(z, zenith)
            half = (z + 0.5 * ds * k[0], zenith + 0.5 * ds * k[2])
            m = slopes(half[0], half[1])
            new = z + ds * m[0]
            over = np.where(new < 0.0, z / np.maximum(z - new, 1e-12), np.where(new > top, (top - z) / np.maximum(new - z, 1e-12), 1.0))
            ds = ds * np.clip(over, 0.0, 1.0)
            middle = np.maximum(z + 0.5 * ds * np.cos(zenith + 0.25 * ds * m[2]), 0.0)
            amount += self.density(middle) * ds
            hit |= alive & (new < 0.0)
            z, turn, zenith = z + ds * m[0], turn + ds * m[1], zenith + ds * m[2]
            z = np.where(over < 1.0, np.where(rate < 0.0, np.maximum(z, 0.0), np.maximum(z, top)), z)
            track.append((z.copy(), turn.copy(), amount.copy(), zenith.copy()))
        if every:
            return [np.array([t[i] for t in track]) for i in range(4)]
        return amount, turn, zenith, hit


def depths(laws, amount):
    """Optical depth (n, ...) of amounts (columns, ...)."""
    out = np.tensordot(laws.linear.T, amount[: laws.linear.shape[0]], axes=1)
    at = 0
    for (column, first, end), power in zip(laws.segments, laws.power, strict=True):
        c = laws.coefficient[at : at + end - first]
        out[first:end] += np.multiply.outer(c, np.maximum(amount[column], 0.0) ** power)
        at += end - first
    return out


def phases(shells, z):
    """Shares of the kinds of scatterers in aerosol regions (AEROSOLS, kinds), at heights."""
    laws = shells.laws
    humidity = shells.at(z, laws.humidity, exponential=False)
    boundary = np.array([np.interp(humidity, HUMIDITIES, row) for row in np.eye(len(HUMIDITIES))])
    out = np.zeros((AEROSOLS, len(HUMIDITIES) + AEROSOLS - 1, z.size))
    out[0, : len(HUMIDITIES)] = boundary
    for region in range(1, AEROSOLS):
        out[region, len(HUMIDITIES) + region - 1] = 1.0
    return out


def sunward(shells, z, sent, step, rounds=9):
    """Amounts from places [km] to Suns at zenith angles without refraction [rad], and True where the sea does not hide them.

    The direction at the place that leaves the air towards the Sun is found by regula falsi between a ray that ends too high and one that
    ends too low or meets the sea.
    """
    high, low = sent - MOST_BENT, sent.copy()
    over = np.full(z.shape, MOST_BENT)
    under = np.full(z.shape, -MOST_BENT)
    best, error, clear = np.zeros((shells.laws.density.shape[0], *z.shape)), np.full(z.shape, np.inf), np.zeros(z.shape, dtype=bool)
    for n in range(rounds):
        # the first ray is without refraction; a side that stays counts half, so that the other side moves
        at = low.copy() if n == 0 else high + (low - high) * over / (over - under)
        amount, turn, end, hit = shells.follow(z, at, step, 20000)
        short = np.where(hit, -MOST_BENT, sent - (end + turn))
        better = ~hit & (np.abs(short) < error)
        best, error, clear = np.where(better, amount, best), np.where(better, np.abs(short), error), clear | ~hit
        below = hit | (short < 0.0)
        low, under = np.where(below, at, low), np.where(below, short, 0.5 * under)
        high, over = np.where(below, high, at), np.where(below, 0.5 * over, short)
        if n > 0 and np.all(hit | (np.abs(short) < 1e-6)):
            break
    return best, clear & (error < 2e-4)


def twilight(air, height_km, line, angle, strips=11, fine=1.0):
    """Spectrum of a line of sight from a height: zenith, azimuth from the Sun, the Sun's zenith angle without refraction [rad].

    ``angle``: scattering angle. The disc is cut into strips, each of which sends its own ray to every place of the line.
    """
    laws = air.laws
    shells = Shells(laws)

    def along(h, n):
        return np.minimum(0.005 * 1.03**n, 0.04 + 0.05 * h) / fine + 0.0 * h

    z, turn, amount, _ = (part[..., 0] for part in shells.follow([height_km], [line[0]], along, 40000, every=True))
    up = np.cos(line[2]) * np.cos(turn) + np.sin(line[2]) * np.sin(turn) * np.cos(line[1])
    local = np.arccos(np.clip(up, -1.0, 1.0))
    x = (2.0 * np.arange(strips) + 1.0) / strips - 1.0
    weight = np.sqrt(1.0 - x * x)
    weight /= weight.sum()
    # rays of all strips together: (places, strips)
    sent = local[:, None] + SOLAR_ANGULAR_RADIUS * x
    got, clear = sunward(shells, np.repeat(z[:, None], strips, axis=1), sent, lambda h, n: (0.3 + 0.12 * h) / fine)
    depth = depths(laws, amount.T[:, :, None] + got)
    light = (np.where(clear, np.exp(-np.minimum(depth, 600.0)), 0.0) * weight).sum(axis=-1)
    phase = air.phase(angle)
    piece = np.diff(amount, axis=0).T
    mean = 0.5 * (light[:, 1:] + light[:, :-1])
    middle = 0.5 * (z[1:] + z[:-1])
    share = phases(shells, middle)
    out = phase[-1] * laws.linear[MOLECULES] * (mean @ piece[MOLECULES])
    for region in range(AEROSOLS):
        for kind in range(share.shape[1]):
            out = out + phase[kind] * laws.scattering[region] * (mean @ (share[region, kind] * piece[region]))
    return air.source * out
