"""Absorber amounts on a line between two heights, and their optical depth in every spectral channel.

LOWTRAN7 adds up ``sum_k (c_k W_k)^a_k`` over absorbers ``k``: the amounts ``W_k`` are integrals along the path of densities scaled by
powers of pressure and temperature, the exponents ``a_k`` are below 1 for lines (their growth lies between the square root and the
linear law) and 1 for continua and aerosol. :class:`BandLaw` finds the coefficients of a channel from paths whose optical depth is
known; what it leaves, half a per cent, cancels where it only scales a known path to another one.

References
----------
Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177; Pierluissi, J. H., and C. E. Maragoudakis (1986), Molecular
transmission band models for LOWTRAN, AFGL-TR-86-0272. Exponents are those of LOWTRAN7's subroutines STDMDL and ABCDTA.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from seaglint.air.line import heights_along, level_shares, lowest_height
from seaglint.air.table.profiles import LEVEL_STEP, PROFILES
from seaglint.base.conventions import FloatArray
from seaglint.optics.blackbody import planck_wavenumber

Region = Literal["mwir", "lwir"]

# Per gas: exponents of pressure and of 273.15 K / T in the scaled density, exponent of the amount in the optical depth.
_GASES: Final[dict[Region, dict[str, tuple[float, float, float]]]] = {
    "mwir": {"water": (0.9681, -1.9537, 0.5479), "carbon dioxide": (0.7258, -1.674, 0.6033), "traces": (0.72, -0.18, 0.72)},
    "lwir": {
        "water": (1.1406, -2.6343, 0.53),
        "carbon dioxide": (0.7038, -5.0768, 0.681),
        "traces": (0.72, -0.18, 0.65),
        "ozone": (0.4221, 0.7678, 0.7593),
    },
}

_HIGH_AEROSOL: Final = {
    "summer": (0.931, 0.771, 0.623, 0.337, 0.182, 0.114),
    "winter": (0.485, 0.354, 0.231, 0.141, 0.098, 0.0787),
}
"""Relative aerosol profiles of LOWTRAN7 at 5 to 10 km (SPSU50, FAWI50), independent of wind; below, the fit determines the density."""

_NODES, _WEIGHTS = (0.5 * (1.0 + np.polynomial.legendre.leggauss(4)[0]), 0.5 * np.polynomial.legendre.leggauss(4)[1])
"""Gauss-Legendre nodes and weights on a piece within a layer, where densities are exponentials."""

_LEAST: Final = 1e-300


@dataclass(frozen=True, eq=False)
class LayerPieces:
    """Absorber amounts on the pieces of lines between two levels, from one end to the other.

    Attributes
    ----------
    amount : ndarray
        Scaled amounts from the line's first end to each piece's far end [km of sea-level density, (cases, pieces, absorbers)].
    temperature : ndarray
        Mean air temperature of each piece, weighted with the density of air [K, (cases, pieces)].
    """

    amount: FloatArray
    temperature: FloatArray

    @property
    def whole(self) -> FloatArray:
        """Absorber amounts of the whole lines [(cases, absorbers)]."""
        return self.amount[:, -1]

    def reversed(self, where: NDArray[np.bool_]) -> LayerPieces:
        """Return the lines counted from their other end in the cases where the mask is true."""
        parts = np.diff(self.amount, axis=1, prepend=0.0)
        amount = np.where(where[:, None, None], np.cumsum(parts[:, ::-1], axis=1), self.amount)
        return LayerPieces(amount, np.where(where[:, None], self.temperature[:, ::-1], self.temperature))


@dataclass(frozen=True, eq=False)
class Absorbers:
    """Vertical distribution of the absorbers of one model atmosphere, relative to the largest value; none above 10 km.

    Attributes
    ----------
    density : ndarray
        Scaled densities at the levels [1, (absorbers, levels)]; between them exponential, linear next to a zero.
    growth : ndarray
        Exponents of the amounts [1, (absorbers,)].
    air, temperature : ndarray
        Density of air [1] and temperature [K] at the levels.
    """

    density: FloatArray
    growth: FloatArray
    air: FloatArray
    temperature: FloatArray

    @classmethod
    def of_model(cls, model: str, region: Region) -> Absorbers:
        """Absorbers of a model atmosphere: water vapour lines and continua, carbon dioxide, traces, dry continuum, ozone, aerosol."""
        profile = PROFILES[model]
        pressure, kelvin = np.array(profile.pressure_hpa) / 1013.25, np.array(profile.temperature_k)
        cold = 273.15 / kelvin
        air = pressure * cold
        water = 1e-6 * air * np.array(profile.water_ppmv)
        gas = {"water": water, "carbon dioxide": air, "traces": air, "ozone": air * np.array(profile.ozone_ppmv)}
        profiles = [(gas[name] * pressure**p * cold**t, growth) for name, (p, t, growth) in _GASES[region].items()]
        profiles += [(air * pressure * np.sqrt(cold), 1.0), (water * water, 1.0), (water * (air - water), 1.0)]
        profiles += [(hat, 1.0) for hat in np.eye(5, air.size)]
        profiles += [(np.concatenate([np.zeros(5), _HIGH_AEROSOL["winter" if model.endswith("winter") else "summer"]]), 1.0)]
        return cls(
            density=np.array([density / density.max() for density, _ in profiles]),
            growth=np.array([growth for _, growth in profiles]),
            air=air,
            temperature=kelvin,
        )

    def _at(self, values: FloatArray, height: FloatArray) -> FloatArray:
        """Densities at heights [m]: below the sea those at the sea, above the highest level none."""
        u = np.clip(height / LEVEL_STEP, 0.0, values.shape[-1] - 1.0)
        layer = np.minimum(u.astype(np.intp), values.shape[-1] - 2)
        low, high, part = values[..., layer], values[..., layer + 1], u - layer
        both = (low > 0.0) & (high > 0.0)
        ratio = np.where(both, high, 1.0) / np.where(both, low, 1.0)
        between = np.where(both, low * ratio**part, low + part * (high - low))
        return np.where(height > (values.shape[-1] - 1.0) * LEVEL_STEP, 0.0, between)

    def along(self, start: FloatArray, end: FloatArray, slant: FloatArray, levels: FloatArray | None = None) -> LayerPieces:
        """Amounts and temperatures on straight lines of length ``slant`` from height ``start`` to ``end`` [m, (cases,)].

        The pieces end where a line crosses ``levels`` [m]: those of the model atmosphere where none are given.
        """
        if levels is None:
            levels = LEVEL_STEP * np.arange(1.0, self.air.size)
        met = levels[(levels > lowest_height(start, end, slant).min()) & (levels < max(start.max(), end.max()))]
        shares = level_shares(start, end, slant, met)
        width = np.diff(shares, axis=1)
        x = shares[:, :-1, None] + width[:, :, None] * _NODES
        height = heights_along(start[:, None, None], end[:, None, None], slant[:, None, None], x)
        km = 1e-3 * slant[:, None] * width
        amount = np.moveaxis(self._at(self.density, height) @ _WEIGHTS, 0, -1) * km[:, :, None]
        weight = (self._at(self.air, height) + 1e-9) * _WEIGHTS  # pieces above the highest level have a temperature, too
        kelvin = np.interp(height, LEVEL_STEP * np.arange(self.air.size), self.temperature)
        return LayerPieces(np.cumsum(amount, axis=1), np.asarray((weight * kelvin).sum(axis=-1) / weight.sum(axis=-1)))


@dataclass(frozen=True, eq=False)
class BandLaw:
    """Optical depth of each channel as a sum over absorbers. Make it with :meth:`fit`.

    Attributes
    ----------
    absorbers : Absorbers
        The atmosphere.
    coefficient : ndarray
        ``c_k^a_k``, 0 or more [(absorbers, n)].
    wavenumber_cm : ndarray
        Channels [cm-1, (n,)].
    """

    absorbers: Absorbers
    coefficient: FloatArray
    wavenumber_cm: FloatArray

    @classmethod
    def fit(cls, absorbers: Absorbers, wavenumber_cm: FloatArray, amount: FloatArray, optical_depth: FloatArray) -> BandLaw:
        """Band law fitted to amounts [(paths, absorbers)] and optical depths [1, (paths, n)] by non-negative least squares.

        Depths count by their relative error; those above 8, where nothing is seen, and below 0.01 less.
        """
        terms = amount**absorbers.growth
        coefficient = np.empty((terms.shape[1], optical_depth.shape[1]))
        for channel, depth in enumerate(optical_depth.T):
            weight = np.minimum(1.0, 8.0 / np.maximum(depth, _LEAST)) / (depth + 0.01)
            coefficient[:, channel] = nnls(terms * weight[:, None], depth * weight)[0]
        return cls(absorbers, coefficient, wavenumber_cm)

    def optical_depth(self, amount: FloatArray) -> FloatArray:
        """Optical depths of amounts [(..., absorbers)]: [1, (..., n)]."""
        return np.asarray(amount**self.absorbers.growth @ self.coefficient)

    def scale(self, amount: FloatArray, optical_depth: FloatArray) -> FloatArray:
        """Factor of the law's optical depths that reproduces the known depths of given paths [1, (cases, n)]."""
        return np.asarray(optical_depth / np.maximum(self.optical_depth(amount), _LEAST))

    def emission(self, pieces: LayerPieces, scale: FloatArray) -> FloatArray:
        """Blackbody radiance of the air as seen from the first end, ``L / (1 - tau)`` [W m-2 sr-1 per cm-1, (cases, n)].

        As LOWTRAN7 has it, each piece between two levels is at its mean temperature: ``sum_j B(T_j) (tau_(j-1) - tau_j)``.
        """
        depth = self.optical_depth(pieces.amount) * scale[:, None, :]
        own = np.diff(depth, axis=1, prepend=0.0)
        share = np.exp(-(depth - own)) * -np.expm1(-own)
        share[:, 0] += _LEAST  # a path of no length shines like its first piece
        glow = planck_wavenumber(self.wavenumber_cm, pieces.temperature[:, :, None])
        return np.asarray((share * glow).sum(axis=1) / share.sum(axis=1))
