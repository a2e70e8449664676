"""Shares of a wave's variance that readers between lattice points get, and the amplitudes that give them all of it.

A reader sums lattice points with weights ``w(x - i)``, a B-spline. Of a wave of unit variance that turns by ``a`` from point to point it
gets, averaged over the places in a cell and for each axis,

::

    sum_m c(m) cos(m a),      c: the same B-spline's product with itself, moved by m cells

(2 + cos a)/3 for linear reading and (2416 + 2382 cos a + 240 cos 2a + 2 cos 3a)/5040 for cubic B-splines. So lattices hold amplitudes over
the root of that share. At single places of a cell the variance differs from the mean: for waves of four cells by -24 to +50 % of it
(linear) and 2.5 % (cubic), for longer ones with the second and fourth power of one over their length.

References: M. Unser, Splines: a perfect fit for signal and image processing, IEEE Signal Process. Mag. 16(6), 22-38, 1999.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from seaglint.base.conventions import FloatArray

Reading = Literal["linear", "cubic"]

_KEPT: dict[Reading, tuple[float, ...]] = {"linear": (2 / 3, 1 / 3), "cubic": (2416 / 5040, 2382 / 5040, 240 / 5040, 2 / 5040)}


def kept_share(turn: FloatArray, reading: Reading) -> FloatArray:
    """Share of the variance of waves that a reader gets, along one axis [1].

    Parameters
    ----------
    turn : ndarray
        Phase from one lattice point to the next [rad], at most half a circle.
    reading : "linear" or "cubic"
        Linear interpolation, or a cubic B-spline whose coefficients the lattice holds.

    Examples
    --------
    >>> [round(float(kept_share(np.pi / 2, reading)), 3) for reading in ("linear", "cubic")]
    [0.667, 0.432]
    """
    turn = np.asarray(turn, np.float64)
    return np.asarray(sum(share * np.cos(m * turn) for m, share in enumerate(_KEPT[reading])), np.float64)


def gain(turn: FloatArray, reading: Reading) -> FloatArray:
    """Factor of the amplitudes of waves with which a reader gets their variance, along one axis [1]; as :func:`kept_share`."""
    return np.asarray(1.0 / np.sqrt(kept_share(turn, reading)))
