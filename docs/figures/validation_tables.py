"""Recompute the tables of docs/validation, each between its two markers, from the package itself.

    python docs/figures/validation_tables.py               all tables
    python docs/figures/validation_tables.py headline sea  some of them

The tables ``lowtran``, ``scattered``, ``emissivity``, ``low-suns`` and ``other-seas`` need the reference tables, ``buoy`` the measured
waves of ``data_folders.py``; without them they stay as they are.
"""

from __future__ import annotations

import csv
import json
import math
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from seaglint.air.lowtran_table import BatchAtmosphere, models
from seaglint.base.conventions import FloatArray
from seaglint.facet.emissivity import emissivity
from seaglint.formats.tables.input_tables import read_cases
from seaglint.optics.band import Band
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.sea.second_order import bound_limit, bound_skewness
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.spectra.pierson_moskowitz import PiersonMoskowitzSpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField
from seaglint.sea.wave_record import WaveRecord
from seaglint.studies.build import scenario_physics
from seaglint.studies.mean.evaluate_cases import evaluate_scattered, parse_bands
from seaglint.studies.measured.measured_numbers import MeasuredRow
from seaglint.studies.sequence.render_sequence import prepare_sequence

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
from data_folders import data_folder

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

Lines = Iterator[str]


class NotHereError(Exception):
    """The table's data are not on this machine."""


def folder(variable: str) -> Path:
    """Folder named by an environment variable, or found beside the repository."""
    if found := data_folder(variable):
        return found
    raise NotHereError(f"{variable} is not set")


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> Lines:
    """Markdown table."""
    for row in (head, ("---",) * len(head), *rows):
        yield "| " + " | ".join(row) + " |"


def headline() -> Lines:
    """The article's numbers beside ours."""
    command = [sys.executable, "-m", "seaglint.cli.app", "reproduce", "headline", "--json"]
    rows = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    common: dict[str, object] = {}
    for row in rows.values():
        if "atmosphere" in row["settings"]:
            common = {k: v for k, v in row["settings"].items() if k in ("atmosphere", "band_um", "slopes", "background", "water")}
    body = []
    for key, row in rows.items():
        settings = "; ".join(f"{k} {v}" for k, v in row["settings"].items() if k not in common or common[k] != v)
        body.append((f"`{key}`", f"{row['article']:g}", f"{row['ours']:.4g}", row["unit"], settings))
    yield from table(("row", "article", "here", "unit", "settings"), body)
    yield ""
    yield "The three rows of glint share: " + "; ".join(f"{k} {v}" for k, v in common.items()) + "."


def lowtran() -> Lines:
    """Medians and 95th percentiles of the table's error over the reference cases."""
    names = {
        "tau_mean": "path transmittance",
        "path_radiance_W_m2_sr": "path radiance",
        "sun_normal_irradiance_W_m2": "Sun at the sea",
        "sun_times_tau_W_m2": "Sun times path, per wavenumber",
        "sky_radiance_W_m2_sr": "sky from the sea",
    }
    with (folder("SEAGLINT_REFERENCE_DIR") / "lowtran7_slant_paths.csv").open() as file:
        cases = [row for row in csv.DictReader(file) if row["atmosphere"] in models()]
    bands = ((3.0, 5.0), (3.5, 5.0), (8.0, 12.0))
    found = {}
    for edges in bands:
        ours = np.array([lowtran_case(row, edges) for row in cases])
        theirs = np.array([[float(row[f"{name}[{edges[0]:.1f}-{edges[1]:.1f}]"]) for name in names] for row in cases])
        relative = 100.0 * np.abs(ours / theirs - 1.0)
        found[edges] = np.median(relative, axis=0), np.percentile(relative, 95.0, axis=0)
    head = (f"{len(cases)} cases, error in %: median / 95 %", *(f"{low:g}-{high:g} µm" for low, high in bands))
    rows = [(label, *(f"{found[edges][0][i]:.2g} / {found[edges][1][i]:.2g}" for edges in bands)) for i, label in enumerate(names.values())]
    yield from table(head, rows)


