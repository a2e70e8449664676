"""Exported runs read back by other readers than those that wrote them."""

from __future__ import annotations

import json
import subprocess
import sys

import h5py
import numpy as np
import pytest
import tifffile
import xarray as xr
from PIL import Image

from seaglint.base.errors import BackendError, DataError
from seaglint.base.schema import VARIABLES
from seaglint.formats.export import file_formats
from seaglint.formats.export.stack import Counts, select
from seaglint.formats.recording import open_recording
from seaglint.optics.band import Band
from seaglint.plot.run_export import write_stack
from seaglint.store.layout import Layout
from seaglint.store.sequence_store import open_sequence, write_sequence

RATE = 30.0
AZIMUTH = np.linspace(100.0, 109.0, 10)
ELEVATION = np.linspace(0.0, -3.0, 4)
FRAMES = np.random.default_rng(7).gamma(2.0, 0.5, (5, 4, 10)).astype(np.float32)
FRAMES[1, 2, 3] = np.nan
EXTREMES = (0.0, 6.5)  # a range that holds all values
HALF = 0.5 * (1.0 + 1e-3)  # half a step of the counts, and the rounding of single precision


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Frames 3 to 7 of a sequence."""
    path = tmp_path_factory.mktemp("run") / "run.zarr"
    layout = Layout(
        AZIMUTH, ELEVATION, range(3, 8), RATE, Band.rectangular(3.5, 5.0), ("radiance", "glint_radiance"),
        {"scenario": '{"sea": {"temperature_k": 288.15}}', "seed": 4, "history": "written"},
    )  # fmt: skip
    write_sequence(path, layout, lambda n: {"radiance": FRAMES[n - 3], "glint_radiance": 0.5 * FRAMES[n - 3]})
    return open_sequence(path)


def parsed_fits(path):
    """Header cards and stored numbers of the first image, by the standard's own words: 80 characters a card, 2880 bytes a block."""
    content = path.read_bytes()
    assert len(content) % 2880 == 0
    cards, at = {}, 0
    last = ""
    while True:
        card = content[at : at + 80].decode("ascii")
        at += 80
        if card.startswith("END "):
            break
        value = card[9 if card.startswith("CONTINUE") else 10 :].strip()
        if value.startswith("'"):
            text = value[1:].replace("''", "\0").split("'")[0].replace("\0", "'").rstrip()
            if card.startswith("CONTINUE"):
                cards[last] = cards[last].removesuffix("&") + text
            else:
                last = card[:8].strip()
                cards[last] = text
        else:
            number = value.split("/")[0].strip()
            cards[card[:8].strip()] = {"T": True, "F": False}.get(number) or float(number or "nan")
    start = -(-at // 2880) * 2880
    kind = {16.0: ">i2", -32.0: ">f4", 8.0: "u1", 32.0: ">i4"}[cards["BITPIX"]]
    shape = tuple(int(cards[f"NAXIS{n}"]) for n in (3, 2, 1))
    stored = np.frombuffer(content, kind, int(np.prod(shape)), start).reshape(shape)
    return cards, stored


def tiff_text(path):
    """JSON of a TIFF: in ImageJ's Info, of BigTIFF the description."""
    with tifffile.TiffFile(path) as file:
        return json.loads(file.imagej_metadata["Info"] if file.is_imagej else file.pages[0].description)


def read_back(path):
    """Physical values and metadata by a reader that had no part in the writing."""
    if path.suffix == ".tif":
        pages = []
        with Image.open(path) as image:
            for n in range(image.n_frames):
                image.seek(n)
                pages.append(np.array(image))
        stored, about = np.stack(pages), tiff_text(path)
    elif path.suffix == ".npy":
        stored, about = np.load(path), json.loads(path.with_name(path.name + ".json").read_text())["metadata"]
    elif path.suffix == ".raw":
        table = json.loads(path.with_suffix(".json").read_text())
        kind = np.dtype(table["dtype"]).newbyteorder({"little": "<", "big": ">"}[table["byte_order"]])
        stored = np.fromfile(path, kind).reshape(-1, table["rows"], table["columns"])
        about = table["metadata"]
    elif path.suffix == ".fits":
        cards, numbers = parsed_fits(path)
        values = numbers * cards.get("BSCALE", 1.0) + cards.get("BZERO", 0.0)
        return np.where(numbers == cards["BLANK"], np.nan, values) if "BLANK" in cards else values, cards["BUNIT"]
    else:
        with h5py.File(path) as file:
            stored, attributes = file["radiance"][:], dict(file["radiance"].attrs)
        about = {name: np.ravel(value)[0] for name, value in attributes.items() if name in ("scale_factor", "add_offset", "_FillValue")}
        about["attributes"] = {"units": attributes["units"]}
        if "scale_factor" not in about:
            return stored, about["attributes"]["units"]
    if "scale_factor" not in about:
        return stored, about["attributes"]["units"]
    values = about["add_offset"] + about["scale_factor"] * stored.astype(np.float64)
    return np.where(stored == about["_FillValue"], np.nan, values), about["attributes"]["units"]


@pytest.mark.parametrize("ending", ["nc", "h5", "tif", "fits", "npy", "raw"])
def test_single_precision_comes_back_as_it_was(run, tmp_path, ending):
    told = write_stack(select(run), tmp_path / f"x.{ending}")
    found, units = read_back(tmp_path / f"x.{ending}")
    np.testing.assert_array_equal(found.astype(np.float32), FRAMES)
    assert (units, told.shape, told.dtype, told.scale_factor) == ("W m-2 sr-1", FRAMES.shape, "float32", None)
    assert {path.name for path in tmp_path.iterdir()} == {path.name for path in told.files}


@pytest.mark.parametrize("ending", ["nc", "h5", "tif", "fits", "npy", "raw"])
@pytest.mark.parametrize("limits", [None, EXTREMES], ids=["data", "given"])
def test_counts_come_back_within_half_a_step(run, tmp_path, ending, limits):
    told = write_stack(select(run), tmp_path / f"x.{ending}", dtype="uint16", limits=limits)
    low, high = limits or (np.nanmin(FRAMES), np.nanmax(FRAMES))
    step = (float(high) - float(low)) / 65534
    found, units = read_back(tmp_path / f"x.{ending}")
    np.testing.assert_array_equal(np.isnan(found), np.isnan(FRAMES))
    assert np.nanmax(np.abs(found - FRAMES)) <= HALF * step
    assert np.nanmax(np.abs(found - FRAMES)) > 0.3 * step  # counts, not the values themselves
    assert (units, told.dtype, told.cut) == ("W m-2 sr-1", "uint16", 0)
    assert told.scale_factor == pytest.approx(step, rel=1e-12)


def test_values_beyond_the_range_are_put_to_its_ends_and_told(run, tmp_path):
    told = write_stack(select(run), tmp_path / "x.npy", dtype="uint16", limits=(0.5, 1.0))
    found, _ = read_back(tmp_path / "x.npy")
    assert told.cut == np.count_nonzero((FRAMES < 0.5) | (FRAMES > 1.0))
    assert f"{told.cut} values" in told.line
    np.testing.assert_allclose(found, np.clip(FRAMES.astype(np.float64), 0.5, 1.0), atol=0.51 * 0.5 / 65534)


def test_constant_images_have_a_scale_too():
    counts = Counts.over(3.25, 3.25)
    assert counts.offset + counts.scale * counts.of(np.array([3.25]))[0] == 3.25


def test_infinite_values_are_beyond_any_range():
    counts = Counts.over(0.0, 1.0)
    values = np.array([np.inf, -np.inf, 0.5])
    assert counts.beyond(values) == 2
    assert counts.of(values).tolist()[:2] == [65535, 1]


def signals(dtype, frames=3):
    """A run of a sensor: counts."""
    values = np.random.default_rng(1).integers(0, np.iinfo(dtype).max, (frames, 4, 10), dtype=dtype, endpoint=True)
    values[0, 0, :2] = (0, np.iinfo(dtype).max)
    coordinates = {"time": ("time", np.arange(frames) / RATE, VARIABLES["time"].attributes)}
    attributes = {"units": "count", "gain": 12.5}
    return xr.Dataset(
        {"radiance": (("time", "y", "x"), np.ones((frames, 4, 10))), "signal": (("time", "y", "x"), values, attributes)}, coordinates
    )


@pytest.mark.parametrize("ending", ["tif", "fits", "npy", "raw", "nc"])
def test_counts_of_a_sensor_are_exported_first_and_unchanged(tmp_path, ending):
    from astropy.io import fits

    given = signals(np.uint16)
    told = write_stack(select(given), tmp_path / f"x.{ending}")
    assert (told.variable, told.dtype, told.units) == ("signal", "int32" if ending == "nc" else "uint16", "count")
    if ending == "fits":
        with fits.open(tmp_path / "x.fits") as file:
            found = file[0].data
    elif ending == "nc":
        with xr.open_dataset(tmp_path / "x.nc") as file:
            found = file["signal"].to_numpy()
            assert file["signal"].attrs["gain"] == 12.5
    else:
        found, _ = read_back(tmp_path / f"x.{ending}")
    np.testing.assert_array_equal(found, given["signal"])


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int16, np.int32, np.uint32])
def test_integers_of_any_kind_fit_into_fits(tmp_path, dtype):
    from astropy.io import fits

    given = signals(dtype)
    write_stack(select(given), tmp_path / "x.fits")
    np.testing.assert_array_equal(fits.getdata(tmp_path / "x.fits"), given["signal"])


