"""The plain ray marcher: what it must do on seas known by heart, and the sweep's images beside it."""

import numpy as np
import pytest
from render_scenes import camera, one_tile, sea_view, shown, swept_scene

from bench.scene import facet_bands, renderer, scene
from ray_marcher import Sea, facets_of, first_hit, mean_radiance, sea_of, visible_slopes
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.conventions import horizon_depression, surface_range, view_zenith
from seaglint.facet.legs import BOTH
from seaglint.facet.sea_view import SeaView
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.mean import mean_radiance as model_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from visibility_ratio import power_law_sea, ratios

FLAT = Sea(np.zeros((1, 16, 16, 3), np.float32), np.array([[1.0, 1.0, 0.0]]), 0.0, 0.0, 0.05, 7.0 / 6.0 * 6.371e6)


def reflected(view: SeaView, nodes: int = 1025):
    """Reflectance times irradiance over the band at even cosines of incidence [W m-2]."""
    over = view.in_band
    return reflectance(np.linspace(0.0, 1.0, nodes)[:, None], view.water.index(over.wavenumber_cm)) @ (view.irradiance * over.weights)


def facets(view, waves, bands):
    up, cross = waves.resolved_mss()
    rest = SlopeStatistics(view.slopes.mss_up - up, view.slopes.mss_cross - cross, wind_to_azimuth=waves.spectrum.wind_to_azimuth)
    return facets_of(rest.covariance(), bands)


def pixel(eye, row, column):
    return eye.azimuths[column], eye.column_step, eye.elevations[row], eye.row_step


@pytest.mark.parametrize("depression_deg", [0.3, 2.0, 30.0])
def test_rays_meet_a_calm_sea_where_the_sphere_is(depression_deg):
    height, depression = 30.0, np.radians(depression_deg)
    t = first_hit(FLAT, (0.0, 0.0, height), (np.cos(depression), 0.0, -np.sin(depression)), 0.0, 1e6)
    radius = FLAT.radius
    arc = np.arctan2(t * np.cos(depression), radius + height - t * np.sin(depression)) * radius
    # surface_range is to first order in height over radius
    assert arc == pytest.approx(float(surface_range(height, depression)), rel=1e-4)


def test_rays_above_the_horizon_meet_nothing():
    for share, seen in ((0.99, False), (1.01, True)):
        d = share * horizon_depression(30.0)
        assert (first_hit(FLAT, (0.0, 0.0, 30.0), (np.cos(d), 0.0, -np.sin(d)), 0.0, 1e6) >= 0.0) == seen


@pytest.mark.parametrize("sun_zenith", [70.0, pytest.param(40.0, marks=pytest.mark.validation)])
def test_all_slopes_on_facets_give_the_mean_model(sun_zenith):
    """No resolved waves: a pixel is the mean-radiance model's, whose own Sun is one of the two independent ways here."""
    slopes = cox_munk_anisotropic(8.0, 0.6)
    view = sea_view(VacuumAtmosphere.for_band(3.5, 5.0), slopes, 30.0, sun_zenith, shadowing=BOTH)
    eye = camera(30.0, -19.9, -20.1, 1, width=0.2)
    found, error = mean_radiance(
        FLAT, facets_of(slopes.covariance()), 30.0, pixel(eye, 0, 0), (view.solar_zenith, 0.0), 4000, reflected=reflected(view)
    )
    assert found == pytest.approx(float(model_radiance(view, eye.elevations, eye.azimuths).sun[0, 0]), rel=2e-3, abs=3.0 * error)


def test_a_wave_in_front_hides_and_shades():
    """One long crest of 3 m, 100 m away; behind it a calm sea that a low ray cannot see and a low Sun cannot light."""
    n = 256
    lattice = np.zeros((1, n, n, 3), np.float32)
    lattice[0, 100, :, 0] = 3.0
    sea = Sea(lattice, np.array([[1.0, 1.0, 0.0]]), 3.0, 3.0, 0.05, 1e12)
    low, high = np.radians(2.0), np.radians(20.0)
    assert 99.0 < first_hit(sea, (0.0, 0.0, 5.0), (0.0, np.cos(low), -np.sin(low)), 0.0, 1e4) < 101.0
    assert first_hit(sea, (0.0, 0.0, 5.0), (0.0, np.cos(high), -np.sin(high)), 0.0, 1e4) == pytest.approx(5.0 / np.sin(high), abs=1e-3)
    assert first_hit(sea, (0.0, 90.0, 1e-3), (0.0, np.cos(low), np.sin(low)), 0.0, 1e4) > 0.0
    assert first_hit(sea, (0.0, 90.0, 1e-3), (0.0, np.cos(high), np.sin(high)), 0.0, 1e4) < 0.0


