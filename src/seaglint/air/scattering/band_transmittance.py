"""Kernels of LOWTRAN7's transmittances in channels: continua, aerosols and band laws.

Optical depth in a channel is ``sum_k c_k W_k`` over continua and aerosols plus ``sum_b (C_b W_b)^a_b`` over absorption bands, whose lines
saturate: the transmittance of a bent way Sun - point - sensor is that of its whole amount, not a product of two.

References
----------
LOWTRAN7's subroutines DBLTX and TRANS; Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177.
"""

from __future__ import annotations

import math

import numpy as np

from seaglint.air.scattering.gas_bands import DEEPEST
from seaglint.air.scattering.lowtran_ray import Laws
from seaglint.base.jit import njit


@njit
def optical_depths(laws: Laws, amount: np.ndarray, out: np.ndarray) -> None:
    """Optical depth [1, (n,)] of amounts [(columns,)]."""
    channels = out.size
    for i in range(channels):
        out[i] = 0.0
    for k in range(laws.linear.shape[0]):
        w = amount[k]
        if w != 0.0:  # what counts as cold is below 0 in warm air
            for i in range(channels):
                out[i] += w * laws.linear[k, i]
    at = 0
    for s in range(laws.segments.shape[0]):
        column, first, end = laws.segments[s]
        w = amount[column]
        if w > 1e-20:
            grown = w ** laws.power[s]
            band, coefficient = out[first:end], laws.coefficient[at : at + end - first]
            for i in range(band.size):
                band[i] += grown * coefficient[i]
        at += end - first


@njit
def passed(depth: float) -> float:
    """Transmittance of an optical depth; 0 beyond :data:`~seaglint.air.scattering.gas_bands.DEEPEST`."""
    return math.exp(-depth) if depth < DEEPEST else 0.0
