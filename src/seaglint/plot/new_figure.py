"""Figures that need no screen, shown by notebooks, and as bytes."""

from __future__ import annotations

import io
from functools import partial
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DOTS_PER_INCH: Final = 100


def png(figure: Figure) -> bytes:
    """A figure as PNG, without date or version inside."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    buffer = io.BytesIO()
    figure.set_dpi(_DOTS_PER_INCH)
    # Not savefig, which lays everything out twice.
    FigureCanvasAgg(figure).print_png(buffer, metadata={"Software": None})  # type: ignore[no-untyped-call]
    return buffer.getvalue()


def new_figure(width: float, height: float) -> Figure:
    """A figure of this size [inch] that needs no screen; notebooks show it without pyplot."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    figure._repr_png_ = partial(png, figure)  # type: ignore[attr-defined]  # IPython shows figures of pyplot alone by itself
    return figure
