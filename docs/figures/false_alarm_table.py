"""Recompute the tables of false alarms in rendered seas in docs/validation/clutter.md, and docs/data/false_alarms.csv.

    python docs/figures/false_alarm_table.py            4 frames of each sea, some minutes on two cores
    python docs/figures/false_alarm_table.py 12         more frames, narrower intervals
    python docs/figures/false_alarm_table.py table1     Table 1 alone

First Table 1 itself, then the rates against wind, Sun and range. The scene is that of ``seaglint reproduce table1`` at other winds and
Suns; its frames lie a second apart. Rates are those of the corridor in three bands of rows, each with its own standard deviation.
"""

from __future__ import annotations

import sys
from itertools import pairwise

import numpy as np

from seaglint.analysis.analyze_recording import ALWAYS
from seaglint.base.conventions import surface_range
from seaglint.clutter.false_alarms import FalseAlarmRate, FalseAlarms
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.facet.sea_view import SeaView
from seaglint.formats.tables.table_text import write_columns
from seaglint.imaging.camera.imager import Camera
from seaglint.studies.article.headline import ArticleRow
from seaglint.studies.article.table1 import BLURS_PX, corridor, scene, sequence, table1
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence
from validation_tables import DOCS, table, write_table

WINDS = (2.0, 5.0, 10.0)
SUNS = (50.0, 60.0, 70.0)
BANDS = 3
APART = 1.0  # s; waves of half a metre are forgotten within a tenth of it
OUTPUT = DOCS / "data" / "false_alarms.csv"

Row = dict[str, float]


def rates(wind: float, sun: float, frames: int) -> list[Row]:
    """Rates of one sea, a row for each band and threshold, far to near."""
    run, camera = prepare_sequence(scene(wind, sun)), scenario_physics.camera(scene(wind, sun))
    mask, steep = corridor(run.scene.view, camera), steepness(run.scene.view, camera, sun)
    filtered = Laplacian().apply(sequence(run.scene, APART * np.arange(frames)))
    edges = np.linspace(0, camera.rows, BANDS + 1).astype(int)
    found = []
    for first, last in pairwise(edges):
        band = np.zeros_like(mask)
        band[first:last] = mask[first:last]
        alarms = FalseAlarms(ALWAYS)
        alarms.add(standardise(filtered, band))
        depression = np.array([-camera.top + camera.row_step * row for row in (first, last)])
        far, near = surface_range(camera.height, depression)
        shares = {
            f"resolved_share_{way}": float(run.layout.attributes[f"resolved_mss_{way}"])
            / float(run.layout.attributes[f"resolved_mss_{way}"] + run.layout.attributes[f"facet_mss_{way}"])
            for way in ("up", "cross")
        }
        for rate in alarms.rates():
            place = {"wind_speed_m_s": wind, "solar_zenith_deg": sun, "mirroring_over_rms_slope": steep, "near_m": near, "far_m": far}
            found.append({**place, **shares, **numbers(rate)})
    return found


def steepness(view: SeaView, camera: Camera, solar_zenith_deg: float) -> float:
    """Slope that mirrors the Sun into the middle of the image, in rms slopes along the line of sight [1]."""
    slopes = view.slopes
    tilt = 0.5 * (0.5 * np.pi - np.radians(solar_zenith_deg) + camera.elevation)
    turn = camera.azimuth - slopes.wind_to_azimuth
    variance = slopes.mss_up * np.cos(turn) ** 2 + slopes.mss_cross * np.sin(turn) ** 2
    return float(np.tan(tilt) / np.sqrt(variance))


def numbers(rate: FalseAlarmRate) -> Row:
    """What the file keeps of a rate."""
    low, high = (np.nan if end is None else end for end in (rate.rate_low, rate.rate_high))
    return {
        "threshold_sigma": rate.threshold_sigma,
        "rate": rate.rate,
        "rate_low": low,
        "rate_high": high,
        "gaussian_rate": rate.gaussian_rate,
        "times_gaussian": rate.ratio,
    }


