"""Measure the sensor against what it must show and write the table into docs/validation/sensor.md; about a minute.

python docs/figures/sensor_validation.py
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from seaglint.instrument.chain import SensorModel
from seaglint.instrument.detector import PhotonPixels, square_mtf
from seaglint.instrument.figures_of_merit import figures, mtf, three_d
from seaglint.instrument.noise import DetectorNoise, three_d_noise
from seaglint.instrument.optics import SensorOptics, jitter_mtf, pupil_mtf, wavefront_mtf
from seaglint.instrument.photons import Photons
from seaglint.optics.band import Band

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "validation" / "sensor.md"
PYBSM = ROOT / "tests" / "instrument" / "data" / "pybsm.csv"
ANGLE = 5.0
BINS = 4
"""Bins of the edge's profile to a pixel, as the standard has it."""
Row = tuple[str, str, str]
"""What is compared, the bound, what was found."""


def slanted_edge(size: int, oversampling: int, angle_deg: float, low: float = 1.0, high: float = 2.0, turned: bool = False) -> np.ndarray:
    """Radiance of an edge, as ISO 12233 has it, each fine pixel the mean over its area (8 x 8 points) [(size oversampling, same)]."""
    count, points = size * oversampling, (np.arange(8) + 0.5) / 8
    tangent, middle = np.tan(np.radians(angle_deg)), 0.5 * size * oversampling
    share = np.zeros((count, count))
    for a in points:
        row = np.arange(count)[:, None] + a - middle
        for b in points:
            share += (np.arange(count)[None, :] + b - middle) > row * tangent
    picture = (low + (high - low) * share / 64).astype(np.float32)
    return picture.T.copy() if turned else picture


