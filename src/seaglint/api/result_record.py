"""Results that have no axes: their numbers and text by name, a picture, and what a notebook shows."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHORT: Final = 8  #: Largest number of values of a list that a notebook's table shows; ``as_dict()`` has all.


class ResultRecord(dict[str, Any]):
    """Numbers and text of a result by name, as the command prints them with ``--json``.

    Parameters
    ----------
    values : mapping
        Numbers, text, lists and mappings of them.
    draw : callable, optional
        Makes the picture of the result.
    html : callable, optional
        Makes what a notebook shows; without it the values as a table.
    title : str
        Heading of that table.

    Examples
    --------
    >>> record = ResultRecord({"netd_k": 0.02}, title="sensor")
    >>> record["netd_k"], record.as_dict()
    (0.02, {'netd_k': 0.02})
    """

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        draw: Callable[[], Figure] | None = None,
        html: Callable[[], str] | None = None,
        title: str = "result",
    ) -> None:
        super().__init__(values)
        self._draw, self._html, self._title = draw, html, title

    def as_dict(self) -> dict[str, Any]:
        """Return the values as a plain dictionary, which JSON can hold."""
        return dict(self)

    def plot(self) -> Figure:
        """Draw the result.

        Raises
        ------
        DataError
            A result that has no picture.
        """
        if self._draw is None:
            from seaglint.base.errors import DataError

            raise DataError(f"the {self._title} has no picture; its numbers are in as_dict()")
        return self._draw()

    def __repr__(self) -> str:
        """Return the values, with long lists and text shortened."""
        short = reprlib.Repr()
        short.maxlevel, short.maxdict, short.maxlist, short.maxtuple, short.maxstring, short.maxother = 3, 40, SHORT, SHORT, 120, 120
        return short.repr(dict(self))

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        if self._html is not None:
            return self._html()
        from seaglint.base.representation import card, table

        return card(self._title, table(("name", "value"), list(_rows("", self))))


def _rows(name: str, value: Any) -> Any:
    """Yield names and values of a result, those of inner mappings by dotted names; curves, tables and the scenario are left out."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key != "scenario":
                yield from _rows(f"{name}.{key}" if name else str(key), inner)
    elif not isinstance(value, list | tuple) or (len(value) <= SHORT and not any(isinstance(item, Mapping | list) for item in value)):
        yield name, value
