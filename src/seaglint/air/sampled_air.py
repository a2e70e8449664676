"""Atmosphere from spectra at nodes, for one sensor height: a user's calculation or measurement, or a live run of LOWTRAN7.

Between the nodes the same quantities are splined as in the tables (``seaglint.air.lowtran_table``): encoded optical depth and
effective air temperature of the path, encoded optical depth towards the Sun, brightness temperature of the sky.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from seaglint.air.coordinates import decode_optical_depth, elevation_coordinate, encode_optical_depth, heights_along, path_coordinate
from seaglint.air.protocol import ANGLE_SLACK, ClearAir, ScatteredSamples, require_line, require_range, require_solar_zenith, slant_range
from seaglint.air.sun_and_sky import Sky, SkySamples, brightness_temperature, radiance_of
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance

if TYPE_CHECKING:
    from seaglint.air.scattering.scattering_laws import ScatteringAir

OPAQUE = 25.0  #: Largest optical depth: transmittance 1e-11.

CLEAR = 1e-6  #: Smallest optical depth whose emission is evaluated.

HEIGHT_SLACK = 1e-3  #: Tolerance within which two heights are equal [m].

FILE_SUN = 1.02  #: Ratio of assumed extraterrestrial sunlight to the largest value given, where no solar spectrum is known.


#: Scale height of the absorber [m], equal to water vapour's: paths to points above the sea are matched by equal amounts of it.
SCALE_HEIGHT = 2000.0

#: Least and largest power of the path length with which optical depth grows; strong lines grow by the root, continua linearly.
GROWTH = (0.3, 1.0)


class LiveLine(Protocol):
    """Calculation of single lines from the sensor to points above the sea."""

    def reaches(self, range_m: FloatArray, target_height: FloatArray) -> NDArray[np.bool_]:
        """True if the calculation covers the points at these arcs and heights [m, (cases,)]."""
        ...

    def __call__(self, range_m: FloatArray, target_height: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and thermal radiance [W m-2 sr-1 per cm-1], both (cases, n)."""
        ...


@dataclass(frozen=True, eq=False)
class PathSamples:
    """Paths from the sea to the sensor at ascending arcs ``range_m`` [m, (k,)]: transmittance [1], thermal radiance, both (k, n).

    ``beyond`` is true if the last one touches the sea horizon, so that longer ones (to wave crests) continue along the tangent.
    """

    range_m: FloatArray
    transmittance: FloatArray
    radiance: FloatArray
    beyond: bool = False