def scattered() -> Lines:
    """Medians, 95th percentiles and largest errors of scattered sunlight over the reference cases."""
    path = folder("SEAGLINT_REFERENCE_DIR") / "lowtran7_scattered.csv"
    labels = ("2.0-2.4", "3.0-5.0", "3.5-5.0", "3.5-4.2")
    with path.open() as file:
        cases = list(csv.DictReader(file))
    ours = evaluate_scattered(read_cases(path), parse_bands(labels))
    sun = np.array([float(row["solar_zenith_deg"]) for row in cases])
    body = []
    for label in labels:
        light, warmth = (np.array([float(row[f"{name}_W_m2_sr[{label}]"]) for row in cases]) for name in ("scattered", "thermal"))
        relative = 100.0 * np.abs(np.asarray(ours[f"scattered_W_m2_sr[{label}]"]) / light - 1.0)
        cells = []
        for rows in (light > 0.01 * (light + warmth), (light > 0.01 * (light + warmth)) & (sun > 80.0)):
            median, most = np.percentile(relative[rows], (50.0, 95.0))
            cells += [str(np.count_nonzero(rows)), f"{median:.2g} / {most:.2g} / {relative[rows].max():.2g}"]
        body.append((f"{label} µm", *cells))
    yield from table(("error in %: median / 95 % / largest", "cases", "all Suns", "cases", "Sun beyond 80°"), body)


def lowtran_case(row: dict[str, str], edges: tuple[float, float]) -> list[float]:
    """What our table says to one reference case."""
    wind, height, depression, sun_zenith, sky_zenith = (
        float(row[key]) for key in ("wind_speed_m_s", "sensor_height_m", "depression_deg", "solar_zenith_deg", "sky_zenith_deg")
    )
    air = BatchAtmosphere.load(row["atmosphere"], edges)
    weights = Band.rectangular(*edges).weights(air.wavenumber_cm)
    tau, path = air.path([wind], [height], np.radians([depression]))
    sun, sky = air.solar_irradiance([wind], np.radians([sun_zenith])), air.sky_radiance([wind], np.radians([sky_zenith]))
    return [float(value[0] @ weights) for value in (tau / weights.sum(), path, sun, sun * tau, sky)]


def wu_smith() -> Lines:
    """Largest difference to Wu and Smith's emissivities, by wavelength."""
    lines = (folder("SEAGLINT_REFERENCE_DIR") / "emissivity_wu_smith.csv").read_text(encoding="utf-8").splitlines()
    worst: dict[float, float] = {}
    winds: set[float] = set()
    for row in csv.DictReader(line for line in lines if not line.startswith("#")):
        wavelength, wind = float(row["wavelength_um"]), float(row["wind_m/s"])
        angles = [int(key[2:]) for key, value in row.items() if key.startswith("e_") and value and int(key[2:]) <= 65]
        slopes = cox_munk_isotropic(wind, height=12.5)
        ours = emissivity(np.radians(angles), slopes, hale_querry_sea(), 1e4 / wavelength)[:, 0]
        difference = float(np.max(np.abs(ours - [float(row[f"e_{angle}"]) for angle in angles])))
        worst[wavelength] = max(worst.get(wavelength, 0.0), difference)
        winds.add(wind)
    head = (f"wavelength, winds {min(winds):g}-{max(winds):g} m/s, 0-65°", "largest difference")
    yield from table(head, [(f"{wavelength:g} µm", f"{value:.5f}") for wavelength, value in sorted(worst.items())])


LOW_SUNS = ("1", "2", "3", "5", "10")
LOW_VIEWS = ("0.5", "1", "2", "5", "10")


