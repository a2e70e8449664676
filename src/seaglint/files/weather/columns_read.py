"""Columns read from one weather file, and the number of rows and values that were left out."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.climate.select import Selection
from seaglint.climate.weather_table import RANGES, TextArray


@dataclass(frozen=True)
class WeatherSource:
    """Rows of weather from one file."""

    path: Path  #: The file.
    kind: str  #: Its format in words.
    columns: Mapping[str, FloatArray]  #: Numbers, in the names and units of a weather table.
    read: int  #: Records that the file holds.
    texts: Mapping[str, TextArray] = field(default_factory=dict)  #: Columns of text.
    left_out: Mapping[str, int] = field(default_factory=dict)  #: Records that gave no row, by reason.
    set_missing: Mapping[str, int] = field(default_factory=dict)  #: Values that were there and could not be used, by column and reason.
    notes: tuple[str, ...] = ()  #: Sentences on what was assumed.

    @property
    def rows(self) -> int:
        """Return the number of rows."""
        return int(next(iter(self.columns.values())).size)

    def within_ranges(self) -> WeatherSource:
        """Return the rows with observations outside the range of their column set missing, and counted."""
        columns, lost = dict(self.columns), dict(self.set_missing)
        for name, values in self.columns.items():
            low, high = RANGES[name]
            bad = ~np.isnan(values) & ~((values >= low) & (values <= high))
            if bad.any():
                columns[name] = np.where(bad, np.nan, values)
                lost[f"{name} outside {low:g} to {high:g}"] = int(bad.sum())
        return replace(self, columns=columns, set_missing=lost)

    def selected(self, selection: Selection) -> WeatherSource:
        """Return the selected rows; the others are counted."""
        good, fallen = selection.rows(self.columns, self.rows)
        if good.all():
            return self
        left_out = dict(self.left_out)
        for reason, count in fallen.items():
            left_out[reason] = left_out.get(reason, 0) + count
        return replace(
            self,
            columns={name: values[good] for name, values in self.columns.items()},
            texts={name: values[good] for name, values in self.texts.items()},
            left_out=left_out,
        )


def text_of(path: Path) -> str:
    """Return the text of a file, also of one packed by gzip.

    Raises
    ------
    DataError
        A file that is missing, cannot be read, or is no text.
    """
    try:
        content = path.read_bytes()
        if content[:2] == b"\x1f\x8b":
            content = gzip.decompress(content)
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; give a file of weather") from None
    except (OSError, EOFError) as error:
        raise DataError(f"{path}: cannot be read ({error}); is it whole?") from None
    if b"\0" in content[:4096]:
        raise DataError(f"{path}: is no text; give ERA5 NetCDF or GRIB, ICOADS IMMA1 or CSV, NDBC text, or CSV with map='NAME=COLUMN:UNIT'")
    return content.decode("utf-8-sig" if content[:3] == b"\xef\xbb\xbf" else "latin-1")
