"""Recompute the tables of foam in docs/validation/clutter.md, and docs/data/foam_alarms.csv.

    python docs/figures/foam_statistics.py            50 frames of each sea, half an hour on two cores
    python docs/figures/foam_statistics.py 8          8 frames, of which the rates alone are of use

The scene is that of ``seaglint reproduce table1`` at other winds, in two bands, with and without ``[sea.foam]`` over the same waves, and
counted in the same manner. Beside its two regions, the glint corridor and the rest of the picture, is a picture away from the Sun.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.scene import image
from seaglint.optics.band import apparent_temperature
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.sea_tables import Foam
from seaglint.studies.article.table1 import ARTICLE, BLUR_PX, FRAME_RATE, FRAMES, MARGIN, corridor, detector, scene
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence
from validation_tables import DOCS, table, write_table

WINDS = (8.0, 14.0)
BANDS = ((3.5, 5.0), (8.0, 12.0))
TOWARDS, AWAY = 180.0, 0.0  # azimuths of the sensor [deg]; the Sun is in the south
SIGMAS = (3.0, 3.5)
INNER = np.s_[MARGIN:-MARGIN, MARGIN:-MARGIN]
OUTPUT = DOCS / "data" / "foam_alarms.csv"

Row = dict[str, Any]
Mask = NDArray[np.bool_]
Pictures = NDArray[np.float32]


class Place(NamedTuple):
    """Where and in which light a row is counted."""

    band: tuple[float, float]
    wind: float
    region: str

    def __str__(self) -> str:
        return f"{self.band[0]:g}-{self.band[1]:g} µm, {self.wind:g} m/s, {self.region}"


def foam_scene(band: tuple[float, float], wind: float, azimuth: float, foam: bool, frames: int) -> Scenario:
    """Table 1's scene in a band, at a wind, towards an azimuth [deg], with or without foam."""
    plain = scene(wind, frames=frames, margin=MARGIN, sensor={"azimuth_deg": azimuth})
    return plain.model_copy(
        update={
            "band": plain.band.model_copy(update={"min_um": band[0], "max_um": band[1]}),
            "sea": plain.sea.model_copy(update={"foam": Foam() if foam else None}),
            "render": plain.render.model_copy(update={"layers": ("foam_share",) if foam else ()}),
        }
    )


def pictures(scenario: Scenario, *layers: str) -> tuple[SeaView, *tuple[Pictures, ...]]:
    """The view of a scene and layers of its frames [(frames, rows, columns)], with the margin."""
    prepared = prepare_sequence(scenario).scene
    drawn = [image(prepared, prepared.pose, frame / FRAME_RATE) for frame in range(scenario.sensor.frames)]
    return prepared.view, *(np.stack([one[layer] for one in drawn]) for layer in layers)


def counted(place: Place, frames: Pictures, mask: Mask, foam: bool, sensed: bool) -> Iterator[Row]:
    """Rates and correlation times of a region at every threshold, without pixels at the border."""
    laplacian = Laplacian()
    edge = laplacian.margin
    inner = np.s_[edge:-edge, edge:-edge]
    alarms = FalseAlarms(SIGMAS)
    alarms.add(standardise(laplacian.apply(frames)[:, *inner], mask[inner]))
    for rate in alarms.rates():
        yield {
            "band_um": f"{place.band[0]:g}-{place.band[1]:g}",
            "wind_speed_m_s": place.wind,
            "region": place.region,
            "foam": foam,
            "through_detector": sensed,
            "threshold_sigma": rate.threshold_sigma,
            "rate": rate.rate,
            "rate_low": rate.rate_low,
            "rate_high": rate.rate_high,
            "times_gaussian": rate.ratio,
            "correlation_time_s": None if rate.correlation_time is None else rate.correlation_time / FRAME_RATE,
        }


