"""Labelled data sets of ensembles: scenes are drawn and rendered, or taken from a folder, and written in a layout for training.

A data set is written scene by scene in ``OUTPUT.partial``, checked, and renamed when it is complete.
"""

from __future__ import annotations

import hashlib
import math
import shutil
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, ScenarioError
from seaglint.base.free_form import JsonObject
from seaglint.base.reports import REPORTS
from seaglint.cluster import Workers
from seaglint.formats.dataset import dataset_writing, format_named
from seaglint.formats.dataset.dataset_writing import ABOUT, ConversionSettings, finish
from seaglint.formats.dataset.picture_levels import PictureOptions
from seaglint.formats.dataset.scene_records import FOLDER, LEAST_SNR, SPLITS, Catalogue, DatasetScene, Entry, splits_of
from seaglint.formats.object_labels import RESPONSE, require_masks
from seaglint.scenario.ensemble_file import Ensemble, load_ensemble, read_toml
from seaglint.scenario.records.ensemble_tables import Dataset
from seaglint.store import outputs
from seaglint.store.resumable_folder import ResumableFolder
from seaglint.store.sequence_store import partial_path
from seaglint.store.writers import exclusive
from seaglint.studies.build.profile_air import report_air
from seaglint.studies.build.scenario_physics import band
from seaglint.studies.ensemble.dataset_scenes import SceneSettings, write_scenes
from seaglint.studies.ensemble.ensemble_folder import MOST_LISTED, Folder, differences, ensemble_text
from seaglint.studies.ensemble.label_outlook import report_weak
from seaglint.studies.ensemble.law_draws import EnsembleScene
from seaglint.studies.ensemble.render_ensemble import Rendering, draw, render_ensemble
from seaglint.studies.ensemble.scene_attempts import STAGES, forget_attempts
from seaglint.studies.sequence.memory import require_memory_of_all
from seaglint.version import __version__

SCENES: Final = ".ensemble"  #: Folder of the scenes' stores while a data set is made.

SOURCE: Final = "ensemble.toml"

_SETTINGS: Final = "settings.json"
_REPLACED: Final = ".replaced"


@dataclass(frozen=True)
class DatasetOptions:
    """Format and pictures of a data set."""

    format: str  #: Name of one of ``seaglint.formats.dataset.FORMATS``.
    pictures: PictureOptions  #: Bits, range and kind of pictures.
    masks: str = RESPONSE  #: Kind of masks, one of ``seaglint.formats.object_labels.MASKS``.
    min_snr: float | None = None  #: Signal-to-noise ratio below which objects are ignored; None for that of the ensemble.

    @classmethod
    def of(
        cls,
        form: str,
        bits: int | str | None = None,
        image: str | None = None,
        *,
        masks: str = RESPONSE,
        min_snr: float | None = None,
        **more: Any,
    ) -> DatasetOptions:
        """Return checked options; ``more`` are ``scale``, ``limits`` and ``clip`` of ``PictureOptions.of``.

        Raises
        ------
        DataError
            An unknown format, kind of masks or ratio below 0, or options of pictures that are unknown or do not fit.
        """
        chosen = format_named(form)
        given = [name for name, value in {"bits": bits, "image": image, **more}.items() if value is not None]
        if not chosen.pictures and given:
            names = " and ".join(f"`{name}`" for name in given)
            raise DataError(f"{names}: for pictures only, and format = {form!r} keeps {chosen.note}; leave them out")
        if min_snr is not None and not 0.0 <= min_snr < math.inf:
            raise DataError(f"min_snr = {min_snr:g}: is no signal-to-noise ratio; give 0, which ignores nothing, or more")
        return cls(form, PictureOptions.of(bits, image, **more), require_masks(masks), min_snr)


@dataclass(frozen=True)
class DatasetPlan:
    """Ensemble, scenes and folders of a data set."""

    title: str  #: Title of the data card, where the table has none.
    seed: int  #: Seed of the ensemble.
    table: Dataset  #: The ensemble's table ``[dataset]``.
    source: str  #: Text of the ensemble's file.