def test_visible_slopes_keep_the_projected_area():
    """Rays fall evenly on the level plane: ``<v_z/(v_z - v_h.s)>`` over the slopes they meet is the share of sea seen, 1 when steep."""
    waves = one_tile()
    depression = np.radians(60.0)
    places = np.random.default_rng(2).uniform(0.0, 64.0, (4000, 2))
    slope = visible_slopes(sea_of(waves, radius=1e12), depression, 0.0, places)
    seen = np.sin(depression) / (np.sin(depression) + np.cos(depression) * slope[:, 1])
    assert seen.mean() == pytest.approx(1.0, abs=4.0 * seen.std() / np.sqrt(seen.size))


@pytest.mark.parametrize("sun_zenith", [78.0, pytest.param(50.0, marks=pytest.mark.validation)])
def test_sweep_and_marcher_agree_on_short_steep_waves(sun_zenith):
    """Small: one tile, a block of pixels. The validation run does the comparison scene."""
    waves = one_tile()
    slopes = cox_munk_anisotropic(6.0, waves.spectrum.wind_to_azimuth)
    view = sea_view(VacuumAtmosphere.for_band(3.5, 5.0), slopes, 12.0, sun_zenith)
    eye = camera(12.0, -8.0, -11.0, 24, width=2.0, columns=16)
    image = shown(swept_scene(view, eye, waves, step=0.1, lines_per_column=4, shortest_wave_columns=0.0), 0.5).glint_radiance
    block = (eye.azimuth, eye.width, eye.elevation, eye.height_angle)
    found, error = mean_radiance(
        sea_of(waves, 0.5),
        facets(view, waves, facet_bands(view, waves)),
        12.0,
        block,
        (view.solar_zenith, 0.0),
        20_000,
        reflected=reflected(view),
    )
    # the sweep's steps and tables: half a per cent
    assert image.mean() == pytest.approx(found, rel=5e-3, abs=3.5 * error)


@pytest.mark.validation
@pytest.mark.parametrize("sun_zenith", [50.0, 80.0])
@pytest.mark.parametrize("rows", [(60, 76), (120, 136), (300, 316)])
def test_sweep_and_marcher_agree_on_the_comparison_scene(sun_zenith, rows):
    """Blocks of 16 x 64 pixels of the scene that is compared with the general ray tracer, waves shading waves included."""
    view, eye, waves = scene(sun_zenith)
    image = shown(renderer(view, eye, waves, step=0.25, detail=0.0), 0.04).glint_radiance
    columns = slice(480, 544)
    middle = 0.5 * (eye.azimuths[480] + eye.azimuths[543])
    block = (middle, 64 * eye.column_step, 0.5 * (eye.elevations[rows[0]] + eye.elevations[rows[1] - 1]), 16 * eye.row_step)
    found, error = mean_radiance(
        sea_of(waves, 0.04),
        facets(view, waves, facet_bands(view, waves)),
        eye.height,
        block,
        (view.solar_zenith, view.solar_azimuth),
        400_000,
        reflected=reflected(view),
    )
    seen = float(image[rows[0] : rows[1], columns].mean(dtype=float))
    print(f"Sun {sun_zenith:g} rows {rows}: sweep {seen:.4f}, marcher {found:.4f} +- {error:.4f}, ratio {seen / found:.4f}")
    assert seen == pytest.approx(found, rel=1e-2, abs=2.0 * error)


# Brute force on the k^-4 surface, Suns at 60, 77, 80, 85 deg; from an independent calculation with standard errors of 0.003-0.015.
SEEN_OVER_MODEL = {1.0: (1.22, 0.73, 0.61, 0.43), 3.0: (1.19, 0.81, 0.69, 0.52), 10.0: (1.05, 0.97, 0.94, 0.88)}


@pytest.mark.validation
@pytest.mark.parametrize("depression", SEEN_OVER_MODEL)
def test_visibility_ratio_of_a_sea_of_all_scales(depression):
    waves, slopes = power_law_sea()
    mean, error = ratios(waves, slopes, depression, seas=24, rays=10_000)
    print(f"depression {depression:g}: " + ", ".join(f"{m:.3f} +- {e:.3f}" for m, e in zip(mean, error, strict=True)))
    # both calculations' standard errors, and the last eighth of the slope variance, which bilinear lattices leave to the facets
    assert mean == pytest.approx(np.array(SEEN_OVER_MODEL[depression]), abs=0.02 + 2.0 * float(np.hypot(error.max(), 0.008)))


def test_marched_incidence_is_the_views():
    """The frame of the place: a view down at 2 deg from 30 m has the zenith angle of the conventions."""
    depression = np.radians(2.0)
    t = first_hit(FLAT, (0.0, 0.0, 30.0), (np.cos(depression), 0.0, -np.sin(depression)), 0.0, 1e6)
    x, z = t * np.cos(depression), 30.0 - t * np.sin(depression) + FLAT.radius
    cosine = (-np.cos(depression) * x + np.sin(depression) * z) / np.hypot(x, z)
    assert np.arccos(cosine) == pytest.approx(float(view_zenith(30.0, depression)), abs=1e-6)
