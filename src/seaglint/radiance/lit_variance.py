r"""Variance of glint in a pixel from the waves that are no geometry (:mod:`seaglint.sea.glitter.lit_share`).

The lit share of a pixel of the sides a, b on the sea has the relative variance ``v = K/(a b)``, with K by the steepness of the mirroring
slope, in deviations of all slopes, and by the sides. Waves longer than geometry's cut move the mean of a pixel and are no part of the
variance; they tilt the sea under the short ones. The cut is the shortest wave of the scenario, or two pixels where these are longer, as in
images.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import RegularGridInterpolator

from seaglint.base.conventions import FloatArray
from seaglint.facet.sunlight import visible_sun
from seaglint.sea.glitter.lit_share import Clusters, Covariance
from seaglint.sea.glitter.short_waves import ShortWaves
from seaglint.sea.shadowing.smith import projected_area
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum

STEEPEST: Final = 7.0  #: Steepness of the mirroring slope up to which variances are computed [1]; beyond, glint is 1e-10 of its peak.

#: Steepness at which variances are computed; their logarithm is nearly linear in its square.
_STEEPNESS: Final = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.5, STEEPEST])

COLUMNS: Final = 2.0  #: Least length of geometry's waves in widths of a pixel, as in images.

_SIZES: Final = 5  #: Number of sizes of pixels at which the variance is computed; linear in logarithms in between.


@dataclass(frozen=True)
class WaveGlint:
    """Waves from which the fluctuation of glint follows, instead of a fixed correlation time."""

    spectrum: DirectionalSpectrum | None  #: All waves; None for slopes without a spectrum.
    shortest_wave: float  #: Length of the shortest wave that is geometry [m]; infinite where none is.

    def short_waves(self, slopes: SlopeStatistics, cut: float, variances: tuple[float, float] | None = None) -> ShortWaves:
        """Return the waves beyond a wavenumber [rad m⁻¹], scaled to variances of the slopes along and across their axis [1].

        Without ``variances`` the waves of a spectrum keep their own, and of slopes without a spectrum the slopes'.
        """
        waves = self._beyond(slopes, cut)
        return waves if variances is None else waves.scaled(*variances)

    def _beyond(self, slopes: SlopeStatistics, cut: float) -> ShortWaves:
        spectrum = self.spectrum
        if spectrum is not None and cut < 0.9 * spectrum.wavenumber_range[1]:
            waves = ShortWaves.of_spectrum(spectrum, cut)
            if min(waves.variances) > 0.0:
                return waves
        return ShortWaves.of_slopes(slopes, cut)

    def clusters(self, slopes: SlopeStatistics, cut: float) -> Clusters:
        """Return the fluctuation of the lit share by the waves beyond a wavenumber [rad m⁻¹], on a sea of slopes."""
        waves = self.short_waves(slopes, cut)
        total = float(slopes.mss_along(waves.to_azimuth)), float(slopes.mss_along(waves.to_azimuth + 0.5 * math.pi))
        own = waves.variances
        # longer waves have what is left of the slopes; a law with fewer slopes than its spectrum has fewer short ones too
        short = tuple(min(part, 0.999 * whole) for part, whole in zip(own, total, strict=True))
        longer: Covariance = (total[0] - short[0], 0.0, total[1] - short[1])
        return Clusters(waves.scaled(*short), longer)

    def relative_variance(
        self,
        slopes: SlopeStatistics,
        radius: float,
        cos_incidence: ArrayLike,
        view_zenith: ArrayLike,
        solar_zenith: float,
        slant_range: ArrayLike,
        solid_angle: ArrayLike,
    ) -> FloatArray:
        r"""Relative variance of the mirrored Sun in square pixels, ``v = K A+/(Omega r^2)`` with Smith's projected area ``A+`` [1].

        Parameters
        ----------
        slopes : SlopeStatistics
            Slopes of all waves.
        radius : float
            Angular radius of the Sun, or of the lit part of the Moon [rad].
        cos_incidence, view_zenith, solar_zenith, slant_range, solid_angle
            As in :func:`seaglint.radiance.variance.patches`.

        Returns
        -------
        ndarray
            Of the broadcast shape, 0 or more.

        Notes
        -----
        The mirroring slope counts by its size alone, and hiding by Smith's law: variances along and across the wind differ by a factor of
        two at most.
        """
        _, zenith = visible_sun(solar_zenith)
        cosine = np.maximum(np.asarray(cos_incidence, np.float64), 1e-9)
        upward = np.maximum(np.cos(np.asarray(view_zenith, np.float64)), 1e-6)
        tilt = np.clip((upward + math.cos(zenith)) / (2.0 * cosine), 1e-3, 1.0)
        steepness = np.sqrt(np.maximum(1.0 / tilt**2 - 1.0, 0.0) * 2.0 / max(slopes.mss, 1e-300))
        # the disc in slopes is larger where the Sun is met at a grazing angle
        spread = radius / (2.0 * np.sqrt(tilt**3 * cosine))
        width = np.sqrt(np.asarray(solid_angle, np.float64)) * np.asarray(slant_range, np.float64)
        steepness, width, length, spread = np.broadcast_arrays(steepness, width, width / upward, spread)
        if steepness.size == 0:
            return np.zeros(steepness.shape)
        sizes = _nodes(width), _nodes(length / width), _nodes(spread, 2)
        table = _table(self, slopes, *(tuple(float(x) for x in size) for size in sizes))
        inside = [
            np.clip(np.log(x), np.log(size[0]), np.log(size[-1])) for x, size in zip((width, length / width, spread), sizes, strict=True)
        ]
        points = np.stack([*inside, np.clip(steepness, 0.0, STEEPEST) ** 2], axis=-1)
        # the sea that is seen in a pixel is the less the more of it is hidden
        seen = projected_area(np.asarray(view_zenith, np.float64), 0.5 * slopes.mss)
        return np.asarray(np.exp(table(points.reshape(-1, 4))).reshape(steepness.shape) * seen / width**2)


def _nodes(values: FloatArray, most: int = _SIZES) -> FloatArray:
    """Return sizes, even over their logarithm, that span values; one size where the values hardly differ."""
    low, high = float(np.min(values)), float(np.max(values))
    # rounded to steps of a twelfth of a decade, so that neighbouring calls share a table
    low, high = 10.0 ** (math.floor(12.0 * math.log10(low)) / 12.0), 10.0 ** (math.ceil(12.0 * math.log10(high)) / 12.0)
    return np.geomspace(low, high, max(min(most, math.ceil(4.0 * math.log10(high / low)) + 1), 2))


@lru_cache(maxsize=32)
def _table(
    glint: WaveGlint, slopes: SlopeStatistics, widths: tuple[float, ...], ratios: tuple[float, ...], radii: tuple[float, ...]
) -> RegularGridInterpolator:
    """Logarithm of ``K`` [m2] by logarithms of width, length over width and disc, and by steepness."""
    values = np.empty((len(widths), len(ratios), len(radii), _STEEPNESS.size))
    for i, clusters in enumerate(_by_width(glint, slopes, widths)):
        for j, ratio in enumerate(ratios):
            box = (ratio * widths[i], widths[i])
            for k, radius in enumerate(radii):
                for u, steepness in enumerate(_STEEPNESS):
                    ways = [max(clusters.variance(steepness, radius, box, turn), 1e-30) for turn in (0.0, 0.5 * math.pi)]
                    values[i, j, k, u] = math.log(0.5 * sum(ways) * box[0] * box[1])
    nodes = (*(np.log(size) for size in (widths, ratios, radii)), _STEEPNESS**2)
    return RegularGridInterpolator(nodes, values)


def _by_width(glint: WaveGlint, slopes: SlopeStatistics, widths: tuple[float, ...]) -> Iterator[Clusters]:
    for width in widths:
        yield glint.clusters(slopes, 2.0 * math.pi / max(min(glint.shortest_wave, 1e9), COLUMNS * width))
