"""Meshes: read back by a reader of the format's few rules, and checked as surfaces."""

import numpy as np
import pytest

from seaglint.base.errors import DataError, StorageError
from seaglint.formats import mesh
from seaglint.formats.mesh import ply_bytes, write_ply

TYPES = {"float": "<f4", "uchar": "u1", "int": "<i4"}


def read_ply(path):
    """Vertices as a record array, triangles (n, 3), and the comments of a binary little-endian file."""
    content = path.read_bytes()
    head, _, body = content.partition(b"end_header\n")
    lines = head.decode("ascii").splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    counts, fields = {}, {}
    for line in lines[2:]:
        word = line.split()
        if word[0] == "element":
            counts[word[1]], element = int(word[2]), word[1]
        elif word[0] == "property" and word[1] != "list":
            fields.setdefault(element, []).append((word[2], TYPES[word[1]]))
        elif word[0] == "property":
            fields[element] = [("count", TYPES[word[2]]), (word[4], TYPES[word[3]], (3,))]
    vertex = np.frombuffer(body, np.dtype(fields["vertex"]), counts["vertex"])
    face = np.frombuffer(body, np.dtype(fields["face"]), counts["face"], vertex.nbytes)
    assert vertex.nbytes + face.nbytes == len(body)
    assert np.all(face["count"] == 3)
    return vertex, face["vertex_indices"], [line.removeprefix("comment ") for line in lines if line.startswith("comment")]


@pytest.fixture
def plane(tmp_path):
    """A tilted plane of 5 x 4 points: triangles' normals are the vertices' normals."""
    x, y = 10.0 + 2.0 * np.arange(5), -3.0 + 2.0 * np.arange(4)
    surface = np.empty((4, 5, 3), np.float32)
    surface[..., 0], surface[..., 1], surface[..., 2] = 0.3 * x + -0.2 * y[:, None], 0.3, -0.2
    path = write_ply(tmp_path / "sea.ply", x, y, surface, comments=["one\ntwo"])
    return x, y, surface, path


def test_vertices_normals_and_comments_return(plane):
    x, y, surface, path = plane
    vertex, _, comments = read_ply(path)
    assert np.array_equal(vertex["x"].reshape(4, 5), np.broadcast_to(x, (4, 5)))
    assert np.array_equal(vertex["y"].reshape(4, 5), np.broadcast_to(y[:, None], (4, 5)))
    assert np.array_equal(vertex["z"].reshape(4, 5), surface[..., 0])
    assert comments == ["one two"]


def test_triangles_cover_the_patch_once_and_face_upwards(plane):
    x, y, _, path = plane
    vertex, face, _ = read_ply(path)
    corner = np.stack([vertex["x"], vertex["y"], vertex["z"]], axis=-1).astype(float)[face]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert np.all(normal[:, 2] > 0.0)
    assert 0.5 * normal[:, 2].sum() == pytest.approx((x[-1] - x[0]) * (y[-1] - y[0]), rel=1e-6)  # single precision
    unit = normal / np.linalg.norm(normal, axis=1)[:, None]
    given = np.array([vertex[name][0] for name in ("nx", "ny", "nz")])
    assert np.abs(unit - given).max() < 1e-5  # single precision of coordinates of tens of metres
    edges = np.sort(np.concatenate([face[:, [0, 1]], face[:, [1, 2]], face[:, [2, 0]]]), axis=1)
    uses = np.unique(edges, axis=0, return_counts=True)[1]
    assert np.sum(uses == 1) == 2 * (4 + 3)  # the rim alone
    assert uses.max() == 2


def test_size_is_told_beforehand(plane):
    path = plane[3]
    body = path.read_bytes().partition(b"end_header\n")[2]
    assert ply_bytes(4, 5) == len(body)


@pytest.mark.parametrize("shape", [(1, 5), (5, 1)])
def test_a_mesh_needs_two_points_each_way(shape, tmp_path):
    with pytest.raises(DataError, match="2 x 2"):
        write_ply(tmp_path / "sea.ply", np.arange(shape[1]) * 1.0, np.arange(shape[0]) * 1.0, np.zeros((*shape, 3), np.float32))


def test_what_the_disk_cannot_hold_is_refused_with_its_size(tmp_path, monkeypatch):
    monkeypatch.setattr(mesh.shutil, "disk_usage", lambda path: type("Usage", (), {"free": 10})())
    with pytest.raises(StorageError, match="GB are free"):
        write_ply(tmp_path / "sea.ply", np.arange(3.0), np.arange(3.0), np.zeros((3, 3, 3), np.float32))
    assert list(tmp_path.iterdir()) == []
