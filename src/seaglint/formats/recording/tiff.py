"""Reader of TIFF: which pages are frames, which channel is read, the numbers of each page, and facts beside the pixels.

Facts are frame rate, units, missing value and the line of the counts, in the words of seaglint, ImageJ, OME and GDAL (tags 42112 and
42113), and the frame rate of CinemaDNG (tag 51044).

References
----------
TIFF 6.0: NewSubfileType (p. 36), PhotometricInterpretation (p. 37), Orientation (p. 36), ExtraSamples (p. 31); ImageJ and OME write the
axes of a stack in its description.
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.base.optional import optional
from seaglint.formats.recording.frame_axes import AxisOrder, Ordered, one_rate, seconds_in
from seaglint.formats.recording.pictures import PictureFile, channel_index, first_line
from seaglint.formats.recording.stored_values import Decoding, ValueFacts, in_type

_STRAIGHT: Final = 0
_UNCALIBRATED: Final = 20  #: ImageJ's numbers of a calibration by a straight line, and of none (``ij.measure.Calibration``).

_MINISWHITE: Final = 0
#: Tags of curves from numbers to light, which are not applied.
_UNUSED: Final = {291: "GrayResponseCurve", 301: "TransferFunction", 50712: "LinearizationTable"}

_REDUCED, _MASK = 1, 4  #: Bits of NewSubfileType: a reduced version of another page, a transparency mask.

_OLD_REDUCED: Final = 2  #: SubfileType of a reduced version.

_MASK_PICTURE, _PALETTE, _RGB, _YCBCR = 4, 3, 2, 6
#: Photometric interpretations whose numbers are no measure of radiance.
_REFUSED: Final = {
    5: "inks (CMYK)", 8: "CIE L*a*b* colours", 9: "ICC L*a*b* colours", 10: "ITU L*a*b* colours", 32803: "a mosaic of colour filters",
    32844: "logarithms of luminance (LogL)", 32845: "logarithms of luminance (LogLuv)",
}  # fmt: skip

#: Compressions that may round numbers: JPEG in two forms, JPEG 2000, LERC, WebP, JPEG XL.
_LOSSY: Final = (6, 7, 33003, 33004, 33005, 33007, 34712, 34887, 34927, 50001, 50002)

_BEYOND_THE_END: Final = ("invalid page offset", "invalid value offset")  #: Parts of tifffile's messages at a file whose end is missing.

#: Kinds of files whose description says what the pages of a stack are.
_STACKED: Final = ("is_imagej", "is_ome", "is_stk", "is_lsm", "is_micromanager", "is_scanimage", "is_nih", "is_fluoview", "is_mdgel")

#: Axes of a stack that are frames, the likeliest first: time, index, others, depth (ImageJ calls the frames of a stack slices).
_TIMES: Final = "TIQRHZ"

#: Turns by Orientation that put the first row at the top and the first column at the left.
_TURNS: Final[dict[int, Callable[[NDArray[Any]], NDArray[Any]]]] = {
    2: lambda a: a[:, :, ::-1],
    3: lambda a: a[:, ::-1, ::-1],
    4: lambda a: a[:, ::-1],
    5: lambda a: a.swapaxes(1, 2),
    6: lambda a: np.rot90(a, -1, (1, 2)),
    7: lambda a: a.swapaxes(1, 2)[:, ::-1, ::-1],
    8: lambda a: np.rot90(a, 1, (1, 2)),
}


@dataclass(frozen=True)
class TiffFacts(ValueFacts):
    """Facts of a TIFF about its values.

    ``bands`` are scale, offset and units of each channel by GDAL, which states them one by one; None without them.
    """

    bands: tuple[tuple[float, float, str | None], ...] | None = None

    @classmethod
    def of(cls, file: Any, page: Any, source: str) -> TiffFacts:
        """Return the facts of an open ``tifffile.TiffFile`` and its first page that is a frame.

        Raises
        ------
        DataError
            Two lines that contradict each other, or numbers whose values are not known.
        """
        imagej: JsonObject = file.imagej_metadata or {}
        own = _own(imagej.get("Info")) or _own(page.description)
        lines: dict[str, tuple[float, float]] = {}
        blanks = _gdal_nodata(page, source)
        units: str | None = None
        if own is not None:
            scale, zero = _number(own.get("scale_factor")), _number(own.get("add_offset"))
            if scale is not None:
                lines["our own description"] = scale, zero or 0.0
                blanks += [blank for blank in [_number(own.get("_FillValue"))] if blank is not None]
            units = _words(own.get("attributes", {}).get("units"))
        else:
            value_unit = imagej.get("vunit")
            units = None if value_unit in (None, "", "Gray Value") else str(value_unit)
            line = _imagej_line(imagej, source)
            if line is not None:
                lines["ImageJ's calibration"] = line
        bands = _gdal_lines(page, source)
        if any(line[:2] != (1.0, 0.0) for line in bands) and lines:
            lines["GDAL's metadata"] = bands[0][:2]
        first, offset = _one_line(lines, source)
        rate, notes = one_rate(_rates(file, page, own, imagej))
        decoding = Decoding(in_type(blanks, np.dtype(page.dtype)), scale=first, offset=offset, white=_white(page, source))
        # Counts of an export end at the largest value, which is no saturation: full scale holds without a line alone.
        stated = bands if bands and not lines else None
        return cls(stated, frame_rate=rate, units=units, decoding=decoding, saturation=_limit(file, page), notes=(*notes, *_curves(page)))

    def of_channel(self, index: int | None) -> TiffFacts:
        """Return the facts of one channel, by default of the first; a channel without a line of GDAL's has unscaled values."""
        if self.bands is None:
            return self
        place = 0 if index is None else index
        scale, zero, units = self.bands[place] if place < len(self.bands) else (1.0, 0.0, None)
        return replace(self, units=units or self.units, decoding=replace(self.decoding, scale=scale, offset=zero))

    @property
    def full_scale(self) -> float | None:
        """Value of full scale; None for numbers with a line, since counts of an export end at the largest value."""
        return self.saturation if self.decoding.scale == 1.0 and self.decoding.offset == 0.0 else None


