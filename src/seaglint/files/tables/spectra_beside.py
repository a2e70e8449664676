"""Spectra of one scene side by side, for a file of numbers and for a picture."""

from __future__ import annotations

from typing import NamedTuple

from seaglint.base.conventions import FloatArray


class SpectraBeside(NamedTuple):
    """Measured spectrum with ours beside it, by name."""

    #: ``title``, ``label``: Scene, and quantity with its unit.
    title: str
    label: str
    wavenumber_cm: FloatArray  #: Samples [cm-1, (n,)], ascending; a gap wider than 20 cm-1 separates parts.
    measured: FloatArray  #: Measured quantity [(n,)].
    ours: dict[str, FloatArray]  #: Computed quantity by name [(n,)].
    unit: str = "K"  #: Unit of their difference.
    reference: str = "measured"  #: Name of the measured quantity in a picture.

    def columns(self) -> dict[str, FloatArray]:
        """Return the numbers by column names."""
        return {"wavenumber_cm": self.wavenumber_cm, "measured": self.measured, **self.ours}
