"""Photon detectors: from in-band radiance on the focal plane to electrons and counts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

MOST_BITS: Final = 16  #: Largest bit depth of the signal.

#: Blackbody temperature that fills the converter without a given well or gain [K]: hotter than any sea, cooler than a mirrored Sun.
FULL_SCALE_TEMPERATURE: Final = 400.0


class Pixels:
    """Common interface of the pixels of all detectors: a pitch [m], a fill factor and a bit depth."""

    pitch: float
    fill_factor: float
    bit_depth: int

    def require_bits(self) -> None:
        """Raise for a bit depth outside 1 to ``MOST_BITS``."""
        if not 1 <= self.bit_depth <= MOST_BITS:
            raise DomainError(
                f"bit depth = {self.bit_depth} is not one of a signal of 16 bits; give 1 to {MOST_BITS}",
                name="bit_depth",
                value=self.bit_depth,
                allowed=(1, MOST_BITS),
            )

    @property
    def active_width(self) -> float:
        """Side of the sensitive square [m]."""
        return self.pitch * math.sqrt(self.fill_factor)

    @property
    def active_area(self) -> float:
        """Area of the sensitive square [m2]."""
        return self.pitch**2 * self.fill_factor

    @property
    def top_count(self) -> int:
        """Largest count."""
        return (1 << self.bit_depth) - 1


@dataclass(frozen=True)
class PhotonPixels(Pixels):
    """Pixels of a photon detector."""

    pitch: float  #: Distance of the pixels' centres [m].
    fill_factor: float = 1.0  #: Share of a pixel's area that is sensitive, a square in its middle [1].
    integration_time: float = 0.01  #: Integration time [s].
    quantum_efficiency: float = 1.0  #: Electrons for each photon, where the response of the efficiency's curve is 1 [1].
    well_capacity: float | None = None  #: Largest number of electrons in a pixel; None without saturation.
    read_noise: float = 0.0  #: Rms noise of a reading [electrons].
    dark_current: float = 0.0  #: Dark current [electrons s-1].
    bit_depth: int = MOST_BITS  #: Bit depth of the converter.
    gain: float | None = None  #: Electrons for each count; None: a full well, or the electrons of a hot blackbody, fill the converter.
    offset: float = 0.0  #: Counts without electrons.
    crosstalk: float = 0.0  #: Share of a pixel's electrons that its four neighbours collect [1].
    short_integration_time: float | None = None  #: Second, shorter integration time, used where the long integration saturates [s].

    def __post_init__(self) -> None:
        self.require_bits()
        if self.well_capacity is not None and self.well_capacity <= self.read_noise:
            raise DomainError(
                f"well capacity = {self.well_capacity:g} electrons is not above the read noise of {self.read_noise:g}; correct one of them",
                name="well_capacity",
                value=self.well_capacity,
                allowed=f"above {self.read_noise:g}",
            )
        if self.short_integration_time is not None and not 0.0 < self.short_integration_time < self.integration_time:
            raise DomainError(
                f"short integration time = {self.short_integration_time:g} s is not below the long one of {self.integration_time:g} s; "
                "shorten it",
                name="short_integration_time",
                value=self.short_integration_time,
                allowed=f"0 to {self.integration_time:g} s",
            )

    @property
    def range_factor(self) -> float:
        """Factor by which the second integration time widens the range of electrons."""
        return 1.0 if self.short_integration_time is None else self.integration_time / self.short_integration_time


@dataclass(frozen=True)
class Readout:
    """Straight line from radiance to counts, for photon and thermal detectors.

    ``units`` are electrons of a photon detector, nanowatts absorbed by a thermal one.
    """

    per_radiance: float  #: Units for each unit of in-band radiance at the aperture [units (W m-2 sr-1)-1].
    background: float  #: Units without a scene: dark current, warm optics and housing.
    dark: float  #: Units of dark current, a part of ``background``.
    # capacity and full scale differ: the converter may end before the well
    capacity: float  #: Units at which a pixel saturates; infinite without saturation.
    gain: float  #: Units for each count.
    offset: float  #: Counts without units.
    top_count: int  #: Largest count.

    def __post_init__(self) -> None:
        if not 0.0 <= self.offset < self.top_count:
            raise DomainError(
                f"offset = {self.offset:g} counts leaves nothing of {self.top_count} counts; give a lower offset or more bits",
                name="offset",
                value=self.offset,
                allowed=f"0 to below {self.top_count}",
            )

    @property
    def full_scale(self) -> float:
        """Largest signal of the pixel or of the converter [units]."""
        return min(self.capacity, (self.top_count - self.offset) * self.gain)

    def units(self, radiance: ArrayLike) -> FloatArray:
        """Return the mean signal of radiances at the aperture [W m-2 sr-1], without limits [units]."""
        return self.per_radiance * np.asarray(radiance, np.float64) + self.background

    def counts(self, units: ArrayLike) -> FloatArray:
        """Return the counts of a signal [units], whole numbers as floats, within the converter's range."""
        raw = np.rint(np.asarray(units, np.float64) / self.gain + self.offset)
        return np.clip(raw, 0.0, float(self.top_count))

    @property
    def radiance_scale(self) -> float:
        """Radiance of a count [W m-2 sr-1]."""
        return self.gain / self.per_radiance

    @property
    def radiance_offset(self) -> float:
        """Radiance of zero counts [W m-2 sr-1]; negative with a background."""
        return -(self.offset * self.gain + self.background) / self.per_radiance

    def radiance(self, counts: ArrayLike) -> FloatArray:
        """Return the radiance at the aperture from counts [W m-2 sr-1]."""
        return np.asarray(counts, np.float64) * self.radiance_scale + self.radiance_offset


def square_mtf(frequency: ArrayLike, width: float) -> FloatArray:
    """Return the transfer of a detector of an angular width w [rad], at frequencies f across it [cycles rad-1].

    ``MTF = sin(pi f w) / (pi f w)``
    """
    return np.asarray(np.sinc(np.asarray(frequency, np.float64) * width))


def crosstalk_mtf(along: ArrayLike, across: ArrayLike, share: float, step: float) -> FloatArray:
    """Return the transfer of pixels a ``step`` s [rad] apart that lose a share c to their four neighbours [1].

    ``MTF = 1 - c + c/2 [cos(2 pi x s) + cos(2 pi y s)]`` at frequencies x along and y across [cycles rad-1].
    """
    x, y = np.asarray(along, np.float64), np.asarray(across, np.float64)
    return np.asarray(1.0 - share + 0.5 * share * (np.cos(2.0 * np.pi * x * step) + np.cos(2.0 * np.pi * y * step)))
