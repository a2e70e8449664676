"""Breaking crests by their speed: Phillips' distribution, the foam that they leave, and how often they break.

``Lambda(c) dc`` is the length of breaking crests per area of sea whose speeds are between ``c`` and ``c + dc`` (Phillips 1985). A crest
sweeps the area ``c`` per length and time, and a place that it has passed is foam for the time ``T(c)``. The coverage is therefore
``W = integral of c T(c) Lambda(c) dc``. The shape of ``Lambda`` is published; its amplitude is set here by the coverage.

References
----------
Phillips, J. Fluid Mech. 156, 505 (1985). Melville and Matusov, Nature 417, 58 (2002). Reul and Chapron, J. Geophys. Res. 108, 3321
(2003): life of foam. Rapp and Melville, Phil. Trans. R. Soc. A 331, 735 (1990), and Banner et al., Phys. Rev. Lett. 112, 114502 (2014):
breaking crests are slower than their waves. Korinenko et al., Phys. Oceanogr. 27 (2020), statistical characteristics of wave breakings:
length of crests; the same authors in Fundamental and Applied Hydrophysics: lifetime of whitecaps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
import numpy.typing as npt
from scipy.special import expn, gamma, gammaincc

from seaglint.base.constants import GRAVITY
from seaglint.base.errors import DomainError
from seaglint.sea.wind_profile import FULLY_DEVELOPED

Floats = npt.NDArray[np.float64]
Form = Literal["melville-matusov-2002", "phillips-1985"]  #: Published shapes of the distribution.
FORMS: Final[tuple[str, ...]] = get_args(Form)

SLOWEST: Final = 1.0  #: Speed of the slowest crest that entrains air [m s-1]; crests below some 1.25 m/s contribute little foam.
CREST_SPEED: Final = 0.8  #: Speed of a breaking crest as a share of the phase speed of its wave (Rapp and Melville; Banner et al.).

_DECLINE: Final = 0.64  #: Decline of Melville and Matusov's distribution with speed [s m-1].
_AMPLITUDE: Final = 3.3e-4  #: Value of the same distribution at rest and at a wind of 10 m/s [s m-2]; it grows with the wind cubed.
_POWER: Final = 6  #: Exponent of the decline in Phillips' equilibrium range.

#: Persistence of foam in periods ``2 pi c/g`` (Reul and Chapron 2003): dense foam of the active crest, and all foam of short breakers.
_ACTIVE, _WHOLE = 0.8, 5.0
_DECAY: Final = 3.8  #: Longest decay time of the foam of salt water [s] (Reul and Chapron 2003; measured 0.2 to 10.4 s).
_LENGTH: Final = 0.1  #: Mean length of a breaking crest over the length of its wave (Korinenko et al. 2020).
_DURATION: Final = 0.3  #: Mean time that a crest breaks over the period of its wave (Korinenko et al.).

_NODES: Final = 1025  #: Nodes of the table from which the inversion of the cumulative rate starts.


@dataclass(frozen=True)
class BreakingCrests:
    """Breaking crests of a sea: their density by speed, the life of their foam, and the rate at which they start to break.

    Examples
    --------
    >>> crests = BreakingCrests.create(0.0098, 10.0)
    >>> round(crests.coverage_between(1.0, crests.fastest), 6), round(crests.factor, 2)
    (0.0098, 2.62)
    """

    form: Form  #: Shape of the distribution.
    amplitude: float  #: Factor of the shape: exp(-0.64 c) [s m-2], or c^-6 [m4 s-5].
    slowest: float  #: Speed of the slowest crest [m s-1].
    fastest: float  #: Speed of the fastest crest [m s-1].
    factor: float | None  #: Amplitude over the published one at this wind; None for Phillips' form, of which only the shape is used.

    @classmethod
    def create(
        cls,
        coverage: float,
        wind_speed: float,
        form: Form = "melville-matusov-2002",
        slowest: float = SLOWEST,
        fastest: float | None = None,
    ) -> BreakingCrests:
        """Return the crests whose foam covers a share of the sea.

        Parameters
        ----------
        coverage : float
            Share of the sea that is foam, 0-1.
        wind_speed : float
            Wind speed at 10 m [m s⁻¹].
        form : {"melville-matusov-2002", "phillips-1985"}
            Shape of the distribution.
        slowest : float
            Speed of the slowest crest [m s⁻¹].
        fastest : float, optional
            Speed of the fastest crest [m s⁻¹]; default: of the dominant wave of a fully developed sea, at least ``2 slowest``.

        Returns
        -------
        BreakingCrests

        Raises
        ------
        DomainError
            For an unknown form, a coverage outside 0-1, a wind that is not positive, speeds that are not in order.
        """
        if form not in FORMS:
            raise DomainError(f"form = {form!r} is not known; allowed: {', '.join(FORMS)}", name="form", value=form, allowed=str(FORMS))
        if not 0.0 <= coverage <= 1.0:
            raise DomainError(f"coverage = {coverage:g} is outside 0-1", name="coverage", value=coverage, allowed=(0.0, 1.0))
        if not wind_speed > 0.0:
            raise DomainError(f"wind_speed = {wind_speed:g} m/s must be positive", name="wind_speed", value=wind_speed)
        if fastest is None:
            fastest = max(CREST_SPEED * wind_speed / FULLY_DEVELOPED, 2.0 * slowest)
        if not 0.0 < slowest < fastest < math.inf:
            raise DomainError(f"speeds from {slowest:g} to {fastest:g} m/s are not in order; give 0 < slowest < fastest", name="slowest")
        unscaled = cls(form, 1.0, slowest, fastest, None)
        amplitude = coverage / unscaled.coverage_between(slowest, fastest)
        published = _AMPLITUDE * (wind_speed / 10.0) ** 3 if form == "melville-matusov-2002" else None
        return cls(form, amplitude, slowest, fastest, None if published is None else amplitude / published)

    def density(self, c: npt.ArrayLike) -> Floats:
        """Return ``Lambda(c)``, the length of breaking crests per area and speed [s m⁻²]; 0 outside the range of speeds.

        Parameters
        ----------
        c : array_like
            Speed of the crest [m s⁻¹].

        Returns
        -------
        ndarray
        """
        speed = np.asarray(c, dtype=float)
        shape = np.exp(-_DECLINE * speed) if self.form == "melville-matusov-2002" else np.maximum(speed, self.slowest) ** -float(_POWER)
        return np.where((speed >= self.slowest) & (speed <= self.fastest), self.amplitude * shape, 0.0)

    def active(self, c: npt.ArrayLike) -> Floats:
        """Return how long a place is dense foam after the crest [s]: ``0.8 (2 pi c/g)``; speeds [m s⁻¹]."""
        return _ACTIVE * _period(c)

    def decay(self, c: npt.ArrayLike) -> Floats:
        """Return the decay time of foam after its active part [s]: ``4.2 (2 pi c/g)``, at most 3.8 s; speeds [m s⁻¹]."""
        return np.minimum((_WHOLE - _ACTIVE) * _period(c), _DECAY)

    def life(self, c: npt.ArrayLike) -> Floats:
        """Return ``T(c)``, the integral over time of the share of foam at a place after the crest [s]; speeds [m s⁻¹].

        The share is 1 for the active time and then declines exponentially, so that ``T`` is the sum of active and decay time.
        """
        return np.asarray(self.active(c) + self.decay(c))

    def crest_length(self, c: npt.ArrayLike) -> Floats:
        """Return the mean length of a crest while it breaks [m]: 0.1 of the length of its wave; speeds [m s⁻¹]."""
        phase_speed = np.asarray(c, dtype=float) / CREST_SPEED
        return _LENGTH * 2.0 * math.pi * phase_speed**2 / GRAVITY

    def duration(self, c: npt.ArrayLike) -> Floats:
        """Return the mean time that a crest breaks [s]: 0.3 of the period of its wave; speeds [m s⁻¹]."""
        return _DURATION * _period(np.asarray(c, dtype=float) / CREST_SPEED)

    def rate(self, c: npt.ArrayLike) -> Floats:
        """Return how many crests start to break per area, time and speed [m⁻² s⁻¹ (m s⁻¹)⁻¹]; speeds [m s⁻¹]."""
        return self.density(c) / (self.crest_length(c) * self.duration(c))

    def coverage_between(self, c1: float, c2: float) -> float:
        """Return the share of the sea that is foam of crests between two speeds [m s⁻¹]: the integral of ``c T(c) Lambda(c)``."""
        low, high = self._limited(c1, c2)
        # Above this speed the decay time is 3.8 s, below it grows with the speed: two powers of c, each with its closed form.
        bend = min(max(_DECAY / ((_WHOLE - _ACTIVE) * float(_period(1.0))), low), high)
        growing = self._moment(2, low, high) * _ACTIVE + self._moment(2, low, bend) * (_WHOLE - _ACTIVE)
        return self.amplitude * (growing * float(_period(1.0)) + self._moment(1, bend, high) * _DECAY)

    def rate_between(self, c1: float, c2: float) -> float:
        """Return how many crests with speeds between two values [m s⁻¹] start to break per area and time [m⁻² s⁻¹]."""
        low, high = self._limited(c1, c2)
        return self.amplitude * self._moment(-3, low, high) / float(self.crest_length(1.0) * self.duration(1.0))

    def speeds(self, uniform: npt.ArrayLike, c1: float, c2: float) -> Floats:
        """Return the speeds at which the cumulative rate between two speeds has given values.

        Parameters
        ----------
        uniform : array_like
            Shares of the cumulative rate, 0-1; uniform random numbers give speeds distributed as the breaking crests.
        c1, c2 : float
            Limits of the speeds [m s⁻¹].

        Returns
        -------
        ndarray
            Speeds [m s⁻¹], in the shape of ``uniform``.
        """
        low, high = self._limited(c1, c2)
        share = np.asarray(uniform, dtype=float)
        if self.form == "phillips-1985":
            # The rate declines with the ninth power, its integral with the eighth.
            return np.asarray(((1.0 - share) * low**-8.0 + share * high**-8.0) ** -0.125)
        nodes = np.geomspace(low, high, _NODES)
        tails = _exponential_tail(-3, nodes)
        target = (1.0 - share) * tails[0] + share * tails[-1]
        speed = np.exp(np.interp(-target, -tails, np.log(nodes)))
        for _ in range(2):  # Newton's steps; the table is right to 1e-5, each step doubles the digits
            speed += (_exponential_tail(-3, speed) - target) * speed**3 * np.exp(_DECLINE * speed)
        return np.asarray(np.clip(speed, low, high))

    def _limited(self, c1: float, c2: float) -> tuple[float, float]:
        """Return two speeds within the range of speeds, in order."""
        low, high = (min(max(c, self.slowest), self.fastest) for c in (c1, c2))
        return low, max(low, high)

    def _moment(self, power: int, low: float, high: float) -> float:
        """Return the integral of ``c**power`` times the shape between two speeds."""
        tail = _exponential_tail if self.form == "melville-matusov-2002" else _power_tail
        return float(tail(power, np.asarray(low)) - tail(power, np.asarray(high)))


def _period(speed: npt.ArrayLike) -> Floats:
    """Return the period of the gravity wave with a phase speed [m s⁻¹] in deep water [s]."""
    return np.asarray(2.0 * math.pi / GRAVITY * np.asarray(speed, dtype=float))


def _exponential_tail(power: int, c: Floats) -> Floats:
    """Return the integral of ``c**power exp(-0.64 c)`` from speeds to infinity."""
    if power < 0:
        return np.asarray(c ** (power + 1.0) * expn(-power, _DECLINE * c))
    return np.asarray(gamma(power + 1.0) * gammaincc(power + 1.0, _DECLINE * c) / _DECLINE ** (power + 1.0))


def _power_tail(power: int, c: Floats) -> Floats:
    """Return the integral of ``c**(power - 6)`` from speeds to infinity."""
    rest = _POWER - 1.0 - power
    return np.asarray(c**-rest / rest)
