"""Attempts of scenes by workers, in the stage of the process that assigned them and moves them to their places.

A scene is rendered into a store by one process at a time, which a lock on the store ensures. An attempt continues the store of an earlier
one whose process has ended; while that process still holds the lock, even suspended, the scene is rendered anew in a separate folder.
When a job ends before a scene, the store with the most frames is moved to the place of the scene, under the name of an unfinished one,
from where the next job continues it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

from seaglint.store.sequence_store import partial_path
from seaglint.store.shards import DONE
from seaglint.store.staging import remove_folder, remove_stages, staged, token
from seaglint.store.writers import BeingWrittenError, Claim

STAGES: Final = ".stages"  #: Folder of the stages in the folder of an ensemble or data set.


@contextmanager
def scene_stage(
    folder: Path, claim: Claim, places: Mapping[str, Path], keep_files: Callable[[str, Path], None] = lambda label, scene: None
) -> Iterator[Path]:
    """Provide the stage of a job; at the beginning and at the end unfinished scenes of earlier attempts are moved to their places.

    Parameters
    ----------
    folder : Path
        Folder of the ensemble or data set.
    claim : Claim
        Claim of the job on it.
    places : mapping
        Places of the scenes' stores by their labels.
    keep_files : callable
        ``keep_files(label, attempts)`` moves what else a complete attempt has made, from the folder of all attempts of the scene.
    """

    def keep(stage: Path) -> None:
        for label in sorted(os.listdir(stage)):
            keep_files(label, stage / label)
            if label in places:
                _keep_scene(stage / label, places[label])

    remove_stages(folder / STAGES, keep=keep)
    with staged(folder / STAGES, f"whole-{claim.token}", keep) as stage:
        yield stage


def forget_attempts(folder: Path) -> None:
    """Remove the stages of earlier jobs with all that is in them."""
    remove_stages(folder / STAGES)


def rendered_store(stage: Path, label: str, place: Path, render: Callable[[Path], None]) -> Path:
    """Return the complete store of a scene, rendered by ``render(store)`` in the stage.

    ``place`` is the place of the scene's store; an unfinished store there is moved into the stage and continued.
    """
    scene = scene_folder(stage, label)
    for earlier in sorted(scene.glob("store-*")):
        store = earlier / place.name
        with suppress(BeingWrittenError):
            if not store.exists():
                render(store)
            return store
    fresh = scene / f"store-{token()}"
    fresh.mkdir()
    with suppress(FileNotFoundError):  # another attempt may have moved it
        partial_path(place).rename(fresh / partial_path(place).name)
    render(fresh / place.name)
    return fresh / place.name


def scene_folder(stage: Path, label: str) -> Path:
    """Return the folder of the attempts of a scene, made where it is missing; the stage exists."""
    scene = stage / label
    scene.mkdir(exist_ok=True)
    return scene


def forget_scene(stage: Path, label: str) -> None:
    """Remove the attempts of a scene that is complete."""
    with suppress(OSError):
        remove_folder(stage / label)


def _keep_scene(scene: Path, place: Path) -> None:
    """Move the most complete store of a scene to its place, unless one is there."""
    whole, begun = (sorted(scene.glob(f"store-*/{name}")) for name in (place.name, partial_path(place).name))
    if place.exists() or partial_path(place).exists():
        return
    if whole:
        whole[0].rename(place)
    elif begun:
        max(begun, key=_frames).rename(partial_path(place))


def _frames(store: Path) -> int:
    """Return the number of frames in a store; -1 where it cannot be read."""
    import zarr

    try:
        group: Any = zarr.open_group(store, mode="r", zarr_format=3)
        return int(group[DONE][:].sum())
    except Exception:  # whatever was cut, another one has more
        return -1