def test_axes_of_fits(run, tmp_path):
    from astropy.wcs import WCS

    write_stack(select(run, frames=range(3, 8, 2)), tmp_path / "x.fits")
    cards, _ = parsed_fits(tmp_path / "x.fits")
    assert [cards[f"CTYPE{n}"] for n in (1, 2, 3)] == ["AZIMUTH", "ELEVATION", "TIME"]
    assert [cards[f"CDELT{n}"] for n in (1, 2, 3)] == pytest.approx([1.0, -1.0, 2.0 / RATE], rel=1e-9)
    assert cards["FRMRATE"] == pytest.approx(RATE / 2, rel=1e-9)
    about = json.loads(cards["METADATA"])
    assert about["provenance"]["scenario"] == '{"sea": {"temperature_k": 288.15}}'
    assert about["coordinates"]["frame"]["values"] == [3, 5, 7]
    from astropy.io import fits

    # Columns, rows and frames from 0: the last column of the third row of the second frame.
    place = WCS(fits.getheader(tmp_path / "x.fits")).pixel_to_world_values(9, 2, 1)
    assert [float(value) for value in place] == pytest.approx([109.0, -2.0, 5.0 / RATE], rel=1e-9)


def test_directions_of_single_pixels_and_dates(tmp_path):
    from datetime import UTC, datetime

    azimuth = AZIMUTH + np.linspace(0.0, 0.3, 4)[:, np.newaxis] ** 2
    elevation = np.repeat(ELEVATION[:, np.newaxis], 10, axis=1)
    begin = datetime(2024, 5, 1, 12, tzinfo=UTC)
    layout = Layout(azimuth, elevation, range(2, 4), 10.0, Band.rectangular(3.5, 5.0), start=begin)
    write_sequence(tmp_path / "run.zarr", layout, lambda n: {"radiance": FRAMES[n]})
    stack = select(open_sequence(tmp_path / "run.zarr"))
    for ending in ("fits", "nc", "tif"):
        write_stack(stack, tmp_path / f"x.{ending}")
    from astropy.io import fits

    with fits.open(tmp_path / "x.fits") as file:
        np.testing.assert_array_equal(file["AZIMUTH"].data, azimuth)
        np.testing.assert_array_equal(file["ELEVATION"].data, elevation)
        assert "CTYPE1" not in file[0].header
        assert file[0].header["DATE-OBS"] == "2024-05-01T12:00:00.200"
    with h5py.File(tmp_path / "x.nc") as file:
        np.testing.assert_array_equal(file["azimuth"][:], azimuth)
    assert "azimuth" not in tiff_text(tmp_path / "x.tif")["coordinates"]
    with tifffile.TiffFile(tmp_path / "x.tif") as file:
        assert file.imagej_metadata["unit"] == "pixel"


