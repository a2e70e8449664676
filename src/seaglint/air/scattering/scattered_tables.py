"""Tables of scattered sunlight for ``seaglint.air.scattering.scattered_light``.

They are made from lines of sight computed one by one (``ScatteredLight``), or from the samples of a user's calculation
(``SampledLight``).
"""

from __future__ import annotations

import hashlib
import itertools
import math
import pickle
import threading
from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple, cast

import numpy as np
from numpy.polynomial import chebyshev
from scipy.interpolate import CubicSpline, PchipInterpolator

from seaglint.air.coordinates import elevation_of_coordinate, straight_sea_cosine, straight_slant
from seaglint.air.protocol import Atmosphere, ScatteredSamples, ScatteredSky, slant_range
from seaglint.air.scattering.lowtran_ray import invariant_of
from seaglint.air.scattering.scattered_light import DARK, ScatteredTable
from seaglint.air.scattering.scattered_line import KINDS, horizon_zenith
from seaglint.air.scattering.scattering_laws import ScatteringAir, scattering_angle
from seaglint.air.scattering.twilight import LOWEST_SUN, fading
from seaglint.air.sun_and_sky import grazing_coordinate, grazing_share
from seaglint.base.constants import DARK_SUN
from seaglint.base.conventions import FloatArray, depression_of_range, horizon_depression

ANGLES: Final = 721
FILE_COLUMNS: Final = 65
ROWS: Final = 257
FILE_DIP_ROWS: Final = 64

#: Height [m] up to which the sky below the horizontal is the horizontal's.
#:
#: LOWTRAN7 makes the sensor's height a level, and the thin layer below it, with different air, would appear as a line above the sea.
LOW: Final = 300.0

_RANK: Final = 1e-4  #: Relative singular value of the spectra below which components are dropped.

ELEVATION_NODES: Final = 26
DIP_NODES: Final = 12
DIP_PIECE_NODES: Final = 6

#: Numbers of computed lines from the horizontal up, down to the horizon (fewer between two grazed levels), and to the sea.
PATH_NODES: Final = 26

DIP_ROWS: Final = 128
COLUMNS: Final = 17  #: Rows and columns of the tables, splined from the computed lines.

SHAPE_ERROR: Final = 3e-4  #: Root-mean-square relative error of the phase function expansion, weighted over kinds and wavenumbers.

SPECTRAL_ERROR: Final = 1e-3  #: Largest root-mean-square relative error of a spectrum, a tenth of which remains in sums over the band.

MOST_SHAPES: Final = 10

LEAST_COSINE: Final = 1e-5  #: Cosine of the zenith angle at the sea of the last path, which almost grazes the sea.

_LEAST: Final = 1e-30

_SUNS: Final = 7  #: Number of zenith angles of the Sun that are computed for the places in view; three if they differ little.

SUN_ROWS: Final = 13  #: Number of tabulated zenith angles of the Sun.

_SMALL_TURN: Final = np.radians(1.0)

_ONE_SUN: Final = np.radians(0.1)  #: Largest difference of zenith angles that is treated as one Sun [rad].

#: Numbers of computed lines from the horizontal up and to the sea in twilight, whose light changes quickly at the Earth's shadow: it is
#: interpolated linearly in its logarithm, above a floor relative to the brightest line.
TWILIGHT_NODES: Final = 31
_DARKEST: Final = 1e-7

#: Columns of the tables at which twilight is computed, denser near the Sun.
_TWILIGHT_COLUMNS: Final = (0, 1, 2, 4, 6, 8, 11, 14, 16)

#: Largest step between computed Suns in twilight [rad], and its growth with their height above the horizon.
_SUN_STEP, _SUN_GROWTH = math.radians(0.5), 0.5

_HIGH_SUN, _LOW_SUN = np.radians((60.0, 80.0))

_MOST_CACHED: Final = 2
_CACHED: Final[OrderedDict[bytes, ScatteredLight]] = OrderedDict()
_LOCK: Final = threading.Lock()


class _Computed(NamedTuple):
    """Sums over computed lines of sight, before they are resampled to a table."""

    angular: FloatArray  #: Shapes over scattering angle, as in the table.
    spectral: FloatArray  #: Spectral shapes, as in the table.
    values: FloatArray  #: Sums at the nodes [(suns, nodes, azimuths, k, r)].
    azimuths: FloatArray  #: Azimuths from the Sun [rad].
    twilit: bool  #: True if one of the Suns is cut by the horizon or below it.


