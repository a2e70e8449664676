"""Spectral emissivity of plumes along chords of all lengths, on the samples of a band."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np
from scipy.sparse import csr_array

from seaglint.base.conventions import FloatArray
from seaglint.objects.body import GasPlume
from seaglint.objects.combustion_gas import HEADS, emissivity

#: Number of chords that are tabulated, even in the root of their length: short ones absorb as the root, and linear interpolation leaves
#: 1e-4 of the emissivity 0.999999 of a grey plume.
CHORDS: Final = 257

FINE_STEP: Final = 1.0  #: Largest step of the wavenumbers that are averaged over a sample of the band [cm-1].


def chord_shares() -> FloatArray:
    """Shares of the longest chord that are tabulated [1, (chords,)]."""
    return np.linspace(0.0, 1.0, CHORDS) ** 2


def longest_chord(plume: GasPlume) -> float:
    """Length of a plume of gases along its longest axis [m]; 0 for a grey one, whose chords are shares of the longest in a direction."""
    return 0.0 if plume.emissivity is not None else 2.0 * max(plume.semi_axes)


def plume_emissivity(plume: GasPlume, wavenumber_cm: FloatArray) -> FloatArray:
    """Emissivity along chords of :func:`chord_shares` at the samples of a band [1, (chords, n)]."""
    if plume.emissivity is not None:
        grey = -np.expm1(chord_shares() * math.log1p(-plume.emissivity))
        return np.repeat(grey[:, None], wavenumber_cm.size, axis=1)
    nu = np.ascontiguousarray(wavenumber_cm, np.float64)
    return _tabulated(plume.temperature, plume.co2_share, plume.h2o_share, longest_chord(plume), nu.tobytes())


@lru_cache(maxsize=16)
def _tabulated(temperature: float, co2_share: float, h2o_share: float, longest: float, wavenumber_cm: bytes) -> FloatArray:
    """Means of the gases' emissivity over each sample, weighted by the hat of linear interpolation between samples.

    A sum over the samples is then the integral of the emissivity times what else is linear between them.
    """
    nu = np.frombuffer(wavenumber_cm)
    pieces = max(math.ceil(float(np.diff(nu).max()) / FINE_STEP - 1e-9), 1)
    evenly = (nu[:-1, None] + np.diff(nu)[:, None] * (np.arange(pieces) / pieces)).ravel()
    # no piece lies on both sides of a head, where the spectrum has a step
    edges = np.unique(np.concatenate([evenly, nu[-1:], [head for head in HEADS if nu[0] < head < nu[-1]]]))
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    left = np.clip(np.searchsorted(nu, middle, side="right") - 1, 0, nu.size - 2)
    right = (middle - nu[left]) / (nu[left + 1] - nu[left])
    rows = np.arange(middle.size)
    hats = csr_array((np.concatenate([width * (1.0 - right), width * right]), (np.tile(rows, 2), np.concatenate([left, left + 1]))))
    spectra = emissivity(middle, longest * chord_shares(), temperature, co2_share, h2o_share)
    out = np.asarray(spectra @ hats / hats.sum(axis=0))
    out.setflags(write=False)
    return out
