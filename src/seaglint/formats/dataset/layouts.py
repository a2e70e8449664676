"""Layouts of data sets, each a class that writes and checks its files.

- COCO: one folder of pictures and ``annotations.json``, for all and for each split.
- SIRST, the layout of single-frame small-target sets: pictures, masks of the same names in 0 and 255, and lists of names. Each list has two
  names: with the folder's name for the loaders of BasicIRSTD, SCTransNet and others, without it for DNANet's.
- Stores: unchanged copies of the scenes' stores, sequences with their truth, in Zarr.
- YOLO: pictures and text files of boxes in a folder for each split, and ``data.yaml``.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.formats.dataset.grey_pictures import box_of, decoded, read_picture, write_picture
from seaglint.formats.dataset.scene_records import (
    FOLDER,
    SPLITS,
    Catalogue,
    DatasetFormat,
    DatasetFrame,
    DatasetObject,
    DatasetScene,
    Piece,
)
from seaglint.formats.object_labels import RESPONSE
from seaglint.formats.tables.table_text import read_rows
from seaglint.store.outputs import read_json, write_json, write_text
from seaglint.store.staging import copy_folder

if TYPE_CHECKING:
    from seaglint.formats.dataset.scene_records import Entry


ANNOTATIONS = "annotations.json"


class Coco(DatasetFormat):
    """Pictures in one folder, and annotations as JSON."""

    name: ClassVar[str] = "coco"
    layout: ClassVar[str] = (
        "`images/` and `annotations.json` (all), `annotations_train.json`, `annotations_val.json`, `annotations_test.json`"
    )
    folders: ClassVar[tuple[str, ...]] = ("images",)

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write ``annotations.json`` and ``annotations_train.json``, ``_val``, ``_test``, which have its numbers."""
        version = f"seaglint {about['version']}, seed {about['seed']}"
        info = {"description": about["title"], "version": version, "contributor": "simulated"}
        whole = cls.document(catalogue, info, about["licence"])
        write_json(whole, folder / ANNOTATIONS, indent=None)
        for split in SPLITS:
            write_json(cls.of_split(whole, split), folder / f"annotations_{split}.json", indent=None)

    @classmethod
    def document(cls, catalogue: Catalogue, info: Mapping[str, Any], licence: str) -> JsonObject:
        """Return what ``annotations.json`` contains."""
        return _document(catalogue, info, licence)

    @classmethod
    def of_split(cls, whole: JsonObject, split: str) -> JsonObject:
        """Return the part of ``annotations.json`` that belongs to a split."""
        images = [image for image in whole["images"] if image["split"] == split]
        chosen = {image["id"] for image in images}
        annotations = [annotation for annotation in whole["annotations"] if annotation["image_id"] in chosen]
        return {**whole, "images": images, "annotations": annotations}

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield the faults of annotations: boxes outside pictures, masks that are not of their boxes, splits that share scenes."""
        names = (ANNOTATIONS, *(f"annotations_{split}.json" for split in SPLITS))
        documents: JsonObject = {}
        for name in names:
            try:
                documents[name] = read_json(folder / name, "make the data set again")
            except DataError as error:
                yield str(error)
        whole = documents.get(ANNOTATIONS)
        if whole is None or len(documents) < len(names):
            return
        images = {image["id"]: image for image in whole["images"]}
        categories = {category["id"] for category in whole["categories"]}
        for annotation in whole["annotations"]:
            where = f"{ANNOTATIONS}: annotation {annotation['id']}"
            image = images.get(annotation["image_id"])
            if image is None or annotation["category_id"] not in categories:
                yield f"{where}: names an image or category that is not there"
                continue
            yield from (f"{where}: {text}" for text in _coco_box_problems(annotation, (image["height"], image["width"])))
        ids = [annotation["id"] for annotation in whole["annotations"]]
        if len(set(ids)) < len(ids):
            yield f"{ANNOTATIONS}: several annotations have one id"
        shared = [{image["id"] for image in documents[name]["images"]} for name in names[1:]]
        if sum(map(len, shared)) != len(images) or set().union(*shared) != set(images):
            yield "the images of annotations_train.json, _val and _test are not those of annotations.json, each once"


def _document(catalogue: Catalogue, info: Mapping[str, Any], licence: str) -> JsonObject:
    numbers = {name: number for number, name in enumerate(catalogue.categories, 1)}
    tracks = catalogue.tracks()
    images: list[JsonObject] = []
    annotations: list[JsonObject] = []
    for part in catalogue.parts:
        first = len(images) + 1
        images += [_image(part, picture, first + i, catalogue.image) for i, picture in enumerate(part.pictures)]
        for row in part.rows:
            for piece in row.pieces:
                about = {"id": len(annotations) + 1, "image_id": first + row.frame, "track_id": tracks[part.scene] + row.number}
                annotations.append({**about, "category_id": numbers[part.categories[row.number]], **_annotation(part, row, piece)})
    return {
        "info": dict(info),
        "licenses": [{"id": 1, "name": licence, "url": ""}],
        "images": images,
        "categories": [{"id": number, "name": name, "supercategory": "object"} for name, number in numbers.items()],
        "annotations": annotations,
    }


def _image(part: DatasetScene, picture: DatasetFrame, number: int, ending: str) -> JsonObject:
    rows, columns = part.shape
    about = {"id": number, "file_name": f"{picture.name}.{ending}", "width": columns, "height": rows, "license": 1}
    beside = {"file_name_16": about["file_name"]} if len(picture.levels) > 1 else {}
    place = {"scene": part.scene, "split": part.split, "frame": picture.frame, "time_s": picture.time_s}
    return {**about, **beside, **place, **picture.attributes}


def _annotation(part: DatasetScene, row: DatasetObject, piece: Piece) -> JsonObject:
    values = row.values
    return {
        "bbox": list(piece.box),
        "area": piece.area,
        # COCOeval honours ``iscrowd`` and sets ``ignore`` from it; other programs read ``ignore``
        "iscrowd": int(part.ignores(row)),
        "ignore": int(part.ignores(row)),
        "segmentation": {"size": list(part.shape), "counts": piece.counts},
        "object": part.names[row.number],
        "object_id": row.number + 1,
        "scene": part.scene,
        "frame": part.pictures[row.frame].frame,
        "centroid": [values["column_px"], values["row_px"]],
        "range_m": values["range_m"],
        "contrast_W_m2_sr": values["contrast_W_m2_sr"],
        "irradiance_W_m2": values["irradiance_W_m2"],
        "local_contrast_W_m2_sr": row.local_contrast,
        "mean_snr": row.mean_snr,
        "snr": row.snr,
        "difficulty": part.difficulty(row),
        "signal_to_clutter": values["signal_to_clutter"],
        "filled_px": values["pixels"],
        "attributes": {name: values[name] for name in ("visible_share", "occluded_share", "truncated_share")},
    }


def _coco_box_problems(annotation: Mapping[str, Any], shape: tuple[int, int]) -> Iterator[str]:
    left, top, width, height = annotation["bbox"]
    if width < 1 or height < 1 or left < 0 or top < 0 or left + width > shape[1] or top + height > shape[0]:
        yield f"its box {annotation['bbox']} is not within {shape[1]} x {shape[0]} pixels"
        return
    if tuple(annotation["segmentation"]["size"]) != shape:
        yield f"its mask is of {annotation['segmentation']['size']} rows and columns, its image of {list(shape)}"
        return
    try:
        mask = decoded(annotation["segmentation"]["counts"], shape)
    except DataError as error:
        yield f"{error}"
        return
    if not mask.any() or box_of(mask) != (left, top, width, height):
        yield f"its box {annotation['bbox']} is not that of its mask"
    elif int(mask.sum()) != annotation["area"]:
        yield f"its area {annotation['area']} is not that of its mask, {int(mask.sum())}"


class Sirst(DatasetFormat):
    """Pictures, masks and lists of names."""

    name: ClassVar[str] = "sirst"
    layout: ClassVar[str] = "`images/`, `masks/` (0 and 255), `img_idx/SPLIT_NAME.txt` with the folder's name, and `img_idx/SPLIT.txt`"
    folders: ClassVar[tuple[str, ...]] = ("images", "masks", "img_idx")

    @classmethod
    def write_scene(cls, folder: Path, part: DatasetScene, image: str) -> None:
        """Write ``masks/NAME.png``."""
        for name, mask in masks(part).items():
            write_mask(folder / "masks" / f"{name}.png", mask)

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write the list of each split under both names: BasicIRSTD reads ``SPLIT_NAME.txt``, DNANet ``SPLIT.txt``."""
        for split in SPLITS:
            names = "".join(f"{picture.name}\n" for part in catalogue.of_split(split) for picture in part.pictures)
            for file in (f"{split}_{about['folder']}.txt", f"{split}.txt"):
                write_text(names, folder / "img_idx" / file)

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield the faults of masks and lists, and of masks against the boxes of ``truth.csv``."""
        yield from _sirst_problems(folder, about["image"])
        yield from mask_box_problems(folder, about, {path.stem: path for path in (folder / "masks").glob("*.png")})


def masks(part: DatasetScene) -> dict[str, NDArray[np.bool_]]:
    """Return the mask of all objects that are not ignored by picture."""
    out = {picture.name: np.zeros(part.shape, bool) for picture in part.pictures}
    for row in (row for row in part.rows if not part.ignores(row)):
        for piece in row.pieces:
            out[part.pictures[row.frame].name] |= decoded(piece.counts, part.shape)
    return out


def write_mask(path: Path, mask: NDArray[np.bool_]) -> None:
    """Write a mask as PNG of 0 and 255."""
    write_picture(path, np.where(mask, np.uint8(255), np.uint8(0)), {})


def _sirst_problems(folder: Path, image: str) -> Iterator[str]:
    """Yield pictures without masks or names, lists that differ, masks of another size or other values."""
    lists = {path.stem: path.read_text(encoding="utf-8").split() for path in sorted((folder / "img_idx").glob("*.txt"))}
    for split in SPLITS:
        if [names for file, names in lists.items() if file.startswith(f"{split}_")] != [lists[split]]:
            yield f"img_idx: {split}.txt and {split}_NAME.txt are not one list each with the same names"
    listed = [name for split in SPLITS for name in lists[split]]
    pictures = {path.stem for path in (folder / "images").glob(f"*.{image}")}
    if len(set(listed)) < len(listed) or set(listed) != pictures:
        yield "img_idx: the lists do not name every picture once"
    if {path.stem for path in (folder / "masks").glob("*.png")} != pictures:
        yield "masks: not every picture has a mask, or a mask has no picture"
        return
    for name in sorted(pictures):
        yield from mask_problems(folder, folder / "masks" / f"{name}.png", folder / "images" / f"{name}.{image}")


def mask_problems(folder: Path, mask: Path, picture: Path) -> Iterator[str]:
    """Yield a mask that cannot be read, is of another size than its picture, or has other values than 0 and 255."""
    try:
        values, levels = read_picture(mask), read_picture(picture)
    except DataError as error:
        yield str(error)
        return
    if values.shape != levels.shape or not np.isin(values, (0, 255)).all():
        yield f"{mask.relative_to(folder).as_posix()}: is not of the picture's size, or has other values than 0 and 255"


def mask_box_problems(folder: Path, about: Mapping[str, Any], masks: Mapping[str, Path]) -> Iterator[str]:
    """Yield masks that are empty in an annotated object's box, or not empty outside of all boxes; ``masks`` are by picture."""
    boxes: dict[str, list[tuple[int, int, int, int]]] = {}
    for row in read_rows(folder / "truth.csv"):
        annotated = boxes.setdefault(row["image"], [])
        if row["annotated"] == "True" and row["ignore"] == "False":
            prefix = "response" if about["scenes"][row["scene"]]["masks"] == RESPONSE else "bbox"
            left, top, width, height = (int(float(row[f"{prefix}_{side}_px"])) for side in ("left", "top", "width", "height"))
            annotated.append((left, top, width, height))
    for name, path in sorted(masks.items()):
        mask, shown = read_picture(path) > 0, path.relative_to(folder).as_posix()
        # Pixels that remain after all boxes are removed belong to no object.
        left_over = mask.copy()
        for left, top, width, height in boxes.get(name, ()):
            # A box over the seam of a panorama continues at the left.
            columns = [column % mask.shape[1] for column in range(left, left + width)]
            if not mask[top : top + height, columns].any():
                yield f"{shown}: has nothing in the box of an object of truth.csv"
            left_over[top : top + height, columns] = False
        if left_over.any():
            yield f"{shown}: has pixels outside of the boxes of truth.csv"


