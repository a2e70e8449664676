"""The layout of single-frame small-target sets: pictures, masks of the same names in 0 and 255, and lists of names."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.files.dataset.grey_picture import read_picture, write_picture
from seaglint.files.dataset.masks import decoded
from seaglint.files.dataset.part import Catalogue, DatasetScene
from seaglint.files.dataset.split import SPLITS
from seaglint.files.text_file import write_text


def write(folder: Path, catalogue: Catalogue) -> None:
    """Write ``masks/NAME.png`` and ``img_idx/SPLIT.txt``."""
    for part in catalogue.parts:
        for name, mask in masks(part).items():
            write_picture(folder / "masks" / f"{name}.png", np.where(mask, np.uint8(255), np.uint8(0)), {})
    for split in SPLITS:
        names = [picture.name for part in catalogue.of_split(split) for picture in part.pictures]
        write_text("".join(f"{name}\n" for name in names), folder / "img_idx" / f"{split}.txt")


def masks(part: DatasetScene) -> dict[str, NDArray[np.bool_]]:
    """Mask of all objects by picture."""
    out = {picture.name: np.zeros(part.shape, bool) for picture in part.pictures}
    for row in part.rows:
        for piece in row.pieces:
            out[part.pictures[row.frame].name] |= decoded(piece.counts, part.shape)
    return out


def problems(folder: Path, image: str) -> Iterator[str]:
    """What is wrong: pictures without masks or names, masks of another size or other values."""
    listed: list[str] = []
    for split in SPLITS:
        listed += (folder / "img_idx" / f"{split}.txt").read_text(encoding="utf-8").split()
    pictures = {path.stem for path in (folder / "images").glob(f"*.{image}")}
    if len(set(listed)) < len(listed) or set(listed) != pictures:
        yield "img_idx: the lists do not name every picture once"
    if {path.stem for path in (folder / "masks").glob("*.png")} != pictures:
        yield "masks: not every picture has a mask, or a mask has no picture"
        return
    for name in sorted(pictures):
        try:
            mask, levels = read_picture(folder / "masks" / f"{name}.png"), read_picture(folder / "images" / f"{name}.{image}")
        except DataError as error:
            yield str(error)
            continue
        if mask.shape != levels.shape or not np.isin(mask, (0, 255)).all():
            yield f"masks/{name}.png: is not of the picture's size, or has other values than 0 and 255"