def contrast(place: Place, view: SeaView, water: Pictures, foamy: Pictures, share: Pictures) -> tuple[str, ...]:
    """Row of the contrast from a region's pixels [(frames, pixels)]: share, water, its variation, and the difference of a pixel of foam."""
    mean = float(water.mean())
    # the difference is proportional to the share, so that the sums give the difference of a pixel that is all foam
    full = float((foamy - water).sum() / share.sum())
    levels = np.array([mean, mean + float(water.std(axis=1).mean()), mean + full])
    cold, spread, foam = apparent_temperature(levels, view.band, view.atmosphere.wavenumber_cm)
    return (str(place), f"{100.0 * share.mean():.2f} %", f"{cold:.1f} K", *(f"{1e3 * (one - cold):.0f} mK" for one in (spread, foam)))


def of_picture(band: tuple[float, float], wind: float, azimuth: float, frames: int) -> tuple[list[Row], list[tuple[str, ...]]]:
    """Rates of one picture's regions with and without foam, and their contrasts."""
    wide = foam_scene(band, wind, azimuth, False, frames)
    view, water = pictures(wide, "radiance")
    _, foamy, share = pictures(foam_scene(band, wind, azimuth, True, frames), "radiance", "foam_share")
    if azimuth == TOWARDS:
        glint = corridor(view, scenario_physics.camera(wide))[INNER]
        regions = {"glint": glint, "background": ~glint}
    else:
        regions = {"away from the Sun": np.ones(water.shape[1:], np.bool_)[INNER]}
    sensor = detector(BLUR_PX)
    rows, contrasts = [], []
    for region, mask in regions.items():
        place = Place(band, wind, region)
        for foam, seen in ((False, water), (True, foamy)):
            for sensed in (False, True):
                found = (sensor.focal_plane(seen) if sensed else seen)[:, *INNER]
                rows += counted(place, found, mask, foam, sensed)
        own = [one[:, *INNER][:, mask] for one in (water, foamy, share)]
        contrasts.append(contrast(place, view, *own))
    return rows, contrasts


def alarms_table(rows: list[Row], sensed: bool) -> list[str]:
    """Table of rates and times with and without foam, under the article's."""

    def both(values: list[float | None], style: str) -> str:
        return " / ".join("-" if value is None else f"{value:{style}}" for value in values)

    body = []
    for region, article in ARTICLE.items():
        rates, times = ([article[sigma][i] for sigma in SIGMAS] for i in range(2))
        body.append((f"the article, {region}", both(rates, ".2g"), "", both(times, ".2f"), ""))
    places = dict.fromkeys((row["band_um"], row["wind_speed_m_s"], row["region"]) for row in rows)
    for band, wind, region in places:
        cells = []
        for key, style in (("rate", ".2g"), ("correlation_time_s", ".2f")):
            for foam in (False, True):
                own = [row for row in rows if (row["band_um"], row["wind_speed_m_s"], row["region"]) == (band, wind, region)]
                cells.append(both([row[key] for row in own if row["foam"] == foam and row["through_detector"] == sensed], style))
        body.append((f"{band} µm, {wind:g} m/s, {region}", *cells))
    head = ("at 3 / 3.5 sigma", "rate", "with foam", "correlation time [s]", "with foam")
    return list(table(head, body))


def main(frames: str = str(FRAMES)) -> None:
    """Render, count, and write the file and the tables."""
    rows: list[Row] = []
    contrasts: list[tuple[str, ...]] = []
    for band in BANDS:
        for wind in WINDS:
            for azimuth in (TOWARDS, AWAY):
                found, more = of_picture(band, wind, azimuth, int(frames))
                rows, contrasts = rows + found, contrasts + more
                print(*more, sep="\n", flush=True)
    with OUTPUT.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: f"{value:.5g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows)
    head = ("scene", "foam in the picture", "water", "its standard deviation", "foam less water")
    for name, lines in (
        ("foam-rendered", alarms_table(rows, False)),
        ("foam-detector", alarms_table(rows, True)),
        ("foam-contrast", list(table(head, contrasts))),
    ):
        print(*lines, sep="\n")
        write_table(name, lines)


if __name__ == "__main__":
    main(*sys.argv[1:])
