"""What the program puts off at its start, and that it comes back."""

from __future__ import annotations

import gc
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from xarray.namedarray import pycompat

from seaglint.base.machine import processor
from seaglint.cli.terminal.program import OBJECTS, collect_later, only_numpy
from seaglint.store.netcdf import labelled, write_netcdf

DEMO = Path(__file__).parents[2] / "examples" / "demo.toml"


def python(code: str) -> list[str]:
    """Words that a fresh interpreter prints."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()


@pytest.fixture(autouse=True)
def settled() -> None:
    """End what a command in this process may have put off."""
    gc.collect()


def test_the_first_search_puts_the_settings_back() -> None:
    before, others = gc.get_threshold(), list(gc.callbacks)
    collect_later()
    assert gc.get_threshold() == (OBJECTS, *before[1:])
    gc.collect()
    assert gc.get_threshold() == before
    assert gc.callbacks == others


def test_two_starts_in_one_process_end_as_one() -> None:
    before = gc.get_threshold()
    collect_later()
    collect_later()
    gc.collect()
    assert gc.get_threshold() == before


def test_memory_is_searched_again_when_enough_was_made() -> None:
    code = (
        "import gc; from seaglint.cli.terminal.program import *; before = gc.get_threshold(); collect_later()\n"
        "kept = [[] for _ in range(OBJECTS + 10)]; print(gc.get_threshold() == before)"
    )
    assert python(code) == ["True"]


def test_arrays_of_numpy_are_indexed_and_written_without_other_libraries() -> None:
    code = (
        "import sys; from seaglint.cli.terminal.program import only_numpy; only_numpy(); import numpy as np, xarray as xr\n"
        "data = xr.Dataset({'radiance': (('y', 'x'), np.ones((2, 3)))}, {'x': [1.0, 2.0, 4.0]})\n"
        "print(float(data.radiance.sel(x=2.0)[0].to_numpy()), *({'dask.array', 'pint', 'sparse'} & set(sys.modules)))"
    )
    assert python(code) == ["1.0"]


def test_libraries_in_use_stay(monkeypatch) -> None:
    used = object()
    monkeypatch.setattr(pycompat, "_cached_duck_array_modules", {"sparse": used})
    monkeypatch.setitem(sys.modules, "pint", types.ModuleType("pint"))
    only_numpy()
    assert pycompat._cached_duck_array_modules["sparse"] is used
    assert "pint" not in pycompat._cached_duck_array_modules


def test_a_version_of_xarray_without_these_names_imports_as_before(monkeypatch) -> None:
    monkeypatch.delattr(pycompat, "DuckArrayModule")
    only_numpy()


def test_a_map_has_the_bytes_that_xarray_writes(tmp_path) -> None:
    data = xr.Dataset(
        {"radiance": (("y", "x"), np.linspace(0.0, 1.0, 12).reshape(3, 4))}, {"x": np.arange(4.0)}, {"processor": processor()}
    )
    path = write_netcdf(data, tmp_path / "map.nc")
    written = {"radiance": {"zlib": True, "complevel": 3}, "x": {"_FillValue": None}}
    whole = labelled(data).to_netcdf(engine="h5netcdf", encoding=written)
    assert path.read_bytes() == bytes(whole)


@pytest.mark.parametrize("command", [["mean", "-o", "never.nc"], ["render", "-o", "never.zarr"]], ids=lambda command: command[0])
def test_kernels_are_compiled_while_the_other_libraries_are_imported(command: list[str]) -> None:
    code = (
        "import sys; import seaglint.base.kernel_plan as plan; from seaglint.cli.app import main\n"
        "def seen(work):\n"
        "    print(work, *({'xarray', 'pandas', 'zarr', 'scipy.interpolate', 'matplotlib'} & set(sys.modules))); raise SystemExit(0)\n"
        f"plan.start_helpers = seen; sys.argv = ['seaglint', {command[0]!r}, {str(DEMO)!r}, *{command[1:]!r}]; main()"
    )
    assert python(code) == [command[0]]