def require_output(output: Path, *, resume: bool, overwrite: bool) -> Path:
    """Refuse a folder that may not be written, before anything is computed.

    Raises
    ------
    DataError
        The folder may not be replaced, or holds an unfinished data set that is neither resumed nor replaced.
    StorageError
        Nothing can be written in the folder.
    """
    partial = partial_path(outputs.refuse_file_ending(output, "a data set"))
    if resume and overwrite:
        raise DataError("resume keeps what is there and overwrite replaces it; give one of the two")
    with outputs.storage_errors(output, outputs.ELSEWHERE):
        outputs.require_folder(output)
        if output.exists() and not output.is_dir():
            raise DataError(f"{output}: is a file; a data set is a folder, give another name")
        if output.exists() and any(output.iterdir()) and not resume:
            if not overwrite:
                raise DataError(f"{output}: is not empty; choose another name, or replace a data set with overwrite=True")
            dataset_writing.read_about(output)
        if partial.exists() and not resume:
            if not overwrite:
                raise DataError(
                    f"{partial}: an unfinished data set is there; continue it with resume=True, or start again with overwrite=True"
                )
            _require_ours(partial)
    return partial


def _unfinished(partial: Path) -> ResumableFolder:
    """Return the folder of an unfinished data set, which its settings mark."""
    return ResumableFolder(partial, f"{FOLDER}/{_SETTINGS}")


def _require_ours(partial: Path) -> None:
    # A process killed as it begins, or as it clears up, leaves only the folder of records, or a complete data set.
    ours = _unfinished(partial).is_ours or (partial / dataset_writing.SUMS).is_file()
    if not ours and any(path.name != FOLDER for path in partial.iterdir()):
        raise DataError(f"{partial}: is no unfinished data set of seaglint and is left alone; choose another name or remove it yourself")


