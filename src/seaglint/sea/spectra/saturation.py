"""Wavenumber spectra given as a table of the saturation, joined to a model beyond the table.

    B(k) = k^3 S(k),     slope variance of a band: int B dk/k

Between two wavenumbers of the table log B is linear in log k where both values are positive; otherwise B is linear in log k. Below the
first and above the last wavenumber the spectrum is a model's, or has no energy. It changes from the table to the model at that wavenumber,
without a passage: every band of the table has the table's energy, every other band the model's.

Directions are given per wavenumber and are linear in log k: by the ratio ``Delta`` of Elfouhaily et al. 1997 (Eq. 49) on the half plane
around the mean direction, ``D = [1 + Delta cos 2 phi]/pi``, or by a circular width, as a power of the cosine
(:mod:`seaglint.sea.spectra.directional`).

References
----------
O. M. Phillips, Spectral and statistical properties of the equilibrium range in wind-generated gravity waves, J. Fluid Mech. 156, 505-531,
1985 (saturation).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.sea.dispersion import group_velocity
from seaglint.sea.spectra.directional import DirectionalSpectrum, cosine_power, downwind, power_of_width

FEWEST: Final = 3  #: Fewest wavenumbers of a table.

#: Angles from the mean direction at which the directional distribution may fall to half its maximum [rad]; of ``WIDTHS``.
HALF_WIDTHS: Final = (float(np.radians(1.2)), float(np.radians(170.0)))


class Join(NamedTuple):
    """Change from the table to a model at one of its ends."""

    wavenumber: float  #: Where it is [rad m⁻¹].
    measured: float  #: Saturation of the table there [1].
    model: float  #: Saturation of the model there [1]; 0 without a model, and where the model has no waves.
    longer: bool  #: True for the longest waves of the table, False for its shortest.


@dataclass(frozen=True, eq=False)
class SaturationSpectrum(DirectionalSpectrum):
    """Spectrum of one wind by a table of the saturation, with models of the longer and the shorter waves.

    Raises
    ------
    DataError
        Fewer than 3 wavenumbers, not ascending, or saturations that are negative, missing or all 0.
    DomainError
        Ratios beyond 1, or widths that the cosine does not have.

    Examples
    --------
    >>> k = np.array([5.0, 20.0, 100.0])
    >>> flat = SaturationSpectrum(k, np.full(3, 0.01), delta=np.full(3, 0.4))
    >>> [round(part, 5) for part in flat.mss(20.0, 5.0)], float(round(0.01 * np.log(4.0), 5))
    ([0.00832, 0.00555], 0.01386)
    """

    wavenumber: FloatArray  #: Ascending wavenumbers of the table [rad m⁻¹, (m,)].
    saturation: FloatArray  #: Saturation ``B = k^3 S`` [1, (m,)].
    wind_to_azimuth: float = 0.0  #: Azimuth the wind blows TO [rad].
    to_azimuth: float | None = None  #: Azimuth the waves of the table travel TO on average [rad]; by default the wind's.
    delta: FloatArray | None = None  #: Ratio ``Delta`` [1, (m,)]; either this or the width.
    width: FloatArray | None = None  #: Circular width of the directions [rad, (m,)].
    longer: DirectionalSpectrum | None = None  #: Model of waves longer than those of the table; its own wind is where its waves travel TO.
    shorter: DirectionalSpectrum | None = None  #: Model of waves shorter than those of the table, likewise.

    def __post_init__(self) -> None:
        """Refuse tables that are no spectrum."""
        k, saturation = self.wavenumber, self.saturation
        if k.size < FEWEST or k.shape != saturation.shape:
            raise DataError(f"a spectrum of {k.size} wavenumbers is no table; give {FEWEST} or more, each with its value")
        if not (np.all(np.isfinite(k)) and k[0] > 0.0 and np.all(np.diff(k) > 0.0)):
            raise DataError("wavenumbers of a spectrum must be finite, above 0 rad/m and ascending; sort them, each once")
        if not np.all(np.isfinite(saturation)) or np.any(saturation < 0.0):
            raise DataError("values of a spectrum must be finite and not negative; leave out the wavenumbers without a value")
        if not np.any(saturation > 0.0):
            raise DataError("a spectrum must not be 0 everywhere; for a calm sea use the flat spectrum")
        if (self.delta is None) == (self.width is None):
            raise DomainError("directions of a spectrum are given by delta or by a width; give one of them", name="delta")
        if self.delta is not None and not np.all(np.abs(self.delta) <= 1.0):
            raise DomainError(
                "delta of a spectrum must lie within -1 to 1 [1]: beyond, a direction would have negative energy",
                name="delta",
                allowed=(-1.0, 1.0),
            )
        if self.width is not None:
            power_of_width(self.width)

    @property
    def _to(self) -> float:
        """Azimuth the waves of the table travel TO on average [rad]."""
        return self.wind_to_azimuth if self.to_azimuth is None else self.to_azimuth

    @property
    def peak_wavenumber(self) -> float:
        """Wavenumber with the most energy in the FREQUENCY spectrum, among the table's and the peaks of the models [rad m⁻¹]."""
        models = [model.peak_wavenumber for model in (self.longer, self.shorter) if model is not None]
        k = np.concatenate([self.wavenumber, models])
        return float(k[int(np.argmax(self.omnidirectional(k) / group_velocity(k)))])

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range of the table and of the models that continue it [rad m⁻¹]."""
        first, last = float(self.wavenumber[0]), float(self.wavenumber[-1])
        low = first if self.longer is None else min(first, self.longer.wavenumber_range[0])
        return low, last if self.shorter is None else max(last, self.shorter.wavenumber_range[1])

    def breakpoints(self) -> FloatArray:
        """Wavenumbers of the table, and break points of the models beyond it [rad m⁻¹]."""
        first, last = self.wavenumber[0], self.wavenumber[-1]
        parts = [self.wavenumber]
        if self.longer is not None:
            k = np.concatenate([self.longer.breakpoints(), self.longer.wavenumber_range])
            parts.append(k[k < first])
        if self.shorter is not None:
            k = np.concatenate([self.shorter.breakpoints(), self.shorter.wavenumber_range])
            parts.append(k[k > last])
        return np.unique(np.concatenate(parts))

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Omnidirectional spectrum ``S(k) = B/k^3``, and the models' beyond the table [m³]."""
        k = np.asarray(wavenumber, dtype=np.float64)
        first, last = self.wavenumber[0], self.wavenumber[-1]
        values = np.where((k >= first) & (k <= last), self._saturation(np.clip(k, first, last)) / k**3, 0.0)
        for model, outside in ((self.longer, k < first), (self.shorter, k > last)):
            if model is not None and np.any(outside):
                values = np.where(outside, model.omnidirectional(np.where(outside, k, 0.5 * sum(model.wavenumber_range))), values)
        return np.asarray(values)

    def _saturation(self, wavenumber: FloatArray) -> FloatArray:
        """Saturation within the table [1]."""
        x, nodes = np.log(wavenumber), np.log(self.wavenumber)
        linear = np.interp(x, nodes, self.saturation)
        positive = self.saturation > 0.0
        logarithm = np.interp(x, nodes, np.log(np.where(positive, self.saturation, 1.0)))
        left = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
        return np.asarray(np.where(positive[left] & positive[left + 1], np.exp(logarithm), linear))

    def _interpolated(self, values: FloatArray, wavenumber: ArrayLike) -> FloatArray:
        """Values of the table's directions, linear in log k [(...)]; beyond the table those of its ends."""
        return np.asarray(np.interp(np.log(np.asarray(wavenumber, dtype=np.float64)), np.log(self.wavenumber), values))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Directional distribution of the table, and of the models beyond it [rad⁻¹]."""
        angle = np.asarray(azimuth, dtype=np.float64) - self._to
        if self.delta is not None:
            table = downwind(angle) * (1.0 + self._interpolated(self.delta, wavenumber) * np.cos(2.0 * angle)) / np.pi
        else:
            assert self.width is not None
            table = cosine_power(angle, power_of_width(self._interpolated(self.width, wavenumber)))
        k = np.asarray(wavenumber, dtype=np.float64)
        for model, outside in ((self.longer, k < self.wavenumber[0]), (self.shorter, k > self.wavenumber[-1])):
            if model is not None and np.any(outside):
                table = np.where(outside, model.spreading(wavenumber, azimuth), table)
        return np.asarray(table)

    def _second(self, wavenumber: ArrayLike) -> FloatArray:
        """Mean of ``cos 2(phi - phi_0)`` of the table's distribution about its mean direction [1]."""
        if self.delta is not None:
            return np.asarray(0.5 * self._interpolated(self.delta, wavenumber))
        assert self.width is not None
        s = power_of_width(self._interpolated(self.width, wavenumber))
        return np.asarray(s * (s - 1.0) / ((s + 1.0) * (s + 2.0)))

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic along the wind [1]."""
        return self._harmonic(wavenumber).real

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic across the wind [1]."""
        return self._harmonic(wavenumber).imag

    def _harmonic(self, wavenumber: ArrayLike) -> NDArray[np.complex128]:
        """Mean of ``exp 2i(phi - phi_wind)`` [1]."""
        value = self._second(wavenumber) * np.exp(2j * (self._to - self.wind_to_azimuth))
        k = np.asarray(wavenumber, dtype=np.float64)
        for model, outside in ((self.longer, k < self.wavenumber[0]), (self.shorter, k > self.wavenumber[-1])):
            if model is not None and np.any(outside):
                # harmonics of a model are about its own wind
                turn = np.exp(2j * (model.wind_to_azimuth - self.wind_to_azimuth))
                value = np.where(outside, turn * (model.second_harmonic(k) + 1j * model.cross_harmonic(k)), value)
        return np.asarray(value, dtype=np.complex128)

    def joins(self) -> tuple[Join, Join]:
        """Joins at the first and the last wavenumber of the table."""
        return self._join(0, self.longer, True), self._join(-1, self.shorter, False)

    def _join(self, end: int, model: DirectionalSpectrum | None, longer: bool) -> Join:
        k = float(self.wavenumber[end])
        beyond = 0.0 if model is None else k**3 * float(model.omnidirectional(k))
        return Join(k, float(self.saturation[end]), beyond, longer)


def width_of_half(half_width: ArrayLike) -> FloatArray:
    """Circular width [rad] of the power of the cosine that falls to half its maximum at an angle [rad] from the mean direction.

    ``cos^2s(theta/2) = 1/2``, so ``s = -ln 2/[2 ln cos(theta/2)]``, and the width is ``sqrt(2/(s + 1))``.

    Examples
    --------
    >>> float(np.degrees(width_of_half(np.radians(60.0))).round(2))
    43.88
    """
    theta = np.asarray(half_width, dtype=np.float64)
    low, high = HALF_WIDTHS
    outside = ~((theta >= low) & (theta <= high))
    if np.any(outside):
        value = float(np.degrees(theta[outside].ravel()[0]))
        allowed = (float(np.degrees(low)), float(np.degrees(high)))
        raise DomainError(
            f"half width = {value:g} deg is outside {allowed[0]:g}-{allowed[1]:g} deg, the angles from the mean direction at which the "
            "cosine can fall to half its maximum; check the unit",
            name="half_width",
            value=value,
            allowed=allowed,
        )
    s = -np.log(2.0) / (2.0 * np.log(np.cos(0.5 * theta)))
    return np.asarray(np.sqrt(2.0 / (s + 1.0)))