def _imagej_line(imagej: JsonObject, source: str) -> tuple[float, float] | None:
    """Return ImageJ's scale and offset; curves are refused."""
    function = imagej.get("cf")
    slope, zero = _number(imagej.get("c1")), _number(imagej.get("c0"))
    if function is None or function == _UNCALIBRATED or (slope is None and zero is None):
        return None
    if function != _STRAIGHT:
        raise DataError(f"{source}: ImageJ's calibration is no straight line (function {function}); write the calibrated values as floats")
    return (1.0 if slope is None else slope), zero or 0.0


def _gdal_lines(page: Any, source: str) -> tuple[tuple[float, float, str | None], ...]:
    """Return scale, offset and units of each band (GDAL: Item elements with the roles scale, offset and unittype)."""
    text = _tag(page, 42112)
    if text is None:
        return ()
    try:
        items = ElementTree.fromstring(str(text).strip("\x00 \n")).iter("Item")
        bands: dict[int, dict[str, str]] = {}
        for item in items:
            role = (item.get("role") or item.get("name") or "").lower()
            if role in ("scale", "offset", "unittype"):
                bands.setdefault(int(item.get("sample", "0")), {})[role] = (item.text or "").strip()
        every = [bands.get(i, {}) for i in range(max(bands, default=-1) + 1)]
        return tuple((float(b.get("scale", 1.0)), float(b.get("offset", 0.0)), b.get("unittype") or None) for b in every)
    except (ElementTree.ParseError, ValueError) as error:
        raise DataError(f"{source}: GDAL's metadata cannot be read ({error}); write the file again") from error


def _gdal_nodata(page: Any, source: str) -> list[float]:
    text = _tag(page, 42113)
    if text is None:
        return []
    try:
        return [float(str(text).strip("\x00 \n"))]
    except ValueError:
        raise DataError(f"{source}: GDAL_NODATA = '{text}' is no number; correct the tag") from None


def _rates(file: Any, page: Any, own: JsonObject | None, imagej: JsonObject) -> dict[str, float]:
    """Return frame rates [Hz] by their source."""
    rates: dict[str, float] = {}
    interval, unit = _positive(imagej.get("finterval")), seconds_in(imagej.get("tunit", "s"))
    if own is not None:
        rate = _positive(own.get("frame_rate_hz"))
        rates |= {} if rate is None else {"our own description": rate}
    elif interval is not None and unit is not None:
        rates["ImageJ's finterval"] = 1.0 / (interval * unit)
    # A rational number: numerator and denominator.
    fraction = _tag(page, 51044)
    if fraction is not None:
        above, below = (float(part) for part in np.ravel(fraction)[:2]) if np.size(fraction) > 1 else (float(fraction), 1.0)
        if above > 0.0 and below > 0.0:
            rates["FrameRate"] = above / below
    if file.is_ome:
        step = _ome_interval(ome_pixels(file.ome_metadata))
        rates |= {} if step is None else {"OME": 1.0 / step}
    return rates


