"""Plain text tables of results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seaglint.studies.article.article_row import ArticleRow


def _number(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, list | tuple):
        return " to ".join(_number(item) for item in value)
    return f"{value:.4g}" if isinstance(value, int | float) else str(value)


def table(rows: Mapping[str, ArticleRow]) -> list[str]:
    """Lines of a table: what, the numbers that all rows have, unit; the settings of each row under it."""
    width = max((len(key) for key in rows), default=4)
    heads = next((list(row.numbers) for row in rows.values()), ["article", "ours"])
    out = ["  ".join([f"{'what':{width}}", *(f"{head:>12}" for head in heads), "unit"])]
    for key, row in rows.items():
        cells = (f"{_number(value):>12}" for value in row.numbers.values())
        out.append("  ".join([f"{key:{width}}", *cells, row.unit]).rstrip())
        if row.settings:
            out.append(f"{'':{width}}  {'; '.join(f'{name} = {_number(value)}' for name, value in row.settings.items())}")
    return out
