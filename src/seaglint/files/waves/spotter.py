"""Reader of Sofar Spotter data: JSON of the programming interface, CSV of the dashboard.

Both give the moments of every band, a1, b1, a2, b2, about the direction waves travel TO, counter-clockwise from east:
``direction = 270 deg - atan2(b1, a1)``, where they come FROM. wavespectra would rebuild them from mean direction and width alone, and
takes the times of the wave heights for those of the spectra, which lie an hour apart in older files.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files import text_file
from seaglint.files.tables.table_text import read_cell_lines
from seaglint.files.waves.bands import Bands, DirectionalMoments
from seaglint.files.waves.record_choice import as_utc
from seaglint.files.waves.wave_file import Held, parsed

_COLUMNS: Final = ("frequency", "varianceDensity", "a1", "b1", "a2", "b2")

_AGAIN: Final = "give a Spotter's file as its dashboard or programming interface wrote it, or see sea.spectrum.format"

Record = Mapping[str, Any]


def read_json(path: Path) -> Held:
    """Read the records of ``data.frequencyData``."""
    records = parsed(path, "a Spotter's JSON", lambda: text_file.read_json(path, _AGAIN)["data"]["frequencyData"])
    return _held(path, "a Spotter's JSON", records)


def read_csv(path: Path) -> Held:
    """Read the records of a table with a column for each band and quantity: ``f_0``, ``a1_0``, ``varianceDensity_0`` and so on."""

    def parse() -> list[Record]:
        (head, *rest), _ = read_cell_lines(path, _AGAIN, ",")
        header = [name.split("(")[0].strip() for name in head.cells]
        return [_record(dict(zip(header, line.cells, strict=True))) for line in rest]

    return _held(path, "a Spotter's CSV", parsed(path, "a Spotter's CSV", parse))


def _record(row: Mapping[str, str]) -> Record:
    """Return one row of the table, laid out as the JSON's records are."""
    count = sum(name.startswith("f_") for name in row)
    record: JsonObject = {name: [float(row[f"{'f' if name == 'frequency' else name}_{i}"]) for i in range(count)] for name in _COLUMNS}
    moment = datetime.fromtimestamp(float(row["Epoch Time"]), UTC)
    return record | {"timestamp": moment.isoformat(), "latitude": row.get("Latitude"), "longitude": row.get("Longitude")}


def _held(path: Path, kind: str, records: Sequence[Record]) -> Held:
    def parse() -> Held:
        times = np.array([as_utc(record["timestamp"]) for record in records], dtype="datetime64[ns]")
        places = [np.array([[float(record[name])] for record in records]) for name in ("latitude", "longitude")]
        return Held(lambda moment, _: _bands(path, records[moment]), times, ("1",), *places)

    held: Held = parsed(path, kind, parse)
    return held


def _bands(path: Path, record: Record) -> Bands:
    frequency, energy, a1, b1, a2, b2 = (np.asarray(record.get(name, ()), dtype=np.float64) for name in _COLUMNS)
    if len({values.shape for values in (frequency, energy, a1, b1, a2, b2)}) > 1:
        raise DataError(
            f"{path}: the record of {record['timestamp']} lacks one of {', '.join(_COLUMNS)} in some bands; ask for all of them"
        )
    # From counter-clockwise of east to clockwise of north: exp(i phi) = i conj(exp(i theta)).
    return DirectionalMoments(frequency, energy, 1j * np.conj(a1 + 1j * b1), -np.conj(a2 + 1j * b2))
