"""Values as files store them: full scale, and one channel of colour images."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

NEARLY_GREY: Final = 0.02
"""Largest difference between colour channels that still counts as grey (rounding, recompression), as a share of full scale."""

CHANNELS: Final = ("mean", "red", "green", "blue")
"""Names of the ways to make one image of colour channels."""


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


def full_scale(dtype: np.dtype[Any]) -> float | None:
    """Return the largest value of an integer type; None for floats."""
    return float(np.iinfo(dtype).max) if np.issubdtype(dtype, np.integer) else None


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
    if channel is None and worst > NEARLY_GREY:
        raise DataError(
            f"{source}: is a true colour image (channels differ by up to {100 * worst:.3g} % of full scale, grey allows "
            f"{100 * NEARLY_GREY:g} %); false colours are no measure of radiance: give the grey original, or choose a channel: "
            f"{', '.join(CHANNELS)}"
        )
    if not span.any():
        return np.asarray(colours[..., 0])
    return np.asarray(colours.mean(axis=-1, dtype=np.float64))
