"""Sunlight scattered by the air in the mean model, against sums over a plain grid of slopes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seaglint.air.scattering.scattered_light import scattered_path, scattered_shares, scattered_sky_at
from seaglint.base.conventions import surface_range, view_zenith
from seaglint.facet.legs import BOTH
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import solar_zenith_at
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.mean_radiance import MeanModel, mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier
from seaglint.studies.build.profile_air import model_air

AZIMUTHS = np.radians([0.0, 12.0, -40.0, 180.0])


def _view(wind=7.0, sun=75.0, height=30.0, slopes=cox_munk_anisotropic, band=(3.5, 5.0), **changes):
    air = model_air("midlatitude-summer", wind, band)
    view = SeaView(
        air,
        Band.rectangular(*band),
        sea_water.hale_querry_sea(),
        slopes(wind, 2.6),
        288.15,
        height,
        math.radians(sun),
        0.3,
        1.02,
        shadowing=BOTH,
    )
    return replace(view, **changes)


def _brute_force(view, elevation, azimuth):
    """Mirrored sky by a sum over 801 x 801 slopes, each with its own direction, its reflectance in every channel and the local Sun."""
    side = np.linspace(-1.1, 1.1, 801)
    east, north = np.meshgrid(side, side, indexing="ij")
    nz = 1.0 / np.sqrt(1.0 + east**2 + north**2)
    normal = np.stack([-east * nz, -north * nz, nz], axis=-1)
    theta = float(view_zenith(view.sensor_height, -elevation))
    to_viewer = np.array([-math.sin(theta) * math.sin(azimuth), -math.sin(theta) * math.cos(azimuth), math.cos(theta)])
    cosine = normal @ to_viewer
    weight = np.maximum(view.slopes.density(east, north) * cosine / nz, 0.0)
    mirrored = 2.0 * cosine[..., None] * normal - to_viewer
    kept = (mirrored[..., 2] > 0.0) & (weight > 1e-8 * weight.max())
    up, share, incidence = mirrored[kept], weight[kept] / weight.sum(), cosine[kept]
    arc = float(surface_range(view.sensor_height, -elevation))
    zenith = float(solar_zenith_at(view.solar_zenith, view.solar_azimuth - azimuth, arc / 6371e3))
    table, over = view.scattered.sea_sky, view.in_band
    directions = np.arcsin(np.minimum(up[:, 2], 1.0)), np.arctan2(up[:, 0], up[:, 1]) - view.solar_azimuth
    shares = scattered_shares(*directions, table, zenith)
    nodes = np.linspace(0.0, 1.0, 401)
    seen = view.atmosphere.transmittance(view.sensor_height, [arc])[0][over.grid] * over.weights
    rho = (reflectance(nodes[:, None], view.water.index(over.wavenumber_cm)) * seen) @ table.spectral.T
    of_facets = np.stack([np.interp(incidence, nodes, column) for column in rho.T], axis=1)
    return view.sun_distance_factor * float(((shares * of_facets).sum(axis=1) * share).sum())


@pytest.mark.parametrize(
    ("wind", "sun", "height", "slopes"),
    [
        (7.0, 75.0, 30.0, cox_munk_anisotropic),
        pytest.param(3.0, 50.0, 10.0, cox_munk_anisotropic, marks=pytest.mark.validation),
        pytest.param(14.0, 86.0, 3000.0, cox_munk_anisotropic, marks=pytest.mark.validation),
        pytest.param(10.0, 70.0, 100.0, cox_munk_gram_charlier, marks=pytest.mark.validation),
    ],
)
def test_every_slope_mirrors_its_own_direction_of_the_sky(wind, sun, height, slopes):
    view = _view(wind, sun, height, slopes)
    elevations = np.radians([-4.0, -20.0, -70.0])
    lit, dark = (mean_radiance(v, elevations, AZIMUTHS) for v in (view, replace(view, scattering=False)))
    mirrored = lit.sky - dark.sky
    for i, elevation in enumerate(elevations):
        for j, azimuth in enumerate(AZIMUTHS):
            assert mirrored[i, j] == pytest.approx(_brute_force(view, elevation, azimuth), rel=0.01, abs=1e-6)
    assert np.array_equal(lit.sun, dark.sun), "the disc is glint, not sky"
    assert np.array_equal(lit.emission, dark.emission)


def test_paths_and_the_sky_above_are_those_of_the_air():
    view = _view()
    elevations = np.radians([3.0, 0.2, -1.0, -10.0])
    lit, dark = (mean_radiance(v, elevations, AZIMUTHS) for v in (view, replace(view, scattering=False)))
    more = (lit.path - dark.path)[2:]
    arcs = surface_range(30.0, -elevations[2:])[:, None]
    table = scattered_path(arcs, elevations[2:, None], AZIMUTHS - view.solar_azimuth, view.scattered.path)
    np.testing.assert_allclose(more, 1.02 * table, rtol=4e-3)
    for i, elevation in enumerate(elevations[:2]):
        for j, azimuth in enumerate(AZIMUTHS):
            sky = 1.02 * scattered_sky_at(elevation, azimuth - view.solar_azimuth, view.scattered.sky)
            assert (lit.sky - dark.sky)[i, j] == pytest.approx(sky, rel=1e-9)


@pytest.mark.validation
def test_tabulated_maps_are_the_sums():
    view = _view(sun=84.0, height=300.0)
    elevations, azimuths = np.radians(np.linspace(-1.0, -40.0, 30)), 0.3 + np.radians(np.linspace(-175.0, 175.0, 40))
    exact, map_ = mean_radiance(view, elevations, azimuths), MeanModel.prepare(view).map(elevations, azimuths)
    np.testing.assert_allclose(map_.sky, exact.sky, rtol=1e-3)
    np.testing.assert_allclose(map_.path, exact.path, rtol=1e-3)
    wide = mean_radiance(view, elevations, np.tile(azimuths, 2))
    np.testing.assert_allclose(wide.sky[:, :40], exact.sky, rtol=1e-3)
    np.testing.assert_allclose(wide.path[:, :40], exact.path, rtol=1e-3)
    i, j = np.meshgrid(np.arange(30), np.arange(40), indexing="ij")
    along = MeanModel.prepare(view).along(elevations[i.ravel()], azimuths[j.ravel()])
    np.testing.assert_allclose(along.sky.ravel(), map_.sky.ravel(), rtol=1e-9)
    np.testing.assert_allclose(along.path.ravel(), map_.path.ravel(), rtol=1e-9)


@pytest.mark.parametrize("change", [{"background": "blackbody"}, {"solar_zenith": math.radians(100.0)}, {"scattering": False}])
def test_the_article_and_the_night_have_none(change):
    view = _view(**change)
    dark = replace(view, scattering=False)
    elevations = np.radians([1.0, -2.0, -30.0])
    assert np.array_equal(mean_radiance(view, elevations, AZIMUTHS).total, mean_radiance(dark, elevations, AZIMUTHS).total)


@pytest.mark.validation
def test_day_passes_into_night_without_a_jump():
    zeniths = np.radians([*np.arange(89.0, 91.0, 0.1), 91.5, 92.0, 93.0, 95.0, 96.5])
    lines = np.radians([0.5, -3.0]), np.array([0.3])
    found = []
    for zenith in zeniths:
        view = _view(solar_zenith=float(zenith))
        found.append((mean_radiance(view, *lines).total - mean_radiance(replace(view, scattering=False), *lines).total)[:, 0])
    steps = np.abs(np.diff(np.array(found), axis=0)).max(axis=0)
    assert found[0].min() > 0.0
    assert not found[-1].any()
    assert np.all(steps < 0.2 * found[0])