@dataclass(frozen=True, eq=False)
class SunSamples:
    """Sunlight at the sea, normal to the beam, at 1 au (k, n), at ascending zenith angles [rad, (k,)]; ``source``: outside the air (n)."""

    zenith: FloatArray
    irradiance: FloatArray
    source: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class SampledAtmosphere(ClearAir):
    """Atmosphere of spectra at nodes with splines between them, for one sensor height. Make it with :meth:`create`.

    Notes
    -----
    Other sensor heights, arcs beyond the samples (unless they reach the horizon), and angles outside them are refused with the range
    covered. The sky from a height between the horizontal and the horizon of the calculation is stretched to the horizon of
    ``seaglint.base.conventions``. The accuracy depends on the nodes: with the nodes of
    ``seaglint.formats.lowtran.lowtran_sample``, band quantities are within 0.03 % of LOWTRAN7 runs between them.

    Examples
    --------
    >>> nu = np.arange(2000.0, 2100.0, 5.0)
    >>> one = np.ones((3, nu.size))
    >>> air = SampledAtmosphere.create(
    ...     nu,
    ...     height=10.0,
    ...     path=PathSamples(np.array([0.0, 100.0, 1000.0]), 0.9 * one, 0.0 * one),
    ...     sun=SunSamples(np.radians([0.0, 45.0, 90.0]), 1e-3 * one),
    ...     skies=[SkySamples(0.0, np.radians([0.0, 45.0, 90.0]), 1e-4 * one)],
    ... )
    >>> round(float(air.transmittance(10.0, 500.0)[0]), 6)
    0.9
    """

    wavenumber_cm: FloatArray
    height: float
    name: str
    provenance: JsonObject
    _beyond: bool
    _ranges: tuple[float, float]
    _longest: float
    _zeniths: tuple[float, float]
    _source: FloatArray
    _depth: CubicSpline[np.float64]
    _temperature: CubicSpline[np.float64]
    _sun: CubicSpline[np.float64]
    _skies: tuple[Sky, ...] = field(default=())
    _line: LiveLine | None = None
    _scattering: Callable[[], ScatteringAir] | None = None
    _unbounded: tuple[bool, bool] = (False, False)
    scattered: ScatteredSamples | None = None  #: Sunlight scattered by the air, where the calculation contains it.

    @classmethod
    def create(
        cls,
        wavenumber_cm: FloatArray,
        *,
        height: float,
        path: PathSamples,
        sun: SunSamples,
        skies: Sequence[SkySamples],
        line: LiveLine | None = None,
        scattered: ScatteredSamples | None = None,
        scattering: Callable[[], ScatteringAir] | None = None,
        name: str = "sampled atmosphere",
        provenance: JsonObject | None = None,
    ) -> SampledAtmosphere:
        """Prepare the splines.

        Parameters
        ----------
        wavenumber_cm : ndarray
            Ascending spectral samples [cm-1, (n,)].
        height : float
            Sensor height of ``path`` [m], above 0.
        path, sun, skies
            The samples; one sky must be the sky at the sea (height 0).
        line : LiveLine, optional
            The calculation itself, for paths to points above the sea.
        scattered : ScatteredSamples, optional
            Sunlight scattered by the air.
        scattering : callable, optional
            Function that computes the scatterers on all spectral samples on request; without it the air scatters no sunlight.
        name : str
            Name of the atmosphere in error messages.
        provenance : dict, optional
            Provenance of the spectra.

        Raises
        ------
        DataError
            Fewer than two nodes, nodes not ascending, no sky from the sea, values out of their range.
        """
        nu = np.asarray(wavenumber_cm, dtype=np.float64)
        if not height > 0.0:
            raise DomainError(
                f"sensor height = {height:g} m; give a height above 0 m", name="sensor_height", value=height, allowed="above 0 m"
            )
        _ascending(f"{name}: range_m", path.range_m, 2)
        _ascending(f"{name}: sun zenith", sun.zenith, 2)
        for sky in skies:
            _ascending(f"{name}: sky elevation", sky.elevation, 2)
        if not any(sky.height <= HEIGHT_SLACK for sky in skies):
            raise DataError(f"{name}: has no sky seen from the sea (height 0 m), which the water mirrors; add it")
        depth = np.clip(-np.log(np.maximum(path.transmittance, 1e-300)), CLEAR, OPAQUE)
        temperature = brightness_temperature(nu, path.radiance / -np.expm1(-depth))
        longest = float(slant_range(height, path.range_m[-1]))
        if longest < height * (1.0 + 1e-6):
            raise DataError(
                f"{name}: its ranges up to {path.range_m[-1]:g} m are all straight below a sensor at {height:g} m; add longer ones"
            )
        x = path_coordinate(slant_range(height, path.range_m), height, longest)
        keep = np.concatenate([[True], np.diff(x) > 1e-9])  # arcs much shorter than the height are all straight down
        source = _solar_source(nu, sun)
        sun_depth = np.clip(-np.log(np.maximum(sun.irradiance, 1e-300) / source), 0.0, OPAQUE)
        elevation = np.maximum(0.5 * np.pi - np.asarray(sun.zenith)[::-1], 0.0)
        return cls(
            wavenumber_cm=nu,
            height=float(height),
            name=name,
            provenance=dict(provenance or {"table": name}),
            _beyond=path.beyond,
            _ranges=(float(path.range_m[0]), float(path.range_m[-1])),
            _longest=longest,
            _zeniths=(float(sun.zenith[0]), float(sun.zenith[-1])),
            _source=source,
            _depth=CubicSpline(x[keep], encode_optical_depth(depth[keep]), axis=0),
            _temperature=CubicSpline(x[keep], temperature[keep], axis=0),
            _sun=CubicSpline(elevation_coordinate(elevation, 0.0), encode_optical_depth(sun_depth[::-1]), axis=0),
            _skies=tuple(Sky.of(sky, nu) for sky in skies),
            _line=line,
            scattered=scattered,
            _scattering=scattering,
        )

    def _coordinate(self, height: float, range_m: ArrayLike) -> FloatArray:
        arc = require_range(range_m)
        if abs(height - self.height) > HEIGHT_SLACK:
            raise DomainError(
                f"sensor height = {height:g} m: {self.name} holds paths to {self.height:g} m only; set sensor.height_m to that",
                name="sensor_height",
                value=height,
                allowed=(self.height, self.height),
            )
        first, last = self._ranges
        # Straight down is one path, however the arcs are rounded there.
        nearest = 0.0 if self._unbounded[0] or first <= 0.05 * self.height else first * (1.0 - 1e-6)
        farthest = np.inf if self._unbounded[1] or self._beyond else last * (1.0 + 1e-6)
        outside = (arc < nearest) | (arc > farthest)
        if outside.any():
            wrong = arc[outside].ravel()[0]
            raise DomainError(
                f"range = {wrong:.4g} m is outside {first:g}-{last:g} m of {self.name}; look elsewhere or add paths to it",
                name="range_m",
                value=float(wrong),
                allowed=(first, last),
            )
        return path_coordinate(slant_range(height, arc), height, self._longest)

    def seen_between(self, nearest: float, farthest: float | None) -> SampledAtmosphere:
        """Return the same air for a picture with sea between two arcs only [m]; None means up to the horizon.

        The samples must cover these arcs.

        Models tabulate a view in all directions, whatever part of it they draw: outside the picture their tables take the samples'
        continuation (by the power of the length below them, along their tangent above), which reaches no pixel.

        Raises
        ------
        DomainError
            The samples do not hold an end of the picture.
        """
        self._coordinate(self.height, [nearest] if farthest is None else [nearest, farthest])
        return replace(self, _unbounded=(True, farthest is not None))

    def _sea_depth(self, x: FloatArray, arc: FloatArray) -> FloatArray:
        """Optical depth [1, (..., n)] of paths from the sea at coordinates ``x`` that belong to arcs [m]."""
        depth = decode_optical_depth(_along(self._depth, x))
        slant, shortest = slant_range(self.height, arc), float(slant_range(self.height, self._ranges[0]))
        return depth * self._shortened(slant, np.maximum(slant, shortest)) if np.any(slant < shortest) else depth

    def _shortened(self, slant: FloatArray, inside: FloatArray) -> FloatArray:
        """Ratio [1, (..., n)] of the optical depth of shorter paths [m, (...)] to the optical depth of paths ``inside`` the samples."""
        if not np.any(slant < inside):
            return np.ones((1,))
        shortest = float(slant_range(self.height, self._ranges[0]))
        # the power of the length, from the depths of the shortest sample and of a path 1.3 times as long
        ends = path_coordinate(shortest * np.array([1.0, 1.3]), self.height, self._longest)
        near, farther = np.maximum(decode_optical_depth(_along(self._depth, ends)), CLEAR)
        return np.asarray((slant / inside)[..., np.newaxis] ** np.clip(np.log(farther / near) / np.log(1.3), *GROWTH))

    def path(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and thermal path radiance [W m-2 sr-1 per cm-1] together, both (..., n).

        ``target_height`` [m], broadcast with ``range_m``, belongs to the point looked at. Paths to a point above the sea are computed by
        the calculation behind the samples, if available. Otherwise a path from the sea is used, of such a length that it holds the same
        amount of an absorber with the scale height ``SCALE_HEIGHT``; below the length of the shortest sample, its optical depth falls
        with the power of the length by which the shortest samples differ.
        """
        arc, target = require_line(height, range_m, target_height)
        if not target.any():
            x = self._coordinate(height, arc)
            depth = self._sea_depth(x, arc)
            return np.exp(-depth), -np.expm1(-depth) * radiance_of(self.wavenumber_cm, _along(self._temperature, x))
        self._coordinate(height, arc[target == 0.0])  # refuses the same heights as alone
        shape, n = arc.shape, self.wavenumber_cm.size
        arc, target = arc.ravel(), target.ravel()
        transmittance, radiance = np.empty((arc.size, n)), np.empty((arc.size, n))
        live = np.zeros(arc.size, dtype=np.bool_) if self._line is None else (target != 0.0) & self._line.reaches(arc, target)
        if self._line is not None and live.any():
            transmittance[live], radiance[live] = self._line(arc[live], target[live])
        if not live.all():
            transmittance[~live], radiance[~live] = self._equal_amount(arc[~live], target[~live])
        return transmittance.reshape(*shape, n), radiance.reshape(*shape, n)

    def _equal_amount(self, arc: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Transmittance and radiance [(cases, n)] of the paths from the sea with the same absorber amount as those to points."""
        slant = slant_range(self.height, arc, target)
        # mean densities along both lines of equal length turn the line into a sea path of equal amount
        slant = np.where(target == 0.0, slant, slant * _mean_density(self.height, target, slant) / _mean_density(self.height, 0.0, slant))
        shortest = float(slant_range(self.height, self._ranges[0]))
        inside = np.maximum(slant, shortest)
        if not self._beyond and np.any(inside > self._longest * (1.0 + 1e-6)):
            raise DomainError(
                f"a point at a range of {arc[np.argmax(inside)]:.4g} m needs a path of {inside.max():.4g} m: {self.name} holds paths up to "
                f"{self._longest:.4g} m; leave the point out or add longer paths"
            )
        x = path_coordinate(inside, self.height, self._longest)
        depth = decode_optical_depth(_along(self._depth, x)) * self._shortened(slant, inside)
        return np.exp(-depth), -np.expm1(-depth) * radiance_of(self.wavenumber_cm, _along(self._temperature, x))

    def transmittance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Transmittance of the path from a point at arcs ``range_m`` [m, (...)] and a height to the sensor [1, (..., n)]."""
        if not np.any(target_height):
            return np.asarray(np.exp(-self._sea_depth(self._coordinate(height, range_m), require_range(range_m))))
        return self.path(height, range_m, target_height)[0]

    def path_radiance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Thermal radiance of the air between the point and the sensor [W m-2 sr-1 per cm-1, (..., n)]."""
        return self.path(height, range_m, target_height)[1]

    def scattering(self, grid: slice) -> ScatteringAir | None:
        """Scatterers on part of the spectral samples; None if not known. They are computed at every call."""
        return self._scattering().cut(grid) if self._scattering is not None else None

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (..., n)]; 0 beyond a zenith angle of pi/2."""
        zenith = require_solar_zenith(solar_zenith)
        up = zenith <= 0.5 * np.pi + ANGLE_SLACK
        first, last = self._zeniths
        outside = up & ((zenith < first - ANGLE_SLACK) | (np.minimum(zenith, 0.5 * np.pi) > last + ANGLE_SLACK))
        if outside.any():
            wrong, covered = np.degrees(zenith[outside].ravel()[0]), f"{np.degrees(first):g}-{np.degrees(last):g} deg"
            raise DomainError(
                f"solar zenith = {wrong:.4g} deg is outside {covered} of {self.name}; move the Sun or add sunlight to it",
                name="solar_zenith",
                value=float(zenith[outside].ravel()[0]),
                allowed=(first, last),
            )
        y = elevation_coordinate(np.maximum(0.5 * np.pi - zenith, 0.0), 0.0)
        sunlight = self._source * np.exp(-decode_optical_depth(np.asarray(self._sun(np.clip(y, self._sun.x[0], self._sun.x[-1])))))
        return np.asarray(np.where(up[..., np.newaxis], sunlight, 0.0))

    def sky_radiance(self, zenith: ArrayLike, azimuth: ArrayLike, height: float = 0.0) -> FloatArray:
        """Thermal radiance of the clear sky in directions [rad, (...)] from ``height`` [W m-2 sr-1 per cm-1, (..., n)].

        ``height`` is 0 or the sensor's; from there the angles reach down to the sea horizon, ``pi/2 + horizon_depression(height)``.
        """
        sky = next((sky for sky in self._skies if abs(sky.height - height) <= HEIGHT_SLACK), None)
        dip = horizon_depression(height) if height > 0.0 else 0.0
        horizon = f"{90.0 + np.degrees(dip):.2f} deg"
        if sky is None:
            covered = " and ".join(f"{sky.height:g} m" for sky in self._skies)
            raise DomainError(
                f"sky seen from the sensor at {height:g} m: {self.name} holds the sky from {covered} only; add it, from the zenith down to "
                f"the sea horizon at a zenith angle of {horizon}, or look at the sea only",
                name="sky_height",
                value=height,
                allowed=covered,
            )
        angle = np.broadcast_arrays(np.asarray(zenith, dtype=np.float64), azimuth)[0]
        elevation = 0.5 * np.pi - angle
        outside = ~((elevation >= -dip - ANGLE_SLACK) & (elevation <= 0.5 * np.pi + ANGLE_SLACK))
        if outside.any():
            raise DomainError(
                f"zenith has values outside 0-{np.degrees(0.5 * np.pi + dip):.4f} deg, where the sky of a sensor at {height:g} m ends; "
                "directions below the sea horizon see the sea",
                name="zenith",
                value=float(angle[outside].ravel()[0]),
                allowed=(0.0, 0.5 * np.pi + dip),
            )
        if sky.dip > 0.0 and dip > 0.0:
            elevation = np.where(elevation < 0.0, elevation * (sky.dip / dip), elevation)
        # A file's lowest row is the user's choice; the last degree of a calculation's own horizon is not.
        outside = (elevation < sky.lowest - max(0.01 * sky.dip, 1e-4)) | (elevation > sky.highest + max(ANGLE_SLACK, 1e-4))
        if outside.any():
            covered = f"{90.0 - np.degrees(sky.highest):g}-{90.0 - np.degrees(sky.lowest):g} deg of {self.name}"
            viewpoint, end = (f"sensor at {height:g} m", f"the sea horizon at {horizon}") if dip > 0.0 else ("sea", "90 deg")
            raise DomainError(
                f"sky seen from the {viewpoint}: zenith angles outside {covered} are needed; add the sky there, down to {end}",
                name="zenith",
                value=float(0.5 * np.pi - np.asarray(elevation)[outside].ravel()[0]),
                allowed=(0.5 * np.pi - sky.highest, 0.5 * np.pi - sky.lowest),
            )
        return radiance_of(self.wavenumber_cm, sky(elevation))


def _mean_density(height: float, target: ArrayLike, slant: FloatArray) -> FloatArray:
    """Mean of ``exp(-z / SCALE_HEIGHT)`` along lines from the sensor to points, over the value at the sea [1, (cases,)]."""
    node, weight = np.polynomial.legendre.leggauss(8)
    z = heights_along(height, np.asarray(target, dtype=np.float64)[..., np.newaxis], slant[..., np.newaxis], 0.5 * (1.0 + node))
    return np.asarray(np.exp(-np.maximum(z, 0.0) / SCALE_HEIGHT) @ (0.5 * weight))


def _along(spline: CubicSpline[np.float64], x: FloatArray) -> FloatArray:
    """Spline between the nodes, with the end's tangent beyond the last one and the first value before the first."""
    inside = np.clip(x, spline.x[0], spline.x[-1])
    values = np.asarray(spline(inside))
    beyond = np.maximum(x - spline.x[-1], 0.0)[..., np.newaxis]
    return values + beyond * spline(spline.x[-1], 1) if np.any(beyond) else values


def _solar_source(nu: FloatArray, sun: SunSamples) -> FloatArray:
    """Sunlight outside the atmosphere, nowhere below the sunlight at the sea."""
    # sunlight at the sea below the source keeps every optical depth above 0
    largest = FILE_SUN * np.max(sun.irradiance, axis=0)
    if sun.source is not None:
        return np.maximum(np.asarray(sun.source, dtype=np.float64), 1e-300)
    try:
        known = exoatmospheric_irradiance(nu)
    except DomainError:
        known = np.zeros(nu.size)
    return np.asarray(np.maximum(np.maximum(known, largest), 1e-300))


def _ascending(what: str, nodes: FloatArray, least: int) -> None:
    values = np.asarray(nodes)
    # Nodes that differ by rounding alone are one node in the coordinates of the splines.
    if values.size < least or not np.all(np.isfinite(values)) or not np.all(np.diff(values) > 1e-12 * np.max(np.abs(values))):
        raise DataError(f"{what}: {values.size} nodes; at least {least} are needed, ascending and all different")
