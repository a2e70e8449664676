"""Tables of weather: each row is one set of simultaneous conditions, with a weight.

Rows are drawn whole, which preserves the joint law: strong winds and overcast skies come together as often as they do in the table.
A draw takes uniform numbers rather than a generator, so that quasi-random sequences can drive it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

IntArray = NDArray[np.int64]
TextArray = NDArray[np.str_]

#: Columns of numbers and the closed range of each, from possible observations, so that a wrong unit is noticed.
#:
#: Wind at 10 m, direction that it comes from clockwise from north, cloud cover and humidity as shares of 1 (humidity above 1 is
#: supersaturated air).
RANGES: Final[Mapping[str, tuple[float, float]]] = {
    "weight": (0.0, np.inf),
    "wind_speed_m_s": (0.0, 100.0),
    "wind_from_deg": (0.0, 360.0),
    "cloud_cover": (0.0, 1.0),
    "sea_temperature_k": (265.0, 315.0),
    "air_temperature_k": (200.0, 335.0),
    "relative_humidity": (0.0, 1.1),
    "visibility_km": (0.0, 400.0),
    "significant_height_m": (0.0, 40.0),
    "month": (1.0, 12.0),
    "hour_utc": (0.0, 24.0),
    "latitude_deg": (-90.0, 90.0),
    "longitude_deg": (-180.0, 180.0),
}

TEXTS: Final = ("region", "atmosphere")  #: Columns of text: a user's label, and the name of a model atmosphere; an empty text is missing.

NEEDED: Final = ("wind_speed_m_s", "cloud_cover")  #: Columns that every table must have, though single values may be missing.

MONTHS: Final = ("January", "February", "March", "April", "May", "June", "July", "August", "September", "October", "November", "December")


@dataclass(frozen=True)
class WeatherTable:
    """Table of simultaneous conditions, one set in each row.

    Parameters
    ----------
    columns : mapping of str to (rows,) array
        Numbers by name, a name of ``RANGES``; NaN is a missing value. Without ``weight`` all rows have the same weight.
    texts : mapping of str to (rows,) array
        Texts by name, a name of ``TEXTS``.

    Raises
    ------
    DomainError
        An unknown column, columns of unequal length, no rows, a value outside its range, a missing weight, or weights that are all zero.

    Notes
    -----
    Weights need not sum to 1: any positive sum is divided out by :attr:`probability`, and :attr:`weight_sum` stores it.

    Examples
    --------
    >>> columns = {"wind_speed_m_s": [3.0, 9.0], "cloud_cover": [0.1, 0.9]}
    >>> columns["weight"] = [1.0, 3.0]
    >>> table = WeatherTable({name: np.array(values) for name, values in columns.items()})
    >>> table.draw(np.array([0.1, 0.3, 0.99])).tolist()
    [0, 1, 1]
    """

    columns: Mapping[str, FloatArray]
    texts: Mapping[str, TextArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        columns = {name: np.array(values, dtype=np.float64) for name, values in self.columns.items()}
        texts = {name: np.array(values, dtype=np.str_) for name, values in self.texts.items()}
        _check_names(columns, texts)
        sizes = {name: values.shape for name, values in {**columns, **texts}.items()}
        rows = columns[NEEDED[0]].size
        if any(shape != (rows,) for shape in sizes.values()):
            raise DomainError(f"columns of unequal length: {', '.join(f'{n} {s}' for n, s in sizes.items())}; give each one value a row")
        if rows == 0:
            raise DomainError("a weather table without rows; give at least one")
        columns.setdefault("weight", np.ones(rows))
        for name, values in columns.items():
            _check_range(name, values)
        if np.any(np.isnan(columns["weight"])):
            row = int(np.flatnonzero(np.isnan(columns["weight"]))[0])
            raise DomainError(f"row {row + 1}: weight is missing; give a number of 0 or more, or leave the column out", name="weight")
        if not columns["weight"].sum() > 0.0:
            raise DomainError("all weights are 0; give at least one row a weight above 0", name="weight", value=0.0)
        # A frozen record must not change through its arrays.
        arrays: tuple[NDArray[Any], ...] = (*columns.values(), *texts.values())
        for array in arrays:
            array.flags.writeable = False
        object.__setattr__(self, "columns", columns)
        object.__setattr__(self, "texts", texts)

    def __len__(self) -> int:
        """Number of rows."""
        return int(self.columns["weight"].size)

    def __contains__(self, name: object) -> bool:
        """True if there is a column of this name."""
        return name in self.columns or name in self.texts

    def __getitem__(self, name: str) -> FloatArray:
        """Column of numbers by name [(rows,)]; NaN throughout where the table does not have it."""
        if name not in RANGES:
            raise DomainError(f"'{name}' is not a column of numbers; columns are {', '.join(RANGES)}")
        return self.columns[name] if name in self.columns else np.full(len(self), np.nan)

    def text(self, name: str) -> TextArray:
        """Column of text by name [(rows,)]; empty texts where the table does not have it."""
        if name not in TEXTS:
            raise DomainError(f"'{name}' is not a column of text; columns are {', '.join(TEXTS)}")
        return self.texts[name] if name in self.texts else np.full(len(self), "")

    @property
    def weight_sum(self) -> float:
        """Sum of the weights as given."""
        return float(self.columns["weight"].sum())

    @property
    def probability(self) -> FloatArray:
        """Weights divided by their sum [(rows,), sums to 1]."""
        return np.asarray(self.columns["weight"] / self.weight_sum)

    @property
    def effective_rows(self) -> float:
        """Effective number of rows with equal weights: 1 / sum of squared probabilities (Kish)."""
        return float(1.0 / np.sum(self.probability**2))

    def mean(self, name: str) -> float:
        """Weighted mean of the rows that have a value; NaN without such rows."""
        values = self[name]
        known = ~np.isnan(values) & (self.columns["weight"] > 0.0)
        return float(np.average(values[known], weights=self.columns["weight"][known])) if known.any() else float("nan")

    def missing_share(self, name: str) -> float:
        """Weighted share of the rows without a value."""
        return float(np.sum(self.probability[self.text(name) == "" if name in TEXTS else np.isnan(self[name])]))

    def take(self, rows: NDArray[np.integer] | NDArray[np.bool_]) -> WeatherTable:
        """Return rows by index or mask, in their order, with their weights.

        Raises
        ------
        DomainError
            No rows, or none with a weight above zero.
        """
        return WeatherTable({n: v[rows] for n, v in self.columns.items()}, {n: v[rows] for n, v in self.texts.items()})

    def complete(self, names: Sequence[str] = NEEDED) -> tuple[WeatherTable, int]:
        """Return the rows that have all these values, and the number of excluded rows.

        Raises
        ------
        DomainError
            No row has them all.
        """
        good = np.all([self.text(n) != "" if n in TEXTS else ~np.isnan(self[n]) for n in names], axis=0)
        if not np.any(good & (self.columns["weight"] > 0.0)):
            counts = ", ".join(f"{n} in {100 * self.missing_share(n):.3g} %" for n in names)
            raise DomainError(f"no row has all of {', '.join(names)} (missing: {counts}); fill what is missing or bring another source")
        return self.take(good), int(np.sum(~good))

    def draw(self, uniform: FloatArray) -> IntArray:
        """Draw rows at uniform numbers, by the inverse of the cumulative weights.

        Parameters
        ----------
        uniform : (n,) array
            Numbers in [0, 1), of a generator or a quasi-random sequence. Neighbouring numbers give neighbouring rows: a table sorted by
            what the result depends on (:meth:`ordered`) leaves a quasi-random sequence its advantage.

        Returns
        -------
        (n,) array of int
            Row indices; rows of weight zero never come.
        """
        return _inverse(self.columns["weight"], _checked_uniform(uniform))

    def ordered(self, *names: str) -> WeatherTable:
        """Return the rows sorted by these columns, the first as primary key; missing values come last."""
        return self.take(np.lexsort([self[name] for name in reversed(names)]))

    @property
    def months(self) -> tuple[int, ...]:
        """Months that have rows of a weight above zero, ascending; empty where the table has no months."""
        return _months(self["month"], self.columns["weight"])

    @property
    def month_used(self) -> dict[int, int]:
        """Months by :func:`month_used` for the rows."""
        return month_used(self["month"], self.columns["weight"])

    @property
    def missing_months(self) -> tuple[int, ...]:
        """Months without rows, for which :meth:`draw_in_month` uses a neighbour; empty where the table has no months."""
        return tuple(m for m, used in self.month_used.items() if m != used)

    @property
    def stand_ins(self) -> dict[str, str]:
        """Names of the months without rows, each with the month whose rows serve in its place."""
        used = self.month_used
        return {MONTHS[m - 1]: MONTHS[used[m] - 1] for m in self.missing_months}

    def draw_in_month(self, uniform: FloatArray, month: NDArray[np.integer]) -> IntArray:
        """Draw rows at uniform numbers, each from the rows of its month.

        Parameters
        ----------
        uniform : (n,) array
            Numbers in [0, 1).
        month : (n,) array of int
            Months 1-12; a month without rows uses the month of :attr:`month_used`. A table without months is drawn as a whole; rows without
            a month in a table that has months are not drawn.

        Returns
        -------
        (n,) array of int
            Row indices of this table.
        """
        uniform, month = _checked_uniform(uniform), np.asarray(month)
        if month.shape != uniform.shape or not np.all((month >= 1) & (month <= 12)):
            raise DomainError("months are not one of 1-12 for each uniform number; give as many months as numbers", name="month")
        used = self.month_used
        if not used:
            return self.draw(uniform)
        out = np.empty(uniform.shape, dtype=np.int64)
        for requested in np.unique(month).tolist():
            rows = np.flatnonzero(self["month"] == used[requested])
            at = month == requested
            out[at] = rows[_inverse(self.columns["weight"][rows], uniform[at])]
        return out


def _months(month: FloatArray, weight: FloatArray) -> tuple[int, ...]:
    return tuple(int(m) for m in np.unique(month[~np.isnan(month) & (weight > 0.0)]))


def month_used(month: FloatArray, weight: FloatArray) -> dict[int, int]:
    """Month whose rows are drawn for each of the months 1-12: itself, or the nearest around the year that has rows.

    Of two that are equally near the earlier one is taken. Empty where no month is known: all rows serve all the year.
    """
    with_rows = _months(month, weight)
    if not with_rows:
        return {}
    # The nearest month with rows; of two that are equally near, the earlier one.
    return {m: min(with_rows, key=lambda t: (min((t - m) % 12, (m - t) % 12), (m - t) % 12)) for m in range(1, 13)}


def stand_ins_told(stand_ins: Mapping[str, str]) -> str:
    """Return :attr:`WeatherTable.stand_ins` in one clause; empty where no month is missing.

    Examples
    --------
    >>> stand_ins_told({"May": "June", "July": "June", "December": "November"})
    'no rows in May, July (June serves), December (November serves)'
    >>> stand_ins_told(dict.fromkeys(MONTHS[1:], "January"))
    'rows in January only: they serve all the year'
    """
    if len(stand_ins) == len(MONTHS) - 1:
        return f"rows in {next(iter(stand_ins.values()))} only: they serve all the year"
    served: dict[str, list[str]] = {}
    for month, by in stand_ins.items():
        served.setdefault(by, []).append(month)
    return "no rows in " + ", ".join(f"{', '.join(months)} ({by} serves)" for by, months in served.items()) if served else ""


def _inverse(weight: FloatArray, uniform: FloatArray) -> IntArray:
    """Index of the first cumulative weight above ``uniform`` times the sum."""
    cumulative = np.cumsum(weight)
    # From the right, so that a row without weight is never drawn.
    index = np.searchsorted(cumulative, uniform * cumulative[-1], side="right")
    # Rounding may bring uniform * sum up to the sum itself; the last row that has a weight is then meant.
    return np.asarray(np.minimum(index, np.flatnonzero(weight)[-1]), dtype=np.int64)


def _checked_uniform(uniform: FloatArray) -> FloatArray:
    uniform = np.asarray(uniform, dtype=np.float64)
    if uniform.ndim != 1 or not np.all((uniform >= 0.0) & (uniform < 1.0)):
        raise DomainError("uniform numbers are not a row of numbers in [0, 1); give those of a generator or a Sobol sequence")
    return uniform


def _check_names(columns: Mapping[str, FloatArray], texts: Mapping[str, TextArray]) -> None:
    for name, allowed in [*((n, tuple(RANGES)) for n in columns), *((n, TEXTS) for n in texts)]:
        if name not in allowed:
            raise DomainError(f"'{name}' is not a column of a weather table; allowed are {', '.join(allowed)}")
    missing = [name for name in NEEDED if name not in columns]
    if missing:
        raise DomainError(f"column {', '.join(missing)} missing; every weather table has {', '.join(NEEDED)}")


def _check_range(name: str, values: FloatArray) -> None:
    low, high = RANGES[name]
    bad = np.flatnonzero(~(np.isnan(values) | ((values >= low) & (values <= high) & np.isfinite(values))))
    if name == "month" and bad.size == 0:
        bad = np.flatnonzero(~np.isnan(values) & (values != np.round(values)))
    if bad.size:
        allowed = f"{low:g} to {high:g}" if np.isfinite(high) else f"{low:g} or more"
        more = f" ({bad.size - 1} more rows like it)" if bad.size > 1 else ""
        message = (
            f"row {bad[0] + 1}: {name} = {values[bad[0]]:g} is outside the range allowed: {allowed}; correct it, or leave it empty{more}"
        )
        raise DomainError(message, name=name, value=float(values[bad[0]]), allowed=(low, high))
