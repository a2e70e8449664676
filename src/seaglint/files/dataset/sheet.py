"""Example pictures of a data set on one sheet, with the boxes of what is in them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale, eight_bit, scale_limits
from seaglint.files.outputs import moved_when_whole

WIDTH: Final = 240  #: Greatest side of an example [pixels].

COLUMNS: Final = 6

_GAP, _TEXT = 6, 14
_GREEN: Final = (90, 235, 120)


@dataclass(frozen=True, eq=False)
class Example:
    """Picture with its boxes (first column and row, columns and rows) and a line below it."""

    values: NDArray[Any]
    boxes: Sequence[tuple[int, int, int, int]]
    title: str


def write_sheet(examples: Sequence[Example], path: Path) -> None:
    """Write examples as PNG, each stretched from its 1st to its 99.8th percentile.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    from PIL import Image, ImageDraw

    columns = max(min(COLUMNS, len(examples)), 1)
    rows = max(math.ceil(len(examples) / columns), 1)
    sizes = [(round(e.values.shape[1] * _zoom(e)), round(e.values.shape[0] * _zoom(e))) for e in examples] or [(WIDTH, WIDTH)]
    tall = max(height for _, height in sizes)
    across, down = max(width for width, _ in sizes) + _GAP, tall + _TEXT + _GAP
    sheet = Image.new("RGB", (columns * across + _GAP, rows * down + _GAP), (24, 24, 28))
    pen = ImageDraw.Draw(sheet)
    for i, example in enumerate(examples):
        left, top = _GAP + i % columns * across, _GAP + i // columns * down
        zoom = _zoom(example)
        size = sizes[i]
        way = Image.Resampling.NEAREST if zoom >= 1.0 else Image.Resampling.BOX
        sheet.paste(Image.fromarray(_grey(example.values)).resize(size, way).convert("RGB"), (left, top))
        for box in example.boxes:
            # a frame three pixels of the picture wider, so that what is in it is seen
            x0, y0 = left + (box[0] - 3) * zoom, top + (box[1] - 3) * zoom
            x1, y1 = left + (box[0] + box[2] + 3) * zoom, top + (box[1] + box[3] + 3) * zoom
            inside = (max(x0, left), max(y0, top), min(x1, left + size[0] - 1), min(y1, top + size[1] - 1))
            pen.rectangle(inside, outline=_GREEN)
        pen.text((left, top + tall + 1), example.title, fill=(220, 220, 220))
    with moved_when_whole(path) as partial:
        sheet.save(partial, format="PNG")


def _zoom(example: Example) -> float:
    zoom = WIDTH / max(example.values.shape)
    return float(math.floor(zoom)) if zoom >= 1.0 else zoom


def _grey(values: NDArray[Any]) -> NDArray[np.uint8]:
    return eight_bit(Scale(*scale_limits(values, (1.0, 99.8))).share(values))
