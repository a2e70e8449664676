"""Values as files store them: full scale, and one channel of colour images."""

from __future__ import annotations

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
    """Return true where channels vary together: apart from a level of their own they differ by rounding, or by little of what they vary."""
    step = 1.0 if colours.dtype.kind in "iu" else 0.0
    first = colours[..., 0].astype(np.float64)
    largest = max(ALIKE * float(np.nanstd(first)), step)
    return all(float(np.nanstd(colours[..., i] - first)) <= largest for i in range(1, colours.shape[-1]))


def full_scale(dtype: np.dtype[Any]) -> float | None:
    """Return the largest value of an integer type; None for floats."""
    return float(np.iinfo(dtype).max) if np.issubdtype(dtype, np.integer) else None


def colour_notes(stored: NDArray[Any], channel: str | None) -> tuple[str, ...]:
    """Return notes on the first picture of several channels: which is read, whether they are averaged, and alpha that is ignored."""
    opaque = np.iinfo(stored.dtype).max if stored.dtype.kind in "iu" else 1
    unseen = stored.shape[-1] in (2, 4) and bool(np.any(stored[..., -1] != opaque))
    alpha = ("alpha, which is not full everywhere, is ignored: values are the stored numbers",) if unseen else ()
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
