"""Reader of closed surfaces from mesh files: STL, OBJ, PLY and GLB, by trimesh."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.optional import optional
from seaglint.objects.primitives import Mesh

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
    except Exception as error:  # its readers raise whatever they meet
        raise DataError(f"{path}: cannot be read as a mesh: {' '.join(str(error).split())[:120]}; export it again") from None
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
    raw = mesh.metadata.get("_ply_raw", {}).get("vertex", {}).get("data")
    if raw is None:
        return None
    names = raw.dtype.names if isinstance(raw, np.ndarray) else raw.keys()
    if name not in (names or ()):
        return None
    values = np.asarray(raw[name], np.float64).reshape(-1)
    return values if values.size == size else None
