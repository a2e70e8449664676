"""Measures of the mirrored Sun for a designer: its mean, mean plus deviations, pixels above a threshold, hidden targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaincc

from seaglint.air.protocol import slant_range
from seaglint.base.conventions import FloatArray
from seaglint.climate.looks import Looks
from seaglint.facet.sea_view import sea_arc
from seaglint.radiance.variance import patches_of_tilt, point_variance


def deviation(evaluated: Looks, height: FloatArray, solid_angle: float, length: float) -> FloatArray:
    """Standard deviation of glint in a pixel of each look [W m-2 sr-1, (n,)], as :func:`seaglint.radiance.variance.glint_variance`.

    Parameters
    ----------
    evaluated : Looks
        Results of the looks.
    height : ndarray
        Heights of the sensors [m, (n,)].
    solid_angle : float
        Solid angle of a pixel [sr].
    length : float
        Side of a cell of glint [m].
    """
    gamma = np.maximum(evaluated.elevation, 0.0)
    slant = slant_range(height, sea_arc(height, gamma))
    tilt = np.maximum(np.sin(gamma) + evaluated.sun_up, 0.0)
    m = patches_of_tilt(evaluated.cos_incidence, tilt, slant, solid_angle, length)
    return np.asarray(np.sqrt(point_variance(evaluated.radiance, evaluated.chance) / np.maximum(m, 1.0)))


@dataclass(frozen=True, eq=False)
class DetectionCurve:
    """Probability of detection against contrast, linear between its points and constant beyond them."""

    contrast: FloatArray  #: Ascending, target less what is about it [W m-2 sr-1].
    pd: FloatArray  #: Chance of detection there [1].

    def __call__(self, contrast: FloatArray) -> FloatArray:
        """Probabilities at contrasts [1]."""
        return np.asarray(np.interp(contrast, self.contrast, self.pd))


def exceeds(radiance: FloatArray, threshold: float) -> FloatArray:
    """Value 1 where a radiance is above a threshold, else 0."""
    return (radiance > threshold).astype(np.float64)


def passes(mean: FloatArray, sigma: FloatArray, threshold: float) -> FloatArray:
    """Probability that glint in a pixel is above a threshold [1]: a gamma law of this mean and deviation [W m-2 sr-1].

    >>> import numpy as np
    >>> round(float(passes(np.array([1.0]), np.array([1.0]), 2.0)[0]), 4)
    0.1353
    """
    spread = (sigma > 1e-6 * mean) & (mean > 0.0)
    shape = np.divide(mean, sigma, out=np.ones_like(mean), where=spread) ** 2
    scale = np.divide(mean, shape, out=np.ones_like(mean), where=spread)
    return np.asarray(np.where(spread, gammaincc(shape, threshold / scale), exceeds(mean, threshold)))


def detected(radiance: FloatArray, illuminated: FloatArray, curve: DetectionCurve, contrast: float) -> FloatArray:
    """Probability to detect a target [1] with a contrast of ``contrast`` to a sea without glint [W m-2 sr-1].

    Glint behind it takes its radiance from the contrast; where clouds hide the Sun, with the chance 1 - ``illuminated``, it takes nothing.
    """
    free = curve(np.array([contrast]))[0]
    return np.asarray(free + illuminated * (curve(contrast - radiance) - free))


def exceeded_by(radiance: FloatArray, illuminated: FloatArray, shares: Sequence[float], weight: FloatArray | None = None) -> FloatArray:
    """Radiances that glint exceeds in given shares of all draws [W m-2 sr-1]: contrasts visible in the others.

    ``weight`` is what each draw stands for [(n,)]; all the same where it is not given.
    """
    order = np.argsort(radiance)[::-1]
    each = np.ones(radiance.size) if weight is None else weight
    above = np.cumsum((illuminated * each)[order]) / each.sum()
    at = np.searchsorted(above, np.asarray(shares), side="left")
    values = np.append(np.where(radiance[order] > 1e-200, radiance[order], 0.0), 0.0)
    return np.asarray(values[np.minimum(at, radiance.size)])
