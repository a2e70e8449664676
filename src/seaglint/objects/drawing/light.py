r"""Radiance of a body's surface at the sensor: spectra of the light about the body, and their sums over the band along its paths.

A facet of temperature T, emissivity e and normal n, in diffuse light of the radiance L around it and under the Sun where it is lit, sends

.. math:: L = e B(T) + (1-e) \left[\frac{1}{\pi} \int_{n \cdot r > 0} L(r)\, n \cdot r\, dr + \frac{E}{\pi} \cos i \right]

and the sensor receives ``tau L + L_path`` of the path to the facet's own range and height, integrated per wavenumber. Above the horizontal
L is the sky over the sea, thermal and scattered sunlight; below it the mean sea without glint, as seen from close above. Both are those at
the sensor's foot, at the height of the sea.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from seaglint.air.protocol import slant_range
from seaglint.air.scattering.scattered_light import scattered_path, scattered_shares
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.facet.haze import is_dark
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import mirrored_sky
from seaglint.facet.surface_spectra import SeaSurface
from seaglint.optics.band import apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber

NORMALS: Final = (13, 9)
"""Normals at which light is tabulated: even in the cosine of the angle from the zenith, and in azimuth from the Sun from 0 to pi."""

_ELEVATIONS: Final = 24
_AROUND: Final = 48
"""Directions of the light about a body: elevations above and below the horizontal, and azimuths from the Sun on one side."""

LOWEST_LINE: Final = -50.0
"""Greatest depth of the line of sight below the sea [m]; paths to points that lie deeper end higher up instead."""


class Arriving(NamedTuple):
    """Sums over the band at four corners of a body's range and height [W m-2 sr-1].

    The field ``corner`` holds arc and height of the first, each followed by its inverse extent.

    Of corner p: ``emitted[p, k]`` of a blackbody at the body's k-th temperature, ``mirrored[p, m, a]`` of light diffusely reflected by a
    white facet of the m-th and a-th of :data:`NORMALS`, ``sun[p]`` of the Sun at normal incidence on it, ``path[p]`` of the path;
    ``clear[p]``: flat mean of the transmittance over the band [1].
    """

    corner: np.ndarray
    emitted: np.ndarray
    mirrored: np.ndarray
    sun: np.ndarray
    path: np.ndarray
    clear: np.ndarray


class Corners(NamedTuple):
    """Arcs [m] and heights [m] of a body's near and far, low and high end, azimuth and elevation of its line of sight [rad]."""

    arc: tuple[float, float]
    height: tuple[float, float]
    azimuth: float
    elevation: float


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Light about a body near the sea, in one view. Make it with :meth:`of`.

    Attributes
    ----------
    view : SeaView
        Sea, air and Sun.
    diffuse : ndarray
        Mean radiance over the hemisphere of a normal [W m-2 sr-1 per cm-1, (m, a, n)], normals as :data:`NORMALS`.
    """

    view: SeaView
    diffuse: FloatArray

    @classmethod
    def of(cls, view: SeaView) -> Surroundings:
        """Surroundings for a view's sky and mean sea."""
        grid = view.in_band.grid
        x, w = np.polynomial.legendre.leggauss(_ELEVATIONS)
        # crowded at the horizontal, where the sky is brightest and the sea darkens
        sine = (0.5 * (1.0 + x)) ** 2
        weight = 0.5 * w * 2.0 * np.sqrt(sine)
        zenith = np.arccos(sine)
        surface = SeaSurface.create(view.atmosphere, view.water, view.sea_temperature, grid)
        leaving = surface.leaving(zenith, view.solar_azimuth, view.slopes)
        sea, sky = leaving.emission + leaving.sky, mirrored_sky(view.atmosphere, zenith, grid)
        azimuth, share = _azimuths()
        light = np.concatenate([np.repeat(sky[:, None], azimuth.size, 1), np.repeat(sea[:, None], azimuth.size, 1)])
        table = view.scattered.sea_sky
        if not is_dark(table):
            shares = scattered_shares(np.arcsin(sine)[:, None], azimuth, table)
            light[:_ELEVATIONS] += view.sun_distance_factor * np.maximum(shares @ table.spectral, 0.0)
        up = np.concatenate([sine, -sine])
        solid = np.concatenate([weight, weight])[:, None] * share
        return cls(view, _hemispheres(up, azimuth, solid, light))

    @property
    def sun(self) -> FloatArray:
        """Unit vector to the Sun's centre, east, north and up [1, (3,)]."""
        z, a = self.view.solar_zenith, self.view.solar_azimuth
        return np.array([math.sin(z) * math.sin(a), math.sin(z) * math.cos(a), math.cos(z)])

    @property
    def sea_counted(self) -> float:
        """1."""
        return 1.0

    @property
    def shines(self) -> bool:
        """True if the Sun's centre is above the horizontal and its light arrives."""
        return bool(self.view.solar_zenith < 0.5 * np.pi and self.view.irradiance.any())

    def arriving(self, places: list[Corners], temperatures: list[FloatArray]) -> list[Arriving]:
        """Sums over the band for bodies at some places, for surfaces at some temperatures [K, (k,)]."""
        if not places:
            return []
        eye, view = self.view.sensor_height, self.view
        arcs = np.array([[p.arc[0], p.arc[1], p.arc[0], p.arc[1]] for p in places])
        heights = np.array([[p.height[0], p.height[0], p.height[1], p.height[1]] for p in places])
        heights = np.maximum(np.maximum(heights, 0.0), _lowest_seen(eye, arcs))
        tau = np.clip(view.atmosphere.transmittance(eye, arcs, heights)[..., view.in_band.grid], 0.0, 1.0) * view.in_band.weights
        path = view.in_band(view.atmosphere.path_radiance(eye, arcs, heights))
        path = path + self._scattered(arcs, heights, places)
        nu = view.in_band.wavenumber_cm
        sun = tau @ (view.irradiance / np.pi) if self.shines else np.zeros(tau.shape[:2])
        out = []
        for i, (place, kelvin) in enumerate(zip(places, temperatures, strict=True)):
            emitted = tau[i] @ planck_wavenumber(nu, kelvin[:, None]).T
            mirrored = np.tensordot(tau[i], self.diffuse, axes=(1, 2))
            lengths = (place.arc[1] - place.arc[0], place.height[1] - place.height[0])
            corner = np.array(
                [
                    place.arc[0],
                    1.0 / lengths[0] if lengths[0] > 0.0 else 0.0,
                    place.height[0],
                    1.0 / lengths[1] if lengths[1] > 0.0 else 0.0,
                ]
            )
            flat = tau[i].sum(axis=-1) / view.in_band.weights.sum()
            out.append(Arriving(corner, np.ascontiguousarray(emitted), np.ascontiguousarray(mirrored), sun[i].copy(), path[i].copy(), flat))
        return out

    def _scattered(self, arcs: FloatArray, heights: FloatArray, places: list[Corners]) -> FloatArray:
        """Sunlight scattered into the paths [W m-2 sr-1, (places, corners)].

        That of a path to the sea of the same length, seen in the direction of the body.
        """
        view = self.view
        table = view.scattered.path
        if is_dark(table):
            return np.zeros(arcs.shape)
        eye, radius = view.sensor_height, EFFECTIVE_EARTH_RADIUS
        slant = slant_range(eye, arcs, heights)
        ratio = np.maximum(slant**2 - eye**2, 0.0) / (4.0 * radius * (radius + eye))
        at_sea = 2.0 * radius * np.arcsin(np.sqrt(np.minimum(ratio, 1.0)))
        azimuth = np.array([p.azimuth for p in places])[:, None] - view.solar_azimuth
        elevation = np.array([p.elevation for p in places])[:, None]
        radiance = scattered_path(at_sea, elevation, azimuth, table)
        # shorter than the sensor is high, there is no path to the sea: in proportion to the length
        return np.asarray(view.sun_distance_factor * radiance * np.minimum(slant / eye, 1.0))

    def kelvin(self, radiance: float) -> float:
        """Apparent temperature [K] of a band radiance [W m-2 sr-1]."""
        return float(apparent_temperature(np.array([radiance]), self.view.band, self.view.atmosphere.wavenumber_cm)[0])


