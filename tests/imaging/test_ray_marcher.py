"""The plain ray marcher: what it must do on seas known by heart, and the sweep's images beside it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from render_scenes import camera, one_tile, sea_view, shown, swept_scene

from mitsuba_comparison import agreement
from mitsuba_scene import facets_left, renderer, scene
from mitsuba_sea import MitsubaMissingError, load_mitsuba
from ray_marcher import Sea, evenly_sampled, facets_of, first_hit, mean_radiance, sea_of, visible_slopes
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.conventions import horizon_depression, surface_range, view_zenith
from seaglint.facet.legs import BOTH
from seaglint.facet.sea_view import SeaView
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.mean_radiance import mean_radiance as model_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic
from visibility_ratio import power_law_sea, ratios

FLAT = Sea(np.zeros((1, 16, 16, 3), np.float32), np.array([[1.0, 1.0, 0.0]]), 0.0, 0.0, 0.05, 7.0 / 6.0 * 6.371e6)


def reflected(view: SeaView, nodes: int = 1025):
    """Reflectance times irradiance over the band at even cosines of incidence [W m-2]."""
    over = view.in_band
    return reflectance(np.linspace(0.0, 1.0, nodes)[:, None], view.water.index(over.wavenumber_cm)) @ (view.irradiance * over.weights)


def facets(view, waves):
    rest, law = facets_left(view, waves)
    return facets_of(rest.covariance(), law)


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
    _compare_with_mean_model(sun_zenith, 20.0, 0.0)


def test_the_marchers_sun_is_higher_at_places_towards_it():
    """At 3.8 km and 6 deg off a Sun at 80 deg the glint is 3 % more than with the Sun of the sensor's foot: local verticals turn."""
    _compare_with_mean_model(80.0, 0.5, 6.0)


def _compare_with_mean_model(sun_zenith, depression, azimuth):
    slopes = cox_munk_anisotropic(8.0, 0.6)
    view = sea_view(VacuumAtmosphere.for_band(3.5, 5.0), slopes, 30.0, sun_zenith, shadowing=BOTH)
    half = 0.005 * depression
    eye = camera(30.0, half - depression, -half - depression, 1, width=0.05, azimuth=azimuth)
    found, error = mean_radiance(
        FLAT, facets_of(slopes.covariance()), 30.0, pixel(eye, 0, 0), (view.solar_zenith, 0.0), 100_000, reflected=reflected(view)
    )
    expected = float(model_radiance(view, eye.elevations, eye.azimuths).sun[0, 0])
    assert found == pytest.approx(expected, rel=2e-3, abs=3.0 * error)


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
        sea_of(waves, 0.5), facets(view, waves), 12.0, block, (view.solar_zenith, 0.0), 20_000, reflected=reflected(view)
    )
    # the sweep's steps and tables: half a per cent
    assert image.mean() == pytest.approx(found, rel=5e-3, abs=3.5 * error)


AZIMUTHS = (-7.25, -5.0, -2.75, 0.0, 2.75, 5.0, 7.25)
"""Azimuths off the Sun of the blocks compared [deg]."""

BLOCK = (16, 32)
"""Rows and columns of a block."""


@cache
def comparison_image(sun_zenith):
    """View, camera, sea and facets of the comparison scene, and the sweep's image of two lines a column, steps of an eighth of a metre."""
    view, eye, waves = scene(sun_zenith)
    image = shown(renderer(view, replace(eye, columns=2 * eye.columns), waves, step=0.125, detail=0.0), 0.04).glint_radiance
    image = image.reshape(eye.rows, eye.columns, 2).mean(axis=2, dtype=float)
    return view, eye, sea_of(waves, 0.04), facets(view, waves), reflected(view), image


def sweep_over_marcher(sun_zenith, row, rays, azimuths=AZIMUTHS):
    """Ratios of blocks at some azimuths, 16 rows from ``row`` on, and their standard errors."""
    view, eye, sea, rough, table, image = comparison_image(sun_zenith)
    ratios, errors = [], []
    for azimuth in azimuths:
        column = round(0.5 * eye.columns + np.radians(azimuth) / eye.column_step) - BLOCK[1] // 2
        part = slice(row, row + BLOCK[0]), slice(column, column + BLOCK[1])
        middle = eye.azimuths[part[1]].mean(), eye.elevations[part[0]].mean()
        block = (middle[0], BLOCK[1] * eye.column_step, middle[1], BLOCK[0] * eye.row_step)
        sun = (view.solar_zenith, view.solar_azimuth)
        found, error = evenly_sampled(sea, rough, eye.height, block, sun, rays, reflected=table)
        ratios.append(image[part].mean() / found)
        errors.append(error / found)
        print(f"Sun {sun_zenith:g}, row {row}, azimuth {azimuth:g}: {ratios[-1]:.4f} +- {errors[-1]:.4f}")
    return np.array(ratios), np.array(errors)


