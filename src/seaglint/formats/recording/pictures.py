"""Readers of pictures and videos: PNG, GIF, BMP, PGM and JPEG by Pillow, animated ones among them, and video files by PyAV.

Frames of videos and animations can only be decoded in order. A lossy codec is noted.

References
----------
PNG specification, third edition: IHDR, PLTE, tRNS, gAMA, pCAL (in the extensions), acTL and fcTL.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import BackendError, DataError
from seaglint.base.optional import optional
from seaglint.formats.recording.stored_values import PLAIN, SeveralChannelsError, ValueFacts, grey

PICTURE_ENDINGS: Final = (".png", ".apng", ".gif", ".bmp", ".pgm", ".pbm", ".ppm", ".pnm", ".pfm", ".jpg", ".jpeg")

VIDEO_ENDINGS = (".mp4", ".avi", ".mkv", ".mov")
_LIMITED = 1  #: PyAV's number of a limited range of luma (AVCOL_RANGE_MPEG).

LOSSLESS = ("ffv1", "rawvideo", "huffyuv", "ffvhuff", "utvideo", "png")

#: Formats that Pillow opens here: it knows FITS and TIFF too, without the tags that change their numbers.
_FORMATS: Final = ("PNG", "GIF", "BMP", "DIB", "PPM", "JPEG")

#: Beginnings of files of other formats, with their names and endings.
_OTHERS: Final = {
    b"SIMPLE": "FITS (.fits)",
    b"II*\0": "TIFF (.tif)",
    b"MM\0*": "TIFF (.tif)",
    b"\x89HDF": "HDF5 (.h5)",
    b"\x93NUMPY": "NumPy (.npy)",
}

_SIGNATURE: Final = b"\x89PNG\r\n\x1a\n"
#: Length of the axis of colours by the colour type of a PNG: grey, RGB, palette (made RGB), grey and alpha, RGB and alpha.
_CHANNELS: Final = {0: 0, 2: 3, 3: 3, 4: 2, 6: 4}

_BEFORE_PIXELS: Final = 200  #: Largest number of chunks before the pixels that are looked at.

_GAMMA_ONE: Final = 100_000
_UNEVEN_GIF: Final = 10.0  #: Largest difference between durations of a GIF's frames that rounding to hundredths of a second explains [ms].


class ForwardFrames:
    """Decoder of frames in order; a request for earlier ones starts again.

    Parameters
    ----------
    path : Path
        The file, for messages.
    decode : callable
        ``decode()`` iterates over the frames from the first on.
    """

    def __init__(self, path: Path, decode: Callable[[], Iterator[NDArray[Any]]]) -> None:
        self._path, self._decode, self._next = path, decode, 0
        self._frames: Iterator[NDArray[Any]] = iter(())

    def read(self, start: int, stop: int) -> NDArray[Any]:
        """Return frames ``start`` to ``stop``.

        Raises
        ------
        DataError
            The file ends before, or its frames differ in shape.
        """
        # Decoders cannot go back: an earlier frame begins a new pass.
        if start < self._next or self._next == 0:
            self._next, self._frames = 0, self._decode()
        block: list[NDArray[Any]] = []
        while self._next < stop:
            frame = next(self._frames, None)
            if frame is None:
                raise DataError(f"{self._path}: ends after frame {self._next}, {stop} were announced; the file is cut")
            if self._next >= start:
                block.append(frame)
            self._next += 1
        if any(frame.shape != block[0].shape for frame in block):
            raise DataError(f"{self._path}: some of its frames are grey and some in colour; write them as grey pictures")
        return np.stack(block)


@dataclass(frozen=True)
class PictureFile(ValueFacts):
    """Frames of one file as stored, and facts about their values."""

    path: Path  #: The file.
    frames: int  #: Number of frames.
    rows: int  #: Rows of a frame.
    columns: int  #: Columns of a frame.
    dtype: np.dtype[Any]  #: Type of the stored numbers.
    #: ``(start, stop) -> stored numbers``, shape (stop - start, rows, columns), with a further axis of channels for colours.
    read: Callable[[int, int], NDArray[Any]]
    colours: int = 0  #: Length of the axis of colours, grey and alpha (2), RGB (3) or RGBA (4); 0 without that axis.


def channel_index(count: int, requested: str | None, source: object) -> int:
    """Return the index of the requested channel of several.

    Raises
    ------
    SeveralChannelsError
        None requested.
    DataError
        One that is not there.
    """
    if requested is None:
        raise SeveralChannelsError(f"{source}: has {count} channels; give channel = 1 to {count}")
    if not requested.isdecimal() or not 1 <= int(requested) <= count:
        raise DataError(f"{source}: has {count} channels, and channel = {requested} is none of them; give channel = 1 to {count}")
    return int(requested) - 1


def first_line(error: BaseException) -> str:
    """Return the first line of an exception's text."""
    return (str(error).splitlines() or [type(error).__name__])[0]


