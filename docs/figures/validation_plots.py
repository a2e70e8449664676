"""Draw ours against theirs, with what is left below, into docs/images/validation.

    python docs/figures/validation_plots.py              all pictures
    python docs/figures/validation_plots.py air emissivity

Pictures of ``air``, ``scattered`` and ``emissivity`` are drawn from docs/data/against_*.csv, which hold what others computed beside what
this package gives. Where ``data_folders.py`` finds the others' numbers, these files are made anew first.
``mitsuba`` is drawn from the table of docs/performance.md, ``sensor`` and ``detection`` are computed.
"""

from __future__ import annotations

import csv
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pictures import save

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
from data_folders import data_folder

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "docs" / "data"
IMAGES = ROOT / "docs" / "images" / "validation"
QUANTITIES = {
    "tau_mean": "path transmittance [1]",
    "path_radiance_W_m2_sr": "path radiance [W m⁻² sr⁻¹]",
    "sun_normal_irradiance_W_m2": "Sun at the sea [W m⁻²]",
    "sky_radiance_W_m2_sr": "sky from the sea [W m⁻² sr⁻¹]",
}
BANDS = {(3.5, 5.0): "tab:blue", (8.0, 12.0): "tab:red"}


def write(name: str, head: list[str], rows: list[list[Any]]) -> None:
    """Write a table of docs/data, numbers with six digits."""
    with (DATA / f"against_{name}.csv").open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(head)
        out.writerows([[f"{v:.6g}" if isinstance(v, float) else v for v in row] for row in rows])


