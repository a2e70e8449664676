"""Options that several commands have."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.terminal.progress import ProgressMode


class PreviewScale(StrEnum):
    """Brightness of pictures."""

    AUTO = "auto"
    LINEAR = "linear"
    LOG = "log"


def place_given(text: str) -> Path | str:
    """A store's name: a URL as it stands, else a path without a slash at its end, which would put what lies beside the store elsewhere."""
    bare = text.rstrip("/\\") or text
    return bare if "://" in text else Path(bare)


Overwrite = Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")]
StoreOption = Annotated[str, typer.Option("-o", "--output", help="Zarr store to write: run.zarr, or a URL like s3://bucket/run.zarr")]
ShardOption = Annotated[
    str | None,
    typer.Option("--shard", metavar="I/N", help="make share K of N, from 0:N to N-1:N; 'render --finish' joins them"),
]
ProgressOption = Annotated[ProgressMode, typer.Option("--progress", help="bar on a terminal, log lines elsewhere, or nothing")]
LateProgressOption = Annotated[
    ProgressMode, typer.Option("--progress", help="after 2 s: bar on a terminal, log lines elsewhere; or nothing")
]
