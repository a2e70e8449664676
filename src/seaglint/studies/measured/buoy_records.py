"""Skewness, kurtosis and the largest crest of a buoy's record, beside records that are drawn from its spectrum.

Records are drawn linear and to second order (``seaglint.sea.wave_record``), of the length and interval of the buoy's: at a place fixed in
space, and of a buoy that moves with the water and records no waves below its lowest frequency.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.sea.second_order import bound_limit
from seaglint.sea.spectra.measured import MeasuredSpectrum
from seaglint.sea.wave_record import WaveRecord
from seaglint.studies.measured.measured_numbers import MeasuredRow, shipped

SAMPLES: Final = 9216  #: Heights of the record.

RATE_HZ: Final = 1.28  #: Their rate.

RECORDS: Final = 12  #: Records that are drawn: the error of their mean is less than a third of one record's.

HERTZ: Final = (1.0 / 30.0, 0.58)  #: Frequencies that the buoy records: Datawell's filter passes periods below 30 s.


class RecordStatistics(NamedTuple):
    """Statistics of a record of heights."""

    significant_height: float  #: Four standard deviations [m].
    skewness: float  #: Third moment over the cube of the standard deviation [1].
    excess_kurtosis: float  #: Fourth moment over the square of the variance, less 3 [1].
    crest: float  #: Greatest height above the mean over the significant height [1].

    @classmethod
    def of(cls, heights: FloatArray) -> RecordStatistics:
        """Return the statistics of heights [m, (n,)].

        Examples
        --------
        >>> RecordStatistics.of(np.array([-1.0, 1.0, -1.0, 1.0]))
        RecordStatistics(significant_height=4.0, skewness=0.0, excess_kurtosis=-2.0, crest=0.25)
        """
        z = heights - heights.mean()
        variance = float(np.mean(z**2))
        height = 4.0 * variance**0.5
        return cls(height, float(np.mean(z**3)) / variance**1.5, float(np.mean(z**4)) / variance**2 - 3.0, float(z.max()) / height)


KINDS: Final = {
    "linear": "linear",
    "second_order": "second order, fixed place",
    "buoy": "second order, buoy",
}  #: Records that are drawn, and their words in rows.


def drawn_statistics(spectrum: MeasuredSpectrum, records: int = RECORDS) -> dict[str, FloatArray]:
    """Return the statistics of drawn records by kind (``KINDS``), each (records, 4)."""
    bound = bound_limit(spectrum)
    drawn = [WaveRecord.draw(spectrum, seed, SAMPLES, 1.0 / RATE_HZ, hertz=HERTZ, bound=bound) for seed in range(records)]
    return {kind: np.array([RecordStatistics.of(getattr(record, kind)) for record in drawn]) for kind in KINDS}


def record_rows(spectrum: MeasuredSpectrum, case: str) -> list[MeasuredRow]:
    """Return rows of skewness, excess kurtosis and largest crest of the record and of drawn ones."""
    table = {name: float(values[0]) for name, values in shipped("cdip_record").columns.items()}
    drawn = drawn_statistics(spectrum)
    rows = []
    for i, (name, words) in enumerate(
        (("skewness", "skewness"), ("excess_kurtosis", "excess kurtosis"), ("crest", "largest crest over Hs")), 1
    ):
        measured = table[name]
        for kind, title in KINDS.items():
            values = drawn[kind][:, i]
            ours, spread = float(values.mean()), float(values.std(ddof=1))
            rows.append(
                MeasuredRow(
                    case=case,
                    quantity=f"{words}, {title}",
                    spectroscopy="",
                    unit="1",
                    ours=ours,
                    measured=measured,
                    # skewness and kurtosis are near 0: a relative difference has no meaning
                    difference_percent=100.0 * (ours / measured - 1.0) if name == "crest" else float("nan"),
                    uncertainty=f"{table[f'{name}_error']:.2g} (one record; drawn: {spread:.2g})",
                    reason=f"Ours are means of {RECORDS} drawn records of two hours; one measured record cannot tell them apart.",
                )
            )
    return rows
