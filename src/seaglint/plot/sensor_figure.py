"""Picture of a sensor's figures of merit: MTF with its parts, and the noise budget."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from seaglint.files.outputs import moved_when_whole

SIZE = (11.0, 4.2)
"""Width and height [in]."""


def write_sensor_plot(values: dict[str, Any], path: Path) -> None:
    """Draw what :func:`seaglint.studies.mean.sensor_figures.describe_sensor` tells into a picture file."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    mtf = values["mtf"]
    frequency = mtf["frequency_cycles_per_mrad"]
    for name, part in mtf["parts"]["along"].items():
        left.plot(frequency, part, linewidth=0.9, linestyle="--", label=name)
    left.plot(frequency, mtf["along"], color="black", linewidth=1.8, label="along rows")
    if mtf["along"] != mtf["across"]:
        left.plot(frequency, mtf["across"], color="0.5", linewidth=1.8, label="across rows")
    left.axvline(mtf["nyquist_cycles_per_mrad"], color="0.6", linewidth=0.8)
    left.annotate("Nyquist", (mtf["nyquist_cycles_per_mrad"], 0.96), fontsize=8, color="0.4")
    left.set(xlabel="frequency [cycles/mrad]", ylabel="MTF", ylim=(min(-0.05, min(mtf["along"])), 1.02), xlim=(0, frequency[-1]))
    left.legend(fontsize=8, frameon=False)
    unit = "electrons" if values["detector"] == "photon" else "nW"
    budget = values["noise_budget_electrons" if values["detector"] == "photon" else "noise_budget_nw"]
    names = [name for name, value in budget.items() if value and name != "signal" and not name.startswith("scene_")]
    right.barh([name.replace("_", " ") for name in names], [budget[name] for name in names], color="0.45")
    right.invert_yaxis()
    right.set(xlabel=f"noise [{unit} rms] at the scene's mean, {budget['scene_radiance']:.3g} W m⁻² sr⁻¹")
    for place, name in enumerate(names):
        right.text(budget[name], place, f" {budget[name]:.3g}", va="center", fontsize=8)
    right.margins(x=0.15)
    right.set_title(f"NETD {1e3 * values['netd_k']:.3g} mK at {values['background_k']:g} K", fontsize=10)
    with moved_when_whole(path) as partial:
        figure.savefig(partial, dpi=120, format=path.suffix.lstrip(".").lower())
