"""Picture of spectra side by side: measured and computed on the left, their difference on the right."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.files.outputs import moved_when_whole
from seaglint.files.tables.spectra_beside import SpectraBeside
from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from seaglint.base.conventions import FloatArray

COLOURS: Final = ("#d95f02", "#1f78b4", "#33a02c")  #: Colours of the computed spectra, distinct for colour-blind readers and in print.

GAP_CM: Final = 100.0  #: Step from which two parts of a spectrum are not joined [cm-1].


def write_beside(spectra: Sequence[SpectraBeside], output: Path) -> Path:
    """Write the picture of some spectra, complete or not at all."""
    with moved_when_whole(output) as partial:
        draw_beside(spectra).savefig(partial, dpi=110, format=output.suffix.lstrip(".").lower())
    return output


def draw_beside(spectra: Sequence[SpectraBeside]) -> Figure:
    """Draw a row of two panels for each scene."""
    figure = new_figure(12.0, 0.6 + 2.6 * len(spectra))
    panels = figure.subplots(len(spectra), 2, squeeze=False, width_ratios=(1.5, 1.0))
    for (left, right), scene in zip(panels, spectra, strict=True):
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
    """Points of a line with gaps where samples are missing."""
    at = np.flatnonzero(np.diff(wavenumber_cm) > GAP_CM) + 1
    return np.insert(x, at, np.nan), np.insert(y, at, np.nan)
