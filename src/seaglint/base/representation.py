"""Numbers as text, and HTML of scenarios and results in notebooks: escaped, without scripts and without external files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any, Final

ABSENT: Final = "–"  #: Text shown in place of a number that does not exist.

_CELL: Final = "padding:.15rem .6rem;text-align:left;border-bottom:1px solid rgba(128,128,128,.3);vertical-align:top"


def as_text(value: Any) -> str:
    """Return a value as plain text, numbers with four digits.

    Examples
    --------
    >>> as_text(3.14159), as_text((1.0, 2.5)), as_text(None), as_text(True)
    ('3.142', '1, 2.5', '–', 'true')
    """
    match value:
        case None:
            return ABSENT
        case bool():
            return "true" if value else "false"
        case float():
            return f"{value:.4g}"
        case list() | tuple():
            return ", ".join(as_text(item) for item in value)
        case _:
            text = str(value)
            return text if len(text) <= 120 else text[:117] + "..."


def table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return an HTML table; cells are values or text."""

    def line(tag: str, cells: Sequence[Any]) -> str:
        return "<tr>" + "".join(f'<{tag} style="{_CELL}">{escape(as_text(cell))}</{tag}>' for cell in cells) + "</tr>"

    body = "".join(line("td", row) for row in rows)
    return f'<table style="border-collapse:collapse;font-size:.85rem">{line("th", head)}{body}</table>'


def card(title: str, *parts: str) -> str:
    """Return an HTML card: a heading and the given pieces of HTML side by side below it."""
    inside = "".join(f"<div>{part}</div>" for part in parts if part)
    return f'<div><strong>{escape(title)}</strong><div style="display:flex;flex-wrap:wrap;gap:1.2rem;margin-top:.3rem">{inside}</div></div>'


def notes(texts: Iterable[str]) -> str:
    """Return the HTML of notes, one sentence a line; empty without notes."""
    lines = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f'<ul style="margin:.2rem 0;padding-left:1.2rem;font-size:.85rem">{lines}</ul>' if lines else ""


def rounded(value: float, digits: int) -> str:
    """Return a number as text with some digits, in full from a thousandth to ten million.

    Examples
    --------
    >>> rounded(25412.0, 3), rounded(2.5e9, 3)
    ('25400', '2.5e+09')
    """
    import numpy as np

    if not 1e-3 <= abs(value) < 1e7:
        return f"{value:.{digits}g}"
    return np.format_float_positional(float(f"{value:.{digits}g}"), trim="-")


def decimals(value: float, most: int = 2) -> str:
    """Return a number as text with at most a number of decimals, and no zeros at their end.

    Examples
    --------
    >>> decimals(7.20222), decimals(290.15), decimals(-0.001), decimals(100.0), decimals(4.6e-3, 3)
    ('7.2', '290.15', '0', '100', '0.005')
    """
    text = f"{value:.{most}f}"
    text = text.rstrip("0").rstrip(".") if most else text
    return "0" if text == "-0" else text


def duration(seconds: float) -> str:
    """Return a time span [s] as text in everyday units.

    Examples
    --------
    >>> duration(42.4), duration(600), duration(7500), duration(3e6), duration(1e9)
    ('42 s', '10 min', '2 h 05 min', '35 days', '32 years')
    """
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    if minutes < 100:
        return f"{minutes} min"
    if minutes < 100 * 60:
        return f"{minutes // 60} h {minutes % 60:02d} min"
    days = seconds / 86_400.0
    return f"{days:.0f} days" if days < 1000.0 else f"{days / 365.25:.0f} years"


def size_text(size: float) -> str:
    """Return a number of bytes as text.

    Examples
    --------
    >>> size_text(4e3), size_text(5.1e7), size_text(3.9e13)
    ('0.004 MB', '51 MB', '39 TB')
    """
    factor, unit = next(((factor, unit) for factor, unit in ((1e12, "TB"), (1e9, "GB")) if size >= factor), (1e6, "MB"))
    return f"{size / factor:.3g} {unit}"
