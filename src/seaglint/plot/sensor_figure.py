"""Picture of a sensor's figures of merit: MTF with its parts, and the noise budget."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from seaglint.files.outputs import moved_when_whole
from seaglint.instrument.data_sheet import SensorDataSheet
from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (11.0, 4.2)  #: Width and height [in].


def write_sensor_plot(sheet: SensorDataSheet, path: Path) -> None:
    """Draw the figures of merit of a sensor into a picture file."""
    with moved_when_whole(path) as partial:
        draw_sensor(sheet).savefig(partial, dpi=120, format=path.suffix.lstrip(".").lower())


def draw_sensor(sheet: SensorDataSheet) -> Figure:
    """Draw MTF and noise budget of a sensor."""
    figure = new_figure(*SIZE)
    left, right = figure.subplots(1, 2)
    mtf = sheet.mtf
    frequency = mtf.frequency_cycles_per_mrad
    for name, part in mtf.parts["along"].items():
        left.plot(frequency, part, linewidth=0.9, linestyle="--", label=name)
    left.plot(frequency, mtf.along, color="black", linewidth=1.8, label="along rows")
    if mtf.along != mtf.across:
        left.plot(frequency, mtf.across, color="0.5", linewidth=1.8, label="across rows")
    left.axvline(mtf.nyquist_cycles_per_mrad, color="0.6", linewidth=0.8)
    left.annotate("Nyquist", (mtf.nyquist_cycles_per_mrad, 0.96), fontsize=8, color="0.4")
    left.set(xlabel="frequency [cycles/mrad]", ylabel="MTF", ylim=(min(-0.05, min(mtf.along)), 1.02), xlim=(0, frequency[-1]))
    left.legend(fontsize=8, frameon=False)
    noise = {name: value for name, value in sheet.noise_budget.noise.items() if value}
    right.barh([name.replace("_", " ") for name in noise], list(noise.values()), color="0.45")
    right.invert_yaxis()
    right.set(xlabel=f"noise [{sheet.unit} rms] at the scene's mean, {sheet.noise_budget.scene_radiance:.3g} W m⁻² sr⁻¹")
    for place, value in enumerate(noise.values()):
        right.text(value, place, f" {value:.3g}", va="center", fontsize=8)
    right.margins(x=0.15)
    right.set_title(f"NETD {1e3 * sheet.netd_k:.3g} mK at {sheet.background_k:g} K", fontsize=10)
    return figure
