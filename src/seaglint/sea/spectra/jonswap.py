"""JONSWAP spectrum of a stated height and period (Hasselmann et al. 1973), for wind sea and swell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.sea.spectra.directional import GRAVITY_WAVES_END, DirectionalSpectrum, cosine_power, power_of_width, second_moment

HEIGHTS: Final = (0.01, 30.0)  #: Allowed significant heights [m].

PERIODS: Final = (0.5, 30.0)  #: Allowed peak periods [s]; shorter waves are not gravity waves, longer ones are not raised by wind.

#: Allowed peak enhancements [1]: 1 is a fully developed sea, the experiment's mean 3.3, its scatter 1 to 7.
PEAK_FACTORS: Final = (1.0, 20.0)

STEEPEST: Final = 0.07  #: Largest allowed ratio of significant height to the peak's wavelength [1]; young seas in a gale reach 0.06.

_SIDES: Final = (0.07, 0.09)  # width of the peak below and above its frequency


@dataclass(frozen=True)
class JonswapSpectrum(DirectionalSpectrum):
    """JONSWAP spectrum with a given height, spread by a power of the cosine.

    ``E(f) ~ f^-5 exp[-5/4 (f_p/f)^4] gamma^r``, ``r = exp[-(f/f_p - 1)^2/(2 sigma^2)]``, sigma 0.07 below the peak and 0.09 above,
    with the gravity dispersion ``(2 pi f)^2 = g k`` and the level that gives the significant height.

    Raises
    ------
    DomainError
        Height, period, enhancement or width outside the allowed ranges; waves too steep to exist.

    Notes
    -----
    Cut at 370 rad/m (1.7 cm), where surface tension takes over; the height counts the waves up to there.

    References
    ----------
    Hasselmann et al. 1973, Dtsch. Hydrogr. Z. Suppl. A 8(12), Eq. 2.4.1.

    Examples
    --------
    >>> round(JonswapSpectrum(2.0, 12.0, 0.0).significant_height(), 6)
    2.0
    """

    height: float  #: Significant height, four times the standard deviation of the surface [m].
    peak_period: float  #: Period of the largest density per frequency [s].
    to_azimuth: float  #: Azimuth the waves travel TO [rad].
    gamma: float = 3.3  #: Peak enhancement [1].
    width: float = float(np.radians(30.0))  #: Circular width of the directions [rad]; see :mod:`seaglint.sea.spectra.directional`.
    wind_to_azimuth: float = 0.0  #: Azimuth the wind blows TO [rad]; used only to distinguish upwind from crosswind.

    def __post_init__(self) -> None:
        """Refuse values outside the ranges, and waves that would break."""
        for name, value, (low, high), unit in (
            ("height", self.height, HEIGHTS, " m"),
            ("peak_period", self.peak_period, PERIODS, " s"),
            ("gamma", self.gamma, PEAK_FACTORS, ""),
        ):
            if not low <= value <= high:
                raise DomainError(
                    f"{name} = {value:g}{unit} is outside {low:g}-{high:g}{unit} of the JONSWAP spectrum; give a value inside",
                    name=name,
                    value=value,
                    allowed=(low, high),
                )
        if not (np.isfinite(self.to_azimuth) and np.isfinite(self.wind_to_azimuth)):
            raise DomainError("azimuths of waves and wind must be finite", name="to_azimuth", value=self.to_azimuth, allowed="finite")
        power_of_width(self.width)
        most = STEEPEST * GRAVITY * self.peak_period**2 / (2.0 * np.pi)
        if self.height > most:
            raise DomainError(
                f"height = {self.height:g} m at a peak period of {self.peak_period:g} s is steeper than waves can be; allowed: up to "
                f"{most:.3g} m ({100 * STEEPEST:g} % of the peak's wavelength); give a longer period or less height",
                name="height",
                value=self.height,
                allowed=(HEIGHTS[0], float(most)),
            )

    @property
    def peak_wavenumber(self) -> float:
        """Wavenumber of the frequency spectrum's peak, ``(2 pi/T_p)^2/g`` [rad m⁻¹]."""
        return float((2.0 * np.pi / self.peak_period) ** 2 / GRAVITY)

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range from a sixth of the peak (a factor exp(-45)) to 370 rad/m [rad m⁻¹]."""
        return self.peak_wavenumber / 6.0, GRAVITY_WAVES_END

    def breakpoints(self) -> FloatArray:
        """Peak wavenumber, where the peak width changes, and the sides of the narrow peak [rad m⁻¹]."""
        # the width jumps at the peak; the other points keep panels short across it
        low, high = _SIDES
        return np.asarray(self.peak_wavenumber * np.array([1 - 3 * low, 1 - low, 1.0, 1 + high, 1 + 3 * high]) ** 2)

    def _shape(self, k: FloatArray) -> FloatArray:
        """Unscaled spectrum ``k^-3 exp[-5/4 (k_p/k)^2] gamma^r`` [m³]."""
        ratio = np.sqrt(k / self.peak_wavenumber)
        side = np.where(ratio <= 1.0, *_SIDES)
        peak = self.gamma ** np.exp(-((ratio - 1.0) ** 2) / (2.0 * side**2))
        return np.asarray(k**-3 * np.exp(-1.25 * ratio**-4) * peak)

    @cached_property
    def _level(self) -> float:
        """Scale factor that gives the stated height [1]."""
        return float((self.height / 4.0) ** 2 / self.integrate(self._shape))

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Omnidirectional spectrum ``S(k)`` of the stated height [m³]."""
        k = np.asarray(wavenumber, dtype=np.float64)
        low, high = self.wavenumber_range
        inside = (k >= low) & (k <= high)
        return np.asarray(np.where(inside, self._level * self._shape(np.where(inside, k, self.peak_wavenumber)), 0.0))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Spreading function, the same power of the cosine at every wavenumber [rad⁻¹]."""
        share = cosine_power(np.asarray(azimuth, dtype=np.float64) - self.to_azimuth, power_of_width(self.width))
        return np.asarray(np.broadcast_arrays(share, np.asarray(wavenumber, dtype=np.float64))[0])

    def _second(self) -> complex:
        """Second moment of the directions about the wind [1]."""
        return complex(second_moment(float(power_of_width(self.width))) * np.exp(2j * (self.to_azimuth - self.wind_to_azimuth)))

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic of the spreading along the wind [1], equal at every wavenumber."""
        return np.full(np.shape(np.asarray(wavenumber)), self._second().real)

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic of the spreading across the wind [1], equal at every wavenumber."""
        return np.full(np.shape(np.asarray(wavenumber)), self._second().imag)
