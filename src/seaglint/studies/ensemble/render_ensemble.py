"""Ensembles: scenes drawn from the laws of a file, each a separate scenario, rendered one by one, and their expected cost.

The cost is the expected time and room of all scenes, from one frame of the first.
"""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, DomainError, ScenarioError
from seaglint.base.free_form import TableRow
from seaglint.base.threads import thread_limit
from seaglint.cluster import Failed, Job, ThisProcess, Workers
from seaglint.scenario.changed_scenario import middle_of, set_key
from seaglint.scenario.ensemble_file import Ensemble, with_absolute_paths
from seaglint.scenario.keys import quantity_of
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.ensemble_tables import Weather, value_of
from seaglint.store.outputs import refuse_file_ending, stop_on_signal, storage_errors, write_text
from seaglint.store.sequence_store import Interrupted, check_output, write_sequence
from seaglint.store.writers import exclusive
from seaglint.studies.build.profile_air import report_air
from seaglint.studies.build.scenario_physics import band
from seaglint.studies.ensemble import law_draws
from seaglint.studies.ensemble.ensemble_folder import Folder
from seaglint.studies.ensemble.label_outlook import report_unseen
from seaglint.studies.ensemble.law_draws import EnsembleScene, SingleLaw, count_key, prepared
from seaglint.studies.ensemble.scene_attempts import forget_scene, rendered_store, scene_stage
from seaglint.studies.mean.field_numbers import field_numbers
from seaglint.studies.sea_draws import part_of, require_drawn
from seaglint.studies.sequence.memory import give_back, require_memory_of_all
from seaglint.studies.sequence.sequence_work import SceneCache
from seaglint.studies.study_requests import require_sea_draws

MANY: Final = 16  #: Least number of scenes whose cost is worth the time of one frame.

_MOST_NAMED: Final = 3  #: Largest number of failed scenes that an error names; more are counted.

_STRIP: Final = 16


def draw(ensemble: Ensemble) -> list[EnsembleScene]:
    """Draw all scenes of an ensemble, each checked as a scenario.

    Raises
    ------
    SeaglintError
        The first scene that is no scenario, with the key and the value drawn for it.
    """
    return list(scenes(ensemble))


def scenes(ensemble: Ensemble) -> Iterator[EnsembleScene]:
    """Iterate over the scenes of an ensemble; see ``draw``."""
    settings = ensemble.ensemble
    sampled = ["weather" if isinstance(law, Weather) else law.key or "" for law in ensemble.vary]
    sampled += [count_key(template) for template in ensemble.objects if not isinstance(template.count, int)]
    numbers = law_draws.UniformNumbers(ensemble, tuple(sampled))
    rows = {
        i: law_draws.WeatherRows.of(law, f"{ensemble.name}: vary[{i}]", ensemble.base)
        for i, law in enumerate(ensemble.vary)
        if isinstance(law, Weather)
    }
    objects, width = law_draws.DrawnObjects(ensemble, numbers), max(4, len(str(settings.scenes - 1)))
    for number in range(settings.scenes):
        where, parameters = f"{ensemble.name}, scene {number}", TableRow()
        for i, law in enumerate(ensemble.vary):
            if isinstance(law, Weather):
                parameters |= rows[i].at(numbers.of("weather", number), numbers.of("weather direction", number))
            else:
                parameters[law.key or ""] = _value(ensemble, i, law, numbers, number)
        tables = copy.deepcopy(ensemble.base)
        tables["seed"] = law_draws.sea_seed(settings.seed, number)
        if settings.frames is not None:
            tables.setdefault("sensor", {})["frames"] = settings.frames
        for key, value in parameters.items():
            set_key(tables, key, list(value) if isinstance(value, tuple) else copy.deepcopy(value), where)
        drawn: list[TableRow] = []
        if ensemble.objects:
            # Places in the picture need the sensor, as it is drawn, before there are objects.
            picture = law_draws.PixelGrid(_checked(ensemble, {k: v for k, v in tables.items() if k != "objects"}, parameters, where))
            taken: list[tuple[float, float]] = []
            for template in ensemble.objects:
                count = objects.count(template, number)
                parameters[count_key(template)] = count
                drawn += objects.draw(template, count, number, picture, taken)
            if drawn or "objects" in tables:
                tables["objects"] = [*tables.get("objects", []), *drawn]
        scenario = _checked(ensemble, tables, parameters, where)
        yield EnsembleScene(
            number=number,
            label=f"{number:0{width}d}",
            scenario=scenario,
            tables=with_absolute_paths(tables, scenario),
            parameters=parameters,
            objects=tuple(drawn),
        )


