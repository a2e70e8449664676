"""Saturated counts of 16 bits in files of other programs: no reader takes them for missing."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
import xarray as xr

from seaglint.formats.export.stack import select
from seaglint.optics.band import Band
from seaglint.plot.run_export import write_stack
from seaglint.store.layout import Layout
from seaglint.store.netcdf import write_netcdf
from seaglint.store.sequence_store import open_sequence, write_sequence

FULL = 65535
BITS = [12, 14, 16]


def counts(bits: int) -> np.ndarray:
    """Every frame with saturated pixels, and with zeros."""
    rng = np.random.default_rng(bits)
    values = rng.integers(0, 1 << bits, (3, 6, 8)).astype(np.uint16)
    values[:, 2, rng.integers(0, 8)] = (1 << bits) - 1
    values[:, 4, rng.integers(0, 8)] = 0
    return values


@pytest.fixture(params=BITS)
def run(request, tmp_path):
    """A finished sequence of a detector, and its counts."""
    values = counts(request.param)
    layout = Layout(
        azimuth_deg=np.linspace(178.0, 182.0, 8),
        elevation_deg=np.linspace(1.0, -2.0, 6),
        frames=range(3),
        frame_rate=30.0,
        band=Band.rectangular(3.5, 5.0),
        variables=("signal",),
        details={"signal": {"saturation_counts": float((1 << request.param) - 1)}},
        attributes={"seed": 1},
    )
    write_sequence(tmp_path / "run.zarr", layout, lambda number: {"signal": values[number]})
    return tmp_path / "run.zarr", values


def written(run, folder):
    """Files of the counts: exported, and as a dataset."""
    path, values = run
    with open_sequence(path) as dataset:
        write_stack(select(dataset), folder / "exported.nc")
    write_netcdf(xr.Dataset({"signal": (("time", "y", "x"), values), "first": ("x", values[0, 2])}), folder / "dataset.nc")
    return (folder / "exported.nc", folder / "dataset.nc"), values


def test_netcdf4_masks_no_saturated_pixel(run, tmp_path):
    netcdf4 = pytest.importorskip("netCDF4", reason="netCDF4 is not installed: its default mask is checked where it is")
    files, values = written(run, tmp_path)
    for path in files:
        with netcdf4.Dataset(path) as dataset:
            for name in {"signal", "first"} & set(dataset.variables):
                read = dataset[name][:]
                assert np.ma.count_masked(read) == 0
                np.testing.assert_array_equal(np.asarray(read), values if name == "signal" else values[0, 2])


def test_files_hold_no_number_that_netcdf_takes_for_missing(run, tmp_path):
    """NetCDF's default fill values, by type, from its manual."""
    fills = {"uint16": 65535, "int32": -2147483647}
    for path in written(run, tmp_path)[0]:
        with h5py.File(path) as file:
            signal = file["signal"]
            assert "_FillValue" not in signal.attrs
            assert not (signal[:] == fills[signal.dtype.name]).any()


def test_xarray_reads_whole_numbers(run, tmp_path):
    files, values = written(run, tmp_path)
    for path in files:
        with xr.open_dataset(path) as dataset:
            assert dataset["signal"].dtype.kind in "iu"
            np.testing.assert_array_equal(dataset["signal"], values)
            if values.max() < FULL:
                assert dataset["signal"].dtype == np.uint16
    with xr.open_zarr(run[0], consolidated=False) as dataset:
        assert dataset["signal"].dtype == np.uint16
        np.testing.assert_array_equal(dataset["signal"], values)
