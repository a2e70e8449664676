"""Every format gives back the numbers that were written, and what is wrong with a file is said in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.formats.recording import RawLayout, open_recording

FRAMES, ROWS, COLUMNS = 12, 6, 9
COUNTS = np.random.default_rng(4).integers(0, 4000, (FRAMES, ROWS, COLUMNS)).astype(np.uint16)
BYTES = (COUNTS >> 4).astype(np.uint8)
FLOATS = (COUNTS / 100.0).astype(np.float32)


def save_npy(folder: Path) -> tuple[Path, np.ndarray]:
    np.save(folder / "clip.npy", FLOATS)
    return folder / "clip.npy", FLOATS


def save_npz(folder: Path) -> tuple[Path, np.ndarray]:
    np.savez(folder / "clip.npz", clip=COUNTS)
    return folder / "clip.npz", COUNTS


def save_png8(folder: Path) -> tuple[Path, np.ndarray]:
    return save_png(folder, BYTES), BYTES


def save_png16(folder: Path) -> tuple[Path, np.ndarray]:
    return save_png(folder, COUNTS), COUNTS


def save_png(folder: Path, frames: np.ndarray) -> Path:
    from PIL import Image

    for i, frame in enumerate(frames):  # not padded: frame 10 follows frame 9 only in natural order
        Image.fromarray(frame).save(folder / f"frame{i}.png")
    return folder


def save_png_rgba(folder: Path) -> tuple[Path, np.ndarray]:
    from PIL import Image

    for i, frame in enumerate(BYTES):
        Image.fromarray(np.dstack([frame] * 3 + [np.full_like(frame, 255)])).save(folder / f"frame{i}.png")
    return folder, BYTES


def save_png16_colour(folder: Path) -> tuple[Path, np.ndarray]:
    return save_deep_png(folder, 3), COUNTS


def save_png16_alpha(folder: Path) -> tuple[Path, np.ndarray]:
    return save_deep_png(folder, 2), COUNTS


def save_deep_png(folder: Path, channels: int) -> Path:
    imagecodecs = pytest.importorskip("imagecodecs", reason="imagecodecs, which writes PNG of 16 bits in colour, is not installed")
    for i, frame in enumerate(COUNTS):
        (folder / f"frame{i}.png").write_bytes(imagecodecs.png_encode(np.repeat(frame[..., None], channels, 2)))
    return folder


def save_tiff_folder_of_pages(folder: Path) -> tuple[Path, np.ndarray]:
    import tifffile

    tifffile.imwrite(folder / "a2.tif", COUNTS[:5], photometric="minisblack")
    tifffile.imwrite(folder / "a10.tif", COUNTS[5:], photometric="minisblack")
    return folder, COUNTS


def save_tiff_pages(folder: Path) -> tuple[Path, np.ndarray]:
    import tifffile

    tifffile.imwrite(folder / "clip.tif", COUNTS, photometric="minisblack")
    return folder / "clip.tif", COUNTS


def save_tiff_written_page_by_page(folder: Path) -> tuple[Path, np.ndarray]:
    import tifffile

    with tifffile.TiffWriter(folder / "clip.tiff") as file:
        for frame in FLOATS:
            file.write(frame, contiguous=False, compression="zlib")
    return folder / "clip.tiff", FLOATS


def save_tiff_folder(folder: Path) -> tuple[Path, np.ndarray]:
    import tifffile

    for i, frame in enumerate(FLOATS):
        tifffile.imwrite(folder / f"f_{i}.tif", frame)
    return folder / "f_*.tif", FLOATS


def save_hdf5(folder: Path) -> tuple[Path, np.ndarray]:
    import h5py

    with h5py.File(folder / "clip.h5", "w") as file:
        file.create_dataset("camera/frames", data=COUNTS, chunks=(1, ROWS, COLUMNS), compression="gzip")
        file["camera/frames"].attrs["units"] = "counts"
        file["camera/frames"].attrs["fps"] = 50.0
        file["times"] = np.arange(FRAMES)
    return folder / "clip.h5", COUNTS


def save_fits(folder: Path) -> tuple[Path, np.ndarray]:
    fits = pytest.importorskip("astropy.io.fits", reason="astropy, which reads FITS, is not installed")
    fits.PrimaryHDU(COUNTS).writeto(folder / "clip.fits")  # unsigned 16 bit is stored signed, with an offset
    return folder / "clip.fits", COUNTS


def save_raw(folder: Path) -> tuple[Path, np.ndarray]:
    with (folder / "clip.raw").open("wb") as file:
        file.write(b"HEADER..")
        for frame in COUNTS:
            file.write(b"time" + frame.astype(">u2").tobytes())
    (folder / "clip.toml").write_text(
        f'rows = {ROWS}\ncolumns = {COLUMNS}\nbyte_order = "big"\noffset = 8\nframe_header = 4\nframe_rate = 25.0\n'
    )
    return folder / "clip.raw", COUNTS


def save_netcdf(folder: Path) -> tuple[Path, np.ndarray]:
    import xarray as xr

    times = ("time", np.arange(FRAMES) / 40.0, {"units": "s"})
    dataset = xr.Dataset({"radiance": (("time", "y", "x"), FLOATS, {"units": "W m-2 sr-1"})}, coords={"time": times})
    dataset.to_netcdf(folder / "clip.nc", engine="h5netcdf")
    return folder / "clip.nc", FLOATS


def save_video(folder: Path) -> tuple[Path, np.ndarray]:
    av = pytest.importorskip("av", reason="PyAV, which reads video, is not installed")
    frames = np.repeat(np.repeat(BYTES, 4, 1), 4, 2)[:, :, :32].copy()
    with av.open(str(folder / "clip.mkv"), "w") as container:
        stream = container.add_stream("ffv1", rate=30)
        stream.width, stream.height, stream.pix_fmt = frames.shape[2], frames.shape[1], "gray"
        for frame in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="gray")))
        container.mux(stream.encode())
    return folder / "clip.mkv", frames


SAVERS: tuple[Callable[[Path], tuple[Path, np.ndarray]], ...] = (
    *(
        save_npy,
        save_npz,
        save_png8,
        save_png16,
        save_png16_colour,
        save_png16_alpha,
        save_png_rgba,
        save_tiff_folder_of_pages,
        save_tiff_pages,
        save_tiff_written_page_by_page,
        save_tiff_folder,
    ),
    *(save_hdf5, save_fits, save_raw, save_netcdf, save_video),
)


@pytest.mark.parametrize("save", SAVERS)
def test_numbers_come_back(save: Callable[[Path], tuple[Path, np.ndarray]], tmp_path: Path) -> None:
    path, frames = save(tmp_path)
    recording = open_recording(path)
    assert (recording.frames, recording.rows, recording.columns) == frames.shape
    whole = recording.read(0, frames.shape[0])
    assert whole.dtype == np.float32
    np.testing.assert_array_equal(whole, frames.astype(np.float32))
    # blocks in any order, as a seek backwards in a compressed file
    np.testing.assert_array_equal(recording.read(7, 9), frames[7:9])
    np.testing.assert_array_equal(recording.read(2, 3), frames[2:3])
    np.testing.assert_array_equal(np.concatenate(list(recording.blocks(memory=5 * 4 * frames[0].size))), frames)


@pytest.mark.parametrize(
    ("save", "rate", "units", "saturation"),
    [
        (save_hdf5, 50.0, "counts", 65535.0),
        (save_raw, 25.0, None, 65535.0),
        (save_netcdf, 40.0, "W m-2 sr-1", None),
        (save_video, 30.0, None, 255.0),
        (save_png8, None, None, 255.0),
        (save_fits, None, None, 65535.0),
        (save_npy, None, None, None),
    ],
)
def test_what_a_file_knows(
    save: Callable[[Path], tuple[Path, np.ndarray]], rate: float, units: str, saturation: float, tmp_path: Path
) -> None:
    recording = open_recording(save(tmp_path)[0])
    assert recording.frame_rate == pytest.approx(rate, rel=1e-9) if rate else recording.frame_rate is None
    assert (recording.units, recording.saturation) == (units, saturation)


def test_the_users_rate_counts_and_a_contradiction_is_noted(tmp_path: Path) -> None:
    path, _ = save_hdf5(tmp_path)
    recording = open_recording(path, frame_rate=60.0, units="K")
    assert (recording.frame_rate, recording.units) == (60.0, "K")
    assert any("50 Hz" in note for note in recording.notes)
    assert not open_recording(path, frame_rate=50.0).notes


def test_a_rendered_sequence(tmp_path: Path) -> None:
    from seaglint.scenario.load import parse_scenario
    from seaglint.studies.sequence.render_sequence import render

    scenario = parse_scenario({"sensor": {"pixels": [8, 4], "frames": 3, "frame_rate_hz": 20}, "sea": {"resolve_waves": False}})
    render(scenario, tmp_path / "run.zarr")
    recording = open_recording(tmp_path / "run.zarr")
    assert (recording.frames, recording.rows, recording.columns) == (3, 4, 8)
    assert recording.frame_rate == pytest.approx(20.0)
    assert recording.units == "W m-2 sr-1"
    assert np.isfinite(recording.read(0, 3)).all()


def colour(folder: Path) -> Path:
    from PIL import Image

    image = np.zeros((ROWS, COLUMNS, 3), np.uint8)
    image[..., 0] = 200
    Image.fromarray(image).save(folder / "colour.png")
    return folder / "colour.png"


def test_true_colour_is_refused_unless_a_channel_is_chosen(tmp_path: Path) -> None:
    path = colour(tmp_path)
    with pytest.raises(DataError, match="true colour"):
        open_recording(path)
    assert open_recording(path, channel="red").read(0, 1).mean() == 200.0
    assert open_recording(path, channel="mean").read(0, 1).mean() == pytest.approx(200.0 / 3.0, rel=1e-6)


def test_nearly_grey_is_the_mean_of_its_channels(data_dir: Path) -> None:
    from PIL import Image

    path = data_dir / "imagery" / "Misc_26.png"
    recording = open_recording(path)
    np.testing.assert_allclose(recording.read(0, 1)[0], np.asarray(Image.open(path), float).mean(axis=2), rtol=1e-6)
    assert recording.notes


def nothing(folder: Path) -> Path:
    return folder / "no.npy"


def empty(folder: Path) -> Path:
    (folder / "empty.png").touch()
    return folder / "empty.png"


def broken_png(folder: Path) -> Path:
    whole = (save_png(folder, BYTES[:1]) / "frame0.png").read_bytes()
    (folder / "cut.png").write_bytes(whole[: len(whole) // 2])
    return folder / "cut.png"


def cut_npy(folder: Path) -> Path:
    path, _ = save_npy(folder)
    path.write_bytes(path.read_bytes()[:300])
    return path


def mixed_sizes(folder: Path) -> Path:
    import tifffile

    tifffile.imwrite(folder / "a0.tif", FLOATS[0])
    tifffile.imwrite(folder / "a1.tif", FLOATS[1][:3])
    return folder


def mixed_types(folder: Path) -> Path:
    from PIL import Image

    Image.fromarray(COUNTS[0]).save(folder / "f0.png")
    Image.fromarray(BYTES[1]).save(folder / "f1.png")
    return folder


def cut_npz(folder: Path) -> Path:
    path, _ = save_npz(folder)
    path.write_bytes(path.read_bytes()[:300])
    return path


def layout_with_a_word(folder: Path) -> Path:
    (folder / "x.toml").write_text('rows = 1\ncolumns = 1\nframe_rate = "fast"\n')
    return no_layout(folder)


def beyond_single_precision(folder: Path) -> Path:
    np.save(folder / "huge.npy", FLOATS.astype(np.float64) * 1e300)
    return folder / "huge.npy"


def no_layout(folder: Path) -> Path:
    (folder / "x.raw").write_bytes(b"1234")
    return folder / "x.raw"


def wrong_layout(folder: Path) -> Path:
    (folder / "x.toml").write_text("rows = 0\ncolumns = 4\n")
    return no_layout(folder)


def too_small(folder: Path) -> Path:
    (folder / "x.toml").write_text("rows = 4\ncolumns = 4\n")
    return no_layout(folder)


def several(folder: Path) -> Path:
    np.savez(folder / "two.npz", a=FLOATS, b=FLOATS)
    return folder / "two.npz"


def text(folder: Path) -> Path:
    (folder / "a.xyz").write_text("hello")
    return folder / "a.xyz"


def not_hdf5(folder: Path) -> Path:
    (folder / "a.h5").write_text("hello")
    return folder / "a.h5"


def complex_numbers(folder: Path) -> Path:
    np.save(folder / "c.npy", FLOATS.astype(np.complex64))
    return folder / "c.npy"


def five_dimensions(folder: Path) -> Path:
    np.save(folder / "c.npy", np.broadcast_to(FLOATS, (2, 2, *FLOATS.shape)))
    return folder / "c.npy"


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (nothing, "no such file"),
        (empty, "is empty"),
        (broken_png, "cannot be decoded"),
        (cut_npy, "cannot be read|cut"),
        (mixed_sizes, "one size"),
        (mixed_types, "no common scale"),
        (cut_npz, "cannot be read"),
        (layout_with_a_word, "frame_rate = 'fast'"),
        (beyond_single_precision, "single precision"),
        (no_layout, "need a layout"),
        (wrong_layout, "rows = 0"),
        (too_small, "less than one frame"),
        (several, "give one as variable"),
        (text, "format not known"),
        (not_hdf5, "HDF5"),
        (complex_numbers, "not real numbers"),
        (five_dimensions, "has shape"),
    ],
)
def test_bad_files_are_refused_in_one_line(make: Callable[[Path], Path], says: str, tmp_path: Path) -> None:
    def whole(recording: Recording) -> None:
        recording.read(0, recording.frames)

    with pytest.raises(DataError, match=says) as caught:
        whole(open_recording(make(tmp_path)))
    assert "\n" not in str(caught.value)


def test_trailing_bytes_are_noted(tmp_path: Path) -> None:
    (tmp_path / "x.bin").write_bytes(bytes(20))
    recording = open_recording(tmp_path / "x.bin", raw=RawLayout(rows=2, columns=4, dtype="uint8"))
    assert recording.frames == 2
    assert "4 bytes" in recording.notes[0]


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, np.inf])
def test_impossible_frame_rates(rate: float, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="frame rate"):
        open_recording(save_npy(tmp_path)[0], frame_rate=rate)


def test_what_is_read_is_the_callers_own(tmp_path: Path) -> None:
    """Dead pixels are blanked in it: neither a file's read-only map nor somebody's array may be handed on."""
    path, frames = save_npy(tmp_path)
    block = open_recording(path).read(0, 3)
    block[:] = -1.0
    held = FLOATS.copy()
    Recording("memory", *held.shape, lambda a, b: held[a:b]).read(0, 3)[:] = -1.0
    np.testing.assert_array_equal(held, FLOATS)
    np.testing.assert_array_equal(open_recording(path).read(0, 3), frames[:3])


@pytest.mark.parametrize(("numbers", "noted"), [((0, 1, 2, 6, 7), True), ((0, 10, 20, 30), False), ((3, 4, 5), False)])
def test_missing_numbers_of_files_are_noted(numbers: tuple[int, ...], noted: bool, tmp_path: Path) -> None:
    from PIL import Image

    for number in numbers:
        Image.fromarray(BYTES[0]).save(tmp_path / f"cam2_{number:03d}.png")
    notes = open_recording(tmp_path).notes
    assert bool(notes) is noted
    assert not noted or "cam2_002.png to cam2_006.png" in notes[0]


def test_time_as_the_last_axis(tmp_path: Path) -> None:
    last = np.moveaxis(FLOATS, 0, 2)[:, :, :5]  # (6, 9, 5)
    np.save(tmp_path / "clip.npy", last)
    assert "--axes yxt" in open_recording(tmp_path / "clip.npy").notes[0]
    recording = open_recording(tmp_path / "clip.npy", axes="yxt")
    assert not recording.notes
    np.testing.assert_array_equal(recording.read(1, 4), FLOATS[1:4])


@pytest.mark.parametrize("dtype", [np.float64, np.int64])
def test_a_level_that_single_precision_cannot_carry_is_taken_off(dtype: type, tmp_path: Path) -> None:
    level = 2**40
    np.save(tmp_path / "clip.npy", COUNTS.astype(dtype) + dtype(level))
    recording = open_recording(tmp_path / "clip.npy")
    assert any("taken off" in note for note in recording.notes)
    np.testing.assert_array_equal(recording.read(0, FRAMES).astype(np.float64) + recording.offset, COUNTS + float(level))


def test_the_users_saturation_counts(tmp_path: Path) -> None:
    assert open_recording(save_npz(tmp_path)[0], saturation=3500.0).saturation == 3500.0
