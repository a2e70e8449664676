"""Wave data of one place and time in the kinds that files have, and their conversion to a spectrum.

Directions here are where waves come FROM, in degrees clockwise from north, as CF and wavespectra have them; they are turned to where
waves travel TO in one place, :func:`spectrum_of`. Only moments are complex numbers about the azimuth TO.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.files.waves.record_choice import WaveChoice
from seaglint.sea.spectra.binned import of_bins, of_cosine
from seaglint.sea.spectra.measured import MeasuredSpectrum, possible_moments

ComplexArray = NDArray[np.complex128]

LOST_SHARE = 0.1  #: Largest share of energy in bands without directions [1]; those bands take the directions of their neighbours.


@dataclass(frozen=True, eq=False)
class Plain:
    """Wave data with energy alone: ``frequency_hz`` [Hz, (m,)] and ``energy`` [m² Hz⁻¹, (m,)]."""

    frequency_hz: FloatArray
    energy: FloatArray


@dataclass(frozen=True, eq=False)
class DirectionalMoments(Plain):
    """Wave data with the first two moments of the azimuth TO, ``int D exp(i n phi) dphi`` [1, (m,)]; NaN where unknown."""

    first: ComplexArray
    second: ComplexArray


@dataclass(frozen=True, eq=False)
class Cosine(Plain):
    """Wave data with mean direction FROM and circular width of the directions [deg, (m,)]."""

    from_deg: FloatArray
    width_deg: FloatArray


@dataclass(frozen=True, eq=False)
class Bins:
    """Wave data as densities over frequency [Hz, (m,)] and direction FROM [deg, (n,)]: ``density`` [m² Hz⁻¹ deg⁻¹, (m, n)]."""

    frequency_hz: FloatArray
    from_deg: FloatArray
    density: FloatArray


Bands = Plain | DirectionalMoments | Cosine | Bins


def spectrum_of(bands: Bands, choice: WaveChoice, wind_to_azimuth: float, what: str) -> tuple[MeasuredSpectrum, str]:
    """Return the spectrum of wave data, and the source of its directions in words.

    Raises
    ------
    DomainError
        ``from_deg`` or ``spreading_deg`` missing for energy alone, or given where the file has directions.
    DataError
        Values that are missing, negative or impossible; energy without directions; no energy at all.
    """
    bands = _ordered(bands)
    if not isinstance(bands, Bins):
        _require_energy(bands, what)
    if type(bands) is not Plain and (choice.from_deg is not None or choice.spreading_deg is not None):
        name = "from_deg" if choice.from_deg is not None else "spreading_deg"
        raise DomainError(f"does not go with {what}, which has directions of its own; leave it out", name=name, value=getattr(choice, name))
    try:
        match bands:
            case Bins():
                degree = np.pi / 180.0
                spectrum: MeasuredSpectrum = of_bins(
                    bands.frequency_hz, (bands.from_deg + 180.0) * degree, bands.density / degree, wind_to_azimuth
                )
                return spectrum, f"{bands.from_deg.size} directions of the file"
            case DirectionalMoments():
                first, second = _everywhere(bands, what)
                return MeasuredSpectrum(bands.frequency_hz, bands.energy, *possible_moments(first, second), wind_to_azimuth), (
                    "two moments of the file, maximum entropy"
                )
            case Cosine():
                to = np.radians(bands.from_deg + 180.0)
                return of_cosine(bands.frequency_hz, bands.energy, to, np.radians(bands.width_deg), wind_to_azimuth), (
                    "mean direction and width of the file, cosine to a power"
                )
            case Plain():
                return _stated(bands, choice, wind_to_azimuth, what)
            case other:
                assert_never(other)
    except DataError as error:
        raise DataError(f"{what}: {error}") from error


def _stated(bands: Plain, choice: WaveChoice, wind_to_azimuth: float, what: str) -> tuple[MeasuredSpectrum, str]:
    """Return energy with directions that the user states."""
    for name, value, hint in (
        ("from_deg", choice.from_deg, "the azimuth the waves come from"),
        ("spreading_deg", choice.spreading_deg, "the width of their directions (wind sea about 30, swell 10 to 20)"),
    ):
        if value is None:
            raise DomainError(f"is missing: {what} has no directions; give {hint}", name=name, allowed=hint)
    assert choice.from_deg is not None
    assert choice.spreading_deg is not None
    to, width = np.radians(choice.from_deg + 180.0), np.radians(choice.spreading_deg)
    return of_cosine(bands.frequency_hz, bands.energy, to, width, wind_to_azimuth), "as stated: the file has none"


def _ordered(bands: Bands) -> Bands:
    """Return bands by ascending frequency; a band at 0 Hz is no wave."""
    order = np.argsort(bands.frequency_hz)
    order = order[bands.frequency_hz[order] > 0.0]
    if isinstance(bands, Bins):
        return Bins(bands.frequency_hz[order], bands.from_deg, bands.density[order])
    return replace(bands, **{name: values[order] for name, values in vars(bands).items()})


def _require_energy(bands: Plain, what: str) -> None:
    if not np.all(np.isfinite(bands.energy)):
        raise DataError(f"{what} has missing energy; choose another time or place")


def _everywhere(bands: DirectionalMoments, what: str) -> tuple[ComplexArray, ComplexArray]:
    """Return moments of every band, interpolated where they are not known."""
    frequency, energy = bands.frequency_hz, bands.energy
    known = np.isfinite(bands.first) & np.isfinite(bands.second)
    share = np.where(known, 0.0, energy) @ np.gradient(frequency) / max(float(energy @ np.gradient(frequency)), 1e-300)
    if share > LOST_SHARE or not np.any(known):
        raise DataError(f"lacks directions for {100 * share:.0f} % of its energy ({100 * LOST_SHARE:.0f} % allowed); choose another time")
    first, second = (np.interp(frequency, frequency[known], c[known]) for c in (bands.first, bands.second))
    return first, second
