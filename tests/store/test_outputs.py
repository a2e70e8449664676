"""Output files: what may be replaced, and that nothing half-written stays."""

import os
import stat

import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import DataError
from seaglint.formats.tables.input_tables import read_cases, write_cases
from seaglint.formats.tables.table_text import write_columns
from seaglint.store.netcdf import write_netcdf
from seaglint.store.outputs import moved_when_whole, refuse_existing

needs_fifo = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes are a matter of Unix")


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    yield path
    assert stat.S_ISFIFO(path.lstat().st_mode)  # whatever was tried
    assert not path.with_name("pipe.partial").exists()


def _cases(path):
    source = path.with_name("cases.csv")
    source.write_text("x\n1\n")
    write_cases(read_cases(source), {"y": ["2"]}, path, overwrite=True)


def _moved(path):
    with moved_when_whole(path) as partial:
        partial.write_text("new")


@needs_fifo
@pytest.mark.parametrize(
    "write",
    [
        _cases,
        _moved,
        lambda path: refuse_existing(path),
        lambda path: write_columns({"x": np.ones(2)}, path, overwrite=True),
        lambda path: write_netcdf(xr.Dataset({"x": ("n", [1.0])}), path, overwrite=True),
    ],
    ids=["cases", "pictures", "check", "columns", "netcdf"],
)
@pytest.mark.parametrize("linked", [False, True], ids=["itself", "by a link"])
def test_a_pipe_is_never_replaced(pipe, write, linked):
    path = pipe
    if linked:
        path = pipe.with_name("link")
        path.symlink_to(pipe)
    with pytest.raises(DataError, match="device, pipe or socket") as error:
        write(path)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


@needs_fifo
def test_a_pipe_under_the_name_of_the_unfinished_file_is_left_alone(tmp_path):
    os.mkfifo(tmp_path / "out.csv.partial")
    with pytest.raises(DataError, match=r"out\.csv\.partial: is a device, pipe"):
        _moved(tmp_path / "out.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["out.csv.partial"]


def test_a_file_is_replaced_when_whole_and_kept_when_not(tmp_path):
    output = tmp_path / "out.txt"
    output.write_text("old")
    with pytest.raises(TypeError), moved_when_whole(output) as partial:
        partial.write_text(None)
    assert output.read_text() == "old"
    _moved(output)
    assert output.read_text() == "new"
    assert [path.name for path in tmp_path.iterdir()] == ["out.txt"]


def test_folders_are_named(tmp_path):
    with pytest.raises(DataError, match="is a folder"):
        refuse_existing(tmp_path, overwrite=True)
    with pytest.raises(DataError, match="does not exist; make it first"):
        refuse_existing(tmp_path / "none" / "out.csv")
