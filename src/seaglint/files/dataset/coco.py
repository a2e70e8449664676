"""COCO: one folder of pictures and ``annotations.json``, for all and for each split."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.dataset.dataset_format import DatasetFormat
from seaglint.files.dataset.grey_levels import Bits
from seaglint.files.dataset.masks import box_of, decoded
from seaglint.files.dataset.part import Catalogue, DatasetFrame, DatasetObject, DatasetScene, Piece
from seaglint.files.dataset.split import SPLITS
from seaglint.files.text_file import read_json, write_json

ANNOTATIONS = "annotations.json"


class Coco(DatasetFormat):
    """Pictures in one folder, and annotations as JSON."""

    name: ClassVar[str] = "coco"
    bits: ClassVar[Bits] = 16
    layout: ClassVar[str] = (
        "`images/` and `annotations.json` (all), `annotations_train.json`, `annotations_val.json`, `annotations_test.json`"
    )
    folders: ClassVar[tuple[str, ...]] = ("images",)

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write ``annotations.json`` and ``annotations_train.json``, ``_val``, ``_test``, which have its numbers."""
        _write(folder, catalogue, about)

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield the faults of annotations: boxes outside pictures, masks that are not of their boxes, splits that share scenes."""
        return _problems(folder)


def _write(folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
    version = f"seaglint {about['version']}, seed {about['seed']}"
    info = {"description": about["title"], "version": version, "contributor": "simulated"}
    whole = _document(catalogue, info, about["licence"])
    write_json(whole, folder / ANNOTATIONS, indent=None)
    for split in SPLITS:
        images = [image for image in whole["images"] if image["split"] == split]
        chosen = {image["id"] for image in images}
        annotations = [annotation for annotation in whole["annotations"] if annotation["image_id"] in chosen]
        write_json({**whole, "images": images, "annotations": annotations}, folder / f"annotations_{split}.json", indent=None)


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
                category = numbers[part.categories[row.number]]
                annotations.append({**about, "category_id": category, **_annotation(part, row, piece)})
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
    lines = part.levels.attributes if part.levels is not None else {}
    return {**about, "scene": part.scene, "split": part.split, "frame": picture.frame, "time_s": picture.time_s, **lines}


def _annotation(part: DatasetScene, row: DatasetObject, piece: Piece) -> JsonObject:
    values = row.values
    return {
        "bbox": list(piece.box),
        "area": piece.area,
        # a mask as run lengths is of one object: 1 would mark a crowd, which scores leave out
        "iscrowd": 0,
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
        "snr": row.snr,
        "signal_to_clutter": values["signal_to_clutter"],
        "filled_px": values["pixels"],
        "attributes": {name: values[name] for name in ("visible_share", "occluded_share", "truncated_share")},
    }


def _problems(folder: Path) -> Iterator[str]:
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
        yield from (f"{where}: {text}" for text in _box_problems(annotation, (image["height"], image["width"])))
    ids = [annotation["id"] for annotation in whole["annotations"]]
    if len(set(ids)) < len(ids):
        yield f"{ANNOTATIONS}: several annotations have one id"
    shared = [{image["id"] for image in documents[name]["images"]} for name in names[1:]]
    if sum(map(len, shared)) != len(images) or set().union(*shared) != set(images):
        yield "the images of annotations_train.json, _val and _test are not those of annotations.json, each once"


def _box_problems(annotation: Mapping[str, Any], shape: tuple[int, int]) -> Iterator[str]:
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