@pytest.mark.parametrize("dtype", [None, "uint16"])
def test_netcdf_is_the_run_for_xarray(run, tmp_path, dtype):
    write_stack(select(run, "glint_radiance", range(4, 7)), tmp_path / "x.nc", dtype=dtype)
    with xr.open_dataset(tmp_path / "x.nc", decode_times=False) as found:
        atol = 0.0 if dtype is None else HALF * 0.5 * float(np.nanmax(FRAMES)) / 65534
        np.testing.assert_allclose(found["glint_radiance"], 0.5 * FRAMES[1:4], rtol=0.0, atol=atol)
        np.testing.assert_array_equal(found["azimuth"], AZIMUTH)
        np.testing.assert_array_equal(found["frame"], [4, 5, 6])
        np.testing.assert_allclose(found["time"], np.array([4, 5, 6]) / RATE, rtol=1e-12)
        assert found["elevation"].attrs["units"] == "degree"
        assert found["wavelength_bounds"].to_numpy().tolist() == [3.5, 5.0]
        assert set(found.coords) == set(run.coords)
        assert found.attrs["seed"] == 4
        assert found.attrs["history"].startswith(f"{run.attrs['history']}\n")


def test_text_headers_hold_axes_units_times_and_geometry(run, tmp_path):
    write_stack(select(run), tmp_path / "x.raw")
    table = json.loads((tmp_path / "x.json").read_text())
    assert (table["rows"], table["columns"], table["dtype"], table["byte_order"], table["units"]) == (
        4,
        10,
        "float32",
        "little",
        "W m-2 sr-1",
    )
    about = table["metadata"]
    assert (about["axes"], about["shape"]) == (["time", "y", "x"], [5, 4, 10])
    assert about["coordinates"]["azimuth"] == {**VARIABLES["azimuth"].attributes, "dims": ["x"], "values": pytest.approx(AZIMUTH)}
    assert about["coordinates"]["time"]["values"] == pytest.approx(np.arange(3, 8) / RATE)


