"""Reader of the wave sentences of Nortek's AWAC and Signature (NMEA, data format 501).

A record is the sentences of one date and time: ``$PNORW`` (heights, periods and the direction at the peak), ``$PNORE`` (energies over
frequency), and either ``$PNORF`` (Fourier coefficients A1, B1, A2, B2) or ``$PNORWD`` (main direction MD and spread DS). Coefficients are
the cosine and sine parts about the direction waves come FROM, clockwise from north: ``DirTp = atan2(B1, A1)`` at the peak, which must
agree. Coefficients may end at a lower frequency than energies. -9 is a missing value.

Nortek documents energies in cm² Hz⁻¹, and instruments send m² Hz⁻¹: the unit is the one with which the height Hm0 of ``$PNORW`` agrees.
Times are by the clock of the instrument, which is taken as UTC, and directions by its compass.

wavespectra is not used: it stretches the frequencies by the factor N / (N - 1), leaves out energies above the last coefficient and scales
the rest to Hm0.

Sentences with a wrong checksum, another number of values than they state, or an impossible date are left out and reported by their
number; a file with more bad lines than good ones is refused.

References
----------
Nortek, "Signature integrator's guide", telemetry data formats, DF 501; "AWAC NMEA telegrams".
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from functools import reduce
from operator import xor
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.tables.observed_lines import lines_of, sound, text_of
from seaglint.formats.tables.table_text import plain_number
from seaglint.formats.waves.buoys import filled_directions
from seaglint.formats.waves.wave_records import Bands, ComplexArray, Cosine, DirectionalMoments, Plain, WaveRecords

_AGAIN: Final = "give the telegrams of waves (data format 501) as the instrument sent them, or see sea.spectrum.format"

_SENTENCE: Final = re.compile(r"\$([A-Z0-9]+),([^$*]*)\*([0-9A-Fa-f]{2})")

_HEIGHT_CELLS: Final = 21  # of $PNORW without its name
_HM0, _TP, _DIR_TP = 2, 7, 9  # places of values of $PNORW, the basis of the spectrum first
_PARTS: Final = {"PNORF": ("A1", "B1", "A2", "B2"), "PNORWD": ("MD", "DS")}
_MISSING: Final = -9.0

_AGREE_HEIGHT: Final = 0.25  # share of Hm0: the two units are a factor of 100 in height
_AGREE_DEG: Final = 30.0  # DirTp against the coefficients of the band of the peak
_POINTED: Final = 0.3  # length of the first moment below which a peak has no direction worth comparing


@dataclass
class _Record:
    """Sentences of one date and time."""

    #: Frequencies [Hz] and values by part: PNORE, A1, MD and others; of PNORW values alone, from the basis of the spectrum on.
    parts: dict[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    error: str = ""  #: Error code of PNORW.
    differs: bool = False  #: Whether two sentences of one part differ.

    def directions(self) -> str | None:
        """Return the sentence that has all directions of the record; None without one."""
        return next((name for name, parts in _PARTS.items() if all(part in self.parts for part in parts)), None)


def read_awac(path: Path) -> WaveRecords:
    """Read the records of a file of sentences.

    Raises
    ------
    DataError
        No record, or more bad lines than good ones.
    """
    records: dict[datetime, _Record] = {}
    lines = lines_of(text_of(path))
    _, bad = sound(path, lines, [_taken(line.strip(), records) for _, line in lines], "telegrams", _AGAIN)
    whole = {moment: record for moment, record in records.items() if {"PNORW", "PNORE"} <= record.parts.keys()}
    if any(record.directions() for record in records.values()):
        whole = {moment: record for moment, record in whole.items() if record.directions()}
    good_records = {moment: record for moment, record in whole.items() if not record.differs and not record.error.strip("0")}
    for kind, count in (
        ("records without all of $PNORW, $PNORE and directions", len(records) - len(whole)),
        ("records with an error code", sum(bool(record.error.strip("0")) for record in whole.values())),
        ("records with two sentences that differ", sum(record.differs for record in whole.values())),
    ):
        if count:
            bad[kind] = count
    used = sorted(good_records)
    if not used:
        raise DataError(f"{path}: has no whole record of waves{f' ({_listed(bad)})' if bad else ''}; {_AGAIN}")
    note = f"left out: {_listed(bad)}" if bad else None
    times = np.array(used, "datetime64[ns]")
    return WaveRecords(lambda moment, _: _bands(good_records[used[moment]], f"{path} at {used[moment].isoformat()}"), times, note=note)


def _listed(bad: Mapping[str, int]) -> str:
    return ", ".join(f"{kind}: {count}" for kind, count in bad.items())


def _taken(line: str, records: dict[datetime, _Record]) -> str:
    """Add the sentence of a line to the record of its time; return what is wrong with the line, empty where nothing is."""
    sentence = _SENTENCE.fullmatch(line)
    if sentence is None:
        return "lines that are no whole sentence"
    if reduce(xor, line[1:-3].encode("latin-1"), 0) != int(sentence[3], 16):
        return "lines with a wrong checksum"
    name, cells = sentence[1], [cell.strip() for cell in sentence[2].split(",")]
    if name not in ("PNORW", "PNORE", *_PARTS):
        return ""
    part = cells.pop(0) if name in _PARTS else name
    if name in _PARTS and part not in _PARTS[name]:
        return f"lines of ${name} of an unknown kind"
    try:
        moment = datetime.strptime("".join(cells[:2]).partition(".")[0], "%m%d%y%H%M%S")
        numbers = np.array([plain_number(cell or "nan") for cell in (cells[2:-1] if name == "PNORW" else cells[2:])])
    except ValueError:
        return f"lines of ${name} with an impossible date or number"
    if name == "PNORW":
        whole, frequency = len(cells) == _HEIGHT_CELLS, np.zeros(0)
    else:
        whole = len(numbers) > 4 and numbers[2] > 0.0 and len(numbers) - 4 == numbers[3]
    if not whole:
        return f"lines of ${name} with another number of values"
    record = records.setdefault(moment, _Record())
    if name == "PNORW":
        record.error = cells[-1]
    else:
        frequency, numbers = numbers[1] + numbers[2] * np.arange(len(numbers) - 4), numbers[4:]
    values = np.where(numbers == _MISSING, np.nan, numbers)
    earlier = record.parts.get(part, (frequency, values))
    record.differs |= not all(np.array_equal(a, b, equal_nan=True) for a, b in zip(earlier, (frequency, values), strict=True))
    record.parts[part] = frequency, values
    return ""


def _bands(record: _Record, what: str) -> Bands:
    """Return the bands of a record; its unit and directions must agree with $PNORW."""
    frequency, energy = record.parts["PNORE"]
    height = record.parts["PNORW"][1][_HM0]
    step = float(frequency[1] - frequency[0]) if frequency.size > 1 else 0.0
    own = 4.0 * float(np.sqrt(abs(np.nansum(energy)) * step))
    unit = next((unit for unit in (1.0, 1e-4) if abs(own * np.sqrt(unit) - height) <= _AGREE_HEIGHT * height), None)
    if unit is None or not height > 0.0:
        raise DataError(
            f"{what}: its energies give a height of {own:.2f} m in m2/Hz and {0.01 * own:.2f} m in cm2/Hz, and $PNORW has {height:.2f} m; "
            "choose another time"
        )
    energy = energy * unit
    match record.directions():
        case "PNORF":
            a1, b1, a2, b2 = (_on(frequency, *record.parts[part], what) for part in _PARTS["PNORF"])
            first, second = a1 + 1j * b1, a2 + 1j * b2
            _require_peak(record, frequency, first, what)
            return DirectionalMoments(frequency, energy, -first, second)  # about the direction TO
        case "PNORWD":
            come_from, width = (_on(frequency, *record.parts[part], what) for part in _PARTS["PNORWD"])
            _require_peak(record, frequency, np.exp(1j * np.radians(come_from)), what)
            come_from, width = filled_directions(frequency, np.where(np.isfinite(energy), energy, 0.0), come_from, width, what)
            return Cosine(frequency, energy, come_from, width)
        case _:
            return Plain(frequency, energy)


def _on(frequency: FloatArray, own: FloatArray, values: FloatArray, what: str) -> FloatArray:
    """Return values on the frequencies of the energies; NaN where there are none."""
    step = float(np.min(np.diff(frequency), initial=np.inf))
    index = np.rint((own - frequency[0]) / step).astype(int)
    inside = (index >= 0) & (index < frequency.size)
    if np.any(np.abs(frequency[index[inside]] - own[inside]) > 0.01 * step):
        raise DataError(f"{what}: directions have other frequencies than the energies; choose another time")
    out = np.full(frequency.size, np.nan)
    out[index[inside]] = values[inside]
    return out


def _require_peak(record: _Record, frequency: FloatArray, first: ComplexArray, what: str) -> None:
    """Refuse directions that do not have the direction of the peak that $PNORW states."""
    period, stated = (float(record.parts["PNORW"][1][place]) for place in (_TP, _DIR_TP))
    if not (period > 0.0 and 0.0 <= stated <= 360.0):
        return
    moment = first[np.argmin(np.abs(frequency - 1.0 / period))]
    own = float(np.degrees(np.angle(moment)) % 360.0)
    if np.abs(moment) >= _POINTED and abs((own - stated + 180.0) % 360.0 - 180.0) > _AGREE_DEG:
        raise DataError(
            f"{what}: waves of the peak come from {own:.0f} deg by its spectrum and from {stated:.0f} deg by $PNORW; see the file"
        )
