"""Spectra of one scene side by side, for a file of numbers and for a picture."""

from __future__ import annotations

from typing import NamedTuple

from seaglint.base.conventions import FloatArray


class SpectraBeside(NamedTuple):
    """Measured spectrum with ours beside it, by name.

    Attributes
    ----------
    title, label : str
        Scene, and quantity with its unit.
    wavenumber_cm : ndarray
        Samples [cm-1, (n,)], ascending; a gap wider than 20 cm-1 separates parts.
    measured : ndarray
        Measured quantity [(n,)].
    ours : dict
        Computed quantity by name [(n,)].
    unit : str
        Unit of their difference.
    reference : str
        Name of the measured quantity in a picture.
    """

    title: str
    label: str
    wavenumber_cm: FloatArray
    measured: FloatArray
    ours: dict[str, FloatArray]
    unit: str = "K"
    reference: str = "measured"

    def columns(self) -> dict[str, FloatArray]:
        """Return the numbers by column names."""
        return {"wavenumber_cm": self.wavenumber_cm, "measured": self.measured, **self.ours}
