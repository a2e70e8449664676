"""A few numbers of the documentation's tables computed again, within ten seconds of processor time each: for ``./run tables --check``.

Each function yields pairs of a line as printed and the same line as the code has it now. ``1.23 ± 0.02`` is a number with its standard
error, which for the new one is that of the fewer seas drawn here.
"""

from __future__ import annotations

import csv
import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation_tables import NotHereError, page_of

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
from tables import ROOT, block

Pairs = Iterator[tuple[str, str]]

EVERY = 25
"""Of the long files one row in so many."""
NORMAL = 1.96
"""Half the width of an interval of 95 % in standard errors [1]."""


def printed(name: str, page: str = "") -> list[str]:
    """Lines of a table as they stand on its page, of those of docs/validation if none is given."""
    return [line for line in block(f"{page or page_of(name).relative_to(ROOT)}#{name}")[1].group().splitlines() if line]


def cells(name: str, first: str, page: str = "") -> list[str]:
    """Cells of the row that begins with some text."""
    line = next(line for line in printed(name, page) if line.startswith(f"| {first} |"))
    return [cell.strip() for cell in line.strip("|").split("|")]


def data(name: str) -> list[dict[str, str]]:
    """Rows of a file of docs/data."""
    with (ROOT / "docs" / "data" / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def whole(name: str, lines: Iterable[str]) -> Pairs:
    """All lines of a table."""
    yield from zip(printed(name), (line for line in lines if line), strict=True)


def rows(name: str, made: Iterable[Sequence[str]]) -> Pairs:
    """Some rows of a table, found by their first cells."""
    for row in made:
        yield " | ".join(cells(name, row[0])), " | ".join(row)


def pages() -> Pairs:
    """Tables, lists and pictures that come from the code, all of them."""
    from page_tables import BLOCKS, written

    for place, make in BLOCKS.items():
        yield "\n".join(written(place)), "\n".join(make())


def air_differences() -> Pairs:
    """What today's absorption changes, all of it."""
    import air_differences as made

    for name, text in (("air-paths", made.paths_table()), ("air-skies", made.skies_table()), ("air-ranges", made.ranges_table())):
        yield from whole(name, text.splitlines())


def fitted_bands() -> Pairs:
    """Differences from RRTMGP's paths, all of them."""
    from fitted_bands import lines

    yield from whole("fitted-bands", lines())


def headline() -> Pairs:
    """The article's numbers, all of them."""
    from validation_tables import headline

    return whole("headline", headline())


def measured() -> Pairs:
    """Measured spectra beside ours, all of them."""
    from validation_tables import measured

    return whole("measured", measured())


def lowtran() -> Pairs:
    """Errors of the table over the reference cases."""
    from validation_tables import lowtran

    return whole("lowtran", lowtran())


def scattered() -> Pairs:
    """Errors of scattered sunlight over the reference cases."""
    from validation_tables import scattered

    return whole("scattered", scattered())


def emissivity() -> Pairs:
    """Largest differences from Wu and Smith."""
    from validation_tables import wu_smith

    return whole("emissivity", wu_smith())


def sea() -> Pairs:
    """Integrals of the spectra, and seas of 256 x 256 points."""
    from validation_tables import spectra, synthesised

    return rows("sea", [*spectra(), synthesised(256, 60)])


def second_order() -> Pairs:
    """Skewness and crests of drawn seas with bound waves."""
    from validation_tables import second_order

    return whole("second-order", second_order())


def buoy() -> Pairs:
    """The week of a buoy."""
    from validation_tables import buoy

    return whole("buoy", buoy())


def scenes() -> Pairs:
    """A flat sea, and one without waves that are geometry."""
    from validation_tables import all_in_facets, calm

    return rows("scenes", [calm(), all_in_facets(7.0)])


def horizon() -> Pairs:
    """Two Suns with a few seas each."""
    from near_horizon_table import near_horizon

    for zenith in (60.0, 80.0):
        old = [row for row in data("near_horizon") if float(row["solar_zenith_deg"]) == zenith]
        for row, new in zip(old, near_horizon(zenith, range(6)), strict=True):
            place = f"{zenith:g}°, {row['depression_deg']}°: glint"
            yield (
                f"{place} {row['glint_ratio']} ± {row['glint_standard_error']}, all {row['total_ratio']} ± {row['total_standard_error']}",
                f"{place} {new.sun:.4f} ± {new.sun_error:.4f}, all {new.total:.4f} ± {new.total_error:.4f}",
            )


def means_and_images() -> Pairs:
    """The largest departures of one wind and Sun."""
    from mean_against_images import scene

    wind, sun = 7.0, 80.0
    line = next(line for line in printed("means-and-images") if line.startswith(f"| {wind:g} m/s | {sun:g}° |"))
    towards, aside = (cell.strip() for cell in line.strip("|").split("|")[2:])
    found = {(row["azimuth_deg"], row["depression_deg"]): row for row in scene(wind, sun, 5)}
    radiance, glint = towards.split("; ")
    for text, azimuth in ((radiance, 0.0), (aside, 5.0)):
        row = found[azimuth, float(text.split(" at ")[1].strip("°"))]
        yield text, f"{row['radiance_ratio']:.3f} ± {row['radiance_error']:.3f} at {row['depression_deg']:g}°"
    row = found[0.0, float(glint.split(" at ")[1].strip("°"))]
    apart, error = ((row["glint_image"] - row["glint_mean"]) / row["glint_smith"], row["glint_error"] / row["glint_smith"])
    yield glint, f"{apart:+.3f} ± {error:.3f} at {row['depression_deg']:g}°"


def low_suns() -> Pairs:
    """The law over Smith's under low Suns, all of it."""
    from validation_tables import low_suns

    yield from whole("low-suns", low_suns())


def other_seas() -> Pairs:
    """What cannot be known, by the reference alone."""
    from validation_tables import other_seas

    yield from whole("other-seas", other_seas())


def nested() -> Pairs:
    """The law of nested bands over Smith's."""
    from nested_bands import law

    for line in printed("nested")[2:]:
        where, *values = (cell.strip() for cell in line.strip("|").split("|"))
        wind, depression = (float(part.split("m")[0].strip(" °")) for part in where.split(","))
        for zenith, value in zip((60.0, 77.0, 80.0, 85.0), values, strict=True):
            yield f"{where}, {zenith:g}°: {value.split(' / ')[0]}", f"{where}, {zenith:g}°: {law(wind, depression, zenith)[1]:.2f}"


def visibility() -> Pairs:
    """The isotropic sea, few rays; errors of the page's numbers as the text states them."""
    from visibility_ratio import SUN_ZENITHS, power_law_sea, ratios

    waves, slopes = power_law_sea()
    for depression in (3.0, 10.0):
        mean, error = ratios(waves, slopes, depression, seas=6, rays=500)
        values = [value.split(" (")[0] for value in cells("visibility", f"{depression:g}°")[1:]]
        for zenith, value, m, e in zip(SUN_ZENITHS, values, mean, error, strict=True):
            yield f"{depression:g}°, {zenith:g}°: {value} ± 0.008", f"{depression:g}°, {zenith:g}°: {m:.3f} ± {e:.3f}"


def sensor() -> Pairs:
    """Transfer functions against pyBSM, points, fields and temperatures."""
    from sensor_validation import energy, pybsm

    return rows("sensor", [*pybsm(), *energy()])


def textures() -> Pairs:
    """The last measured picture."""
    from seaglint.formats.recording import open_recording
    from texture_table import MEASURED, row

    if not os.environ.get("SEAGLINT_DATA_DIR"):
        raise NotHereError("SEAGLINT_DATA_DIR is not set")
    name, region = MEASURED[-1]
    picture = open_recording(Path(os.environ["SEAGLINT_DATA_DIR"]) / "imagery" / f"{name}.png", channel="mean")
    made, _, _ = row(name, region, picture, trend=True)
    # the last cell is of one sample of the fit, whose draw depends on signs that linear algebra leaves open: it differs by machine
    kept = range(9)
    old = cells("textures", name)
    return iter([(" | ".join(old[i] for i in kept), " | ".join(made[i] for i in kept))])


def measured_field() -> Pairs:
    """The closed form of one packaged sea, and the cells."""
    import measured_sparkle as made

    radius, wind = made.RADII[1], made.RADYO_WINDS[0]
    rows = made.data("measured_sparkle")
    covariance = made.of_waves(made.campaign_spectrum("radyo-2008", wind, 0.5 * np.pi))
    share = float(made.values(rows, round(1e3 * radius), "measured")[0])
    for what, lit in ((f"radyo-2008, {wind:g} m/s, closed form", made.closed(covariance, radius)), ("cells of 2.6 mm", made.cells(share))):
        new = next(made.numbers(radius, what, 0, lit))
        old = made.values(rows, round(1e3 * radius), what)
        yield f"{what}: " + ", ".join(f"{v:.3g}" for v in old), f"{what}: " + ", ".join(f"{new[name]:.3g}" for name in made.NAMES)


def mean_slopes() -> Pairs:
    """The nearest wind."""
    import measured_sparkle as made

    rows = made.data("mean_slopes")
    away = made.departures(rows)
    wind = min(away, key=lambda one: away[one])
    waves = made.ShortWaves.of_spectrum(made.campaign_spectrum("asit-2019", float(wind), 0.0), 0.0)
    new, _ = made.of_sea(waves, made.footprint(), 0.0, 0.0333 * np.arange(4096))
    for old, value in zip(made.line_of(rows, "asit-2019", wind), new, strict=True):
        yield f"{wind} m/s: {old:.3f}", f"{wind} m/s: {value:.3f}"


def false_alarms() -> Pairs:
    """One sea, with the intervals of the rates as errors."""
    from false_alarm_table import rates

    wind, sun = 5.0, 60.0
    old = [row for row in data("false_alarms") if (float(row["wind_speed_m_s"]), float(row["solar_zenith_deg"])) == (wind, sun)]
    for row, new in zip(old, rates(wind, sun, 2), strict=True):
        before = {key: float(value) for key, value in row.items()}
        place = f"{wind:g} m/s, {sun:g}°, {before['near_m']:.0f} m, {before['threshold_sigma']:g} sigma:"
        steep = (f"slope {one['mirroring_over_rms_slope']:.4g}" for one in (before, new))
        yield tuple(f"{place} {slope}, {with_error(one, 'rate_low', 'rate_high')}" for slope, one in zip(steep, (before, new), strict=True))


def with_error(row: dict[str, Any], low: str = "low", high: str = "high") -> str:
    """A rate with half its interval as a standard error; without an interval half the rate."""
    ends = np.array([row[low], row[high]], dtype=np.float64)
    error = np.ptp(ends) / (2.0 * NORMAL) if np.isfinite(ends).all() else 0.5 * row["rate"]
    return f"{row['rate']:.6f} ± {error:.6f}"


def corridors() -> Pairs:
    """Verdicts on the measured pictures, all of them."""
    from corridor_verdicts import measured

    lines = measured()
    if lines is None:
        raise NotHereError("the measured pictures are not here")
    yield from whole("corridor-pictures", lines)


def scattered_background() -> Pairs:
    """Apparent temperatures of the sea without glint."""
    from scattered_figures import background_of

    return rows("scattered-background", [(name, *(f"{t:.2f} K" for t in background_of(name == "with"))) for name in ("without", "with")])


def rates() -> Pairs:
    """One frame of one sensor, with intervals as errors."""
    from sensor_rates import SENSORS, rows_of

    name = next(iter(SENSORS))
    old = [row for row in data("sensor_rates") if row["sensor"] == name]
    for row, new in zip(old, rows_of(name, SENSORS[name], 1), strict=True):
        place = ", ".join((name, row["picture"], row["region"], row["threshold_sigma"]))
        before = {key: float(row[key]) for key in ("rate", "low", "high")}
        yield f"{place}: {with_error(before)}", f"{place}: {with_error(new)}"


def object_sizes() -> Pairs:
    """The change that the mirror image of the first object makes, at its farthest place."""
    from object_sizes import THINGS, mirrored, view_of

    thing = THINGS[0]
    row = next(line for line in printed("sizes", "docs/guide/objects.md") if line.startswith(f"| | {thing.before[-1]:g} m |"))
    yield row.split("|")[3].strip(), f"{mirrored(view_of(), thing, thing.before[-1]):+.3f}"


def against_lowtran7() -> Pairs:
    """Some cases of the file of slant paths."""
    from validation_plots import BANDS, QUANTITIES
    from validation_tables import lowtran_case

    for row in data("against_lowtran7")[::EVERY]:
        for low, high in BANDS:
            tau, path, sun, _, sky = lowtran_case(row, (low, high))
            for name, ours in zip(QUANTITIES, (tau, path, sun, sky), strict=True):
                column = f"{name}[{low:g}-{high:g}]:seaglint"
                yield f"{column}: {row[column]}", f"{column}: {ours:.6g}"


def against_scattered() -> Pairs:
    """Scattered sunlight of the reference cases."""
    from seaglint.formats.tables.input_tables import read_cases
    from seaglint.studies.mean.evaluate_cases import evaluate_scattered, parse_bands
    from validation_tables import folder

    cases = read_cases(folder("SEAGLINT_REFERENCE_DIR") / "lowtran7_scattered.csv")
    ours = np.asarray(evaluate_scattered(cases, parse_bands(["3.5-5.0"]))["scattered_W_m2_sr[3.5-5.0]"])
    for number, (row, value) in enumerate(zip(data("against_scattered"), ours, strict=True)):
        yield f"case {number}: {row['scattered:seaglint']}", f"case {number}: {value:.6g}"


def against_wu_smith() -> Pairs:
    """Some of the emissivities."""
    from seaglint.facet.emissivity import emissivity
    from seaglint.optics.sea_water import hale_querry_sea
    from seaglint.sea.slopes.cox_munk import cox_munk_isotropic

    for row in data("against_wu_smith")[::EVERY]:
        wavelength, wind, angle = (float(row[key]) for key in ("wavelength_um", "wind_speed_m_s", "zenith_deg"))
        ours = emissivity(np.radians([angle]), cox_munk_isotropic(wind, height=12.5), hale_querry_sea(), 1e4 / wavelength)[0, 0]
        place = f"{wavelength:g} µm, {wind:g} m/s, {angle:g}°:"
        yield f"{place} {row['emissivity:seaglint']}", f"{place} {ours:.6g}"
