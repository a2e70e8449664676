"""Records of the scenes of a data set, from which all layouts and tables are written, and the interface of a layout.

Each scene belongs to one split: training, validation or test.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

from seaglint.base.errors import DataError
from seaglint.base.free_form import TableRow
from seaglint.base.random import stream
from seaglint.base.schema import NUMBERS
from seaglint.formats.dataset.grey_pictures import read_picture
from seaglint.formats.dataset.picture_levels import PictureLevels
from seaglint.store.outputs import read_json, write_json

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


SPLITS: Final = ("train", "val", "test")

_GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


def split_of(seed: int, scene: int, fractions: tuple[float, float, float]) -> str:
    """Return the split of a scene: a function of seed and number alone, so that scenes added later move none.

    Scene ``n`` has the number ``u + n g`` modulo 1, with ``g`` the golden section and ``u`` drawn from the seed; it trains where this is
    below the first fraction, and so on. Numbers of this kind fill their interval evenly: of N scenes a split has its fraction of N to
    within about two, and all parts of a long list have their share.

    >>> [split_of(1, n, (1.0, 0.0, 0.0)) for n in range(2)]
    ['train', 'train']
    """
    place = (float(stream(seed, "dataset split").random()) + scene * _GOLDEN) % 1.0
    below = 0.0
    for name, fraction in zip(SPLITS[:2], fractions[:2], strict=True):
        below += fraction
        if place < below:
            return name
    # the last one: sums of fractions may end a rounding below 1
    return "test" if fractions[2] > 0.0 else "val" if fractions[1] > 0.0 else "train"


FOLDER: Final = ".parts"  #: Folder of the records while a data set is made.


@dataclass(frozen=True)
class Entry:
    """Finished scene store that goes into a data set."""

    name: str
    store: str  #: Path of the store.
    split: str
    parameters: Mapping[str, Any]  #: Drawn values by column.


@dataclass(frozen=True)
class Piece:
    """Visible piece of an object in a picture; one that spans the seam of a panorama has two pieces."""

    box: tuple[int, int, int, int]  #: First column and row, columns and rows.
    area: int  #: Pixels of the mask.
    counts: str  #: Run lengths of the mask.


@dataclass(frozen=True)
class DatasetObject:
    """Object in a frame, in view or not."""

    frame: int  #: Index of the picture in the record.
    number: int  #: Number of the object in its scene, from 0.
    values: Mapping[str, float | None]  #: Numbers of the truth by name; None where not known.
    local_contrast: float | None  #: Mean over its mask above the mean around it, in the delivered picture [W m-2 sr-1].
    snr: float | None  #: Local contrast over the standard deviation around the mask.
    pieces: tuple[Piece, ...]  #: Visible pieces; empty for an object out of view.


@dataclass(frozen=True)
class DatasetFrame:
    """Frame of a scene."""

    name: str  #: Name of its picture, with slashes where a scene has a folder, and without ending.
    frame: int
    time_s: float
    #: Levels of its pictures: of the first one, and of the one of 16 bits beside it; none where the store itself is delivered.
    levels: tuple[PictureLevels, ...] = ()
    clipped_px: int = 0  #: Pixels of the first picture that are clipped to its first or last level.

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Return the relations of its levels by their names in tables; those of the second picture end in ``_16``."""
        if not self.levels:
            return {}
        first, *second = (levels.attributes for levels in self.levels)
        beside = {f"{name}_16": value for one in second for name, value in one.items() if name not in ("bits", "radiance_units")}
        return {**first, **beside, "clipped_px": self.clipped_px}


@dataclass(frozen=True)
class DatasetScene:
    """Scene of a data set."""

    scene: str
    split: str
    seed: int
    shape: tuple[int, int]  #: Rows and columns.
    frame_rate_hz: float
    names: tuple[str, ...]  #: Names of the objects.
    categories: tuple[str, ...]  #: Categories of the objects.
    pictures: tuple[DatasetFrame, ...]
    rows: tuple[DatasetObject, ...]
    parameters: Mapping[str, Any]

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Return the relations of levels that all of its frames share, and the sum of clipped pixels."""
        every = [picture.attributes for picture in self.pictures]
        shared = {name: value for name, value in every[0].items() if all(one[name] == value for one in every)}
        return {**shared, "clipped_px": sum(picture.clipped_px for picture in self.pictures)} if shared else {}

    def write(self, folder: Path) -> None:
        """Write the record; its presence marks the scene's pictures as complete."""
        write_json(asdict(self), part_path(folder, self.scene), indent=None)

    @classmethod
    def read(cls, folder: Path, scene: str) -> DatasetScene:
        """Read a scene's record.

        Raises
        ------
        DataError
            It is not one.
        """
        path = part_path(folder, scene)
        again = "remove it and go on with resume=True"
        raw = read_json(path, again)
        try:
            pieces = [tuple(Piece(tuple(p["box"]), p["area"], p["counts"]) for p in row["pieces"]) for row in raw["rows"]]
            rows = tuple(DatasetObject(**{**row, "pieces": visible}) for row, visible in zip(raw["rows"], pieces, strict=True))
            # JSON has lists for tuples, and tables for records.
            frames = [{**one, "levels": tuple(PictureLevels(**levels) for levels in one["levels"])} for one in raw["pictures"]]
            changed = {
                "shape": tuple(raw["shape"]),
                "names": tuple(raw["names"]),
                "categories": tuple(raw["categories"]),
                "pictures": tuple(DatasetFrame(**frame) for frame in frames),
                "rows": rows,
            }
            return cls(**{**raw, **changed})
        except (ValueError, KeyError, TypeError) as error:
            raise DataError(f"{path}: is not readable ({error}); {again}") from error