@dataclass(frozen=True)
class _PngHeader(ValueFacts):
    """Header of a PNG: size, depth, kind of colours, and facts from chunks that change the meaning of numbers."""

    rows: int
    columns: int
    depth: int
    colour: int
    animated: bool = False


def open_picture(path: Path) -> PictureFile:
    """Look at a picture or an animation: from its header where possible.

    Raises
    ------
    DataError
        A file that cannot be decoded, or one of several pictures that are read by no one.
    """
    header = _png_header(path) if path.suffix.lower() in (".png", ".apng") else None
    if header is not None and not header.animated and header.colour in _CHANNELS:
        dtype = np.dtype(np.uint16 if header.depth == 16 else np.uint8)
        full = float(2 ** (header.depth if header.colour == 0 else max(header.depth, 8)) - 1)
        return PictureFile(
            path, 1, header.rows, header.columns, dtype, lambda a, b: _decoded(path)[np.newaxis], _CHANNELS[header.colour],
            units=header.units, decoding=header.decoding, saturation=full if header.decoding.scale == 1.0 else None, notes=header.notes,
        )  # fmt: skip
    return _by_pillow(path, header)


def _by_pillow(path: Path, header: _PngHeader | None) -> PictureFile:
    """Look at a file by decoding its first frame, and at the durations of all of them."""
    from PIL import Image

    try:
        with Image.open(path, formats=_FORMATS) as image:
            # The picture before an animation that is no part of it (APNG) is the first frame to Pillow.
            skipped = int(bool(getattr(image, "default_image", False)))
            count = int(getattr(image, "n_frames", 1)) - skipped
            form = str(image.format)
            durations = []
            for i in range(count if count > 1 else 0):
                image.seek(i + skipped)
                durations.append(float(image.info.get("duration", 0.0) or 0.0))
    except Exception as error:
        raise _undecodable(path, error) from error
    if header is not None and header.animated and header.depth == 16 and header.colour != 0:
        raise DataError(f"{path}: is an animated PNG of 16 bits in colour, which is not read; write grey frames, or TIFF")
    frames = ForwardFrames(path, lambda: _frames(path, skipped))
    first = frames.read(0, 1)[0]
    notes = list(header.notes if header is not None else ())
    decoding, units = (header.decoding, header.units) if header is not None else (PLAIN, None)
    full: float | None = float(np.iinfo(first.dtype).max) if first.dtype.kind == "u" else None
    if form == "PPM":
        own, notes_of = _netpbm(path)
        full = float(own) if own is not None else full
        notes += notes_of
    if form == "JPEG":
        notes.append("JPEG is lossy: tails and correlations of the noise are changed")
        notes += _radiometric(path)
    rate, uneven = _rate(durations, form)
    colours = 0 if first.ndim == 2 else int(first.shape[-1])
    return PictureFile(
        path, count, int(first.shape[0]), int(first.shape[1]), first.dtype, frames.read, colours,
        frame_rate=rate, units=units, decoding=decoding, saturation=full, notes=(*notes, *uneven),
    )  # fmt: skip


def _rate(durations: list[float], form: str) -> tuple[float | None, tuple[str, ...]]:
    """Return the frame rate [Hz] of an animation whose frames last as long as each other."""
    if not durations or min(durations) <= 0.0:
        return None, ()
    if max(durations) - min(durations) > (_UNEVEN_GIF if form == "GIF" else 1e-3 * max(durations)):
        return None, (f"frames last {min(durations):g} to {max(durations):g} ms: they have no one frame rate",)
    return 1000.0 * len(durations) / sum(durations), ()


def _frames(path: Path, skipped: int) -> Iterator[NDArray[Any]]:
    """Iterate over the frames of an animation as stored."""
    from PIL import Image

    try:
        with Image.open(path, formats=_FORMATS) as image:
            for i in range(skipped, int(getattr(image, "n_frames", 1))):
                if i:
                    image.seek(i)
                yield _numbers(image, path)
    except DataError:
        raise
    except Exception as error:
        raise _undecodable(path, error) from error


def _undecodable(path: Path, error: Exception) -> DataError:
    with path.open("rb") as file:
        head = file.read(8)
    other = next((name for start, name in _OTHERS.items() if head.startswith(start)), None)
    if other is not None:
        return DataError(f"{path}: holds {other}, and its ending is that of a picture; give it the ending of its format")
    return DataError(
        f"{path}: cannot be decoded ({first_line(error)}); copy it again if it is cut, or write it as plain PNG or uncompressed TIFF"
    )


