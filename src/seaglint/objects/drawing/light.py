r"""Radiance of a body's surface at the sensor: spectra of the light about the body, and their sums over the band along its paths.

A facet of temperature T, emissivity e and normal n, in diffuse light of the radiance L around it and under the Sun if lit, has the radiance

.. math:: L = e B(T) + (1-e) \left[\frac{1}{\pi} \int_{n \cdot r > 0} L(r)\, n \cdot r\, dr + \frac{E}{\pi} \cos i \right]

and the sensor receives ``tau L + L_path`` of the path to the range and height of the facet, integrated per wavenumber. Above the horizontal
L is the sky over the sea, thermal and scattered sunlight; below it L is the mean sea without glint, from close above. Both are evaluated at
the sensor's foot, at the height of the sea.

Each sum is evaluated twice: of the radiance, and of the counted radiance, in which each wavenumber is weighted by its electrons per joule
over the electrons per joule of the spectrum for which the sensor's chain converts. This needs no sub-bands, as sums run over wavenumbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from seaglint.air.protocol import slant_range
from seaglint.air.scattering.scattered_light import scattered_path, scattered_shares
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import is_dark, mirrored_sky
from seaglint.facet.surface_spectra import SeaSurface
from seaglint.objects.body import GasPlume
from seaglint.objects.combustion_gas import plume_emissivity
from seaglint.optics.band import apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber

#: Normals at which light is tabulated: even in the cosine of the angle from the zenith, and in azimuth from the Sun from 0 to pi.
NORMALS: Final = (13, 9)

_ELEVATIONS: Final = 24  #: Number of elevations of the light about a body, above and below the horizontal each.
_AROUND: Final = 48  #: Number of azimuths of the light about a body, on one side of the Sun.

LOWEST_LINE: Final = -50.0  #: Greatest depth of a line of sight below the sea [m]; paths to points on deeper lines end higher up.


#: Electrons per joule at wavenumbers [cm-1, (n,)] relative to the spectrum for which the sensor's chain converts [1, (n,)].
Counting = Callable[[FloatArray], FloatArray]


class Arriving(NamedTuple):
    """Sums over the band at four corners p of a body's range and height [W m-2 sr-1].

    The axis q has two entries: radiance and counted radiance.
    """

    corner: np.ndarray  #: Arc and height of the first corner [m], each followed by one over its extent [1/m]. Shape (4,).
    #: Light of a blackbody at the body's k-th temperature, or of a plume along its k-th chord
    #: (``chord_shares``). Axes (q, p, k).
    emitted: np.ndarray
    mirrored: np.ndarray  #: Diffuse light reflected by a white facet of the m-th and a-th of ``NORMALS``. Axes (q, p, m, a).
    sun: np.ndarray  #: Sunlight reflected by a white facet at normal incidence. Axes (q, p).
    path: np.ndarray  #: Light of the path. Axes (q, p).
    cover: np.ndarray  #: Share of the light behind a plume that it absorbs along its k-th chord [1, (k,)]; empty for other bodies.
    clear: np.ndarray  #: Transmittance to the first corner times the band's weights [cm-1, (n,)].


class Corners(NamedTuple):
    """Extent of a body in arc and height, and its line of sight."""

    arc: tuple[float, float]  #: Arcs of its near and far end [m].
    height: tuple[float, float]  #: Heights of its low and high end [m].
    azimuth: float  #: Azimuth of the line of sight [rad].
    elevation: float  #: Elevation of the line of sight [rad].


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Light about a body near the sea, in one view. Make it with ``of``."""

    view: SeaView  #: Sea, air and Sun.
    diffuse: FloatArray  #: Mean radiance over the hemisphere of a normal [W m-2 sr-1 per cm-1, (m, a, n)], normals as ``NORMALS``.
    counted: FloatArray  #: Weight of each wavenumber of the view's band in the counted radiance [1, (n,)]; 1 for a detector of energy.

    @classmethod
    def of(cls, view: SeaView, counted: Counting | None = None) -> Surroundings:
        """Return the surroundings of a view's sky and mean sea for a detector of photons; without ``counted`` for one of energy."""
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
        table = view.scattered.sea_sky_within(view.farthest_turn, 1)
        if not is_dark(table):
            shares = scattered_shares(np.arcsin(sine)[:, None], azimuth, table)
            light[:_ELEVATIONS] += view.sun_distance_factor * np.maximum(shares @ table.spectral, 0.0)
        up = np.concatenate([sine, -sine])
        solid = np.concatenate([weight, weight])[:, None] * share
        return cls(view, _hemispheres(up, azimuth, solid, light), np.ones(view.in_band.wavenumber_cm.size)).counting(counted)

    def counting(self, counted: Counting | None) -> Surroundings:
        """Return the same light for a detector of photons, or of energy (None)."""
        nu = self.view.in_band.wavenumber_cm
        return replace(self, counted=np.ones(nu.size) if counted is None else np.asarray(counted(nu), np.float64))

    @property
    def sun(self) -> FloatArray:
        """Unit vector to the Sun's centre, east, north and up [1, (3,)]."""
        z, a = self.view.solar_zenith, self.view.solar_azimuth
        return np.array([math.sin(z) * math.sin(a), math.sin(z) * math.cos(a), math.cos(z)])

    @property
    def shines(self) -> bool:
        """True if the Sun's centre is above the horizontal and the band has sunlight."""
        return bool(self.view.solar_zenith < 0.5 * np.pi and self.view.irradiance.any())

    @cached_property
    def _sea(self) -> FloatArray:
        """Radiance of a blackbody at the sea's temperature [W m-2 sr-1 per cm-1, (n,)]."""
        return planck_wavenumber(self.view.in_band.wavenumber_cm, self.view.sea_temperature)

    @cached_property
    def sea_counted(self) -> float:
        """Counted radiance over radiance, for a blackbody at the sea's temperature [1]."""
        sea = self.view.in_band.weights * self._sea
        return float(sea @ self.counted / sea.sum())

    def arriving(self, places: list[Corners], sources: Sequence[FloatArray | GasPlume]) -> list[Arriving]:
        """Return the sums over the band for bodies at some places: surfaces at temperatures [K, (k,)], or plumes."""
        if not places:
            return []
        eye, view = self.view.sensor_height, self.view
        arcs = np.array([[p.arc[0], p.arc[1], p.arc[0], p.arc[1]] for p in places])
        heights = np.array([[p.height[0], p.height[0], p.height[1], p.height[1]] for p in places])
        heights = np.maximum(np.maximum(heights, 0.0), _lowest_visible(eye, arcs))
        tau = np.clip(view.atmosphere.transmittance(eye, arcs, heights)[..., view.in_band.grid], 0.0, 1.0) * view.in_band.weights
        kinds = np.stack([np.ones_like(self.counted), self.counted])[:, None]
        path = view.atmosphere.path_radiance(eye, arcs, heights)[..., view.in_band.grid] * view.in_band.weights
        sunlight = tau * (view.irradiance / np.pi) if self.shines else np.zeros_like(tau)
        scattered = self._scattered(arcs, heights, places)
        out = []
        for i, (place, source) in enumerate(zip(places, sources, strict=True)):
            through_air = tau[i] * kinds
            sun = (sunlight[i] * kinds).sum(axis=-1)
            # sunlight scattered into the path is known as a sum over the band: its assumed spectrum is that of arriving sunlight
            as_counted = np.divide(sun, sun[0], out=np.ones_like(sun), where=sun[0] > 0.0)
            lengths = (place.arc[1] - place.arc[0], place.height[1] - place.height[0])
            corner = np.array(
                [
                    place.arc[0],
                    1.0 / lengths[0] if lengths[0] > 0.0 else 0.0,
                    place.height[0],
                    1.0 / lengths[1] if lengths[1] > 0.0 else 0.0,
                ]
            )
            emitted, cover = (
                self._plume(source, through_air) if isinstance(source, GasPlume) else (self._blackbodies(source, through_air), np.zeros(0))
            )
            mirrored = np.ascontiguousarray(np.tensordot(through_air, self.diffuse, axes=(2, 2)))
            along = (path[i] * kinds).sum(axis=-1) + scattered[i] * as_counted
            out.append(Arriving(corner, np.ascontiguousarray(emitted), mirrored, sun, along, cover, tau[i, 0].copy()))
        return out

    def _blackbodies(self, kelvin: FloatArray, through_air: FloatArray) -> FloatArray:
        """Return the light of blackbodies at temperatures [K, (k,)] through the air [W m-2 sr-1, (2, corners, k)]."""
        return np.asarray(through_air @ planck_wavenumber(self.view.in_band.wavenumber_cm, kelvin[:, None]).T)

    def _plume(self, plume: GasPlume, through_air: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the emission of a plume through the air along its chords [W m-2 sr-1, (2, corners, k)], and the absorbed share [1, (k,)].

        The share is of the light behind the plume, approximated by a blackbody at the sea's temperature through the same air: most of it is
        such light, and air emits as much as it absorbs. One share serves both kinds of light and all corners; the emission contains the
        difference to their exact shares, so that a plume at the sea's temperature is invisible.
        """
        absorbed = plume_emissivity(plume, self.view.in_band.wavenumber_cm).T
        behind = through_air * self._sea
        mean = behind[0].mean(axis=0)
        # in opaque air the band's weights alone
        weights = mean if mean.any() else self.view.in_band.weights
        cover = weights @ absorbed / weights.sum()
        emitted = (through_air * planck_wavenumber(self.view.in_band.wavenumber_cm, plume.temperature)) @ absorbed
        return emitted + behind.sum(axis=-1)[..., None] * cover - behind @ absorbed, np.ascontiguousarray(cover)

    def bare_cover(self, plume: GasPlume) -> FloatArray:
        """Return the share of the sea's blackbody radiance that a plume absorbs along its chords, without air [1, (k,)]."""
        weights = self.view.in_band.weights * self._sea
        return np.asarray(plume_emissivity(plume, self.view.in_band.wavenumber_cm) @ weights / weights.sum())

    def cover_of(self, part: GasPlume | object) -> FloatArray:
        """Return the share of the light behind a plume that it absorbs along its chords, without air [1, (k,)]; empty for other parts."""
        return self.bare_cover(part) if isinstance(part, GasPlume) else np.zeros(0)

    def _scattered(self, arcs: FloatArray, heights: FloatArray, places: list[Corners]) -> FloatArray:
        """Return the sunlight scattered into the paths [W m-2 sr-1, (places, corners)].

        It is approximated by a path to the sea of equal length, in the direction of the body.
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
        # no path to the sea is shorter than the height of the sensor: shorter paths scatter in proportion to their length
        return np.asarray(view.sun_distance_factor * radiance * np.minimum(slant / eye, 1.0))

    def kelvin(self, radiance: float) -> float:
        """Return the apparent temperature [K] of a band radiance [W m-2 sr-1]."""
        return float(apparent_temperature(np.array([radiance]), self.view.band, self.view.atmosphere.wavenumber_cm)[0])


def _azimuths() -> tuple[FloatArray, FloatArray]:
    """Return azimuths from the Sun on one side [rad], denser near it, and their weights for both sides [rad]."""
    x, w = np.polynomial.legendre.leggauss(_AROUND)
    u, crowd = 0.5 * (1.0 + x), 4.0
    return np.pi * np.sinh(crowd * u) / np.sinh(crowd), w * np.pi * crowd * np.cosh(crowd * u) / np.sinh(crowd)


def _hemispheres(up: FloatArray, azimuth: FloatArray, solid: FloatArray, light: FloatArray) -> FloatArray:
    """Return means over hemispheres of the normals [X, (m, a, n)] of light [X, (elevations, azimuths, n)] with solid angles [sr].

    Each azimuth represents both sides of the Sun; weights are normalised to a sum of 1.
    """
    cosines, turns = np.linspace(-1.0, 1.0, NORMALS[0]), np.linspace(0.0, np.pi, NORMALS[1])
    level = np.sqrt(1.0 - up**2)[:, None]
    out = np.empty((*NORMALS, light.shape[-1]))
    for m, c in enumerate(cosines):
        s = math.sqrt(max(1.0 - c * c, 0.0))
        for a, turn in enumerate(turns):
            cosine = sum(np.maximum(c * up[:, None] + s * level * np.cos(azimuth - side * turn), 0.0) for side in (1.0, -1.0))
            weight = solid * cosine
            out[m, a] = np.tensordot(weight / weight.sum(), light, axes=2)
    return out


def _lowest_visible(eye: float, arcs: FloatArray) -> FloatArray:
    """Return the height of points at arcs [m] with a line to the sensor that touches the depth ``LOWEST_LINE``; 0 for nearer points."""
    radius = EFFECTIVE_EARTH_RADIUS + LOWEST_LINE
    beyond = arcs / EFFECTIVE_EARTH_RADIUS - math.acos(radius / (EFFECTIVE_EARTH_RADIUS + eye))
    return np.asarray(np.where(beyond > 0.0, radius / np.cos(np.maximum(beyond, 0.0)) - EFFECTIVE_EARTH_RADIUS, 0.0))