def read(name: str) -> list[dict[str, str]]:
    """Rows of a table of docs/data."""
    with (DATA / f"against_{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(rows: list[dict[str, str]], column: str) -> np.ndarray:
    """A column."""
    return np.array([float(row[column]) for row in rows])


def take_air(reference: Path) -> None:
    """LOWTRAN7's slant paths beside the table's."""
    from seaglint.air.lowtran_table import models
    from validation_tables import lowtran_case

    keys = ["atmosphere", "wind_speed_m_s", "sensor_height_m", "depression_deg", "solar_zenith_deg", "sky_zenith_deg"]
    with (reference / "lowtran7_slant_paths.csv").open() as file:
        cases = [row for row in csv.DictReader(file) if row["atmosphere"] in models()]
    head, rows = list(keys), [[case[key] for key in keys] for case in cases]
    for low, high in BANDS:
        head += [f"{name}[{low:g}-{high:g}]:{whose}" for name in QUANTITIES for whose in ("lowtran7", "seaglint")]
        for row, case in zip(rows, cases, strict=True):
            tau, path, sun, _, sky = lowtran_case(case, (low, high))
            for name, ours in zip(QUANTITIES, (tau, path, sun, sky), strict=True):
                row += [float(case[f"{name}[{low:.1f}-{high:.1f}]"]), ours]
    write("lowtran7", head, rows)


def take_scattered(reference: Path) -> None:
    """LOWTRAN7's scattered sunlight beside ours, 3.5-5 um."""
    from seaglint.formats.tables.input_tables import read_cases
    from seaglint.studies.mean.evaluate_cases import evaluate_scattered, parse_bands

    path = reference / "lowtran7_scattered.csv"
    with path.open() as file:
        cases = list(csv.DictReader(file))
    ours = np.asarray(evaluate_scattered(read_cases(path), parse_bands(["3.5-5.0"]))["scattered_W_m2_sr[3.5-5.0]"])
    keys = ["kind", "atmosphere", "wind_speed_m_s", "sensor_height_m", "elevation_deg", "azimuth_from_sun_deg", "solar_zenith_deg"]
    names = ["scattered_W_m2_sr[3.5-5.0]", "thermal_W_m2_sr[3.5-5.0]"]
    rows = [[*(case[k] for k in keys), *(float(case[n]) for n in names), float(o)] for case, o in zip(cases, ours, strict=True)]
    write("scattered", [*keys, "scattered:lowtran7", "thermal:lowtran7", "scattered:seaglint"], rows)


def take_emissivity(reference: Path) -> None:
    """Wu and Smith's emissivities beside ours."""
    from seaglint.facet.emissivity import emissivity
    from seaglint.optics.sea_water import hale_querry_sea
    from seaglint.sea.slopes.cox_munk import cox_munk_isotropic

    lines = (reference / "emissivity_wu_smith.csv").read_text(encoding="utf-8").splitlines()
    rows: list[list[Any]] = []
    for row in csv.DictReader(line for line in lines if not line.startswith("#")):
        wavelength, wind = float(row["wavelength_um"]), float(row["wind_m/s"])
        angles = [int(key[2:]) for key, value in row.items() if key.startswith("e_") and value and int(key[2:]) <= 65]
        ours = emissivity(np.radians(angles), cox_munk_isotropic(wind, height=12.5), hale_querry_sea(), 1e4 / wavelength)[:, 0]
        rows += [[wavelength, wind, a, float(row[f"e_{a}"]), float(o)] for a, o in zip(angles, ours, strict=True)]
    write("wu_smith", ["wavelength_um", "wind_speed_m_s", "zenith_deg", "emissivity:wu_smith", "emissivity:seaglint"], rows)


def pair(figure: Figure, columns: int) -> np.ndarray:
    """Panels, each with a lower one for what is left."""
    return figure.subplots(2, columns, sharex="col", height_ratios=(2, 1), squeeze=False)


def air() -> Figure:
    """Transmittance, path radiance, Sun and sky against LOWTRAN7."""
    rows = read("lowtran7")
    figure = Figure(figsize=(12, 5.4), layout="constrained")
    panels = pair(figure, len(QUANTITIES))
    for k, (name, label) in enumerate(QUANTITIES.items()):
        upper, lower = panels[:, k]
        for (low, high), colour in BANDS.items():
            theirs, ours = (numbers(rows, f"{name}[{low:g}-{high:g}]:{whose}") for whose in ("lowtran7", "seaglint"))
            seen = theirs > 1e-3 * theirs.max()
            upper.loglog(theirs[seen], ours[seen], ".", color=colour, ms=4, label=f"{low:g}-{high:g} µm")
            lower.semilogx(theirs[seen], 100 * (ours[seen] / theirs[seen] - 1), ".", color=colour, ms=4)
        ends = upper.get_xlim()
        upper.plot(ends, ends, "k", lw=0.6, zorder=0)
        lower.axhline(0, color="k", lw=0.6)
        lower.set_xlabel(f"LOWTRAN7: {label}", fontsize=9)
        lower.set_ylim(-0.6, 0.6)
    panels[0, 0].set_ylabel("the table")
    panels[1, 0].set_ylabel("difference [%]")
    panels[0, 0].legend(fontsize=8)
    return figure


def scattered() -> Figure:
    """Scattered sunlight against LOWTRAN7, where it is over 1 % of the sum."""
    rows = read("scattered")
    theirs, warmth, ours = (numbers(rows, name) for name in ("scattered:lowtran7", "thermal:lowtran7", "scattered:seaglint"))
    sun = numbers(rows, "solar_zenith_deg")
    figure = Figure(figsize=(6.4, 5.4), layout="constrained")
    upper, lower = pair(figure, 1)[:, 0]
    counts = theirs > 0.01 * (theirs + warmth)
    for low, colour in ((counts & (sun <= 80), "tab:blue"), (counts & (sun > 80), "tab:red")):
        upper.loglog(theirs[low], ours[low], ".", color=colour, label="Sun up to 80°" if colour == "tab:blue" else "Sun beyond 80°")
        lower.semilogx(theirs[low], 100 * (ours[low] / theirs[low] - 1), ".", color=colour)
    ends = upper.get_xlim()
    upper.plot(ends, ends, "k", lw=0.6, zorder=0)
    lower.axhline(0, color="k", lw=0.6)
    upper.set_ylabel("here [W m⁻² sr⁻¹]")
    lower.set(xlabel="LOWTRAN7: sunlight scattered once, 3.5-5 µm [W m⁻² sr⁻¹]", ylabel="difference [%]")
    upper.legend()
    return figure


def emissivity() -> Figure:
    """Emissivity of a rough sea against Wu and Smith."""
    rows = read("wu_smith")
    figure = Figure(figsize=(10, 5.4), layout="constrained")
    wavelengths = sorted(set(numbers(rows, "wavelength_um")))
    panels = pair(figure, len(wavelengths))
    for k, wavelength in enumerate(wavelengths):
        upper, lower = panels[:, k]
        chosen = [row for row in rows if float(row["wavelength_um"]) == wavelength]
        for n, wind in enumerate(sorted(set(numbers(chosen, "wind_speed_m_s")))):
            of_wind = [row for row in chosen if float(row["wind_speed_m_s"]) == wind]
            angle, theirs, ours = (numbers(of_wind, c) for c in ("zenith_deg", "emissivity:wu_smith", "emissivity:seaglint"))
            upper.plot(angle, ours, f"C{n}", lw=1, label=f"{wind:g} m/s")
            upper.plot(angle, theirs, f"C{n}o", ms=3)
            lower.plot(angle, 1000 * (ours - theirs), f"C{n}.-", ms=4, lw=0.6)
        lower.axhline(0, color="k", lw=0.6)
        lower.set_ylim(-1.1, 1.1)
        upper.set_title(f"{wavelength:g} µm")
        lower.set_xlabel("zenith angle [deg]")
    panels[0, 0].set_ylabel("emissivity [1]; dots: Wu and Smith")
    panels[1, 0].set_ylabel("difference [0.001]")
    panels[0, 0].legend(fontsize=8)
    return figure


def mitsuba() -> Figure:
    """Error against time of both renderers, from the table of the performance page."""
    page = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
    row = re.compile(r"^\| (\d+)° \| (sweep|Mitsuba), ([^|]*) \| ([\d.]+) s \| ([\d.]+) s \| ([\d.]+) % \|$", re.MULTILINE)
    figure = Figure(figsize=(8.4, 4.4), layout="constrained")
    for axes, sun in zip(figure.subplots(1, 2, sharey=True, sharex=True), ("50", "80"), strict=True):
        for colour, who, how in (("tab:blue", "sweep", ""), ("tab:orange", "Mitsuba", "independent"), ("tab:red", "Mitsuba", "stratified")):
            found = [
                (float(geometry) + float(image), float(error), "extrapolated" in text)
                for s, name, text, geometry, image, error in row.findall(page)
                if s == sun and name == who and how in text
            ]
            for extrapolated, marker in ((False, "o"), (True, "x")):
                some = [(time, error) for time, error, flag in found if flag is extrapolated]
                label = f"{who} {how}".strip() + (", extrapolated" if extrapolated else "")
                axes.loglog(*(np.array(some).T if some else ([], [])), marker, color=colour, label=label)
        axes.axhline(1.5, color="k", lw=0.6)
        axes.set(title=f"Sun's zenith angle {sun}°", xlabel="time of an image [s]")
        axes.grid(alpha=0.3, which="both")
    figure.axes[0].set_ylabel("RMS error over mean, to the own converged image [%]")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.axes[1].legend(
        *zip(*[(h, text) for h, text in zip(handles, labels, strict=True) if text != "sweep, extrapolated"], strict=True), fontsize=8
    )
    return figure


def sensor() -> Figure:
    """MTF by slanted edges against the product of its parts, and parts against pyBSM."""
    from seaglint.instrument.detector import square_mtf
    from seaglint.instrument.figures_of_merit import mtf
    from seaglint.instrument.optics import SensorOptics, jitter_mtf, pupil_mtf, wavefront_mtf
    from sensor_validation import ANGLE, PYBSM, camera, edge_mtf, slanted_edge

    figure = Figure(figsize=(10, 5.4), layout="constrained")
    panels = pair(figure, 2)
    upper, lower = panels[:, 0]
    for k, (name, optics, fill) in enumerate(
        (
            ("F/2, aberrated, jitter", SensorOptics(0.05, 0.1, wavefront_error=0.04, jitter=2e-5), 0.8),
            ("F/6, obscured", SensorOptics(0.1 / 6, 0.1, obscuration=0.3), 1.0),
        )
    ):
        model = camera(optics=optics, fill_factor=fill)
        frequency, found = edge_mtf(model.sense(slanted_edge(256, 5, ANGLE), oversampling=5).units, ANGLE)
        below = frequency <= 0.5
        expected = mtf(model, frequency[below] / model.ifov)["along"]["total"]
        upper.plot(frequency[below], expected, f"C{k}", lw=1, label=f"{name}: product of parts")
        upper.plot(frequency[below][::6], found[below][::6], f"C{k}o", ms=3, label="the same by a slanted edge")
        lower.plot(frequency[below], found[below] - expected, f"C{k}", lw=0.8)
    upper.legend(fontsize=7)
    lower.set(xlabel="frequency [cycles/pixel]", ylabel="difference [1]", ylim=(-0.011, 0.011))
    text = PYBSM.read_text()
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    f = numbers(rows, "cycles_per_rad")
    v = f * 4.0e-6 / 0.08
    ours = {
        "diffraction": pupil_mtf(v, 0.3),
        "wavefront": wavefront_mtf(v, 0.07),
        "detector": square_mtf(f, 15e-6 / 0.2),
        "jitter": jitter_mtf(f, 20e-6),
    }
    upper, lower = panels[:, 1]
    for k, (name, found) in enumerate(ours.items()):
        upper.plot(f / 1000, found, f"C{k}", lw=1, label=name)
        upper.plot(f / 1000, numbers(rows, name), f"C{k}o", ms=3)
        lower.plot(f / 1000, 1e6 * (found - numbers(rows, name)), f"C{k}", lw=0.8)
    upper.legend(fontsize=7)
    upper.set_title("parts; dots: pyBSM 0.16.1", fontsize=9)
    lower.set(xlabel="frequency [cycles/mrad]", ylabel="difference [1e-6]")
    for axes in panels[1]:
        axes.axhline(0, color="k", lw=0.6)
    panels[0, 0].set_ylabel("MTF [1]")
    panels[0, 0].set_title("whole sensor", fontsize=9)
    return figure


def detection() -> Figure:
    """P_fa and P_d of a plain threshold in white Gaussian noise against their closed forms."""
    from scipy import stats

    import seaglint as sg

    noise = np.random.default_rng(11).normal(0.0, 1.0, (60, 128, 128)).astype(np.float32)
    thresholds = np.arange(1.0, 4.6, 0.5)
    found = [
        sg.detect(
            noise, 3.0, detector="threshold", threshold=float(t), injections=4000, placement="centre", match_radius=0.0, frame_rate=1.0
        )
        for t in thresholds
    ]
    figure = Figure(figsize=(6.8, 5.6), layout="constrained")
    upper, lower = pair(figure, 1)[:, 0]
    fine = np.linspace(0.8, 4.7, 100)
    for key, colour, shift in (("p_d", "tab:blue", 3.0), ("p_fa", "tab:red", 0.0)):
        parts = [one["sweep"][0] if key == "p_d" else one for one in found]
        values = np.array([part[key] for part in parts])
        ends = np.array([part[f"{key}_interval"] or (np.nan, np.nan) for part in parts], float)
        closed = stats.norm.sf(thresholds - shift)
        upper.semilogy(fine, stats.norm.sf(fine - shift), color=colour, label=f"{'P_d' if key == 'p_d' else 'P_fa'}, Gaussian tail")
        upper.plot(thresholds, values, "o", color=colour, ms=4)
        beside = thresholds + (0.03 if key == "p_d" else -0.03)
        lower.errorbar(beside, 100 * (values / closed - 1), 100 * np.abs(ends.T - values) / closed, fmt="o", color=colour, ms=4)
    lower.axhline(0, color="k", lw=0.6)
    upper.set_ylabel("probability [1]; dots: counted")
    lower.set(xlabel="threshold [standard deviations]", ylabel="difference [%]", ylim=(-25, 25))
    upper.set_title("60 frames of 128 x 128 pixels, 4000 objects of three standard deviations", fontsize=9)
    upper.legend(fontsize=8)
    return figure


PICTURES = {"air": air, "scattered": scattered, "emissivity": emissivity, "mitsuba": mitsuba, "sensor": sensor, "detection": detection}
TAKEN = {"air": take_air, "scattered": take_scattered, "emissivity": take_emissivity}


def main(names: list[str]) -> int:
    """Draw those named, or all; how many were drawn from files that could not be made anew."""
    if unknown := set(names) - set(PICTURES):
        sys.exit(f"{', '.join(sorted(unknown))}: not one of {', '.join(PICTURES)}")
    IMAGES.mkdir(parents=True, exist_ok=True)
    reference, old = data_folder("SEAGLINT_REFERENCE_DIR"), 0
    for name in names or PICTURES:
        if name in TAKEN and reference:
            TAKEN[name](reference)
        elif name in TAKEN:
            print(f"{name}: drawn from the file as it is, no reference tables are beside the repository")
            old += 1
        path = IMAGES / f"{name}.png"
        save(PICTURES[name](), path, dpi=90)
        print(f"{path.relative_to(ROOT)}  {path.stat().st_size / 1e3:.0f} kB")
    return old


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