def ome_pixels(text: str | None) -> Any:
    """Return the element of OME's description that describes the first images; None without one."""
    try:
        root = ElementTree.fromstring(text or "")
    except ElementTree.ParseError:
        return None
    return next((element for element in root.iter() if element.tag.rpartition("}")[2] == "Pixels"), None)


def _ome_interval(pixels: Any) -> float | None:
    """Return OME's time step [s]: TimeIncrement, otherwise the even spacing of DeltaT of the planes of the first channel."""
    if pixels is None:
        return None
    step = _positive(_float(pixels.get("TimeIncrement")))
    unit = seconds_in(pixels.get("TimeIncrementUnit", "s"))
    if step is not None:
        return None if unit is None else step * unit
    times: dict[int, float] = {}
    for plane in pixels:
        if plane.tag.rpartition("}")[2] == "Plane" and plane.get("TheC", "0") == "0" and plane.get("TheZ", "0") == "0":
            moment, scale = _float(plane.get("DeltaT")), seconds_in(plane.get("DeltaTUnit", "s"))
            if moment is not None and scale is not None:
                times[int(plane.get("TheT", "0"))] = moment * scale
    if len(times) < 2 or sorted(times) != list(range(len(times))):
        return None
    steps = np.diff([times[i] for i in range(len(times))])
    typical = float(np.median(steps))
    return typical if typical > 0.0 and bool(np.all(np.abs(steps - typical) < 0.01 * typical)) else None


def _one_line(lines: dict[str, tuple[float, float]], source: str) -> tuple[float, float]:
    """Return the only scale and offset.

    Raises
    ------
    DataError
        Two that differ, or a scale that is no number other than 0.
    """
    if not lines:
        return 1.0, 0.0
    if len(set(lines.values())) > 1:
        listed = " and ".join(f"{where} with {scale:g} and {zero:g}" for where, (scale, zero) in lines.items())
        raise DataError(f"{source}: scale and offset stand in two places that contradict each other, {listed}; leave one out")
    scale, zero = next(iter(lines.values()))
    if not (math.isfinite(scale) and math.isfinite(zero)) or scale == 0.0:
        raise DataError(f"{source}: its scale {scale:g} and offset {zero:g} give no values; correct them")
    return scale, zero


def _white(page: Any, source: str) -> float | None:
    """Return the largest number of a page whose white is zero (PhotometricInterpretation 0)."""
    if int(page.photometric) != _MINISWHITE:
        return None
    dtype = np.dtype(page.dtype)
    if dtype.kind == "b" or dtype.kind == "u":
        return float(2 ** int(np.ravel(page.bitspersample)[0]) - 1)
    if dtype.kind == "i":
        return -1.0
    raise DataError(f"{source}: white is zero in floats, whose white is not known; write it with black as zero (MinIsBlack)")


def _limit(file: Any, page: Any) -> float | None:
    """Return full scale: a white level (DNG), or by OME's significant bits or the bits of a number."""
    white = _tag(page, 50717)
    if white is not None:
        return float(np.ravel(white)[0])
    if np.dtype(page.dtype).kind != "u":
        return None
    bits = int(np.ravel(page.bitspersample)[0])
    pixels = ome_pixels(file.ome_metadata) if file.is_ome else None
    significant = "" if pixels is None else pixels.get("SignificantBits", "")
    return float(2 ** (min(int(significant), bits) if significant.isdecimal() and int(significant) else bits) - 1)


def _curves(page: Any) -> tuple[str, ...]:
    there = [name for code, name in _UNUSED.items() if _tag(page, code) is not None]
    notes = [f"the tag {name} is not applied: values are the stored numbers" for name in there]
    black = _tag(page, 50714)
    if black is not None and np.any(np.asarray(black, dtype=np.float64) != 0.0):
        notes.append(f"a black level of {float(np.ravel(black)[0]):g} (DNG) is not subtracted")
    return tuple(notes)


def _tag(page: Any, code: int) -> Any:
    tag = page.tags.get(code)
    return None if tag is None else tag.value


def _own(text: Any) -> JsonObject | None:
    """Return our own metadata; None for any other text."""
    try:
        table = json.loads(text)
    except (TypeError, ValueError):
        return None
    return table if isinstance(table, dict) and {"variable", "attributes"} <= set(table) and isinstance(table["attributes"], dict) else None