class _SeaLines(NamedTuple):
    """Lines computed from the sea, whose Suns lie between the apparent zenith angles ``first`` and ``last`` [rad], equal for one Sun."""

    lines: _Computed
    rows: FloatArray  #: Matrix from nodes to rows.
    nodes: FloatArray  #: Places of the Suns between the first and the last [1], from 0 to 1.
    first: float
    last: float


@dataclass(frozen=True, eq=False)
class SampledLight:
    """Scattered sunlight of a file, for its one Sun; as ``seaglint.air.scattering.scattered_tables.ScatteredLight``.

    Radiance is split into a function of the scattering angle, which has the aureole, and the smooth rest, which is interpolated
    linearly between the file's directions. Directions that the file omits are dark.
    """

    samples: ScatteredSamples
    grid: slice
    weights: FloatArray
    height: float

    @property
    def is_dark(self) -> bool:
        """True if nothing is scattered."""
        return False

    @cached_property
    def path(self) -> ScatteredTable:
        """Table of scattered path radiance to the sea, in band."""
        path, samples = self.samples.path, self.samples
        if path is None:
            return DARK
        slant = slant_range(self.height, samples.range_m)
        longest = float(max(slant[-1], 1.001 * self.height))
        even = self.height * (longest / self.height) ** np.linspace(0.0, 1.0, ROWS)
        zenith = 0.5 * np.pi + depression_of_range(self.height, samples.range_m)
        table = self._table(zenith, path[..., self.grid] @ self.weights, np.log(slant), np.log(even))
        return table._replace(height=self.height, longest=longest)

    @cached_property
    def sky(self) -> ScatteredTable:
        """Table of the scattered sky above the sensor, in band."""
        sky = self._sky_from(self.height)
        if sky is None:
            return DARK
        dip = horizon_depression(self.height)
        below = -dip * (1.0 - np.arange(FILE_DIP_ROWS) / FILE_DIP_ROWS) ** 2
        rows = 0.5 * np.pi - np.concatenate([below if self.height > LOW else 0.0 * below, self._elevations])
        table = self._table(sky.zenith, sky.radiance[..., self.grid] @ self.weights, sky.zenith, rows)
        return table._replace(height=self.height, dip=dip, dip_rows=FILE_DIP_ROWS)

    @cached_property
    def sea_sky(self) -> ScatteredTable:
        """Table of the scattered sky above the sea, as spectra."""
        sky = self._sky_from(0.0)
        if sky is None:
            return DARK._replace(spectral=np.zeros((1, self.weights.size)))
        radiance = sky.radiance[..., self.grid]
        _, size, shapes = np.linalg.svd(radiance.reshape(-1, radiance.shape[-1]), full_matrices=False)
        spectral = shapes[: max(int(np.count_nonzero(size > _RANK * size[0])), 1)]
        table = self._table(sky.zenith, radiance @ spectral.T, sky.zenith, 0.5 * np.pi - self._elevations)
        return table._replace(spectral=np.ascontiguousarray(spectral))

    def sea_sky_within(self, turn: float, suns: int = SUN_ROWS) -> ScatteredTable:
        """Table ``sea_sky``, the same for all places and one Sun."""
        return self.sea_sky

    def paths(self, arc: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Scattered path radiance in band [W m-2 sr-1] to the sea at arcs [m] (rows), azimuths from the Sun [rad] (columns)."""
        from seaglint.air.scattering.scattered_light import scattered_path

        elevation = -depression_of_range(self.height, arc)
        if self.samples.path is None:
            return np.zeros((arc.size, azimuth.size))
        return scattered_path(arc[:, None], elevation[:, None], azimuth, self.path)

    @property
    def _elevations(self) -> FloatArray:
        return np.maximum(elevation_of_coordinate(np.linspace(0.0, 1.0, ROWS), 0.0), 0.0)

    def _sky_from(self, height: float) -> ScatteredSky | None:
        # heights within 1 % count as equal
        matches = [sky for sky in self.samples.skies if abs(sky.height - height) <= 0.01 * max(height, 1.0)]
        return matches[0] if matches else None

    def _table(self, zenith: FloatArray, radiance: FloatArray, nodes: FloatArray, rows: FloatArray) -> ScatteredTable:
        """Table of radiance (k, a[, r]) at zenith angles of lines of sight [rad, (k,)]; ``nodes`` (k,) are the coordinates of ``rows``."""
        values = radiance if radiance.ndim == 3 else radiance[..., None]
        sun, azimuth = self.samples.solar_zenith, self.samples.azimuth
        angle = scattering_angle(zenith[:, None], azimuth, sun)
        size = np.sqrt((values**2).sum(axis=2))
        angular = self._angular(angle, size)
        smooth = np.interp(angle, np.linspace(0.0, math.pi, ANGLES), angular)
        # the smooth rest: its magnitude is interpolated as a logarithm, its spectrum linearly
        tiny = 1e-9 * max(float(size.max()), 1e-30)
        split = np.concatenate([np.log(np.maximum(size, tiny) / smooth)[..., None], values / np.maximum(size, tiny)[..., None]], axis=2)
        columns = np.sin(0.5 * azimuth) ** 2
        wide = np.stack(
            [[np.interp(np.linspace(0.0, 1.0, FILE_COLUMNS), columns, part) for part in row.T] for row in split]
        )  # (k, 1 + r, columns)
        order = np.argsort(nodes)
        flat = wide.reshape(nodes.size, -1)[order]
        place = np.clip(np.interp(rows, nodes[order], np.arange(nodes.size)), 0.0, nodes.size - 1.0)
        low = np.minimum(place.astype(np.int64), max(nodes.size - 2, 0))
        part = (place - low)[:, None]
        resampled = ((1.0 - part) * flat[low] + part * flat[np.minimum(low + 1, nodes.size - 1)]).reshape(rows.size, -1, FILE_COLUMNS)
        amplitude = (np.exp(resampled[:, :1]) * resampled[:, 1:]).transpose(0, 2, 1)[None, :, :, None, :]
        return ScatteredTable(angular[:, None], np.ascontiguousarray(amplitude), np.ones((1, 1)), sun, (0.0, 0.0), 1.0, 2.0, 1.0, 0)

    @staticmethod
    def _angular(angle: FloatArray, size: FloatArray) -> FloatArray:
        """Function of the scattering angle that contains the aureole, from the line of sight nearest to the Sun."""
        row = int(np.argmin(angle.min(axis=1)))
        floor = 1e-6 * max(float(size.max()), 1e-30)
        # two azimuths may have one scattering angle; the spline needs distinct ones
        known, first = np.unique(np.round(angle[row], 6), return_index=True)
        log = np.log(np.maximum(size[row][first], floor))
        if known.size < 3:
            return np.ones(ANGLES)
        angles = np.clip(np.linspace(0.0, math.pi, ANGLES), known[0], known[-1])
        return np.asarray(np.exp(PchipInterpolator(known, log)(angles)))


def scattered_in(
    atmosphere: Atmosphere | None, grid: slice, weights: FloatArray, height: float, solar_zenith: float, farthest_turn: float = 0.0
) -> ScatteredLight | SampledLight:
    """Return the scattered sunlight of a band in any atmosphere.

    Vacuum and isothermal air scatter nothing, nor does air in 7.5-14 um, nor a Sun 6 deg or more below the horizon of all places in
    view. Air from a file has the scattered sunlight of the file.

    Parameters
    ----------
    atmosphere : Atmosphere or None
        Source of samples, ``scattered``, or else of scatterers; None to omit scattered sunlight.
    grid, weights : slice, ndarray
        Samples in the band and its quadrature weights there [cm-1, (n,)], as in ``seaglint.facet.sea_view.BandSum``.
    height, solar_zenith, farthest_turn : float
        As for ``ScatteredLight``; ``seaglint.facet.sea_view.SeaView`` has all three.
    """
    up = solar_zenith - farthest_turn < DARK_SUN
    samples = None if atmosphere is None else atmosphere.scattered
    if samples is not None and solar_zenith < DARK_SUN:
        samples.require_sun(solar_zenith, "the file of air")
        return SampledLight(samples, grid, np.asarray(weights, dtype=np.float64), height)
    air = atmosphere.scattering(grid) if up and atmosphere is not None else None
    light = ScatteredLight(air, np.asarray(weights, dtype=np.float64), height, solar_zenith, farthest_turn)
    # Its tables take 0.4 s: a frame reuses the tables of the mean map, and a map the tables of an earlier one with the same air and Sun.
    key = hashlib.blake2b(pickle.dumps(light)).digest()
    with _LOCK:
        light = _CACHED.pop(key, light)
        _CACHED[key] = light
        while len(_CACHED) > _MOST_CACHED:
            _CACHED.popitem(last=False)
    return light


@dataclass(frozen=True, eq=False)
class ScatteredLight:
    """Scattered sunlight of one band, wind, sensor height and Sun; its tables are computed on first use.

    Notes
    -----
    Against line by line sums the tables are within 0.3 % from the horizontal up and along paths while the whole disc is above the horizon
    of all places in view. From then on it is twilight, down to a Sun 6 deg below the horizon (``seaglint.air.scattering.twilight``).
    """

    air: ScatteringAir | None  #: Air on the band's channels; None if nothing scatters: the tables are then dark.
    weights: FloatArray  #: Quadrature weights of the band on them [cm-1, (n,)].
    height: float  #: Sensor height [m].
    solar_zenith: float  #: Apparent zenith angle of the Sun's centre at the sea at the sensor's foot [rad].
    #: Turn of the vertical to the farthest place in view [rad]: ``sea_sky`` covers Suns that much higher and lower.
    farthest_turn: float = 0.0

    @property
    def is_dark(self) -> bool:
        """True if nothing is scattered."""
        return self.air is None

    @cached_property
    def path(self) -> ScatteredTable:
        """Table of scattered path radiance to the sea, in band [W m-2 sr-1]: one spectral shape, which is 1."""
        if self.air is None or self._share == 0.0:
            return DARK
        twilit = self.solar_zenith > LOWEST_SUN
        zenith, arcs, coordinate = _path_lines(self.air, self.height, TWILIGHT_NODES if twilit else PATH_NODES)
        table = self._in_band(zenith, (_linear if twilit else _splined)(coordinate, np.linspace(0.0, 1.0, ROWS)))
        return table._replace(longest=float(slant_range(self.height, arcs[-1])))

    @cached_property
    def sky(self) -> ScatteredTable:
        """Table of the scattered sky above the sensor, in band [W m-2 sr-1]."""
        if self.air is None or self._share == 0.0:
            return DARK
        table = self._in_band(*_sky_lines(self.air, self.height, twilit=self.solar_zenith > LOWEST_SUN))
        return table._replace(dip=horizon_depression(self.height), dip_rows=DIP_ROWS)

    @cached_property
    def sea_sky(self) -> ScatteredTable:
        """Table of the scattered sky above the sea, as spectra."""
        return self.sea_sky_within(self.farthest_turn)

    def sea_sky_within(self, turn: float, suns: int = SUN_ROWS) -> ScatteredTable:
        """Table ``sea_sky`` for places whose vertical is turned by at most ``turn`` [rad]; a tenth of a degree counts as one Sun.

        Parameters
        ----------
        turn : float
            Largest turn of the vertical [rad].
        suns : int
            Number of tabulated zenith angles of the Sun, 2: the ends of their range, 1: the Sun at the sensor's foot alone. In twilight
            there are more where there are several.
        """
        if self.air is None:
            return DARK._replace(spectral=np.zeros((1, self.weights.size)))
        lines, rows, nodes, first, last = self._sea_lines if turn == self.farthest_turn else self._lines_within(turn)
        if first == last:
            table = _table(lines, rows)
            return table._replace(amplitude=self._share * table.amplitude, solar_zenith=self.solar_zenith)
        if lines.twilit and suns > 1:
            suns = max(suns, math.ceil(2.0 * (last - first) / _SUN_STEP) + 1)
        at = np.linspace(0.0, 1.0, suns) if suns > 1 else np.clip([(self.solar_zenith - first) / (last - first)], 0.0, 1.0)
        table = _table(lines, rows, (_linear if lines.twilit else _splined)(nodes, at))
        if lines.twilit:
            weights = np.array([fading(first + share * (last - first)) for share in at.tolist()])
            table = table._replace(amplitude=weights[:, None, None, None, None] * table.amplitude)
        return table._replace(suns=(first, (suns - 1) / (last - first)), solar_zenith=self.solar_zenith)

    @cached_property
    def _sea_lines(self) -> _SeaLines:
        return self._lines_within(self.farthest_turn)

    def _lines_within(self, turn: float) -> _SeaLines:
        """Compute the lines for ``sea_sky_within``."""
        air = cast(ScatteringAir, self.air)
        first, last = _sun_range(self.solar_zenith, turn)
        zenith, rows = _sky_lines(air, 0.0, twilit=last > LOWEST_SUN)
        if last - first <= _ONE_SUN:
            lines = _computed(air, None, 0.0, zenith, max(self._apparent, last), [self._sun])
            return _SeaLines(lines, rows, np.zeros(1), 0.0, 0.0)
        nodes, zeniths = _sun_nodes(first, last)
        suns = [air.unrefracted_zenith(z) for z in zeniths]
        return _SeaLines(_computed(air, None, 0.0, zenith, last, suns), rows, nodes, first, last)

    def paths(self, arc: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Scattered paths to the sea in band [W m-2 sr-1], line by line: arcs [m] (rows), azimuths from the Sun [rad] (columns)."""
        return self.path_spectra(arc, azimuth) @ self.weights

    def path_spectra(self, arc: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Scattered path radiance in every channel [W m-2 sr-1 per cm-1, (rows, columns, n)], as ``paths``."""
        if self.air is None:
            return np.zeros((arc.size, azimuth.size, self.weights.size))
        horizon = slant_range(self.height, float(_path_lines(self.air, self.height)[1][-1]))
        slant = np.clip(slant_range(self.height, arc), self.height, horizon)
        for _ in range(3):  # refraction takes a straight line's end a little farther
            zenith = _path_zenith(self.air, self.height, slant)
            reached = 1e3 * self.air.laws.earth_radius * self.air.arcs(self.height, zenith)
            slant = np.clip(slant * np.where(reached > 0.0, arc / np.maximum(reached, 1e-9), 1.0), self.height, horizon)
        return self._spectra(zenith, azimuth, self.height, self._aloft)

    def sky_spectra(self, zenith: FloatArray, azimuth: FloatArray, height: float) -> FloatArray:
        """Scattered sky in every channel, from a height [m] at zenith angles (rows) and azimuths from the Sun (columns) [rad]."""
        if self.air is None:
            return np.zeros((zenith.size, azimuth.size, self.weights.size))
        return self._spectra(zenith, azimuth, height, float(self.air.apparent_zenith(self._sun, height)))

    def _spectra(self, zenith: FloatArray, azimuth: FloatArray, height: float, apparent: float) -> FloatArray:
        air = cast(ScatteringAir, self.air)
        lines = np.stack(np.broadcast_arrays(zenith[:, None], azimuth, self._sun), axis=-1).reshape(-1, 3)
        amplitudes = air.amplitudes(height, lines)[0] * air.source
        phase = air.phase(scattering_angle(lines[:, 0], lines[:, 1], apparent))
        return np.asarray(self._share * (phase * amplitudes).sum(axis=1)).reshape(zenith.size, azimuth.size, air.source.size)

    @property
    def _apparent(self) -> float:
        return min(self.solar_zenith, DARK_SUN)

    @cached_property
    def _sun(self) -> float:
        """Zenith angle of the Sun without refraction [rad]."""
        return cast(ScatteringAir, self.air).unrefracted_zenith(self._apparent)

    @cached_property
    def _aloft(self) -> float:
        """Apparent zenith angle of the Sun at the sensor [rad]."""
        return float(cast(ScatteringAir, self.air).apparent_zenith(self._sun, self.height))

    @property
    def _share(self) -> float:
        """Weight of the light of a Sun that is as high as at the sensor's foot [1]."""
        return fading(self.solar_zenith)

    def _in_band(self, zenith: FloatArray, rows: FloatArray) -> ScatteredTable:
        """Table in band for lines of sight from the sensor."""
        air = cast(ScatteringAir, self.air)
        lines = _computed(air, self.weights[None], self.height, zenith, self._apparent, [self._sun])
        table = _table(lines, rows)
        return table._replace(amplitude=self._share * table.amplitude, solar_zenith=self._aloft, height=self.height)


def _sun_range(solar_zenith: float, turn: float) -> tuple[float, float]:
    """Range of apparent zenith angles of the Sun at the places in view where the air scatters its light [rad]."""
    return min(max(solar_zenith - turn, 0.0), DARK_SUN), min(solar_zenith + turn, DARK_SUN)


def _sun_nodes(first: float, last: float) -> tuple[FloatArray, FloatArray]:
    """Suns that are computed in a range of zenith angles [rad], denser for a low Sun: places from 0 to 1, and zenith angles [rad]."""
    if last <= LOWEST_SUN:
        t = np.linspace(0.0, 1.0, 3 if last - first < _SMALL_TURN else _SUNS)
        return 1.0 - (1.0 - t) ** 2, last - (last - first) * (1.0 - t) ** 2
    zenith = [last]
    while zenith[-1] > first:
        zenith.append(zenith[-1] - _SUN_STEP - _SUN_GROWTH * max(LOWEST_SUN - zenith[-1], 0.0))
    # even steps a little smaller end at the first
    below = last - np.array(zenith[::-1])
    nodes = 1.0 - below / below[0]
    return nodes, first + (last - first) * nodes


def _azimuth_nodes(solar_zenith: float) -> FloatArray:
    """Azimuths from the Sun [rad], denser near it for a low Sun."""
    if solar_zenith > LOWEST_SUN:
        return 2.0 * np.arcsin(np.sqrt(np.array(_TWILIGHT_COLUMNS) / (COLUMNS - 1)))
    count = 3 if solar_zenith < _HIGH_SUN else 5 if solar_zenith < _LOW_SUN else 8
    return np.linspace(0.0, math.pi, count)  # Chebyshev's extrema in the cosine


def _path_lines(air: ScatteringAir, height: float, nodes: int = PATH_NODES) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Zenith angles at the sensor [rad] of lines to the sea, arcs to their ends [m], their coordinates along the tables' rows."""
    slant = height * (float(straight_slant(height, 0.0)) / height) ** np.linspace(0.0, 1.0, nodes)
    zenith = _path_zenith(air, height, slant)
    arcs = 1e3 * air.laws.earth_radius * air.arcs(height, zenith)
    lengths = slant_range(height, arcs)
    return zenith, arcs, np.asarray(np.log(np.maximum(lengths / height, 1.0)) / np.log(lengths[-1] / height))


def _path_zenith(air: ScatteringAir, height: float, slant: FloatArray) -> FloatArray:
    """Zenith angles at the sensor [rad] of lines with given straight lengths [m]."""
    cosine = np.clip(straight_sea_cosine(height, slant), LEAST_COSINE, 1.0)
    cosine[slant <= height] = 1.0
    at_sea = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    ratio = invariant_of(air.laws, 0.0, 1.0) / invariant_of(air.laws, 1e-3 * height, 1.0)
    return np.asarray(math.pi - np.arcsin(ratio * at_sea))


def _sky_lines(air: ScatteringAir, height: float, *, twilit: bool = False) -> tuple[FloatArray, FloatArray]:
    """Zenith angles [rad] from the horizon up, and the matrix (rows, nodes) that resamples their values to rows."""
    resampled = _linear if twilit else _splined
    y = np.linspace(0.0, 1.0, TWILIGHT_NODES if twilit else ELEVATION_NODES)
    above = np.maximum(0.5 * math.pi - elevation_of_coordinate(y, 0.0), 0.0)
    even = resampled(y, np.linspace(0.0, 1.0, ROWS))
    if height <= 0.0:
        return above, even
    if height <= LOW:  # below the horizontal the horizontal's sky
        return above, np.concatenate([np.repeat(even[:1], DIP_ROWS, axis=0), even])
    edges = _grazed(air, height)
    pieces = len(edges) - 1
    nodes_each = DIP_NODES if pieces == 1 else DIP_PIECE_NODES
    share = np.linspace(0.0, 1.0, nodes_each)
    below = [low + (high - low) * grazing_share(share)[:-1] for low, high in itertools.pairwise(edges)]
    fine = edges[0] * (1.0 - np.arange(DIP_ROWS) / DIP_ROWS) ** 2
    piece = np.clip(np.searchsorted(edges, fine, side="right") - 1, 0, pieces - 1)
    horizontal = pieces * (nodes_each - 1)
    rows = np.zeros((DIP_ROWS + ROWS, horizontal + y.size))
    rows[DIP_ROWS:, horizontal:] = even
    for i in range(pieces):
        in_piece, first = np.flatnonzero(piece == i), i * (nodes_each - 1)
        where = grazing_coordinate((fine[in_piece] - edges[i]) / (edges[i + 1] - edges[i]))
        rows[in_piece, first : first + nodes_each] = resampled(share, where)
    return np.concatenate([0.5 * math.pi - np.concatenate(below), above]), rows


def _splined(nodes: FloatArray, places: FloatArray) -> FloatArray:
    """Matrix (places, nodes) from values at nodes to values of the cubic spline through them at places."""
    return np.asarray(CubicSpline(nodes, np.eye(nodes.size))(places))


def _linear(nodes: FloatArray, places: FloatArray) -> FloatArray:
    """Matrix as ``_splined`` for linear interpolation, which stays between its nodes."""
    return np.stack([np.interp(places, nodes, row) for row in np.eye(nodes.size)], axis=1)


def _grazed(air: ScatteringAir, height: float) -> FloatArray:
    """Elevations, up to the horizontal, of the rays that touch the sea or a level [rad], at which the sky has corners."""
    level = invariant_of(air.laws, 1e-3 * height, 1.0)
    # levels closer than 10 m below the sensor are left to the horizontal's piece
    levels = air.laws.height[(air.laws.height > 0.0) & (1e3 * air.laws.height < height - 10.0)]
    touching = [-math.acos(min(invariant_of(air.laws, float(z), 1.0) / level, 1.0)) for z in levels]
    horizon = (0.5 * math.pi - horizon_zenith(air.laws, 1e-3 * height)) * (1.0 - 1e-3)
    return np.array([horizon, *(e for e in touching if e > horizon), 0.0])


def _computed(
    air: ScatteringAir, weights: FloatArray | None, height: float, zenith: FloatArray, lowest: float, suns: list[float]
) -> _Computed:
    """Compute lines of sight under Suns without refraction [rad]: in band for ``weights`` [(1, n)], else as spectra.

    ``lowest``: the largest apparent zenith angle of these Suns [rad].
    """
    azimuths, twilit = _azimuth_nodes(lowest), lowest > LOWEST_SUN
    grid = np.stack(np.meshgrid(suns, zenith, azimuths, indexing="ij"), axis=-1).reshape(-1, 3)
    amplitudes = air.amplitudes(height, grid[:, [1, 2, 0]], tabulated=True)[0] * air.source
    spectral = np.ones((1, 1)) if weights is not None else _spectral_shapes(air, amplitudes, _DARKEST if twilit else 0.0)
    sums = weights if weights is not None else spectral
    angular, kinds = _angular_shapes(air, amplitudes, sums)
    # share of every shape over angle and spectrum in each kind and channel
    shares = (kinds[:, None] * sums[:, None]).reshape(kinds.shape[0] * sums.shape[0], -1)
    by_shape = amplitudes.reshape(len(amplitudes), -1) @ shares.T
    return _Computed(
        angular, spectral, by_shape.reshape(len(suns), zenith.size, azimuths.size, kinds.shape[0], sums.shape[0]), azimuths, twilit
    )


def _table(lines: _Computed, rows: FloatArray, suns: FloatArray | None = None) -> ScatteredTable:
    """Table of computed lines, resampled by matrices from nodes to rows, and from the Suns of the nodes to those of the table."""
    amplitude = _fine(lines, rows, suns)
    return ScatteredTable(lines.angular, amplitude, lines.spectral, 0.0, (0.0, 0.0), 0.0, 0.0, 0.0, 0)


def _spectral_shapes(air: ScatteringAir, amplitudes: FloatArray, least: float = 0.0) -> FloatArray:
    """Orthonormal spectra [(r, n)] that span the spectra of all lines at any scattering angle, except lines darker than a share."""
    # spectra of lines at some scattering angles, from the aureole to backscatter, span those at all angles
    phase = air.phase(np.radians((1.0, 10.0, 30.0, 90.0, 150.0)))
    spectra = np.einsum("acn,lcn->aln", phase, amplitudes).reshape(-1, amplitudes.shape[-1])
    size = np.linalg.norm(spectra, axis=1, keepdims=True)
    lit = size[:, 0] > max(_LEAST, least * float(size.max()))
    scaled = spectra[lit] / size[lit]
    if scaled.shape[0] == 0:
        return np.full((1, amplitudes.shape[-1]), amplitudes.shape[-1] ** -0.5)
    _, vectors = np.linalg.eigh(scaled.T @ scaled)
    shapes = vectors[:, ::-1].T
    residual = np.maximum(1.0 - np.cumsum((scaled @ shapes[:MOST_SHAPES].T) ** 2, axis=1), 0.0).max(axis=0)
    good = np.flatnonzero(residual < SPECTRAL_ERROR**2)
    return np.ascontiguousarray(shapes[: int(good[0]) + 1 if good.size else MOST_SHAPES])


def _angular_shapes(air: ScatteringAir, amplitudes: FloatArray, sums: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shapes over scattering angle [(ANGLES, k)] and their share in each kind and channel [(k, KINDS, n)]."""
    importance = np.sqrt((np.abs(sums).sum(axis=0) * amplitudes.mean(axis=0)).ravel() + _LEAST)
    importance /= importance.max()
    phase = air.even_phase(ANGLES)
    coarse = phase[::4].reshape(-1, importance.size)
    typical = (coarse @ importance**2) / np.sum(importance**2)
    scaled = coarse / typical[:, None] * importance
    energy, vectors = np.linalg.eigh(scaled @ scaled.T)
    residual = np.sqrt(np.maximum(np.cumsum(np.maximum(energy, 0.0)) / energy.sum(), 0.0))
    count = min(max(int(np.sum(residual > SHAPE_ERROR)), 1), MOST_SHAPES)
    # eigenvectors of the weighted phase functions, largest first: the fewest shapes for a given error
    kinds = (vectors[:, ::-1][:, :count].T @ scaled) / importance  # of the scaled phase functions
    # Least squares over kinds and channels, as they count, gives the shapes at all angles.
    basis = kinds * importance
    shapes = np.linalg.solve(basis @ basis.T, (basis * importance) @ phase.reshape(ANGLES, -1).T).T
    return np.ascontiguousarray(shapes), kinds.reshape(count, KINDS, -1)


def _fine(lines: _Computed, rows: FloatArray, suns: FloatArray | None) -> FloatArray:
    """Node values [(suns, nodes, azimuths, k, r)] resampled to the tables' rows and columns: magnitude by its logarithm, rest linearly."""
    values, azimuths = lines.values, lines.azimuths
    size = np.sqrt(np.sum(values**2, axis=(3, 4), keepdims=True)) + _LEAST
    # lines in the shadow would have no logarithm
    floor = _DARKEST * float(size.max()) if lines.twilit else 0.0
    size = size + floor
    encoded = np.concatenate([np.log(size).reshape(*values.shape[:3], 1), (values / size).reshape(*values.shape[:3], -1)], axis=-1)
    columns = np.linspace(0.0, 1.0, COLUMNS)
    nodes = np.sin(0.5 * azimuths) ** 2
    order = azimuths.size - 1
    # polynomials in the cosine of the azimuth: the azimuth nodes are their Chebyshev extrema
    to_columns = (
        _linear(nodes, columns)
        if lines.twilit
        else chebyshev.chebvander(1.0 - 2.0 * columns, order) @ np.linalg.inv(chebyshev.chebvander(1.0 - 2.0 * nodes, order))
    )
    # the axis that grows most is resampled last
    if suns is not None:
        encoded = np.tensordot(suns, encoded, axes=(1, 0))
    by_rows = (rows @ encoded.reshape(len(encoded), len(rows.T), -1)).reshape(len(encoded), len(rows), azimuths.size, -1)
    whole = to_columns @ by_rows
    magnitude = np.exp(whole[..., :1])
    if lines.twilit:
        magnitude = np.maximum(magnitude - floor, 0.0)
    amplitude = magnitude * whole[..., 1:]
    return np.ascontiguousarray(amplitude.reshape(*amplitude.shape[:3], *values.shape[3:]))
