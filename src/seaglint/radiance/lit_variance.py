r"""Variance of glint in a pixel from the waves that are no geometry (``seaglint.sea.glitter.lit_share``).

The lit share of a pixel of the sides a, b on the sea has the relative variance ``v = K/(a b)``, with K by the steepness of the mirroring
slope, in deviations of all slopes, and by the sides. Waves longer than geometry's cut move the mean of a pixel and are no part of the
variance; they tilt the sea under the short ones. The cut is the shortest wave of the scenario, or two pixels where these are longer, as in
images.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.sea.glitter.lit_share import Clusters, disc_in_slopes
from seaglint.sea.glitter.short_waves import ShortWaves
from seaglint.sea.shadowing.smith import projected_area
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.tiles import RESOLVED_SHARE, resolve_limit

STEEPEST: Final = 7.0  #: Steepness of the mirroring slope up to which variances are computed [1]; beyond, glint is 1e-10 of its peak.

#: Steepness at which variances are computed; their logarithm is nearly linear in its square.
_STEEPNESS: Final = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.5, STEEPEST])

COLUMNS: Final = 2.0  #: Least length of geometry's waves in widths of a pixel, as in images.

#: Winds at which the waves of many cases are computed [m s⁻¹]: variances between them are within 2 %.
WINDS: Final = tuple(float(wind) for wind in np.geomspace(0.5, 20.0, 19))

#: Nodes per decade of the width of a pixel, its length over its width, and the radius of the disc; logarithms are linear in between.
_PER_DECADE: Final = (4.0, 4.0, 2.0)

_BLOCK: Final = 1 << 14  #: Number of pixels whose variance is read from the table at once.

_LONGEST: Final = 1e9  #: Length of waves for a sea that is not resolved [m]: all its waves are shorter.


@dataclass(frozen=True)
class WaveGlint:
    """Waves from which the fluctuation of glint follows, instead of a fixed correlation time."""

    spectrum: DirectionalSpectrum | None  #: All waves; None for slopes without a spectrum.
    shortest_wave: float  #: Length of the shortest wave that is geometry [m]; infinite where none is.

    def short_waves(self, slopes: SlopeStatistics, cut: float) -> ShortWaves:
        """Return the waves beyond a wavenumber [rad m⁻¹]: of the spectrum, or of the slope law where the spectrum has none there."""
        spectrum = self.spectrum
        if spectrum is not None and cut < 0.9 * spectrum.wavenumber_range[1]:
            waves = ShortWaves.of_spectrum(spectrum, cut)
            if min(waves.variances) > 0.0:
                return waves
        return ShortWaves.of_slopes(slopes, cut)

    def clusters(self, slopes: SlopeStatistics, cut: float) -> Clusters:
        """Return the fluctuation of the lit share by the waves beyond a wavenumber [rad m⁻¹], on a sea of slopes.

        Waves up to the wavenumber are geometry as far as the energy rule allows, and have the spectrum's slopes; the short ones have
        what is left of the slope law, as facets of images.
        """
        if self.spectrum is None:
            return Clusters(self.short_waves(slopes, 0.0).scaled(slopes.mss_up, slopes.mss_cross))
        end = min(cut, resolve_limit(self.spectrum, slopes))
        waves = self.short_waves(slopes, end)
        longer = ShortWaves.of_spectrum(self.spectrum, 0.0, end).variances if end > 1.01 * self.spectrum.wavenumber_range[0] else (0.0, 0.0)
        axis = waves.to_azimuth
        total = float(slopes.mss_along(axis)), float(slopes.mss_along(axis + 0.5 * math.pi))
        # the axis of longer waves may be another: no direction loses more than the energy rule allows
        kept = tuple(min(part, RESOLVED_SHARE * whole) for part, whole in zip(longer, total, strict=True))
        return Clusters(waves.scaled(total[0] - kept[0], total[1] - kept[1]), (kept[0], 0.0, kept[1]))

    def relative_variance(
        self,
        slopes: SlopeStatistics,
        radius: ArrayLike,
        cos_incidence: ArrayLike,
        view_zenith: ArrayLike,
        sun_up: ArrayLike,
        slant_range: ArrayLike,
        solid_angle: ArrayLike,
        chance: ArrayLike,
        solar_azimuth: ArrayLike | None = None,
    ) -> FloatArray:
        r"""Relative variance of the mirrored Sun in square pixels, ``v = K A+/(Omega r^2)`` [1].

        ``A+`` is the area of the sea over the viewed area that the chance of mirroring implies, hiding and shadows included:
        ``A+ = p pi eps^2/(4 cos^4(beta) P)``. The less of the sea is seen and lit in a pixel, the more it fluctuates.

        Parameters
        ----------
        slopes : SlopeStatistics
            Slopes of all waves.
        radius : array_like
            Angular radius of the Sun, or of the lit part of the Moon [rad].
        cos_incidence, view_zenith, slant_range, solid_angle
            As in ``patches``.
        sun_up : array_like
            Cosine of the zenith angle of the visible part of the Sun [1].
        chance : array_like
            P, share of the viewed area that mirrors the light, above 0 [1].
        solar_azimuth : array_like, optional
            Azimuth of the Sun [rad]; without it slopes are taken as equal in all directions.

        Returns
        -------
        ndarray
            Of the broadcast shape, 0 or more.

        Notes
        -----
        Looks to both sides of the Sun have the mean of both, as the angle of incidence does not distinguish them. Slope laws with skewness
        have Smith's ``A+`` of the viewer, with slopes equal in all directions.
        """
        cosine = np.maximum(np.asarray(cos_incidence, np.float64), 1e-9)
        upward = np.maximum(np.cos(np.asarray(view_zenith, np.float64)), 1e-6)
        tilt = np.clip((upward + np.asarray(sun_up, np.float64)) / (2.0 * cosine), 1e-3, 1.0)
        inverse, along = _directions(slopes, cosine, upward, sun_up, solar_azimuth)
        steepness = np.sqrt(np.maximum(1.0 / tilt**2 - 1.0, 0.0) * inverse)
        disc = np.asarray(radius, np.float64)
        spread = disc_in_slopes(disc, tilt, cosine)
        width = np.sqrt(np.asarray(solid_angle, np.float64)) * np.asarray(slant_range, np.float64)
        steepness, width, length, spread, along = np.broadcast_arrays(steepness, width, width / upward, spread, along)
        if steepness.size == 0 or slopes.is_flat:
            return np.zeros(steepness.shape)
        # block by block: the corners of the table take some hundred bytes a pixel
        columns = [np.ravel(values) for values in (width, length / width, spread, steepness, along)]
        blocks = [[column[i : i + _BLOCK] for column in columns] for i in range(0, steepness.size, _BLOCK)]
        logs = np.concatenate([self._area(slopes, (block[0], block[1], block[2]), block[3], block[4]) for block in blocks])
        if slopes.is_gaussian:
            spread2 = 0.25 * spread**2
            peak = 2.0 * math.pi * np.sqrt((slopes.mss_up + spread2) * (slopes.mss_cross + spread2))
            density = np.exp(-0.5 * steepness**2) / peak
            share = np.maximum(np.asarray(chance, np.float64), 1e-300)
            seen = density * math.pi * disc**2 / (4.0 * tilt**4 * share)
        else:
            # the chance has a skewness that the steepness does not know
            seen = projected_area(np.asarray(view_zenith, np.float64), 0.5 * slopes.mss)
        return np.asarray(np.exp(logs.reshape(steepness.shape)) * seen / width**2)

    def correlation_time(self, slopes: SlopeStatistics, radius: float, width: float, length: float) -> float:
        """Time after which the light of a pixel of a width and length on the sea [m] keeps 1/e of its correlation [s].

        For facets a deviation away from the mirroring slope, a disc of a ``radius`` [rad] near the nadir, and a pixel along the wind; these
        change the time by less than the size of the pixel does.
        """
        return _clusters(self, slopes, self._cut(width)).correlation_time(1.0, 0.5 * radius, (length, width))

    def _cut(self, width: float) -> float:
        """Wavenumber up to which waves are geometry for pixels of a width [m] [rad m⁻¹]."""
        return 2.0 * math.pi / max(min(self.shortest_wave, _LONGEST), COLUMNS * width)

    def _area(self, slopes: SlopeStatistics, sizes: tuple[FloatArray, ...], steepness: FloatArray, along: FloatArray) -> FloatArray:
        """Logarithm of ``K`` [m2] at widths, ratios of length to width and discs, linear between nodes of their logarithms [(n,) each].

        ``along``: squared cosine of the angle between the line of sight and the wind [1].
        """
        nodes = np.stack([per * np.log10(size) for per, size in zip(_PER_DECADE, sizes, strict=True)])
        lower = np.floor(nodes)
        squared = np.clip(steepness, 0.0, STEEPEST) ** 2
        u = np.clip(np.searchsorted(_STEEPNESS**2, squared, side="right") - 1, 0, _STEEPNESS.size - 2)
        part = (squared - _STEEPNESS[u] ** 2) / (_STEEPNESS[u + 1] ** 2 - _STEEPNESS[u] ** 2)
        total = np.zeros(steepness.shape)
        for corner in np.ndindex(2, 2, 2):
            step = np.array(corner, np.float64)[:, None]
            weight = np.prod(1.0 - np.abs(nodes - lower - step), axis=0)
            places, inverse = np.unique((lower + step).T.astype(np.int64), axis=0, return_inverse=True)
            table = np.array([_node(self, slopes, *(int(n) for n in place)) for place in places])[inverse.ravel()]
            rows = np.arange(steepness.size)
            ways = [table[rows, way, u] + part * (table[rows, way, u + 1] - table[rows, way, u]) for way in range(2)]
            total += weight * (along * ways[0] + (1.0 - along) * ways[1])
        return total


def variance_by_wind(
    at: Callable[[float], tuple[WaveGlint, SlopeStatistics]], wind: FloatArray, radius: FloatArray, looks: tuple[FloatArray, ...]
) -> FloatArray:
    """Relative variance of the mirrored Sun in square pixels, each at its own wind: interpolated between ``WINDS`` in logarithms.

    Parameters
    ----------
    at : callable
        Waves and slopes of a wind [m s⁻¹].
    wind : ndarray
        Winds [m s⁻¹, (n,)]; beyond ``WINDS`` the nearest of them counts.
    radius : ndarray
        Angular radius of the light [rad, (n,)].
    looks : tuple of ndarray
        Cosine of incidence, view zenith, ``sun_up``, slant range, solid angle, chance and azimuth of the light, as of
        ``WaveGlint.relative_variance`` [(n,) each].

    Returns
    -------
    ndarray
        Relative variance [1, (n,)].
    """
    nodes = np.array(WINDS)
    place = np.interp(np.log(np.maximum(wind, nodes[0])), np.log(nodes), np.arange(nodes.size))
    total = np.zeros(wind.shape)
    for i, node in enumerate(WINDS):
        weight = np.clip(1.0 - np.abs(place - i), 0.0, None)
        near = weight > 0.0
        if near.any():
            glint, slopes = at(node)
            total[near] += weight[near] * np.log(glint.relative_variance(slopes, radius[near], *(look[near] for look in looks)))
    return np.exp(total)


def _directions(
    slopes: SlopeStatistics, cosine: FloatArray, view_up: FloatArray, sun_up: ArrayLike, solar_azimuth: ArrayLike | None
) -> tuple[FloatArray, FloatArray]:
    """Squared steepness of the mirroring slope over its square [1], and squared cosine between line of sight and wind [1].

    The angle of incidence implies the directions up to the side of the Sun; both are means over the two sides.
    """
    least = max(slopes.mss, 1e-300) * 1e-6
    up, cross = max(slopes.mss_up, least), max(slopes.mss_cross, least)
    # a slope law without directions leaves none to a pixel either
    if solar_azimuth is None or slopes.is_isotropic:
        return np.asarray(2.0 / (up + cross)), np.asarray(0.5)
    sun = np.asarray(sun_up, np.float64)
    level = np.sqrt(np.maximum((1.0 - view_up**2) * (1.0 - sun**2), 1e-12))
    aside = np.clip((2.0 * cosine**2 - 1.0 - view_up * sun) / level, -1.0, 1.0)
    # horizontal directions to viewer and Sun, along and across the Sun's azimuth; the slope points against their sum
    along = np.sqrt(np.maximum(1.0 - view_up**2, 0.0)) * aside + np.sqrt(np.maximum(1.0 - sun**2, 0.0))
    across = np.sqrt(np.maximum((1.0 - view_up**2) * (1.0 - aside**2), 0.0))
    size = np.maximum(along**2 + across**2, 1e-12)
    from_wind = np.cos(2.0 * (np.asarray(solar_azimuth, np.float64) - slopes.wind_to_azimuth))
    double = (along**2 - across**2) / size * from_wind
    sight = 0.5 * (1.0 + (2.0 * aside**2 - 1.0) * from_wind)
    return np.asarray(0.5 * ((1.0 + double) / up + (1.0 - double) / cross)), np.asarray(sight)


@lru_cache(maxsize=64)
def _clusters(glint: WaveGlint, slopes: SlopeStatistics, cut: float) -> Clusters:
    return glint.clusters(slopes, cut)


@lru_cache(maxsize=4096)
def _node(glint: WaveGlint, slopes: SlopeStatistics, width: int, ratio: int, disc: int) -> FloatArray:
    """Logarithms of ``K`` [m2] at the steepness of ``_STEEPNESS``, for numbers of the nodes of a pixel's width, shape and disc.

    Rows: pixels whose length lies along the wind, and across it.
    """
    size, shape, radius = (10.0 ** (number / per) for number, per in zip((width, ratio, disc), _PER_DECADE, strict=True))
    clusters = _clusters(glint, slopes, glint._cut(size))
    ways = [[clusters.variance(float(u), radius, (shape * size, size), turn) for u in _STEEPNESS] for turn in (0.0, 0.5 * math.pi)]
    return np.asarray(np.log(np.maximum(np.array(ways) * shape * size**2, 1e-30)))
