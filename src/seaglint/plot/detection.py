"""Picture of a detector's performance: operating characteristic with bands, and P_d against contrast."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from seaglint.io.outputs import moved_when_whole

if TYPE_CHECKING:
    from seaglint.pipeline.detect import Performance

MOST_CURVES: Final = 6
"""Characteristics drawn, evenly chosen from the contrasts."""


def draw_roc(found: Performance, path: Path) -> None:
    """Draw what :func:`seaglint.pipeline.detect.detect` found into a PNG file."""
    import numpy as np
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    scores = found.trials.scores
    several = len(scores) > 1
    figure = Figure(figsize=(10.5 if several else 5.6, 4.4), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, 2 if several else 1, squeeze=False)[0]
    left = panels[0]
    for k in np.unique(np.linspace(0, len(scores) - 1, min(len(scores), MOST_CURVES)).astype(int)):
        curve = found.characteristic(int(k))
        seen = curve.p_fa > 0
        (line,) = left.plot(curve.p_fa[seen], curve.p_d[seen], linewidth=1.4, label=f"contrast {scores[k].contrast:g}")
        left.fill_between(curve.p_fa[seen], curve.p_d_low[seen], curve.p_d_high[seen], color=line.get_color(), alpha=0.2, linewidth=0)
    rate = found.alarms.per_pixel.rate
    if rate > 0:
        left.axvline(rate, color="0.6", linewidth=0.8)
    left.set(xscale="log", xlabel="P_fa per pixel and frame", ylabel="P_d", ylim=(-0.02, 1.02))
    left.set_title(f"{found.detector.name}, filter {found.options.filter.name}", fontsize=10)
    left.legend(fontsize=8, frameon=False)
    if several:
        right = panels[1]
        contrast = [s.contrast for s in scores]
        rates = [d.rate for d in found.detections]
        low = [d.rate if d.low is None else d.low for d in found.detections]
        high = [d.rate if d.high is None else d.high for d in found.detections]
        right.plot(contrast, rates, marker="o", markersize=3, linewidth=1.2, color="0.2")
        right.fill_between(contrast, low, high, color="0.2", alpha=0.2, linewidth=0)
        right.set(xlabel="contrast", ylabel="P_d", ylim=(-0.02, 1.02))
        right.set_title(f"threshold {found.threshold.sigma:.3g} sigma, P_fa {rate:.2g}", fontsize=10)
    with moved_when_whole(path) as partial:
        figure.savefig(partial, dpi=120, format="png")