class Stores(DatasetFormat):
    """Copies of the scenes' stores; no pictures."""

    name: ClassVar[str] = "zarr"
    layout: ClassVar[str] = "`scenes/NAME.zarr`, sequences as seaglint writes them, with their truth"
    note: ClassVar[str] = "the scenes' stores as they are"
    folders: ClassVar[tuple[str, ...]] = ("scenes",)
    pictures: ClassVar[bool] = False

    @classmethod
    def store(cls, folder: Path, scene: str) -> Path:
        """Return the place of a scene's store."""
        return folder / "scenes" / f"{scene}.zarr"

    @classmethod
    def placed(cls, folder: Path, entry: Entry) -> Entry:
        """Copy a scene's store into the data set, whole or not at all; one that was rendered there stays."""
        stored = cls.store(folder, entry.name)
        if not stored.exists():
            # Renamed when whole: a copy that was interrupted is begun again, and what it left is removed with the records.
            fresh = folder / FOLDER / stored.name
            if fresh.exists():
                shutil.rmtree(fresh)
            copy_folder(Path(entry.store), fresh)
            fresh.rename(stored)
        return replace(entry, store=str(stored))

    @classmethod
    def picture(cls, folder: Path, part: DatasetScene, place: int, image: str) -> NDArray[np.generic]:
        """Return a frame of a stored scene (rows, columns)."""
        # Imported here, as they load Numba, and help pages list the formats of data sets.
        from seaglint.store.sequence_store import open_sequence
        from seaglint.store.stored_images import pictures

        with open_sequence(cls.store(folder, part.scene)) as dataset:
            return np.asarray(pictures(dataset)[place].to_numpy())

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield stores that cannot be read, or have other frames and pixels than stated in ``dataset.json``."""
        from seaglint.store.sequence_store import open_sequence

        for scene, one in about["scenes"].items():
            path = cls.store(folder, scene)
            try:
                with open_sequence(path) as dataset:
                    if (dataset.sizes["time"], dataset.sizes["y"], dataset.sizes["x"]) != (len(one["images"]), one["height"], one["width"]):
                        yield f"{path.name}: has not the frames and pixels that dataset.json tells"
            except DataError as error:
                yield str(error)


class Yolo(DatasetFormat):
    """Pictures and boxes in a folder for each split."""

    name: ClassVar[str] = "yolo"
    layout: ClassVar[str] = "`images/SPLIT/`, `labels/SPLIT/` (class, middle and size of boxes over those of the picture), `data.yaml`"
    folders: ClassVar[tuple[str, ...]] = tuple(f"{kind}/{split}" for kind in ("images", "labels") for split in SPLITS)

    @classmethod
    def image_path(cls, folder: Path, split: str, name: str, image: str, beside: str = "") -> Path:
        """Return the place of a picture, in the folder of its split."""
        return folder / f"images{beside}" / split / f"{name}.{image}"

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write ``labels/SPLIT/NAME.txt``, empty for a picture without objects, and ``data.yaml``."""
        numbers = {name: number for number, name in enumerate(catalogue.categories)}
        for split in SPLITS:
            for part in catalogue.of_split(split):
                for name, lines in _lines(part, numbers).items():
                    write_text("".join(lines), folder / "labels" / split / f"{name}.txt")
        names = "".join(f"  {number}: {json.dumps(name)}\n" for name, number in numbers.items())
        places = "".join(f"{split}: images/{split}\n" for split in SPLITS)
        write_text(f"{places}names:{' {}' if not names else ''}\n{names}", folder / "data.yaml")

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield the faults of labels: pictures without labels, labels without pictures, lines that are no boxes in the picture."""
        # Classes are the only lines of data.yaml that begin with blanks.
        classes = sum(1 for line in (folder / "data.yaml").read_text(encoding="utf-8").splitlines() if line.startswith("  "))
        for split in SPLITS:
            pictures = {path.stem for path in (folder / "images" / split).glob(f"*.{about['image']}")}
            labels = {path.stem: path for path in (folder / "labels" / split).glob("*.txt")}
            for name in sorted(pictures ^ set(labels)):
                yield f"{split}: {name} has {'no labels' if name in pictures else 'labels and no picture'}"
            for name, path in sorted(labels.items()):
                for line in path.read_text(encoding="utf-8").splitlines():
                    if not _is_box(line, classes):
                        yield f"labels/{split}/{name}.txt: '{line}' is no class and box within the picture"


def _is_box(line: str, classes: int) -> bool:
    """Return true for a line of a known class and of a box within the picture, but for the rounding of its eight digits."""
    try:
        number, *box = line.split()
        x, y, width, height = map(float, box)
        edges = (x - width / 2, y - height / 2, 1 - x - width / 2, 1 - y - height / 2)
        return 0 <= int(number) < classes and width > 0.0 and height > 0.0 and min(edges) > -1e-6
    except ValueError:
        return False


def _lines(part: DatasetScene, numbers: dict[str, int]) -> dict[str, list[str]]:
    """Return lines ``class x y width height`` by picture: middle and size of boxes over the size of the picture."""
    rows, columns = part.shape
    lines: dict[str, list[str]] = {picture.name: [] for picture in part.pictures}
    for row in (row for row in part.rows if not part.ignores(row)):
        for left, top, width, height in (piece.box for piece in row.pieces):
            box = ((left + 0.5 * width) / columns, (top + 0.5 * height) / rows, width / columns, height / rows)
            # 8 digits: a hundredth of a pixel in pictures of a million
            values = " ".join(f"{value:.8f}" for value in box)
            lines[part.pictures[row.frame].name].append(f"{numbers[part.categories[row.number]]} {values}\n")
    return lines
