"""Layouts of data sets of sequences: an object has one number through all frames of its scene, and is absent where it is out of view.

- COCO for video: COCO with ``videos``, ``tracks``, and the frame and video of each image (mmtracking's CocoVID, TAO).
- MOTChallenge: a folder for each sequence with ``seqinfo.ini``, ``img1`` and ``gt/gt.txt``; frames, numbers and pixels count from 1.
- NUDT-MIRSDT: a folder for each sequence with pictures, masks, masks of centroids, and stacks of five frames for MATLAB's readers.
"""

from __future__ import annotations

import configparser
from collections import deque
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.formats.dataset.grey_pictures import read_picture
from seaglint.formats.dataset.layouts import Coco, mask_box_problems, mask_problems, masks, write_mask
from seaglint.formats.dataset.scene_records import SPLITS, Catalogue, DatasetFormat, DatasetObject, DatasetScene
from seaglint.store.outputs import moved_when_whole, write_text


class CocoVideo(Coco):
    """Pictures in a folder for each scene, and annotations as JSON with videos and tracks."""

    name: ClassVar[str] = "coco-video"
    layout: ClassVar[str] = (
        "`images/SCENE/` and `annotations.json` (all), `annotations_train.json`, `annotations_val.json`, `annotations_test.json`, with "
        "`videos` and `tracks`; `frame_id` counts from 0"
    )
    sequences: ClassVar[bool] = True

    @classmethod
    def frame_name(cls, scene: str, frame: int, place: int) -> str:
        """Return the name of a picture, in the folder of its scene."""
        return f"{scene}/{frame:06d}"

    @classmethod
    def document(cls, catalogue: Catalogue, info: Mapping[str, Any], licence: str) -> JsonObject:
        """Return what ``annotations.json`` contains."""
        whole = super().document(catalogue, info, licence)
        videos = {part.scene: number for number, part in enumerate(catalogue.parts, 1)}
        places = [place for part in catalogue.parts for place in range(len(part.pictures))]
        for image, place in zip(whole["images"], places, strict=True):
            # mmtracking reads ``frame_id``, TAO ``frame_index`` and ``video``
            image |= {"video_id": videos[image["scene"]], "video": image["scene"], "frame_id": place, "frame_index": place}
        seen: dict[int, JsonObject] = {}
        for annotation in whole["annotations"]:
            track, video = annotation["track_id"], videos[annotation["scene"]]
            annotation |= {"video_id": video, "instance_id": track}
            seen.setdefault(
                track, {"id": track, "video_id": video, "category_id": annotation["category_id"], "object": annotation["object"]}
            )
        described = [_video(part, videos[part.scene]) for part in catalogue.parts]
        return {**whole, "videos": described, "tracks": [seen[track] for track in sorted(seen)]}

    @classmethod
    def of_split(cls, whole: JsonObject, split: str) -> JsonObject:
        """Return the part of ``annotations.json`` that belongs to a split."""
        videos = [video for video in whole["videos"] if video["split"] == split]
        chosen = {video["id"] for video in videos}
        tracks = [track for track in whole["tracks"] if track["video_id"] in chosen]
        return {**super().of_split(whole, split), "videos": videos, "tracks": tracks}


def _video(part: DatasetScene, number: int) -> JsonObject:
    rows, columns = part.shape
    about = {"id": number, "name": part.scene, "split": part.split, "width": columns, "height": rows}
    # TAO's lists of classes without labels: all objects are labelled
    complete: JsonObject = {"neg_category_ids": [], "not_exhaustive_category_ids": []}
    return {**about, "fps": part.frame_rate_hz, "length": len(part.pictures), **complete}


