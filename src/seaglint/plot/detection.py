"""Picture of a detector's performance: operating characteristic with bands, and P_d against contrast."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from seaglint.detection.roc import Roc
from seaglint.detection.scoring import Interval
from seaglint.io.outputs import moved_when_whole

MOST_CURVES: Final = 6
"""Characteristics drawn, evenly chosen from the contrasts."""


def draw_roc(path: Path, title: str, contrasts: Sequence[float], curves: Sequence[Roc], found: Sequence[Interval], p_fa: float) -> None:
    """Draw a run into a PNG file.

    Parameters
    ----------
    path : Path
        File to write, or to replace.
    title : str
        Detector and filter.
    contrasts : sequence of float
        Contrasts of the run [u].
    curves : sequence of Roc
        Characteristic of each.
    found : sequence of Interval
        P_d of each at the threshold of the run [1].
    p_fa : float
        Rate of false alarms at that threshold [1].
    """
    import numpy as np
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    several = len(contrasts) > 1
    figure = Figure(figsize=(10.5 if several else 5.6, 4.4), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, 2 if several else 1, squeeze=False)[0]
    left = panels[0]
    for k in np.unique(np.linspace(0, len(contrasts) - 1, min(len(contrasts), MOST_CURVES)).astype(int)):
        curve = curves[k]
        seen = curve.p_fa > 0
        (line,) = left.plot(curve.p_fa[seen], curve.p_d[seen], linewidth=1.4, label=f"contrast {contrasts[k]:g}")
        left.fill_between(curve.p_fa[seen], curve.p_d_low[seen], curve.p_d_high[seen], color=line.get_color(), alpha=0.2, linewidth=0)
    if p_fa > 0:
        left.axvline(p_fa, color="0.6", linewidth=0.8)
    left.set(xscale="log", xlabel="P_fa per pixel and frame", ylabel="P_d", ylim=(-0.02, 1.02))
    left.set_title(title, fontsize=10)
    left.legend(fontsize=8, frameon=False)
    if several:
        right = panels[1]
        low = [d.rate if d.low is None else d.low for d in found]
        high = [d.rate if d.high is None else d.high for d in found]
        right.plot(contrasts, [d.rate for d in found], marker="o", markersize=3, linewidth=1.2, color="0.2")
        right.fill_between(contrasts, low, high, color="0.2", alpha=0.2, linewidth=0)
        right.set(xlabel="contrast", ylabel="P_d", ylim=(-0.02, 1.02))
        right.set_title(f"at the threshold of P_fa {p_fa:.2g}", fontsize=10)
    with moved_when_whole(path) as partial:
        figure.savefig(partial, dpi=120, format="png")
