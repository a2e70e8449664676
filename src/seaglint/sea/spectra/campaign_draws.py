"""Short waves between those of two measured campaigns and a model: how far the sea itself is unknown at one wind.

Least and largest saturation ``B = k^3 S`` of three seas bound the short waves of a wind: the Air-Sea Interaction Tower 2019, RaDyO 2008
(``seaglint.sea.spectra.campaigns``, from 20 rad/m) and Elfouhaily et al. 1997. A sea between them has two numbers of 0 to 1, its levels
at ``k_1`` and ``k_2``, between which the level is linear in the logarithm of the wavenumber:

    B(k) = B_min(k)^(1 - u(k)) B_max(k)^u(k),     u = u_long + (u_short - u_long) ln(k/k_1)/ln(k_2/k_1)

With even ``u_long`` and ``u_short`` the saturation is log-uniform between the bounds at ``k_1`` and ``k_2``; between them the levels of
two wavenumbers have the correlation :func:`level_correlation`, and less spread (1/sqrt(2) of it in the middle). Waves longer than
``k_1/2`` are a given spectrum's; from there to ``k_1`` one passes to the other, linearly in ln k. Waves shorter than ``k_2`` fall off as
the short waves of Elfouhaily's model do by surface tension and viscosity (Eq. 40):
``B = B(k_2) c(k_2)/c(k) exp{[(k_2/k_m - 1)^2 - (k/k_m - 1)^2]/4}``.

At winds outside a campaign's its saturation is the saturation of its nearest wind, in proportion to the wind, as Cox and Munk's slope
variances are. Elfouhaily's ratio is not used for this: its slope variance beyond 5 rad/m falls from 0.018 to 0.014 between 1 and 2.7 m/s.

The bounds are no confidence interval: they hold two campaigns and one model, and which is right is not known.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.random import stream
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.spectra.campaigns import CAMPAIGNS, Campaign, campaign_spectrum, campaign_winds
from seaglint.sea.spectra.combined import CombinedSpectrum
from seaglint.sea.spectra.directional import DirectionalSpectrum, require_wavenumbers
from seaglint.sea.spectra.elfouhaily import VALID_WIND, ElfouhailySpectrum
from seaglint.sea.spectra.saturation_table import elfouhaily_or_calm

LONGEST: Final = 5.0  #: Wavenumber ``k_1`` of the first level [rad m⁻¹]: 1.3 m, near the longest waves of which both campaigns differ.

SHORTEST_MEASURED: Final = 1000.0  #: Wavenumber ``k_2`` of the second level [rad m⁻¹]: 6 mm, the last that both campaigns have.

SHORTEST: Final = 1.0e4  #: Wavenumber at which the spectrum ends [rad m⁻¹]; beyond 3000 rad/m there is less than 1e-6 of the saturation.

#: First wavenumber of each campaign that counts for the bounds [rad m⁻¹]; longer waves of RaDyO are Elfouhaily's in its table.
MEASURED_FROM: Final[dict[Campaign, float]] = {"asit-2019": 0.5 * LONGEST, "radyo-2008": 20.0}

_K_M: Final = 370.0  # gravity-capillary peak of Elfouhaily's model [rad/m]

_PER_DECADE: Final = 32  # panels of a table of slopes; four points each
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(4)

_STEP: Final = 1e-4  # share of the wavenumber over which a bound passes to another one where a campaign begins


class ShortWaveLevels(NamedTuple):
    """Place of a sea between the bounds, 0 at the least and 1 at the largest saturation [1]."""

    long: float  #: At ``LONGEST``.
    short: float  #: At ``SHORTEST_MEASURED``.


class ShortWaveBounds(NamedTuple):
    """Least and largest saturation of a wind, log-linear in the logarithm of the wavenumber between the rows."""

    wavenumber: FloatArray  #: Ascending, from half of ``LONGEST`` to ``SHORTEST_MEASURED`` [rad m⁻¹, (n,)].
    least: FloatArray  #: [1, (n,)].
    largest: FloatArray  #: [1, (n,)].


def drawn_levels(seed: int, draw: int = 0, draws: int = 1) -> ShortWaveLevels:
    """Return the levels of one of several seas.

    Each level is even over 0 to 1, and of ``draws`` seas each ``1/draws`` of this range holds one (Latin hypercube): a quantile over few
    seas then varies less between seeds than a quantile of independent ones.

    Parameters
    ----------
    seed : int
        Seed; the levels are a function of it, the number of the sea, and how many there are.
    draw, draws : int
        Number of the sea, from 0, and how many there are.

    Returns
    -------
    ShortWaveLevels

    Examples
    --------
    >>> seas = [drawn_levels(7, i, 4) for i in range(4)]
    >>> sorted(int(4 * sea.short) for sea in seas)
    [0, 1, 2, 3]
    """
    if not 0 <= draw < draws:
        raise DomainError(
            f"sea {draw} of {draws} does not exist; count from 0 to {draws - 1}", name="draw", value=draw, allowed=(0, draws - 1)
        )
    rng = stream(seed, "sea between campaigns", draws)
    places = np.stack([rng.permutation(draws) for _ in ShortWaveLevels._fields])
    long, short = ((places + rng.random(places.shape)) / draws)[:, draw].tolist()
    return ShortWaveLevels(long, short)


def level_at(levels: ShortWaveLevels, wavenumber: ArrayLike) -> FloatArray:
    """Return the level ``u`` at wavenumbers [rad m⁻¹]; beyond the two ends it is that of the end [1]."""
    share = _share(wavenumber)
    return np.asarray(levels.long + (levels.short - levels.long) * share)


def _share(wavenumber: ArrayLike) -> FloatArray:
    k = np.asarray(wavenumber, dtype=np.float64)
    return np.asarray(np.clip(np.log(k / LONGEST) / np.log(SHORTEST_MEASURED / LONGEST), 0.0, 1.0))


def level_correlation(first: ArrayLike, second: ArrayLike) -> FloatArray:
    """Return the correlation of the levels of two wavenumbers [rad m⁻¹] over drawn seas [1].

    ``[(1 - t)(1 - t') + t t']/sqrt{[(1 - t)^2 + t^2][(1 - t')^2 + t'^2]}`` with ``t = ln(k/k_1)/ln(k_2/k_1)``.

    Examples
    --------
    >>> level_correlation([5.0, 5.0, 5.0], [5.0, 70.7, 1000.0]).round(2).tolist()
    [1.0, 0.71, 0.0]
    """
    t, s = _share(first), _share(second)
    return np.asarray(((1.0 - t) * (1.0 - s) + t * s) / np.sqrt(((1.0 - t) ** 2 + t**2) * ((1.0 - s) ** 2 + s**2)))


@lru_cache(maxsize=1024)
def short_wave_bounds(wind: float) -> ShortWaveBounds:
    """Return the bounds of the saturation of short waves at a wind.

    Parameters
    ----------
    wind : float
        Neutral wind at 10 m [m s⁻¹], above 0 and at most 30.

    Returns
    -------
    ShortWaveBounds

    Raises
    ------
    DomainError
        A wind outside Elfouhaily's model.

    Examples
    --------
    >>> bounds = short_wave_bounds(7.0)
    >>> ratio = bounds.largest / bounds.least
    >>> float(ratio[-1].round(0))
    26.0
    """
    if not 0.0 < wind <= VALID_WIND[1]:
        raise DomainError(
            f"wind_speed = {wind:g} m/s is outside 0-{VALID_WIND[1]:g} m/s of the seas between the campaigns; choose a wind inside it",
            name="wind_speed",
            value=wind,
            allowed=(0.0, VALID_WIND[1]),
        )
    low, high = 0.5 * LONGEST, SHORTEST_MEASURED
    seas = []
    for name in CAMPAIGNS:
        winds = campaign_winds(name)
        nearest = float(np.clip(wind, winds[0], winds[-1]))
        # The last wavenumber of a table is its own; the bounds end there.
        seas.append((MEASURED_FROM[name], campaign_spectrum(name, nearest), wind / nearest))
    starts = [start * (1.0 - _STEP) for start, _, _ in seas if start > low]
    # Elfouhaily's spectrum is smooth: between 8 points an octave log-linear interpolation is within 1 %.
    even = np.geomspace(low, high, 8 * int(np.ceil(np.log2(high / low))) + 1)
    k = np.unique(np.concatenate([even, starts, [LONGEST], *(sea.breakpoints() for _, sea, _ in seas)]))
    k = k[(k >= low) & (k <= high)]
    model = elfouhaily_or_calm(wind, 0.0)
    assert model is not None  # the wind is above 0
    values = [k**3 * model.omnidirectional(k)]
    # nan where the campaign has no waves: it counts for neither bound there
    values += [np.where(k >= start, ratio * k**3 * sea.omnidirectional(k), np.nan) for start, sea, ratio in seas]
    # Calm seas have no energy at some wavenumbers, whose logarithm is still needed.
    table = np.maximum(values, 1e-30)
    return ShortWaveBounds(k, np.nanmin(table, axis=0), np.nanmax(table, axis=0))


@dataclass(frozen=True)
class DrawnShortWaves(DirectionalSpectrum):
    """Short waves of a wind between the bounds, from half of ``LONGEST``; with ``directions`` of another spectrum.

    Raises
    ------
    DomainError
        ShortWaveLevels outside 0 to 1, or a wind outside Elfouhaily's model.

    Examples
    --------
    >>> calm, rough = (DrawnShortWaves(7.0, ShortWaveLevels(u, u), ElfouhailySpectrum(7.0)) for u in (0.0, 1.0))
    >>> round(sum(calm.mss()), 3), round(sum(rough.mss()), 3)
    (0.017, 0.056)
    """

    wind: float  #: Neutral wind at 10 m [m s⁻¹].
    levels: ShortWaveLevels  #: Place between the bounds.
    directions: DirectionalSpectrum  #: Spectrum with the directions of the short waves, about the same wind.

    def __post_init__(self) -> None:
        """Refuse levels that are no place between the bounds."""
        for level in self.levels:
            if not 0.0 <= level <= 1.0:
                raise DomainError(
                    f"level = {level:g} is not within 0-1, the least and the largest saturation of short waves; choose a value inside it",
                    name="levels",
                    value=level,
                    allowed=(0.0, 1.0),
                )
        short_wave_bounds(self.wind)

    @property
    def wind_to_azimuth(self) -> float:  # type: ignore[override]
        """Azimuth the wind blows TO [rad]."""
        return self.directions.wind_to_azimuth

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range of wavenumbers that has energy [rad m⁻¹]."""
        return 0.5 * LONGEST, SHORTEST

    @property
    def peak_wavenumber(self) -> float:
        """Longest of these waves that are not mixed with others [rad m⁻¹]: their height spectrum falls from there."""
        return LONGEST

    def breakpoints(self) -> FloatArray:
        """Wavenumbers of the bounds and of the directions [rad m⁻¹]."""
        return np.unique(np.concatenate([short_wave_bounds(self.wind).wavenumber, self.directions.breakpoints()]))

    def saturation(self, wavenumber: ArrayLike) -> FloatArray:
        """Saturation ``B = k^3 S`` [1], before it passes to longer waves."""
        k = np.asarray(wavenumber, dtype=np.float64)
        nodes, least, largest = short_wave_bounds(self.wind)
        x, at = np.log(np.clip(k, nodes[0], nodes[-1])), np.log(nodes)
        low, high = np.interp(x, at, np.log(least)), np.interp(x, at, np.log(largest))
        inside = np.exp(low + level_at(self.levels, k) * (high - low))
        return np.asarray(inside * np.where(k > nodes[-1], _fall(np.maximum(k, nodes[-1])), 1.0))

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Height variance per wavenumber [m³]."""
        k = np.asarray(wavenumber, dtype=np.float64)
        low, high = self.wavenumber_range
        safe = np.clip(k, low, high)
        return np.asarray(np.where((k >= low) & (k <= high), passage(safe) * self.saturation(safe) / safe**3, 0.0))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Share of energy per angle travelling TO an azimuth [rad⁻¹]."""
        return self.directions.spreading(wavenumber, azimuth)

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic of the spreading [1]."""
        return self.directions.second_harmonic(wavenumber)

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic across the wind [1]."""
        return self.directions.cross_harmonic(wavenumber)


@dataclass(frozen=True)
class LongWaves(DirectionalSpectrum):
    """Waves of a spectrum that are longer than the short ones: all to half of ``LONGEST``, and less and less of them up to it."""

    spectrum: DirectionalSpectrum  #: Spectrum of all waves.

    @property
    def wind_to_azimuth(self) -> float:  # type: ignore[override]
        """Azimuth the wind blows TO [rad]."""
        return self.spectrum.wind_to_azimuth

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range of wavenumbers that has energy [rad m⁻¹]; empty where all waves are short."""
        low, high = self.spectrum.wavenumber_range
        return min(low, LONGEST), min(high, LONGEST)

    @property
    def peak_wavenumber(self) -> float:
        """Wavenumber of the spectral peak [rad m⁻¹]; ``LONGEST`` at most."""
        return min(self.spectrum.peak_wavenumber, LONGEST)

    def breakpoints(self) -> FloatArray:
        """Break points of the spectrum, and the ends of the passage [rad m⁻¹]."""
        k = np.append(self.spectrum.breakpoints(), [0.5 * LONGEST, LONGEST])
        return np.unique(k[k <= LONGEST])

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Height variance per wavenumber [m³]."""
        return np.asarray((1.0 - passage(wavenumber)) * self.spectrum.omnidirectional(wavenumber))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Share of energy per angle travelling TO an azimuth [rad⁻¹]."""
        return self.spectrum.spreading(wavenumber, azimuth)

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic of the spreading [1]."""
        return self.spectrum.second_harmonic(wavenumber)

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic across the wind [1]."""
        return self.spectrum.cross_harmonic(wavenumber)


class DrawnSea(CombinedSpectrum):
    """Sum of longer and short waves whose slope variances are read from a table of their integrals.

    Slopes of a sea take some fifty integrals and a likelihood some hundred seas; with the table they take a tenth of the time. Between its
    wavenumbers the integrals are cubic in ln k, with their values and derivatives: within 1e-5 of the total slope variance.
    """

    @cached_property
    def _slopes(self) -> CubicHermiteSpline:
        """Integrals from the longest waves: slope variance, its part by which waves along the wind exceed, covariance [1], of ln k."""
        low, high = self.wavenumber_range
        breaks = self.breakpoints()
        even = np.geomspace(low, high, 1 + int(np.ceil(_PER_DECADE * np.log10(high / low))))
        edges = np.log(np.unique(np.concatenate([even, breaks[(breaks > low) & (breaks < high)]])))
        half = 0.5 * np.diff(edges)[:, None]
        within = edges[:-1, None] + half * (1.0 + _GAUSS_X)
        at_edges, of_panels = self._densities(np.exp(edges)), self._densities(np.exp(within))
        sums = np.cumsum((half * _GAUSS_W * of_panels).sum(axis=-1), axis=-1)
        return CubicHermiteSpline(edges, np.concatenate([np.zeros((3, 1)), sums], axis=1), at_edges, axis=1)

    def _densities(self, k: FloatArray) -> FloatArray:
        """Slope variance per ln k, times 1 and both second harmonics [1, (3, ...)]."""
        both = k**3 * self.omnidirectional(k)
        return np.stack([both, both * self.second_harmonic(k), both * self.cross_harmonic(k)])

    def _between(self, k_min: float, k_max: float) -> list[float]:
        require_wavenumbers(k_min, k_max)
        first, last = np.clip([k_min, k_max], *self.wavenumber_range)
        if last <= first:
            return [0.0, 0.0, 0.0]
        ends = self._slopes(np.log([first, last]))
        return [float(value) for value in ends[:, 1] - ends[:, 0]]

    def mss(self, k_max: float = np.inf, k_min: float = 0.0) -> tuple[float, float]:
        """Slope variance along and across the wind of waves with k_min <= k < k_max [1]."""
        both, split, _ = self._between(k_min, k_max)
        return 0.5 * (both + split), 0.5 * (both - split)

    def slope_covariance(self, k_max: float = np.inf, k_min: float = 0.0) -> float:
        """Covariance of the slopes along the wind and to the right of it, of waves with k_min <= k < k_max [1]."""
        return 0.5 * self._between(k_min, k_max)[2]


def passage(wavenumber: ArrayLike) -> FloatArray:
    """Return the share of the short waves [1] in the passage: 0 to half of ``LONGEST``, 1 from it on, linear in ln k."""
    k = np.maximum(np.asarray(wavenumber, dtype=np.float64), 1e-12)
    return np.asarray(np.clip(np.log2(k / (0.5 * LONGEST)), 0.0, 1.0))


def _fall(wavenumber: FloatArray) -> FloatArray:
    """Saturation over the saturation at ``SHORTEST_MEASURED`` of shorter waves [1] (Elfouhaily et al. 1997, Eq. 40)."""
    end = SHORTEST_MEASURED
    falls = 0.25 * ((end / _K_M - 1.0) ** 2 - (wavenumber / _K_M - 1.0) ** 2)
    slower = angular_frequency(end) / end * wavenumber / angular_frequency(wavenumber)
    return np.asarray(slower * np.exp(falls))


def drawn_sea(
    wind: float, levels: ShortWaveLevels, wind_to_azimuth: float, longer: DirectionalSpectrum | None, *, directed: bool = True
) -> DrawnSea | None:
    """Return a sea with short waves between the bounds.

    Parameters
    ----------
    wind : float
        Neutral wind at 10 m [m s⁻¹]; without wind there are no short waves.
    levels : ShortWaveLevels
        Place between the bounds.
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].
    longer : DirectionalSpectrum, optional
        Spectrum of the longer waves, about the same wind; None without longer waves.
    directed : bool
        True where ``longer`` also has the directions of the short waves; otherwise, and without it, Elfouhaily's of the wind serve.

    Returns
    -------
    DrawnSea or None
        None for a sea without waves.

    Examples
    --------
    >>> model = ElfouhailySpectrum(7.0)
    >>> seas = [drawn_sea(7.0, drawn_levels(1, i, 20), 0.0, model) for i in range(20)]
    >>> slopes = sorted(sum(sea.mss()) for sea in seas if sea is not None)
    >>> round(slopes[0], 3), round(slopes[-1], 3), round(sum(model.mss()), 3)
    (0.033, 0.062, 0.042)
    """
    parts: list[DirectionalSpectrum] = []
    if longer is not None and longer.wavenumber_range[0] < LONGEST:
        parts.append(LongWaves(longer))
    if wind > 0.0:
        of_wind = ElfouhailySpectrum(max(wind, VALID_WIND[0]), wind_to_azimuth)
        parts.append(DrawnShortWaves(wind, levels, longer if directed and longer is not None else of_wind))
    return DrawnSea(tuple(parts)) if parts else None
