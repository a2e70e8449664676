"""Compare lit points of a measured field of slopes with models of sparkle, and mean slopes of a footprint with measured seas.

    python docs/figures/measured_sparkle.py          both tables, docs/data and the picture
    python docs/figures/measured_sparkle.py field    one of field, mean_slopes

``field`` counts points whose slope lies in a disc of a radius, in the field of RaDyO (512 x 512 points, 1.28 mm apart, means taken off), in
seas drawn on the same lattice, and by the closed form of :mod:`seaglint.sea.glitter.lit_share`. Variances are those of averages over
squares within one field, over the squared mean share: a field has no waves longer than itself. ``mean_slopes`` compares the rms and the 1/e
time of slopes averaged over a camera's footprint. The measured field and series are read from the folder of reference tables
(``data_folders.py``), in ``measured_sea``; without it the rows of docs/data are drawn again.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from pictures import save_named
from seaglint.base.conventions import FloatArray
from seaglint.base.random import stream
from seaglint.sea.glitter.lit_share import RIGID, LitShare
from seaglint.sea.glitter.short_waves import ShortWaves
from seaglint.sea.spectra.campaigns import campaign_spectrum, campaign_winds
from seaglint.sea.spectra.directional import DirectionalSpectrum
from validation_tables import DOCS, NotHereError, folder, table, write_table

DATA = DOCS / "data"
POINTS, STEP = 512, 0.0012774955980940877  # of the measured field; m
RADII = (0.010, 0.020, 0.040)
SIDES = (2, 4, 8, 16, 32, 64)  # points
LAGS = 120  # points, of correlation lengths
CELL = 0.0026  # m: the article's cells at 70 ms
RADYO_WINDS = (5.0, 9.0)
BLOCK, RESAMPLED = 128, 400  # points of a side of the blocks that are drawn again
DRAWS = {"own": 400, "radyo": 200}
SEED = 1
VARIANCES = slice(1, 1 + len(SIDES))  # of ``Lit.values``

#: The camera of the series of mean slopes: height [m], angle off the nadir [deg], focal length [m], pitch [m], and pixels.
#:
#: The number of pixels is assumed, of the sensor Sony IMX250MZR in usual polarimetric cameras.
CAMERA = (23.0, 30.0, 0.075, 3.45e-6, (2448, 2048))
SCALES = (1.0, 0.5, 2.0)  # of the footprint's sides
SERIES_BLOCK = 150  # samples of 1/30 s: ten times the 1/e time

Fields = tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class Lit:
    """Lit points of one field or of a model: share, variance by side, correlation length along both axes [m]."""

    share: float
    variance: FloatArray
    length: FloatArray

    @property
    def values(self) -> FloatArray:
        """All numbers in one row."""
        return np.concatenate([[self.share], self.variance, self.length])


def one_over_e(line: FloatArray) -> float:
    """Lag at which a correlation that begins with 1 is 1/e for the first time, linear in between; NaN beyond the line."""
    below = np.flatnonzero(line < math.exp(-1.0))
    if below.size == 0:
        return math.nan
    i = int(below[0])
    return float(i - 1 + (line[i - 1] - math.exp(-1.0)) / (line[i - 1] - line[i]))


def averages(lit: FloatArray, side: int) -> FloatArray:
    """Means over squares of some points."""
    n = lit.shape[0] // side
    return np.asarray(lit.reshape(n, side, n, side).mean((1, 3)))


def products(lit: FloatArray, block: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Means by block (rows, columns): of points, of squared averages (..., sides), of products at lags along both axes (..., 2, lags)."""
    shares = averages(lit, block)
    squares = np.stack([averages(averages(lit, side) ** 2, block // side) for side in SIDES], axis=-1)
    n = lit.shape[0] // block
    if n == 1:
        return shares, squares, whole_products(lit)[None, None]
    lags = np.full((n, n, 2, LAGS), np.nan)
    for axis, field in enumerate((lit, lit.T)):
        for lag in range(LAGS):
            pairs = field * np.roll(field, -lag, axis=0)
            pairs[field.shape[0] - lag :] = np.nan
            means = np.nanmean(pairs.reshape(n, block, n, block), axis=(1, 3))
            lags[:, :, axis, lag] = means if axis == 0 else means.T
    return shares, squares, lags


def whole_products(lit: FloatArray) -> FloatArray:
    """Mean products at lags along both axes of a whole field (2, lags), by Fourier transforms."""
    out = np.empty((2, LAGS))
    for axis, field in enumerate((lit, lit.T)):
        spectrum = np.sum(np.abs(np.fft.rfft(field, 2 * len(field), axis=0)) ** 2, axis=1)
        out[axis] = np.fft.irfft(spectrum)[:LAGS] / (field.shape[1] * (len(field) - np.arange(LAGS)))
    return out


def summary(shares: FloatArray, squares: FloatArray, lags: FloatArray) -> Lit:
    """Numbers of a field from its blocks."""
    share = float(shares.mean())
    variance = squares.reshape(-1, len(SIDES)).mean(0) / share**2 - 1.0
    line = lags.reshape(-1, 2, LAGS).mean(0) - share**2
    length = np.array([one_over_e(one / one[0]) for one in line])
    return Lit(share, variance, STEP * length)


def points_of(fields: Fields, radius: float) -> FloatArray:
    """Points whose slope is within a radius, 1 or 0."""
    return ((fields[0] ** 2 + fields[1] ** 2) < radius**2).astype(np.float64)


@cache
def measured() -> Fields:
    """The measured field of slopes along its two axes."""
    with np.load(folder("SEAGLINT_REFERENCE_DIR") / "measured_sea" / "radyo_slope_field.npz") as file:
        if abs(float(file["pixel_m"]) - STEP) > 1e-9:
            raise ValueError(f"points {float(file['pixel_m'])} m apart; the lattice of this comparison has {STEP}")
        scale = float(file["scale"])
        return file["slope_across"] * scale, file["slope_along"] * scale


def of_measured(radius: float) -> tuple[Lit, FloatArray]:
    """The measured field, and standard errors of its numbers by blocks that are drawn again."""
    blocks = products(points_of(measured(), radius), BLOCK)
    count = (POINTS // BLOCK) ** 2
    flat = [part.reshape(count, *part.shape[2:]) for part in blocks]
    rng = stream(SEED, "bootstrap")
    again: list[FloatArray] = []
    for _ in range(RESAMPLED):
        chosen = rng.integers(0, count, count)
        again.append(summary(*(part[chosen] for part in flat)).values)
    return summary(*blocks), np.nanstd(again, axis=0)


def random_phases(seed: int) -> Fields:
    """A field with the measured one's spectra and cross spectrum, and random phases and amplitudes: a Gaussian field.

    Phases alone would not suffice: few long waves of fixed amplitudes have fewer small slopes than a Gaussian field, here by a tenth.
    """
    white = np.fft.fft2(stream(SEED, "phases", seed).standard_normal((POINTS, POINTS))) / POINTS
    first, second = (np.fft.ifft2(np.fft.fft2(part) * white).real for part in measured())
    return first, second


def drawn(spectrum: DirectionalSpectrum, seed: int, points: int = POINTS, step: float = STEP) -> Fields:
    """Slopes to the east and north of a sea of one spectrum on a lattice, without waves that are longer than it."""
    k = 2.0 * np.pi * np.fft.fftfreq(points, step)
    east, north = np.meshgrid(k, k, indexing="ij")
    rng = stream(SEED, "patch", seed)
    deviates = rng.standard_normal((points, points)) + 1j * rng.standard_normal((points, points))
    height = np.sqrt(spectrum.density(east, north)) * deviates * (2.0 * np.pi / (points * step))
    to_east, to_north = (np.fft.ifft2(1j * part * height).real * points**2 for part in (east, north))
    return to_east, to_north


def of_fields(make: Callable[[int], Fields], count: int) -> dict[float, tuple[Lit, FloatArray]]:
    """Means of many fields by radius, variances over the squared mean share of all, and standard errors by omission of one field."""
    sums: dict[float, list[list[FloatArray]]] = {radius: [] for radius in RADII}
    for seed in range(count):
        fields = make(seed)
        for radius in RADII:
            sums[radius].append([part[0, 0] for part in products(points_of(fields, radius), POINTS)])
    out = {}
    for radius, parts in sums.items():
        shares, squares, lags = (np.array(part) for part in zip(*parts, strict=True))
        # variance about each field's own mean, as of the measured one
        totals = (shares, squares - shares[:, None] ** 2, lags - shares[:, None, None] ** 2)

        def of_all(means: list[FloatArray]) -> FloatArray:
            share, variance, line = means
            return np.concatenate([[share], variance / share**2, [STEP * one_over_e(one / one[0]) for one in line]])

        values = of_all([part.mean(0) for part in totals])
        without = np.array([of_all([(part.sum(0) - part[i]) / (count - 1) for part in totals]) for i in range(count)])
        lit = Lit(float(values[0]), values[VARIANCES], values[VARIANCES.stop :])
        out[radius] = lit, np.nanstd(without, axis=0) * math.sqrt(count - 1.0)
    return out


def closed(covariance: FloatArray, radius: float) -> Lit:
    """Closed form with the covariances of slopes (lags, lags, 3) on the lattice, lag 0 first and negative lags last."""
    lit = LitShare(tuple(float(v) for v in covariance[0, 0]), RIGID, (0.0, 0.0), radius)  # type: ignore[arg-type]
    excess = lit.pairs(covariance) - lit.unrelated
    # a point is lit or not
    excess[0, 0] = 1.0 / lit.chance - 1.0

    def of_square(side: int) -> float:
        lags = np.arange(-side + 1, side)
        weight = (1.0 - np.abs(lags) / side) / side
        return float(np.sum(np.outer(weight, weight) * excess[np.ix_(lags, lags)]))

    whole = of_square(POINTS // 2) if covariance.shape[0] < 2 * POINTS else of_square(POINTS)
    if covariance.shape[0] == POINTS:
        whole = float(excess.mean())
    variance = np.array([of_square(side) - whole for side in SIDES])
    lines = (excess[:LAGS, 0] - whole, excess[0, :LAGS] - whole)
    return Lit(lit.chance, variance, STEP * np.array([one_over_e(line / line[0]) for line in lines]))


def own_covariance() -> FloatArray:
    """Covariance of the measured slopes at all lags of the lattice, from their spectra."""
    first, second = (np.fft.fft2(part) for part in measured())
    parts = (np.abs(first) ** 2, (first * np.conj(second)).real, np.abs(second) ** 2)
    return np.stack([np.fft.ifft2(part).real for part in parts], axis=-1) / first.size


def of_waves(spectrum: DirectionalSpectrum) -> FloatArray:
    """Covariance of the slopes of the waves of a lattice at lags up to its side, the lag towards the east first; waves go east."""
    # the longest waves of a lattice are few: the continuous ones begin where both have the same slopes
    k = 2.0 * np.pi * np.fft.fftfreq(POINTS, STEP)
    east, north = np.meshgrid(k, k, indexing="ij")
    total = float(np.sum(spectrum.density(east, north) * (east**2 + north**2))) * k[1] ** 2
    begin = brentq(lambda low: sum(spectrum.mss(np.pi / STEP, low)) - total, 0.2 * k[1], 4.0 * k[1], rtol=1e-6)
    waves = ShortWaves.of_spectrum(spectrum, begin, np.pi / STEP)
    lags = np.fft.fftfreq(2 * POINTS, 1.0 / (2 * POINTS))
    along, across = np.meshgrid(lags[lags >= 0], lags, indexing="ij")
    half = waves.covariance(STEP * np.hypot(along, across), np.arctan2(across, along))
    # R(-r) = R(r)
    out = np.empty((2 * POINTS, 2 * POINTS, 3))
    out[:POINTS] = half
    turned = np.roll(half[::-1, ::-1], 1, axis=1)
    out[POINTS + 1 :] = turned[:-1]
    out[POINTS] = 0.0
    return out


def cells(share: float) -> Lit:
    """The article's cells: independent squares of 2.6 mm that are lit or not."""
    variance = [(1.0 / share - 1.0) * min(1.0, (CELL / (side * STEP)) ** 2) for side in SIDES]
    return Lit(share, np.array(variance), np.full(2, (1.0 - math.exp(-1.0)) * CELL))


NAMES = ("share", *(f"variance_{side}" for side in SIDES), "length_1_mm", "length_2_mm")


def numbers(radius: float, what: str, number: int, lit: Lit, error: FloatArray | None = None) -> Iterator[dict[str, Any]]:
    """Rows of the file: values, and their standard errors where there are some."""
    scale = np.array([1.0] * (1 + len(SIDES)) + [1e3] * 2)
    head = {"window_mrad": round(1e3 * radius), "what": what, "fields": number}
    yield {**head, "kind": "value", **dict(zip(NAMES, lit.values * scale, strict=True))}
    if error is not None:
        yield {**head, "kind": "error", **dict(zip(NAMES, error * scale, strict=True))}


def field_rows() -> Iterator[dict[str, Any]]:
    """All rows of the comparison with the field."""
    seas = {f"radyo-2008, {wind:g} m/s": campaign_spectrum("radyo-2008", wind, 0.5 * math.pi) for wind in RADYO_WINDS}
    covariances = {name: of_waves(spectrum) for name, spectrum in seas.items()}
    own = own_covariance()
    made = {"own spectrum": of_fields(random_phases, DRAWS["own"])}
    print("fields with the measured spectrum drawn", file=sys.stderr, flush=True)
    for name, spectrum in seas.items():
        made[name] = of_fields(lambda seed, spectrum=spectrum: drawn(spectrum, seed), DRAWS["radyo"])  # type: ignore[misc]
        print(f"{name} drawn", file=sys.stderr, flush=True)
    for radius in RADII:
        seen, error = of_measured(radius)
        yield from numbers(radius, "measured", 1, seen, error)
        for name, fields in made.items():
            covariance = own if name == "own spectrum" else covariances[name]
            yield from numbers(radius, f"{name}, drawn", DRAWS[name.split("-")[0].split()[0]], *fields[radius])
            yield from numbers(radius, f"{name}, closed form", 0, closed(covariance, radius))
        yield from numbers(radius, "cells of 2.6 mm", 0, cells(seen.share))


def put(name: str, rows: list[dict[str, Any]]) -> None:
    """Write a file of docs/data, five digits."""
    with (DATA / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        out.writeheader()
        out.writerows({key: f"{value:.5g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows)


def data(name: str) -> list[dict[str, str]]:
    """Rows of a file of docs/data."""
    with (DATA / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def values(rows: list[dict[str, str]], window: int, what: str, kind: str = "value") -> FloatArray:
    """Numbers of one line of the comparison, in the order of ``NAMES``."""
    row = next(row for row in rows if (row["window_mrad"], row["what"], row["kind"]) == (str(window), what, kind))
    return np.array([float(row[name]) for name in NAMES])


def apart(rows: list[dict[str, str]], what: str) -> float:
    """Mean of the absolute logarithm of the ratio of a model's variances to the field's, all windows and sides [1]."""
    logs = [
        np.log(values(rows, round(1e3 * radius), what)[VARIANCES] / values(rows, round(1e3 * radius), "measured")[VARIANCES])
        for radius in RADII
    ]
    return float(np.mean(np.abs(logs)))


def worst(rows: list[dict[str, str]]) -> tuple[float, str]:
    """Largest difference of the closed form's variances to those of drawn fields [1], and of which line it is."""
    every = []
    for name in ("own spectrum", *(f"radyo-2008, {wind:g} m/s" for wind in RADYO_WINDS)):
        for radius in RADII:
            window = round(1e3 * radius)
            ratio = values(rows, window, f"{name}, closed form")[VARIANCES] / values(rows, window, f"{name}, drawn")[VARIANCES]
            i = int(np.argmax(np.abs(ratio - 1.0)))
            every.append((float(ratio[i] - 1.0), f"{name}, {window} mrad, {SIDES[i]} points"))
    return max(every, key=lambda one: abs(one[0]))


LINES = (
    "measured",
    "own spectrum, drawn",
    "own spectrum, closed form",
    *(f"radyo-2008, {wind:g} m/s, {how}" for wind in RADYO_WINDS for how in ("drawn", "closed form")),
    "cells of 2.6 mm",
)


def field_table(rows: list[dict[str, str]]) -> Iterator[str]:
    """The table of the page and two sentences."""

    def cell(value: float, error: float | None) -> str:
        return f"{value:.3g}" if error is None else f"{value:.3g} ± {error:.1g}" if error < 1.0 else f"{value:.3g} ± {error:.0f}"

    body = []
    for radius in RADII:
        window = round(1e3 * radius)
        for what in LINES:
            line = values(rows, window, what)
            errors = values(rows, window, what, "error") if any(
                (row["window_mrad"], row["what"], row["kind"]) == (str(window), what, "error") for row in rows
            ) else None  # fmt: skip
            texts = [cell(line[i], None if errors is None else errors[i]) for i in range(line.size)]
            # of drawn fields the errors of lengths are below the digits
            lengths = texts[-2:] if what == "measured" else [f"{value:.2g}" for value in line[-2:]]
            body.append((f"{window} mrad, {what}", *texts[: 1 + len(SIDES)], " / ".join(lengths)))
    head = ("window, what", "share", *(f"{side} points" for side in SIDES), "length [mm]")
    yield from table(head, body)
    yield ""
    by = {what: apart(rows, what) for what in LINES[1:]}
    logs = "; ".join(f"{what} {value:.2f}" for what, value in by.items())
    yield f"Mean absolute logarithm of the ratio of variances to the measured ones: {logs}."
    difference, where = worst(rows)
    yield f"Largest difference of the closed form to drawn fields: {100 * difference:+.1f} % ({where})."


def field_picture(rows: list[dict[str, str]]) -> Figure:
    """Variance against side in the three windows."""
    figure = Figure(figsize=(11, 4), layout="constrained")
    side = 1e3 * STEP * np.array(SIDES)
    for axes, radius in zip(figure.subplots(1, len(RADII), sharey=True), RADII, strict=True):
        window = round(1e3 * radius)
        axes.errorbar(side, values(rows, window, "measured")[VARIANCES], values(rows, window, "measured", "error")[VARIANCES], fmt="ko",
                      ms=4, label="measured")  # fmt: skip
        for colour, name in (("tab:blue", "own spectrum"), ("tab:green", "radyo-2008, 5 m/s"), ("tab:olive", "radyo-2008, 9 m/s")):
            axes.plot(side, values(rows, window, f"{name}, closed form")[VARIANCES], color=colour, label=f"{name}, closed form")
            axes.plot(side, values(rows, window, f"{name}, drawn")[VARIANCES], "x", color=colour)
        axes.plot(side, values(rows, window, "cells of 2.6 mm")[VARIANCES], color="tab:red", ls="--", label="cells of 2.6 mm (70 ms)")
        axes.set(xscale="log", yscale="log", xlabel="side of the square [mm]", title=f"slopes within {window} mrad")
        axes.set_xticks([3.0, 10.0, 30.0, 80.0], ["3", "10", "30", "80"])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
    figure.axes[0].set_ylabel("variance of the lit share / mean² [1]")
    figure.axes[0].legend(fontsize=7, title="x: drawn", title_fontsize=7)
    return figure


def field() -> None:
    """Compute where the field is present; write table and picture."""
    if _has_reference():
        put("measured_sparkle", list(field_rows()))
    rows = data("measured_sparkle")
    lines = list(field_table(rows))
    print(*lines, sep="\n")
    write_table("measured-field", lines)
    save_named({"measured_sparkle": lambda: field_picture(rows)}, [])


def _has_reference() -> bool:
    try:
        return (folder("SEAGLINT_REFERENCE_DIR") / "measured_sea").is_dir()
    except NotHereError as error:
        print(f"{error}: docs/data stays as it is", file=sys.stderr)
        return False


# mean slopes


def footprint(scale: float = 1.0) -> tuple[float, float]:
    """Length along the view and width of the camera's footprint on the sea [m]."""
    height, angle, focal, pitch, (columns, rows) = CAMERA
    cosine = math.cos(math.radians(angle))
    slant = height / cosine
    return scale * slant * rows * pitch / focal / cosine, scale * slant * columns * pitch / focal


def series() -> tuple[FloatArray, float]:
    """Measured mean slopes without their means (samples, 2), and their step [s]."""
    path = folder("SEAGLINT_REFERENCE_DIR") / "measured_sea" / "asit_mean_slope_30hz.csv"
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    return rows[:, 1:] - rows[:, 1:].mean(0), float(rows[1, 0] - rows[0, 0])


def correlation(samples: FloatArray) -> FloatArray:
    """Correlation of a series at lags up to a quarter of it."""
    n = samples.size
    spectrum = np.abs(np.fft.rfft(samples - samples.mean(), 2 * n)) ** 2
    line = np.fft.irfft(spectrum)[: n // 4] / (n - np.arange(n // 4))
    return np.asarray(line / line[0])


def rms_and_time(samples: FloatArray, step: float) -> FloatArray:
    """Standard deviations [1] and 1/e times [s] of the columns of a series."""
    return np.array([*samples.std(0), *(step * one_over_e(correlation(column)) for column in samples.T)])


def of_sea(waves: ShortWaves, box: tuple[float, float], turn: float, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rms [1] and 1/e time [s] of a footprint's mean slopes along and across the waves, and their covariances in time (times, 3)."""
    covariance = waves.mean_covariance(box, turn, times)
    lines = covariance[:, [0, 2]] / covariance[0, [0, 2]]
    return np.array([*np.sqrt(covariance[0, [0, 2]]), *(float(times[1]) * one_over_e(line) for line in lines.T)]), covariance


def one_minute(covariance: FloatArray, step: float, samples: int, count: int) -> FloatArray:
    """Numbers of ``rms_and_time`` of series of one length drawn with a covariance, each component for itself (count, 4)."""
    out = []
    rng = stream(SEED, "minutes")
    energy = [np.clip(np.fft.rfft(np.concatenate([c, c[-2:0:-1]])).real, 0.0, None) for c in (covariance[:, 0], covariance[:, 2])]
    n = 2 * covariance.shape[0] - 2
    for _ in range(count):
        white = np.fft.rfft(rng.standard_normal((2, n)), axis=1)
        both = np.fft.irfft(np.sqrt(energy) * white, n, axis=1)[:, :samples]
        out.append(rms_and_time(both.T, step))
    return np.array(out)


def mean_slope_rows() -> Iterator[dict[str, Any]]:
    """Measured numbers by the file's axes and by the axes of most and least slope, and those of all winds."""
    keys = ("rms_1", "rms_2", "time_1_s", "time_2_s")
    samples, step = series()

    def row(what: str, wind: float, kind: str, line: FloatArray) -> dict[str, Any]:
        return {"what": what, "wind_speed_m_s": wind, "kind": kind, **dict(zip(keys, (float(v) for v in line), strict=True))}

    principal = samples @ np.linalg.eigh(np.cov(samples.T))[1][:, ::-1]
    rng = stream(SEED, "series")
    starts = rng.integers(0, len(samples) - SERIES_BLOCK, (RESAMPLED, len(samples) // SERIES_BLOCK))
    for what, part in (("measured, axes of the file", samples), ("measured, largest and least slope", principal)):
        yield row(what, math.nan, "value", rms_and_time(part, step))
        rms = [np.concatenate([part[s : s + SERIES_BLOCK] for s in line]).std(0) for line in starts]
        yield row(what, math.nan, "error", np.array([*np.std(rms, axis=0), math.nan, math.nan]))
    times = step * np.arange(4096, dtype=np.float64)
    for wind in campaign_winds("asit-2019"):
        waves = ShortWaves.of_spectrum(campaign_spectrum("asit-2019", float(wind), 0.0), 0.0)
        for scale in SCALES:
            ours, covariance = of_sea(waves, footprint(scale), 0.0, times)
            name = "asit-2019" if scale == 1.0 else f"asit-2019, footprint times {scale:g}"
            yield row(name, float(wind), "value", ours)
            if scale == 1.0:
                drawn_minutes = one_minute(covariance, step, len(samples), 200)
                yield row(name, float(wind), "error", np.nanstd(drawn_minutes, axis=0))
                yield row("asit-2019, turned by 90 deg", float(wind), "value", of_sea(waves, footprint(), 0.5 * math.pi, times)[0])


KEYS = ("rms_1", "rms_2", "time_1_s", "time_2_s")


def line_of(rows: list[dict[str, str]], what: str, wind: str = "nan", kind: str = "value") -> FloatArray:
    """Rms [1] and 1/e times [s] along both axes of one line of the file."""
    row = next(row for row in rows if (row["what"], row["wind_speed_m_s"], row["kind"]) == (what, wind, kind))
    return np.array([float(row[key]) for key in KEYS])


def departures(rows: list[dict[str, str]]) -> dict[str, float]:
    """Largest relative difference of the four numbers of each wind to the measured ones, by the axes of largest and least slope [1]."""
    seen = line_of(rows, "measured, largest and least slope")
    winds = [row["wind_speed_m_s"] for row in rows if (row["what"], row["kind"]) == ("asit-2019", "value")]
    return {wind: float(np.abs(line_of(rows, "asit-2019", wind) / seen - 1.0).max()) for wind in winds}


def mean_slope_table(rows: list[dict[str, str]]) -> Iterator[str]:
    """The table of the page and two sentences."""

    def cells_of(what: str, wind: str = "nan") -> list[str]:
        pairs = zip(line_of(rows, what, wind), line_of(rows, what, wind, "error"), strict=True)
        return [f"{value:.3f}" if math.isnan(error) else f"{value:.3f} ± {error:.3f}" for value, error in pairs]

    body = [(what, *cells_of(what), "", "") for what in ("measured, axes of the file", "measured, largest and least slope")]
    for wind in (largest := departures(rows)):
        changes = []
        for scale in SCALES[1:]:
            change = line_of(rows, f"asit-2019, footprint times {scale:g}", wind) / line_of(rows, "asit-2019", wind) - 1.0
            changes.append(f"{100 * change[0]:+.0f} %, {100 * change[2]:+.0f} %")
        body.append((f"asit-2019, {float(wind):.3g} m/s", *cells_of("asit-2019", wind), *changes))
    heads = ("rms along the waves", "rms across", "1/e time along [s]", "1/e time across [s]", "half the footprint: rms, time", "twice")
    yield from table(("what", *heads), body)
    yield ""
    near = ", ".join(f"{float(wind):.2f} m/s" for wind, most in largest.items() if most < 0.15) or "none"
    best = min(largest, key=lambda wind: largest[wind])
    turned = line_of(rows, "asit-2019, turned by 90 deg", best) / line_of(rows, "asit-2019", best) - 1.0
    yield f"Winds at which all four numbers are within 15 % of the measured ones, by the axes of largest and least slope: {near}."
    yield f"The nearest wind, {float(best):.2f} m/s, is {100 * largest[best]:.0f} % away at most."
    yield f"A camera across the waves there changes these numbers by {100 * np.abs(turned).max():.1f} % at most."


def mean_slopes() -> None:
    """Compute where the series is present; write the table."""
    if _has_reference():
        put("mean_slopes", list(mean_slope_rows()))
    lines = list(mean_slope_table(data("mean_slopes")))
    print(*lines, sep="\n")
    write_table("mean-slopes", lines)


MAKERS = {"field": field, "mean_slopes": mean_slopes}


def main(names: list[str]) -> None:
    """Make the named parts, or both."""
    for name in names or list(MAKERS):
        MAKERS[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