def _words(value: Any) -> str | None:
    return str(value) if value else None


def _float(text: str | None) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) else None


def _positive(value: Any) -> float | None:
    number = _number(value)
    return number if number is not None and number > 0.0 else None


@dataclass(frozen=True)
class _StackFrames:
    """Pages that are frames, or one page that holds a whole stack."""

    keys: tuple[int, ...]
    stack: AxisOrder | None = None
    channel: int | None = None
    notes: tuple[str, ...] = ()
    count: int = 0


def open_tiff(path: Path, channel: str | None) -> PictureFile:
    """Look at a TIFF: its frames, their size and type, and the facts about them.

    Raises
    ------
    DataError
        Pages that are no images of one size, channels none of which is chosen, or numbers that are no measure of radiance.
    """
    tifffile = optional("tifffile", f"{path}: TIFF")

    try:
        with _silent() as messages, tifffile.TiffFile(path) as file:
            whole = next((kind for kind in _STACKED if getattr(file, kind, False)), None) is not None
            shaped = file.is_shaped and len(file.series) == 1 and len(file.series[0].axes.replace("S", "")) > 3
            frames = _of_series(file, path, channel) if whole or shaped else _of_pages(file, path)
            _require_whole(file, path, frames)
            if any(text in message for message in messages.texts for text in _BEYOND_THE_END):
                raise DataError(f"{path}: points to pages or tags beyond its end; the file is cut: copy it again")
            page = file.pages[frames.keys[0]].keyframe  # further pages of a stack have no tags of their own
            return _picture_file(path, page, frames, TiffFacts.of(file, page, str(path)), channel)
    except DataError:
        raise
    except Exception as error:
        raise DataError(f"{path}: cannot be read as TIFF ({first_line(error)}); write it again") from error


def _require_whole(file: Any, path: Path, frames: _StackFrames) -> None:
    """Refuse a file of fewer images than its description names: tifffile reads a file that is cut as if it were whole."""
    page = file.pages[0]
    named = 1
    if file.is_imagej:
        named = int((file.imagej_metadata or {}).get("images", 1))
    elif file.is_ome:
        pixels = ome_pixels(file.ome_metadata)
        sizes = [1 if pixels is None else int(pixels.get(name, "1")) for name in ("SizeT", "SizeC", "SizeZ")]
        named = int(np.prod(sizes)) // int(page.samplesperpixel if sizes[1] % int(page.samplesperpixel) == 0 else 1)
    elif file.is_shaped:
        shape = _shape_of(page.description)
        named = int(np.prod(shape)) // max(int(np.prod(page.shape)), 1) if shape else 1
    if frames.stack is not None:
        there = (path.stat().st_size - int(file.series[0].dataoffset)) // max(int(page.nbytes), 1)
    else:
        there = len(file.pages)
    if there < named:
        raise DataError(f"{path}: its description names {named} images, {there} are there; the file is cut: copy it again")


def _shape_of(description: str) -> tuple[int, ...]:
    """Return the shape that tifffile's own description states, empty for any other."""
    try:
        return tuple(int(size) for size in json.loads(description)["shape"])
    except (ValueError, TypeError, KeyError):
        return ()


class _Messages(logging.Filter):
    """Messages of tifffile, recorded and not printed: important ones become errors or notes."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []

    def filter(self, record: logging.LogRecord) -> bool:
        """Record a message, and print none."""
        self.texts.append(record.getMessage())
        return False


@contextmanager
def _silent() -> Iterator[_Messages]:
    """Record tifffile's messages for the caller instead of printing them."""
    logger, messages = logging.getLogger("tifffile"), _Messages()
    logger.addFilter(messages)
    try:
        yield messages
    finally:
        logger.removeFilter(messages)


