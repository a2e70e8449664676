"""Scenes of a data set over workers: the worker that draws a scene writes its pictures, from memory where the scene is short.

A scene that is held in memory is written once, as pictures. A longer one goes through a store, so that an interruption costs no more than
a frame; the store is removed when the pictures are written, unless the format keeps it.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
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
from seaglint.formats.dataset.scene_records import Entry, part_path
from seaglint.formats.object_labels import RESPONSE
from seaglint.scenario.load import load_scenario
from seaglint.scenario.model import Scenario
from seaglint.store.layout import BITS
from seaglint.store.outputs import stop_on_signal, write_text
from seaglint.store.sequence_store import Interrupted
from seaglint.studies.ensemble.ensemble_folder import Folder
from seaglint.studies.ensemble.law_draws import prepared
from seaglint.studies.ensemble.render_ensemble import Rendering, render_scene
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
    settings: SceneSettings, entries: Sequence[Entry], failures: Folder, workers: Workers | None, progress: Progress | None
) -> None:
    """Write the missing scenes; ``failures`` is the folder for the tracebacks of those that fail.

    Raises
    ------
    DataError, StorageError
        Scenes that failed; the others are written.
    Interrupted
        After SIGINT or SIGTERM, between two scenes.
    """
    folder = Path(settings.conversion.folder)
    for name in format_named(settings.conversion.format).folders:
        (folder / name).mkdir(parents=True, exist_ok=True)
    missing = [entry for entry in entries if not part_path(folder, entry.name).is_file()]
    done, failed = len(entries) - len(missing), list[str]()
    report = progress or (lambda done, total: None)
    report(done, len(entries))
    job: Job[SceneSettings, Entry, str] = Job(start, settings)
    try:
        with stop_on_signal(at_once=workers is not None) as stopped, (workers or ThisProcess()).map(job, missing) as outcomes:
            for outcome in outcomes:
                trace = failures.failure(outcome.unit.name)
                if isinstance(outcome, Done):
                    done += 1
                    trace.unlink(missing_ok=True)
                    report(done, len(entries))
                else:
                    failed.append(f"scene {outcome.unit.name}: {outcome.error}")
                    trace.parent.mkdir(parents=True, exist_ok=True)
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


def start(settings: SceneSettings) -> Callable[[Entry], str]:
    """Return the function of a worker that writes the pictures and the record of a scene and returns its name."""
    conversion, rendering, cached = settings.conversion, settings.rendering, SceneCache()
    folder, form = Path(conversion.folder), format_named(conversion.format)

    def of_store(entry: Entry) -> str:
        with LabelledScene.stored(Path(entry.store), conversion.masks) as scene:
            return convert(entry, scene, conversion).scene

    def rendered(entry: Entry, drawn: Rendering) -> str:
        source, store = Folder(drawn.folder).scenario(entry.name), Path(entry.store)
        scenario = load_scenario(source)
        if form.pictures and is_short(scenario):
            return convert(entry, held_scene(scenario, source, drawn.threads, cached, conversion.masks), conversion).scene
        if not store.exists():
            render_scene(scenario, store, drawn.threads, cached)
        name = of_store(entry)
        if form.pictures:
            shutil.rmtree(store, ignore_errors=True)
        return name

    def work(entry: Entry) -> str:
        for name in form.folders:
            (folder / name).mkdir(parents=True, exist_ok=True)
        try:
            return of_store(form.placed(folder, entry)) if rendering is None else rendered(entry, rendering)
        except Interrupted:
            raise KeyboardInterrupt from None  # no failure of the scene
        finally:
            give_back()

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