def edge_mtf(picture: np.ndarray, angle_deg: float, turned: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [cycles/pixel, along the edge's normal] and MTF of a picture whose middle the edge crosses."""
    picture = picture.T if turned else picture
    rows, columns = picture.shape
    tangent = np.tan(np.radians(angle_deg))
    y, x = np.mgrid[0:rows, 0:columns] + 0.5
    distance = ((x - 0.5 * columns) - (y - 0.5 * rows) * tangent) * np.cos(np.radians(angle_deg))
    place = np.floor(distance * BINS).astype(int)
    lowest, reach = place.min(), int(0.45 * columns * BINS)
    total = np.bincount((place - lowest).ravel(), picture.ravel().astype(float))
    count = np.bincount((place - lowest).ravel())
    profile = (total / np.maximum(count, 1))[-lowest - reach : -lowest + reach]
    spread = np.diff(profile)
    frequency = np.fft.rfftfreq(spread.size, 1.0 / BINS)
    # averaging over a bin and the difference of two each blur by a bin's width
    found = np.abs(np.fft.rfft(spread)) / np.sinc(frequency / BINS) ** 2
    return frequency, found / found[0]


def camera(noise: DetectorNoise | None = None, optics: SensorOptics | None = None, **detector: float) -> SensorModel:
    """A mid-wave camera, F/2, 15 um pixels, without noise unless told."""
    given = {"pitch": 15e-6, "integration_time": 2e-3, "well_capacity": 7e6, "bit_depth": 14, **detector}
    quiet = DetectorNoise(temporal=False, fixed_pattern=False)
    return SensorModel(
        Photons(Band.rectangular(3.5, 5.0)), optics or SensorOptics(0.05, 0.1), PhotonPixels(**given), noise or quiet, seed=3
    )


def flat(model: SensorModel, radiance: float, size: int, frame: int) -> np.ndarray:
    """Counts of an even field."""
    return model.sense(np.full((size, size), radiance, np.float32), frame).signal.astype(float)


def edges() -> Iterator[Row]:
    """Slanted edges of 256 pixels up to the Nyquist frequency."""
    cases = (
        ("F/2, wavefront error 0.04, jitter 0.13 pixels, fill factor 0.8", SensorOptics(0.05, 0.1, wavefront_error=0.04, jitter=2e-5), 0.8),
        ("F/3", SensorOptics(0.1 / 3, 0.1), 1.0),
        ("F/3, obscuration 0.3", SensorOptics(0.1 / 3, 0.1, obscuration=0.3), 1.0),
        ("F/6, obscuration 0.3", SensorOptics(0.1 / 6, 0.1, obscuration=0.3), 1.0),
    )
    for name, optics, fill in cases:
        model = camera(optics=optics, fill_factor=fill)
        worst = 0.0
        for n, turned in ((3, False), (5, False), (5, True)):
            frequency, found = edge_mtf(model.sense(slanted_edge(256, n, ANGLE, turned=turned), oversampling=n).units, ANGLE, turned)
            below = frequency <= 0.5
            expected = mtf(model, frequency[below] / model.ifov)["across" if turned else "along"]["total"]
            worst = max(worst, float(np.abs(found[below] - expected).max()))
        yield f"slanted edge (ISO 12233), {name}: MTF against the product of its parts", "0.01", f"{worst:.4f}"


def pybsm() -> Iterator[Row]:
    """Transfer functions of pyBSM."""
    text = PYBSM.read_text()
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    table = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    f = table["cycles_per_rad"]
    v = f * 4.0e-6 / 0.08
    ours = {"clear": pupil_mtf(v), "diffraction": pupil_mtf(v, 0.3), "wavefront": wavefront_mtf(v, 0.07)}
    ours |= {"detector": square_mtf(f, 15e-6 / 0.2), "jitter": jitter_mtf(f, 20e-6)}
    worst = max(float(np.abs(found - table[name]).max()) for name, found in ours.items())
    yield "diffraction, wavefront, detector, jitter against pyBSM 0.16.1", "0.005", f"{worst:.0e}"
    electrons = {float(t): float(n) for t, n in re.findall(r"blackbody at (\d+) K: (\S+)", text)}
    optics = SensorOptics(0.08, 0.2, transmission=0.8, obscuration=0.3, solid_angle_law="thin-lens")
    model = SensorModel(Photons(Band.rectangular(3.5, 5.0), None, 0.7), optics, PhotonPixels(15e-6, integration_time=2e-3, gain=10.0))
    theirs = np.sqrt(electrons[300.0]) / (electrons[301.0] - electrons[300.0])
    yield "NETD against pyBSM's electrons at 300 and 301 K", "3 %", f"{100 * (figures(model).netd_k / theirs - 1):+.1f} %"


def transfer() -> Iterator[Row]:
    """Photon transfer and NETD from flat fields."""
    model = camera(DetectorNoise(gain_spread=0.01), well_capacity=1e6, read_noise=200.0, offset=100.0)
    full = (1e6 - model.readout.background) / model.readout.per_radiance
    pairs = [[flat(model, share * full, 256, 2 * i + k) for k in (0, 1)] for i, share in enumerate(np.linspace(0.0, 0.9, 10))]
    mean = [0.5 * (a + b).mean() for a, b in pairs]
    variance = [0.5 * (a - b).var() for a, b in pairs]
    slope, _ = np.polyfit(mean, variance, 1)
    gain = model.readout.gain
    read = np.sqrt(variance[0] - 1.0 / 12.0) * gain
    well = (flat(model, 2.0 * full, 64, 40).mean() - 100.0) * gain
    found = f"{100 * (1 / slope / gain - 1):+.1f}, {100 * (read / 200 - 1):+.1f}, {100 * (well / 1e6 - 1):+.2f} %"
    yield "photon transfer at ten levels: gain, read noise, well", "2 %", found
    model = camera(DetectorNoise(gain_spread=0.001), read_noise=500.0)
    cold, warm = (float(model.photons.radiance(t)) for t in (300.0, 301.0))
    still = [flat(model, cold, 256, k) for k in range(8)]
    step = np.mean([flat(model, warm, 256, 10 + k).mean() for k in range(4)]) - np.mean(still)
    noise = np.sqrt(np.mean([0.5 * (a - b).var() for a, b in zip(still[::2], still[1::2], strict=True)]))
    told = figures(model).netd_k
    yield "NETD of flat fields at 300 and 301 K against the formula", "3 %", f"{100 * (noise / step / told - 1):+.1f} %"


def cube() -> Iterator[Row]:
    """Components of 3-D noise: those drawn, because one set of rows has an rms of its own."""
    put = {"frame": 300.0, "row": 400.0, "column": 350.0, "row_temporal": 250.0, "column_temporal": 450.0, "offset_spread": 500.0}
    model = camera(DetectorNoise(**put), read_noise=600.0)
    seen = np.full((200, 240), 1.0, np.float32)
    found, told = three_d_noise(np.stack([model.expose(seen, k).units for k in range(400)])), three_d(model, 1.0)
    offset = model._pattern((200, 240)).offset
    told |= {"V": float(offset.mean(axis=1).std(ddof=1)), "H": float(offset.mean(axis=0).std(ddof=1))}
    worst = max(abs(found[name] / told[name] - 1.0) for name in found)
    yield "components of 3-D noise, 400 frames of 200 x 240", "5 %", f"{100 * worst:.1f} %"


def point(row: int, column: int, size: int = 96, n: int = 5) -> np.ndarray:
    """All light in one fine pixel, of 1 pixel solid angle in all."""
    out = np.zeros((size * n, size * n), np.float32)
    out[size // 2 * n + row, size // 2 * n + column] = n**2
    return out


def energy() -> Iterator[Row]:
    """Points, fields, temperatures."""
    model = camera(optics=SensorOptics(0.1, 0.1))
    sums = [float(model.focal_plane(point(a, b), 5).sum()) for a in range(5) for b in range(5)]
    yield "a point's sum at 25 places within its pixel, fill factor 1", "0.3 %", f"{100 * np.ptp(sums) / np.mean(sums):.2f} %"
    gaps = replace(model, detector=PhotonPixels(15e-6, 0.25, 2e-3))
    mean = np.mean([model.focal_plane(point(a, b), 5).sum() for a in range(5) for b in range(5)])
    mean_gaps = 0.25 * np.mean([gaps.focal_plane(point(a, b), 5).sum() for a in range(5) for b in range(5)])
    yield "its mean over places at fill factor 0.25, over that at 1", "0.25", f"{mean_gaps / mean:.4f}"
    model = camera(optics=SensorOptics(0.05, 0.1, obscuration=0.3, transmission=0.8))
    # power through the pupil, against radiance times solid angle of a pixel
    electrons = model.ifov**2 * model.optics.pupil_area * 0.8 * model.photons.electrons_per_joule * 2e-3
    light = float((model.readout.units(model.focal_plane(point(2, 2), 5)) - model.readout.background).sum())
    yield "electrons of a point: pupil area x irradiance, within 96 x 96 pixels", "1 %", f"{100 * (light / electrons - 1):+.2f} %"
    model = camera(optics=SensorOptics(0.05, 0.1, transmission=0.8, emissivity=0.2, temperature=305.0), dark_current=1e6, offset=100.0)
    off = [
        float(np.abs(model.apparent_temperature(flat(model, float(model.photons.radiance(t)), 16, 0)) - t).max())
        for t in (275.0, 288.0, 300.0, 315.0)
    ]
    yield "a blackbody's own temperature from counts, 275-315 K, warm optics and dark current taken off", "0.05 K", f"{max(off):.3f} K"
    counts = np.arange(int(100 + model.readout.background / model.readout.gain) + 2, model.readout.top_count, 37)
    again = model.readout.units(model.photons.radiance(model.apparent_temperature(counts))) / model.readout.gain + 100.0
    yield "counts to temperature and back", "0.5", f"{np.abs(again - counts).max():.1g}"


def main() -> None:
    """Print the table and write it into the page."""
    rows = [row for part in (edges, pybsm, transfer, cube, energy) for row in part()]
    lines = ["| what | bound | found |", "| --- | --- | --- |", *(f"| {what} | {bound} | {found} |" for what, bound, found in rows)]
    print("\n".join(lines))
    page = PAGE.read_text(encoding="utf-8")
    table = "\n".join(("<!-- begin sensor -->", "", *lines, "", "<!-- end sensor -->"))
    PAGE.write_text(re.sub(r"<!-- begin sensor -->\n.*?<!-- end sensor -->", lambda _: table, page, flags=re.DOTALL), encoding="utf-8")


if __name__ == "__main__":
    main()
