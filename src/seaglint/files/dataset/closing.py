"""The files of a data set that are written when all scenes are in: annotations, tables, card, examples, checksums."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.errors import BackendError
from seaglint.base.free_form import JsonObject
from seaglint.files.dataset import format_named
from seaglint.files.dataset.card import card, statistics
from seaglint.files.dataset.check import ABOUT, KIND, write_sums
from seaglint.files.dataset.convert import ConversionSettings
from seaglint.files.dataset.part import TRUTH_COLUMNS, Catalogue, DatasetScene
from seaglint.files.dataset.sheet import Example, write_sheet
from seaglint.files.tables.rows import require_parquet, write_parquet, write_rows
from seaglint.files.text_file import write_json, write_text
from seaglint.version import __version__

LICENCE: Final = "CC-BY-4.0"  #: Licence of a data set whose ensemble says none.

EXAMPLES: Final = 18  #: Pictures on the sheet of examples.


def finish(folder: Path, catalogue: Catalogue, settings: ConversionSettings, about: Mapping[str, Any]) -> None:
    """Write all that goes beside the pictures.

    Parameters
    ----------
    folder : Path
        With the pictures.
    catalogue : Catalogue
        Records of all scenes.
    settings : ConversionSettings
        How they were written.
    about : mapping
        ``description``, ``licence`` (None where the ensemble says none) and ``split``.
    """
    licence = about["licence"] or LICENCE
    counts = all(part.levels is not None and part.levels.counts for part in catalogue.parts)
    shared = {
        "title": catalogue.title,
        "description": about["description"],
        "licence": licence,
        "version": __version__,
        "seed": catalogue.seed,
        "split": list(about["split"]),
    }
    form = format_named(settings.format)
    form.write(folder, catalogue, shared)
    _write_tables(folder, catalogue)
    write_sheet(_examples(folder, catalogue, settings), folder / "examples.png")
    numbers = statistics(catalogue)
    pictured = {"bits": settings.bits, "image": settings.image} if form.pictures else {}
    document = {
        "kind": KIND,
        "format": settings.format,
        **pictured,
        **shared,
        "categories": list(catalogue.categories),
        "scenes": {part.scene: _scene(part) for part in catalogue.parts},
        "statistics": numbers,
        "made_from": about["made_from"],
    }
    write_json(document, folder / ABOUT)
    note = (
        ""
        if about["licence"]
        else ". The ensemble's file names no licence; this is seaglint's default, and yours to change with `[dataset] licence`."
    )
    write_text(card({**shared, **pictured, "licence_note": note, "counts": counts}, numbers, form), folder / "README.md")
    write_sums(folder)


def _scene(part: DatasetScene) -> JsonObject:
    rows, columns = part.shape
    lines = part.levels.attributes if part.levels is not None else {}
    images = [picture.name for picture in part.pictures]
    return {"split": part.split, "seed": part.seed, "width": columns, "height": rows, **lines, "images": images}


def _write_tables(folder: Path, catalogue: Catalogue) -> None:
    """``parameters.csv``, ``truth.csv``, and as Parquet where PyArrow is installed."""
    parameters, truth = catalogue.parameters(), catalogue.truth()
    write_rows(parameters, folder / "parameters.csv")
    if truth:
        write_rows(truth, folder / "truth.csv")
    else:
        write_text(",".join(TRUTH_COLUMNS) + "\n", folder / "truth.csv")
    try:
        require_parquet()
    except BackendError:
        return
    write_parquet({name: [row[name] for row in truth] for name in TRUTH_COLUMNS}, folder / "truth.parquet")


def _examples(folder: Path, catalogue: Catalogue, settings: ConversionSettings) -> list[Example]:
    """One picture of each of some scenes, evenly among all: that with most objects, the first of these."""
    parts = catalogue.parts
    chosen = [parts[i] for i in sorted({round(j) for j in np.linspace(0, len(parts) - 1, min(EXAMPLES, len(parts)))})]
    out = []
    for part in chosen:
        counts = [sum(len(row.pieces) for row in part.rows if row.frame == i) for i in range(len(part.pictures))]
        place = int(np.argmax(counts))
        rows = [row for row in part.rows if row.frame == place and row.pieces]
        most = max((row.snr for row in rows if row.snr is not None), default=None)
        title = f"{part.pictures[place].name} {part.split}" + (f", SNR to {most:.3g}" if most is not None else "")
        picture = format_named(settings.format).picture(folder, part, place, settings.image)
        out.append(Example(picture, [piece.box for row in rows for piece in row.pieces], title))
    return out
