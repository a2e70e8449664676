"""Values of the numbers that files of images store: missing values, valid range, scale and offset, white as zero, channels of colours."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

#: Largest difference between colour channels that still counts as grey (rounding, recompression), as a share of full scale.
NEARLY_GREY: Final = 0.02

#: Largest deviation of the difference between colour channels that still counts as grey, as a share of that of the picture.
ALIKE: Final = 0.1

CHANNELS: Final = ("mean", "red", "green", "blue")  #: Names of the ways to make one image of colour channels.


class SeveralChannelsError(DataError):
    """Images have several channels, none of which was chosen."""


def require_channel(channel: str) -> None:
    """Refuse a channel that is neither a colour nor a number from 1.

    Raises
    ------
    DataError
        Any other word.
    """
    if channel not in CHANNELS and not (channel.isdecimal() and int(channel) >= 1):
        raise DataError(f"channel = {channel!r}; allowed are {', '.join(CHANNELS)}, or the number of a channel from 1")


def _alike(colours: NDArray[Any]) -> bool:
    """Return true where channels vary together: apart from a constant they differ by rounding, or by a small part of their variation."""
    step = 1.0 if colours.dtype.kind in "iu" else 0.0
    # A constant difference is a level, not a colour: its deviation counts.
    first = colours[..., 0].astype(np.float64)
    largest = max(ALIKE * float(np.nanstd(first)), step)
    return all(float(np.nanstd(colours[..., i] - first)) <= largest for i in range(1, colours.shape[-1]))


def full_scale(dtype: np.dtype[Any]) -> float | None:
    """Return the largest value of an integer type; None for floats."""
    return float(np.iinfo(dtype).max) if np.issubdtype(dtype, np.integer) else None


def colour_notes(stored: NDArray[Any], channel: str | None) -> tuple[str, ...]:
    """Return notes on the first picture of several channels: which is read, whether they are averaged, and alpha that is ignored."""
    opaque = np.iinfo(stored.dtype).max if stored.dtype.kind in "iu" else 1
    transparent = stored.shape[-1] in (2, 4) and bool(np.any(stored[..., -1] != opaque))
    alpha = ("alpha, which is not full everywhere, is ignored: values are the stored numbers",) if transparent else ()
    if channel is not None:
        return (f"colour image, channel {channel}", *alpha)
    averaged = stored.shape[-1] > 2 and bool(np.ptp(stored[..., :3], axis=-1).any())
    return (*(("nearly equal colour channels, averaged",) if averaged else ()), *alpha)


def grey(images: NDArray[Any], source: str, channel: str | None = None) -> NDArray[Any]:
    """Return one channel of images whose last axis is grey+alpha, RGB or RGBA; images without that axis are unchanged.

    Raises
    ------
    DataError
        The channels differ and no ``channel`` was chosen.
    """
    count = images.shape[-1]
    if channel is not None and channel.isdecimal():
        if not 1 <= int(channel) <= count:
            raise DataError(f"{source}: has {count} channels; channel = {channel} is none of them, give 1 to {count}")
        return np.asarray(images[..., int(channel) - 1])
    if count in (1, 2):
        return images[..., 0]
    colours = images[..., :3]
    if channel is not None and channel != "mean":
        return np.asarray(colours[..., CHANNELS.index(channel) - 1])
    scale = full_scale(images.dtype) or float(np.nanmax(np.abs(colours))) or 1.0
    span = colours.max(axis=-1).astype(np.float64) - colours.min(axis=-1)
    worst = float(np.nanmax(span)) / scale
    if channel is None and (worst > NEARLY_GREY or not _alike(colours)):
        allowed = f"grey allows {100 * NEARLY_GREY:g} %" if worst > NEARLY_GREY else "more than a tenth of what the picture varies"
        raise DataError(
            f"{source}: is a true colour image (channels differ by up to {100 * worst:.3g} % of full scale, {allowed}); false colours "
            "are no measure of radiance: give the grey original, or choose a channel: "
            f"{', '.join(CHANNELS)}"
        )
    if not span.any():
        return np.asarray(colours[..., 0])
    return np.asarray(colours.mean(axis=-1, dtype=np.float64))


#: Values that the NetCDF library writes where nothing was written (``netcdf.h``, NC_FILL_*); it has none for bytes.
DEFAULT_FILLS: Final = {
    "f4": 9.9692099683868690e36, "f8": 9.9692099683868690e36, "i2": -32767, "i4": -2147483647, "i8": -9223372036854775806,
}  # fmt: skip

_COUNTS: Final = ("count", "counts", "dn", "adu", "digital number", "digital numbers")  #: Units of stored numbers.

_SCALES: Final = ("scale", "slope", "gain")
#: Names that other programs give to a scale or an offset, in lower case; CF, which HDF5, NetCDF and Zarr share, has others.
_OFFSETS: Final = ("offset", "intercept", "bias")


@dataclass(frozen=True)
class Decoding:
    """Relation of stored numbers to values.

    A stored number that is missing or outside the valid range has no value; otherwise ``value = offset + scale * n``, where ``n`` is the
    number, or ``white - number`` where white is zero.
    """

    missing: tuple[float, ...] = ()  #: Stored numbers without a value.
    low: float | None = None  #: Lowest valid stored number.
    high: float | None = None  #: Highest valid stored number.
    scale: float = 1.0  #: Slope of the line of the values.
    offset: float = 0.0  #: Value of the number 0.
    white: float | None = None  #: Largest number of a picture whose white is zero.
    unsigned: np.dtype[Any] | None = None  #: Type of the numbers where the file's own type has the wrong sign.

    @property
    def masks(self) -> bool:
        """True where some numbers may have no value."""
        return bool(self.missing) or self.low is not None or self.high is not None

    @property
    def straight(self) -> bool:
        """True where the values are the numbers."""
        return self.scale == 1.0 and self.offset == 0.0 and self.white is None

    @property
    def plain(self) -> bool:
        """True where the stored numbers are the values and all have one."""
        return self.straight and not self.masks and self.unsigned is None

    def dtype(self, stored: np.dtype[Any]) -> np.dtype[Any]:
        """Return the type of the values of numbers of a type."""
        kind = stored if self.unsigned is None else self.unsigned
        if self.straight and not self.masks:
            return kind
        narrow = kind.itemsize <= 2 or kind == np.float32
        return np.dtype(np.float32 if narrow and self.scale == 1.0 and self.offset == 0.0 else np.float64)

    def values(self, stored: NDArray[Any]) -> NDArray[Any]:
        """Return the values of stored numbers; NaN for a missing value."""
        if self.unsigned is not None:
            stored = np.ascontiguousarray(stored).view(self.unsigned)
        if self.straight and not self.masks:
            return stored
        values = stored.astype(self.dtype(stored.dtype))
        # In place, in the order of the relation: an array of a whole sequence is not copied for each step.
        if self.white is not None:
            np.subtract(self.white, values, out=values)
        if self.scale != 1.0:
            values *= self.scale
        if self.offset != 0.0:
            values += self.offset
        if self.masks:
            values[self._absent(stored)] = np.nan
        return values

    def with_missing(self, numbers: Iterable[float], stored: np.dtype[Any]) -> Decoding:
        """Return the decoding with further numbers without a value, as far as the type of the stored numbers can hold them."""
        return replace(self, missing=tuple(dict.fromkeys((*self.missing, *in_type(numbers, stored)))))

    def _absent(self, stored: NDArray[Any]) -> NDArray[np.bool_]:
        absent = np.zeros(stored.shape, dtype=np.bool_)
        for number in self.missing:
            absent |= stored == number
        if self.low is not None:
            absent |= stored < self.low
        if self.high is not None:
            absent |= stored > self.high
        return absent

    @property
    def notes(self) -> tuple[str, ...]:
        """Return sentences for the user on masked, scaled or inverted numbers."""
        notes = []
        if self.missing:
            notes.append(f"stored values of {', '.join(f'{number:.9g}' for number in self.missing)} are missing values and are masked")
        if self.low is not None or self.high is not None:
            low, high = ("" if bound is None else f"{bound:.9g}" for bound in (self.low, self.high))
            outside = f"outside {low} to {high}" if low and high else f"below {low}" if low else f"above {high}"
            notes.append(f"stored values {outside}, the file's valid range, are masked")
        if self.white is not None:
            notes.append(f"white is zero in the file: values are {self.white:g} less the stored ones")
        if self.scale != 1.0 or self.offset != 0.0:
            notes.append(f"values are {self.offset:.9g} + {self.scale:.9g} x the stored ones")
        return tuple(notes)


PLAIN: Final = Decoding()  #: Stored numbers that are the values.


@dataclass(frozen=True, kw_only=True)
class ValueFacts:
    """Facts of a file about the values of its images."""

    frame_rate: float | None = None  #: Frames per second [Hz].
    units: str | None = None  #: Units of the values.
    decoding: Decoding = PLAIN  #: Relation of stored numbers to values.
    saturation: float | None = None  #: Value of full scale.
    notes: tuple[str, ...] = ()  #: Sentences for the user.


def in_type(numbers: Iterable[Any], dtype: np.dtype[Any]) -> tuple[float, ...]:
    """Return the numbers that a type can hold, each once and as the type rounds them; NaN needs no mask.

    >>> in_type([-9999.0, 1e20], np.dtype(np.int16))
    (-9999,)
    """
    held: dict[float, None] = {}
    for number in numbers:
        value = float(number)
        if np.isnan(value):
            continue
        if dtype.kind in "iu":
            if not (np.isfinite(value) and value == int(value) and np.iinfo(dtype).min <= int(value) <= np.iinfo(dtype).max):
                continue
            # A float cannot hold every integer of 64 bits: the number itself is taken where it is an integer.
            held[int(number) if isinstance(number, int | np.integer) else int(value)] = None
        elif dtype.kind == "f":
            with np.errstate(over="ignore"):
                held[float(dtype.type(value))] = None
    return tuple(held)


def of_attributes(attributes: Mapping[Any, Any], dtype: np.dtype[Any], source: str) -> tuple[Decoding, tuple[str, ...]]:
    """Return the decoding that CF attributes state, and notes on attributes of other names: with any, units do not hold.

    ``_FillValue``, ``missing_value``, ``valid_min``, ``valid_max``, ``valid_range``, ``scale_factor``, ``add_offset`` and ``_Unsigned``
    (CF conventions 1.11, sections 2.5.1 and 8.1; NetCDF users' guide, appendix A).

    Raises
    ------
    DataError
        An attribute that is no number, or two that contradict each other.
    """
    unsigned = _other_sign(attributes.get("_Unsigned"), dtype, source)
    kind = dtype if unsigned is None else unsigned
    signed = np.dtype(dtype.str)

    def as_stored(numbers: list[Any]) -> list[Any]:
        # The attributes of numbers whose sign is wrong have that sign too.
        if unsigned is None or kind.kind != "u":
            return numbers
        return [int(n) + int(np.iinfo(kind).max) + 1 if float(n) < 0.0 and float(n) >= np.iinfo(signed).min else n for n in numbers]

    missing = in_type(as_stored([*_numbers(attributes, "_FillValue", source), *_numbers(attributes, "missing_value", source)]), kind)
    scale, offset = _single(attributes, "scale_factor", 1.0, source), _single(attributes, "add_offset", 0.0, source)
    low, high = _valid_range(attributes, kind, scale, offset, source, as_stored)
    return Decoding(missing, low, high, scale, offset, unsigned=unsigned), _other_names(attributes, scale, offset, source)


def _other_sign(word: Any, dtype: np.dtype[Any], source: str) -> np.dtype[Any] | None:
    if word is None or dtype.kind not in "iu":
        return None
    text = (word.decode() if isinstance(word, bytes) else str(np.ravel(word)[0])).strip().lower()
    if text not in ("true", "false"):
        raise DataError(f"{source}: _Unsigned = '{text}'; allowed are true, false")
    kind = "u" if text == "true" else "i"
    return None if dtype.kind == kind else np.dtype(f"{dtype.byteorder if dtype.byteorder in '<>' else ''}{kind}{dtype.itemsize}")


def _numbers(attributes: Mapping[Any, Any], name: str, source: str) -> list[Any]:
    """Return the numbers of an attribute, with whole ones as integers: a double cannot hold all 64-bit ones."""
    given = attributes.get(name)
    if given is None:
        return []
    numbers: list[Any] = []
    for value in np.ravel(given).tolist():
        text = value.decode() if isinstance(value, bytes) else value
        try:
            numbers.append(text if isinstance(text, int | float) else float(text))
        except (TypeError, ValueError):
            raise DataError(f"{source}: {name} = {text!r} is no number; correct the attribute") from None
    return numbers


def _single(attributes: Mapping[Any, Any], name: str, default: float, source: str) -> float:
    numbers = _numbers(attributes, name, source)
    if not numbers:
        return default
    if len(set(numbers)) > 1:
        raise DataError(f"{source}: {name} has {len(numbers)} numbers; one for the whole array is read")
    value = float(numbers[0])
    if not np.isfinite(value) or (value == 0.0 and name == "scale_factor"):
        raise DataError(f"{source}: {name} = {value:g}; give a finite number" + (" other than 0" if name == "scale_factor" else ""))
    return value


def _valid_range(
    attributes: Mapping[Any, Any], kind: np.dtype[Any], scale: float, offset: float, source: str, as_stored: Any
) -> tuple[float | None, float | None]:
    """Return the valid range in stored numbers; floats beside packed integers are a range of the values (NetCDF users' guide)."""
    both = _numbers(attributes, "valid_range", source)
    ends = [_numbers(attributes, name, source) for name in ("valid_min", "valid_max")]
    if both and len(both) != 2:
        raise DataError(f"{source}: valid_range has {len(both)} numbers; it needs 2")
    if both and any(end and end[0] != both[i] for i, end in enumerate(ends)):
        raise DataError(f"{source}: valid_range and valid_min or valid_max contradict each other; leave one out")
    packed = scale != 1.0 or offset != 0.0
    low_high: list[float | None] = []
    for i, name in enumerate(("valid_min", "valid_max")):
        numbers = both[i : i + 1] or ends[i][:1]
        if not numbers or np.isnan(float(numbers[0])):
            low_high.append(None)
            continue
        given = np.asarray(attributes["valid_range" if both else name])
        number = float(numbers[0])
        of_values = packed and kind.kind in "iu" and given.dtype.kind == "f"
        low_high.append((number - offset) / scale if of_values else float(as_stored(numbers)[0]))
    low, high = low_high
    # A negative scale turns a range of values round.
    if scale < 0.0 and low is not None and high is not None and low > high:
        low, high = high, low
    # Checked after the turn: what is still empty cannot be satisfied.
    if low is not None and high is not None and low > high:
        raise DataError(f"{source}: the valid range {low:g} to {high:g} is empty; correct the attributes")
    # An end of the type's own range masks nothing.
    if kind.kind in "iu":
        low = None if low is not None and low <= np.iinfo(kind).min else low
        high = None if high is not None and high >= np.iinfo(kind).max else high
    return low, high


def _other_names(attributes: Mapping[Any, Any], scale: float, offset: float, source: str) -> tuple[str, ...]:
    """Refuse a second scale or offset that differs from the first; note one that CF does not know."""
    units = attributes.get("units")
    # A gain in addition to units of counts is the camera's: the stored numbers are in these units.
    counts = str(units.decode() if isinstance(units, bytes) else units).strip().lower() in _COUNTS
    lower = {str(name).lower(): (name, value) for name, value in attributes.items()}
    notes = []
    for own, value, names in (("scale_factor", scale, _SCALES), ("add_offset", offset, _OFFSETS)):
        for name in names:
            if name not in lower:
                continue
            given, other = lower[name]
            try:
                number = float(np.ravel(other)[0])
            except (TypeError, ValueError, IndexError):
                continue
            if own in attributes:
                if number != value:
                    raise DataError(
                        f"{source}: {own} = {value:g} and {given} = {number:g} contradict each other; leave one of the attributes out"
                    )
            elif not counts and number != (1.0 if own == "scale_factor" else 0.0):
                what = f"the attribute {given} = {number:g} is no CF name and is not applied"
                notes.append(f"{what}; values are the stored numbers, of unknown units; write it as {own}")
    return tuple(notes)


class Decoded:
    """Array whose stored numbers become values when it is sliced."""

    def __init__(self, stored: Any, decoding: Decoding) -> None:
        self._stored, self._decoding = stored, decoding
        self.shape, self.dtype = tuple(int(size) for size in stored.shape), decoding.dtype(np.dtype(stored.dtype))

    def __getitem__(self, key: Any) -> NDArray[Any]:
        return self._decoding.values(np.asarray(self._stored[key]))
