"""Scenes of a data set over workers: the worker that draws a scene makes its pictures, from memory where the scene is short.

Workers write into a stage, from which the process that makes the data set moves the files of a complete scene, its record last.

A scene that is held in memory is written once, as pictures. A longer one goes through a store, so that an interruption costs no more than
a frame; the store is removed when the pictures are written, unless the format keeps it.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, StorageError
from seaglint.base.threads import thread_limit
from seaglint.cluster import Done, Job, ThisProcess, Workers
from seaglint.formats.dataset import format_named
from seaglint.formats.dataset.dataset_writing import ConversionSettings, convert
from seaglint.formats.dataset.labelled_scene import LabelledScene
from seaglint.formats.dataset.scene_records import FOLDER, Entry, part_path
from seaglint.formats.object_labels import RESPONSE
from seaglint.scenario.load import load_scenario
from seaglint.scenario.model import Scenario
from seaglint.store.layout import BITS
from seaglint.store.outputs import stop_on_signal, storage_errors, write_text
from seaglint.store.sequence_store import Interrupted
from seaglint.store.staging import make_below, move, token
from seaglint.store.writers import Claim
from seaglint.studies.ensemble.ensemble_folder import Folder
from seaglint.studies.ensemble.law_draws import prepared
from seaglint.studies.ensemble.render_ensemble import Rendering, render_scene
from seaglint.studies.ensemble.scene_attempts import forget_scene, rendered_store, scene_folder, scene_stage
from seaglint.studies.sequence.memory import give_back
from seaglint.studies.sequence.sequence_work import SceneCache

MOST_FRAMES: Final = 16  #: Largest number of frames that are held in memory: an interruption costs at most these.

MOST_BYTES: Final = 64_000_000  #: Largest size of the frames that are held in memory [bytes].


@dataclass(frozen=True)
class SceneSettings:
    """Settings that a worker needs to write scenes of a data set."""

    conversion: ConversionSettings
    rendering: Rendering | None  #: Folder of drawn scenes that the workers render; None where all scenes have stores.


def write_scenes(
    settings: SceneSettings, entries: Sequence[Entry], failures: Folder, claim: Claim, workers: Workers | None, progress: Progress | None
) -> None:
    """Write the missing scenes; ``failures`` is the folder for the tracebacks of those that fail, ``claim`` is on the data set.

    Raises
    ------
    DataError, StorageError
        Scenes that failed; the others are written.
    Interrupted
        After SIGINT or SIGTERM, between two scenes.
    """
    folder, form = Path(settings.conversion.folder), format_named(settings.conversion.format)
    for name in form.folders:
        make_below(folder, name)
    named = {entry.name: entry for entry in entries}
    places = {} if settings.rendering is None else {entry.name: Path(entry.store) for entry in entries}

    def take(entry: Entry, made: MadeScene) -> None:
        """Move the files of a scene into the data set."""
        if made.store and not form.pictures:
            move(Path(made.store), Path(entry.store))
        for name in sorted(os.listdir(made.files), key=lambda name: (name == FOLDER, name)):
            move(Path(made.files) / name, folder / name)
        if form.pictures and settings.rendering is not None:
            shutil.rmtree(entry.store, ignore_errors=True)

    def take_begun(label: str, scene: Path) -> None:
        """Move the files of a scene that was complete when its job ended."""
        whole = [files for files in sorted(scene.glob("files-*")) if part_path(files, label).is_file()]
        stores = sorted(scene.glob("store-*/*.zarr"))
        if whole and label in named and not part_path(folder, label).is_file():
            take(named[label], MadeScene(str(whole[0]), str(stores[0]) if stores else ""))

    done, failed, report = 0, list[str](), progress or (lambda done, total: None)
    remedy = f"the finished scenes stay in {folder}; make room and go on with resume=True"
    try:
        with ExitStack() as stack:
            with storage_errors(folder, remedy):
                stage = stack.enter_context(scene_stage(folder, claim, places, take_begun)).absolute()
            missing = [entry for entry in entries if not part_path(folder, entry.name).is_file()]
            done = len(entries) - len(missing)
            report(done, len(entries))
            stopped = stack.enter_context(stop_on_signal(at_once=workers is not None))
            job: Job[tuple[SceneSettings, Path], Entry, MadeScene] = Job(start, (settings, stage))
            for outcome in stack.enter_context((workers or ThisProcess()).map(job, missing)):
                trace = failures.failure(outcome.unit.name)
                if isinstance(outcome, Done):
                    with storage_errors(folder, remedy):
                        take(outcome.unit, outcome.record)
                    forget_scene(stage, outcome.unit.name)
                    done += 1
                    trace.unlink(missing_ok=True)
                    report(done, len(entries))
                else:
                    failed.append(f"scene {outcome.unit.name}: {outcome.error}")
                    make_below(folder, str(trace.parent.absolute().relative_to(folder)))
                    write_text(outcome.traceback or f"{outcome.error}\n", trace)
                if stopped:
                    raise KeyboardInterrupt
    except KeyboardInterrupt:
        # workers may have finished scenes that they had no time to report
        done = sum(part_path(folder, entry.name).is_file() for entry in entries)
        raise Interrupted(f"stopped after {done} of {len(entries)} scenes, kept in {folder}; run the same again with resume=True") from None
    if failed:
        error = StorageError if any("StorageError" in line for line in failed) else DataError
        summary = f"{len(failed)} of {len(entries)} scenes failed, their tracebacks are in {failures.failure('').parent}"
        raise error("\n".join([*failed[:20], f"{summary}; the others stay in {folder}; go on with resume=True"]))


@dataclass(frozen=True)
class MadeScene:
    """Paths of a scene in the stage."""

    files: str  #: Folder of the pictures and the record.
    store: str  #: Store that was rendered for it; empty without one.


def start(settings: tuple[SceneSettings, Path]) -> Callable[[Entry], MadeScene]:
    """Return the function of a worker that makes the pictures and the record of a scene in a stage and returns their paths."""
    (scenes, stage), cached = settings, SceneCache()
    rendering, form = scenes.rendering, format_named(scenes.conversion.format)

    def of_store(entry: Entry, store: Path, conversion: ConversionSettings) -> None:
        with LabelledScene.stored(store, conversion.masks) as scene:
            convert(entry, scene, conversion)

    def rendered(entry: Entry, drawn: Rendering, conversion: ConversionSettings) -> str:
        source, store = Folder(drawn.folder).scenario(entry.name), Path(entry.store)
        scenario = load_scenario(source)
        if form.pictures and is_short(scenario):
            convert(entry, held_scene(scenario, source, drawn.threads, cached, conversion.masks), conversion)
            return ""
        if store.exists():
            of_store(entry, store, conversion)
            return ""
        made = rendered_store(stage, entry.name, store, lambda path: render_scene(scenario, path, drawn.threads, cached))
        of_store(entry, made, conversion)
        return str(made)

    def work(entry: Entry) -> MadeScene:
        files = scene_folder(stage, entry.name) / f"files-{token()}"
        files.mkdir()
        for name in (FOLDER, *form.folders):
            make_below(files, name)
        conversion, store = replace(scenes.conversion, folder=str(files)), ""
        try:
            if rendering is None:
                of_store(entry, Path(form.placed(files, entry).store), conversion)
            else:
                store = rendered(entry, rendering, conversion)
        except BaseException as error:
            shutil.rmtree(files, ignore_errors=True)
            if isinstance(error, Interrupted):
                raise KeyboardInterrupt from None  # no failure of the scene
            raise
        finally:
            give_back()
        return MadeScene(str(files), store)

    return work


def is_short(scenario: Scenario) -> bool:
    """Return True for a scene that is held in memory until its pictures are written."""
    columns, rows = scenario.sensor.pixels
    kinds = 2 if scenario.sensor.senses else 1
    pixel = 4 + 8 * kinds * -(-len(scenario.objects or ()) // BITS)  # radiance or counts, and planes of masks
    return scenario.sensor.frames <= MOST_FRAMES and scenario.sensor.frames * columns * rows * pixel <= MOST_BYTES


def held_scene(scenario: Scenario, source: Path, threads: int | None, cached: SceneCache, masks: str = RESPONSE) -> LabelledScene:
    """Draw the frames of a scene, as ``render_scene`` does, and hold them in memory.

    Raises
    ------
    KeyboardInterrupt
        After SIGINT or SIGTERM, when the current frame is drawn.
    """
    with thread_limit(threads), stop_on_signal() as stopped:
        run = prepared(scenario, cached)

        def frames() -> Iterator[Mapping[str, NDArray[Any]]]:
            for number in run.layout.frames:
                if stopped:
                    raise KeyboardInterrupt
                yield run.images(number)

        return LabelledScene.held(source, run.layout, frames(), masks)
