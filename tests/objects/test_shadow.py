"""Shadows of objects on the glint against the closed form of a box's shadow."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.objects import solids
from seaglint.objects.body import Body, Placement
from seaglint.objects.drawing.compose import shadowed
from seaglint.objects.drawing.draw import Drawer, Stage
from seaglint.objects.solids import solid
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import Sequence, prepare_sequence

SIZE = (20.0, 8.0, 12.0)
DRAUGHT = 3.0
FAR = 700.0
EYE = 300.0


class Still:
    """Where it always is."""

    def at(self, time: float) -> Placement:
        return Placement(np.array([0.0, FAR, 0.5 * SIZE[2] - DRAUGHT]), np.eye(3))


SCENE = {
    "sun": {"zenith_deg": 65.0, "azimuth_deg": 0.0},
    "sensor": {"pixels": [220, 160], "fov_deg": [5.5, 4.0], "azimuth_deg": 0.0, "elevation_deg": -24.0, "height_m": EYE, "frames": 1},
    "sea": {"resolve_waves": False},
    "render": {"layers": ["coverage", "glint_share"]},
}
BOX = {"name": "box", "shape": {"kind": "box", "size_m": list(SIZE)}, "temperature_k": 300.0, "draught_m": DRAUGHT, "north_m": FAR}


@cache
def glinting() -> Sequence:
    """A calm glinting sea, its Sun beyond the place of the box."""
    return prepare_sequence(parse_scenario({**SCENE, "objects": [BOX]}))


def darkened(azimuth_deg: float):
    """The image with and without the shadow under a Sun from somewhere: only where the shadow lies depends on it."""
    run = glinting()
    pose, layers = run.track.at(0.0), run.scene.drawn(run.track.at(0.0), 0.0)
    view = replace(run.scene.view, solar_azimuth=math.radians(azimuth_deg))
    stage = Stage(run.scene.pixels, pose, view, None, (0, 220), (0, 160))
    drawer = Drawer.of((Body("box", (solid(solids.box(SIZE), 300.0, 0.9),), Still()),))
    return stage, layers, shadowed(layers, stage, drawer.picture(stage, 0.0).placed, drawer.light(view))


@pytest.mark.parametrize("azimuth_deg", [0.0, 35.0, -60.0])
def test_a_box_darkens_the_solid_angle_of_its_shadow(azimuth_deg):
    stage, bare, dark = darkened(azimuth_deg)
    lost = 1.0 - dark.glint_radiance.astype(float) / bare.glint_radiance
    assert lost.min() >= 0.0
    assert lost.max() == pytest.approx(1.0, abs=1e-6)
    pixel = stage.imager.solid_angle(stage.pose.attitude, np.arange(220) + 0.5, np.arange(160)[:, None] + 0.5)
    turn, above = math.radians(azimuth_deg), SIZE[2] - DRAUGHT
    length = above * math.tan(math.radians(65.0))
    # the waterline, and what it sweeps on its way from the Sun
    area = SIZE[0] * SIZE[1] + length * (SIZE[0] * abs(math.cos(turn)) + SIZE[1] * abs(math.sin(turn)))
    i, j = np.meshgrid(np.arange(220) + 0.5, np.arange(160) + 0.5)
    weight = lost * pixel
    # every pixel's share of the sea that it sees: distance squared over the sine of its grazing angle
    down = -stage.imager.directions(stage.pose.attitude, i, j)[..., 2]
    way = EYE / down * (1.0 + EYE / down**2 / (2.0 * EFFECTIVE_EARTH_RADIUS))
    assert (weight * way**2 / down).sum() == pytest.approx(area, rel=0.01)
    # as symmetric as the waterline, about its middle half-way
    ground = np.array([np.sin(turn), np.cos(turn)]) * -0.5 * length + np.array([0.0, FAR])
    across = stage.imager.directions(stage.pose.attitude, i, j)
    east, north = ((weight * way**3 / down * across[..., k]).sum() / (weight * way**2 / down).sum() for k in (0, 1))
    assert east == pytest.approx(ground[0], abs=0.2)
    assert north == pytest.approx(ground[1], abs=0.4)


def test_only_the_glint_of_pixels_in_the_shadow_changes():
    _, bare, dark = darkened(0.0)
    touched = dark.glint_radiance != bare.glint_radiance
    assert 100 < touched.sum() < 0.5 * touched.size
    assert np.array_equal(dark.radiance[~touched], bare.radiance[~touched])
    lost = bare.glint_radiance.astype(float) - dark.glint_radiance
    np.testing.assert_allclose(dark.radiance, bare.radiance - lost, rtol=1e-5)
    assert dark["glint_share"][touched].max() < bare["glint_share"].max()
    assert np.array_equal(dark["coverage"], bare["coverage"])


def test_the_key_draws_the_shadow_and_is_off_where_nothing_is_said():
    run = glinting()
    assert run.objects is not None
    assert run.objects.shadows is False
    lit = run.at(0.0)
    shaded = replace(run, objects=replace(run.objects, shadows=True)).drawn(0.0)
    truth = run.objects.truth(shaded.sights, shaded.sea, run.scene, (run.scene.pixels, run.track.at(0.0).attitude))
    beside = (lit.radiance != shaded.layers.radiance) & ~(truth["object_mask"][0] > 0)
    assert beside.sum() > 100
    assert (shaded.layers.radiance[beside] < lit.radiance[beside]).all()
    assert parse_scenario({"render": {"object_shadows": True}}).render.object_shadows


def test_a_sun_under_the_horizon_casts_none():
    run = glinting()
    layers = run.scene.drawn(run.track.at(0.0), 0.0)
    view = replace(run.scene.view, solar_zenith=math.radians(91.0))
    stage = Stage(run.scene.pixels, run.track.at(0.0), view, None, (0, 220), (0, 160))
    drawer = Drawer.of((Body("box", (solid(solids.box(SIZE), 300.0, 0.9),), Still()),))
    assert shadowed(layers, stage, drawer.picture(stage, 0.0).placed, drawer.light(view)) is layers
