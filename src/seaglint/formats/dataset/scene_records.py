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

LEAST_SNR: Final = 1.0  #: Default of ``min_snr``: a weaker object is not visible in a single picture.

#: Least signal-to-noise ratio, visible share and pixels of the mask of each class of difficulty; what reaches none is ``HARD``.
DIFFICULTIES: Final = (("easy", 7.0, 0.85, 4), ("medium", 3.0, 0.5, 1))

HARD: Final = "hard"

_GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


def splits_of(seed: int, scenes: int, fractions: tuple[float, float, float]) -> list[str]:
    """Return the splits of scenes 0, 1, ...: that of a scene depends on seed and scenes before it, so that scenes added later move none.

    The first scenes go to each split with a share, so that few scenes have all of them: training first, then validation. A further scene
    ``n`` has the number ``u + n g`` modulo 1, with ``g`` the golden section and ``u`` drawn from the seed, which fills its interval evenly
    and without a period; it trains where this is below the first fraction, and so on. Where this split has its share already, or another
    one is a whole scene behind, the scene goes to the split that is furthest behind. So of N scenes each split has its fraction of N to
    within about one, and up to two where fractions are small, since the first scenes go to each split.

    Examples
    --------
    >>> splits_of(1, 5, (0.7, 0.15, 0.15)), splits_of(1, 2, (1.0, 0.0, 0.0))
    (['train', 'val', 'test', 'train', 'train'], ['train', 'train'])
    """
    used = [k for k in range(len(SPLITS)) if fractions[k] > 0.0]
    start = float(stream(seed, "dataset split").random())
    counts, out = [0] * len(SPLITS), list[str]()
    for scene in range(scenes):
        place, below, drawn = (start + scene * _GOLDEN) % 1.0, 0.0, used[-1]
        for k in used[:-1]:
            below += fractions[k]
            if place < below:
                drawn = k
                break
        behind = [fractions[k] * (scene + 1) - counts[k] for k in range(len(SPLITS))]
        most = max(used, key=behind.__getitem__)
        chosen = used[scene] if scene < len(used) else most if behind[most] >= 1.0 or behind[drawn] <= 0.0 else drawn
        counts[chosen] += 1
        out.append(SPLITS[chosen])
    return out


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
    mean_snr: float | None  #: Absolute local contrast over the standard deviation around the mask.
    snr: float | None  #: Largest change of a pixel by the object, without noise, over the standard deviation around the mask.
    pieces: tuple[Piece, ...]  #: Visible pieces; empty for an object out of view.

    @property
    def area(self) -> int:
        """Return the pixels of the mask."""
        return sum(piece.area for piece in self.pieces)


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
    masks: str  #: Kind of the masks.
    min_snr: float  #: Signal-to-noise ratio below which objects are ignored.

    def ignores(self, row: DatasetObject) -> bool:
        """Return True for an object in view that is too weak to be seen: neither its detection nor its miss counts."""
        return bool(row.pieces) and row.snr is not None and row.snr < self.min_snr

    def difficulty(self, row: DatasetObject) -> str | None:
        """Return the class of difficulty of an object; None for one out of view or ignored, or of unknown ratio or visible share."""
        visible = row.values.get("visible_share")
        if not row.pieces or self.ignores(row) or row.snr is None or visible is None:
            return None
        for name, ratio, share, pixels in DIFFICULTIES:
            if row.snr >= ratio and visible >= share and row.area >= pixels:
                return name
        return HARD

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
                "ignore": part.ignores(row),
                "difficulty": part.difficulty(row),
                "mask_pixels": row.area,
                "local_contrast_W_m2_sr": row.local_contrast,
                "mean_snr": row.mean_snr,
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
    *("ignore", "difficulty", "mask_pixels", "local_contrast_W_m2_sr", "mean_snr", "snr"),
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