def _of_pages(file: Any, path: Path) -> _StackFrames:
    """Return the pages that are frames: neither reduced versions of others nor masks, and of one size."""
    keys: list[int] = []
    reduced = masks = 0
    sizes: dict[tuple[int, ...], int] = {}
    first: Any = None
    for i, page in enumerate(file.pages):
        tags = page.tags
        kind, old = tags.get(254), tags.get(255)
        kind_bits = 0 if kind is None else int(kind.value)
        if kind_bits & _MASK or int(page.photometric) == _MASK_PICTURE:
            masks += 1
            continue
        if kind_bits & _REDUCED or (old is not None and int(old.value) == _OLD_REDUCED):
            reduced += 1
            continue
        first = page if first is None else first
        sizes[tuple(page.shape)] = sizes.get(tuple(page.shape), 0) + 1
        _require_alike(page, first, i, path)
        keys.append(i)
    if not keys and not reduced + masks:
        raise DataError(f"{path}: holds no page; the file is cut: copy it again")
    if not keys:
        raise DataError(f"{path}: all of its {reduced + masks} pages are masks or reduced versions of others; give the file of the images")
    if len(sizes) > 1:
        listed = ", ".join(f"{count} of {' x '.join(map(str, size))}" for size, count in sizes.items())
        raise DataError(f"{path}: holds pages of several sizes ({listed}), and nothing says which are frames; write frames of one size")
    notes = []
    # Pyramids and masks are additional pages of one image, not frames.
    if reduced:
        notes.append(f"{reduced} page{'s' * (reduced != 1)} with a reduced version of another (NewSubfileType) left out")
    if masks:
        notes.append(f"{masks} page{'s' * (masks != 1)} with a mask (NewSubfileType) left out")
    return _StackFrames(tuple(keys), notes=tuple(notes))


def _require_alike(page: Any, first: Any, index: int, path: Path) -> None:
    """Refuse a page whose numbers have another meaning than in the first page."""
    if page is first or tuple(page.shape) != tuple(first.shape):
        return
    if page.dtype != first.dtype or page.photometric != first.photometric or page.bitspersample != first.bitspersample:
        raise DataError(
            f"{path}: page {index + 1} holds {page.dtype} ({page.photometric.name.lower()}), the first frame {first.dtype} "
            f"({first.photometric.name.lower()}), which have no common scale; write all pages alike"
        )
    for code, name in ((42112, "GDAL's metadata"), (42113, "GDAL_NODATA"), (274, "Orientation")):
        ours, theirs = page.tags.get(code), first.tags.get(code)
        # A tag of the first page alone holds for all: many programs write it once.
        if ours is not None and (theirs is None or ours.value != theirs.value):
            raise DataError(f"{path}: page {index + 1} has another {name} than the first frame; write all pages alike")


def _of_series(file: Any, path: Path, channel: str | None) -> _StackFrames:
    """Return the pages of a stack whose axes the file names."""
    series = file.series[0]
    page = series.keyframe
    axes, shape = str(series.axes), tuple(int(n) for n in series.shape)
    within = len(page.axes)
    lead, sizes = axes[: len(axes) - within], shape[: len(axes) - within]
    if axes[len(lead) :] != page.axes:
        raise DataError(f"{path}: holds a stack of axes {axes} in pages of {page.axes}; write a page for each image")
    longer = [letter for letter, size in zip(lead, sizes, strict=True) if size > 1]
    time = next((letter for letter in _TIMES if letter in longer), None)
    others = [letter for letter in longer if letter != time]
    if longer.count(str(time)) > 1:
        sizes_of = " x ".join(str(n) for n in sizes if n > 1)
        raise DataError(f"{path}: holds a stack of {sizes_of} images whose axes have no names; name them, e.g. metadata={{'axes': 'TCYX'}}")
    if len(others) > 1:
        listed = ", ".join(f"{shape[axes.index(letter)]} along {letter}" for letter in longer)
        raise DataError(f"{path}: holds a stack of {listed} ({axes}); write one with frames and channels alone")
    index = None
    notes: list[str] = []
    if others:
        count = shape[axes.index(others[0])]
        index = channel_index(count, channel, path)
        notes.append(f"channel {index + 1} of {count}")
    if time == "Z":
        notes.append(f"{shape[axes.index('Z')]} slices of a stack taken as frames")
    if len(file.series) > 1:
        notes.append(f"the first of {len(file.series)} series of images is read")
    count = int(np.prod(sizes)) if sizes else 1
    if len(series.pages) < count:
        if len(series.pages) != 1 or series.dataoffset is None:
            raise DataError(f"{path}: its description names {count} images, {len(series.pages)} are there; the file is cut")
        letters = "".join("t" if a == time else "c" if a in others else "1" for a in lead)
        order = AxisOrder(letters + page.axes.lower().replace("s", "c"), guessed=False)
        return _StackFrames((int(page.index),), order, index, tuple(notes), shape[axes.index(time)] if time else 1)
    numbers: NDArray[Any] = np.arange(count).reshape(sizes)
    numbers = numbers[tuple(slice(None) if a == time else index if a in others else 0 for a in lead)]
    pages = [series.pages[int(i)] for i in np.ravel(numbers)]
    if any(p is None for p in pages):
        raise DataError(f"{path}: some images of its description are missing or in other files; give one file that holds all")
    return _StackFrames(tuple(int(p.index) for p in pages), notes=tuple(notes))


