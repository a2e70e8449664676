r"""Foam in the mean radiance of the sea: ``L = (1 - F) water + F foam``, with the mean share F of the view's ``FoamCover``.

The part of foam that mirrors like water has the water's emission, sky and glint; the light of its bubbles is added
(``seaglint.facet.foam``). The share is that of the area in view, the same for all slopes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import ndtr

from seaglint.air.sun_and_sky import visible_part_kernel
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, unit_vector
from seaglint.facet.foam import FoamCover
from seaglint.facet.foam_light import FoamLight
from seaglint.facet.sea_view import SeaView, sea_arc
from seaglint.facet.sunlight import solar_zenith_at, turn_at
from seaglint.sea.shadowing.smith import projected_area

_LEAST_VARIANCE: Final = 1e-10  #: Least variance of the slope along the view: the visible area of a mirror is 0 at the horizon.

_visible_part = np.vectorize(visible_part_kernel, otypes=[np.float64, np.float64])


@dataclass(frozen=True, eq=False)
class FoamMean:
    """Foam of a view, for its mean radiance. Make it with ``prepare``."""

    view: SeaView  #: Sea, air, Sun and the share of foam.
    cover: FoamCover  #: Share of foam.
    light: FoamLight  #: Light of its bubbles at the sea.

    @classmethod
    def prepare(cls, view: SeaView) -> FoamMean | None:
        """Prepare the foam of a view; None for a sea without foam, and for a sea that is a blackbody, whose foam cannot be told apart."""
        if view.foam is None or view.foam.share == 0.0 or view.background == "blackbody":
            return None
        return cls(view, view.foam, FoamLight.of(view))

    def rows(self, seen: FloatArray) -> FloatArray:
        """Emission, sky and sunlight at normal incidence of the bubbles behind the air [W m-2 sr-1, (rows, 3)].

        ``seen`` (rows, n) is transmittance times quadrature weight [cm-1].
        """
        return np.asarray(seen @ self.light.spectra.T)

    def incidence(self, gamma: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Cosine of incidence of the Sun on the sea in view, times the visible share of its disc and its strength there [1].

        ``gamma``: elevations of the viewer over the sea; ``azimuth``: of the lines of sight [rad]; they broadcast. The mean tilt of the
        facets in view, towards the viewer, counts.
        """
        view, sea = self.view, self.view.slopes
        if not view.irradiance.any():
            return np.zeros(np.broadcast_shapes(gamma.shape, azimuth.shape))
        turn = turn_at(sea_arc(view.sensor_height, gamma))
        zenith = solar_zenith_at(view.solar_zenith, azimuth - view.solar_azimuth, turn)
        share, elevation = np.ones_like(zenith), 0.5 * np.pi - zenith
        low = elevation < SOLAR_ANGULAR_RADIUS
        if low.any():
            share[low], lift = _visible_part(elevation[low])
            elevation[low] += lift
        up, flat = np.sin(elevation), np.cos(elevation)
        table = view.sun_table
        if table.values.size > 1:
            share = share * np.interp(up, table.first + np.arange(table.values.size) / table.per_step, table.values)
        # mean slope of the Gaussian slopes in view: their covariance times the direction, E[s max(0, v_z - v_h.s)] over the visible area
        (sun_east, sun_north), (east, north) = unit_vector(view.solar_azimuth), unit_vector(azimuth + np.pi)
        wind_east, wind_north = unit_vector(sea.wind_to_azimuth)
        along = sea.mss_up * (east * wind_east + north * wind_north) * (sun_east * wind_east + sun_north * wind_north)
        across = sea.mss_cross * (east * wind_north - north * wind_east) * (sun_east * wind_north - sun_north * wind_east)
        variance = np.maximum(sea.mss_along(azimuth), _LEAST_VARIANCE)
        area = projected_area(0.5 * np.pi - gamma, variance)
        tilt = np.cos(gamma) * (along + across) * ndtr(np.tan(gamma) / np.sqrt(variance)) / area
        return np.asarray(share * np.maximum(up + flat * tilt, 0.0))
