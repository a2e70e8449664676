"""Writer of a height field as a triangle mesh: binary little-endian PLY, with normals at the vertices."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, StorageError
from seaglint.files.outputs import moved_when_whole, refuse_existing

MOST_VERTICES: Final = 2**31 - 1  #: Largest number of vertices, since readers take the indices of faces for signed 32-bit numbers.

_VERTEX: Final = np.dtype([(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")])
_FACE: Final = np.dtype([("count", "u1"), ("corner", "<i4", (3,))])


def ply_bytes(rows: int, columns: int) -> int:
    """Return the size of the file without its header of some hundred bytes."""
    return rows * columns * _VERTEX.itemsize + 2 * (rows - 1) * (columns - 1) * _FACE.itemsize


def write_ply(
    output: str | Path,
    x: FloatArray,
    y: FloatArray,
    surface: NDArray[np.float32],
    *,
    comments: Sequence[str] = (),
    overwrite: bool = False,
) -> Path:
    """Write a mesh of two triangles per cell, counter-clockwise seen from above, row by row.

    Parameters
    ----------
    output : path
        File to write.
    x, y : ndarray
        Coordinates of the columns and of the rows, ascending [m].
    surface : ndarray
        Height [m], slope along x and slope along y [1], (rows, columns, 3). Normals are those of the slopes given, not of the triangles.
    comments : sequence of str
        Lines of the header.
    overwrite : bool
        Replace what is there.

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