class Mot(DatasetFormat):
    """Folders of sequences as MOTChallenge has them."""

    name: ClassVar[str] = "mot"
    layout: ClassVar[str] = (
        "`SPLIT/SCENE/` with `seqinfo.ini`, `img1/000001.png`, `gt/gt.txt` (frame, object, left, top, width, height, considered, "
        "class, visible share; frames, objects, classes and pixels count from 1) and `gt/labels.txt`, the names of the "
        "classes; `seqmaps/SPLIT.txt`"
    )
    folders: ClassVar[tuple[str, ...]] = (*SPLITS, "seqmaps")
    sequences: ClassVar[bool] = True

    @classmethod
    def frame_name(cls, scene: str, frame: int, place: int) -> str:
        """Return the name of a picture, which counts from 1 without gaps."""
        return f"{scene}/{place + 1:06d}"

    @classmethod
    def image_path(cls, folder: Path, split: str, name: str, image: str, beside: str = "") -> Path:
        """Return the place of a picture, in the folder of its sequence: ``img1``, or ``img1_16`` of the second ones."""
        scene, number = name.split("/")
        return folder / split / scene / ("img1_16" if beside else "img1") / f"{number}.{image}"

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write ``seqinfo.ini``, ``gt/gt.txt`` and ``gt/labels.txt`` of each sequence, and ``seqmaps/SPLIT.txt``."""
        numbers = {name: number for number, name in enumerate(catalogue.categories, 1)}
        for part in catalogue.parts:
            sequence = folder / part.split / part.scene
            (sequence / "gt").mkdir(parents=True, exist_ok=True)
            write_text(_seqinfo(part, catalogue.image), sequence / "seqinfo.ini")
            lines = [_mot_line(part, row, numbers) for row in part.rows if row.pieces]
            write_text("".join(lines), sequence / "gt" / "gt.txt")
            write_text("".join(f"{name}\n" for name in numbers), sequence / "gt" / "labels.txt")
        for split in SPLITS:
            names = "".join(f"{part.scene}\n" for part in catalogue.of_split(split))
            write_text(f"name\n{names}", folder / "seqmaps" / f"{split}.txt")

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield the faults of ``gt.txt`` and ``seqinfo.ini``, and sequences that ``seqmaps`` does not list."""
        for split in SPLITS:
            listed = (folder / "seqmaps" / f"{split}.txt").read_text(encoding="utf-8").split()[1:]
            if listed != [scene for scene, one in about["scenes"].items() if one["split"] == split]:
                yield f"seqmaps/{split}.txt: does not list the sequences of its split"
        for scene, one in about["scenes"].items():
            yield from _mot_problems(folder, f"{one['split']}/{scene}", one)


def _seqinfo(part: DatasetScene, image: str) -> str:
    """Return ``seqinfo.ini``; readers expect this order and a whole frame rate."""
    rows, columns = part.shape
    values = {"name": part.scene, "imDir": "img1", "frameRate": max(round(part.frame_rate_hz), 1), "seqLength": len(part.pictures)}
    values |= {"imWidth": columns, "imHeight": rows, "imExt": f".{image}"}
    return "[Sequence]\n" + "".join(f"{name}={value}\n" for name, value in values.items())


def _mot_line(part: DatasetScene, row: DatasetObject, numbers: Mapping[str, int]) -> str:
    """Return ``frame,object,left,top,width,height,considered,class,visible share`` of a visible object.

    Readers accept an object once in a frame: of one over the seam of a panorama it is the greater piece, with its part of the share.
    """
    piece = max(row.pieces, key=lambda one: one.area)
    left, top, width, height = piece.box
    visible = (row.values["visible_share"] or 0.0) * piece.area / sum(one.area for one in row.pieces)
    considered = int(not part.ignores(row))  # scores leave out boxes with 0
    place = f"{row.frame + 1},{row.number + 1},{left + 1},{top + 1},{width},{height}"
    return f"{place},{considered},{numbers[part.categories[row.number]]},{visible:.6g}\n"


def _mot_problems(folder: Path, sequence: str, one: Mapping[str, Any]) -> Iterator[str]:
    info = configparser.ConfigParser()
    info.read(folder / sequence / "seqinfo.ini", encoding="utf-8")
    sizes = {"seqLength": len(one["images"]), "imWidth": one["width"], "imHeight": one["height"]}
    if any(info.get("Sequence", name, fallback="") != str(value) for name, value in sizes.items()):
        yield f"{sequence}/seqinfo.ini: does not state the frames and pixels of its pictures"
    classes = len((folder / sequence / "gt" / "labels.txt").read_text(encoding="utf-8").splitlines())
    known: set[tuple[int, int]] = set()
    for line in (folder / sequence / "gt" / "gt.txt").read_text(encoding="utf-8").splitlines():
        try:
            frame, number, left, top, width, height, _, kind = map(int, line.split(",")[:8])
            visible = float(line.split(",")[8])
        except (ValueError, IndexError):
            yield f"{sequence}/gt/gt.txt: '{line}' is not nine numbers"
            continue
        inside = 1 <= left <= one["width"] - width + 1 and 1 <= top <= one["height"] - height + 1
        sound = 1 <= frame <= len(one["images"]) and number >= 1 and 1 <= kind <= classes and 0.0 <= visible <= 1.0
        if not (inside and sound and min(width, height) >= 1 and (frame, number) not in known):
            yield f"{sequence}/gt/gt.txt: '{line}' is no box within the picture of an object that is once in a frame"
        known.add((frame, number))


#: Frames of a stack: readers take the last five, of which the last one is the labelled frame.
STACK: Final = 5


