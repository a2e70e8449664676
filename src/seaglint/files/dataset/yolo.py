"""YOLO: pictures and text files of boxes in a folder for each split, and ``data.yaml``."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar

from seaglint.files.dataset.dataset_format import DatasetFormat
from seaglint.files.dataset.grey_levels import Bits
from seaglint.files.dataset.part import Catalogue, DatasetScene
from seaglint.files.dataset.split import SPLITS
from seaglint.files.text_file import write_text


class Yolo(DatasetFormat):
    """Pictures and boxes in a folder for each split."""

    name: ClassVar[str] = "yolo"
    bits: ClassVar[Bits] = 8
    layout: ClassVar[str] = "`images/SPLIT/`, `labels/SPLIT/` (class, middle and size of boxes over those of the picture), `data.yaml`"
    folders: ClassVar[tuple[str, ...]] = tuple(f"{kind}/{split}" for kind in ("images", "labels") for split in SPLITS)

    @classmethod
    def image_path(cls, folder: Path, split: str, name: str, image: str) -> Path:
        """Return the place of a picture, in the folder of its split."""
        return folder / "images" / split / f"{name}.{image}"

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write ``labels/SPLIT/NAME.txt``, empty where nothing is in a picture, and ``data.yaml``."""
        _write(folder, catalogue)

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield the faults of labels: pictures without labels, labels without pictures, lines that are no boxes in the picture."""
        return _problems(folder, about["image"])


def _write(folder: Path, catalogue: Catalogue) -> None:
    numbers = {name: number for number, name in enumerate(catalogue.categories)}
    for split in SPLITS:
        for part in catalogue.of_split(split):
            for name, lines in _lines(part, numbers).items():
                write_text("".join(lines), folder / "labels" / split / f"{name}.txt")
    names = "".join(f"  {number}: {json.dumps(name)}\n" for name, number in numbers.items())
    places = "".join(f"{split}: images/{split}\n" for split in SPLITS)
    write_text(f"{places}names:{' {}' if not names else ''}\n{names}", folder / "data.yaml")


def _lines(part: DatasetScene, numbers: dict[str, int]) -> dict[str, list[str]]:
    """Lines ``class x y width height`` by picture: middle and size of boxes over those of the picture."""
    rows, columns = part.shape
    lines: dict[str, list[str]] = {picture.name: [] for picture in part.pictures}
    for row in part.rows:
        for left, top, width, height in (piece.box for piece in row.pieces):
            box = ((left + 0.5 * width) / columns, (top + 0.5 * height) / rows, width / columns, height / rows)
            # 8 digits: a hundredth of a pixel in pictures of a million
            values = " ".join(f"{value:.8f}" for value in box)
            lines[part.pictures[row.frame].name].append(f"{numbers[part.categories[row.number]]} {values}\n")
    return lines


def _problems(folder: Path, image: str) -> Iterator[str]:
    classes = sum(1 for line in (folder / "data.yaml").read_text(encoding="utf-8").splitlines() if line.startswith("  "))
    for split in SPLITS:
        pictures = {path.stem for path in (folder / "images" / split).glob(f"*.{image}")}
        labels = {path.stem: path for path in (folder / "labels" / split).glob("*.txt")}
        for name in sorted(pictures ^ set(labels)):
            yield f"{split}: {name} has {'no labels' if name in pictures else 'labels and no picture'}"
        for name, path in sorted(labels.items()):
            for line in path.read_text(encoding="utf-8").splitlines():
                try:
                    number, *box = line.split()
                    x, y, width, height = map(float, box)
                    edges = (x - width / 2, y - height / 2, 1 - x - width / 2, 1 - y - height / 2)
                    good = 0 <= int(number) < classes and width > 0.0 and height > 0.0 and min(edges) > -1e-6
                except ValueError:
                    good = False
                if not good:
                    yield f"labels/{split}/{name}.txt: '{line}' is no class and box within the picture"
