"""Facts that a TIFF states beside its pixels: rate, units, missing value and the line of its counts.

Read are our own words, ImageJ's, OME's, GDAL's (tags 42112 and 42113) and the frame rate of CinemaDNG (tag 51044).
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from typing import Any, Final
from xml.etree import ElementTree

import numpy as np

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.recording.decoding import PLAIN, Decoding, in_type
from seaglint.files.recording.frame_times import one_rate, seconds_in

_STRAIGHT: Final = 0
_UNCALIBRATED: Final = 20  #: ImageJ's numbers of a calibration by a straight line, and of none (``ij.measure.Calibration``).

_MINISWHITE: Final = 0
#: Tags of curves from numbers to light, which are not applied.
_UNUSED: Final = {291: "GrayResponseCurve", 301: "TransferFunction", 50712: "LinearizationTable"}


@dataclass(frozen=True)
class TiffFacts:
    """Frame rate [Hz], units, decoding of the numbers, full scale, and notes; None where the file does not say.

    ``bands`` are scale, offset and units of each channel by GDAL, which states them one by one; None where it states none.
    """

    frame_rate: float | None = None
    units: str | None = None
    decoding: Decoding = PLAIN
    bands: tuple[tuple[float, float, str | None], ...] | None = None
    full_scale: float | None = None
    notes: tuple[str, ...] = ()

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
        scaled = any(line[:2] != (1.0, 0.0) for line in bands)
        if scaled and lines:
            lines["GDAL's metadata"] = bands[0][:2]
        first, offset = _one_line(lines, source)
        rate, notes = one_rate(_rates(file, page, own, imagej))
        decoding = Decoding(in_type(blanks, np.dtype(page.dtype)), scale=first, offset=offset, white=_white(page, source))
        return cls(rate, units, decoding, bands if bands and not lines else None, _limit(file, page), (*notes, *_curves(page)))

    def of_channel(self, index: int | None) -> TiffFacts:
        """Return the facts of one channel, of the first where there is one; a channel without a line of GDAL's own has none."""
        if self.bands is None:
            return self
        place = 0 if index is None else index
        scale, zero, units = self.bands[place] if place < len(self.bands) else (1.0, 0.0, None)
        return replace(self, units=units or self.units, decoding=replace(self.decoding, scale=scale, offset=zero))

    @property
    def saturation(self) -> float | None:
        """Value of full scale; None where a line makes the values, since counts of an export end at the largest value."""
        return self.full_scale if self.decoding.scale == 1.0 and self.decoding.offset == 0.0 else None


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
    middle = float(np.median(steps))
    return middle if middle > 0.0 and bool(np.all(np.abs(steps - middle) < 0.01 * middle)) else None


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
    """Return full scale: a white level (DNG), that of OME's significant bits, or that of the bits of a number."""
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
    """Our own metadata, or None for any other text."""
    try:
        found = json.loads(text)
    except (TypeError, ValueError):
        return None
    return found if isinstance(found, dict) and {"variable", "attributes"} <= set(found) and isinstance(found["attributes"], dict) else None


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
