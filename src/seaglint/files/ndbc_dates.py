"""Dates of NDBC text files of every generation, of weather and of waves: years of two or four digits, with or without minutes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime, timedelta
from typing import Final

_WHOLE: Final = re.compile(r"\d{1,4}")
_PIVOT: Final = 70  # NDBC's first buoys are of the 1970s

YEAR_NAMES: Final = ("YY", "YYYY")  #: Headings of the column of years; from 2007 on the line begins with ``#``.


def headings_of(line: str) -> list[str]:
    """Return the headings of a line, the column of years first; an empty list where the line is none of headings.

    Examples
    --------
    >>> headings_of("#YYYY MM DD hh mm WDIR")
    ['YY', 'MM', 'DD', 'hh', 'mm', 'WDIR']
    >>> headings_of("# YY MM DD hh .0300")
    ['YY', 'MM', 'DD', 'hh', '.0300']
    >>> headings_of("#yr  mo dy hr mn degT")
    []
    """
    names = line.lstrip().removeprefix("#").split()
    dated = bool(names) and names[0] in YEAR_NAMES and names[1:3] == ["MM", "DD"] and names[3:4] in (["hh"], ["HH"])
    return ["YY", "MM", "DD", "hh", *names[4:]] if dated else []


def full_year(year: int) -> int:
    """Return a year of four digits: of two digits those from 70 on are of the last century, the others of this one.

    Raises
    ------
    ValueError
        A year that is neither 0 to 99 nor 1900 to 2199.

    Examples
    --------
    >>> [full_year(year) for year in (96, 70, 69, 5, 2024)]
    [1996, 1970, 2069, 2005, 2024]
    """
    if 0 <= year < 100:
        return year + (1900 if year >= _PIVOT else 2000)
    if 1900 <= year < 2200:
        return year
    raise ValueError(f"year {year} is neither 0 to 99 nor 1900 to 2199")


def moment_of(cells: Sequence[str]) -> datetime:
    """Return the time of year, month, day, hour and, where there is a fifth cell, minute; 24 h is the midnight that ends the day.

    Raises
    ------
    ValueError
        Cells that are no whole numbers, or a date or time that there is not.

    Examples
    --------
    >>> moment_of(["96", "12", "31", "24"]).isoformat()
    '1997-01-01T00:00:00'
    """
    for cell in cells:
        if not (cell.isascii() and _WHOLE.fullmatch(cell)):
            raise ValueError(f"'{cell}' is not a whole number")
    year, month, day, hour, minute = (int(cell) for cell in (*cells, "0")[:5])
    if (hour, minute) == (24, 0):
        return datetime(full_year(year), month, day) + timedelta(days=1)
    return datetime(full_year(year), month, day, hour, minute)
