"""Data sets that keep the scenes' stores as they are: sequences with their truth, in Zarr."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.counts import pictures
from seaglint.files.dataset.dataset_format import DatasetFormat
from seaglint.files.dataset.grey_levels import Bits

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seaglint.files.dataset.part import DatasetScene, Entry


class Stores(DatasetFormat):
    """Copies of the scenes' stores; no pictures."""

    name: ClassVar[str] = "zarr"
    bits: ClassVar[Bits] = 16
    layout: ClassVar[str] = "`scenes/NAME.zarr`, sequences as seaglint writes them, with their truth"
    note: ClassVar[str] = "the scenes' stores as they are"
    folders: ClassVar[tuple[str, ...]] = ("scenes",)
    pictures: ClassVar[bool] = False

    @classmethod
    def placed(cls, folder: Path, entry: Entry) -> Entry:
        """Copy a scene's store into the data set, whole or not at all."""
        stored = _store(folder, entry.name)
        if not stored.exists():
            stored.parent.mkdir(parents=True, exist_ok=True)
            fresh = stored.with_name(stored.name + ".partial")
            if fresh.exists():
                shutil.rmtree(fresh)
            shutil.copytree(Path(entry.store), fresh)
            fresh.rename(stored)
        return replace(entry, store=str(stored))

    @classmethod
    def picture(cls, folder: Path, part: DatasetScene, place: int, image: str) -> NDArray[np.generic]:
        """Return a frame of a stored scene (rows, columns)."""
        from seaglint.files.store.store import open_sequence

        with open_sequence(_store(folder, part.scene)) as dataset:
            return np.asarray(pictures(dataset)[place].to_numpy())

    @classmethod
    def problems(cls, folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
        """Yield stores that cannot be read, or have other frames and pixels than ``dataset.json`` says."""
        from seaglint.files.store.store import open_sequence

        for scene, one in about["scenes"].items():
            path = _store(folder, scene)
            try:
                with open_sequence(path) as dataset:
                    shape = (dataset.sizes["time"], dataset.sizes["y"], dataset.sizes["x"])
                    if shape != (len(one["images"]), one["height"], one["width"]):
                        yield f"{path.name}: has not the frames and pixels that dataset.json tells"
            except DataError as error:
                yield str(error)


def _store(folder: Path, scene: str) -> Path:
    return folder / "scenes" / f"{scene}.zarr"