def _azimuths() -> tuple[FloatArray, FloatArray]:
    """Azimuths from the Sun on one side [rad], denser near it, and their weights for both sides."""
    x, w = np.polynomial.legendre.leggauss(_AROUND)
    u, crowd = 0.5 * (1.0 + x), 4.0
    return np.pi * np.sinh(crowd * u) / np.sinh(crowd), w * np.pi * crowd * np.cosh(crowd * u) / np.sinh(crowd)


def _hemispheres(up: FloatArray, azimuth: FloatArray, solid: FloatArray, light: FloatArray) -> FloatArray:
    """Means over hemispheres of the normals [X, (m, a, n)] of light [X, (elevations, azimuths, n)] with solid angles [sr].

    Azimuths stand for both sides of the Sun; weights are made to add to 1.
    """
    cosines, turns = np.linspace(-1.0, 1.0, NORMALS[0]), np.linspace(0.0, np.pi, NORMALS[1])
    level = np.sqrt(1.0 - up**2)[:, None]
    out = np.empty((*NORMALS, light.shape[-1]))
    for m, c in enumerate(cosines):
        s = math.sqrt(max(1.0 - c * c, 0.0))
        for a, turn in enumerate(turns):
            seen = sum(np.maximum(c * up[:, None] + s * level * np.cos(azimuth - side * turn), 0.0) for side in (1.0, -1.0))
            weight = solid * seen
            out[m, a] = np.tensordot(weight / weight.sum(), light, axes=2)
    return out


def _lowest_seen(eye: float, arcs: FloatArray) -> FloatArray:
    """Height of points at arcs [m] whose line to the sensor passes :data:`LOWEST_LINE` below the sea; 0 before that sea's horizon."""
    radius = EFFECTIVE_EARTH_RADIUS + LOWEST_LINE
    beyond = arcs / EFFECTIVE_EARTH_RADIUS - math.acos(radius / (EFFECTIVE_EARTH_RADIUS + eye))
    return np.asarray(np.where(beyond > 0.0, radius / np.cos(np.maximum(beyond, 0.0)) - EFFECTIVE_EARTH_RADIUS, 0.0))
