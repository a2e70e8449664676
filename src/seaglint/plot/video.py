"""A sequence as a video, white hot, on one grey scale for all frames (PyAV, extra ``video``)."""

from __future__ import annotations

from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.errors import BackendError
from seaglint.io.outputs import moved_when_whole
from seaglint.plot.preview import scale_limits
from seaglint.plot.summary import images

if TYPE_CHECKING:
    import xarray as xr

_SHOWN_WIDTH: Final = 1024  # small images are enlarged to about this, by whole factors, so that pixels stay pixels
_MAX_SIDE: Final = 4096  # what H.264 decoders take; wider panoramas are averaged down
_SAMPLED_FRAMES: Final = 16  # frames that set the grey scale


def video_available() -> bool:
    """Whether PyAV is installed."""
    return find_spec("av") is not None


def grey(image: NDArray[np.float32], low: float, high: float) -> NDArray[np.uint8]:
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


def write_video(dataset: xr.Dataset, output: str | Path) -> Path:
    """Write an MP4 at the sequence's frame rate.

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
    low, high = scale_limits(sampled)
    rate = Fraction(float(dataset.attrs.get("frame_rate_hz", 25.0))).limit_denominator(1000)
    with (
        moved_when_whole(output, "make room and run the same command with --resume") as partial,
        av.open(str(partial), mode="w", format="mp4") as container,
    ):
        stream = container.add_stream("libx264", rate=rate, options={"crf": "18", "preset": "veryfast"})
        stream.pix_fmt = "yuv420p"
        for index in range(count):
            picture = grey(frames[index], low, high)
            if index == 0:
                stream.height, stream.width = picture.shape
            for packet in stream.encode(av.VideoFrame.from_ndarray(picture, format="gray")):
                container.mux(packet)
        for packet in stream.encode(None):
            container.mux(packet)
    return output
