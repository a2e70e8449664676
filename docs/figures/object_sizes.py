"""How much of the sea's radiance the mirror image of an object and its shadow on the glint change, for typical objects.

    python docs/figures/object_sizes.py

The mean model by brute force: at a point of the mean sea in front of an object, slopes on a grid, each with its share of the visible sea;
where the ray that its facet mirrors meets the object (a box), the sky is replaced by it. In the shadow the mirrored Sun of the mean model
is lost, all of it. Sea 288 K, wind 7 m/s across, Sun 14 deg high behind the object, 3.5-5 um, midlatitude summer. Markdown goes to
standard output.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.facet.sea_view import SeaView
from seaglint.optics.band import apparent_temperature
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics

SENSOR_HEIGHT = 20.0
SUN_HEIGHT_DEG = 14.0
SEA = 288.15
SLOPES = 801
WIDEST = 5.0
"""Slopes up to so many deviations."""


@dataclass(frozen=True)
class Thing:
    """A box: width across the line of sight, depth, its lowest and highest point above the sea [m], distance [m], temperature [K], and
    distances in front of it at which the sea is looked at [m].
    """

    name: str
    width: float
    depth: float
    low: float
    high: float
    distance: float
    kelvin: float
    before: tuple[float, ...]


THINGS = (
    Thing("container ship, broadside, 300 K", 294.0, 32.0, 0.0, 22.5, 2000.0, 300.0, (1.0, 10.0, 30.0, 100.0, 300.0)),
    Thing("buoy, 295 K", 3.0, 3.0, 0.0, 4.0, 500.0, 295.0, (0.5, 2.0, 5.0, 10.0)),
    Thing("drone 16 m up, 300 K", 0.8, 0.8, 15.8, 16.2, 500.0, 300.0, (100.0, 200.0, 300.0)),
)


def view_of() -> SeaView:
    """Sensor, sea and air; the Sun stands behind what is looked at."""
    return scenario_physics.view(
        parse_scenario(
            {
                "sun": {"zenith_deg": 90.0 - SUN_HEIGHT_DEG, "azimuth_deg": 0.0},
                "sensor": {"height_m": SENSOR_HEIGHT, "azimuth_deg": 0.0, "elevation_deg": -2.0},
                "band": {"min_um": 3.5, "max_um": 5.0},
                "wind": {"speed_m_s": 7.0, "from_deg": 90.0},
                "sea": {"temperature_k": SEA},
            }
        )
    )


def mirrored(view: SeaView, thing: Thing, before: float) -> float:
    """What the mirror image adds to the sea's radiance at the sea [W m-2 sr-1], ``before`` the object [m]; north is ahead."""
    away = thing.distance - before
    towards = np.array([0.0, -away, SENSOR_HEIGHT]) / math.hypot(away, SENSOR_HEIGHT)
    deviation = math.sqrt(view.slopes.mss)
    s = np.linspace(-WIDEST * deviation, WIDEST * deviation, SLOPES)
    east, north = np.meshgrid(s, s)
    normal = np.stack([-east, -north, np.ones_like(east)], axis=-1) / np.sqrt(1.0 + east**2 + north**2)[..., None]
    cosine = normal @ towards
    weight = np.where(cosine > 0.0, view.slopes.density(east, north) * cosine / normal[..., 2], 0.0)
    weight /= weight.sum()
    ray = 2.0 * cosine[..., None] * normal - towards
    met = _meets(ray, (-0.5 * thing.width, before, thing.low), (0.5 * thing.width, before + thing.depth, thing.high))
    middle = float(view.in_band.wavenumber_cm.mean())
    rho = reflectance(np.clip(cosine, 1e-3, 1.0), view.water.index(middle))
    zenith = np.linspace(0.0, 0.5 * np.pi, 91)
    sky = np.interp(np.arccos(np.clip(ray[..., 2], 0.0, 1.0)), zenith, view.in_band(view.atmosphere.sky_radiance(zenith, 0.0)))
    thing_sends = float(view.band.radiance(np.array([thing.kelvin]), view.atmosphere.wavenumber_cm)[0])
    return float((weight * rho * (thing_sends - sky))[met].sum())


def _meets(ray: FloatArray, low: tuple[float, ...], high: tuple[float, ...]) -> NDArray[np.bool_]:
    """Whether rays from the origin meet a box."""
    with np.errstate(divide="ignore"):
        first, last = (np.array(end) / ray for end in (low, high))
    near, far = np.minimum(first, last).max(axis=-1), np.maximum(first, last).min(axis=-1)
    return np.asarray((far > np.maximum(near, 0.0)) & np.isfinite(far))


def kelvin_more(view: SeaView, change: float) -> float:
    """A change of the sea's radiance as a change of its apparent temperature [K]."""
    sea = float(view.band.radiance(np.array([SEA]), view.atmosphere.wavenumber_cm)[0])
    found = apparent_temperature(np.array([sea, sea + change]), view.band, view.atmosphere.wavenumber_cm)
    return float(found[1] - found[0])


def main() -> None:
    """Print both tables."""
    view = view_of()
    print("| mirror image of | m before it | change [W m⁻² sr⁻¹] | [K] | of the object's own contrast |")
    print("|---|---|---|---|---|")
    for thing in THINGS:
        own = float(np.diff(view.band.radiance(np.array([SEA, thing.kelvin]), view.atmosphere.wavenumber_cm))[0])
        for before in thing.before:
            change = mirrored(view, thing, before)
            print(f"| {thing.name} | {before:g} | {change:+.4f} | {kelvin_more(view, change):+.2f} | {change / own:+.1%} |")
    print()
    print("| shadow of | long [m] | high [mrad] | wide [mrad] | glint lost [W m⁻² sr⁻¹] | share of the sea's radiance |")
    print("|---|---|---|---|---|---|")
    slope = math.tan(math.radians(SUN_HEIGHT_DEG))
    for thing in THINGS:
        near, far = thing.distance - thing.high / slope, thing.distance + thing.depth - thing.low / slope
        top, bottom = (math.atan(SENSOR_HEIGHT / min(end, thing.distance)) for end in (far, near))
        found = mean_radiance(view, np.array([-0.5 * (top + bottom)]), np.array([0.0]))
        glint, whole = float(found.sun[0, 0]), float(found.total[0, 0])
        across = 1e3 * thing.width / thing.distance
        print(f"| {thing.name} | {far - near:.0f} | {1e3 * (bottom - top):.2f} | {across:.1f} | {glint:.2f} | {glint / whole:.0%} |")


if __name__ == "__main__":
    main()
