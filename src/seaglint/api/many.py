"""The functions of :mod:`seaglint.api` for many scenes at once."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.base.free_form import TableRow
from seaglint.base.parameters import documented
from seaglint.studies.ensemble.ensemble_requests import DatasetRequest, EnsembleRequest

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress
    from seaglint.cluster import Workers


@documented(EnsembleRequest)
def ensemble(
    source: str | Path | Mapping[str, Any],
    output: str | Path,
    *,
    workers: int | Workers | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    draw_only: bool = False,
    progress: Progress | None = None,
) -> list[TableRow]:
    """Draw scenes from laws of a scenario's keys and render each.

    Parameters
    ----------
    source : path or mapping
        An ensemble's TOML file, or its content as tables in a mapping.
    output : path
        Folder to make: tables, ``scenes/0000.toml`` and ``scenes/0000.zarr`` for each scene.
    {request}
    progress : callable, optional
        ``progress(scenes done, scenes in all)``.

    Returns
    -------
    list of dict
        The rows of ``parameters.csv``: scene, seed, and what was drawn by key.

    Raises
    ------
    SeaglintError
        Mistakes in the file, output that may not be written, or scenes that failed.

    Examples
    --------
    >>> import tempfile
    >>> import seaglint as sg
    >>> laws = [{"key": "wind.speed_m_s", "law": "choice", "values": [3.0]}]
    >>> study = {"ensemble": {"scenes": 2}, "base": {"sensor": {"pixels": [8, 4]}}, "vary": laws}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rows = sg.ensemble(study, f"{folder}/many", draw_only=True)
    >>> [row["wind.speed_m_s"] for row in rows]
    [3.0, 3.0]
    """
    from seaglint.api.inputs import team_of
    from seaglint.scenario.ensemble_file import load_ensemble, parse_ensemble
    from seaglint.studies.ensemble.render_ensemble import draw, render_ensemble

    resolved = parse_ensemble(source) if isinstance(source, Mapping) else load_ensemble(source)
    with team_of(workers, threads) as others:
        render_ensemble(
            resolved, output, workers=others, threads=threads, resume=resume, overwrite=overwrite, draw_only=draw_only, progress=progress
        )
    return [scene.row for scene in draw(resolved)]


@documented(
    DatasetRequest,
    formats="``coco``, ``yolo``, ``sirst`` or ``zarr``: the scenes' stores as they are",
    bits="16 for ``coco``, 8 for ``yolo`` and ``sirst``",
)
def dataset(
    source: str | Path,
    output: str | Path | None = None,
    *,
    format: str = "coco",
    bits: int | None = None,
    image: str | None = None,
    workers: int | Workers | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    check: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Render labelled pictures of an ensemble: masks, boxes, tables.

    Parameters
    ----------
    source : path
        An ensemble's TOML file, or the folder that :func:`ensemble` made; with ``check`` a data set.
    output : path, optional
        Folder to make; needed unless ``check`` is set.
    {request}
    check : bool
        Check a data set that is there, and make none.
    progress : callable, optional
        ``progress(scenes done, scenes in all)``.

    Returns
    -------
    Path
        ``output``; with ``check`` the data set that is whole.

    Raises
    ------
    SeaglintError
        An error as for :func:`ensemble`, an unknown format, or what is wrong with a data set that is checked.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.dataset("small-objects.toml", "small", workers=2)  # doctest: +SKIP
    PosixPath('small')
    """
    from seaglint.api.inputs import team_of
    from seaglint.base.errors import DataError
    from seaglint.files.dataset.check import problems
    from seaglint.studies.ensemble.ensemble_dataset import ensemble_dataset, read_source

    if check:
        faults = list(problems(Path(source)))
        if faults:
            raise DataError("\n".join(f"{source}: {fault}" for fault in faults))
        return Path(source)
    if output is None:
        raise DataError("output is missing: the folder of the data set; give one, or check=True for a data set that is there")
    resolved, options = read_source(Path(source)), DatasetRequest(format=format, bits=bits, image=image).options()
    with team_of(workers, threads) as others:
        ensemble_dataset(resolved, output, options, workers=others, threads=threads, resume=resume, overwrite=overwrite, progress=progress)
    return Path(output)
