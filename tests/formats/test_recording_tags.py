"""Recordings as other programs write them: the kinds that were once misread, each with its truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from seaglint.analysis.recording import Recording, survey
from seaglint.base.errors import DataError
from seaglint.formats.recording import open_recording

FRAMES = np.random.default_rng(7).gamma(9.0, 30.0, (4, 64, 96))


def values(recording: Recording) -> np.ndarray:
    return recording.read(0, recording.frames).astype(np.float64) + recording.offset


def notes_of(recording: Recording) -> str:
    return " | ".join((*recording.notes, *survey(recording, lambda done: None).notes))


TRUTH: dict[str, dict[str, Any]] = {
    "anim.gif": {"size": (12, 64, 96), "rate": 25.0},
    "anim.png": {"size": (12, 64, 96), "rate": 25.0},
    "cube.fits.gz": {"size": (12, 64, 96)},
    "cube4.fits": {"size": (12, 64, 96)},
    "fillmoving.h5": {"size": (4, 64, 96), "mean": 269.8, "std": 89.1, "says": "-9999 are missing"},
    "floatblank.fits": {"size": (4, 64, 96), "mean": 77.64, "says": "integers only"},
    "framerate.tif": {"size": (12, 64, 96), "rate": 30.0},
    "gdalscale.tif": {"size": (1, 64, 96), "mean": 9.60, "units": "degC"},
    "ir.fits.fz": {"size": (1, 64, 96)},
    "lzw.tif": {"size": (1, 64, 96), "mean": 268.66},
    "maskpage.tif": {"size": (1, 64, 96), "mean": 268.66, "says": "1 page with a mask"},
    "matlab5.mat": {"size": (4, 64, 96)},
    "matlab73.mat": {"size": (4, 64, 96)},
    "miniswhite8.tif": {"size": (1, 64, 96), "skewness": 0.706, "says": "white is zero"},
    "nodata.tif": {"size": (1, 64, 96), "mean": 269.05, "std": 90.03},
    "overview.tif": {"size": (1, 64, 96), "mean": 268.66, "says": "2 pages with a reduced version"},
    "repeat.fits": {"size": (1, 64, 96), "mean": 268.66, "says": "SCI,1 is read"},
    "still.npy": {"size": (20, 96, 64)},
    "thumbfirst.tif": {"size": (1, 64, 96), "mean": 268.66, "says": "1 page with a reduced version"},
}


@pytest.mark.parametrize("name", TRUTH)
def test_files_that_were_misread(name: str, data_dir: Path) -> None:
    truth = TRUTH[name]
    recording = open_recording(data_dir / "recordings" / name)
    assert (recording.frames, recording.rows, recording.columns) == truth["size"]
    found = values(recording)
    found = found[np.isfinite(found)]
    deviations = (found - found.mean()) / found.std()
    for what, measured in (("mean", found.mean()), ("std", found.std()), ("skewness", np.mean(deviations**3))):
        if what in truth:
            assert measured == pytest.approx(truth[what], rel=8e-4)
    if "rate" in truth:
        assert recording.frame_rate == pytest.approx(truth["rate"])
    assert recording.units == truth.get("units")
    said = notes_of(recording)
    assert truth.get("says", "") in said
    assert "repeat the one before" not in said
    assert "rows left out" not in said


def test_exposures_of_one_name(data_dir: Path) -> None:
    """Each is its own; the frames of all of them are the exposures in order."""
    fits = pytest.importorskip("astropy.io.fits", reason="astropy, which reads FITS, is not installed")
    path = data_dir / "recordings" / "repeat.fits"
    with fits.open(path) as file:
        exposures = [hdu.data.astype(np.float64) for hdu in file[1:]]
    for i, exposure in enumerate(exposures, 1):
        for name in (f"SCI,{i}", str(i), f"sci,{i}"):
            np.testing.assert_array_equal(values(open_recording(path, variable=name))[0], exposure)
    np.testing.assert_array_equal(values(open_recording(path, variable="SCI,*")), exposures)
    for name in (None, "SCI"):
        np.testing.assert_array_equal(values(open_recording(path, variable=name)), exposures[:1])


def test_matlab_of_two_versions_is_one_array(data_dir: Path) -> None:
    """Clutter that is correlated along rows stays so; the axes of version 7.3 are reversed in the file."""
    old, new = (values(open_recording(data_dir / "recordings" / name)) for name in ("matlab5.mat", "matlab73.mat"))
    np.testing.assert_array_equal(old, new)
    steps = [float(np.mean(np.diff(old, axis=axis) ** 2) / (2.0 * old.var())) for axis in (1, 2)]
    assert steps[1] < 0.1 < steps[0]


def test_channels_are_no_times(data_dir: Path) -> None:
    path = data_dir / "recordings" / "hyper.tif"
    with pytest.raises(DataError, match="has 2 channels; give channel = 1 to 2"):
        open_recording(path)
    first, second = (open_recording(path, channel=number) for number in ("1", "2"))
    assert (first.frames, first.frame_rate, second.frames) == (6, pytest.approx(25.0), 6)
    assert values(second).mean() > 2.0 * values(first).mean()
    with pytest.raises(DataError, match="channel = 3 is none of them"):
        open_recording(path, channel="3")


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("version", [2, 3])
def test_a_fill_value_that_is_data(version: int, named: bool, tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr")
    counts = np.where(FRAMES < 200.0, 0.0, FRAMES).astype(np.uint16)
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w", zarr_format=version)
    names = {"dimension_names": ("time", "y", "x")} if named and version == 3 else {}
    array = group.create_array("counts", shape=counts.shape, chunks=(1, 64, 96), dtype=counts.dtype, fill_value=0, **names)
    array[...] = counts
    if named and version == 2:
        array.attrs["_ARRAY_DIMENSIONS"] = ["time", "y", "x"]
    recording = open_recording(tmp_path / "a.zarr")
    np.testing.assert_array_equal(values(recording), counts)
    assert ("fill value 0 also occurs as data" in notes_of(recording)) == (version == 2)
    masked = open_recording(tmp_path / "a.zarr", missing=[0.0])
    assert np.isnan(values(masked)).mean() == pytest.approx(np.mean(counts == 0))
    assert "also occurs as data" not in notes_of(masked)


def test_chunks_that_are_not_there_are_counted(tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr")
    array = zarr.create_array(store=str(tmp_path / "a.zarr"), shape=FRAMES.shape, chunks=(1, 64, 96), dtype="f4", fill_value=5.0)
    array[:3] = FRAMES[:3]
    recording = open_recording(tmp_path / "a.zarr")
    assert values(recording)[3].mean() == 5.0
    assert "1 of 4 chunks are not there: their values are the fill value 5" in notes_of(recording)


def test_a_missing_value_that_xarray_wrote_among_packed_numbers(tmp_path: Path) -> None:
    """Version 2 has it as the store's fill value alone."""
    import xarray as xr

    frames = FRAMES.copy()
    frames[:, :3, :4] = np.nan
    encoding = {"frames": {"dtype": "int16", "scale_factor": 0.1, "_FillValue": -32768}}
    xr.Dataset({"frames": (("time", "y", "x"), frames)}).to_zarr(tmp_path / "a.zarr", zarr_format=2, encoding=encoding, consolidated=False)
    found = values(open_recording(tmp_path / "a.zarr"))
    np.testing.assert_allclose(found, frames, atol=0.051)