def _value(ensemble: Ensemble, place: int, law: SingleLaw, numbers: law_draws.UniformNumbers, scene: int) -> Any:
    """Return the value that a law of ``[[vary]]`` gives a scene."""
    key = law.key or ""
    quantity = quantity_of(key)
    try:
        return value_of(law, numbers.of(key, scene), quantity, f"{ensemble.name}: vary[{place}] ({key})")
    except ScenarioError:
        if quantity is None:  # text with a unit for an unknown key: the error is about the key
            tables = copy.deepcopy(ensemble.base)
            set_key(tables, key, "", ensemble.name)
            _checked(ensemble, tables, {}, f"{ensemble.name}: vary[{place}]")
        raise


def _checked(ensemble: Ensemble, tables: Mapping[str, Any], parameters: Mapping[str, Any], where: str) -> Scenario:
    """Return the scenario of a scene; the error has its first mistake, with the drawn value."""
    try:
        return parse_scenario(tables, name=where, base=ensemble.folder)
    except ScenarioError as error:
        if not error.mistakes:
            raise
        first = error.mistakes[0]
        drawn = parameters.get(first.key)
        detail = "" if drawn is None or f"{drawn}" in first.text else f" (drawn: {first.key} = {drawn})"
        if first.key not in parameters and parameters:
            detail = f" (drawn: {', '.join(f'{key} = {value}' for key, value in parameters.items())})"
        raise ScenarioError(f"{where}: {first.text}{detail}", mistakes=(first,)) from None


def render_ensemble(
    ensemble: Ensemble,
    output: str | Path,
    *,
    workers: Workers | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    draw_only: bool = False,
    sea_draws: int | None = None,
    progress: Progress | None = None,
) -> Path:
    """Draw an ensemble, write its scenarios and tables, and render its scenes.

    Parameters
    ----------
    ensemble : Ensemble
        See ``seaglint.scenario.ensemble_file.load_ensemble``.
    output : path
        Folder to make: ``ensemble.toml``, ``parameters.csv``, ``objects.csv`` (both also as Parquet where PyArrow is installed), and
        ``scenes/0000.toml``, ``scenes/0000.zarr`` and so on.
    workers : Workers, optional
        Workers that render; this process by default. The bytes do not depend on it.
    threads : int, optional
        Processor threads of each worker; all by default.
    resume, overwrite : bool
        Render the scenes that are missing, or begin anew.
    draw_only : bool
        Leave the scenes unrendered; with ``resume`` they are rendered later.
    sea_draws : int, optional
        Number of seas between the campaigns of which ``sea_unknown.csv`` gives intervals for each scene
        (``seaglint.studies.mean.field_numbers``).
    progress : callable, optional
        Called with (scenes done, scenes in all).

    Returns
    -------
    Path
        ``output``.

    Raises
    ------
    DataError
        The folder holds another ensemble, or scenes failed: the others are rendered, and ``failures/`` has a traceback of each.
    Interrupted
        After SIGINT or SIGTERM; finished scenes stay and the ensemble can be resumed.
    SeaglintError
        See ``draw``; nothing is written then.
    """
    folder = Folder(refuse_file_ending(Path(output), "an ensemble"))
    folder.check(resume=resume, overwrite=overwrite)
    require_sea_draws(sea_draws)
    drawn = draw(ensemble)
    report_unseen(drawn)
    if sea_draws is not None:
        for scene in drawn:
            _named(scene, require_drawn)
    if not draw_only:
        require_memory_of_all(scene.scenario for scene in drawn)
    with ExitStack() as stack:
        with storage_errors(folder.path, "choose another folder"):
            claim = stack.enter_context(exclusive(folder.path))
        # Another process may have written the folder before this one had it for itself.
        folder.check(resume=resume, overwrite=overwrite)
        folder.write(ensemble, drawn, resume=resume, overwrite=overwrite)
        if not draw_only:
            if workers is not None and drawn:
                report_air(drawn[0].scenario, band(drawn[0].scenario))
            labels = [scene.label for scene in drawn]
            with storage_errors(folder.path, "make room and run the same again with resume=True"):
                stage = stack.enter_context(scene_stage(folder.path, claim, {label: folder.store(label) for label in labels}))
            # With drawn seas the rendering is the first half of the work in its report.
            _render(folder, stage, labels, workers, threads, progress if sea_draws is None else part_of(progress, 0, 2))
        if sea_draws is not None:
            # In this process: a scene takes seconds at most, where its rendering takes minutes.
            rows: list[TableRow] = []
            if draw_only and progress is not None:
                progress(0, len(drawn))  # the first report is what was there before
            for scene in drawn:
                rows.append({"scene": scene.number, **_named(scene, partial(field_numbers, draws=sea_draws))})
                if progress is not None:
                    rendered = 0 if draw_only else len(drawn)
                    progress(rendered + len(rows), rendered + len(drawn))
            folder.write_sea_unknown(rows)
    return folder.path


def _named(scene: EnsembleScene, function: Callable[[Scenario], Any]) -> Any:
    """Return the result of a function for the scenario of a scene; errors name the scene."""
    try:
        return function(scene.scenario)
    except (ScenarioError, DomainError) as error:
        raise DataError(f"scene {scene.number}: {error}") from error


