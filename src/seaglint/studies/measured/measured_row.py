"""A measured number beside ours."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.free_form import JsonObject
from seaglint.optics.band import Band, apparent_temperature


@dataclass(frozen=True, kw_only=True)
class MeasuredRow:
    """Measured number, or that of another model, beside ours."""

    #: ``case``, ``quantity``: What was measured, and the band or property.
    case: str
    quantity: str
    spectroscopy: str  #: Absorption of ours; empty for waves.
    unit: str  #: Unit of both numbers.
    #: ``ours``, ``measured``: Both numbers.
    ours: float
    measured: float
    difference_percent: float  #: Ours less measured, of band radiance where the unit is K [%].
    difference_k: float | None = None  #: The same as temperatures [K]; None where there are none.
    #: Root of the mean square difference over 20 cm-1 channels [K], or over paths or skies [unit]; None for single numbers.
    rms: float | None = None
    uncertainty: str = ""  #: Uncertainty of the measurement.
    reason: str = ""  #: A sentence on what is left.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; None for numbers that do not exist."""
        return {name: None if isinstance(value, float) and np.isnan(value) else value for name, value in asdict(self).items()}


@dataclass(frozen=True)
class BandDifference:
    """Two spectra in a band: apparent temperatures, difference of radiance, and of the channels."""

    #: ``ours``, ``measured``: Apparent temperatures [K]; NaN for a band that has no light.
    ours: float
    measured: float
    percent: float  #: Difference of band radiance, ours less measured [%].
    rms: float  #: Root of the mean square difference of brightness temperature over the samples in the band [K].

    @property
    def kelvin(self) -> float:
        """Difference of the temperatures [K]."""
        return self.ours - self.measured


def band_difference(
    wavenumber_cm: FloatArray, ours: FloatArray, measured: FloatArray, band_um: tuple[float, float], kelvin: tuple[FloatArray, FloatArray]
) -> BandDifference:
    """Compare two spectra [W m-2 sr-1 per cm-1, (n,)], whose temperatures are ``kelvin`` [K], over wavelengths [um]."""
    band = Band.rectangular(*band_um)
    weights = band.weights(wavenumber_cm)
    light = np.array([ours @ weights, measured @ weights])
    temperatures = apparent_temperature(light, band, wavenumber_cm)
    inside = weights > 0.0
    rms = float(np.sqrt(np.nanmean((kelvin[0] - kelvin[1])[inside] ** 2))) if inside.any() else float("nan")
    percent = float(100.0 * (light[0] / light[1] - 1.0)) if light[1] > 0.0 else float("nan")
    return BandDifference(float(temperatures[0]), float(temperatures[1]), percent, rms)
