"""A sequence as a video, white hot, on one grey scale for all frames, with time and scale below (PyAV, extra ``video``)."""

from __future__ import annotations

from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.errors import BackendError
from seaglint.io.counts import pictures
from seaglint.io.outputs import moved_when_whole
from seaglint.io.provenance import stored_band
from seaglint.plot.scale import Kind, Scale, scale_of, sea_pixels
from seaglint.plot.summary import images, to_temperature
from seaglint.schema import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

_SHOWN_WIDTH: Final = 1024  # small images are enlarged to about this, by whole factors, so that pixels stay pixels
_MAX_SIDE: Final = 4096  # what H.264 decoders take; wider panoramas are averaged down
_SAMPLED_FRAMES: Final = 16  # frames that set the grey scale
_CAPTION: Final = 56  # px; two lines of text
_LEAST_WIDTH: Final = 480  # px that the caption takes; narrower pictures get black beside them


def video_available() -> bool:
    """Whether PyAV is installed."""
    return find_spec("av") is not None


def grey(image: NDArray[np.floating], low: float, high: float) -> NDArray[np.uint8]:
    """Eight-bit picture of even sides; NaN is black."""
    scaled = np.nan_to_num(np.clip((image - low) / (high - low), 0.0, 1.0), nan=0.0)
    shrink = -(-max(image.shape) // _MAX_SIDE)
    if shrink > 1:
        down, across = (min(shrink, size) for size in image.shape)
        rows, columns = image.shape[0] // down, image.shape[1] // across
        scaled = scaled[: rows * down, : columns * across].reshape(rows, down, columns, across).mean(axis=(1, 3))
    grow = max(1, _SHOWN_WIDTH // max(scaled.shape))
    enlarged = np.repeat(np.repeat(scaled, grow, axis=0), grow, axis=1)
    # H.264 with halved colour resolution takes even sides only.
    even = np.pad(enlarged, [(0, size % 2) for size in enlarged.shape], mode="edge")
    return np.asarray(np.rint(255.0 * even), dtype=np.uint8)


def captioned(picture: NDArray[np.uint8], scale: Scale, ends: str, time: float | None) -> NDArray[np.uint8]:
    """Picture with a strip below it: the time, a bar from the darkest to the brightest grey, and what its ends are."""
    from matplotlib import get_data_path
    from PIL import Image, ImageDraw, ImageFont

    width = max(picture.shape[1], _LEAST_WIDTH)
    strip = Image.new("L", (width, _CAPTION), 0)
    pen = ImageDraw.Draw(strip)
    # Matplotlib brings a font with raised figures; Pillow's own has none.
    font = ImageFont.truetype(str(Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"), 14)
    pen.text((8, 6), "" if time is None else f"t = {time:.2f} s", fill=255, font=font)
    left, right = 120, width - 8
    ramp = np.rint(255.0 * np.linspace(0.0, 1.0, right - left)).astype(np.uint8)
    strip.paste(Image.fromarray(np.repeat(ramp[np.newaxis], 16, axis=0)), (left, 7))
    pen.rectangle((left - 1, 6, right, 23), outline=128)
    pen.text((8, 32), ends + (", logarithmic" if scale.logarithmic else ""), fill=255, font=font)
    beside = np.pad(picture, [(0, 0), (0, width - picture.shape[1])])
    return np.concatenate([beside, np.asarray(strip, dtype=np.uint8)])


def write_video(dataset: xr.Dataset, output: str | Path, scale: Kind = "auto") -> Path:
    """Write an MP4 at the sequence's frame rate; ``scale`` as in :func:`seaglint.plot.scale.scale_of`, one for all frames.

    Raises
    ------
    BackendError
        PyAV is not installed.
    StorageError
        No room or no rights; nothing is left behind.
    """
    if not video_available():
        raise BackendError("a video needs PyAV, which is not installed; pip install 'seaglint[video]'")
    import av

    output = Path(output)
    frames = images(dataset)
    count = len(frames)
    sampled = np.stack([frames[i] for i in np.unique(np.linspace(0, count - 1, min(count, _SAMPLED_FRAMES)).astype(int))])
    grey_scale = scale_of(sampled, sea_pixels(dataset), scale)
    limits = np.array([grey_scale.low, grey_scale.high])
    kelvin = to_temperature(np.maximum(limits, 0.0), stored_band(dataset.attrs))
    ends = f"{limits[0]:.4g} … {limits[1]:.4g} {VARIABLES['radiance'].symbol} ({kelvin[0]:.1f} … {kelvin[1]:.1f} K)"
    times = dataset["time"].to_numpy().astype(np.float64)[frames.indices] if "time" in pictures(dataset).dims else None
    rate = Fraction(float(dataset.attrs.get("frame_rate_hz", 25.0))).limit_denominator(1000)
    with (
        moved_when_whole(output, "make room and run the same command with --resume") as partial,
        av.open(str(partial), mode="w", format="mp4") as container,
    ):
        stream = container.add_stream("libx264", rate=rate, options={"crf": "18", "preset": "veryfast"})
        stream.pix_fmt = "yuv420p"
        for index in range(count):
            shown = grey(grey_scale.share(frames[index]), 0.0, 1.0)
            picture = captioned(shown, grey_scale, ends, None if times is None else float(times[index]))
            if index == 0:
                stream.height, stream.width = picture.shape
            for packet in stream.encode(av.VideoFrame.from_ndarray(picture, format="gray")):
                container.mux(packet)
        for packet in stream.encode(None):
            container.mux(packet)
    return output
