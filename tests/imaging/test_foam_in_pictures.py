"""Foam in pictures: energy, shares, means, and the same foam by every way of drawing."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from render_scenes import BAND, SEA_TEMPERATURE, camera, elfouhaily, furnace, sea_view, shown, swept_scene, table_air

from seaglint.facet.foam import FoamCover
from seaglint.imaging import wave_surface
from seaglint.imaging.attitude_scene import TurnedScene
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Track
from seaglint.imaging.scene import Accuracy, image
from seaglint.imaging.sweep import walk
from seaglint.imaging.upright_scene import SweptScene
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.foam_reflectance import BUBBLES
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.foam.breaking_crests import BreakingCrests
from seaglint.sea.foam.coverage_laws import coverage
from seaglint.sea.foam.foam_field import FoamField
from seaglint.sea.foam.ship_foam import FoamSegments
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic

WIND = 12.0
SHARE = coverage("monahan-1980", WIND)
SLOPES = cox_munk_anisotropic(WIND, wind_to_azimuth=np.radians(30.0))
LAYERS = ("foam_share", "coverage", "emitted_radiance", "sky_radiance")


@cache
def breaking() -> FoamField:
    """Breaking waves of the sea of these pictures."""
    waves = elfouhaily(WIND, shortest_wave=3.0, wander=True)
    return FoamField.create(waves, BreakingCrests.create(SHARE, WIND), WIND, waves.spectrum.wind_to_azimuth, 1)


def foamy(view, eye, *, resolved=True, layers=LAYERS) -> SweptScene:
    """Scene with foam."""
    field = breaking() if resolved else None
    view = replace(view, foam=FoamCover(SHARE))
    return SweptScene.prepare(view, eye, field and field.waves, accuracy=Accuracy(), layers=layers, breaking=field)


@pytest.mark.parametrize("resolved", [True, False])
def test_furnace_with_foam_is_a_blackbody(resolved: bool) -> None:
    air = furnace()
    eye = camera(30.0, 2.0, -30.0, 64, width=8.0, columns=16)
    found = shown(foamy(sea_view(air, SLOPES, sun_zenith=180.0), eye, resolved=resolved), 3.0)
    planck = float(planck_wavenumber(air.wavenumber_cm, SEA_TEMPERATURE) @ BAND.weights(air.wavenumber_cm))
    assert found["foam_share"].max() > (0.3 if resolved else 0.9 * SHARE)
    np.testing.assert_allclose(found.radiance, planck, rtol=3e-4)


@pytest.mark.parametrize("sun", [50.0, 180.0])
def test_without_resolved_waves_the_picture_is_the_mean_map(sun: float) -> None:
    eye = camera(30.0, -1.0, -20.0, 12, azimuth=20.0, width=4.0, columns=3)
    scene = foamy(sea_view(table_air(WIND), SLOPES, sun_zenith=sun, sun_azimuth=20.0), eye, resolved=False)
    found = shown(scene, 0.0)
    mean = mean_radiance(scene.view, eye.elevations, eye.azimuths).total
    np.testing.assert_allclose(found.radiance, np.broadcast_to(mean, found.radiance.shape), rtol=1e-2)
    # of which the water has the most: foam adds what it adds to the map
    view = replace(scene.view, foam=None)
    water = shown(swept_scene(view, eye), 0.0).radiance / mean_radiance(view, eye.elevations, eye.azimuths).total
    np.testing.assert_allclose(found.radiance / mean, water, rtol=3e-4)
    np.testing.assert_allclose(found["foam_share"], SHARE, rtol=1e-6)


@pytest.mark.parametrize("sun", [50.0, 180.0])
def test_expectation_of_pictures_is_the_mean_map(sun: float) -> None:
    eye = camera(30.0, -4.0, -16.0, 12, azimuth=100.0, width=16.0, columns=32)
    view = sea_view(table_air(WIND), SLOPES, sun_zenith=sun, sun_azimuth=20.0)
    scene, clear = foamy(view, eye), swept_scene(view, eye, breaking().waves)
    times = np.arange(12) * 11.0
    pictures = [shown(scene, t) for t in times]
    found = np.mean([one.radiance for one in pictures], axis=(0, 2))
    water = np.mean([shown(clear, t).radiance for t in times], axis=(0, 2))
    mean, mean_water = (mean_radiance(one.view, eye.elevations, eye.azimuths).total.mean(axis=1) for one in (scene, clear))
    np.testing.assert_allclose(found, mean, rtol=1e-2)
    # what foam adds for its share in these pictures: it lies on steep crests, whose water is not the mean water
    share = np.mean([one["foam_share"] for one in pictures])
    gained, expected = (found - water).mean() / share, (mean - mean_water).mean() / SHARE
    assert gained == pytest.approx(expected, rel=0.25)


@pytest.mark.parametrize("sun", [50.0, 180.0])
def test_foam_that_lies_anywhere_adds_what_it_adds_to_the_map(sun: float) -> None:
    eye = camera(30.0, -4.0, -16.0, 12, azimuth=100.0, width=16.0, columns=32)
    view, waves, share = sea_view(table_air(WIND), SLOPES, sun_zenith=sun, sun_azimuth=20.0), breaking().waves, 0.3
    foam = replace(view, foam=FoamCover(share))
    scenes = (SweptScene.prepare(foam, eye, waves, accuracy=Accuracy()), swept_scene(view, eye, waves))
    times = np.arange(6) * 11.0
    found = [np.mean([shown(scene, t).radiance for t in times]) for scene in scenes]
    mean = [mean_radiance(one, eye.elevations, eye.azimuths).total.mean() for one in (foam, view)]
    # bubbles replace water, of which picture and map differ by 0.1 %
    other_water = BUBBLES * share * (found[1] - mean[1])
    assert found[0] - found[1] == pytest.approx(mean[0] - mean[1] - other_water, rel=0.05)


def test_foam_changes_no_pixel_beside_it() -> None:
    eye = camera(20.0, -1.0, -9.0, 96, azimuth=120.0, width=8.0, columns=64)
    view = sea_view(table_air(WIND), SLOPES, height=20.0, sun_zenith=180.0)
    scene, clear = foamy(view, eye), swept_scene(view, eye, breaking().waves, layers=LAYERS)
    found, water = shown(scene, 3.0), shown(clear, 3.0)
    none = found["foam_share"] == 0.0
    assert none.mean() > 0.3
    np.testing.assert_array_equal(found.radiance[none], water.radiance[none])
    # foam is where the layer says
    gained = (found.radiance - water.radiance)[~none]
    assert np.corrcoef(gained, found["foam_share"][~none])[0, 1] > 0.8


def test_share_of_foam_in_view_is_the_coverage() -> None:
    eye = camera(60.0, -30.0, -55.0, 40, width=40.0, columns=48)
    scene = foamy(sea_view(table_air(WIND), SLOPES, height=60.0, sun_zenith=180.0), eye)
    found = [shown(scene, t)["foam_share"] for t in np.arange(14) * 9.0]
    each = np.array([share.mean() for share in found])
    assert each.mean() == pytest.approx(SHARE, abs=4.0 * each.std() / np.sqrt(each.size) + 0.03 * SHARE)
    assert max(share.max() for share in found) <= 1.0


def test_turned_cameras_see_the_same_foam() -> None:
    height = 40.0
    imager = Imager("equal-angle", np.radians(12.0), np.radians(8.0), 48, 32)
    view = replace(sea_view(table_air(WIND), SLOPES, height=height, sun_zenith=40.0), foam=FoamCover(SHARE))
    field = breaking()
    for elevation in (-20.0, -62.0):  # swept, and by rays
        upright = imager.camera(height, Attitude(0.3, np.radians(elevation), 0.0))
        swept = shown(SweptScene.prepare(view, upright, field.waves, layers=LAYERS, breaking=field), 2.0)
        attitude = Attitude(0.3, np.radians(elevation), 1e-6)
        turned = TurnedScene.prepare(lambda h: view, imager, Track.standing(height, attitude), field.waves, layers=LAYERS, breaking=field)
        other = shown(turned, 2.0)
        assert np.corrcoef(swept["foam_share"].ravel(), other["foam_share"].ravel())[0, 1] > 0.85
        assert other["foam_share"].mean() == pytest.approx(swept["foam_share"].mean(), rel=0.15)
        assert other.radiance.mean() == pytest.approx(swept.radiance.mean(), rel=2e-3)


def test_foam_moves_without_jumps_where_detail_changes() -> None:
    eye = camera(20.0, -0.3, -6.0, 60, azimuth=120.0, width=10.0, columns=64)
    scene = foamy(sea_view(table_air(WIND), SLOPES, height=20.0, sun_zenith=180.0), eye)
    assert len(scene.levels.detail.levels) > 2
    frames = np.array([shown(scene, 5.0 + i / 60.0)["foam_share"] for i in range(5)])
    steps = np.abs(np.diff(frames, axis=0)).mean(axis=(0, 2))  # of every row
    level = frames.mean(axis=(0, 2))
    assert np.all(steps[level > 5e-3] < 0.25 * level[level > 5e-3])
    # the mean share of a row does not step where a level of detail begins
    many = np.mean([shown(scene, 9.0 * i)["foam_share"] for i in range(16)], axis=(0, 2))
    smooth = np.convolve(many, np.ones(9) / 9.0, mode="valid")
    assert smooth.max() < 2.5 * smooth.min()


def test_reseeded_foam_is_that_of_the_seed() -> None:
    eye = camera(30.0, -4.0, -16.0, 8, width=8.0, columns=16)
    scene = foamy(sea_view(table_air(WIND), SLOPES, sun_zenith=180.0), eye)
    other = scene.reseeded(5)
    waves = breaking().waves.reseeded(5)
    field = FoamField.create(waves, BreakingCrests.create(SHARE, WIND), WIND, waves.spectrum.wind_to_azimuth, 5)
    fresh = SweptScene.prepare(scene.view, eye, waves, layers=LAYERS, breaking=field)
    assert np.array_equal(shown(other, 1.0)["foam_share"], shown(fresh, 1.0)["foam_share"])
    assert not np.array_equal(shown(other, 1.0)["foam_share"], shown(scene, 1.0)["foam_share"])


def test_columns_alone_and_ships() -> None:
    eye = camera(30.0, -4.0, -16.0, 16, width=8.0, columns=16)
    scene = foamy(sea_view(table_air(WIND), SLOPES, sun_zenith=180.0), eye)
    whole = image(scene, scene.pose, 4.0)
    part = scene.columns(scene.pose, 4.0, (5, 9))
    for name in ("radiance", "foam_share"):
        assert np.array_equal(whole[name][:, 5:9], part[name])
    # a strip of foam across the view, 200 m away
    strip = np.array([[-60.0, 200.0, 15.0, 0.9, 1.0, 0.0, 60.0, 200.0, 15.0, 0.9, 1.0, 0.0]])
    ships = FoamSegments(np.array([-60.0, 60.0, 185.0, 215.0]), strip)
    sea = scene.sea(scene.pose, 4.0, ships)
    found = image(scene, scene.pose, 4.0, sea)["foam_share"] - whole["foam_share"]
    row = int(np.argmin(np.abs(eye.elevations + np.arctan(30.0 / 200.0))))
    assert found[row].mean() > 0.4
    assert np.abs(found[-1]).max() == 0.0
    clear = image(scene, scene.pose, 4.0, scene.sea(scene.pose, 4.0, None))
    assert clear["foam_share"].max() == 0.0


def test_foam_of_pieces_is_that_of_single_reads() -> None:
    """At every level of detail, over all ranges; where nothing is marked, there is no foam."""
    rng = np.random.default_rng(10)
    scene = foamy(sea_view(table_air(WIND), SLOPES), camera(30.0, -1.0, -20.0, 12, width=4.0, columns=3))
    surface = scene.surface(5.0, (300.0, -200.0))
    foam, count = surface.foam, 400
    assert 0.05 < foam.marks.mean() < 0.95
    everywhere = surface._replace(foam=foam._replace(marks=np.ones_like(foam.marks)))
    omitted = 0
    for level in range(surface.level.shape[0]):
        omitted += int((foam.row[level] < 0).sum())
        for azimuth in rng.uniform(0.0, 2.0 * np.pi, 3):
            away, wide = (np.sin(azimuth), np.cos(azimuth)), float(np.exp(rng.uniform(-9.0, -4.0)))
            arcs = np.sort(np.exp(rng.uniform(np.log(30.0), np.log(2e4), count)))
            line = wave_surface.course(surface, level, *away, (30.0, 2e4))
            made = walk.new_pieces(3)
            made.arc[:count] = arcs
            walk.read_foam(surface, level, line, away, wide, made, count)
            single = [[wave_surface.foam_share(sea, level, line, away, r, wide * r) for r in arcs] for sea in (surface, everywhere)]
            assert max(single[0]) > 0.05
            np.testing.assert_allclose(made.foam[:count], single[0], rtol=1e-9, atol=1e-9)
            assert single[0] == single[1]
    assert omitted > 0
