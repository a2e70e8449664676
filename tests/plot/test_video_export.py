"""Exported videos, decoded by Pillow and by a program of ffmpeg, which had no part in the encoding."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from seaglint.base.errors import BackendError, DataError
from seaglint.optics.band import Band
from seaglint.plot import video
from seaglint.plot.run_export import export_run
from seaglint.plot.video import palette
from seaglint.store.layout import Layout
from seaglint.store.sequence_store import open_sequence, write_sequence

ROWS, COLUMNS, FRAMES = 16, 128, 6
GROW = 8  # 1024 columns are shown


def ramp(number):
    """Brightness from 0 to 1 along the rows, and one column that moves and is dark."""
    image = np.repeat(np.linspace(0.0, 1.0, COLUMNS, dtype=np.float32)[np.newaxis], ROWS, axis=0)
    image[:, 100 + number] = 0.0
    return image


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.zarr"
    layout = Layout(np.linspace(100, 110, COLUMNS), np.linspace(0, -1, ROWS), range(FRAMES), 20.0, Band.rectangular(3.5, 5.0))
    write_sequence(path, layout, lambda n: {"radiance": ramp(n)})
    return open_sequence(path)


def decoded_gif(path):
    """Frames (n, rows, columns, 3) and the delay between them [s]."""
    frames = []
    with Image.open(path) as image:
        for n in range(image.n_frames):
            image.seek(n)
            frames.append(np.asarray(image.convert("RGB")))
        return np.stack(frames), image.info["duration"] / 1000.0


def decoded_mp4(path):
    """The same by ffmpeg."""
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    reader = ffmpeg.read_frames(path)
    about = next(reader)
    width, height = about["size"]
    frames = np.stack([np.frombuffer(frame, np.uint8).reshape(height, width, 3) for frame in reader])
    return frames, 1.0 / about["fps"]


def middles(frames):
    """Colours in the middle of every pixel's block in the fifth row, (n, columns, 3)."""
    return frames[:, 4 * GROW + GROW // 2, GROW // 2 : COLUMNS * GROW : GROW]


@pytest.mark.parametrize("colours", ["white-hot", "black-hot", "perceptual"])
@pytest.mark.parametrize(("ending", "decode", "error"), [("gif", decoded_gif, 0), ("mp4", decoded_mp4, 12)])
def test_colours_of_every_frame(run, tmp_path, colours, ending, decode, error):
    output = tmp_path / f"x.{ending}"
    told = export_run(run, output, colours=colours, limits=(0.0, 1.0))
    frames, delay = decode(output)
    expected = np.stack([palette(colours)[np.rint(255.0 * ramp(n)[4]).astype(int)] for n in range(FRAMES)])
    found = middles(frames)
    assert found.shape == expected.shape
    assert delay == pytest.approx(0.05, rel=1e-3)
    # GIF keeps the levels; H.264 is lossy and halves the resolution of colour, so columns beside the dark one are left out.
    kept = np.ones((FRAMES, COLUMNS), dtype=bool)
    for n in range(FRAMES if error else 0):
        kept[n, 98 + n : 103 + n] = False
    assert np.abs(found.astype(int) - expected)[kept].max() <= error
    dark = found.astype(int)[np.arange(FRAMES), 100 + np.arange(FRAMES)]
    assert np.abs(dark - palette(colours)[0].astype(int)).max() <= 3 * error
    assert told.shape == (FRAMES, ROWS, COLUMNS)
    assert [path.name for path in tmp_path.iterdir()] == [output.name]


def test_maps_rise_as_their_names_say():
    weights = np.array([0.2126, 0.7152, 0.0722])
    for colours, sign in (("white-hot", 1.0), ("black-hot", -1.0), ("perceptual", 1.0)):
        light = palette(colours) @ weights
        assert (sign * np.diff(light) > -1.0).all()  # a level of rounding
        assert sign * (light[-1] - light[0]) > 200.0


@pytest.mark.parametrize(("rate", "frames", "delay"), [(None, range(0, 6, 2), 0.1), (5.0, None, 0.2)])
def test_rate_of_the_frames_chosen_or_asked_for(run, tmp_path, rate, frames, delay):
    export_run(run, tmp_path / "x.gif", rate=rate, frames=frames)
    assert decoded_gif(tmp_path / "x.gif")[1] == pytest.approx(delay)


def test_a_gif_that_would_be_too_fast_is_slower_and_says_so(run, tmp_path):
    fast = run.assign_coords(time=run["time"] / 5.0)
    fast["time"].attrs = run["time"].attrs
    told = export_run(fast, tmp_path / "x.gif")
    assert decoded_gif(tmp_path / "x.gif")[1] == pytest.approx(0.02)
    assert "50 per second (the run has 100)" in told.line


def test_other_variables_have_their_units_below(run, tmp_path, monkeypatch):
    seen = []
    drawn = video.captioned
    monkeypatch.setattr(video, "captioned", lambda *given: seen.append(given[2]) or drawn(*given))
    signal = (1000.0 * run["radiance"]).astype(np.uint16).assign_attrs(units="count")
    export_run(run.assign(signal=signal), tmp_path / "x.gif", limits=(0.0, 1000.0))
    export_run(run, tmp_path / "y.gif", limits=(0.0, 1.0))
    assert seen[0] == "0 … 1000 counts"
    assert "W m⁻² sr⁻¹" in seen[-1]


@pytest.mark.parametrize(
    ("name", "choice", "message"),
    [
        ("x.avi", {}, r"allowed are \.nc, \.h5, .*\.raw, \.mp4, \.gif"),
        ("x.mp4", {"dtype": "uint16"}, "takes no `dtype`"),
        ("x.tif", {"colours": "black-hot"}, "takes no `colours`"),
        ("x.tif", {"rate": 3.0}, "takes no `rate`"),
        ("x.gif", {"rate": 60.0}, "outside 0.01-50"),
        ("x.mp4", {"rate": float("nan")}, "outside 0.01-1000"),
        ("x.mp4", {"colours": "rainbow"}, "allowed are white-hot, black-hot, perceptual"),
        ("x.mp4", {"limits": (1.0, 0.0)}, "is no range"),
        ("x.mp4", {"limits": (0.0, 1.0), "scale": "log"}, "one of the two"),
        ("x.tif", {"limits": (0.0, 1.0)}, "dtype = 'uint16'"),
        ("missing/x.gif", {}, "does not exist"),
    ],
)
def test_what_cannot_be_is_refused(run, tmp_path, name, choice, message):
    with pytest.raises(DataError, match=message):
        export_run(run, tmp_path / name, **choice)
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_written_into_the_run(run):
    from pathlib import Path

    with pytest.raises(DataError, match="inside the run"):
        export_run(run, Path(run.encoding["source"]) / "x.npy")


def test_videos_without_pyav_name_it(run, tmp_path, monkeypatch):
    monkeypatch.setattr(video, "video_available", lambda: False)
    with pytest.raises(BackendError, match=r"pip install 'av>=14'"):
        export_run(run, tmp_path / "x.gif")


def test_a_video_that_stops_leaves_nothing(run, tmp_path):
    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export_run(run, tmp_path / "x.mp4", progress=stop)
    assert list(tmp_path.iterdir()) == []