@dataclass(frozen=True)
class Rendering:
    """Settings that a worker needs to render scenes."""

    folder: Path
    threads: int | None


def scene_renderer(settings: tuple[Rendering, Path]) -> Callable[[str], str]:
    """Return the function that renders the scene of a label, or the rest of it, in a stage, and returns the path of its store there."""
    (rendering, stage), cached = settings, SceneCache()
    folder = Folder(rendering.folder)

    def work(label: str) -> str:
        scenario = load_scenario(folder.scenario(label))

        def render(store: Path) -> None:
            render_scene(scenario, store, rendering.threads, cached)

        try:
            return str(rendered_store(stage, label, folder.store(label), render))
        except Interrupted:
            raise KeyboardInterrupt from None  # no failure of the scene
        finally:
            give_back()

    return work


def render_scene(scenario: Scenario, output: Path, threads: int | None, cached: SceneCache) -> None:
    """Render a scene, or the rest of it, as 'seaglint render' does; tables shared with the scene before are taken from ``cached``."""
    check_output(output, resume=True)
    with thread_limit(threads):
        run = prepared(scenario, cached)
        write_sequence(output, run.layout, run.images, resume=True)


def _render(
    folder: Folder, stage: Path, labels: Sequence[str], workers: Workers | None, threads: int | None, progress: Progress | None
) -> None:
    """Render the scenes that have no store yet."""
    missing = [label for label in labels if not folder.store(label).exists()]
    done, failed = len(labels) - len(missing), dict[str, str]()
    report = progress or (lambda done, total: None)
    report(done, len(labels))
    # Workers' own processes get no signals: leaving their context ends them at once. In this process the current frame is finished.
    with ExitStack() as stack:
        stopped = stack.enter_context(stop_on_signal(at_once=workers is not None))
        try:
            settings = (Rendering(folder.path.absolute(), threads), stage.absolute())
            outcomes = stack.enter_context((workers or ThisProcess()).map(Job(scene_renderer, settings), missing))
            for outcome in outcomes:
                if isinstance(outcome, Failed):
                    failed[outcome.unit] = outcome.error
                    folder.failure(outcome.unit).parent.mkdir(exist_ok=True)
                    write_text(outcome.traceback or f"{outcome.error}\n", folder.failure(outcome.unit))
                else:
                    with storage_errors(folder.path, "make room and run the same again with resume=True"):
                        Path(outcome.record).rename(folder.store(outcome.unit))
                        forget_scene(stage, outcome.unit)
                    done += 1
                    folder.failure(outcome.unit).unlink(missing_ok=True)
                    report(done, len(labels))
                if stopped:
                    raise KeyboardInterrupt
        except KeyboardInterrupt:
            raise Interrupted(
                f"stopped after {done} of {len(labels)} scenes, kept in {folder.path}; run the same again with resume=True"
            ) from None
    if failed:
        named = "; ".join(f"scene {label}: {error}" for label, error in list(failed.items())[:_MOST_NAMED])
        more = f"; and {len(failed) - _MOST_NAMED} more" if len(failed) > _MOST_NAMED else ""
        raise DataError(
            f"{folder.path}: {len(failed)} of {len(labels)} scenes failed, the others are there; {named}{more}; tracebacks are in "
            f"{folder.path / 'failures'}; resume renders them again"
        )


@dataclass(frozen=True)
class ExpectedCost:
    """Expected cost of an ensemble's scenes, on this machine alone."""

    seconds: float  #: Time [s].
    size: int  #: Largest room [bytes].


def expected_cost(first: Scenario, second: Scenario, scenes: int) -> ExpectedCost:
    """Return the expected cost of rendering some scenes, with the first frame of the first scene for all frames.

    A narrow strip compiles the kernels first; then the preparation of the scene and the drawing of its first frame are timed. The second
    scene is prepared like all further ones, with the tables that it shares with the first. The room is that of stored pixels without
    compression.
    """
    columns, rows = first.sensor.pixels
    cached = SceneCache()
    _times(middle_of(first, rows, _STRIP), cached)
    ready, drawn = _times(first, cached)
    again = _ready(second, cached)[1]
    size = scenes * first.sensor.frames * rows * columns * (2 if first.sensor.senses else 4)
    return ExpectedCost(ready + (scenes - 1) * again + scenes * first.sensor.frames * drawn, size)


def _times(scenario: Scenario, cached: SceneCache) -> tuple[float, float]:
    """Return the times of preparing a scenario and of drawing its first frame [s]."""
    run, ready = _ready(scenario, cached)
    start = time.perf_counter()
    run.images(next(iter(run.layout.frames)))
    return ready, time.perf_counter() - start


def _ready(scenario: Scenario, cached: SceneCache) -> tuple[Any, float]:
    """Return the prepared scenario, and the time of its preparation [s]."""
    start = time.perf_counter()
    return prepared(scenario, cached), time.perf_counter() - start
