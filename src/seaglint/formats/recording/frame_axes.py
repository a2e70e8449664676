"""Axes of an array of images, and frame rates that files state.

The order of frames, rows, columns and channels is stated by the user, or follows from names or sizes of the axes. Frame rates follow from
attributes or from evenly spaced times, in their units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes

LETTERS: Final = "tyxc"  #: Letters of the axes: frames (times), rows, columns, channels.

#: Names of dimensions by letter, in lower case.
_NAMES: Final = {
    "t": ("t", "time", "times", "valid_time", "frame", "frames", "frame_number", "image", "images", "n_frames"),
    "y": ("y", "row", "rows", "line", "lines", "lat", "latitude", "height", "ny", "y_pixel", "yc", "north", "northing", "south_north"),
    "x": ("x", "col", "cols", "column", "columns", "sample", "samples", "lon", "longitude", "width", "nx", "x_pixel", "xc", "east",
          "easting", "west_east", "pixel"),
    "c": ("c", "channel", "channels", "band", "bands", "wavelength", "wavelengths", "filter", "s",
          "color", "colour", "colors", "colours", "rgb", "rgba"),
}  # fmt: skip

#: Names of dimensions whose channels are red, green and blue.
COLOUR_NAMES: Final = ("rgb", "rgba", "color", "colour", "colors", "colours")

MOST_COLOURS: Final = 4  #: Largest number of channels of a colour picture: red, green, blue and alpha.


@dataclass(frozen=True)
class AxisOrder:
    """Order of an array's axes."""

    letters: str  #: A letter of ``LETTERS`` for each axis; ``1`` for an axis of length one that is left out.
    guessed: bool  #: True where it follows from the sizes alone.

    def size(self, shape: Sequence[int], letter: str) -> int:
        """Return the length of an axis; 1 for one that is not there."""
        return int(shape[self.letters.index(letter)]) if letter in self.letters else 1


def letter_of(name: str) -> str | None:
    """Return the letter of a dimension by its name; None for an unknown one.

    >>> letter_of("Time"), letter_of("lat"), letter_of("realization")
    ('t', 'y', None)
    """
    plain = name.rpartition("/")[2].strip().lower()
    return next((letter for letter, known in _NAMES.items() if plain in known), None)


def require_axes(axes: str) -> None:
    """Refuse an order that is none.

    Raises
    ------
    DataError
        Unknown or repeated letters, or no rows and columns.
    """
    if not axes or set(axes) - set(LETTERS) or len(set(axes)) < len(axes) or not {"x", "y"} <= set(axes):
        raise DataError(
            f"axes = {axes!r}; allowed are the letters t (frames), y (rows), x (columns) and c (channels) in the order of the array, each "
            "once, y and x always: tyx (time first), yxt (time last), txy (a MATLAB array written by h5write), tyxc, tcyx"
        )


def layout_of(shape: Sequence[int], source: str, axes: str | None, names: Sequence[str] | None = None, default: str = "tyx") -> AxisOrder:
    """Return the order of an array's axes: as stated, by the names of its dimensions, or the usual one for its sizes.

    Parameters
    ----------
    shape : sequence of int
        Lengths of the axes.
    source : str
        For messages.
    axes : str or None
        Stated order, of all axes or of those that are longer than one.
    names : sequence of str, optional
        Names of the dimensions.
    default : str
        Order of three axes without other information.

    Raises
    ------
    DataError
        An order that does not fit the shape, or a shape that no order fits.
    """
    if 0 in shape:
        raise DataError(f"{source}: has shape {tuple(shape)}, and so no values; give (rows, columns) or (frames, rows, columns)")
    if axes is not None:
        return AxisOrder(_fitted(shape, source, axes), guessed=False)
    letters = _of_names(names, shape) if names else None
    if letters is not None:
        return AxisOrder(letters, guessed=False)
    return AxisOrder(_usual(tuple(shape), source, default), guessed=True)


def _fitted(shape: Sequence[int], source: str, axes: str) -> str:
    require_axes(axes)
    if len(axes) == len(shape):
        return axes
    longer = [i for i, size in enumerate(shape) if size > 1]
    if len(axes) == len(longer):
        letters = dict(zip(longer, axes, strict=True))
        return "".join(letters.get(i, "1") for i in range(len(shape)))
    raise DataError(f"{source}: has shape {tuple(shape)}, and axes = '{axes}' has {len(axes)} letters; give {len(shape)}")


def _of_names(names: Sequence[str], shape: Sequence[int]) -> str | None:
    """Return the order of the axes by their names; None unless all axes longer than one have known names."""
    letters = []
    for name, size in zip(names, shape, strict=True):
        letter = letter_of(str(name))
        if letter is None:
            if size > 1:
                return None
            letter = "1"
        letters.append(letter)
    used = [letter for letter in letters if letter != "1"]
    return "".join(letters) if len(set(used)) == len(used) and {"y", "x"} <= set(used) else None


def _usual(shape: tuple[int, ...], source: str, default: str) -> str:
    """Return the usual order of a shape: channels last if there are few, frames first."""
    count = len(shape)
    # A last axis of one is a channel, not a column.
    if count == 3 and shape[2] == 1 and shape[0] > 1 and shape[1] > 1:
        return "yx1"
    letters = ["?"] * count
    if count > 3:
        letters = ["1" if size == 1 else "?" for size in shape]
        if letters.count("?") < 2:  # a picture of one row or column
            letters = ["1"] * (count - 2) + ["?", "?"]
    open_axes = [i for i, letter in enumerate(letters) if letter == "?"]
    order = _order([shape[i] for i in open_axes], default)
    if order is None:
        raise DataError(
            f"{source}: has shape {shape}; give (rows, columns) or (frames, rows, columns), or the order of its axes: axes = 'tcyx' for "
            "frames, channels, rows, columns"
        )
    for i, letter in zip(open_axes, order, strict=True):
        letters[i] = letter
    return "".join(letters)


