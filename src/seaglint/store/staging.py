"""Stages: folders in which work is written before the process that holds the claim moves it to its place.

A process that stops between the check of its claim and a write can wake at any later time: after the end of the work, or while another
process works under the same name. Therefore no file is written in its place. It is written in a stage, a folder that carries the token of
the claim, and is moved from there. The next owner of the claim, and the end of the work, remove the stage; whatever a process wants to
write or move later then fails, because no folder of a path is ever made anew. Neither times of files nor clocks are compared.

Workers have no claim of their own. They write their units in the stage of the process that assigned them, which moves each unit once.
"""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.parse import unquote

from seaglint.store.shards import DONE


def token() -> str:
    """Return a random text for a name that no other process chooses."""
    return secrets.token_hex(8)


@contextmanager
def staged(root: Path, name: str, keep: Callable[[Path], None] = lambda stage: None) -> Iterator[Path]:
    """Provide the new folder ``root/name``, which is removed at the end; ``root`` is made where it is missing and removed when empty.

    Parameters
    ----------
    root : Path
        Folder of all stages of one output; the folder above it exists.
    name : str
        Name of the stage; it contains the token of its claim.
    keep : callable
        Called with the stage at the end, when no other process can write there any more.
    """
    stage = root / name
    while not stage.exists():
        root.mkdir(exist_ok=True)
        with suppress(FileNotFoundError):  # the owner of another stage removed the empty folder in between
            stage.mkdir()
    try:
        yield stage
    finally:
        with suppress(OSError):  # what stays is removed by the next owner
            remove_folder(stage, keep)
        with suppress(OSError):
            root.rmdir()


def remove_stages(root: Path, prefix: str = "", own: str | None = None, keep: Callable[[Path], None] = lambda stage: None) -> None:
    """Remove the stages that earlier owners of a claim left: those whose names begin with ``prefix``, without ``own``."""
    with suppress(FileNotFoundError):
        for name in sorted(os.listdir(root)):
            if name.startswith(prefix) and name != own:
                remove_folder(root / name, keep)
    with suppress(OSError):
        root.rmdir()


def remove_folder(folder: Path, keep: Callable[[Path], None] = lambda folder: None) -> None:
    """Remove a folder that another process may be writing into; ``keep`` is called before with the folder under its last name.

    The folder is renamed first, so that nothing more can be made in it by its path.
    """
    gone = folder.with_name(f"{folder.name}.{token()}.gone")
    try:
        folder.rename(gone)
    except FileNotFoundError:
        return
    # After an error or an interruption the folder stays, for the next process that claims the output.
    keep(gone)
    # The second attempt removes what was made at the moment of the renaming.
    for _ in range(2):
        shutil.rmtree(gone, ignore_errors=True)


def make_below(folder: Path, name: str) -> None:
    """Make the folders of a path below a folder that exists; unlike ``mkdir(parents=True)`` never that folder itself."""
    for part in Path(name).parts:
        folder /= part
        folder.mkdir(exist_ok=True)


def copy_folder(source: Path, target: Path) -> None:
    """Copy a folder with its files; the folder above ``target`` exists, and is not made anew where it is removed meanwhile."""
    target.mkdir()
    for entry in sorted(source.iterdir()):
        if entry.is_dir():
            copy_folder(entry, target / entry.name)
        else:
            shutil.copyfile(entry, target / entry.name)


def move(source: Path, target: Path) -> None:
    """Move a file or folder; it replaces a file, and the files of a folder replace those of the same names."""
    try:
        os.replace(source, target)
    except OSError:
        if not (source.is_dir() and target.is_dir()):
            raise
        for name in sorted(os.listdir(source)):
            move(source / name, target / name)
        source.rmdir()


def best_attempt(unit: Path) -> Path | None:
    """Return the complete attempt of a unit with the most frames."""
    try:
        names = [name for name in os.listdir(unit) if not name.endswith(".new")]
    except FileNotFoundError:
        return None
    return unit / max(names) if names else None


def take_unit(attempt: Path, store: Path) -> None:
    """Move a unit from its stage into the store, the marks of finished frames last; the process holds the claim on the store."""
    # Texts and not paths: thousands of units a second pass here.
    here, there = f"{attempt}{os.sep}", f"{store}{os.sep}"
    for name in sorted(os.listdir(attempt), key=lambda name: (name.startswith(DONE), name)):
        if name.startswith("-"):
            (store / unquote(name[1:])).unlink(missing_ok=True)
            os.unlink(here + name)
            continue
        try:
            os.replace(here + name, there + unquote(name))
        except OSError:
            source, target = attempt / name, store / unquote(name)
            if not source.exists():
                raise
            target.parent.mkdir(exist_ok=True)  # the first chunk of an array
            move(source, target)
    # Other attempts of the unit, which come too late, remain until the stage is removed.
    with suppress(OSError):
        attempt.rmdir()
        attempt.parent.rmdir()
