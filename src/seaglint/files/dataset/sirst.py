"""The layout of single-frame small-target sets: pictures, masks of the same names in 0 and 255, and lists of names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.files.dataset.dataset_format import DatasetFormat
from seaglint.files.dataset.grey_levels import Bits
from seaglint.files.dataset.grey_picture import read_picture, write_picture
from seaglint.files.dataset.masks import decoded
from seaglint.files.dataset.part import Catalogue, DatasetScene
from seaglint.files.dataset.split import SPLITS
from seaglint.files.tables.rows import read_rows
from seaglint.files.text_file import write_text


class Sirst(DatasetFormat):
    """Pictures, masks and lists of names."""

    name: ClassVar[str] = "sirst"
    bits: ClassVar[Bits] = 8
    layout: ClassVar[str] = "`images/`, `masks/` (0 and 255), `img_idx/SPLIT.txt`"
    folders: ClassVar[tuple[str, ...]] = ("images", "masks", "img_idx")

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write ``masks/NAME.png`` and ``img_idx/SPLIT.txt``."""
        _write(folder, catalogue)

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield the faults of masks and lists, and of masks against the boxes of ``truth.csv``."""
        yield from _problems(folder, about["image"])
        yield from _box_problems(folder)


def _write(folder: Path, catalogue: Catalogue) -> None:
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


def _problems(folder: Path, image: str) -> Iterator[str]:
    """Yield pictures without masks or names, masks of another size or other values."""
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


def _box_problems(folder: Path) -> Iterator[str]:
    """Masks have something of every annotated object's box, and nothing outside of them."""
    boxes: dict[str, list[tuple[int, int, int, int]]] = {}
    for row in read_rows(folder / "truth.csv"):
        annotated = boxes.setdefault(row["image"], [])
        if row["annotated"] == "True":
            left, top, width, height = (int(float(row[f"bbox_{side}_px"])) for side in ("left", "top", "width", "height"))
            annotated.append((left, top, width, height))
    for path in sorted((folder / "masks").glob("*.png")):
        mask = read_picture(path) > 0
        left_over = mask.copy()
        for left, top, width, height in boxes.get(path.stem, ()):
            # a box over the seam of a panorama goes on at the left
            columns = [column % mask.shape[1] for column in range(left, left + width)]
            if not mask[top : top + height, columns].any():
                yield f"masks/{path.name}: has nothing in the box of an object of truth.csv"
            left_over[top : top + height, columns] = False
        if left_over.any():
            yield f"masks/{path.name}: has pixels outside of the boxes of truth.csv"
