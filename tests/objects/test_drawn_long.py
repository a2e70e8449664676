"""Objects in the picture at length: a sea that hides them by chance, meshes of a million triangles, combinations against meshes."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
import xarray as xr
from scipy.interpolate import RegularGridInterpolator

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.cli.app import main
from seaglint.imaging.wave_surface import course, height
from seaglint.objects import solids
from seaglint.objects.body import Body, Placement
from seaglint.objects.drawing.draw import Drawer, Stage
from seaglint.objects.drawing.sample_sums import COVER, SEEN
from seaglint.objects.solids import combined, placed, solid
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence

pytestmark = pytest.mark.validation


class Still:
    def __init__(self, position, rotation=None):
        self.placement = Placement(np.array(position, float), np.eye(3) if rotation is None else rotation)

    def at(self, time):
        return self.placement


def sea_sequence(eye, fov, *, waves):
    sensor = {"pixels": [128, 64], "fov_deg": fov, "elevation_deg": -0.2, "azimuth_deg": 0.0, "height_m": eye}
    return prepare_sequence(parse_scenario({"sensor": sensor, "wind": {"speed_m_s": 10.0}, "sea": {"resolve_waves": waves}}))


def stage(run, time):
    sea, pose = run.scene.sea(run.scene.pose, time), run.scene.pose
    pixels = run.scene.pixels
    waves = (sea.levels, sea.surface) if run.scene.waves is not None else None
    return Stage(pixels, pose, run.scene.view, waves, (0, pixels.columns), (0, pixels.rows))


def test_a_rough_sea_hides_low_objects_as_often_as_lines_of_sight_say():
    eye, far, width = 8.0, 3000.0, 0.3
    run = sea_sequence(eye, [8.0, 4.0], waves=True)
    azimuths = np.radians(np.linspace(-3.5, 3.5, 29))
    post = solid(solids.box((width, width, 1.0)), 300.0, 1.0)
    bodies = tuple(Body(f"{i}", (post,), Still((far * math.sin(a), far * math.cos(a), 0.5))) for i, a in enumerate(azimuths))
    shown, counted = [], []
    arcs = np.arange(1000.0, far, 0.2)
    drop = eye + arcs**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    for time in (0.0, 7.0, 19.0):
        at = stage(run, time)
        found = {p.placed.part.body: p.sums[SEEN] for p in Drawer.of(bodies).picture(at, time).patches}
        surface = at.sea[1]
        for i, a in enumerate(azimuths):
            shown.append(found.get(i, 0.0) / (width * (abs(math.cos(a)) + abs(math.sin(a))) / far**2))
            line = course(surface, 0, math.sin(a), math.cos(a), (arcs[0], arcs[-1]))
            sea = np.array([height(surface, line, 0, line.part.shape[0], r) for r in arcs])
            highest = ((sea - drop) / arcs).max()
            lowest = max(highest * far + eye + far**2 / (2.0 * EFFECTIVE_EARTH_RADIUS), 0.0, sea[-1])
            counted.append(max(1.0 - lowest, 0.0))
    shown, counted = np.array(shown), np.array(counted)
    hidden = np.mean(shown < 1e-3)
    assert 0.2 < np.mean(counted == 0.0) < 0.98
    # three standard errors of a share that is the same for 95 % of them
    assert hidden == pytest.approx(np.mean(counted == 0.0), abs=3.0 * math.sqrt(0.05 / shown.size))
    assert shown.mean() == pytest.approx(counted.mean(), abs=0.03)


POSTS = """
[sensor]
pixels = [128, 64]
fov_deg = [8.0, 4.0]
elevation_deg = -0.2
azimuth_deg = 0.0
height_m = 8.0
frames = 20
frame_rate_hz = 1.0
[wind]
speed_m_s = 10.0
[sea]
shortest_wave_m = 4.0
[render]
tile_size = 256
"""


def test_labels_say_hidden_as_often_as_lines_of_sight_over_the_exported_sea(tmp_path, monkeypatch):
    eye, far, count = 8.0, 3000.0, 29
    azimuths = np.radians(np.linspace(-3.5, 3.5, count))
    east, north = far * np.sin(azimuths), far * np.cos(azimuths)
    posts = [
        f'[[objects]]\nname = "{i}"\nshape = {{ kind = "box", size_m = [0.3, 0.3, 1] }}\ntemperature_k = 300\n'
        f"east_m = {east[i]}\nnorth_m = {north[i]}\nheight_m = 0.5\n"
        for i in range(count)
    ]
    path = tmp_path / "posts.toml"
    path.write_text(POSTS + "".join(posts))
    run = prepare_sequence(load_scenario(path))
    arcs = np.arange(1000.0, far, 0.5)
    drop = (eye + arcs**2 / (2.0 * EFFECTIVE_EARTH_RADIUS))[:, None]
    shown, counted = [], []
    for time in (0, 7, 19):
        shown.append(run.images(time)["visible_share"])
        patch = ("--time", time, "--centre", 0, 1990, "--extent", 400, 2040, "--spacing", 1, "--no-lattices")
        monkeypatch.setattr("sys.argv", ["seaglint", "export-sea", str(path), "-o", str(tmp_path / f"{time}.nc"), *map(str, patch)])
        with pytest.raises(SystemExit) as end:
            main()
        assert not end.value.code
        with xr.open_dataset(tmp_path / f"{time}.nc") as sea:
            read = RegularGridInterpolator((sea.y.to_numpy(), sea.x.to_numpy()), sea.height.to_numpy())
        heights = read((arcs[:, None] * np.cos(azimuths), arcs[:, None] * np.sin(azimuths)))
        highest = ((heights - drop) / arcs[:, None]).max(axis=0)
        lowest = np.maximum(highest * far + eye + far**2 / (2.0 * EFFECTIVE_EARTH_RADIUS), np.maximum(heights[-1], 0.0))
        counted.append(np.clip(1.0 - lowest, 0.0, None))
    shown, counted = np.concatenate(shown), np.concatenate(counted)
    print(f"hidden {np.mean(shown < 1e-3):.3f} and {np.mean(counted == 0.0):.3f}, shown {shown.mean():.4f} and {counted.mean():.4f} m")
    assert 0.2 < np.mean(counted == 0.0) < 0.98
    # three standard errors of a share that is the same for 95 % of them
    assert np.mean(shown < 1e-3) == pytest.approx(np.mean(counted == 0.0), abs=3.0 * math.sqrt(0.05 / shown.size))
    assert shown.mean() == pytest.approx(counted.mean(), abs=0.03)


def test_a_million_triangles_are_drawn():
    run = sea_sequence(20.0, [2.0, 1.0], waves=False)
    ball = trimesh.creation.icosphere(8, 3.0)
    assert len(ball.faces) > 1e6
    mesh = (np.asarray(ball.vertices), np.asarray(ball.faces, np.int32))
    picture = Drawer.of((Body("ball", (solid(mesh, 300.0, 0.9),), Still((0.0, 1000.0, 15.0))),)).picture(stage(run, 0.0), 0.0)
    place = float(np.linalg.norm(picture.stands[0].place))
    assert picture.patches[0].sums[SEEN] == pytest.approx(2.0 * math.pi * (1.0 - math.sqrt(1.0 - (3.0 / place) ** 2)), rel=2e-3)


def test_a_combination_covers_pixels_as_its_mesh_does():
    at = stage(sea_sequence(20.0, [2.0, 1.0], waves=False), 0.0)
    block, hole = solid(solids.box((6.0, 6.0, 6.0)), 300.0, 1.0), solid(solids.cylinder(1.5, 20.0), 300.0, 1.0)
    drilled = combined("difference", [block, placed(hole, (0.5, 0.2, 0.0), np.eye(3))])
    mesh = trimesh.Trimesh(drilled.vertices, drilled.triangles).subdivide()
    fine = solid((np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int32)), 300.0, 1.0)
    turn = trimesh.transformations.euler_matrix(1.2, 0.3, 0.5)[:3, :3]
    one, other = (Drawer.of((Body("it", (s,), Still((0.0, 900.0, 15.0), turn)),)).picture(at, 0.0).patches[0] for s in (drilled, fine))
    np.testing.assert_allclose(one.planes[COVER], other.planes[COVER], atol=5e-3)
    assert ((one.planes[COVER] > 0.01) & (one.planes[COVER] < 0.99)).sum() > 20