def cell(rows: list[Row]) -> str:
    """Times Gaussian at both thresholds."""
    return " / ".join(f"{row['times_gaussian']:.2g}" for row in rows)


def main(frames: str = "4") -> None:
    """Compute, write the file and the table."""
    write_table1(table1().rows())
    if frames == "table1":
        return
    rows: list[Row] = []
    for wind in WINDS:
        for sun in SUNS:
            rows += rates(wind, sun, int(frames))
            print(f"{wind:g} m/s, Sun {sun:g} deg:", [round(row["times_gaussian"], 2) for row in rows[-2 * BANDS :]], flush=True)
    write_columns({key: np.array([row[key] for row in rows]) for key in rows[0]}, OUTPUT, overwrite=True)
    write_rates(rows)


def write_table1(rows: dict[str, ArticleRow]) -> None:
    """Put Table 1 between its markers: the article's number / as rendered / through the detector, other blurs, and sparkle by waves."""

    def all_of(key: str, style: str, heads: tuple[str, ...] = ("article", "as rendered", "detector")) -> str:
        numbers = rows[key].numbers
        return " / ".join("-" if numbers[head] is None else f"{numbers[head]:{style}}" for head in heads)

    def ends(key: str, which: str) -> str:
        found = rows[key].settings[which]
        return "not determined" if found is None else " to ".join(f"{end:.2g}" for end in found)

    head = ("article / as rendered / through the detector", "false-alarm rate", "95 % intervals", "times Gaussian", "correlation time [s]")
    body, blurs, waves = [], [], []
    both = ("waves", "waves, detector")
    for region in ("glint", "background"):
        for sigma in ("3", "3.5"):
            name = f"{region}_{sigma}_sigma"
            rate, ratio, time = (f"{what}_{name}" for what in ("rate", "times_gaussian", "correlation_time"))
            intervals = "; ".join(ends(rate, which) for which in ("interval_95", "detector_interval_95"))
            body.append((f"{region}, {sigma} sigma", all_of(rate, ".2g"), intervals, all_of(ratio, ".2g"), all_of(time, ".2f")))
            intervals = "; ".join(ends(rate, which) for which in ("waves_interval_95", "waves_detector_interval_95"))
            cells = (all_of(rate, ".2g", both), intervals, all_of(ratio, ".2g", both), all_of(time, ".2f", both))
            waves.append((f"{region}, {sigma} sigma", *cells))
            pairs = zip(rows[ratio].settings.values(), rows[time].settings.values(), strict=True)
            sharp = f"{rows[ratio].ours:.2g} / {rows[time].ours:.2f}"
            blurs.append((f"{region}, {sigma} sigma", sharp, *(f"{times:.2g} / {seconds:.2f}" for times, seconds in pairs)))
    put("table1", list(table(head, body)))
    put("table1-blur", list(table(("times Gaussian / correlation time [s]", "none", *(f"{blur:g} px" for blur in BLURS_PX)), blurs)))
    put("table1-waves", list(table(("as rendered / through the detector", *head[1:]), waves)))


def put(name: str, lines: list[str]) -> None:
    """Print a table and write it into the page."""
    print(*lines, sep="\n")
    write_table(name, lines)


def write_rates(rows: list[Row]) -> None:
    """Put the table between its markers."""
    bands = sorted({(row["near_m"], row["far_m"]) for row in rows})
    head = ("wind", "Sun's zenith angle", "mirroring / rms slope", *(f"{near / 1e3:.2g}-{far / 1e3:.2g} km" for near, far in bands))
    body = []
    for wind in WINDS:
        for sun in SUNS:
            own = [row for row in rows if (row["wind_speed_m_s"], row["solar_zenith_deg"]) == (wind, sun)]
            cells = (cell([row for row in own if (row["near_m"], row["far_m"]) == band]) for band in bands)
            body.append((f"{wind:g} m/s", f"{sun:g}°", f"{own[0]['mirroring_over_rms_slope']:.1f}", *cells))
    put("false-alarms", list(table(head, body)))


if __name__ == "__main__":
    main(*sys.argv[1:])
