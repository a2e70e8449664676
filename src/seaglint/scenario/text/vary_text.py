"""Values of a key as they are typed on a command line: a list, or a range of numbers."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from decimal import Decimal
from typing import Any, Final

from seaglint.base.errors import DataError

MOST_VALUES: Final = 100_000  #: Values of one key at most.

_NUMBER: Final = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_RANGE: Final = re.compile(rf"\s*({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*({_NUMBER})\s*")

_UNFINISHED: Final = re.compile(rf"\s*{_NUMBER}\s*:\s*{_NUMBER}(?:\s*:\s*{_NUMBER})?(?:\s*[A-Za-z/%]+)?\s*")

#: How values of a key are written.
FORMS: Final = "give KEY=VALUE,VALUE,... or KEY=START:STOP:STEP with STOP included, e.g. wind.speed_m_s=2,5,10 or wind.speed_m_s=1:20:1"


def parse_vary(texts: Sequence[str], option: str = "vary") -> list[tuple[str, list[Any]]]:
    """Return keys and values of ``key=a,b,c`` and ``key=START:STOP:STEP``, STOP included.

    Raises
    ------
    DataError
        No key, no values, a key twice, or a range without an end.

    Examples
    --------
    >>> parse_vary(["wind.speed_m_s=2,5", "detector=matched,log"])
    [('wind.speed_m_s', [2, 5]), ('detector', ['matched', 'log'])]
    >>> parse_vary(["sun.zenith_deg=0:1:0.25", "band=[3.5,4.15],[8,12]"])
    [('sun.zenith_deg', [0.0, 0.25, 0.5, 0.75, 1.0]), ('band', [[3.5, 4.15], [8, 12]])]
    """
    out: list[tuple[str, list[Any]]] = []
    for text in texts:
        key, sign, values = text.partition("=")
        key = key.strip()
        if not sign or not key or not values.strip():
            raise DataError(f"{option} = {text}: {FORMS}")
        if any(key == known for known, _ in out):
            raise DataError(f"{option} = {text}: {key} is varied twice; give all its values at once")
        out.append((key, _values(values, f"{option} = {text}")))
    return out


def _values(text: str, where: str) -> list[Any]:
    """Return the values of a list or a range."""
    whole = _RANGE.fullmatch(text)
    if whole is None:
        parts = _parts(text)
        if not all(part.strip() for part in parts):
            raise DataError(f"{where}: a value is missing between two commas or at an end; {FORMS}")
        if any(_UNFINISHED.fullmatch(part) for part in parts):
            raise DataError(f"{where}: a range has three numbers without a unit, START:STOP:STEP; {FORMS}")
        return [plain_value(part) for part in parts]
    start, stop, step = (Decimal(part) for part in whole.groups())
    if step == 0 or (stop - start) * step < 0:
        raise DataError(f"{where}: steps of {step} do not lead from {start} to {stop}; {FORMS}")
    count = int((stop - start) / step + Decimal("1e-9")) + 1
    if count > MOST_VALUES:
        raise DataError(f"{where}: has {count} values; give at most {MOST_VALUES} of one key, with a larger STEP")
    values = [start + i * step for i in range(count)]
    if all(part == part.to_integral_value() and "." not in text and "e" not in text.lower() for part in (start, step)):
        return [int(value) for value in values]
    return [float(value) for value in values]


def _parts(text: str) -> list[str]:
    """Split at commas that stand in no brackets or quotes."""
    found, depth, quote, part = [], 0, "", ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        depth += (letter in "[{") - (letter in "]}") if not quote else 0
        if letter == "," and depth == 0 and not quote:
            found.append(part)
            part = ""
        else:
            part += letter
    return [*found, part]


def plain_value(text: str) -> Any:
    """Return a value as a TOML file has it; text without quotes is text.

    Examples
    --------
    >>> plain_value("2"), plain_value(" 14 kn"), plain_value("[4, 2]"), plain_value("true")
    (2, '14 kn', [4, 2], True)
    """
    try:
        return tomllib.loads(f"v = {text.strip()}")["v"]
    except (tomllib.TOMLDecodeError, ValueError):
        return text.strip()