def _order(sizes: list[int], default: str) -> str | None:
    match len(sizes):
        case 2:
            return "yx"
        case 3:
            return "yxc" if default == "tyx" and sizes[2] in (3, MOST_COLOURS) and sizes[0] > MOST_COLOURS else default
        case 4:
            time_last = default == "yxt"
            if sizes[3 if not time_last else 2] <= MOST_COLOURS:
                return "yxct" if time_last else "tyxc"
            return "tcyx" if sizes[1] <= MOST_COLOURS and not time_last else None
        case _:
            return None


class Ordered:
    """Array whose slices along its frames have the shape (frames, rows, columns) or (frames, rows, columns, channels).

    Parameters
    ----------
    array
        Anything with ``shape``, ``dtype`` and slices.
    layout : AxisOrder
        Order of its axes.
    channel : int, optional
        Index of the channel that is read; by default all are.
    """

    def __init__(self, array: Any, layout: AxisOrder, channel: int | None = None) -> None:
        self._array, self._layout, self._channel, self.dtype = array, layout, channel, array.dtype

    def __getitem__(self, key: slice) -> NDArray[Any]:
        index: list[Any] = []
        remaining = ""
        for letter in self._layout.letters:
            if letter == "1":
                index.append(0)
            elif letter == "c" and self._channel is not None:
                index.append(self._channel)
            else:
                index.append(key if letter == "t" else slice(None))
                remaining += letter
        block = np.asarray(self._array[tuple(index)])
        order = [letter for letter in LETTERS if letter in remaining]
        if remaining != "".join(order):
            block = block.transpose([remaining.index(letter) for letter in order])
        return block if "t" in remaining else block[np.newaxis]


#: Seconds in a unit of time, by its spellings in lower case; the escaped one is how ImageJ writes a micro sign.
SECONDS: Final = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "msecs", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "usec", "µs", "μs", "µsec", "\\u00b5s", "microsecond", "microseconds"), 1e-6),
    **dict.fromkeys(("ns", "nsec", "nanosecond", "nanoseconds"), 1e-9),
    **dict.fromkeys(("min", "mins", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hrs", "hour", "hours"), 3600.0),
    **dict.fromkeys(("d", "day", "days"), 86400.0),
}

RATE_NAMES: Final = ("frame_rate", "frame_rate_hz", "fps")  #: Names of a frame rate in attributes, and of arrays that hold one number.

SAME: Final = 1e-3  #: Relative difference below which two rates or steps are one.


def seconds_in(unit: object) -> float | None:
    """Return the seconds in a unit, alone or in front of "since ..."; None where it is none of time.

    >>> seconds_in("ms"), seconds_in("seconds since 2024-01-01"), seconds_in("frames")
    (0.001, 1.0, None)
    """
    words = str(unit).split()
    return SECONDS.get(words[0].lower()) if words else None


def frame_rate_of(attributes: Attributes) -> float | None:
    """Return the frame rate [Hz] that attributes state."""
    for name in RATE_NAMES:
        value = attributes.get(name)
        if value is not None:
            try:
                rate = float(np.ravel(value)[0])
            except (TypeError, ValueError, IndexError):
                continue
            if np.isfinite(rate) and rate > 0.0:
                return rate
    return None


def rate_of_times(times: NDArray[Any], attributes: Mapping[Any, Any]) -> tuple[float | None, str | None]:
    """Return the frame rate [Hz] of a time coordinate, and a sentence where it gives none.

    Times that are whole numbers may be rounded: they are even where rounding explains the differences of their steps.
    """
    if times.ndim != 1 or times.size < 2:
        return None, None
    if times.dtype.kind in "Mm":
        seconds, unit, whole = (times - times[0]) / np.timedelta64(1, "ns"), 1e-9, False
    else:
        if times.dtype.kind not in "uif":
            return None, None
        stated = attributes.get("units")
        unit_seconds = None if stated is None else seconds_in(stated.decode() if isinstance(stated, bytes) else stated)
        if unit_seconds is None:
            if stated is None:
                return None, "times have no units: they give no frame rate; give --frame-rate"
            return None, f"times are in {stated}, which is no unit of time that is read; give --frame-rate"
        # Times may be packed as images are.
        unit = unit_seconds * float(np.ravel(attributes.get("scale_factor", 1.0))[0])
        seconds, whole = times.astype(np.float64), bool(np.all(times == np.round(times)))
    steps = unit * np.diff(seconds)
    mean = float(np.mean(steps))
    if not mean > 0.0:
        return None, "times do not rise: they give no frame rate; give --frame-rate"
    if float(np.max(np.abs(steps - mean))) > max(SAME * mean, 1.001 * (unit if whole else 0.0)):
        apart = f"frames are {1e3 * steps.min():.4g} to {1e3 * steps.max():.4g} ms apart"
        return None, f"{apart}: they have no one frame rate; give --frame-rate"
    return 1.0 / mean, None


def one_rate(rates: Mapping[str, float]) -> tuple[float | None, tuple[str, ...]]:
    """Return the only rate [Hz] of several sources, or none and a note where they contradict each other."""
    values = list(rates.values())
    if not values or max(values) / min(values) - 1.0 < SAME:
        return (values[0] if values else None), ()
    listed = ", ".join(f"{rate:g} Hz of {source}" for source, rate in rates.items())
    return None, (f"frame rates contradict each other ({listed}): none is taken; give --frame-rate",)
