"""Write what today's absorption changes against LOWTRAN7's: paths, skies, camera ranges and pictures, for docs/validation/air.md.

python docs/figures/air_differences.py tables
python docs/figures/air_differences.py picture
"""

from __future__ import annotations

import math
import sys
from functools import cache

import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm

import seaglint as sg
from detection_ranges import AIR_K, CASES, Case
from pictures import save
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.band_laws import OwnGases, Spectroscopy, with_gases
from seaglint.air.protocol import wavenumber_grid
from seaglint.optics.band import ApparentTemperature, Band
from seaglint.optics.blackbody import planck_wavenumber
from validation_tables import DOCS, write_table

MODELS = ("tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "us-standard-1976")
BANDS = ((3.0, 5.0), (8.0, 12.0))
LENGTHS_KM = (1.0, 5.0, 10.0, 20.0)
ZENITHS_DEG = (0.0, 60.0, 85.0)
PICTURE = DOCS / "images" / "air_of_today.png"
WIND = 5.0
HEIGHT = 20.0
SPECTROSCOPIES: tuple[Spectroscopy, ...] = ("lblrtm", "lowtran7")


@cache
def air(model: str, band: tuple[float, float], spectroscopy: Spectroscopy) -> AirSums:
    """Air of a model at 5 m/s with the carbon dioxide that goes with a spectroscopy."""
    profile = with_gases(model_profile(model), OwnGases().of(spectroscopy))
    return AirSums(profile, HazeWeather(wind=WIND, wind_24h=WIND), wavenumber_grid(*band), spectroscopy=spectroscopy)


def passed(sums: AirSums, band: tuple[float, float], metres: float) -> float:
    """Mean transmittance of a level path [1], weighted with a blackbody at 288.15 K."""
    nu = sums.laws.wavenumber_cm
    weight = Band.rectangular(*band).weights(nu) * planck_wavenumber(nu, AIR_K)
    return float(weight @ sums.between(HEIGHT, HEIGHT, metres)[0] / weight.sum())


def paths_table() -> str:
    """Transmittance of level paths."""
    head = "| climate | band | " + " | ".join(f"{km:g} km" for km in LENGTHS_KM) + " |\n|---|---|" + "---|" * len(LENGTHS_KM)
    rows = [head]
    for model in MODELS:
        for band in BANDS:
            cells = []
            for km in LENGTHS_KM:
                ours, own = (passed(air(model, band, s), band, 1e3 * km) for s in SPECTROSCOPIES)
                cells.append(f"{ours:.3f} ({own:.3f})")
            rows.append(f"| {model} | {band[0]:g}-{band[1]:g} µm | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def skies_table() -> str:
    """Apparent temperatures of the clear sky from 20 m [K]."""
    bands = ((3.7, 4.2), (4.4, 4.8), (8.0, 9.2), (9.4, 9.9), (10.0, 12.0))
    head = "| climate | zenith angle | " + " | ".join(f"{low:g}-{high:g} µm" for low, high in bands) + " |\n|---|---|" + "---|" * len(bands)
    rows = [head]
    for model in MODELS[:5]:
        for zenith in ZENITHS_DEG:
            cells = []
            for band in bands:
                kelvin = []
                for s in SPECTROSCOPIES:
                    sums = air(model, band, s)
                    nu = sums.laws.wavenumber_cm
                    inverse = ApparentTemperature.create(Band.rectangular(*band), nu)
                    light = Band.rectangular(*band).weights(nu) @ sums.along(HEIGHT, math.radians(zenith)).emitted
                    kelvin.append(float(inverse(light)))
                cells.append(f"{kelvin[0]:.1f} ({kelvin[0] - kelvin[1]:+.1f})")
            rows.append(f"| {model} | {zenith:g}° | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def range_in(case: Case, sums: AirSums) -> float:
    """Closed form of a case's range [km] behind the spectral transmittance of a real air instead of its even extinction."""
    nu = sums.laws.wavenumber_cm
    weight = Band.rectangular(*case.band_um).weights(nu)
    photons = 1.0 if case.netd_k is not None else 1.0 / (1.98644586e-23 * nu)  # h c per cm-1 [J cm]
    step = weight * photons * np.abs(planck_wavenumber(nu, case.temperature_k) - planck_wavenumber(nu, AIR_K))
    gains, contrast = case.gains(), case.step_per_noise() / step.sum()
    angle = math.pi * case.radius_m**2 / (case.pitch_um * 1e-6 / case.focal_length_m) ** 2

    def rate(at: float) -> float:
        seen = contrast * angle * float(step @ sums.between(case.height_m, 4.0, at)[0]) / at**2
        return float(norm.sf(norm.isf(case.p_fa) - seen * gains).mean()) - 0.9

    return 1e-3 * float(brentq(rate, 50.0, 1e5))


def ranges_table() -> str:
    """Ranges of the five cameras."""
    some = ("tropical", "midlatitude-summer", "subarctic-winter")
    rows = ["| camera and object | " + " | ".join(some) + " |\n|---|" + "---|" * len(some)]
    for case in CASES:
        cells = []
        for model in some:
            ours, own = (range_in(case, air(model, case.band_um, s)) for s in SPECTROSCOPIES)
            cells.append(f"{ours:.2f} ({100.0 * (ours / own - 1.0):+.1f} %)")
        rows.append(f"| {case.name} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def picture() -> None:
    """Draw the default scene with both, and the difference, by day and in both bands."""
    import matplotlib.pyplot as plt

    scene = {"sun": {"zenith_deg": 65, "azimuth_deg": 180}, "sensor": {"azimuth_deg": 180, "pixels": [256, 128]}}
    figure, axes = plt.subplots(2, 3, figsize=(12.0, 5.2), constrained_layout=True)
    for row, (low, high) in zip(axes, ((3.5, 5.0), (8.0, 12.0)), strict=True):
        kelvin = []
        for spectroscopy in SPECTROSCOPIES:
            seen = sg.image(sg.load({**scene, "band": {"min_um": low, "max_um": high}, "atmosphere": {"spectroscopy": spectroscopy}}))
            kelvin.append(sg.apparent_temperature(seen["radiance"]))
        limits = {"vmin": float(np.nanquantile(kelvin[1], 0.01)), "vmax": float(np.nanquantile(kelvin[1], 0.99))}
        edge = float(np.nanquantile(np.abs(kelvin[0] - kelvin[1]), 0.99))
        angles = [float(seen[name].values[i]) for name in ("azimuth", "elevation") for i in (0, -1)]
        extent = (angles[0], angles[1], angles[3], angles[2])
        for axis, values, title, style in (
            (row[0], kelvin[0], "lblrtm", {"cmap": "inferno", **limits}),
            (row[1], kelvin[1], "lowtran7", {"cmap": "inferno", **limits}),
            (row[2], kelvin[0] - kelvin[1], "lblrtm less lowtran7", {"cmap": "RdBu_r", "vmin": -edge, "vmax": edge}),
        ):
            drawn = axis.imshow(np.asarray(values), extent=extent, aspect="auto", **style)
            axis.set_title(f"{low:g}-{high:g} µm, {title}")
            axis.set_xlabel("azimuth [deg]")
            figure.colorbar(drawn, ax=axis, label="apparent temperature [K]" if "less" not in title else "difference [K]")
        row[0].set_ylabel("elevation [deg]")
    save(figure, PICTURE)


def main() -> None:
    """Write the tables into the page, or the picture."""
    if sys.argv[1:] == ["picture"]:
        picture()
        return
    for name, lines in (("air-paths", paths_table()), ("air-skies", skies_table()), ("air-ranges", ranges_table())):
        write_table(name, lines.splitlines())


if __name__ == "__main__":
    main()