def _numbers(image: Any, path: Path) -> NDArray[Any]:
    """Return the numbers of a picture: (rows, columns), or (rows, columns, channels)."""
    from PIL import ImageOps

    depth = _grey_depth(image)
    maximum = _netpbm(path)[0] if image.format == "PPM" else None
    if image.format == "JPEG" and image.mode == "CMYK":
        raise DataError(f"{path}: holds inks (CMYK), which are no measure of radiance; give the grey original")
    upright = ImageOps.exif_transpose(image) if image.format == "JPEG" else image
    # A palette is a picture of colours, not numbers; 16-bit grey comes as 32-bit integers from some versions.
    stored = np.asarray(upright.convert("RGB") if upright.mode in ("P", "PA") else upright)
    if image.mode.startswith("I"):
        stored = stored.astype(np.uint16)
    if stored.dtype == np.bool_:
        return stored.astype(np.uint8)
    if depth < 8:
        return stored // np.uint8(255 // (2**depth - 1))  # Pillow stretches 2 and 4 bits to 8
    if maximum is not None and maximum not in (255, 65535):
        # Pillow stretches to 8 or 16 bits; rounding finds the stored number again.
        top = 255 if maximum < 256 else 65535
        return np.rint(stored.astype(np.float64) * maximum / top).astype(np.uint8 if maximum < 256 else np.uint16)
    return stored


def _grey_depth(image: Any) -> int:
    """Return the bits of a grey PNG, which Pillow does not keep."""
    if image.format != "PNG" or image.mode != "L":
        return 8
    header = _png_header(Path(image.filename))
    return header.depth if header is not None and header.colour == 0 else 8


def _decoded(path: Path) -> NDArray[Any]:
    """Return the numbers of a still picture."""
    from PIL import Image

    try:
        header = _png_header(path)
        if header is not None and header.depth == 16 and header.colour != 0:
            # Pillow reduces colours, or grey and alpha, of 16 bits each to 8.
            return np.asarray(optional("imagecodecs", f"{path}: colour of 16 bits").png_decode(path.read_bytes()))
        with Image.open(path, formats=_FORMATS) as image:
            return _numbers(image, path)
    except (BackendError, DataError):
        raise
    except Exception as error:
        raise _undecodable(path, error) from error


def _png_header(path: Path) -> _PngHeader | None:
    """Return the chunks before the pixels that matter; None for a file that is no PNG."""
    header: _PngHeader | None = None
    try:
        with path.open("rb") as file:
            if file.read(8) != _SIGNATURE:
                return None
            for _ in range(_BEFORE_PIXELS):
                length, kind = struct.unpack(">I4s", file.read(8))
                if kind == b"IDAT":
                    break
                content = file.read(length) if kind in _LOOKED_AT else b""
                # A checksum of 4 bytes follows the content of a chunk.
                file.seek(4 if content or not length else length + 4, 1)
                if kind == b"IHDR":
                    columns, rows, depth, colour = struct.unpack(">IIBB", content[:10])
                    header = _PngHeader(rows, columns, depth, colour)
                elif header is not None and kind in _LOOKED_AT:
                    header = _LOOKED_AT[kind](header, content, path)
    except DataError:
        raise
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({first_line(error)})") from error
    except (struct.error, ValueError, IndexError):
        return header
    return header


def _transparent(header: _PngHeader, content: bytes, path: Path) -> _PngHeader:
    if header.colour != 0 or len(content) < 2:
        return header
    return replace(header, decoding=replace(header.decoding, missing=(float(struct.unpack(">H", content[:2])[0]),)))


def _gamma(header: _PngHeader, content: bytes, path: Path) -> _PngHeader:
    gamma = struct.unpack(">I", content[:4])[0]
    if gamma == _GAMMA_ONE:
        return header
    note = f"the file states a gamma of {gamma / _GAMMA_ONE:.4g} for display (gAMA), which is not applied: values are the stored numbers"
    return replace(header, notes=(*header.notes, note))


def _calibration(header: _PngHeader, content: bytes, path: Path) -> _PngHeader:
    """Honour a straight line from numbers to a quantity (pCAL, equation type 0); other equations are refused."""
    _, _, rest = content.partition(b"\0")
    first, last, kind, count = struct.unpack(">iiBB", rest[:10])
    units, *parameters = rest[10:].split(b"\0")
    if kind != 0 or count < 2 or first == last:
        raise DataError(
            f"{path}: its calibration (pCAL, equation {kind}) is no straight line; write the calibrated values as TIFF of floats"
        )
    zero, slope = (float(text) for text in parameters[:2])
    # The numbers of the file span first to last, to which the equation p0 + p1 n / (last - first) is applied.
    line = replace(header.decoding, scale=slope / (2**header.depth - 1), offset=zero + slope * first / (last - first))
    return replace(header, decoding=line, units=units.decode("latin-1").strip() or None)


