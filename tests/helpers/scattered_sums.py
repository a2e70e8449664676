"""Scattered sunlight that facets mirror, summed slope by slope with NumPy."""

from __future__ import annotations

from functools import cache

import numpy as np
from render_scenes import table_air

from seaglint.air.scattering.scattered_light import scattered_shares
from seaglint.base.conventions import view_zenith_of_range
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import solar_zenith_at
from seaglint.optics.fresnel import reflectance
from seaglint.sea.shadowing.nested import nested_ratio

EARTH_RADIUS = 6371e3


@cache
def hazy(wind):
    return table_air(wind)


def mirrored(view: SeaView, arc: float, azimuth: float, slopes, tilt=(0.0, 0.0), bands=1.0, nodes=(701, 401)) -> float:
    """Scattered sky that facets of Gaussian ``slopes`` about a resolved ``tilt`` (east, north) mirror to the sensor [W m-2 sr-1].

    Even steps over 5 deviations along the view and across it; the weight of a slope is its density, its visible area and the law of nested
    bands.
    """
    table, grid, weights = view.scattered.sea_sky, view.in_band.grid, view.in_band.weights
    zenith = float(view_zenith_of_range(view.sensor_height, arc))
    toward = np.array([-np.sin(azimuth), -np.cos(azimuth)])
    across = np.array([toward[1], -toward[0]])
    frame = np.stack([toward, across])
    ee, en, nn = slopes.covariance()
    covariance = frame @ np.array([[ee, en], [en, nn]]) @ frame.T
    spread = np.sqrt(np.diag(covariance))
    a = np.linspace(-5.0, 5.0, nodes[0])[:, None] * spread[0]
    c = np.linspace(-5.0, 5.0, nodes[1])[None, :] * spread[1]
    inverse = np.linalg.inv(covariance)
    density = np.exp(-0.5 * (inverse[0, 0] * a * a + 2.0 * inverse[0, 1] * a * c + inverse[1, 1] * c * c))
    lean = frame @ np.asarray(tilt)
    law = np.ones_like(a)
    if bands > 1.0:
        # facets about a tilt are shadowed as a level sea is from the grazing angle that is left
        edge = np.arctan2(1.0, 1.0 / np.tan(zenith) - lean[0])
        law = nested_ratio(a, edge, covariance[0, 0], bands)
    a, c = a + lean[0], c + lean[1]
    norm = np.sqrt(1.0 + a * a + c * c)
    visible = np.maximum(np.cos(zenith) - np.sin(zenith) * a, 0.0)
    weight = density * visible * law
    weight /= weight.sum()
    cosine = visible / norm
    # the mirrored direction, along the view, across it and up
    along_r, across_r, up = -2.0 * cosine * a / norm - np.sin(zenith), -2.0 * cosine * c / norm, 2.0 * cosine / norm - np.cos(zenith)
    use = (up > 0.0) & (weight > 1e-9 * weight.max())
    east = along_r * toward[0] + across_r * across[0]
    north = along_r * toward[1] + across_r * across[1]
    away = -toward
    psi = arc / EARTH_RADIUS
    local = float(solar_zenith_at(view.solar_zenith, azimuth - view.solar_azimuth, psi))
    sun = np.array([np.sin(view.solar_zenith) * np.sin(view.solar_azimuth), np.sin(view.solar_zenith) * np.cos(view.solar_azimuth)])
    turned = sun + (sun @ away * (np.cos(psi) - 1.0) - np.cos(view.solar_zenith) * np.sin(psi)) * away
    azimuths = np.arctan2(east, north) - np.arctan2(*turned)
    shares = scattered_shares(np.arcsin(np.clip(up[use], 0.0, 1.0)), azimuths[use], table, local)
    levels = np.linspace(0.0, 1.0, 1025)
    rho = reflectance(levels[:, None], view.water.index(view.in_band.wavenumber_cm)[None, :])
    tau = view.atmosphere.transmittance(view.sensor_height, np.array([arc]))[0, grid]
    sums = (rho * tau * weights) @ table.spectral.T * view.sun_distance_factor
    seen = np.stack([np.interp(cosine[use], levels, r) for r in sums.T], axis=-1)
    return float(np.sum(weight[use] * np.sum(seen * shares, axis=-1)))
