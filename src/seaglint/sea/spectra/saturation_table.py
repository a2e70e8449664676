"""Tables of the saturation at one wind or several, and the spectrum at any wind between them.

At a wind of the table the spectrum is the table's. Between two winds it is their mean, each joined to a model at its own wind and over its
own range, weighted linearly in the wind: continuous in the wind, and exact at the winds of the table. A table without winds holds for any.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.sea.spectra.combined import CalmSpectrum, CombinedSpectrum, wind_sea
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import VALID_WIND, ElfouhailySpectrum
from seaglint.sea.spectra.saturation import FEWEST, SaturationSpectrum, width_of_half

Continued = Literal["elfouhaily", "cut"]  #: Waves beyond a table: those of Elfouhaily's spectrum, or none.

#: Least last wavenumber of a table whose shorter waves are cut [rad m⁻¹]: 31 cm.
#:
#: Longer waves carry less than half of the slope variance (Elfouhaily at 10 m/s: 0.6 of it at 20 rad/m, 0.3 at 1 rad/m): without shorter
#: ones the sea would be too smooth.
LEAST_LAST: Final = 20.0

_SAME_WIND: Final = 1e-6  # share by which a wind may differ from the table's by rounding


@dataclass(frozen=True, eq=False)
class SaturationRow:
    """Saturation against wavenumber at one wind."""

    wavenumber: FloatArray  #: Ascending wavenumbers [rad m⁻¹, (m,)].
    saturation: FloatArray  #: Saturation ``B = k^3 S`` [1, (m,)].
    wind: float | None = None  #: Neutral wind at 10 m [m s⁻¹]; None where the table has no winds.
    delta: FloatArray | None = None  #: Ratio ``Delta`` of Elfouhaily et al. 1997, Eq. 49 [1, (m,)].
    half_width: FloatArray | None = None  #: Angle from the mean direction at which the distribution is half its maximum [rad, (m,)].

    @property
    def slope_variance(self) -> float:
        """Slope variance within the table, ``int B dlnk`` by the trapezoidal rule [1]."""
        return float(np.trapezoid(self.saturation, np.log(self.wavenumber)))


@dataclass(frozen=True, eq=False)
class SaturationTable:
    """Rows of the saturation by ascending wind, or one without a wind.

    Raises
    ------
    DataError
        No rows, rows of one wind, or several rows of which one has no wind.
    """

    rows: tuple[SaturationRow, ...]  #: By ascending wind.
    name: str = "the table"  #: For messages.

    def __post_init__(self) -> None:
        """Refuse rows that have no order by wind."""
        if not self.rows:
            raise DataError(f"{self.name} has no spectrum; give {FEWEST} wavenumbers or more")
        winds = [row.wind for row in self.rows if row.wind is not None]
        if len(self.rows) > 1 and (len(winds) < len(self.rows) or np.any(np.diff(winds) <= 0.0)):
            raise DataError(f"{self.name} has spectra that are not in the order of their winds; give each wind once, ascending")

    @property
    def winds(self) -> FloatArray:
        """Winds of the rows [m s⁻¹, (n,)]; empty for a table that holds for any wind."""
        return np.array([row.wind for row in self.rows if row.wind is not None])

    @property
    def has_directions(self) -> bool:
        """True where the table states directions."""
        return self.rows[0].delta is not None or self.rows[0].half_width is not None

    def shares(self, wind: float) -> tuple[tuple[float, SaturationRow], ...]:
        """Rows that make up the spectrum at a wind [m s⁻¹], and their weights [1].

        Raises
        ------
        DomainError
            A wind outside those of the table.
        """
        winds = self.winds
        if winds.size == 0:
            return ((1.0, self.rows[0]),)
        low, high = float(winds[0]), float(winds[-1])
        if not low * (1.0 - _SAME_WIND) <= wind <= high * (1.0 + _SAME_WIND):
            one = winds.size == 1
            raise DomainError(
                f"a wind of {wind:g} m/s is outside the {f'{low:g} m/s' if one else f'{low:g} to {high:g} m/s'} of {self.name}; "
                + ("set that wind, or leave the wind out of the file to use it at any" if one else "choose a wind inside it"),
                name="wind_speed",
                value=wind,
                allowed=(low, high),
            )
        nearest = int(np.argmin(np.abs(winds - wind)))
        if abs(winds[nearest] - wind) <= _SAME_WIND * wind:
            return ((1.0, self.rows[nearest]),)
        upper = int(np.searchsorted(winds, wind))
        share = float((wind - winds[upper - 1]) / (winds[upper] - winds[upper - 1]))
        return (1.0 - share, self.rows[upper - 1]), (share, self.rows[upper])

    def parts(
        self,
        wind: float,
        wind_to_azimuth: float = 0.0,
        *,
        to_azimuth: float | None = None,
        width: float | None = None,
        longer: Continued = "elfouhaily",
        shorter: Continued = "cut",
    ) -> tuple[tuple[float, SaturationSpectrum], ...]:
        """Spectra of the rows that make up the sea at a wind, and their weights [1]; arguments as of ``at``."""
        if width is not None and self.has_directions:
            raise DomainError(
                f"does not go with {self.name}, which has directions (delta, half_width_deg); leave it out",
                name="spreading_deg",
                value=width,
            )
        to = wind_to_azimuth if to_azimuth is None else to_azimuth
        parts = []
        for share, row in self.shares(wind):
            last = float(row.wavenumber[-1])
            if shorter == "cut" and last < LEAST_LAST:
                raise DomainError(
                    f'= "cut" leaves no waves beyond {last:g} rad/m, the last of {self.name}: shorter ones carry most of the slopes '
                    f'and all sparkle; set shorter_waves = "elfouhaily", or give a spectrum that reaches {LEAST_LAST:g} rad/m or more',
                    name="shorter_waves",
                    value=shorter,
                    allowed="elfouhaily",
                )
            speed = wind if row.wind is None else row.wind
            given = self.has_directions or width is not None
            # a table with directions and both ends cut holds at winds outside the model's too
            model = elfouhaily_or_calm(speed, to) if not given or "elfouhaily" in (longer, shorter) else None
            # without wind the directions of the lightest
            like = None if given else 2.0 * (model or ElfouhailySpectrum(VALID_WIND[0], to)).second_harmonic(row.wavenumber)
            wide = None if row.half_width is None else width_of_half(row.half_width)
            parts.append(
                (
                    share,
                    SaturationSpectrum(
                        row.wavenumber,
                        row.saturation,
                        wind_to_azimuth,
                        to,
                        delta=like if row.delta is None else row.delta,
                        width=wide if width is None else np.full(row.wavenumber.size, width),
                        longer=model if longer == "elfouhaily" else None,
                        shorter=model if shorter == "elfouhaily" else None,
                    ),
                )
            )
        return tuple(parts)

    def at(
        self,
        wind: float,
        wind_to_azimuth: float = 0.0,
        *,
        to_azimuth: float | None = None,
        width: float | None = None,
        longer: Continued = "elfouhaily",
        shorter: Continued = "cut",
    ) -> DirectionalSpectrum:
        """Spectrum at a wind.

        Parameters
        ----------
        wind : float
            Neutral wind at 10 m [m s⁻¹].
        wind_to_azimuth : float
            Azimuth the wind blows TO [rad].
        to_azimuth : float, optional
            Azimuth the waves travel TO on average, those of the models too [rad]; by default the wind's.
        width : float, optional
            Circular width of the directions [rad], for a table without; by default those of Elfouhaily's spectrum.
        longer, shorter : "elfouhaily" or "cut"
            Waves beyond the table: those of Elfouhaily's spectrum at the row's wind, or none.

        Returns
        -------
        DirectionalSpectrum

        Raises
        ------
        DomainError
            A wind outside the table, a width for a table with directions, or a table cut where most slopes are still missing.
        """
        parts = self.parts(wind, wind_to_azimuth, to_azimuth=to_azimuth, width=width, longer=longer, shorter=shorter)
        return mixed(parts)


def mixed(parts: tuple[tuple[float, SaturationSpectrum], ...]) -> DirectionalSpectrum:
    """Mean of spectra with their weights [1]."""
    if len(parts) == 1:
        return parts[0][1]
    return CombinedSpectrum(tuple(CalmSpectrum(spectrum, share) for share, spectrum in parts))


def elfouhaily_or_calm(wind: float, to_azimuth: float) -> DirectionalSpectrum | None:
    """Elfouhaily's sea of a wind [m s⁻¹]; below its lightest wind with less energy, None without wind."""
    return None if wind == 0.0 else wind_sea(lambda speed: ElfouhailySpectrum(speed, to_azimuth), wind)
