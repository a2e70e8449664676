"""Sensor effects on an object's light: the object's own shot noise, and the steps of the converter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri, pdtrik

from seaglint.base.conventions import FloatArray
from seaglint.base.random import stream
from seaglint.detection.interface import Frames

_MANY = 100.0  # from here on Cornish and Fisher's quantile is within 0.05 electrons of the exact one inside four standard deviations


@dataclass(frozen=True)
class Counting:
    """Increase of frames by an object's light, counted as the sensor does.

    Electrons of background and object are independent Poisson numbers, so that those of the object may be added to frames which have the
    noise of the background already. The converter has rounded these: what is added is rounded up or down at random, so that its mean
    stays, and the sum takes the converter's values again.
    """

    electrons: float | None  #: Electrons for each unit of the frames [1/u]; None where a sensor has no shot noise.
    step: float  #: Step of the converter [u].

    def draws(self, seed: int, first: int, shape: tuple[int, int, int]) -> FloatArray:
        """Two uniform numbers for each pixel, functions of seed, frame and place, shape (k, 2, rows, columns).

        Parameters
        ----------
        seed : int
            Seed of the objects.
        first : int
            Number of the first frame in its source.
        shape : (int, int, int)
            Frames, rows, columns.
        """
        count, rows, columns = shape
        return np.stack([stream(seed, "object electrons", first + k).random((2, rows, columns)) for k in range(count)])

    def added(self, light: Frames, draws: FloatArray) -> Frames:
        """Increase of frames, in whole steps.

        Parameters
        ----------
        light : ndarray, shape (k, rows, columns)
            Mean of the objects' light [u]. Below 0, for objects darker than what is behind them, it has no noise of its own: the electrons
            that are missing take a little of the background's noise with them, which is left in.
        draws : ndarray, shape (k, 2, rows, columns)
            Numbers from :meth:`draws`.
        """
        out = np.zeros_like(light)
        lit = light != 0.0
        mean = light[lit].astype(np.float64)
        drawn, rounded = draws[:, 0][lit], draws[:, 1][lit]
        if self.electrons is not None:
            number = mean * self.electrons
            bright = number > 0.0
            number[bright] = poisson_quantile(number[bright], drawn[bright])
            mean = number / self.electrons
        out[lit] = self.step * np.floor(mean / self.step + rounded)
        return out


def poisson_quantile(mean: FloatArray, share: FloatArray) -> FloatArray:
    """Quantile of a Poisson distribution: the least whole number with at least that probability, rising in both arguments.

    Examples
    --------
    >>> poisson_quantile(np.array([3.0, 1e4]), np.array([0.5, 0.5])).tolist()
    [3.0, 10000.0]
    """
    out = np.empty(mean.shape)
    few = mean < _MANY
    out[few] = np.ceil(np.maximum(pdtrik(share[few], mean[few]), 0.0))
    z = ndtri(np.clip(share[~few], 1e-16, 1.0 - 1e-16))
    many = mean[~few]
    out[~few] = np.rint(many + np.sqrt(many) * z + (z * z - 1.0) / 6.0)
    return out
