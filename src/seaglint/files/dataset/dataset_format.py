"""Interface of a format of data sets: where pictures lie, which files stand beside them, and how these are checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from seaglint.files.dataset.grey_levels import Bits
from seaglint.files.dataset.grey_picture import read_picture

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from seaglint.files.dataset.part import Catalogue, DatasetScene, Entry


class DatasetFormat:
    """Format of a data set; each is a class in a file of its own, listed in ``FORMATS`` of :mod:`seaglint.files.dataset`."""

    name: ClassVar[str]  #: Name by which users choose it.
    bits: ClassVar[Bits]  #: Bits of a pixel where none are requested: those that the programs expect which read the format.
    layout: ClassVar[str]  #: Sentence of the data card on its files.
    note: ClassVar[str] = ""  #: Remark of the help on it.
    folders: ClassVar[tuple[str, ...]]  #: Folders that are made before the first scene is written.
    pictures: ClassVar[bool] = True  #: Whether scenes become pictures; otherwise they stay stores.

    @classmethod
    def image_path(cls, folder: Path, split: str, name: str, image: str) -> Path:
        """Return the place of a picture; ``image`` is the ending of pictures."""
        return folder / "images" / f"{name}.{image}"

    @classmethod
    def placed(cls, folder: Path, entry: Entry) -> Entry:
        """Make room for a scene in the data set's folder, and return the scene as it is converted from there."""
        return entry

    @classmethod
    def picture(cls, folder: Path, part: DatasetScene, place: int, image: str) -> NDArray[np.generic]:
        """Return a picture of a written scene (rows, columns), by its place among the scene's."""
        return read_picture(cls.image_path(folder, part.split, part.pictures[place].name, image))

    @classmethod
    def write(cls, folder: Path, catalogue: Catalogue, about: Mapping[str, Any]) -> None:
        """Write labels and lists of all scenes; ``about`` has the data set's ``title``, ``licence``, ``version`` and ``seed``."""

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield a line for each fault of what :meth:`write` wrote; ``about`` is ``dataset.json``."""
        yield from ()