def part_path(folder: Path, scene: str) -> Path:
    """Return the file of a scene's record."""
    return folder / FOLDER / f"{scene}.json"


@dataclass(frozen=True)
class Catalogue:
    """All scenes of a data set, in their order."""

    title: str
    seed: int
    image: str  #: Ending of pictures.
    parts: Sequence[DatasetScene]

    @property
    def categories(self) -> tuple[str, ...]:
        """Return the names of categories in alphabetical order."""
        return tuple(sorted({name for part in self.parts for name in part.categories}))

    def of_split(self, split: str) -> list[DatasetScene]:
        """Return the scenes of a split."""
        return [part for part in self.parts if part.split == split]

    def tracks(self) -> dict[str, int]:
        """Return the number of each scene's first object, counted from 1 over all scenes."""
        out, count = {}, 1
        for part in self.parts:
            out[part.scene] = count
            count += len(part.names)
        return out

    def truth(self) -> list[TableRow]:
        """Return one row for each object and frame."""
        tracks = self.tracks()
        return [
            {
                "scene": part.scene,
                "split": part.split,
                "image": part.pictures[row.frame].name,
                "frame": part.pictures[row.frame].frame,
                "time_s": part.pictures[row.frame].time_s,
                "object": part.names[row.number],
                "object_id": row.number + 1,
                "track_id": tracks[part.scene] + row.number,
                "category": part.categories[row.number],
                "annotated": bool(row.pieces),
                "local_contrast_W_m2_sr": row.local_contrast,
                "snr": row.snr,
                **row.values,
            }
            for part in self.parts
            for row in part.rows
        ]

    def parameters(self) -> list[TableRow]:
        """Return one row for each scene: the drawn values, and the linear relation of its levels."""
        columns = list(dict.fromkeys(name for part in self.parts for name in part.parameters))
        rows: list[TableRow] = []
        for part in self.parts:
            about = {"scene": part.scene, "split": part.split, "frames": len(part.pictures), "frame_rate_hz": part.frame_rate_hz}
            drawn = {name: part.parameters.get(name) for name in columns if name not in about}
            rows.append({**about, **drawn, **part.attributes})
        names = list(dict.fromkeys(name for row in rows for name in row))
        return [{name: row.get(name) for name in names} for row in rows]


#: Columns of the truth table.
TRUTH_COLUMNS: Final = (
    *("scene", "split", "image", "frame", "time_s", "object", "object_id", "track_id", "category", "annotated"),
    *("local_contrast_W_m2_sr", "snr"),
    *NUMBERS,
)


def known(value: float) -> float | None:
    """Return a number, or None for NaN, which JSON does not have."""
    return None if math.isnan(value) else float(value)


class DatasetFormat:
    """Format of a data set; each is a class of ``seaglint.formats.dataset.layouts``, listed in ``FORMATS`` of the package."""

    name: ClassVar[str]  #: Name by which users choose it.
    layout: ClassVar[str]  #: Sentence of the data card on its files.
    note: ClassVar[str] = ""  #: Remark of the help on it.
    folders: ClassVar[tuple[str, ...]]  #: Folders that are made before the first scene is written.
    pictures: ClassVar[bool] = True  #: True where scenes become pictures; otherwise they stay stores.
    sequences: ClassVar[bool] = False  #: True where scenes are sequences, of two frames at least.

    @classmethod
    def frame_name(cls, scene: str, frame: int, place: int) -> str:
        """Return the name of a picture from the number of its frame, and its place in the scene from 0."""
        return f"{scene}_{frame:06d}"

    @classmethod
    def image_path(cls, folder: Path, split: str, name: str, image: str, beside: str = "") -> Path:
        """Return the place of a picture; ``image`` is the ending of pictures, ``beside`` that of the folder: "16" of the second ones."""
        return folder / f"images{beside}" / f"{name}.{image}"

    @classmethod
    def store(cls, folder: Path, scene: str) -> Path | None:
        """Return the place of a scene's store in the data set's folder; None where the format keeps pictures alone."""
        return None

    @classmethod
    def placed(cls, folder: Path, entry: Entry) -> Entry:
        """Copy a scene into the data set's folder where the format keeps stores, and return the scene to convert."""
        return entry

    @classmethod
    def write_scene(cls, folder: Path, part: DatasetScene, image: str) -> None:
        """Write the files of a scene other than its pictures that need no other scene; ``image`` is the ending of its pictures."""

    @classmethod
    def picture(cls, folder: Path, part: DatasetScene, place: int, image: str) -> NDArray[np.generic]:
        """Return a picture of a written scene (rows, columns), by its place among the scene's."""
        return read_picture(cls.image_path(folder, part.split, part.pictures[place].name, image))

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write labels and lists that need all scenes.

        ``about`` has the data set's ``title``, ``licence``, ``version`` and ``seed``, and ``folder``, the final name of its folder.
        """

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield a line for each fault of what ``write`` wrote; ``about`` is ``dataset.json``."""
        yield from ()