def _picture_file(path: Path, page: Any, frames: _StackFrames, facts: TiffFacts, channel: str | None) -> PictureFile:
    """Return the frames of a file, with one channel or colours."""
    dtype, kind = np.dtype(page.dtype), int(page.photometric)
    if kind in _REFUSED:
        raise DataError(f"{path}: holds {_REFUSED[kind]}, which are no measure of radiance; give the grey original")
    if dtype.kind not in "uifb":
        raise DataError(f"{path}: holds {dtype}, not real numbers; give radiances or counts")
    axes = str(page.axes)
    if axes not in ("YX", "YXS", "SYX"):
        raise DataError(f"{path}: holds pages of shape {tuple(page.shape)} and axes {axes}; give pages of grey or RGB(A) images")
    size = dict(zip(axes, (int(n) for n in page.shape), strict=True))
    samples = size.get("S", 1)
    coloured = kind in (_RGB, _YCBCR) and samples in (3, 4)
    alpha = samples == 2 and int(np.ravel(page.extrasamples)[0] if len(page.extrasamples) else 0) in (1, 2)
    one = None if coloured or alpha or samples == 1 else channel_index(samples, channel, path)
    notes = list(frames.notes)
    if one is not None:
        notes.append(f"channel {one + 1} of {samples}")
    if int(page.compression) in _LOSSY:
        notes.append(f"compression {page.compression.name} may be lossy: tails and correlations of the noise may be changed")
    palette = _palette(page) if kind == _PALETTE else None
    orientation = page.tags.get(274)
    # Orientation 1 is the usual one and is not in the table.
    turn = _TURNS.get(1 if orientation is None else int(orientation.value))
    if turn is not None:
        notes.append(f"pictures are turned by the file's Orientation {int(orientation.value)}")
    stored = _reader(path, frames, tuple(int(n) for n in page.shape))

    def read(start: int, stop: int) -> NDArray[Any]:
        block = stored(start, stop)
        if axes == "SYX" and frames.stack is None:
            block = np.moveaxis(block, 1, -1)
        if one is not None:
            block = block[..., one]
        if palette is not None:
            block = np.moveaxis(palette[:, block], 0, -1)
        return block if turn is None else turn(block)

    facts = facts.of_channel(one if one is not None else frames.channel)
    rows, columns = (size["X"], size["Y"]) if turn is not None and int(orientation.value) >= 5 else (size["Y"], size["X"])
    return PictureFile(
        path, frames.count or len(frames.keys), rows, columns, dtype if palette is None else palette.dtype, read,
        colours=3 if palette is not None else samples if coloured or alpha else 0,
        frame_rate=facts.frame_rate, units=facts.units, decoding=facts.decoding,
        saturation=facts.full_scale if palette is None else float(np.iinfo(palette.dtype).max),
        notes=(*notes, *facts.notes),
    )  # fmt: skip


def _palette(page: Any) -> NDArray[Any] | None:
    """Return the colours of a palette, shape (3, entries); of 8 bits where they are no finer."""
    colours = None if page.colormap is None else np.asarray(page.colormap)
    return (colours // 257).astype(np.uint8) if colours is not None and not np.any(colours % 257) else colours


def _reader(path: Path, frames: _StackFrames, shape: tuple[int, ...]) -> Callable[[int, int], NDArray[Any]]:
    """Return a function that reads frames as stored."""
    import tifffile

    def read(start: int, stop: int) -> NDArray[Any]:
        keys = frames.keys[start:stop]
        try:
            with _silent():
                if frames.stack is not None:
                    # A stack of one page that a header calls many is mapped, and unmapped when the block is copied.
                    return np.asarray(Ordered(tifffile.memmap(path, mode="r"), frames.stack, frames.channel)[start:stop])
                step = keys[1] - keys[0] if len(keys) > 1 else 1
                even = keys == tuple(range(keys[0], keys[-1] + 1, max(step, 1)))
                block = tifffile.imread(path, key=range(keys[0], keys[-1] + 1, step) if even else list(keys))
        except Exception as error:
            text = first_line(error)
            if "imagecodecs" in text:
                optional("imagecodecs", f"{path}: its compression or packing")
            raise DataError(f"{path}: frames {start}:{stop} cannot be decoded ({text}); the file is cut") from error
        return np.asarray(block).reshape(stop - start, *shape)

    return read
