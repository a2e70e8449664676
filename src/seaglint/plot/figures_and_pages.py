"""New figures that need no screen, figures as bytes, and the HTML pages of reports, which load nothing from the network."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.store.outputs import json_text, moved_when_whole
from seaglint.version import __version__

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_DOTS_PER_INCH: Final = 100


def png(figure: Figure) -> bytes:
    """Return a figure as PNG, without date or version inside."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    buffer = io.BytesIO()
    # Set here, so that a user's settings of Matplotlib do not change the bytes of a report.
    figure.set_dpi(_DOTS_PER_INCH)
    # Not savefig, which lays everything out twice.
    FigureCanvasAgg(figure).print_png(buffer, metadata={"Software": None})  # type: ignore[no-untyped-call]
    return buffer.getvalue()


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of a size [inch] that needs no screen; notebooks display it without pyplot."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    figure._repr_png_ = partial(png, figure)  # type: ignore[attr-defined]  # IPython shows figures of pyplot alone by itself
    return figure


def save_figure(figure: Figure, output: str | Path, dpi: int, *remedy: str, **options: Any) -> Path:
    """Write a figure to a picture file, complete or not at all, in the format of the ending unless ``format`` is given.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind. Its text ends with ``remedy``.
    """
    output = Path(output)
    kind = options.pop("format", output.suffix.lstrip(".").lower())
    with moved_when_whole(output, *remedy) as partial_file:
        figure.savefig(partial_file, dpi=dpi, format=kind, **options)
    return output


def beyond(values: NDArray[Any], low: float, high: float) -> str:
    """Return the ends of a colour bar that values exceed, as Matplotlib's ``extend``: both, max, min or neither."""
    with np.errstate(invalid="ignore"):
        above, below = bool((values > high).any()), bool((values < low).any())
    return {(True, True): "both", (True, False): "max", (False, True): "min", (False, False): "neither"}[above, below]


ABSENT: Final = "–"  #: Text in place of a number that does not exist.

WIDE: Final = 9  #: Number of columns from which a table is set smaller and its numbers may wrap, so that the last columns stay in view.

STYLE: Final = """
body { font: 15px/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; color: #1c2430; background: #fff;
  max-width: 1800px; margin: 0 auto; padding: 1.5rem 1.2rem 4rem; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 .3rem; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 2.4rem 0 .5rem; padding-top: .8rem; border-top: 1px solid #d5dbe3; }
h3 { font-size: 1rem; margin: 1.4rem 0 .3rem; }
p { margin: .4rem 0 .8rem; max-width: 78ch; }
.facts { color: #4a5666; }
.notes { background: #fff6e0; border-left: 4px solid #e0a100; padding: .6rem 1rem .6rem 2rem; margin: 1rem 0; }
.none { background: #eef6ee; border-left-color: #4c9a4c; padding-left: 1rem; }
.table { overflow-x: auto; max-width: 100%; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .88rem; margin: .4rem 0 .8rem; }
th, td { padding: .25rem .5rem; text-align: right; border-bottom: 1px solid #e4e8ee; white-space: nowrap; }
th { background: #f3f5f8; font-weight: 600; vertical-align: bottom; white-space: normal; }
th:first-child, td:first-child, .text { text-align: left; }
td.text { white-space: normal; min-width: 11rem; color: #4a5666; }
.table.wide table { font-size: .8rem; }
.table.wide th, .table.wide td { padding: .25rem .35rem; }
.table.wide td { white-space: normal; overflow-wrap: break-word; }
.table.wide td.text { min-width: 9rem; }
figure { margin: .8rem 0 1.2rem; }
figure img { max-width: 100%; height: auto; border: 1px solid #e4e8ee; }
figcaption, .small { font-size: .85rem; color: #4a5666; max-width: 95ch; }
pre { background: #f3f5f8; padding: .8rem; overflow-x: auto; font-size: .8rem; }
@media print { body { max-width: none; padding: 0; } figure, tr { break-inside: avoid; } }
""".strip()


def page(title: str, body: Iterable[str]) -> str:
    """Return the whole HTML page as text."""
    head = (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        # Names and notes come from files of others: nothing in them may run or load.
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n"
        f'<meta name="generator" content="seaglint {__version__}">\n<title>{escape(title)}</title>\n<style>\n{STYLE}\n</style>\n</head>\n'
    )
    return head + "<body>\n" + "\n".join(body) + "\n</body>\n</html>\n"


def number(value: Any, digits: int = 3) -> str:
    """Return a number for a table; a missing one is a dash."""
    if value is None:
        return ABSENT
    # Before whole numbers, of which Python's truth values are a subclass.
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}".replace(",", "\u202f")
    # Exponents without leading zero and plus sign; a minus sign instead of a hyphen.
    return f"{value:.{digits}g}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e").replace("-", "\u2212")


def interval(ends: Sequence[float | None] | None, digits: int = 3) -> str:
    """Return an interval for a table; where an end is missing, a dash."""
    return ABSENT if ends is None or None in ends else f"{number(ends[0], digits)} … {number(ends[1], digits)}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], words: Sequence[int] = ()) -> str:
    """Return a table of text; cells of the columns ``words`` hold sentences."""

    def cell(tag: str, place: int, text: str) -> str:
        return f'<{tag} class="text">{escape(text)}</{tag}>' if place in words else f"<{tag}>{escape(text)}</{tag}>"

    lines = ["<tr>" + "".join(cell("td", i, text) for i, text in enumerate(row)) + "</tr>" for row in rows]
    top = "<tr>" + "".join(cell("th", i, text) for i, text in enumerate(head)) + "</tr>"
    kind = "table wide" if len(head) >= WIDE else "table"
    return f'<div class="{kind}"><table>\n<thead>' + top + "</thead>\n<tbody>\n" + "\n".join(lines) + "\n</tbody></table></div>"


def bullets(texts: Iterable[str], kind: str = "") -> str:
    """Return sentences as a list; ``kind`` is its style."""
    return (f'<ul class="{kind}">' if kind else "<ul>") + "".join(f"<li>{escape(text)}</li>" for text in texts) + "</ul>"


def notes(texts: Sequence[str], none: str = "") -> str:
    """Return remarks in a box; without remarks the sentence ``none``."""
    return bullets(texts, "notes") if texts else f'<div class="notes none">{escape(none)}</div>'


def all_numbers(results: Any) -> str:
    """Return all results of a report as JSON that opens on a click."""
    return f"<details><summary>All numbers as JSON</summary><pre>\n{escape(json_text(results, indent=1))}\n</pre></details>"


def section(title: str, *parts: str) -> str:
    """Return a heading and the text below it."""
    return "\n".join([f"<h2>{escape(title)}</h2>", *parts])


def figure(content: bytes, title: str, caption: str) -> str:
    """Return a PNG picture and its caption as HTML; the pixels are inside the page."""
    data = base64.b64encode(content).decode("ascii")
    return f'<figure><img alt="{escape(title)}" src="data:image/png;base64,{data}"><figcaption>{escape(caption)}</figcaption></figure>'