def low_sun_rows(case: str) -> dict[tuple[str, str], float]:
    """Shares seen and lit over Smith's of a case of the table of low Suns, by depression and elevation [1]."""
    with (folder("SEAGLINT_REFERENCE_DIR") / "low_sun.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["case"] == case]
    return {(row["view_depression_deg"], row["sun_elevation_deg"]): float(row["lit_and_seen_over_smith"]) for row in rows}


def low_suns() -> Lines:
    """Facets seen and lit over Smith's law under low Suns: ours and brute force."""
    from hidden_facets import SunLook, of_law, of_smith

    rows = []
    for wind in (2, 5, 7):
        wanted, slopes = low_sun_rows(f"U{wind} elf iso 1cm"), cox_munk_isotropic(float(wind))
        for view in LOW_VIEWS:
            looks = [SunLook(math.radians(float(view)), math.radians(float(sun))) for sun in LOW_SUNS]
            ours = [of_law(look, slopes) / of_smith(look, slopes) for look in looks]
            pairs = [f"{share:#.2g} / {wanted[view, sun]:#.2g}" for share, sun in zip(ours, LOW_SUNS, strict=True)]
            rows.append((f"{wind} m/s, {view}°", *pairs))
    yield from table(("wind, view below the horizon", "Sun 1° high", *(f"{sun}°" for sun in LOW_SUNS[1:])), rows)


OTHER_SEAS = {
    "waves to 10 cm": "U7 elf iso 10cm",
    "to 3 cm": "U7 elf iso 3cm",
    "to 3 mm": "U7 elf iso 3mm",
    "waves spread by cos²": "U7 elf cos2 1cm",
    "sharper crests": "U7 elf iso 1cm choppy>0.5m",
    "Phillips' spectrum": "U7 phil iso 1cm",
}


def other_seas() -> Lines:
    """Brute force for other seas of the same slope variance over that for Elfouhaily's down to 1 cm, 7 m/s."""
    places = (("1", "1"), ("1", "2"), ("2", "2"), ("2", "5"), ("5", "5"), ("5", "10"))
    base = low_sun_rows("U7 elf iso 1cm")
    rows = []
    for name, case in OTHER_SEAS.items():
        found = low_sun_rows(case)
        rows.append((name, *(f"{found[place] / base[place]:.2f}" for place in places)))
    yield from table(("sea", *(f"view {view}°, Sun {sun}°" for view, sun in places)), rows)


def sea() -> Lines:
    """Integrals of the spectra against published values, and synthesised seas against their integrals."""
    head = ("spectrum: here (independent integration)", "Hs [m]", "slope variance", "of waves above 1 m")
    yield from table(head, list(spectra()))
    yield ""
    rows = [synthesised(n, seas) for n, seas in ((256, 60), (512, 16), (1024, 5))]
    yield from table(("synthesised / integral of the spectrum", "Hs", "upwind slope variance", "crosswind"), rows)


def spectra() -> Iterator[tuple[str, ...]]:
    """Integrals of the spectra, beside published values."""
    published = {5.0: ("0.65", "0.0323", "0.0143"), 10.0: ("2.64", "0.0624", "0.0223"), 15.0: ("5.94", "0.0855", "0.0260")}
    for wind, (height, slopes, long_slopes) in published.items():
        spectrum = ElfouhailySpectrum(wind)
        total = sum(spectrum.mss(spectrum.wavenumber_range[1]))
        yield (
            f"Elfouhaily, {wind:g} m/s",
            f"{spectrum.significant_height():.3f} ({height})",
            f"{total:.4f} ({slopes})",
            f"{sum(spectrum.mss(2.0 * np.pi)):.4f} ({long_slopes})",
        )
    height = PiersonMoskowitzSpectrum(10.0).significant_height()
    yield "Pierson-Moskowitz, 10 m/s at 19.5 m", f"{height:.3f} (2.13)", "", ""


def synthesised(n: int, seas: int) -> tuple[str, ...]:
    """Seas of three tiles of n x n points over the integrals of their spectrum."""
    spectrum = ElfouhailySpectrum(10.0, np.radians(60.0))
    tiles = plan_tiles(spectrum, 0.5, n)
    field = WaveField.create(spectrum, tiles, 0)
    found = np.array([realisation(field.reseeded(seed), 10.0 * seed) for seed in range(seas)])
    expected = np.array([spectrum.height_variance(tiles[-1].k_max), *spectrum.mss(tiles[-1].k_max)])
    mean, error = found.mean(axis=0) / expected, found.std(axis=0, ddof=1) / np.sqrt(seas) / expected
    mean[0], error[0] = np.sqrt(mean[0]), 0.5 * error[0]
    return f"3 tiles of {n}², {seas} seas", *(f"{m:.4f} ± {e:.4f}" for m, e in zip(mean, error, strict=True))


def realisation(field: WaveField, time: float) -> tuple[float, float, float]:
    """Variance of height, upwind and crosswind slope of one synthesised sea, from its lattices."""
    s, c = np.sin(field.spectrum.wind_to_azimuth), np.cos(field.spectrum.wind_to_azimuth)
    height = up = cross = 0.0
    for lattice in field.surfaces(time):
        z, east, north = (lattice[..., i].astype(float) for i in range(3))
        height += float(np.mean(z**2))
        up += float(np.mean((east * s + north * c) ** 2))
        cross += float(np.mean((east * c - north * s) ** 2))
    return height, up, cross


def second_order() -> Lines:
    """Skewness of drawn seas of second order beside the integral over pairs of waves, and crests beside Tayfun's distribution."""
    seas: dict[str, DirectionalSpectrum] = {
        "Pierson-Moskowitz, 10 m/s": PiersonMoskowitzSpectrum(10.0),
        "Elfouhaily, 10 m/s": ElfouhailySpectrum(10.0),
    }
    for height, period, spreading in ((1.8, 9.0, 30.0), (7.0, 11.0, 10.0), (7.0, 11.0, 30.0), (7.0, 11.0, 45.0), (7.0, 10.0, 30.0)):
        name = f"JONSWAP, {height:g} m, {period:g} s, {spreading:g}°"
        seas[name] = JonswapSpectrum(height, period, 0.0, 3.3, float(np.radians(spreading)))
    rows, crests = [], []
    for name, spectrum in seas.items():
        bound = bound_limit(spectrum)
        field = WaveField.create(spectrum, plan_tiles(spectrum, 2.0, 256, bound=bound), 0, bound=bound)
        bound = min(bound, field.tiles[0].k_max)
        all_pairs, pairs = bound_skewness(spectrum), bound_skewness(spectrum, bound)
        found = np.array([moments_added(field.only(0).reseeded(seed)) for seed in range(80)])
        third = found[:, 0] / spectrum.height_variance() ** 1.5
        rows.append(
            (
                name,
                f"{all_pairs:.3f}",
                f"{bound / spectrum.peak_wavenumber:.1f}",
                f"{pairs:.3f}",
                f"{bound_skewness(spectrum, bound, exact=False):.3f}",
                f"{third.mean():.3f} ± {third.std(ddof=1) / np.sqrt(third.size):.3f}",
                f"{100.0 * found[:, 1].mean() / spectrum.height_variance():+.1f} %",
                f"{100.0 * found[:, 2].mean() / sum(field.resolved_mss()):+.1f} %",
            )
        )
        crests.append((name, *crest_heights(spectrum, bound, pairs / 3.0)))
    head = ("sea", "all pairs", "waves up to [peak]", "pairs of them", "weights of lattices", "drawn", "height variance", "slope variance")
    yield from table(head, rows)
    yield ""
    yield from table(("crest over Hs exceeded by one wave in 100", "linear", "Rayleigh", "second order", "Tayfun"), crests)


def moments_added(field: WaveField) -> FloatArray:
    """Third moment of the height, variance of height and of slope that bound waves add to a tile [m3, m2, 1]."""
    whole, free = (one.surfaces(0.0)[0].astype(float) for one in (field, field.linear()))
    cubes, squares = ([np.mean(z[..., 0] ** power) for z in (whole, free)] for power in (3, 2))
    slopes = [float(np.sum(np.mean(z[..., 1:] ** 2, axis=(0, 1)))) for z in (whole, free)]
    return np.array([cubes[0] - cubes[1], squares[0] - squares[1], slopes[0] - slopes[1]])


def crest_heights(spectrum: DirectionalSpectrum, bound: float, steepness: float) -> tuple[str, ...]:
    """Crests that one wave in 100 exceeds, over the significant height: of 16 records of two hours, and in closed form."""
    share, found = 0.01, []
    records = [WaveRecord.draw(spectrum, seed, 9216, 0.78125, hertz=(1.0 / 30.0, 0.6), bound=bound) for seed in range(16)]
    for kind in ("linear", "second_order"):
        each = []
        for record in records:
            z = getattr(record, kind)
            z = z - z.mean()
            starts = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
            each.append(float(np.quantile(np.maximum.reduceat(z, starts), 1.0 - share)) / spectrum.significant_height())
        found.append(f"{np.mean(each):.3f} ± {np.std(each, ddof=1) / np.sqrt(len(each)):.3f}")
    gaussian = float(np.sqrt(-2.0 * np.log(share)))
    return found[0], f"{0.25 * gaussian:.3f}", found[1], f"{0.25 * (gaussian + 0.5 * steepness * gaussian**2):.3f}"


def buoy() -> Lines:
    """A week of spectra of buoy 41010 against the buoy's own summary."""
    from seaglint.base.errors import DataError
    from seaglint.formats.waves import WaveChoice, read_waves

    path = folder("SEAGLINT_DATA_DIR") / "waves" / "41010"
    summary = [line.split() for line in path.with_suffix(".spec").read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    own, field, count = [], [], 0
    for year, month, day, hour, minute, height, *_ in summary[::9]:
        try:
            choice = WaveChoice(f"{year}-{month}-{day}T{hour}:{minute}", time_tolerance=900.0)
            spectrum = read_waves(path, choice, format="ndbc").spectrum
        except DataError:
            continue  # the summary has hours that the spectra lack
        count += 1
        own.append(abs(spectrum.significant_height() - float(height)))
        synthesised = WaveField.create(spectrum, plan_tiles(spectrum, 1.0, 256), 0).significant_height
        field.append(abs(synthesised / spectrum.significant_height() - 1.0))
    rows = [
        ("spectrum's Hs against WVHT of the summary", f"{max(own):.3f} m", "0.15 m"),
        ("synthesised Hs against the spectrum's own", f"{100 * max(field):.2f} %", "3 %"),
    ]
    yield from table((f"{count} hours of buoy 41010", "largest difference", "bound"), rows)


def scenes() -> Lines:
    """Scenes whose picture is known: largest difference of the rendered picture to it."""
    furnace = {"atmosphere": {"source": "isothermal", "temperature_k": 288.15}, "sea": {"temperature_k": 288.15}}
    rows = [
        ("sea, air and sky at one temperature, 7 m/s, waves resolved", f"{departure(furnace, flat=True):.1e}", "1e-4"),
        calm(),
        *(all_in_facets(wind) for wind in (2.0, 7.0, 14.0)),
    ]
    yield from table(("scene", "largest relative difference", "bound"), rows)


def calm() -> tuple[str, ...]:
    """A flat sea at night."""
    scene = {"sea": {"slopes": {"kind": "flat"}, "spectrum": {"kind": "flat"}}, "sun": {"zenith_deg": 100.0, "azimuth_deg": 180.0}}
    return "flat sea under the table's sky: Fresnel times sky, plus emission", f"{departure(scene):.1e}", "1e-3"


def all_in_facets(wind: float) -> tuple[str, ...]:
    """A sea without waves that are geometry."""
    scene = {"sea": {"resolve_waves": False}, "wind": {"speed_m_s": wind}}
    what = f"all slopes in the facets, {wind:g} m/s: mean-radiance model, depressions 0.5-60°"
    return what, f"{departure(scene):.1e}", "5e-3"


def departure(scene: dict[str, object], *, flat: bool = False) -> float:
    """Largest relative difference of a picture to a constant, or to the mean-radiance model; looking into the Sun and beside it."""
    worst = 0.0
    for top, height, rows in ((-0.5, 1.0, 128), (-1.5, 6.0, 96), (-7.5, 52.5, 320)):
        pixels = {"fov_deg": [60.0, height], "pixels": [12, rows], "elevation_deg": top - 0.5 * height, "pixel_shape": "any"}
        scenario = parse_scenario({**scene, "sensor": {"frames": 1, **pixels}})
        run = prepare_sequence(scenario)
        seen = run.at(0.0).radiance.astype(np.float64)
        view, camera = scenario_physics.view(scenario), scenario_physics.camera(scenario)
        if flat:
            expected = float(view.band.radiance(view.sea_temperature, view.atmosphere.wavenumber_cm))
        else:
            # A pixel is a mean over its elevations (two Gauss points) and, in the glint, over its azimuths, here 5 deg (eight).
            inside, (across, weights) = camera.row_step / np.sqrt(12.0), np.polynomial.legendre.leggauss(8)
            sides = zip(np.radians(30.0 / 12) * across, 0.25 * weights, strict=True)
            expected = sum(
                weight * mean_radiance(view, camera.elevations + y, camera.azimuths + x).total
                for x, weight in sides
                for y in (-inside, inside)
            )
        worst = max(worst, float(np.max(np.abs(seen / expected - 1.0))))
    return worst


def measured() -> Lines:
    """Measured spectra, other models and a buoy beside ours; a sentence on what is left of each."""
    from seaglint.studies.measured.against_measurements import against_measurements

    rows = against_measurements().rows
    names = list(dict.fromkeys(row.spectroscopy for row in rows if row.spectroscopy))
    head = ("", "measured, or the model named", *(f"{name}: ours, difference, rms" for name in names), "uncertainty")
    for case in dict.fromkeys(row.case for row in rows):
        own = [row for row in rows if row.case == case]
        body = []
        for quantity in dict.fromkeys(row.quantity for row in own):
            same = [row for row in own if row.quantity == quantity]
            unit = "" if same[0].unit == "1" else f" {same[0].unit}"
            body.append((quantity, f"{_digits(same[0].measured, same[0].unit)}{unit}", *map(_measured_cell, same), same[0].uncertainty))
        yield f"**{case}**"
        yield ""
        yield from table(head if own[0].spectroscopy else ("", "measured", "ours, difference", "uncertainty"), body)
        yield ""
        for spectroscopy, reason in dict.fromkeys((row.spectroscopy, row.reason) for row in own):
            yield f"- {f'{spectroscopy}: ' if spectroscopy else ''}{reason}"
        yield ""


def _digits(value: float, unit: str) -> str:
    return f"{value:.2f}" if unit == "K" else f"{value:.4g}"


def _measured_cell(row: MeasuredRow) -> str:
    """Ours, its difference in the units there are, and the rms."""
    parts = [_digits(row.ours, row.unit)]
    parts += [] if row.difference_k is None else [f"{row.difference_k:+.2f} K"]
    if row.unit == "deg":
        parts += [f"{row.ours - row.measured:+.1f} deg"]
    elif not math.isnan(row.difference_percent):  # A skewness near zero has no ratio.
        parts += [f"{row.difference_percent:+.1f} %"]
    parts += [] if row.rms is None else [f"{row.rms:.2f} K" if row.unit == "K" else f"{row.rms:.3f}"]
    return ", ".join(parts)


TABLES: dict[str, Callable[[], Lines]] = {
    "headline": headline,
    "lowtran": lowtran,
    "scattered": scattered,
    "emissivity": wu_smith,
    "low-suns": low_suns,
    "other-seas": other_seas,
    "sea": sea,
    "second-order": second_order,
    "buoy": buoy,
    "scenes": scenes,
    "measured": measured,
}


def replace(page: str, name: str, lines: list[str]) -> str:
    """Page with the text between a table's markers replaced."""
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    pattern = re.compile(re.escape(begin) + r"\n.*?" + re.escape(end), re.DOTALL)
    if not pattern.search(page):
        raise SystemExit(f"the page lacks the lines '{begin}' and '{end}'; put them where the table shall be")
    return pattern.sub(lambda _: "\n".join((begin, "", *lines, "", end)), page)


def page_of(name: str) -> Path:
    """The page of docs/validation with a table's markers."""
    begin = f"<!-- begin {name} -->"
    found = [path for path in sorted((DOCS / "validation").glob("*.md")) if begin in path.read_text(encoding="utf-8").splitlines()]
    if len(found) != 1:
        raise SystemExit(f"docs/validation has {len(found)} pages with the line '{begin}'; put it where the table shall be")
    return found[0]


def write_table(name: str, lines: list[str]) -> None:
    """Write a table into its page of docs/validation."""
    page = page_of(name)
    page.write_text(replace(page.read_text(encoding="utf-8"), name, lines), encoding="utf-8")


def main(names: list[str]) -> int:
    """Rewrite the pages; how many tables were left as they are, for want of data."""
    unknown = set(names) - set(TABLES)
    if unknown:
        raise SystemExit(f"no table {', '.join(sorted(unknown))}; there are {', '.join(TABLES)}")
    left = 0
    for name in names or TABLES:
        try:
            lines = list(TABLES[name]())
        except NotHereError as reason:
            print(f"{name}: left as it is, {reason}")
            left += 1
            continue
        print(f"\n{name}", *lines, sep="\n")
        write_table(name, lines)
    return left


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
