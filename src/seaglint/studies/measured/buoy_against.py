"""Waves that a buoy's displacements show, beside those that the program makes of the buoy's own spectrum."""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.files.waves.bands import DirectionalMoments, spectrum_of
from seaglint.files.waves.record_choice import WaveChoice
from seaglint.sea.dispersion import wavenumber
from seaglint.sea.field import WaveField
from seaglint.sea.spectra.measured import MeasuredSpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.studies.measured.measured_row import MeasuredRow
from seaglint.studies.measured.shipped import shipped

TITLE: Final = "CDIP buoy 067, San Nicolas Island 2022"

_AZIMUTHS: Final = 360

_STEPS: Final = 64  #: Wavenumbers of a band over which directions are averaged.

_ENERGY: Final = "Waves are drawn from the buoy's spectrum, with other frequency bands than the displacements."
_DIRECTION: Final = "Displacements are along magnetic axes; 11.7 deg of declination is added."
_SLOPE: Final = "Only waves up to 0.58 Hz are included; glint depends on shorter waves, which a buoy does not measure."


def buoy_spectrum() -> MeasuredSpectrum:
    """Return the spectrum that the program makes of the buoy's energy and four moments."""
    held = shipped("cdip_spectrum").columns
    first = -(held["a1"] + 1j * held["b1"])  # directions come from there, waves travel to the other side
    second = held["a2"] + 1j * held["b2"]
    bands = DirectionalMoments(held["frequency_hz"], held["energy_m2_hz"], first, second)
    return spectrum_of(bands, WaveChoice(), 0.0, TITLE)[0]


def buoy_rows() -> list[MeasuredRow]:
    """Return rows of height, slopes, and of energy and direction in bands of frequency."""
    spectrum, bands = buoy_spectrum(), shipped("cdip_bands").columns
    total, error = float(bands["energy_m2"].sum()), float(np.sqrt(np.sum(bands["energy_error_m2"] ** 2)))
    height = 4.0 * np.sqrt(total)
    field = WaveField.create(spectrum, plan_tiles(spectrum, 1.0, 256), 0)
    spread = 0.5 * height * error / total
    rows = [_row("significant height", "m", field.significant_height, height, f"{spread:.2f} m", _ENERGY)]
    k_low, k_high = (float(wavenumber(2.0 * np.pi * f)) for f in (bands["low_hz"][0], bands["high_hz"][-1]))
    slopes = float(sum(spectrum.mss(k_high, k_low)))
    rows.append(_row("slope variance below 0.58 Hz", "1", slopes, float(bands["slope_variance"].sum()), "", _SLOPE))
    for i in range(bands["low_hz"].size):
        low, high = float(bands["low_hz"][i]), float(bands["high_hz"][i])
        k = [float(wavenumber(2.0 * np.pi * f)) for f in (low, high)]
        energy, theirs = spectrum.height_variance(k[1], k[0]), float(bands["energy_m2"][i])
        said = f"{100.0 * bands['energy_error_m2'][i] / theirs:.0f} %"
        rows.append(_row(f"energy, {low:g}-{high:g} Hz", "m2", energy, theirs, said, _ENERGY))
    for i in range(bands["low_hz"].size):
        low, high = float(bands["low_hz"][i]), float(bands["high_hz"][i])
        ours, theirs = _mean_direction(spectrum, low, high), float(bands["from_deg"][i])
        ours = theirs + (ours - theirs + 180.0) % 360.0 - 180.0
        rows.append(_row(f"direction, {low:g}-{high:g} Hz", "deg", ours, theirs, "2 deg (compass)", _DIRECTION))
    return rows


def _row(quantity: str, unit: str, ours: float, measured: float, uncertainty: str, reason: str) -> MeasuredRow:
    percent = float("nan") if unit == "deg" else 100.0 * (ours / measured - 1.0)
    return MeasuredRow(
        case=TITLE,
        quantity=quantity,
        spectroscopy="",
        unit=unit,
        ours=float(ours),
        measured=float(measured),
        difference_percent=percent,
        uncertainty=uncertainty,
        reason=reason,
    )


def _mean_direction(spectrum: MeasuredSpectrum, low: float, high: float) -> float:
    """Mean direction that the waves of a band [Hz] come from [deg], of the spectrum's own distribution over azimuth."""
    k = np.linspace(float(wavenumber(2.0 * np.pi * low)), float(wavenumber(2.0 * np.pi * high)), _STEPS)
    azimuth = 2.0 * np.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
    moment = spectrum.spreading(k[:, None], azimuth) @ np.exp(1j * azimuth)
    return float(np.degrees(np.angle(-np.sum(spectrum.omnidirectional(k) * moment))) % 360.0)
