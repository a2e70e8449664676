"""Check of a data set: files and checksums, pictures, boxes and masks, and splits that share nothing."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.dataset import format_named
from seaglint.files.dataset.dataset_format import DatasetFormat
from seaglint.files.dataset.grey_picture import read_picture
from seaglint.files.tables.rows import read_rows
from seaglint.files.text_file import read_json, read_text, write_text

SUMS: Final = "SHA256SUMS"
ABOUT: Final = "dataset.json"
KIND: Final = "seaglint-dataset-1"  #: What ``kind`` of ``dataset.json`` says of our data sets.


def files(folder: Path) -> list[str]:
    """All files of a data set but the checksums themselves, with slashes, in order."""
    paths = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return sorted(path.as_posix() for path in paths if path.as_posix() != SUMS and not path.parts[0].startswith("."))


def write_sums(folder: Path) -> None:
    """Write the checksums of all files, as ``sha256sum`` does."""
    write_text("".join(f"{_digest(folder / name)}  {name}\n" for name in files(folder)), folder / SUMS)


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_about(folder: Path) -> JsonObject:
    """``dataset.json``.

    Raises
    ------
    DataError
        No data set of ours.
    """
    try:
        about = read_json(folder / ABOUT, "")
        if about["kind"] == KIND:
            return dict(about)
    except (DataError, KeyError, TypeError):
        pass
    raise DataError(f"{folder}: is no data set of seaglint: it has no readable {ABOUT}; give a folder that 'seaglint dataset' made")


def problems(folder: Path) -> Iterator[str]:
    """Return the faults of a data set, a line each; nothing where it is whole.

    Raises
    ------
    DataError
        No data set of ours.
    """
    about = read_about(folder)
    try:
        lines = read_text(folder / SUMS, "").splitlines()
        sums = {name: digest for digest, name in (line.split("  ", 1) for line in lines)}
    except (DataError, ValueError):
        yield f"{SUMS}: is missing or cut"
        return
    here = files(folder)
    missing = sorted(set(sums) - set(here))
    yield from (f"{name}: is missing" for name in missing)
    yield from (f"{name}: is not in {SUMS}" for name in sorted(set(here) - set(sums)))
    yield from (f"{name}: its checksum is another than in {SUMS}" for name in here if name in sums and _digest(folder / name) != sums[name])
    if missing:
        return
    yield from _split_problems(folder, about)
    form = format_named(about["format"])
    if form.pictures:
        yield from _picture_problems(folder, about, form)
    yield from form.problems(folder, about)


def _split_problems(folder: Path, about: Mapping[str, Any]) -> Iterator[str]:
    """No scene in two splits, whichever file is asked."""
    for name in ("parameters.csv", "truth.csv"):
        for row in read_rows(folder / name):
            recorded = about["scenes"].get(row["scene"], {}).get("split")
            if recorded != row["split"]:
                yield f"{name}: scene {row['scene']} is in '{row['split']}' and in '{recorded}' of {ABOUT}"


def _picture_problems(folder: Path, about: Mapping[str, Any], form: type[DatasetFormat]) -> Iterator[str]:
    for one in about["scenes"].values():
        for picture in one["images"]:
            path = form.image_path(folder, one["split"], picture, about["image"])
            try:
                levels = read_picture(path)
            except DataError as error:
                yield str(error)
                continue
            if levels.shape != (one["height"], one["width"]) or 8 * levels.dtype.itemsize != about["bits"]:
                size = f"{levels.shape[1]} x {levels.shape[0]} pixels of {8 * levels.dtype.itemsize} bits"
                yield f"{path.name}: has {size}, not {one['width']} x {one['height']} of {about['bits']}"
