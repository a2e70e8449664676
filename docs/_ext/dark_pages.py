"""Pictures on dark pages: their paper and lines are inverted and keep their hue, while imagery and colour bars stay as drawn.

Each picture of ``docs/images`` gets a shade over it, which shows on dark pages alone (``site.css``). It inverts what is behind it, except
panels: filled rectangles on white paper. The shade is a place in the page, not a second picture, and needs no script.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from docutils import nodes
from PIL import Image
from scipy import ndimage
from sphinx.transforms.post_transforms import SphinxPostTransform

if TYPE_CHECKING:
    from sphinx.application import Sphinx

PAPER = 240
"""Level from which a pixel is paper [levels of 255]; JPEG files have a little noise on it."""
FILLED = 0.65
"""Share of a panel that is not paper [1]; of axes with lines or bars at most half is not."""
FILLED_OF = {"fig12": 0.9, "sensor_point_edge": 0.5}
"""Share of pictures where drawing and imagery are not that far apart."""
SMALLEST = 0.002
"""Smallest panel as a share of the picture [1]: a colour bar."""
OUTER = -0.05
"""Where the shade is cut [1]: outside of the picture, since a cut along its edge leaves a line of paper where pixels are shared."""
SCREENSHOTS = "viewer-"
"""How names of pictures begin that are dimmed alone."""


@cache
def panels(path: Path) -> tuple[tuple[float, float, float, float], ...]:
    """Return left, top, right and bottom of each panel of imagery of a picture, as shares of its width and height [1]."""
    with Image.open(path) as picture:
        ink = np.asarray(picture.convert("RGB")).min(axis=-1) < PAPER
    labels, _ = ndimage.label(ink)
    height, width = ink.shape
    boxes: list[tuple[int, int, int, int]] = []
    for label, (rows, columns) in enumerate(ndimage.find_objects(labels), 1):
        piece = labels[rows, columns] == label
        if piece.size < SMALLEST * ink.size:
            continue
        # Ticks and arrows of colour bars are attached to a panel: its edges are the first and last line that is filled by half.
        y, x = (np.flatnonzero(piece.mean(axis=axis) > 0.5) for axis in (1, 0))
        if y.size == 0 or x.size == 0 or np.ptp(y) < 0.6 * piece.shape[0] - 2 or np.ptp(x) < 0.6 * piece.shape[1] - 2:
            continue
        if piece[y[0] : y[-1] + 1, x[0] : x[-1] + 1].mean() > FILLED_OF.get(path.stem, FILLED):
            left, top = columns.start, rows.start
            boxes.append((left + int(x[0]), top + int(y[0]), left + int(x[-1]) + 1, top + int(y[-1]) + 1))
    outer = [box for box in boxes if not any(other != box and inside(box, other) for other in boxes)]
    return tuple((x0 / width, y0 / height, x1 / width, y1 / height) for x0, y0, x1, y1 in outer)


def inside(box: tuple[int, int, int, int], other: tuple[int, int, int, int]) -> bool:
    """Whether a rectangle is within another."""
    return other[0] <= box[0] and other[1] <= box[1] and box[2] <= other[2] and box[3] <= other[3]


def shade(path: Path) -> str:
    """Return the element that inverts all of a picture but its panels."""
    corners = [(OUTER, OUTER), (1.0 - OUTER, OUTER), (1.0 - OUTER, 1.0 - OUTER), (OUTER, 1.0 - OUTER), (OUTER, OUTER)]
    for left, top, right, bottom in panels(path):
        corners += [(left, top), (right, top), (right, bottom), (left, bottom), (left, top), (OUTER, OUTER)]
    places = ",".join(f"{100.0 * x:.5g}% {100.0 * y:.5g}%" for x, y in corners)
    return f'<span class="shade" style="clip-path:polygon(evenodd,{places})"></span>'


class Shades(SphinxPostTransform):
    """Put a shade over each picture."""

    default_priority = 500  # pictures have found their files
    formats = ("html",)

    def run(self, **options: Any) -> None:
        """Wrap pictures of ``docs/images``."""
        for image in list(self.document.findall(nodes.image)):
            name = image["uri"]
            path = Path(self.env.srcdir) / name
            if not name.startswith("images/"):
                continue
            if path.name.startswith(SCREENSHOTS):
                content = '<span class="shade dim"></span>'
            else:
                content = '<span class="shade"></span>' if path.suffix == ".svg" else shade(path)
            wrapped = nodes.inline("", "", classes=["picture", "drawing"] if path.suffix == ".svg" else ["picture"])
            image.replace_self(wrapped)
            wrapped += [image, nodes.raw("", content, format="html")]


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the transform."""
    app.add_post_transform(Shades)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
