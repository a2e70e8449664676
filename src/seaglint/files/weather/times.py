"""Times of rows: month and hour of UTC, and notes on their order."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.weather.weather_cells import TextColumns


def month_and_hour(cells: TextColumns, column: str, *, naive_is_utc: bool) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Return month and hour of UTC of a column of ISO times.

    Parameters
    ----------
    cells : TextColumns
        The file.
    column : str
        Heading of the times: ``2019-07-01T06:00Z``, ``2019-07-01 08:00+02:00``.
    naive_is_utc : bool
        Flag: a time without a zone is UTC; else it is refused.

    Returns
    -------
    (array, array, tuple of str)
        Months 1-12; hours 0 to below 24, NaN where a time is missing or only a date; what is told.

    Raises
    ------
    DataError
        A text that is no time, or one without a zone.
    """
    texts = cells.text(column)
    month, hour, seconds = (np.full(len(texts), np.nan) for _ in range(3))
    for i, text in enumerate(texts):
        if not text:
            continue
        try:
            moment = datetime.fromisoformat(text)
        except ValueError:
            raise DataError(
                f"{cells.where(i)}, column {column}: '{text}' is no ISO time; write 2019-07-01T06:00Z, or leave it empty"
            ) from None
        if moment.tzinfo is None:
            if not naive_is_utc:
                raise DataError(
                    f"{cells.where(i)}, column {column}: '{text}' has no time zone; write 2019-07-01T06:00Z or +02:00, or set utc=True "
                    "if times without one are UTC"
                )
            moment = moment.replace(tzinfo=UTC)
        moment = moment.astimezone(UTC)
        month[i], seconds[i] = moment.month, moment.timestamp()
        hour[i] = np.nan if len(text) <= 10 else moment.hour + moment.minute / 60.0 + moment.second / 3600.0
    return month, hour, order_of(seconds)


def order_of(times: Any) -> tuple[str, ...]:
    """Return notes on times [any numbers or datetime64] that go backwards; they are accepted, since a weather table has no order."""
    known = times[~np.isnat(times)] if np.issubdtype(times.dtype, np.datetime64) else times[~np.isnan(times)]
    steps = np.diff(known.astype(np.float64))
    back = int(np.sum(steps < 0))
    notes = []
    if back:
        first = int(np.flatnonzero(steps < 0)[0]) + 2
        notes.append(
            f"times are not sorted: {back} go backwards, the first in record {first}; all rows are kept, a weather table has no order"
        )
    return tuple(notes)
