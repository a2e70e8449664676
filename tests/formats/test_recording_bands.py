"""Channels, times and ends of recordings: what one file says of several is not taken for something else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.formats.recording import open_recording

RNG = np.random.default_rng(11)
FRAMES = RNG.gamma(9.0, 30.0, (12, 32, 40)).astype(np.uint16)


def values(path: Path, **how: Any) -> np.ndarray:
    recording = open_recording(path, **how)
    return recording.read(0, recording.frames).astype(np.float64) + recording.offset


@pytest.mark.parametrize("bands", [2, 3, 4])
@pytest.mark.parametrize("last", [True, False])
def test_bands_are_never_averaged(bands: int, last: bool, tmp_path: Path) -> None:
    """Kelvin of several bands differ by little of full scale, and are no colours of a grey picture."""
    stack = [289.0 + i + RNG.normal(0.0, 0.2, FRAMES.shape).astype(np.float32) for i in range(bands)]
    np.save(tmp_path / "a.npy", np.stack(stack, axis=-1 if last else 1))
    with pytest.raises(DataError, match=f"has {bands} channels.* give channel = 1 to {bands}"):
        open_recording(tmp_path / "a.npy")
    np.testing.assert_allclose(values(tmp_path / "a.npy", channel=str(bands)), stack[-1], rtol=1e-6)


def test_bands_by_name_are_refused_and_colours_by_name_are_averaged_with_a_note(tmp_path: Path) -> None:
    import xarray as xr

    grey = FRAMES.astype(np.float32)
    for name, differs in (("band", True), ("rgb", False)):
        colours = np.stack([grey, grey + 0.01, grey], axis=1)
        xr.Dataset({"a": (("time", name, "y", "x"), colours)}).to_netcdf(tmp_path / f"{name}.nc", engine="h5netcdf")
        if differs:
            with pytest.raises(DataError, match="has 3 channels that differ"):
                open_recording(tmp_path / f"{name}.nc")
        else:
            assert "nearly equal colour channels, averaged" in open_recording(tmp_path / f"{name}.nc").notes
            np.testing.assert_allclose(values(tmp_path / f"{name}.nc"), grey, atol=0.01)


def test_colours_that_do_not_vary_together_are_no_grey(tmp_path: Path) -> None:
    import tifffile

    colours = RNG.gamma(9.0, 30.0, (32, 40, 3)).astype(np.uint16)  # within 2 % of 65535
    tifffile.imwrite(tmp_path / "a.tif", colours, photometric="rgb")
    with pytest.raises(DataError, match=r"true colour.*more than a tenth of what the picture varies"):
        open_recording(tmp_path / "a.tif")
    np.testing.assert_array_equal(values(tmp_path / "a.tif", channel="2")[0], colours[..., 1])


def test_times_of_something_else_are_no_frame_rate(tmp_path: Path) -> None:
    import xarray as xr

    images = (("frame", "y", "x"), FRAMES, {"frame_rate": 25.0})
    weather = ("time", np.linspace(285.0, 286.0, 600))
    times = ("time", np.arange(600.0), {"units": "s"})
    xr.Dataset({"images": images, "air": weather}, coords={"time": times}).to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    assert open_recording(tmp_path / "a.nc").frame_rate == 25.0


@pytest.mark.parametrize(
    ("times", "about", "rate"),
    [
        (np.arange(12) * 40.0, {"units": "ms"}, 25.0),
        (np.arange(12), {"units": "s", "scale_factor": 0.04}, 25.0),
        (np.round(np.arange(12) * 1000.0 / 30.0), {"units": "milliseconds since 2024-01-01"}, pytest.approx(30.0, rel=2e-3)),
        (np.arange(12) * 0.5, {"units": "minutes"}, 1.0 / 30.0),
        (np.cumsum(RNG.uniform(0.01, 0.1, 12)), {"units": "s"}, None),
        (np.arange(12) * 0.5, {"units": "fortnights"}, None),
    ],
)
@pytest.mark.parametrize("group", [False, True])
def test_times_in_their_units(times: np.ndarray, about: dict[str, Any], rate: Any, group: bool, tmp_path: Path) -> None:
    """In the root, and in a group, where the scale of a dimension has them."""
    import xarray as xr

    dataset = xr.Dataset({"a": (("time", "y", "x"), FRAMES)}, coords={"time": ("time", times, about)})
    dataset.to_netcdf(tmp_path / "a.nc", engine="h5netcdf", group="camera" if group else None)
    recording = open_recording(tmp_path / "a.nc")
    assert recording.frame_rate == (rate if rate is None else pytest.approx(rate) if isinstance(rate, float) else rate)
    assert (rate is None) == any("--frame-rate" in note for note in recording.notes)


@pytest.mark.parametrize(("unit", "step", "rate"), [("ms", 40.0, 25.0), ("sec", 0.04, 25.0), ("min", 2.0, 1.0 / 120.0)])
def test_imagejs_unit_of_time(unit: str, step: float, rate: float, tmp_path: Path) -> None:
    import tifffile

    tifffile.imwrite(tmp_path / "a.tif", FRAMES, imagej=True, metadata={"axes": "TYX", "finterval": step, "tunit": unit})
    assert open_recording(tmp_path / "a.tif").frame_rate == pytest.approx(rate)


@pytest.mark.parametrize(
    ("cards", "rate"), [({"TIMEUNIT": "ms"}, 25.0), ({"CUNIT3": "ms"}, 25.0), ({}, 0.025), ({"CUNIT3": "yonks"}, None)]
)
def test_fits_unit_of_time(cards: dict[str, str], rate: float | None, tmp_path: Path) -> None:
    fits = pytest.importorskip("astropy.io.fits", reason="astropy, which reads FITS, is not installed")
    header = fits.Header({"CTYPE3": "TIME", "CDELT3": 40.0, **cards})
    fits.PrimaryHDU(FRAMES.astype(np.int16), header=header).writeto(tmp_path / "a.fits")
    assert open_recording(tmp_path / "a.fits").frame_rate == (None if rate is None else pytest.approx(rate))


@pytest.mark.parametrize("form", ["imagej", "ome", "shaped", "pages", "one page"])
def test_a_stack_that_is_cut_is_refused(form: str, tmp_path: Path) -> None:
    import tifffile

    path = tmp_path / "a.tif"
    if form == "pages":
        with tifffile.TiffWriter(path) as file:
            for frame in FRAMES:
                file.write(frame, contiguous=False)
    elif form == "one page":
        tifffile.imwrite(path, FRAMES, imagej=True, truncate=True, metadata={"axes": "TYX"})
    else:
        tifffile.imwrite(path, FRAMES, imagej=form == "imagej", ome=form == "ome", metadata={"axes": "TYX"}, photometric="minisblack")
    np.testing.assert_array_equal(values(path), FRAMES)
    path.write_bytes(path.read_bytes()[: int(0.6 * path.stat().st_size)])
    with pytest.raises(DataError, match="cut"):
        values(path)


def test_a_band_without_a_scale_has_none(tmp_path: Path) -> None:
    import tifffile

    text = (
        '<GDALMetadata><Item name="OFFSET" sample="0" role="offset">-273.15</Item><Item name="SCALE" sample="0" role="scale">0.01</Item>'
        '<Item name="UNITTYPE" sample="0" role="unittype">degC</Item></GDALMetadata>'
    )
    tifffile.imwrite(
        tmp_path / "a.tif", FRAMES[:3], photometric="minisblack", planarconfig="separate", extratags=[(42112, "s", 0, text, True)]
    )
    np.testing.assert_allclose(values(tmp_path / "a.tif", channel="1")[0], 0.01 * FRAMES[0] - 273.15, rtol=1e-5)
    second = open_recording(tmp_path / "a.tif", channel="2")
    np.testing.assert_array_equal(second.read(0, 1)[0], FRAMES[1])
    assert second.units is None


@pytest.mark.parametrize(("dtype", "level"), [(np.float64, 1e9), (np.uint32, 3e9)])
def test_a_tiff_of_a_high_level_keeps_its_spread(dtype: type, level: float, tmp_path: Path) -> None:
    import tifffile

    tifffile.imwrite(tmp_path / "a.tif", FRAMES.astype(dtype) + dtype(level), photometric="minisblack")
    np.testing.assert_array_equal(values(tmp_path / "a.tif"), FRAMES + level)


def test_what_netcdf_writes_where_nothing_was_written_is_noted(tmp_path: Path) -> None:
    import xarray as xr

    counts = FRAMES.astype(np.int16)
    counts[:, :3, :3] = -32767
    xr.Dataset({"a": (("time", "y", "x"), counts)}).to_netcdf(tmp_path / "a.nc", engine="scipy")
    assert any("-32767 occurs" in note for note in open_recording(tmp_path / "a.nc").notes)
    assert np.isnan(values(tmp_path / "a.nc", missing=[-32767.0])).sum() == 12 * 9


def test_units_of_a_scale_that_is_not_applied_do_not_hold(tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("a", data=FRAMES).attrs.update({"slope": 0.04, "intercept": -273.15, "units": "degC"})
    recording = open_recording(tmp_path / "a.h5")
    assert recording.units is None
    assert sum("no CF name and is not applied" in note for note in recording.notes) == 2


def test_a_folder_in_order_whatever_the_spelling(tmp_path: Path) -> None:
    import tifffile

    for i, frame in enumerate(FRAMES):
        tifffile.imwrite(tmp_path / f"{'im' if i % 3 else 'IM'}{i}.{'tif' if i % 2 else 'TIFF'}", frame)
    np.testing.assert_array_equal(values(tmp_path), FRAMES)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_images_of_a_group_are_reached_by_name(ending: str, tmp_path: Path) -> None:
    """Beside others in the root, which are read where nothing is requested."""
    import xarray as xr

    path = tmp_path / f"a.{ending}"
    for group, frames in ((None, FRAMES), ("camera", FRAMES[::-1])):
        dataset = xr.Dataset({"a": (("time", "y", "x"), frames)})
        if ending == "nc":
            dataset.to_netcdf(path, engine="h5netcdf", group=group, mode="a" if group else "w")
        else:
            dataset.to_zarr(path, group=group, mode="a", consolidated=False)
    np.testing.assert_array_equal(values(path), FRAMES)
    np.testing.assert_array_equal(values(path, variable="camera/a"), FRAMES[::-1])
    with pytest.raises(DataError, match=r"has no image variable 'b'; it has .*camera/a"):
        open_recording(path, variable="b")


@pytest.mark.parametrize("ending", ["png", "gif", "bmp", "pgm", "jpg"])
def test_another_format_under_the_ending_of_a_picture_is_refused(ending: str, tmp_path: Path) -> None:
    """Pillow opens FITS and TIFF too, without the tags that change their numbers."""
    import tifffile

    fits = pytest.importorskip("astropy.io.fits", reason="astropy, which reads FITS, is not installed")
    fits.PrimaryHDU(FRAMES).writeto(tmp_path / "a.fits")
    tifffile.imwrite(tmp_path / "b.tif", FRAMES, imagej=True)
    for name, says in (("a.fits", "FITS"), ("b.tif", "TIFF")):
        path = (tmp_path / name).rename(tmp_path / f"{name[0]}.{ending}")
        with pytest.raises(DataError, match=f"holds {says} .*give it the ending of its format"):
            open_recording(path)


def test_text_under_the_ending_of_fits_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.fits").write_text("a log of the camera\n")
    with pytest.raises(DataError, match="is no FITS file"):
        open_recording(tmp_path / "a.fits")


def test_names_of_channels_are_shown(tmp_path: Path) -> None:
    import xarray as xr

    bands = xr.Dataset({"a": (("time", "band", "y", "x"), np.stack([FRAMES, FRAMES[::-1]], 1))}, coords={"band": ["mwir", "lwir"]})
    bands.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    with pytest.raises(DataError, match=r"has 2 channels \(mwir, lwir\)"):
        open_recording(tmp_path / "a.nc")
    assert "channel 2 of 2 (lwir)" in open_recording(tmp_path / "a.nc", channel="2").notes


def test_pixels_of_few_values_are_not_dead() -> None:
    from seaglint.analysis.recording import Recording, survey

    frames = FRAMES.astype(np.float32)
    frames[1:, 3, 4] = np.nan
    notes = survey(Recording("memory", *frames.shape, lambda a, b: frames[a:b]), lambda done: None).notes
    assert not any("never change" in note for note in notes)
