"""The option ``--scale`` of previews, and what a preview may replace."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.options import PreviewScale

ScaleOption = Annotated[
    PreviewScale, typer.Option("--scale", help="brightness of previews; auto follows the sea, and is log where glint would leave it black")
]


def refuse_preview(path: Path, replace: bool, inputs: list[Path]) -> None:
    """Refuse to write a preview over what may be somebody's, and say why a name is taken that was not given."""
    from seaglint.files.outputs import refuse_existing

    if path.exists() and not replace:
        raise DataError(
            f"{path}: --preview writes this file, which exists already (of another run, or your own); "
            "replace it with --overwrite, give -o another name, or leave --preview out"
        )
    refuse_existing(path, overwrite=replace, inputs=inputs)
