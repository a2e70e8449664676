"""Tables of pictures become cards that stand side by side as the page is wide: one card a column, its cells below each other.

On paper and in the source they are tables. Tables that follow each other become one row of cards.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from docutils import nodes
from sphinx.transforms import SphinxTransform

if TYPE_CHECKING:
    from sphinx.application import Sphinx


def columns(table: nodes.table) -> list[list[nodes.entry]]:
    """Return the cells of each column, without columns that are empty."""
    rows = [list(row.findall(nodes.entry)) for row in table.findall(nodes.row)]
    return [list(cells) for cells in zip(*rows, strict=True) if any(cell.astext() or has_picture(cell) for cell in cells)]


def has_picture(cell: nodes.entry) -> bool:
    """Whether a cell has a picture."""
    return next(cell.findall(nodes.image), None) is not None


def card(cells: list[nodes.entry]) -> nodes.container:
    """Return a card of the cells of a column; words in the head of the table are its title."""
    if not has_picture(cells[0]):
        cells[0][0]["classes"].append("card-title")
    return nodes.container("", *(child for cell in cells for child in cell.children), classes=["card-of-picture"])


class Cards(SphinxTransform):
    """Replace tables that have a picture in each column."""

    default_priority = 700  # before the collectors of pictures and links

    def apply(self, **options: Any) -> None:
        """Replace the tables of a page."""
        for table in list(self.document.findall(nodes.table)):
            cells = columns(table)
            if not cells or not all(any(has_picture(cell) for cell in column) for column in cells):
                continue
            before = table.parent[table.parent.index(table) - 1] if table.parent.index(table) else None
            cards = [card(column) for column in cells]
            if isinstance(before, nodes.container) and "cards" in before["classes"]:
                before += cards
                table.parent.remove(table)
            else:
                table.replace_self(nodes.container("", *cards, classes=["cards"]))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the transform."""
    app.add_transform(Cards)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