@pytest.mark.parametrize("ending", ["nc", "h5", "tif", "fits", "npy", "raw"])
def test_our_own_analysis_reads_what_is_exported(run, tmp_path, ending):
    write_stack(select(run, frames=range(3, 8, 2)), tmp_path / f"x.{ending}")
    opened = open_recording(tmp_path / f"x.{ending}")
    np.testing.assert_array_equal(opened.read(0, opened.frames), FRAMES[::2])
    if ending != "npy":
        assert (opened.frame_rate, opened.units) == (pytest.approx(RATE / 2), "W m-2 sr-1")


@pytest.mark.parametrize("ending", ["nc", "h5", "fits", "tif"])
def test_our_own_analysis_takes_the_scale_of_counts(run, tmp_path, ending):
    told = write_stack(select(run), tmp_path / f"x.{ending}", dtype="uint16", limits=EXTREMES)
    opened = open_recording(tmp_path / f"x.{ending}")
    np.testing.assert_allclose(opened.read(0, 5), FRAMES, rtol=0.0, atol=HALF * told.scale_factor)


@pytest.mark.parametrize("dtype", [None, "uint16"])
def test_imagej_finds_unit_interval_and_scale(run, tmp_path, dtype):
    told = write_stack(select(run), tmp_path / "x.tif", dtype=dtype)
    with tifffile.TiffFile(tmp_path / "x.tif") as file:
        assert file.is_imagej
        known, page = file.imagej_metadata, file.pages[0]
        assert (known["unit"], known["vunit"], known["frames"]) == ("deg", "W m-2 sr-1", 5)
        assert known["finterval"] == pytest.approx(1.0 / RATE)
        assert known["fps"] == pytest.approx(RATE)
        across, down = (page.tags[name].value for name in ("XResolution", "YResolution"))
        assert across[0] / across[1] == pytest.approx(1.0 / abs(AZIMUTH[1] - AZIMUTH[0]), rel=1e-6)
        assert down[0] / down[1] == pytest.approx(1.0 / abs(ELEVATION[1] - ELEVATION[0]), rel=1e-6)
        # ImageJ reads a stack as one run of bytes behind the first page's offset
        assert [p.dataoffsets[0] - page.dataoffsets[0] for p in file.pages] == [n * page.nbytes for n in range(5)]
        if dtype is None:
            assert "cf" not in known
        else:
            assert known["cf"] == 0
            assert (known["c0"], known["c1"]) == (pytest.approx(told.add_offset), pytest.approx(told.scale_factor))