@pytest.mark.parametrize("kind", ["every second", "one run", "none", "gaps"])
def test_repeated_frames_are_compared_whole(kind: str) -> None:
    frames = np.random.default_rng(3).normal(100.0, 1.0, (24, 40, 30)).astype(np.float32)
    if kind == "every second":
        frames = np.repeat(frames[:12], 2, axis=0)
    if kind == "one run":
        frames[5:9] = frames[5]
    if kind == "gaps":
        frames[:, 3, 4] = np.nan
        frames[7] = frames[6]
    if kind == "none":  # a still scene with a spot that moves between the rows that are looked at first
        frames[:] = frames[0]
        for i in range(24):
            frames[i, 5 * (i % 7) + 1, i] += 50.0
    said = notes_of(Recording("memory", *frames.shape, lambda a, b: frames[a:b], frame_rate=25.0, units="K"))
    expected = {
        "every second": "12 frames repeat the one before in all pixels (50 % of 24), in 12 runs of at most 1",
        "one run": "3 frames repeat the one before in all pixels (12.5 % of 24), in one run from frame 6 on",
        "gaps": "1 frames repeat the one before in all pixels (4.17 % of 24)",
    }
    assert expected.get(kind, "never change") in said
    assert ("repeat the one before" in said) == (kind != "none")


