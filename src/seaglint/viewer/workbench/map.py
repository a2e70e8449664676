"""Small picture as SVG: pixels, axes and colour bar."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterator
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale, eight_bit
from seaglint.base.representation import rounded
from seaglint.base.schema import VARIABLES
from seaglint.plot.scale import round_ticks, scale_of, tick_labels
from seaglint.viewer.workbench.small_pictures import PreviewPicture

Quantity = Literal["radiance", "apparent_temperature"]

_WIDTH, _LEFT, _RIGHT, _TOP, _BOTTOM = 620.0, 52.0, 92.0, 8.0, 40.0
_LOW, _HIGH = 120.0, 420.0  # least and greatest height of the pixels


def map_svg(picture: PreviewPicture, quantity: Quantity = "radiance", title: str = "map") -> str:
    """Return the picture with azimuth and elevation [deg] on its axes, or columns and rows of the whole picture, and a colour bar."""
    values = picture.radiance if quantity == "radiance" else picture.temperature
    whole, own = scale_of(picture.radiance), scale_of(picture.radiance, depression=picture.depression)
    # Radiance decides for both pictures whether the sky goes beyond the scale.
    scale = scale_of(values, depression=picture.depression if (own.low, own.high) != (whole.low, whole.high) else None)
    rows, columns = values.shape
    width = _WIDTH - _LEFT - _RIGHT
    x, y, names = _axes(picture)
    shape = abs((y[1] - y[0]) / (x[1] - x[0]))
    height = min(max(width * shape, _LOW), _HIGH)
    if height == _HIGH and 0.2 < shape < 5.0:
        width = height / shape
    middle, below = _TOP + height / 2, _TOP + height
    pieces = [
        f'<image x="{_LEFT:g}" y="{_TOP:g}" width="{width:.1f}" height="{height:.1f}" preserveAspectRatio="none" '
        f'style="image-rendering:pixelated" href="{_png(scale.share(values), _colours(quantity))}"/>',
        f'<rect x="{_LEFT:g}" y="{_TOP:g}" width="{width:.1f}" height="{height:.1f}" fill="none" stroke="currentColor" '
        'stroke-opacity=".5"/>',
        *_ticks(x, _LEFT, width, below, across=True),
        *_ticks(y, _TOP, height, _LEFT, across=False),
        f'<text x="{_LEFT + width / 2:.1f}" y="{below + 34:.1f}" text-anchor="middle">{names[0]}</text>',
        f'<text x="13" y="{middle:.1f}" text-anchor="middle" transform="rotate(-90 13 {middle:.1f})">{names[1]}</text>',
        *_bar(scale, quantity, _LEFT + width + 12, height),
    ]
    size = f"{_LEFT + width + _RIGHT:.0f} {_TOP + height + _BOTTOM:.0f}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" width="100%" role="img" '
        f'aria-label="{title}: {VARIABLES[quantity].long_name}" font-family="system-ui, sans-serif" '
        f'font-size="11" fill="currentColor" data-rows="{rows}" data-columns="{columns}">{"".join(pieces)}</svg>'
    )


def _axes(picture: PreviewPicture) -> tuple[tuple[float, float], tuple[float, float], tuple[str, str]]:
    if picture.azimuth is not None and picture.elevation is not None:
        return picture.azimuth, picture.elevation, ("azimuth [deg]", "elevation [deg]")
    columns, rows = picture.pixels
    return (0.0, float(columns)), (0.0, float(rows)), ("column [px]", "row [px]")


def even(low: float, high: float, most: int = 7) -> list[float]:
    """Return round numbers between two others, at most a given number.

    >>> even(172.0, 188.0)
    [172.5, 175.0, 177.5, 180.0, 182.5, 185.0, 187.5]
    """
    low, high = min(low, high), max(low, high)
    if not high > low:
        return [low]
    size = 10.0 ** math.floor(math.log10((high - low) / most))
    step = next(size * part for part in (1.0, 2.0, 2.5, 5.0, 10.0, 20.0) if (high - low) / (size * part) <= most)
    return [round(n * step, 10) for n in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _ticks(ends: tuple[float, float], begin: float, length: float, edge: float, *, across: bool) -> Iterator[str]:
    for value in even(*ends, most=7 if across else 5):
        at = begin + length * (value - ends[0]) / (ends[1] - ends[0])
        text = f"{value % 360 if across and ends[1] > 360 else value:g}".replace("-", "\u2212")
        if across:
            yield f'<path d="M{at:.1f},{edge:.1f}v5" stroke="currentColor" stroke-opacity=".6"/>'
            yield f'<text x="{at:.1f}" y="{edge + 17:.1f}" text-anchor="middle">{text}</text>'
        else:
            yield f'<path d="M{edge:.1f},{at:.1f}h-5" stroke="currentColor" stroke-opacity=".6"/>'
            yield f'<text x="{edge - 8:.1f}" y="{at:.1f}" text-anchor="end" dominant-baseline="central">{text}</text>'


def _bar(scale: Scale, quantity: Quantity, left: float, height: float) -> Iterator[str]:
    shares = np.linspace(1.0, 0.0, 128)[:, np.newaxis]
    yield (
        f'<image x="{left:.1f}" y="{_TOP:g}" width="12" height="{height:.1f}" preserveAspectRatio="none" '
        f'href="{_png(shares, _colours(quantity))}"/>'
    )
    if scale.logarithmic:
        ticks = round_ticks(scale.share, scale.value)
        shown, labels = scale.share(ticks), [rounded(tick, 9) for tick in ticks]
    else:
        shown = np.linspace(0.0, 1.0, 5)
        labels = tick_labels(scale.value(shown), 4 if quantity == "apparent_temperature" else 3)
    for share, label in zip(shown, labels, strict=True):
        at = _TOP + height * (1.0 - share)
        y = min(max(at, _TOP + 5), _TOP + height - 5)
        yield f'<text x="{left + 17:.1f}" y="{y:.1f}" dominant-baseline="central">{label}</text>'
    unit, x, y = VARIABLES[quantity].symbol or VARIABLES[quantity].units, left + 68, _TOP + height / 2
    unit += ", log" if scale.logarithmic else ""
    yield f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="middle" transform="rotate(-90 {x:.1f} {y:.1f})">{unit}</text>'


def _colours(quantity: Quantity) -> NDArray[np.uint8]:
    from matplotlib import colormaps

    name: Final = "inferno" if quantity == "radiance" else "gray"
    return np.asarray(np.round(255 * colormaps[name](np.linspace(0.0, 1.0, 256))[:, :3]), np.uint8)


def _png(share: NDArray[Any], colours: NDArray[np.uint8]) -> str:
    """Return a data address of pixels of this brightness; those without a number are green."""
    from PIL import Image

    known = np.isfinite(share)
    pixels = colours[eight_bit(share)]
    pixels[~known] = (40, 140, 90)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format="png")
    return "data:image/png;base64," + base64.b64encode(out.getvalue()).decode("ascii")