def test_a_stack_that_imagej_calibrated_is_read_in_its_units(tmp_path):
    counts = np.arange(60, dtype=np.uint16).reshape(3, 4, 5)
    about = {"axes": "TYX", "finterval": 0.04, "vunit": "K", "cf": 0, "c0": 280.0, "c1": 0.5}
    tifffile.imwrite(tmp_path / "x.tif", counts, imagej=True, metadata=about)
    opened = open_recording(tmp_path / "x.tif")
    assert (opened.frame_rate, opened.units, opened.saturation) == (pytest.approx(25.0), "K", None)
    np.testing.assert_allclose(opened.read(0, 3), 280.0 + 0.5 * counts)


def test_large_stacks_are_bigtiff(run, tmp_path, monkeypatch):
    monkeypatch.setattr(file_formats, "_SMALL", 1000)
    write_stack(select(run), tmp_path / "x.tif")
    assert (tmp_path / "x.tif").read_bytes()[:4] == b"II+\x00"
    np.testing.assert_array_equal(read_back(tmp_path / "x.tif")[0], FRAMES)


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({"variable": "signal"}, "has no images 'signal'; it has glint_radiance, radiance"),
        ({"frames": range(0, 2)}, "holds frames 3:8"),
        ({"frames": range(7, 9)}, "holds frames 3:8"),
        ({"frames": range(7, 3, -1)}, "holds frames 3:8"),
    ],
)
def test_what_the_run_does_not_hold_is_refused(run, choice, message):
    with pytest.raises(DataError, match=message):
        select(run, **choice)


def test_a_map_is_no_run(run):
    with pytest.raises(DataError, match="expand_dims"):
        select(run.isel(time=0))


def test_an_unfinished_part_is_refused(run):
    gap = run.assign(frame_done=("time", np.array([1, 1, 0, 1, 1])))
    assert select(gap, frames=range(3, 5)).shape[0] == 2
    with pytest.raises(DataError, match="not rendered yet"):
        select(gap)


@pytest.mark.parametrize("limits", [(1.0, 1.0), (2.0, 1.0), (0.0, float("nan"))])
def test_ranges_that_are_none(run, tmp_path, limits):
    with pytest.raises(DataError, match="is no range"):
        write_stack(select(run), tmp_path / "x.npy", dtype="uint16", limits=limits)


