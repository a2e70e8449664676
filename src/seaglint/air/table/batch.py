"""Table atmosphere for many cases at once, each with its own wind, height and angles, as spreadsheets have them.

Splines over wind, height and the path are taken at every case's own (:mod:`seaglint.air.table.stencil`): 20 us a case, where sums along its
ray (:mod:`seaglint.air.profile.air_sums`) take a millisecond.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.coordinates import dip_coordinate, elevation_coordinate, path_coordinate, straight_slant
from seaglint.air.table.stencil import Stencil, with_slopes
from seaglint.air.table.table_file import BandTable, Spectra
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.optics.blackbody import planck_wavenumber


@dataclass(frozen=True, eq=False)
class BatchAtmosphere:
    """LOWTRAN7 model atmosphere over one band for cases with their own winds. Make it with :meth:`load`.

    Notes
    -----
    LOWTRAN7's Navy maritime aerosol at winds (U10, also the 24-hour mean) of 0 to 20 m/s, heights of 2 m to 10 km, paths to the sea named
    by the depression of LOWTRAN7's own refracted ray at the sensor, in its layers and at its 20 cm-1, sampled every 5. Radiance is thermal.
    Against LOWTRAN7 runs off the nodes (3-5 um) the 95th percentile of the error is 0.15 % of band transmittance, 0.1 % of path radiance
    and sunlight, 0.05 % of the sky seen from the sea, and 1.5 % (largest 5 %) of the sky from a height within four dips of the horizon.

    References
    ----------
    Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177; Gathman, S. G. (1983), Optical properties of
    the marine aerosol as predicted by the Navy aerosol model, Opt. Eng. 22, 57-62.

    Examples
    --------
    >>> air = BatchAtmosphere.load("midlatitude-summer", (3.5, 5.0))
    >>> transmittance, radiance = air.path([5.0, 12.0], [100.0, 30.0], np.radians([1.0, 0.5]))
    >>> transmittance.shape
    (2, 173)
    """

    model: str  #: Name of the model atmosphere.
    wavenumber_cm: FloatArray  #: Ascending spectral samples [cm-1, (n,)].
    #: ``wind_range``, ``height_range``: Ranges of the table [m s-1], [m].
    wind_range: tuple[float, float]
    height_range: tuple[float, float]
    extrapolate: bool  #: Whether winds and heights beyond that are taken.
    _table: BandTable
    _ray: FloatArray
    #: Scores of depth and temperature side by side, values and slopes along the path [(winds, heights, 2 nodes, components)].
    _path_scores: FloatArray
    _sun_scores: FloatArray
    _sky_scores: FloatArray  #: Scores of the sky seen from the sea against elevation, values and slopes [(winds, 2 nodes, components)].

    @classmethod
    def load(cls, model: str, band_um: tuple[float, float], *, extrapolate: bool = False) -> BatchAtmosphere:
        """Read the table of ``model`` over a band [um].

        With ``extrapolate`` winds above the table see the air of its highest wind, as in LOWTRAN7 itself. Below the table's lowest height a
        path is one of equal length from there: the air is the same (transmittance within 0.02 %, path radiance 0.1 %, 0.5 m). The path to
        a sensor above it ends where the ray passes the highest one and lacks the air above: at 15 km and 30 deg down 1-3 % of
        transmittance and 3-9 % of path radiance, more towards the horizon. Outside winds and heights are refused otherwise.

        Raises
        ------
        DomainError
            For an unknown model or a band outside the tables.
        DataError
            If the file in the package is damaged.
        """
        table = BandTable.read(model, band_um)
        winds, heights = table.winds, table.heights
        return cls(
            model=model,
            wavenumber_cm=table.wavenumber_cm,
            wind_range=(float(winds[0]), float(winds[-1])),
            height_range=(float(heights[0]), float(heights[-1])),
            extrapolate=extrapolate,
            _table=table,
            _ray=_and_slopes(np.asarray(table.ray)[..., None])[..., 0],
            _path_scores=np.ascontiguousarray(
                _and_slopes(np.concatenate([table.path_depth.scores, table.path_temperature.scores], axis=-1))
            ),
            _sun_scores=_and_slopes(table.sun_depth.scores),
            _sky_scores=_and_slopes(table.sky_temperature.scores[:, 0]),  # the lowest height is the sea
        )

    def _wind(self, wind_speed: ArrayLike) -> Stencil:
        wind = self._covered(np.asarray(wind_speed, dtype=np.float64), self.wind_range, "wind_speed", "m/s")
        return Stencil.between_kinks(self._table.winds, self._table.wind_kinks, wind)

    def _height(self, height: FloatArray) -> Stencil:
        return self._table.at_heights(self._covered(height, self.height_range, "sensor height", "m"))

    def _covered(self, values: FloatArray, allowed: tuple[float, float], name: str, unit: str) -> FloatArray:
        """Return values inside the table; those outside are set to its edge, or refused."""
        if not self.extrapolate:
            _require(values, allowed, name, unit)
        return np.clip(values, *allowed)

    def dip(self, height: ArrayLike) -> FloatArray:
        """Depression of the sea horizon by LOWTRAN7's refraction [rad] at heights [m]."""
        return self._table.refraction.depression(height, 0.0)

    def path(self, wind_speed: ArrayLike, height: ArrayLike, depression: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and thermal path radiance [W m-2 sr-1 per cm-1], both (cases, n), of rays that end on the sea.

        Parameters
        ----------
        wind_speed : array_like
            U10 [m s-1, (cases,)].
        height : array_like
            Sensor height [m, (cases,)].
        depression : array_like
            Below the horizontal at the sensor [rad, (cases,)].

        Raises
        ------
        DomainError
            A wind or height outside the table, or a ray that misses the sea.
        """
        h = np.asarray(height, dtype=np.float64)
        at_height = self._height(h)
        cosine = self._table.refraction.sea_cosine(h, depression)
        if np.any(np.isnan(cosine)):
            raise DomainError("a line of sight misses the sea; give depressions below the sea horizon, see dip()")
        h = np.minimum(h, self.height_range[1])
        straight = path_coordinate(straight_slant(h, cosine), h, straight_slant(h, 0.0))
        nodes = np.linspace(0.0, 1.0, self._ray.shape[-1] // 2)
        # The ray's spline says how far along LOWTRAN7's own path the sea lies: the coordinate of the path nodes.
        x = np.maximum(at_height.times(Stencil.hermite(nodes, straight)).of(self._ray.reshape(-1)), 0.0)
        x, share = self._of_length(h, x)
        path_nodes = np.linspace(0.0, 1.0, self._path_scores.shape[2] // 2)
        where = self._wind(wind_speed).times(at_height).times(Stencil.hermite(path_nodes, x))
        optical_depth, air = self._table.path_at(self._path_scores, where)
        optical_depth *= share[:, None]
        transmittance = np.exp(-optical_depth)
        return transmittance, -np.expm1(-optical_depth) * planck_wavenumber(self.wavenumber_cm, air)

    def _of_length(self, height: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Path of equal length from the table's lowest height, for heights below it, and its share where that path is too long."""
        lowest, share = self.height_range[0], np.ones_like(x)
        low = height < lowest
        if low.any():
            excess = np.exp(self._table.horizon_excess[0])
            length = height[low] ** (1.0 - x[low]) * (straight_slant(height[low], 0.0) * excess) ** x[low]
            x = x.copy()
            x[low] = np.maximum(np.log(length / lowest) / np.log(straight_slant(lowest, 0.0) * excess / lowest), 0.0)
            share[low] = np.minimum(length / lowest, 1.0)
        return x, share

    def solar_irradiance(self, wind_speed: ArrayLike, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (cases, n)]; 0 beyond a zenith angle of pi/2."""
        y = self._table.sun_coordinate(solar_zenith)
        return self._table.sunlight(solar_zenith, self._against_elevation(self._table.sun_depth, self._sun_scores, wind_speed, y))

    def sky_radiance(self, wind_speed: ArrayLike, zenith: ArrayLike, height: ArrayLike | None = None) -> FloatArray:
        """Thermal radiance of the clear sky [W m-2 sr-1 per cm-1, (cases, n)] at zenith angles [rad, (cases,)].

        Seen from the sea, or from heights [m, (cases,)]; from there down to the horizon of LOWTRAN7's own rays (:meth:`dip`).
        """
        angle = np.asarray(zenith, dtype=np.float64)
        if height is not None:
            return self._sky_from(wind_speed, angle, np.asarray(height, dtype=np.float64))
        _require(angle, (0.0, 0.5 * np.pi), "zenith", "rad")
        y = np.minimum(elevation_coordinate(0.5 * np.pi - angle, 0.0), 1.0)
        temperature = self._against_elevation(self._table.sky_temperature, self._sky_scores, wind_speed, y)
        return planck_wavenumber(self.wavenumber_cm, temperature)

    def _sky_from(self, wind_speed: ArrayLike, zenith: FloatArray, height: FloatArray) -> FloatArray:
        table = self._table
        at = self._covered(height, (0.0, float(table.sky_heights[-1])), "sensor height", "m")
        dip, elevation = self.dip(at), 0.5 * np.pi - zenith
        _require(elevation, (float(-dip.max()), 0.5 * np.pi), "elevation of the sky", "rad")
        where = self._wind(wind_speed).times(table.at_sky_heights(at))
        up, low = self._skies
        nodes = (up.shape[2] // 2, low.shape[2] // 2)
        y = np.minimum(elevation_coordinate(np.maximum(elevation, 0.0), dip), 1.0)
        scores = where.times(Stencil.hermite(np.linspace(0.0, 1.0, nodes[0]), y)).of(up.reshape(-1, up.shape[-1]))
        below = elevation < 0.0
        if below.any():
            x = np.minimum(dip_coordinate(-elevation[below], dip[below]), 1.0)
            part = Stencil(where.index[below], where.weight[below], where.size).times(Stencil.hermite(np.linspace(0.0, 1.0, nodes[1]), x))
            scores[below] = part.of(low.reshape(-1, low.shape[-1]))
        return planck_wavenumber(self.wavenumber_cm, table.sky_temperature.of(scores))

    @cached_property
    def _skies(self) -> tuple[FloatArray, FloatArray]:
        """Scores and slopes of the sky from all heights, above and below the horizontal [(winds, heights, 2 nodes, components)]."""
        return _and_slopes(self._table.sky_temperature.scores), _and_slopes(self._table.sky_dip.scores)

    def _against_elevation(self, spectra: Spectra, scores: FloatArray, wind_speed: ArrayLike, y: FloatArray) -> FloatArray:
        """Spectra at the winds and elevation coordinates of the cases [(cases, n)]."""
        where = self._wind(wind_speed).times(Stencil.hermite(np.linspace(0.0, 1.0, scores.shape[1] // 2), y))
        return spectra.of(where.of(scores.reshape(where.size, -1)))


def _and_slopes(values: FloatArray) -> FloatArray:
    """Return values at even nodes 0...1 followed by the slopes of their spline."""
    return with_slopes(np.linspace(0.0, 1.0, values.shape[-2]), values)


def _require(values: FloatArray, allowed: tuple[float, float], name: str, unit: str) -> None:
    outside = ~((values >= allowed[0]) & (values <= allowed[1]))
    if outside.any():
        raise DomainError(
            f"{name} = {values[outside][0]:g} {unit} is outside {allowed[0]:g}-{allowed[1]:g} {unit} of this atmosphere",
            name=name.replace(" ", "_"),
            value=float(values[outside][0]),
            allowed=allowed,
        )
