"""Pictures of a sensor (MTF with its parts, noise budget) and of two spectra: measured and computed, with their difference."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.formats.tables.spectra import SpectraBeside
from seaglint.instrument.data_sheet import SensorDataSheet
from seaglint.plot.figures_and_pages import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from seaglint.base.conventions import FloatArray


SIZE = (11.0, 4.2)  #: Width and height [in].


def write_sensor_plot(sheet: SensorDataSheet, path: Path) -> None:
    """Draw the figures of merit of a sensor into a picture file."""
    save_figure(draw_sensor(sheet), path, 120)


def draw_sensor(sheet: SensorDataSheet) -> Figure:
    """Draw MTF and noise budget of a sensor."""
    figure = new_figure(*SIZE)
    left, right = figure.subplots(1, 2)
    mtf = sheet.mtf
    frequency = mtf.frequency_cycles_per_mrad
    for name, part in mtf.parts["along"].items():
        left.plot(frequency, part, linewidth=0.9, linestyle="--", label=name)
    left.plot(frequency, mtf.along, color="black", linewidth=1.8, label="along rows")
    # Equal curves are drawn once.
    if mtf.along != mtf.across:
        left.plot(frequency, mtf.across, color="0.5", linewidth=1.8, label="across rows")
    left.axvline(mtf.nyquist_cycles_per_mrad, color="0.6", linewidth=0.8)
    left.annotate("Nyquist", (mtf.nyquist_cycles_per_mrad, 0.96), fontsize=8, color="0.4")
    left.set(xlabel="frequency [cycles/mrad]", ylabel="MTF", ylim=(min(-0.05, min(mtf.along)), 1.02), xlim=(0, frequency[-1]))
    left.legend(fontsize=8, frameon=False)
    noise = {name: value for name, value in sheet.noise_budget.noise.items() if value}
    right.barh([name.replace("_", " ") for name in noise], list(noise.values()), color="0.45")
    right.invert_yaxis()
    right.set(xlabel=f"noise [{sheet.unit} rms] at the scene's mean, {sheet.noise_budget.scene_radiance:.3g} W m⁻² sr⁻¹")
    for place, value in enumerate(noise.values()):
        right.text(value, place, f" {value:.3g}", va="center", fontsize=8)
    right.margins(x=0.15)
    right.set_title(f"NETD {1e3 * sheet.netd_k:.3g} mK at {sheet.background_k:g} K", fontsize=10)
    return figure


COLOURS: Final = ("#d95f02", "#1f78b4", "#33a02c")  #: Colours of the computed spectra, distinct for colour-blind readers and in print.

GAP_CM: Final = 100.0  #: Step from which two parts of a spectrum are not joined [cm-1].


def write_beside(spectra: Sequence[SpectraBeside], output: Path) -> Path:
    """Write the picture of spectra, complete or not at all."""
    return save_figure(draw_beside(spectra), output, 110)


def draw_beside(spectra: Sequence[SpectraBeside]) -> Figure:
    """Draw a row of two panels for each scene."""
    figure = new_figure(12.0, 0.6 + 2.6 * len(spectra))
    for (left, right), scene in zip(figure.subplots(len(spectra), 2, squeeze=False, width_ratios=(1.5, 1.0)), spectra, strict=True):
        micrometres = 1e4 / scene.wavenumber_cm
        left.plot(*_parted(scene.wavenumber_cm, micrometres, scene.measured), color="k", linewidth=1.6, label=scene.reference)
        for colour, (name, ours) in zip(COLOURS, scene.ours.items(), strict=False):
            left.plot(*_parted(scene.wavenumber_cm, micrometres, ours), color=colour, linewidth=1.0, label=name)
            right.plot(*_parted(scene.wavenumber_cm, micrometres, ours - scene.measured), color=colour, linewidth=1.0, label=name)
        right.axhline(0.0, color="0.5", linewidth=0.8)
        left.set_title(scene.title, fontsize=10, loc="left")
        left.set_ylabel(scene.label)
        right.set_ylabel(f"ours − {scene.reference} [{scene.unit}]")
        left.legend(fontsize=8)
        for axes in (left, right):
            axes.grid(alpha=0.3)
            axes.set_xlabel("wavelength [µm]")
    return figure


def _parted(wavenumber_cm: FloatArray, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the points of a line, with gaps where samples are missing."""
    # Matplotlib interrupts a line at a value that is no number.
    at = np.flatnonzero(np.diff(wavenumber_cm) > GAP_CM) + 1
    return np.insert(x, at, np.nan), np.insert(y, at, np.nan)
