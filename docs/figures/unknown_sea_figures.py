"""Draw what is not known of the sea into docs/images, and write its table into docs/what-is-not-known.md.

python docs/figures/unknown_sea_figures.py                 both figures
python docs/figures/unknown_sea_figures.py unknown_sea     one of unknown_sea, three_seas (some minutes)
python docs/figures/unknown_sea_figures.py table           the table of the page, by the interval of the default scenario
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.stats import norm

from pictures import save_named
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.imaging.scene import image
from seaglint.optics.band import apparent_temperature
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.sea.spectra.campaign_draws import LONGEST, ShortWaveLevels, drawn_sea, short_wave_bounds
from seaglint.sea.spectra.campaigns import CAMPAIGNS, campaign_spectrum, campaign_table, campaign_winds
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.studies.build import scenario_physics
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sea_draws import sea_draws
from seaglint.studies.sequence.render_sequence import prepare_sequence

PAGE: Final = Path(__file__).resolve().parents[2] / "docs" / "what-is-not-known.md"
WINDS = (5.3, 9.2)  # m/s, near winds of both campaigns
COLOURS = {"asit-2019": "tab:blue", "radyo-2008": "tab:red", "elfouhaily": "black"}
THRESHOLDS = (3.0, 3.5)  # standard deviations
SEAS, FRAMES = 20, 4  # drawn seas, and frames of each
BETWEEN_FRAMES = 5.0  # s: longer than a wave stays in a pixel
SCENE: dict[str, Any] = {"sensor": {"pixels": [320, 160]}}
TABLE_SEAS = 40


def unknown_sea() -> Figure:
    """Saturation of both campaigns and the model with the band between them, and slope variances against the wind."""
    figure = Figure(figsize=(12.0, 4.2), layout="constrained")
    first, second, third = figure.subplots(1, 3)
    k = np.geomspace(0.5, 4000.0, 800)
    for axes, wind in ((first, WINDS[0]), (second, WINDS[1])):
        bounds = short_wave_bounds(wind)
        inside = bounds.wavenumber >= LONGEST
        nodes = bounds.wavenumber[inside]
        axes.fill_between(nodes, bounds.least[inside], bounds.largest[inside], color="0.85", label="band of drawn seas")
        for name in CAMPAIGNS:
            table = campaign_table(name).at(wind, longer="cut")
            values = k**3 * table.omnidirectional(k)
            axes.loglog(k, np.where(values > 0.0, values, np.nan), color=COLOURS[name], label=name)
        axes.loglog(k, k**3 * ElfouhailySpectrum(wind).omnidirectional(k), color=COLOURS["elfouhaily"], label="Elfouhaily 1997")
        axes.set(xlabel="wavenumber [rad m⁻¹]", ylabel="saturation B = k³S [1]", ylim=(1e-4, 3e-2), title=f"wind {wind:g} m/s")
    first.legend(fontsize=7, loc="lower left")
    wind = np.linspace(1.0, 17.5, 34)
    for name in CAMPAIGNS:
        at = campaign_winds(name)
        third.plot(at, [sum(campaign_spectrum(name, w).mss()) for w in at], ".-", color=COLOURS[name], label=f"{name}, to its last wave")
    third.plot(wind, [sum(ElfouhailySpectrum(w).mss()) for w in wind], color=COLOURS["elfouhaily"], label="Elfouhaily 1997")
    third.plot(wind, [cox_munk_isotropic(w).mss for w in wind], color="tab:green", ls="--", label="Cox and Munk 1954")
    fitted = wind[wind <= 15.0]
    third.plot(fitted, [breon_henriot(w, 0.0).mss for w in fitted], color="tab:purple", ls="-.", label="Bréon and Henriot 2006")
    ends = np.array([[_total(w, level) for w in wind] for level in (0.0, 1.0)])
    third.fill_between(wind, *ends, color="0.85", label="band of drawn seas")
    third.set(xlabel="wind at 10 m [m s⁻¹]", ylabel="slope variance [1]", title="all waves", ylim=(0.0, None))
    third.legend(fontsize=7, loc="upper left")
    return figure


def _total(wind: float, level: float) -> float:
    sea = drawn_sea(wind, ShortWaveLevels(level, level), 0.0, ElfouhailySpectrum(wind))
    return 0.0 if sea is None else sum(sea.mss())


def frames_of(scenario: Scenario) -> tuple[NDArray[np.float32], Any]:
    """Radiance of some frames [W m-2 sr-1, (frames, rows, columns)], and the scene."""
    scene = prepare_sequence(scenario).scene
    return np.stack([image(scene, scene.pose, BETWEEN_FRAMES * number).radiance for number in range(FRAMES)]), scene


def rates(frames: NDArray[np.float32], sea: NDArray[np.bool_]) -> list[float]:
    """Share of the pixels of the sea above each threshold after the Laplacian [1]."""
    z = standardise(Laplacian().apply(frames), sea)[:, sea]
    return [float(np.mean(z > threshold)) for threshold in THRESHOLDS]


def three_seas() -> Figure:
    """One scene with three seas of one wind, and the false alarms of seas drawn between them."""
    given = parse_scenario(SCENE)
    named = {
        "Elfouhaily 1997": parse_scenario({**SCENE, "sea": {"slopes": {"kind": "spectrum"}}}),
        **{name: parse_scenario({**SCENE, "sea": {"spectrum": {"kind": name}}}) for name in CAMPAIGNS},
    }
    figure = Figure(figsize=(12.0, 6.4), layout="constrained")
    grid = figure.add_gridspec(2, 3, height_ratios=(1.2, 1.0))
    camera = scenario_physics.camera(given)
    below = camera.elevations < -horizon_depression(camera.height) - 2.0 * camera.row_step
    sea = np.repeat(below[:, None], camera.columns, axis=1)
    azimuth, elevation = np.degrees(camera.azimuths), np.degrees(camera.elevations)
    box = (azimuth[0], azimuth[-1], elevation[-1], elevation[0])
    found, shown, limits = {}, None, None
    for place, (name, scenario) in enumerate(named.items()):
        frames, scene = frames_of(scenario)
        found[name] = rates(frames, sea)
        kelvin = apparent_temperature(frames[0].astype(np.float64), scene.view.band, scene.view.atmosphere.wavenumber_cm)
        limits = limits or tuple(np.quantile(kelvin, (0.01, 0.995)))
        axes = figure.add_subplot(grid[0, place])
        shown = axes.imshow(kelvin, cmap="gray", vmin=limits[0], vmax=limits[1], extent=box, aspect="auto", interpolation="nearest")
        mss = scene.view.slopes.mss
        axes.set(xlabel="azimuth [deg]", ylabel="elevation [deg]" if place == 0 else "", xlim=(azimuth[0], azimuth[-1]))
        axes.set_title(f"{name}: slope variance {mss:.3f}", fontsize=9)
    assert shown is not None
    figure.colorbar(shown, ax=figure.axes, extend="both", pad=0.01).set_label("apparent temperature [K]")
    drawn = np.array([rates(frames_of(scenario)[0], sea) for scenario in sea_draws(given, SEAS)])
    axes = figure.add_subplot(grid[1, :])
    colours = (COLOURS["elfouhaily"], COLOURS["asit-2019"], COLOURS["radyo-2008"])
    for row, threshold in enumerate(THRESHOLDS):
        low, high = np.quantile(drawn[:, row], (0.05, 0.95))
        axes.plot(
            [low, high], [row, row], color="0.7", lw=9.0, solid_capstyle="butt", label="5 to 95 % of the drawn seas" if row == 0 else None
        )
        axes.plot(
            drawn[:, row], np.full(SEAS, row), "|", color="0.3", ms=14, label=f"{SEAS} seas between the campaigns" if row == 0 else None
        )
        for (name, values), colour in zip(found.items(), colours, strict=True):
            axes.plot(values[row], row + 0.22, "v", color=colour, label=name if row == 0 else None)
        axes.plot(norm.sf(threshold), row, "x", color="tab:green", label="Gaussian noise" if row == 0 else None)
        print(f"{threshold:g} sigma: {low:.3g} to {high:.3g} of {SEAS} seas; " + ", ".join(f"{n} {v[row]:.3g}" for n, v in found.items()))
    axes.set(xlabel="false alarms per pixel and frame [1]", xscale="log", ylim=(-0.5, len(THRESHOLDS) - 0.3))
    axes.set_yticks(range(len(THRESHOLDS)), [f"{threshold:g} σ" for threshold in THRESHOLDS])
    axes.legend(fontsize=8, loc="center", bbox_to_anchor=(0.5, 0.5))
    return figure


def brightest() -> list[tuple[str, str, float, float, float]]:
    """Value and interval of the brightest glint of the default scenario: name, unit, value, low, high."""
    maps = mean(parse_scenario({}), sea_draws=TABLE_SEAS)
    glint: FloatArray = maps.glint_radiance.to_numpy()
    y, x = np.unravel_index(int(np.argmax(glint)), glint.shape)
    out = []
    for name, what, unit in (
        ("radiance", "mean radiance", "W m⁻² sr⁻¹"),
        ("apparent_temperature", "apparent temperature", "K"),
        ("glint_std", "standard deviation of glint in a pixel", "W m⁻² sr⁻¹"),
    ):
        value, low, high = (float(maps[each][y, x]) for each in (name, f"{name}_sea_low", f"{name}_sea_high"))
        out.append((what, unit, value, low, high))
    return out


def table() -> None:
    """Write the table of the page between its markers."""
    lines = ["| | as specified (Cox and Munk) | sea unknown, low | sea unknown, high |", "|---|---|---|---|"]
    lines += [f"| {what} [{unit}] | {value:.3g} | {low:.3g} | {high:.3g} |" for what, unit, value, low, high in brightest()]
    block = "\n".join(("<!-- begin brightest -->", "", *lines, "", "<!-- end brightest -->"))
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(re.sub(r"<!-- begin brightest -->.*?<!-- end brightest -->", lambda _: block, page, flags=re.DOTALL), encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    if sys.argv[1:] == ["table"]:
        table()
    else:
        save_named({"unknown_sea": unknown_sea, "three_seas": three_seas}, sys.argv[1:])
