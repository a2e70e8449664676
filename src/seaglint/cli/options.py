"""Options that several commands have."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from seaglint.cli.progress import ProgressMode


class PreviewScale(StrEnum):
    """Brightness of pictures."""

    AUTO = "auto"
    LINEAR = "linear"
    LOG = "log"


Overwrite = Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")]
Progress = Annotated[ProgressMode, typer.Option("--progress", help="bar on a terminal, log lines elsewhere, or nothing")]
