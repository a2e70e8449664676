"""Compare sunlight scattered once, in LOWTRAN7's layers, with an own converged sum along the same lines.

python docs/figures/converged_scattering.py        # prints a table, half a minute

The converged sum knows nothing of the layers: ``L = E0 int T(Sun - s - sensor) sum_c beta_c(s) P_c ds`` over some 150 pieces of the bent
ray, with the band transmittance T of the whole bent way, the scattering coefficient beta of every region's aerosol where it is, and T
between two places by its logarithmic mean.
"""

from __future__ import annotations

import argparse

import numpy as np

from seaglint.air.profile.absorber_densities import cold_share
from seaglint.air.profile.aerosols import HazeWeather, aerosols
from seaglint.air.profile.air_profile import AirProfile, model_profile
from seaglint.air.profile.air_sums import CUTS, AirSums
from seaglint.air.profile.bent_ray import BentRay
from seaglint.air.profile.profile_scattering import scattering_air
from seaglint.air.protocol import wavenumber_grid
from seaglint.air.scattering.lowtran_ray import MOLECULES
from seaglint.air.scattering.scattered_line import HUMIDITIES
from seaglint.air.scattering.scattering_laws import ScatteringAir, scattering_angle

BAND = (3.5, 5.0)
HEIGHTS = (20.0, 2500.0)
ZENITHS_DEG = (20.0, 70.0, 85.0, 89.9, 95.0, 120.0)
SUNS_DEG = ((10.0, 60.0), (90.0, 30.0), (170.0, 80.0))
"""Azimuth from the Sun and zenith angle of the Sun [deg]."""

SPACE = 99e3
"""Height above which nothing is between a place and the Sun [m]."""


def pieces(sums: AirSums, ray: BentRay) -> tuple[np.ndarray, np.ndarray]:
    """Amounts of aerosols and of gases in the pieces of a ray, the colder water continuum by the temperature at the place."""
    gases, kelvin = sums.ray_amounts(ray)
    cold, own = (sums.laws.columns.index(column) for column in (9, 5))
    gases[:, cold] = gases[:, own] * cold_share(kelvin, sums.laws.cold_kelvin)
    return sums.haze_amounts(ray.between(CUTS), np.repeat(ray.length / CUTS, CUTS)), gases


def converged(profile: AirProfile, haze: HazeWeather, air: ScatteringAir, height: float, line: tuple[float, float, float]) -> np.ndarray:
    """Spectrum from a height [m] along a line: zenith angle, azimuth from the Sun, the Sun's zenith angle unrefracted [rad]."""
    zenith, azimuth, sun = line
    sums = AirSums(profile, haze, air.wavenumber_cm)
    ray = sums.air.ray(height, zenith)
    dust, gases = pieces(sums, ray)
    dust_to, gases_to = (np.concatenate([np.zeros((1, each.shape[1])), np.cumsum(each, axis=0)]) for each in (dust, gases))
    depth = []
    for j, z in enumerate(np.maximum(ray.height, 0.01)):
        up = np.cos(sun) * np.cos(ray.arc[j]) + np.sin(sun) * np.sin(ray.arc[j]) * np.cos(azimuth)
        beyond = (np.zeros(dust.shape[1]), np.zeros(gases.shape[1]))
        if z < SPACE:
            seen = sums.air.ray(float(z), float(air.apparent_zenith(np.arccos(up), float(z))))
            beyond = tuple(each.sum(axis=0) for each in pieces(sums, seen))
        depth.append(sums.laws.optical_depth((gases_to[j] + beyond[1])[None])[0] + sums.haze_depth(dust_to[j] + beyond[0]))
    fall = np.diff(depth, axis=0)
    near = np.exp(-np.array(depth[:-1]))
    small = np.abs(fall) < 1e-6
    mean = near * np.where(small, 1.0 - 0.5 * fall, -np.expm1(-fall) / np.where(small, 1.0, fall))
    phase = air.phase(scattering_angle(zenith, azimuth, float(air.apparent_zenith(sun, height))))
    held = aerosols(profile, haze, air.wavenumber_cm, 0.0)
    coefficient = held.extinction - held.absorption
    humidity = np.interp(0.5 * (ray.height[1:] + ray.height[:-1]), profile.height, profile.relative_humidity)
    shares = np.array([np.interp(humidity, HUMIDITIES, row) for row in np.eye(len(HUMIDITIES))])
    out = (gases[:, sums.laws.columns.index(6)] @ mean) * air.laws.linear[MOLECULES] * phase[-1]
    for region in range(dust.shape[1]):
        kinds = shares if region == 0 else np.ones((1, len(dust)))
        first = 0 if region == 0 else len(HUMIDITIES) - 1 + region
        for kind, share in enumerate(kinds):
            out = out + ((dust[:, region] * share) @ mean) * coefficient[region] * phase[first + kind]
    return np.asarray(air.source * out)


def main() -> None:
    """Command line."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    profile, haze = model_profile("midlatitude-summer"), HazeWeather(wind=7.0, wind_24h=7.0)
    air = scattering_air(profile, haze, wavenumber_grid(*BAND))
    smooth = scattering_air(profile, haze, wavenumber_grid(*BAND), continuous=True)
    print("| from | zenith angle | " + " | ".join(f"{a:g} deg from a Sun at {z:g} deg" for a, z in SUNS_DEG) + " |")
    print("|---" * (2 + len(SUNS_DEG)) + "|")
    for height in HEIGHTS:
        for zenith in ZENITHS_DEG:
            cells = []
            for azimuth, sun in SUNS_DEG:
                line = (np.radians(zenith), np.radians(azimuth), np.radians(sun))
                own = float(converged(profile, haze, air, height, line).sum())
                phase = air.phase(scattering_angle(*line[:2], float(air.apparent_zenith(line[2], height))))
                found = [each.amplitudes(height, np.array([line]))[0][0] for each in (air, smooth)]
                cells.append(", ".join(f"{float((air.source * (phase * each).sum(axis=0)).sum()) / own:.3f}" for each in found))
            print(f"| {height:g} m | {zenith:g} deg | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
