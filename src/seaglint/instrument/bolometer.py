r"""Thermal detectors: the response of a microbolometer to absorbed power, with a lag and without shot noise.

Noise is given as on a data sheet: by the NETD against a blackbody of a temperature, through optics of an f-number. In absorbed power

.. math:: \sigma_P = \mathrm{NETD}\; A_d\, \Omega(F_0)\, \alpha\, \frac{dL}{dT}(T_0)

is a property of the pixel, independent of the optics of the sensor. The signal follows the power with :math:`1 - e^{-t/\tau}`; a frame
contains the share :math:`e^{-dt/\tau}` of the frame ``dt`` before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.instrument.detector import MOST_BITS, Pixels

FORGOTTEN: Final = 1e-4  #: Share of an old frame below which it is omitted from the lag: less than a count of most converters.

MOST_REMEMBERED: Final = 64  #: Largest number of frames in the lag.

NANO: Final = 1e9  #: Number of nanowatts, the units of the signal, in a watt.


@dataclass(frozen=True)
class ThermalPixels(Pixels):
    """Pixels of a thermal detector."""

    pitch: float  #: Distance of the pixels' centres [m].
    netd: float  #: Noise-equivalent temperature difference of the data sheet [K].
    netd_f_number: float = 1.0  #: F-number of the optics (of transmission 1) for which the NETD is stated.
    netd_temperature: float = 300.0  #: Temperature of the blackbody for which the NETD is stated [K].
    time_constant: float = 0.0  #: Time constant of the exponential lag [s]; 0 without lag.
    fill_factor: float = 1.0  #: Share of a pixel's area that absorbs [1].
    absorptance: float = 1.0  #: Absorbed share of the power on the pixel [1].
    full_scale_temperature: float = 433.15  #: Temperature of the blackbody that fills the converter [K].
    bit_depth: int = MOST_BITS  #: Bit depth of the converter.
    offset: float = 0.0  #: Counts without power.

    def __post_init__(self) -> None:
        self.require_bits()


def lag_weights(time_constant: float, interval: float) -> FloatArray:
    """Return the weights of a frame and of the frames before it in its signal [1]; they add to 1.

    Parameters
    ----------
    time_constant, interval : float
        Time constant of the detector, and interval between frames [s].

    Returns
    -------
    ndarray
        Weights [1], that of the frame first.

    Examples
    --------
    >>> lag_weights(0.0, 0.04)
    array([1.])
    >>> [round(float(w), 4) for w in lag_weights(0.01, 0.02)]
    [0.8647, 0.117, 0.0158, 0.0021, 0.0003]
    """
    if time_constant <= 0.0:
        return np.ones(1)
    decay = math.exp(-interval / time_constant)
    # decay^n reaches FORGOTTEN at n = log(FORGOTTEN) / log(decay)
    count = 1 + min(math.floor(math.log(FORGOTTEN) / math.log(decay)) if decay > 0.0 else 0, MOST_REMEMBERED - 1)
    # the forgotten frames' share is divided among the others, so that a steady scene has its full signal
    weights = (1.0 - decay) * decay ** np.arange(count)
    return np.asarray(weights / weights.sum())