def test_rows_with_a_gap_are_no_dead_rows() -> None:
    frames = FRAMES.astype(np.float32)
    frames[np.random.default_rng(1).random(frames.shape) < 0.02] = np.nan
    assert "rows left out" not in notes_of(Recording("memory", *frames.shape, lambda a, b: frames[a:b]))
    frames[:, 10] = np.nan
    frames[:, 10, ::2] = 5.0
    assert "1 rows left out (10)" in notes_of(Recording("memory", *frames.shape, lambda a, b: frames[a:b]))


def contradicting_h5(folder: Path) -> Path:
    import h5py

    with h5py.File(folder / "a.h5", "w") as file:
        dataset = file.create_dataset("a", data=FRAMES.astype(np.int16))
        dataset.attrs.update({"scale_factor": 0.1, "slope": 0.2})
    return folder / "a.h5"


def contradicting_tiff(folder: Path) -> Path:
    import tifffile

    text = '<GDALMetadata><Item name="SCALE" sample="0" role="scale">0.04</Item></GDALMetadata>'
    line = {"Info": "", "axes": "TYX", "cf": 0, "c0": 5.0, "c1": 0.5}
    tifffile.imwrite(folder / "a.tif", FRAMES.astype(np.uint16), imagej=True, metadata=line, extratags=[(42112, "s", 0, text, True)])
    return folder / "a.tif"


def exposures_of_two_shapes(folder: Path) -> Path:
    fits = pytest.importorskip("astropy.io.fits", reason="astropy, which reads FITS, is not installed")
    images = [fits.ImageHDU(data, name="SCI", ver=i + 1) for i, data in enumerate((FRAMES[0], FRAMES[1][:9]))]
    fits.HDUList([fits.PrimaryHDU(), *images]).writeto(folder / "a.fits")
    return folder / "a.fits"


def pages_of_two_sizes(folder: Path) -> Path:
    import tifffile

    with tifffile.TiffWriter(folder / "a.tif") as file:
        file.write(FRAMES[0].astype(np.uint16), contiguous=False)
        file.write(FRAMES[1, :9].astype(np.uint16), contiguous=False)
    return folder / "a.tif"


def indices_of_a_palette(folder: Path) -> Path:
    import h5py

    with h5py.File(folder / "a.h5", "w") as file:
        dataset = file.create_dataset("a", data=FRAMES.astype(np.uint8))
        dataset.attrs.update({"CLASS": np.bytes_("IMAGE"), "IMAGE_SUBCLASS": np.bytes_("IMAGE_INDEXED")})
    return folder / "a.h5"


def two_pictures_in_one_pgm(folder: Path) -> Path:
    (folder / "a.pgm").write_bytes(2 * (b"P5\n4 4\n255\n" + bytes(range(16))))
    return folder / "a.pgm"


def a_curve_of_imagej(folder: Path) -> Path:
    import tifffile

    line = {"Info": "", "axes": "TYX", "cf": 4, "c0": 5.0, "c1": 0.5}
    tifffile.imwrite(folder / "a.tif", FRAMES.astype(np.uint16), imagej=True, metadata=line)
    return folder / "a.tif"


def a_scale_that_is_a_word(folder: Path) -> Path:
    import h5py

    with h5py.File(folder / "a.h5", "w") as file:
        file.create_dataset("a", data=FRAMES.astype(np.int16)).attrs["scale_factor"] = "small"
    return folder / "a.h5"


def a_thermal_cameras_own(folder: Path) -> Path:
    (folder / "a.seq").write_bytes(b"FFF\0")
    return folder / "a.seq"


@pytest.mark.parametrize(
    ("make", "how", "says"),
    [
        (contradicting_h5, {}, "scale_factor = 0.1 and slope = 0.2 contradict each other"),
        (contradicting_tiff, {}, "scale and offset stand in two places that contradict each other"),
        (exposures_of_two_shapes, {"variable": "SCI,*"}, "is 9 x 96, .* is 64 x 96"),
        (pages_of_two_sizes, {}, "pages of several sizes"),
        (indices_of_a_palette, {}, "indices of a palette"),
        (two_pictures_in_one_pgm, {}, "2 pictures in one file"),
        (a_curve_of_imagej, {}, "no straight line"),
        (a_scale_that_is_a_word, {}, "scale_factor = 'small' is no number"),
        (a_thermal_cameras_own, {}, "export it as TIFF or FITS"),
    ],
)
def test_what_cannot_be_honoured_is_refused_in_one_line(make: Any, how: dict[str, Any], says: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=says) as caught:
        values(open_recording(make(tmp_path), **how))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("ending", ["fits", "npy"])