class NudtMirsdt(DatasetFormat):
    """Folders of sequences as NUDT-MIRSDT has them, in the form that the loaders of DTUM and DeepPro read."""

    name: ClassVar[str] = "nudt-mirsdt"
    layout: ClassVar[str] = (
        "`SCENE/` with `images/00001.png`, `masks/` and `masks_centroid/` (0 and 255) and `Mix/00001.mat` (array `Mix` of the "
        "frame and the four before it); `train.txt`, `val.txt`, `test.txt` list the stacks"
    )
    folders: ClassVar[tuple[str, ...]] = ()
    sequences: ClassVar[bool] = True

    @classmethod
    def frame_name(cls, scene: str, frame: int, place: int) -> str:
        """Return the name of a picture, which counts from 1 without gaps."""
        return f"{scene}/{place + 1:05d}"

    @classmethod
    def image_path(cls, folder: Path, split: str, name: str, image: str, beside: str = "") -> Path:
        """Return the place of a picture, in the folder of its sequence."""
        return _beside(folder, name, f"images{beside}", image)

    @classmethod
    def write_scene(cls, folder: Path, part: DatasetScene, image: str) -> None:
        """Write masks, masks of centroids, and stacks."""
        for directory in ("masks", "masks_centroid", "Mix"):
            (folder / part.scene / directory).mkdir(parents=True, exist_ok=True)
        whole = masks(part)
        recent: deque[NDArray[Any]] = deque(maxlen=STACK)
        for place, picture in enumerate(part.pictures):
            write_mask(_beside(folder, picture.name, "masks", "png"), whole[picture.name])
            write_mask(_beside(folder, picture.name, "masks_centroid", "png"), _centroids(part, place))
            recent.append(cls.picture(folder, part, place, image))
            # Before the first frame there is none: it is repeated.
            stack = np.stack([recent[0]] * (STACK - len(recent)) + list(recent))
            _write_stack(_beside(folder, picture.name, "Mix", "mat"), stack)

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write ``SPLIT.txt``, the stacks of a split."""
        for split in SPLITS:
            paths = [_beside(Path(), picture.name, "Mix", "mat") for part in catalogue.of_split(split) for picture in part.pictures]
            write_text("".join(f"{path.as_posix()}\n" for path in paths), folder / f"{split}.txt")

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield lists that do not name every frame, and masks and stacks that are not of their pictures."""
        for split in SPLITS:
            names = [name for one in about["scenes"].values() if one["split"] == split for name in one["images"]]
            listed = (folder / f"{split}.txt").read_text(encoding="utf-8").split()
            if listed != [_beside(Path(), name, "Mix", "mat").as_posix() for name in names]:
                yield f"{split}.txt: does not list the frames of its split"
        names = [name for one in about["scenes"].values() for name in one["images"]]
        faults = [
            fault
            for name in names
            for directory in ("masks", "masks_centroid")
            for fault in mask_problems(folder, _beside(folder, name, directory, "png"), _beside(folder, name, "images", about["image"]))
        ]
        yield from faults
        if not faults:
            yield from mask_box_problems(folder, about, {name: _beside(folder, name, "masks", "png") for name in names})
        for name in names:
            yield from _stack_problems(folder, name, about["image"])


def _beside(folder: Path, name: str, directory: str, ending: str) -> Path:
    """Return the file of a frame in one of the directories of its sequence."""
    scene, number = name.split("/")
    return folder / scene / directory / f"{number}.{ending}"


def _centroids(part: DatasetScene, place: int) -> NDArray[np.bool_]:
    """Return a mask of the pixels nearest to the centroids of the objects of a frame that are visible and not ignored."""
    out = np.zeros(part.shape, bool)
    for row in part.rows:
        centre = row.values["row_px"], row.values["column_px"]
        if row.frame == place and row.pieces and not part.ignores(row) and centre[0] is not None and centre[1] is not None:
            r, c = round(centre[0]), round(centre[1])
            # A centroid beyond the edge is that of an object cut by the edge.
            out[min(max(r, 0), part.shape[0] - 1), min(max(c, 0), part.shape[1] - 1)] = True
    return out


def _write_stack(path: Path, stack: NDArray[Any]) -> None:
    """Write a stack [(frames, rows, columns)] as the array ``Mix`` of a MAT file; equal stacks are equal bytes."""
    from scipy.io import savemat

    with moved_when_whole(path) as partial:
        savemat(partial, {"Mix": stack}, appendmat=False, do_compression=True)
        with partial.open("r+b") as file:
            # The first 116 bytes are free text, in which SciPy writes the date.
            file.write(b"MATLAB 5.0 MAT-file, seaglint".ljust(116))


def _stack_problems(folder: Path, name: str, image: str) -> Iterator[str]:
    """Yield a stack that cannot be read, or does not end with its picture."""
    from scipy.io import loadmat

    path = _beside(folder, name, "Mix", "mat")
    try:
        stack, levels = loadmat(path)["Mix"], read_picture(_beside(folder, name, "images", image))
    except DataError as error:
        yield str(error)
    except Exception as error:  # SciPy raises nearly anything
        yield f"{path.relative_to(folder).as_posix()}: cannot be read as a stack ({type(error).__name__})"
    else:
        if stack.shape != (STACK, *levels.shape) or not np.array_equal(stack[-1], levels):
            yield f"{path.relative_to(folder).as_posix()}: is not {STACK} frames that end with its picture"