def make_dataset(
    output: str | Path,
    plan: DatasetPlan,
    options: DatasetOptions,
    scenes: Callable[[Path], Sequence[Entry]],
    *,
    rendering: Rendering | None = None,
    workers: Workers | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Make a data set of scenes, in ``output.partial`` until it is complete and checked.

    Parameters
    ----------
    output : path
        Folder to make.
    plan : DatasetPlan
        Title, seed, table and source.
    options : DatasetOptions
        Format and pictures.
    scenes : callable
        ``scenes(folder)`` gives the scenes of the data set in ``folder``, the unfinished one.
    rendering : Rendering, optional
        Folder of the drawn scenes, which are rendered as their pictures are written; without it all scenes have stores.
    workers : Workers, optional
        Workers that render and write the scenes; this process by default. The bytes do not depend on it.
    resume : bool
        Continue an unfinished data set, also with another ``min_snr``. A complete one is left unchanged.
    overwrite : bool
        Replace a data set once the new one is complete.
    progress : callable, optional
        ``progress(scenes done, scenes in all)``.

    Raises
    ------
    DataError
        The output may not be written, another process writes it, another ensemble is resumed, scenes failed, or no object reaches the
        requested ``min_snr``.
    StorageError
        No room or no rights; finished scenes stay.
    Interrupted
        After SIGINT or SIGTERM, between two scenes.
    """
    output = Path(output)
    partial = require_output(output, resume=resume, overwrite=overwrite)
    made_from = _settings(plan, options)
    if resume and output.is_dir() and any(output.iterdir()):
        _require_same(dataset_writing.read_about(output)["made_from"], made_from, output, plan.source)
        return output
    remedy = f"what is done stays in {partial}: make room and run the same command with --resume"
    with outputs.storage_errors(partial, remedy), exclusive(partial) as claim:
        if partial.exists() and not resume:
            forget_attempts(partial)
            _unfinished(partial).clear()
        if _is_whole(partial, made_from):
            _give_name(partial, output)
            return output
        _begin(partial, made_from, plan.source)
        entries = scenes(partial)
        settings = ConversionSettings(
            folder=str(partial.absolute()),
            format=options.format,
            pictures=options.pictures,
            classes=dict(plan.table.classes),
            masks=options.masks,
            min_snr=made_from["min_snr"],
        )
        write_scenes(SceneSettings(settings, rendering), entries, Folder(partial / SCENES), claim, workers, progress)
        parts = [_labelled(partial, DatasetScene.read(partial, entry.name), settings) for entry in entries]
        _report_masks(parts, settings)
        _require_visible(parts, settings.min_snr, partial, requested=_requested_snr(plan, options) is not None)
        catalogue = Catalogue(plan.table.title or plan.title, plan.seed, options.pictures.image, parts)
        table = plan.table
        about = {"description": table.description, "licence": table.licence, "split": table.split, "made_from": made_from}
        about["folder"] = output.absolute().name
        finish(partial, catalogue, settings, about)
        if faults := list(dataset_writing.problems(partial)):
            raise DataError("\n".join(f"{partial}: {line}" for line in faults[:20]))
        _give_name(partial, output)
    return output


def _requested_snr(plan: DatasetPlan, options: DatasetOptions) -> float | None:
    """Return the least signal-to-noise ratio that a user has given; None without one."""
    return plan.table.min_snr if options.min_snr is None else options.min_snr


def _labelled(partial: Path, part: DatasetScene, settings: ConversionSettings) -> DatasetScene:
    """Return a scene with the requested ``min_snr``: labels of one that was written with another are written again, no picture is."""
    if part.min_snr == settings.min_snr:
        return part
    part = replace(part, min_snr=settings.min_snr)
    format_named(settings.format).write_scene(partial, part, settings.pictures.image)
    part.write(partial)
    return part


def _report_masks(parts: Sequence[DatasetScene], settings: ConversionSettings) -> None:
    """Report scenes that have geometric masks in place of responses after the optics."""
    with_objects = [part for part in parts if part.names]
    plain = sum(part.masks != settings.masks for part in with_objects)
    if plain:
        text = "%d of %d scenes with objects have geometric masks, as they were rendered without [sensor.optics] and [sensor.detector]"
        REPORTS.warning(text, plain, len(with_objects))


def _require_visible(parts: Sequence[DatasetScene], least: float, partial: Path, *, requested: bool) -> None:
    """Refuse a requested ``min_snr`` that no object reaches, and report the default one if no object reaches it.

    Raises
    ------
    DataError
        All objects with a known ratio are below it.
    """
    known = [(row.snr, part, row) for part in parts for row in part.rows if row.pieces and row.snr is not None]
    if not known or len(known) < sum(bool(row.pieces) for part in parts for row in part.rows):
        return
    highest, part, row = max(known, key=lambda one: one[0])
    if highest >= least:
        return
    where = f"'{part.names[row.number]}' in {part.pictures[row.frame].name}"
    text = f"min_snr = {least:g} leaves no object: the highest signal-to-noise ratio is {highest:.4g} ({where})"
    if requested:
        raise DataError(f"{text}; lower it and go on with resume=True, which renders nothing again: the scenes stay in {partial}")
    REPORTS.warning("%s, and all %d are marked ignore; give a lower min_snr, or nearer or warmer objects", text, len(known))


def _settings(plan: DatasetPlan, options: DatasetOptions) -> JsonObject:
    """Return the settings that both runs of a resumed data set must share."""
    digest = hashlib.sha256(plan.source.encode("utf-8")).hexdigest()
    shown = options.pictures.named if format_named(options.format).pictures else {}
    given = _requested_snr(plan, options)
    labels = {"masks": options.masks, "min_snr": LEAST_SNR if given is None else given}
    return {"format": options.format, **shown, **labels, "version": __version__, "ensemble": digest}


def _require_same(old: Any, new: JsonObject, where: Path, source: str) -> None:
    """Refuse a data set with other settings; for another ensemble the error has the keys that differ."""
    differ = [name for name in {**old, **new} if old.get(name) != new.get(name)]
    if "ensemble" in differ and (where / SOURCE).is_file():
        keys = differences(read_toml(where / SOURCE, "ensemble"), tomllib.loads(source))
        more = [f"{len(keys) - MOST_LISTED} more"] if len(keys) > MOST_LISTED else []
        differ = [name for name in differ if name != "ensemble"] + (keys[:MOST_LISTED] + more or ["ensemble"])
    if differ:
        raise DataError(f"{where}: was made with another {', '.join(differ)}; resume with the same settings, or start again with overwrite")


def _is_whole(partial: Path, made_from: JsonObject) -> bool:
    """Return True where the data set only has to be renamed; the checksums are written last."""
    return (
        (partial / dataset_writing.SUMS).is_file()
        and not _unfinished(partial).is_ours
        and dataset_writing.read_about(partial)["made_from"] == made_from
        and not any(dataset_writing.problems(partial))
    )


def _begin(partial: Path, made_from: JsonObject, source: str) -> None:
    """Make the folder, or check that an unfinished one has the same settings."""
    path = partial / FOLDER / _SETTINGS
    if path.is_file():
        begun = outputs.read_json(path, "start again with overwrite=True")
        # Records of scenes hold for any least ratio.
        _require_same({**begun, "min_snr": made_from["min_snr"]}, made_from, partial, source)
        if begun != made_from:
            outputs.write_json(made_from, path)
    else:
        if partial.exists():
            _require_ours(partial)
        if (partial / dataset_writing.SUMS).is_file():
            _require_same(dataset_writing.read_about(partial)["made_from"], made_from, partial, source)
        path.parent.mkdir(parents=True, exist_ok=True)
        outputs.write_json(made_from, path)
    outputs.write_text(source, partial / SOURCE)


def _give_name(partial: Path, output: Path) -> None:
    """Remove the records for resuming, and put the data set in the place of the old one, which is deleted last."""
    for name in (FOLDER, SCENES, STAGES, _REPLACED):
        shutil.rmtree(partial / name, ignore_errors=True)
    if output.exists():
        output.rename(partial / _REPLACED)
    partial.rename(output)
    shutil.rmtree(output / _REPLACED, ignore_errors=True)


@dataclass(frozen=True)
class EnsembleSource:
    """An ensemble, and the folder where it is rendered already."""

    ensemble: Ensemble  #: Base scenario and laws.
    title: str  #: Title of the data card by default.
    folder: Path | None  #: Folder of the rendered scenes; None where they are rendered for the data set.


def read_source(path: Path) -> EnsembleSource:
    """Read the file of an ensemble, or the folder that 'seaglint ensemble' made of one.

    Raises
    ------
    DataError
        A folder without an ensemble.
    ScenarioError
        A file with a mistake.
    """
    if not path.is_dir():
        return EnsembleSource(load_ensemble(path), path.stem, None)
    folder = Folder(path)
    if not folder.file.is_file():
        raise DataError(f"{path}: is a folder without an ensemble; give an ensemble's TOML file, or a folder made by 'seaglint ensemble'")
    return EnsembleSource(load_ensemble(folder.file), path.resolve().name, path)


def ensemble_dataset(
    source: EnsembleSource,
    output: str | Path,
    options: DatasetOptions,
    *,
    workers: Workers | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Make a labelled data set of an ensemble.

    Parameters
    ----------
    source : EnsembleSource
        See ``read_source``.
    output : path
        Folder to make.
    options : DatasetOptions
        Format and pictures.
    workers : Workers, optional
        Workers that render and write; this process by default. The bytes do not depend on it.
    threads : int, optional
        Processor threads of each worker; all by default.
    resume, overwrite : bool
        Continue an unfinished data set, or replace an existing one.
    progress : callable, optional
        Called with (scenes done, scenes in all).

    Returns
    -------
    Path
        ``output``.

    Raises
    ------
    SeaglintError
        See ``seaglint.studies.ensemble.render_ensemble.render_ensemble`` and ``make_dataset``.
    """
    ensemble = source.ensemble
    drawn = draw(ensemble)
    if source.folder is not None:
        _require_rendered(Folder(source.folder), [scene.label for scene in drawn])
    table, seed = ensemble.dataset, ensemble.ensemble.seed
    known = {item.name for item in ensemble.objects} | {item.name for scene in drawn for item in scene.scenario.objects or ()}
    # A misspelt name would leave its objects without their class.
    if unknown := [name for name in table.classes if name not in known]:
        own = {item["name"] for item in ensemble.base.get("objects", []) if "name" in item} | {item.name for item in ensemble.objects}
        names = f"; objects are {', '.join(sorted(own))}" if own else "; it has no objects"
        raise ScenarioError(f"{ensemble.name}: dataset.classes.{unknown[0]} names no object of the ensemble; correct the name{names}")

    form = format_named(options.format)
    if form.sequences:
        _require_sequences(form.name, drawn)
    folder = Folder(source.folder or partial_path(Path(output)) / SCENES)

    def store(partial: Path, label: str) -> Path:
        """Return the store of a scene: in the data set where it is rendered for a format that keeps stores."""
        kept = form.store(partial, label) if source.folder is None else None
        return (kept or folder.store(label)).absolute()

    def scenes(partial: Path) -> Sequence[Entry]:
        if source.folder is None:
            require_memory_of_all(scene.scenario for scene in drawn)
            if not resume:
                given = options.min_snr if options.min_snr is not None else table.min_snr
                report_weak(drawn, LEAST_SNR if given is None else given)
            render_ensemble(ensemble, folder.path, resume=True, draw_only=True)
            if workers is not None:
                report_air(drawn[0].scenario, band(drawn[0].scenario))
        splits = splits_of(seed, len(drawn), table.split)
        report_splits(splits, table.split)
        return [Entry(scene.label, str(store(partial, scene.label)), split, scene.row) for scene, split in zip(drawn, splits, strict=True)]

    return make_dataset(
        output,
        DatasetPlan(source.title, seed, table, ensemble_text(ensemble)),
        options,
        scenes,
        rendering=Rendering(folder.path.absolute(), threads) if source.folder is None else None,
        workers=workers,
        resume=resume,
        overwrite=overwrite,
        progress=progress,
    )


def _require_sequences(form: str, drawn: Sequence[EnsembleScene]) -> None:
    """Refuse scenes of one frame for a format of sequences, before anything is written."""
    single = [scene.label for scene in drawn if scene.scenario.sensor.frames < 2]
    if single:
        raise DataError(
            f"format = {form!r} is for sequences, and {len(single)} of {len(drawn)} scenes have one frame, the first is {single[0]}; "
            "set ensemble.frames to 2 or more, or choose a format of single pictures"
        )


def report_splits(splits: Sequence[str], fractions: tuple[float, float, float]) -> None:
    """Report splits that have a share and no scene, because there are too few scenes."""
    shares = dict(zip(SPLITS, fractions, strict=True))
    if empty := [name for name in SPLITS if shares[name] > 0.0 and name not in splits]:
        least = sum(share > 0.0 for share in fractions)
        text = "%d scene%s cannot serve all splits: %s has none; draw %d scenes or more, or set its share in dataset.split to 0"
        REPORTS.warning(text, len(splits), "" if len(splits) == 1 else "s", " and ".join(empty), least)


def _require_rendered(folder: Folder, labels: Sequence[str]) -> None:
    """Refuse a folder with unrendered scenes, before anything is written."""
    missing = sum(not folder.store(label).is_dir() for label in labels)
    if missing and (folder.path / ABOUT).is_file():
        raise DataError(f"{folder.path}: is a data set, whose scenes are gone; give the file {folder.file} to make it in another way")
    if missing:
        raise DataError(
            f"{folder.path}: {missing} of {len(labels)} scenes are not rendered; render the ensemble {folder.file} into this folder "
            "with resume=True"
        )