_LOOKED_AT: Final[dict[bytes, Callable[[_PngHeader, bytes, Path], _PngHeader]]] = {
    b"IHDR": lambda header, content, path: header,
    b"acTL": lambda header, content, path: replace(header, animated=True),
    b"tRNS": _transparent,
    b"gAMA": _gamma,
    b"pCAL": _calibration,
}


def _netpbm(path: Path) -> tuple[int | None, list[str]]:
    """Return the largest number that a PGM or PPM states, and notes; the header is ASCII with comments.

    Raises
    ------
    DataError
        Further pictures behind the first.
    """
    with path.open("rb") as file:
        head = file.read(4096)
    words: list[bytes] = []
    at = 0
    # Bitmaps (P1, P4) have no largest number: three words, not four.
    needed = 3 if head[:2] in (b"P1", b"P4") else 4
    for match in re.finditer(rb"#[^\n]*|\S+", head):
        if len(words) < needed and not match[0].startswith(b"#"):
            words.append(match[0])
            at = match.end()
    if len(words) < needed or not words[1].isdigit() or not words[2].isdigit():
        return None, []
    columns, rows = int(words[1]), int(words[2])
    if words[0] in (b"Pf", b"PF"):
        scale = abs(float(words[3]))
        return None, [f"the scale {scale:g} of the file is not applied"] if scale != 1.0 else []
    if words[0] == b"P4":
        size = rows * ((columns + 7) // 8)
        maximum = 1
    elif words[0] in (b"P5", b"P6") and words[3].isdigit():
        maximum = int(words[3])
        size = rows * columns * (2 if maximum > 255 else 1) * (3 if words[0] == b"P6" else 1)
    else:
        return (int(words[3]) if needed == 4 and words[3].isdigit() else 1), []
    behind = path.stat().st_size - (at + 1 + size)
    if behind >= size:
        raise DataError(f"{path}: holds {1 + behind // size} pictures in one file, of which one could be read; write a file for each")
    return maximum, []


def _radiometric(path: Path) -> list[str]:
    """Return a note on the numbers of a thermal camera that some JPEG files carry beside their picture (FLIR)."""
    with path.open("rb") as file:
        head = file.read(65536)
    thermal = b"\xff\xe1" in head and b"FLIR\x00" in head
    return ["the camera's thermal numbers beside the picture (FLIR) are not read: export them as TIFF"] if thermal else []


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
            # Packets are counted: headers of cut files state the length that was planned.
            packets = [(packet.pts, packet.time_base) for packet in container.demux(stream) if packet.size]
            frames, uneven = len(packets), _uneven(packets)
            # PyAV's conversion stretches a limited range to the full one.
            narrow = getattr(stream.codec_context, "color_range", 0) == _LIMITED
    except Exception as error:
        raise DataError(f"{path}: cannot be read as video ({first_line(error)})") from error
    if frames == 0:
        raise DataError(f"{path}: holds no frames")
    decoder = ForwardFrames(path, lambda: _decoded_frames(path, bits > 8, channel))
    notes = [] if codec in LOSSLESS else [f"codec {codec} is lossy: tails and correlations of the noise are changed"]
    if narrow and bits <= 8:
        notes.append("numbers of 16 to 235 (limited range) are stretched to 0 to 255, as players do")
    if bits > 8 and bits < 16:
        notes.append(f"numbers of {bits} bits are stretched to 16")
    if uneven is not None:
        notes.append(f"frames are {uneven[0]:.3g} to {uneven[1]:.3g} ms apart: they have no one frame rate; give --frame-rate")
        rate = None
    saturation = 65535.0 if bits > 8 else 255.0  # numbers of more than 8 bits are widened to 16
    return Recording(
        f"{path} ({codec})", frames, rows, columns, decoder.read, float(rate) if rate else None, None, saturation, tuple(notes)
    )


def _uneven(packets: list[tuple[int | None, Any]]) -> tuple[float, float] | None:
    """Return the smallest and largest time between frames [ms] where they differ by more than the clock's ticks explain."""
    times = sorted(float(pts * base) for pts, base in packets if pts is not None and base is not None)
    if len(times) < max(len(packets), 3):
        return None
    steps = 1e3 * np.diff(times)
    # Times are whole ticks of the stream's clock: two of them differ by up to two roundings.
    tick = 1e3 * float(packets[0][1])
    spread = float(steps.max() - steps.min())
    return (float(steps.min()), float(steps.max())) if spread > max(2.5 * tick, 0.02 * float(np.median(steps))) else None


def _decoded_frames(path: Path, deep: bool, channel: str | None) -> Iterator[NDArray[Any]]:
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
        raise DataError(f"{path}: frame {number} cannot be decoded ({first_line(error)})") from error
