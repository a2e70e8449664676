"""Labelled data sets of ensembles: scenes are drawn and rendered, or taken from a folder, and written in a layout for training."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, ScenarioError
from seaglint.cluster import Workers
from seaglint.files.dataset.check import ABOUT
from seaglint.files.dataset.part import Entry
from seaglint.files.dataset.split import split_of
from seaglint.scenario.ensemble_file import Ensemble, load_ensemble
from seaglint.studies.ensemble.ensemble_folder import Folder, ensemble_text
from seaglint.studies.ensemble.label_outlook import report_weak
from seaglint.studies.ensemble.render_ensemble import draw, render_ensemble
from seaglint.studies.ensemble.scenes_to_dataset import DatasetOptions, DatasetPlan, make_dataset


@dataclass(frozen=True)
class EnsembleSource:
    """An ensemble, and the folder where it is rendered already."""

    ensemble: Ensemble
    title: str
    folder: Path | None


def read_source(path: Path) -> EnsembleSource:
    """An ensemble's file, or the folder that 'seaglint ensemble' made of one.

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
        See :func:`read_source`.
    output : path
        Folder to make.
    options : DatasetOptions
        Format and pictures.
    workers : Workers, optional
        Who renders and writes; this process by default. The bytes do not depend on it.
    threads : int, optional
        Processor threads of each worker; all by default.
    resume, overwrite : bool
        Go on with an unfinished data set, or replace what is there.
    progress : callable, optional
        Called with (scenes done, scenes in all) while they are rendered, or written where they are rendered already.

    Returns
    -------
    Path
        ``output``.

    Raises
    ------
    SeaglintError
        See :func:`seaglint.studies.ensemble.render_ensemble.render_ensemble` and
        :func:`seaglint.studies.ensemble.scenes_to_dataset.make_dataset`.
    """
    ensemble = source.ensemble
    drawn = draw(ensemble)
    if source.folder is not None:
        _require_rendered(Folder(source.folder), [scene.label for scene in drawn])
    table = ensemble.dataset
    known = {item.name for item in ensemble.objects} | {item.name for scene in drawn for item in scene.scenario.objects or ()}
    unknown = [name for name in table.classes if name not in known]
    if unknown:
        own = {item["name"] for item in ensemble.base.get("objects", []) if "name" in item} | {item.name for item in ensemble.objects}
        names = f"; objects are {', '.join(sorted(own))}" if own else "; it has no objects"
        raise ScenarioError(f"{ensemble.name}: dataset.classes.{unknown[0]} names no object of the ensemble; correct the name{names}")

    def rendered(place: Path) -> Sequence[Entry]:
        if source.folder is None:
            if not resume:
                report_weak(drawn)
            folder = Folder(render_ensemble(ensemble, place, workers=workers, threads=threads, resume=True, progress=progress))
        else:
            folder = Folder(source.folder)
        return [
            Entry(
                scene.label,
                str(folder.store(scene.label).absolute()),
                split_of(ensemble.ensemble.seed, scene.number, table.split),
                scene.row,
            )
            for scene in drawn
        ]

    plan = DatasetPlan(source.title, ensemble.ensemble.seed, table, ensemble_text(ensemble))
    return make_dataset(
        output,
        plan,
        options,
        rendered,
        workers=workers,
        resume=resume,
        overwrite=overwrite,
        progress=progress if source.folder is not None else None,
    )


def _require_rendered(folder: Folder, labels: Sequence[str]) -> None:
    """Refuse a folder with scenes that are not rendered, before anything is written."""
    missing = sum(not folder.store(label).is_dir() for label in labels)
    if missing and (folder.path / ABOUT).is_file():
        raise DataError(f"{folder.path}: is a data set, whose scenes are gone; give the file {folder.file} to make it in another way")
    if missing:
        raise DataError(
            f"{folder.path}: {missing} of {len(labels)} scenes are not rendered; render the ensemble {folder.file} into this folder "
            "with resume=True"
        )
