"""Write pictures of the documentation as small PNG files: with 256 colours where these are close enough to all colours.

python docs/figures/pictures.py docs/images/fig2.png    write pictures that exist anew, without drawing them
"""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import uniform_filter

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = 256
METHODS = (Image.Quantize.MEDIANCUT, Image.Quantize.MAXCOVERAGE)
"""Ways to choose the colours: by area for smooth maps, by distance for thin lines of many colours."""
FARTHEST = 22
"""Largest difference of a channel [levels of 255] of all pixels but one in a thousand; a single pixel is hard to see."""
BAND = 2.5
"""Largest mean difference over a square of smooth sea or sky [levels of 255]; beyond it maps show bands."""
SIDE = 7
"""Side of the square [pixels]."""
SMOOTH = 3.0
"""Standard deviation in the square below which a step is visible [levels of 255]."""


def local_mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return means over the square around each pixel, each channel for itself."""
    result: NDArray[np.float64] = uniform_filter(values, (SIDE, SIDE, 0))
    return result


def palettes(picture: Image.Image) -> list[Image.Image]:
    """Return pictures with 256 colours and no dithering; none where some colours would be seen to change."""
    exact = np.asarray(picture, np.float64)
    smooth = (local_mean(exact**2) - local_mean(exact) ** 2).max(axis=-1) < SMOOTH**2
    result = []
    for method in METHODS:
        reduced = picture.quantize(COLOURS, method, kmeans=8, dither=Image.Dither.NONE)
        difference = np.asarray(reduced.convert("RGB"), np.float64) - exact
        farthest = float(np.quantile(np.abs(difference).max(axis=-1), 0.999))
        band = float(np.quantile(np.abs(local_mean(difference)).max(axis=-1)[smooth], 0.999)) if smooth.any() else 0.0
        if farthest <= FARTHEST and band <= BAND:
            result.append(reduced)
    return result


def encoded(picture: Image.Image) -> bytes:
    """Return a picture as the smallest PNG that shows its colours."""
    picture = picture.convert("RGB")
    contents = []
    for one in (picture, *palettes(picture)):
        out = io.BytesIO()
        one.save(out, "PNG", optimize=True)
        contents.append(out.getvalue())
    return min(contents, key=len)


def save(figure: Figure, path: Path, dpi: float = 110) -> None:
    """Write a figure as a PNG file."""
    out = io.BytesIO()
    figure.savefig(out, dpi=dpi, format="png")
    path.write_bytes(encoded(Image.open(out)))


def save_named(pictures: Mapping[str, Callable[[], Figure]], names: list[str]) -> None:
    """Draw the pictures of the documentation that are named, or all, into ``docs/images``."""
    if unknown := set(names) - set(pictures):
        sys.exit(f"{', '.join(sorted(unknown))}: not one of {', '.join(pictures)}")
    root = Path(__file__).resolve().parents[2]
    for name in names or pictures:
        path = root / "docs" / "images" / f"{name}.png"
        save(pictures[name](), path)
        print(path.relative_to(root))


def renew(path: Path) -> None:
    """Write a PNG file anew where that makes it smaller."""
    with Image.open(path) as picture:
        content = encoded(picture)
    if len(content) < path.stat().st_size:
        path.write_bytes(content)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        renew(Path(name))
