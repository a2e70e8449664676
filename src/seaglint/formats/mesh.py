"""Mesh files: closed surfaces read by trimesh from STL, OBJ, PLY and GLB, and height fields written as binary little-endian PLY.

A written mesh has two triangles per cell of the height field, and normals at the vertices.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, StorageError
from seaglint.base.optional import optional
from seaglint.objects.solids import Mesh
from seaglint.store.outputs import moved_when_whole, reason_of, refuse_existing

SUFFIXES: Final = (".stl", ".obj", ".ply", ".glb")  #: Endings of the formats that are read.

METRES: Final = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "in": 0.0254, "ft": 0.3048}  #: Length of each unit [m].

MOST_TRIANGLES: Final = 4_000_000  #: Largest number of triangles of a file: a million take some seconds to check and 0.5 GB.

#: Rotation from the axes of glTF (y up, z forward, x to port) to starboard, forward and up.
_Y_UP: Final = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True, eq=False)
class MeshData:
    """Content of a mesh file: vertices [m] and triangles, and for each vertex temperature [K] and emissivity, where given."""

    mesh: Mesh
    temperature: FloatArray | None = None
    emissivity: FloatArray | None = None


def read_mesh(path: str | Path, *, metres: float = 1.0, up: Literal["auto", "z", "y"] = "auto") -> MeshData:
    """Read a mesh file.

    Parameters
    ----------
    path : path
        The file.
    metres : float
        Length of its unit [m].
    up : "auto", "z" or "y"
        Upward axis: z, with y forward, or y, with z forward; auto is y for GLB, z for the others.

    Raises
    ------
    DataError
        A file of another kind, one that cannot be read, or one without triangles.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise DataError(f"{path}: is no mesh file that is read; allowed are {', '.join(SUFFIXES)}: export it as one of them")
    trimesh = optional("trimesh", f"{path}: a mesh file")

    try:
        mesh: Any = trimesh.load(str(path), force="mesh", process=False)
        vertices, triangles = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)
    except Exception as error:  # trimesh's readers raise nearly anything
        raise DataError(f"{path}: cannot be read as a mesh: {reason_of(error, 120)}; export it again") from None
    if vertices.ndim != 2 or not len(triangles):
        raise DataError(f"{path}: holds no triangles; export a closed surface")
    if len(triangles) > MOST_TRIANGLES:
        raise DataError(f"{path}: holds {len(triangles)} triangles; allowed are {MOST_TRIANGLES}: simplify the mesh")
    if up == "y" or (up == "auto" and suffix == ".glb"):
        vertices = vertices @ _Y_UP.T
    values = {name: _property(mesh, name, len(vertices)) for name in ("temperature", "emissivity")} if suffix == ".ply" else {}
    return MeshData((vertices * metres, triangles.astype(np.int32)), values.get("temperature"), values.get("emissivity"))


def _property(mesh: Any, name: str, size: int) -> FloatArray | None:
    """Return a property of a PLY file's vertices by name."""
    # trimesh keeps properties that it does not know in the raw content.
    raw = mesh.metadata.get("_ply_raw", {}).get("vertex", {}).get("data")
    if raw is None:
        return None
    if name not in ((raw.dtype.names if isinstance(raw, np.ndarray) else raw.keys()) or ()):
        return None
    values = np.asarray(raw[name], np.float64).reshape(-1)
    return values if values.size == size else None


MOST_VERTICES: Final = 2**31 - 1  #: Largest number of vertices, since readers take the indices of faces for signed 32-bit numbers.

_VERTEX: Final = np.dtype([(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")])
_FACE: Final = np.dtype([("count", "u1"), ("corner", "<i4", (3,))])


def ply_bytes(rows: int, columns: int) -> int:
    """Return the size of the file without its header of some hundred bytes."""
    return rows * columns * _VERTEX.itemsize + 2 * (rows - 1) * (columns - 1) * _FACE.itemsize


def write_ply(
    output: str | Path, x: FloatArray, y: FloatArray, surface: NDArray[np.float32], *, comments: Sequence[str] = (), overwrite: bool = False
) -> Path:
    """Write a mesh of two triangles per cell, counter-clockwise seen from above, row by row.

    Parameters
    ----------
    output : path
        File to write.
    x, y : ndarray
        Coordinates of the columns and of the rows, ascending [m].
    surface : ndarray
        Height [m], slope along x and slope along y [1], (rows, columns, 3). Normals follow from the given slopes, not from the triangles.
    comments : sequence of str
        Lines of the header.
    overwrite : bool
        Replace an existing file.

    Raises
    ------
    DataError
        The output exists, or the mesh has too few or too many vertices.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(output, overwrite=overwrite)
    rows, columns = surface.shape[:2]
    if min(rows, columns) < 2 or rows * columns > MOST_VERTICES:
        raise DataError(f"{output}: a mesh of {rows} x {columns} vertices; allowed are 2 x 2 up to {MOST_VERTICES} vertices in all")
    need, room = ply_bytes(rows, columns), shutil.disk_usage(output.parent).free
    if need > room:
        raise StorageError(f"{output}: needs {need / 1e9:.3g} GB and {room / 1e9:.3g} GB are free there; make room or choose another place")
    header = ["ply", "format binary_little_endian 1.0", *(f"comment {' '.join(line.split())}" for line in comments)]
    header += [f"element vertex {rows * columns}", *(f"property float {name}" for name in _VERTEX.names or ())]
    header += [f"element face {2 * (rows - 1) * (columns - 1)}", "property list uchar int vertex_indices", "end_header"]
    with moved_when_whole(output) as partial, partial.open("wb") as stream:
        stream.write(("\n".join(header) + "\n").encode("ascii", "replace"))
        line = np.empty(columns, _VERTEX)
        for i in range(rows):
            z, sx, sy = surface[i].T.astype(np.float64)
            # The normal of z = f(x, y) is (-df/dx, -df/dy, 1), made one long.
            up = 1.0 / np.sqrt(1.0 + sx * sx + sy * sy)
            for name, value in zip(_VERTEX.names or (), (x, y[i], z, -sx * up, -sy * up, up), strict=True):
                line[name] = value
            stream.write(line.tobytes())
        faces = np.empty((columns - 1, 2), _FACE)
        faces["count"] = 3
        # corners of the cells of the first row of cells; the next row's are `columns` more
        corner = np.arange(columns - 1)[:, None, None] + np.array([[0, 1, columns + 1], [0, columns + 1, columns]])
        for i in range(rows - 1):
            faces["corner"] = corner + i * columns
            stream.write(faces.tobytes())
    return output