@pytest.mark.validation
@pytest.mark.parametrize(
    ("sun_zenith", "row", "azimuths", "rays"),
    [
        (50.0, 60, AZIMUTHS, 8192),
        (50.0, 120, AZIMUTHS, 8192),
        (50.0, 300, AZIMUTHS, 8192),
        (80.0, 60, (0.0,), 16384),
        (80.0, 120, (-2.75, 0.0, 2.75), 32768),
        (80.0, 300, AZIMUTHS[1:-1], 8192),
    ],
)
def test_sweep_and_marcher_agree_on_the_comparison_scene(sun_zenith, row, azimuths, rays):
    """Blocks of the scene that is compared with the general ray tracer, waves shading waves included.

    Under a low Sun the sweep takes the hiding of facets at the middle of the disc, the marcher at every point of it: 0.6 %.
    """
    ratios, errors = sweep_over_marcher(sun_zenith, row, rays, azimuths)
    assert errors.max() < 2e-3  # the scatter of eight sets: half a per cent is decided
    assert ratios == pytest.approx(np.ones(len(azimuths)), abs=5e-3 if sun_zenith < 70.0 else 8e-3)


@pytest.mark.validation
@pytest.mark.parametrize(
    ("row", "azimuth", "rays"),
    [(60, 2.75, 32768), (60, 5.0, 32768), (60, 7.25, 65536), (120, 5.0, 32768), (120, 7.25, 32768), (300, 7.25, 16384)],
)
def test_sweep_and_marcher_agree_far_off_a_low_sun(row, azimuth, rays):
    """Radiance falls by a factor of 200 from 5 to 7.25 deg off the Sun: within half a per cent, or four standard errors of a block."""
    ratios, errors = sweep_over_marcher(80.0, row, rays, (-azimuth, azimuth))
    together = np.average(ratios, weights=errors**-2.0)
    assert together == pytest.approx(1.0, abs=5e-3)
    # the scatter of eight sets follows Student's law of 7 degrees of freedom: beyond four standard errors lies one block in 200
    assert np.all(np.abs(ratios - 1.0) < np.maximum(5e-3, 4.0 * errors))


@pytest.mark.validation
@pytest.mark.parametrize("sun_zenith", [50.0, 80.0])
def test_sweep_and_mitsuba_agree_on_the_comparison_scene(sun_zenith):
    """A quarter of the pixels' rows and columns; ``./run bench agreement`` has all of them."""
    try:
        load_mitsuba()
    except MitsubaMissingError as error:
        pytest.skip(str(error))
    found = agreement(sun_zenith, pixels=(256, 128), accuracy=(0.25, 4, 0.0), subdivision=4, half_samples=64)
    print(found)
    # hiding at the middle of a low Sun's disc, as beside the marcher
    assert found.mean_ratio == pytest.approx(1.0, abs=2e-3 if sun_zenith < 70.0 else 5e-3)
    assert found.rms < 1e-2
    assert found.by_azimuth == pytest.approx([1.0] * 4, abs=5e-3)


# Brute force on the k^-4 surface, Suns at 60, 77, 80, 85 deg; from an independent calculation with standard errors of 0.003-0.015.
SEEN_OVER_MODEL = {1.0: (1.22, 0.73, 0.61, 0.43), 3.0: (1.19, 0.81, 0.69, 0.52), 10.0: (1.05, 0.97, 0.94, 0.88)}


@pytest.mark.validation
@pytest.mark.parametrize("depression", SEEN_OVER_MODEL)
def test_visibility_ratio_of_a_sea_of_all_scales(depression):
    waves, slopes = power_law_sea()
    mean, error = ratios(waves, slopes, depression, seas=24, rays=10_000)
    print(f"depression {depression:g}: " + ", ".join(f"{m:.3f} +- {e:.3f}" for m, e in zip(mean, error, strict=True)))
    # both calculations' standard errors, and the last 8 % of the slope variance, which lie on facets
    assert mean == pytest.approx(np.array(SEEN_OVER_MODEL[depression]), abs=0.02 + 2.0 * float(np.hypot(error.max(), 0.008)))


def test_marched_incidence_is_the_views():
    """The frame of the place: a view down at 2 deg from 30 m has the zenith angle of the conventions."""
    depression = np.radians(2.0)
    t = first_hit(FLAT, (0.0, 0.0, 30.0), (np.cos(depression), 0.0, -np.sin(depression)), 0.0, 1e6)
    x, z = t * np.cos(depression), 30.0 - t * np.sin(depression) + FLAT.radius
    cosine = (-np.cos(depression) * x + np.sin(depression) * z) / np.hypot(x, z)
    assert np.arccos(cosine) == pytest.approx(float(view_zenith(30.0, depression)), abs=1e-6)