def test_a_folder_of_arrays_in_order(ending: str, tmp_path: Path) -> None:
    for i, frame in enumerate(FRAMES):
        path = tmp_path / f"exposure{8 + i}.{ending}"
        if ending == "npy":
            np.save(path, frame.astype(np.float32))
        else:
            pytest.importorskip("astropy.io.fits", reason="astropy, which reads FITS, is not installed").PrimaryHDU(
                frame.astype(np.float32)
            ).writeto(path)
    for given in (tmp_path, tmp_path / f"*.{ending}"):
        recording = open_recording(given)
        np.testing.assert_array_equal(values(recording), FRAMES.astype(np.float32))
        np.testing.assert_array_equal(recording.read(1, 3), FRAMES[1:3].astype(np.float32))


def test_rounding_of_compressed_floats_is_noted(tmp_path: Path) -> None:
    fits = pytest.importorskip("astropy.io.fits", reason="astropy, which reads FITS, is not installed")
    floats = FRAMES[0].astype(np.float32)
    for level, rounded in ((16.0, True), (0.0, False)):
        path = tmp_path / f"a{level:g}.fits.fz"
        kind = {"compression_type": "GZIP_1", "quantize_level": level}
        fits.HDUList([fits.PrimaryHDU(), fits.CompImageHDU(floats, **kind)]).writeto(path)
        recording = open_recording(path)
        assert ("rounded when the file was compressed" in notes_of(recording)) == rounded
        np.testing.assert_allclose(values(recording)[0], floats, atol=10.0 if rounded else 0.0)


def test_a_scale_of_the_file_that_differs_from_the_arrays_is_refused(tmp_path: Path) -> None:
    import h5py

    for number, (theirs, says) in enumerate([(0.5, "two places that contradict"), (0.1, "")]):
        path = tmp_path / f"{number}.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("a", data=FRAMES.astype(np.int16)).attrs["scale_factor"] = 0.1
            file.attrs["scale_factor"] = theirs
        if says:
            with pytest.raises(DataError, match=says):
                open_recording(path)
        else:
            np.testing.assert_allclose(values(open_recording(path)), 0.1 * FRAMES.astype(np.int16), rtol=1e-6)


def test_planes_of_a_true_colour_picture_are_no_frames(tmp_path: Path) -> None:
    import h5py

    grey = FRAMES[0].astype(np.uint8)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        dataset = file.create_dataset("a", data=np.stack([grey] * 3))
        about = {"CLASS": "IMAGE", "IMAGE_SUBCLASS": "IMAGE_TRUECOLOR", "INTERLACE_MODE": "INTERLACE_PLANE"}
        dataset.attrs.update({name: np.bytes_(value) for name, value in about.items()})
    np.testing.assert_array_equal(values(open_recording(tmp_path / "a.h5")), grey[None])


@pytest.mark.parametrize("orientation", range(1, 9))
def test_the_first_pixel_of_a_turned_picture(orientation: int, tmp_path: Path) -> None:
    """TIFF 6.0, p. 36: where row 0 and column 0 of the stored pixels lie in the picture."""
    import tifffile

    picture = np.zeros((5, 7), np.uint8)
    picture[0, 0], picture[0, 1] = 200, 100  # the second pixel of the first stored row
    tifffile.imwrite(tmp_path / "a.tif", picture, extratags=[(274, 3, 1, orientation, True)], metadata=None)
    found = values(open_recording(tmp_path / "a.tif"))[0]
    first = {1: (0, 0), 2: (0, 6), 3: (4, 6), 4: (4, 0), 5: (0, 0), 6: (0, 4), 7: (6, 4), 8: (6, 0)}
    second = {1: (0, 1), 2: (0, 5), 3: (4, 5), 4: (4, 1), 5: (1, 0), 6: (1, 4), 7: (5, 4), 8: (5, 0)}
    assert found.shape == ((7, 5) if orientation >= 5 else (5, 7))
    assert (found[first[orientation]], found[second[orientation]]) == (200.0, 100.0)