@pytest.mark.parametrize(
    ("name", "module", "message"),
    [
        ("x.fits", "astropy.io.fits", "FITS needs astropy, which is not installed; pip install 'astropy>=6.1'"),
        ("x.tif", "tifffile", "TIFF needs tifffile, which is not installed; pip install 'tifffile>=2024.8'"),
    ],
)
def test_a_missing_library_is_named_before_the_work(run, tmp_path, monkeypatch, name, module, message):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(BackendError) as caught:
        write_stack(select(run), tmp_path / name)
    assert str(caught.value) == message


class Stopped(BaseException):
    """As Ctrl-C."""


@pytest.mark.parametrize("ending", ["nc", "tif", "fits", "npy", "raw"])
def test_what_stops_leaves_nothing_and_the_old_file_as_it_was(run, tmp_path, ending):
    output = tmp_path / f"x.{ending}"
    output.write_text("old")

    def stop(done, total):
        if done == 2:
            raise Stopped

    with pytest.raises(Stopped):
        write_stack(select(run), output, overwrite=True, progress=stop)
    assert [path.name for path in tmp_path.iterdir()] == [output.name]
    assert output.read_text() == "old"


def test_a_header_that_is_there_is_not_replaced(run, tmp_path):
    (tmp_path / "x.json").write_text("{}")
    with pytest.raises(DataError, match=r"x\.json: exists already"):
        write_stack(select(run), tmp_path / "x.raw")
    assert [path.name for path in tmp_path.iterdir()] == ["x.json"]


FULL = """
import resource, signal, sys, numpy as np, xarray as xr
from seaglint.base.errors import StorageError
from seaglint.formats.export.stack import select
from seaglint.plot.run_export import write_stack
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
sys.dont_write_bytecode = True  # Python would keep half of what it compiles, and fail at its next start
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
noise = np.random.default_rng(1).random((40, 64, 64), np.float32)
for ending in ("h5", "tif", "fits", "npy"):
    try:
        write_stack(select(xr.Dataset({"radiance": (("time", "y", "x"), noise)})), f"{sys.argv[1]}/x.{ending}")
    except StorageError as error:
        print(error)
"""


def test_a_full_disk_is_told_and_leaves_nothing(tmp_path):
    # Another process: HDF5 that was told of a failure ends it with a fault.
    done = subprocess.run([sys.executable, "-c", FULL, tmp_path], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert [line.split(":")[0].rsplit(".")[-1] for line in done.stdout.splitlines() if "no room left" in line] == [
        "h5",
        "tif",
        "fits",
        "npy",
    ]
    assert list(tmp_path.iterdir()) == []


class Lazy(xr.backends.BackendArray):
    """Frames made when they are asked for, as large as a store's."""

    def __init__(self, shape):
        self.shape, self.dtype = shape, np.dtype(np.float32)

    def __getitem__(self, key):
        return xr.core.indexing.explicit_indexing_adapter(key, self.shape, xr.core.indexing.IndexingSupport.BASIC, self._get)

    def _get(self, key):
        size = [len(range(*part.indices(n))) for part, n in zip(key, self.shape, strict=True) if isinstance(part, slice)]
        return np.full(size, float(key[0]) if isinstance(key[0], int | np.integer) else 0.0, np.float32)


@pytest.mark.parametrize("ending", ["nc", "tif", "fits", "npy"])
def test_memory_does_not_grow_with_the_run(tmp_path, ending):
    import tracemalloc

    shape = (60, 256, 512)  # 31 MB, a frame is 0.5 MB
    lazy = xr.Variable(("time", "y", "x"), xr.core.indexing.LazilyIndexedArray(Lazy(shape)))
    stack = select(xr.Dataset({"radiance": lazy}))
    write_stack(select(xr.Dataset({"radiance": lazy[:2]})), tmp_path / f"warm.{ending}")  # what is imported once
    tracemalloc.start()
    write_stack(stack, tmp_path / f"x.{ending}")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10 * shape[1] * shape[2] * 4
    assert open_recording(tmp_path / f"x.{ending}").read(59, 60).mean() == 59.0
