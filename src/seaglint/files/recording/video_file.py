"""Reader of video files, decoded forward; a lossy codec is noted."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.base.optional import optional
from seaglint.files.recording.forward import ForwardFrames
from seaglint.files.recording.stored import grey

ENDINGS = (".mp4", ".avi", ".mkv", ".mov")
_LIMITED = 1  #: PyAV's number of a limited range of luma (AVCOL_RANGE_MPEG).

LOSSLESS = ("ffv1", "rawvideo", "huffyuv", "ffvhuff", "utvideo", "png")


def open_video(path: Path, channel: str | None) -> Recording:
    """Open the first video stream as grey frames; luma where colours are stored as luma and chroma."""
    av = optional("av", f"{path}: video")

    try:
        with av.open(str(path)) as container:
            stream = container.streams.video[0]
            codec, rate = stream.codec_context.name, stream.average_rate
            pixel = stream.codec_context.format
            bits = max(component.bits for component in pixel.components) if pixel is not None else 8
            rows, columns = stream.codec_context.height, stream.codec_context.width
            # Counted, not trusted: headers of cut files tell the length that was planned.
            packets = [(packet.pts, packet.time_base) for packet in container.demux(stream) if packet.size]
            frames, uneven = len(packets), _uneven(packets)
            narrow = getattr(stream.codec_context, "color_range", 0) == _LIMITED
    except Exception as error:
        raise DataError(f"{path}: cannot be read as video ({str(error).splitlines()[0]})") from error
    if frames == 0:
        raise DataError(f"{path}: holds no frames")
    decoder = ForwardFrames(path, lambda: _decoded(path, bits > 8, channel))
    notes = [] if codec in LOSSLESS else [f"codec {codec} is lossy: tails and correlations of the noise are changed"]
    if narrow and bits <= 8:
        notes.append("numbers of 16 to 235 (limited range) are stretched to 0 to 255, as players do")
    if bits > 8 and bits < 16:
        notes.append(f"numbers of {bits} bits are stretched to 16")
    if uneven is not None:
        notes.append(f"frames are {uneven[0]:.3g} to {uneven[1]:.3g} ms apart: they have no one frame rate; give --frame-rate")
        rate = None
    saturation = 65535.0 if bits > 8 else 255.0  # what is deeper than 8 bits is widened to 16
    return Recording(
        f"{path} ({codec})", frames, rows, columns, decoder.read, float(rate) if rate else None, None, saturation, tuple(notes)
    )


def _uneven(packets: list[tuple[int | None, Any]]) -> tuple[float, float] | None:
    """Return the smallest and largest time between frames [ms] where they differ by more than the clock's ticks explain."""
    times = sorted(float(pts * base) for pts, base in packets if pts is not None and base is not None)
    if len(times) < max(len(packets), 3):
        return None
    steps = 1e3 * np.diff(times)
    tick = 1e3 * float(packets[0][1])
    spread = float(steps.max() - steps.min())
    return (float(steps.min()), float(steps.max())) if spread > max(2.5 * tick, 0.02 * float(np.median(steps))) else None


def _decoded(path: Path, deep: bool, channel: str | None) -> Iterator[NDArray[Any]]:
    """Iterate over the frames of a video as one image each."""
    import av

    number = 0
    try:
        with av.open(str(path)) as container:
            for frame in container.decode(video=0):
                image = np.asarray(frame.to_ndarray(format="gray16le" if deep else "rgb24"))
                yield grey(image, str(path), channel) if image.ndim == 3 else image
                number += 1
    except DataError:
        raise
    except Exception as error:
        raise DataError(f"{path}: frame {number} cannot be decoded ({str(error).splitlines()[0]})") from error
