"""NetCDF maps, response files, provenance and the table of variables."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import DataError, StorageError
from seaglint.base.schema import VARIABLES
from seaglint.formats.tables.spectra import read_response
from seaglint.store.netcdf import write_netcdf
from seaglint.store.outputs import storage_errors
from seaglint.store.provenance import band_attributes, provenance, stored_band


def dataset() -> xr.Dataset:
    return xr.Dataset({"radiance": (("y", "x"), np.arange(6.0).reshape(2, 3))}, {"azimuth": ("x", np.arange(3.0))}, {"title": "Mean"})


def test_a_map_comes_back_with_cf_attributes(tmp_path):
    path = write_netcdf(dataset(), tmp_path / "mean.nc")
    with xr.open_dataset(path, engine="h5netcdf") as found:
        np.testing.assert_array_equal(found["radiance"], dataset()["radiance"])
        assert found["radiance"].attrs["units"] == "W m-2 sr-1"
        assert found["azimuth"].attrs["units"] == "degree"
        # CF's sensor_azimuth_angle is measured at the point seen: the opposite direction
        assert "standard_name" not in found["azimuth"].attrs
        assert found.attrs["title"] == "Mean"
    assert [file.name for file in tmp_path.iterdir()] == ["mean.nc"]


def test_coordinates_have_no_fill_value(tmp_path):
    """CF 1.11, 2.5.1; images may have one."""
    import h5py

    with h5py.File(write_netcdf(dataset(), tmp_path / "mean.nc")) as file:
        assert [name for name in dataset().coords if "_FillValue" in file[name].attrs] == []


def test_an_existing_map_is_kept_unless_told_otherwise(tmp_path):
    path = tmp_path / "mean.nc"
    path.write_text("mine")
    with pytest.raises(DataError, match="overwrite=True"):
        write_netcdf(dataset(), path)
    assert path.read_text() == "mine"
    write_netcdf(dataset(), path, overwrite=True)
    assert path.read_bytes()[1:4] == b"HDF"
    with pytest.raises(DataError, match="is a folder"):
        write_netcdf(dataset(), tmp_path, overwrite=True)


def test_a_failed_map_leaves_nothing(tmp_path, monkeypatch):
    def full(self, _):
        with self.open("wb") as file:
            file.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(StorageError, match="no room left"):
        write_netcdf(dataset(), tmp_path / "mean.nc")
    assert list(tmp_path.iterdir()) == []


FULL = """
import resource, sys
import numpy as np, xarray as xr
from seaglint.base.errors import StorageError
from seaglint.store.netcdf import write_netcdf
noise = np.random.default_rng(1).random((300, 300))
sys.dont_write_bytecode = True  # Python would keep half of what it compiles, and fail at its next start
resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
try:
    write_netcdf(xr.Dataset({"radiance": (("y", "x"), noise)}), sys.argv[1], overwrite=True)
except StorageError as error:
    print(error)
    sys.exit(error.exit_code)
"""


def test_a_map_that_does_not_fit_ends_in_a_sentence_and_keeps_the_old_one(tmp_path):
    # In a process of its own: HDF5 writing to a full disk by itself ends in SIGSEGV.
    pytest.importorskip("resource")
    path = tmp_path / "mean.nc"
    path.write_text("old")
    ended = subprocess.run([sys.executable, "-c", FULL, path], capture_output=True, text=True, timeout=600, check=False)
    assert ended.returncode == StorageError.exit_code, ended.stderr
    assert "no room left" in ended.stdout
    assert [file.name for file in tmp_path.iterdir()] == ["mean.nc"]
    assert path.read_text() == "old"


@pytest.mark.parametrize(("number", "words"), [(errno.ENOENT, "moved or removed"), (errno.EIO, "writing failed")])
def test_room_is_not_the_remedy_for_every_refusal(number, words):
    with pytest.raises(StorageError, match=rf"x: .*{words}.*: the-file\)") as caught, storage_errors("x", "make room"):
        raise OSError(number, os.strerror(number), "the-file")
    assert "make room" not in str(caught.value)


def test_our_own_errors_pass_whatever_led_to_them():
    with pytest.raises(DataError, match=r"^busy$"), storage_errors("x", "make room"):
        raise DataError("busy") from BlockingIOError(errno.EAGAIN, "locked")


def test_a_full_disk_is_found_behind_other_exceptions():
    with pytest.raises(StorageError, match=r"x: no room left.*; free some"), storage_errors("x", "free some"):
        raise ExceptionGroup("several writes", [ValueError(), OSError(28, "No space left on device")])
    with pytest.raises(StorageError, match="no right to write"), storage_errors("x", "free some"):
        raise RuntimeError("wrapped") from PermissionError(13, "Permission denied")
    with pytest.raises(ValueError, match="unrelated"), storage_errors("x", "free some"):
        raise ValueError("unrelated")


def test_a_response_file(tmp_path):
    path = tmp_path / "response.csv"
    path.write_text("# made up\nfilter,wavelength_um,response\nA,3.0,0\nA,4.0,50\nA,5.0,0\n")
    band = read_response(path)
    assert (band.min_um, band.max_um) == (3.0, 5.0)
    assert float(band.response.max()) == 1.0  # the peak is 1 whatever the file's unit


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        ("# nothing\n", "is empty"),
        ("lambda,response\n3,1\n", "line 1: columns are lambda, response; needed are wavelength_um, response"),
        ("wavelength_um,response\n3,1\n4", "line 3: '4' does not hold two numbers; is the file whole"),
        ("wavelength_um,response\n3,1\n4,high\n", "line 3"),
        ("wavelength_um,response\n3,1\n4,nan\n", "not finite"),
        ("wavelength_um,response\n3,1\n", "at least 2 rows"),
        ("wavelength_um,response\n3,0\n4,0\n", "somewhere > 0"),
    ],
)
def test_response_files_that_cannot_be_used(tmp_path, text, words):
    path = tmp_path / "response.csv"
    path.write_text(text)
    with pytest.raises(DataError) as caught:
        read_response(path)
    assert str(path) in str(caught.value)
    assert words in str(caught.value)


def test_a_missing_response_file(tmp_path):
    with pytest.raises(DataError, match="no such file"):
        read_response(tmp_path / "nix.csv")


def test_provenance_is_json_and_gives_the_band_back(tmp_path):
    path = tmp_path / "response.csv"
    path.write_text("wavelength_um,response\n3.0,0.1\n4.1,50\n5.0,0.3\n")
    band = read_response(path)
    attributes = provenance("t", "{}", 1, **band_attributes(band))
    again = stored_band(json.loads(json.dumps(attributes)))
    np.testing.assert_array_equal(again.wavelength_um, band.wavelength_um)
    np.testing.assert_array_equal(again.response, band.response)


def test_every_variable_says_what_it_is():
    for name, variable in VARIABLES.items():
        assert variable.name == name
        assert variable.long_name
        assert variable.units
