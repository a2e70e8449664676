"""Options that several commands share: output, progress, overwriting, the scale of previews, and numbers of frames.

Frames are written ``37``, ``37:38``, ``10:`` or ``:20``; of a stored run also with a step, ``0:100:2``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from seaglint.base.errors import DataError, ScenarioError
from seaglint.cli.terminal.progress import ProgressMode


class PreviewScale(StrEnum):
    """Brightness scales of pictures."""

    AUTO = "auto"
    LINEAR = "linear"
    LOG = "log"


def place_given(text: str) -> Path | str:
    """Return the name of a store: a URL unchanged, a path without a final slash, so that files beside the store get the right folder."""
    bare = text.rstrip("/\\") or text
    return bare if "://" in text else Path(bare)


AsJson = Annotated[bool, typer.Option("--json", help="print JSON")]
ScenarioArgument = Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file")]
Preview = Annotated[bool, typer.Option("--preview", help="write a picture beside the file")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="replace an existing output")]
StoreOption = Annotated[str, typer.Option("-o", "--output", help="Zarr store to write: run.zarr, or a URL like s3://bucket/run.zarr")]
ShardOption = Annotated[
    str | None, typer.Option("--shard", metavar="I/N", help="make share K of N, from 0:N to N-1:N; 'render --finish' joins them")
]
ProgressOption = Annotated[ProgressMode, typer.Option("--progress", help="bar on a terminal, log lines elsewhere, or nothing")]
LateProgressOption = Annotated[
    ProgressMode, typer.Option("--progress", help="after 2 s: bar on a terminal, log lines elsewhere; or nothing")
]


ScaleOption = Annotated[
    PreviewScale, typer.Option("--scale", help="brightness of previews; auto follows the sea, and is log where glint would leave it black")
]


def refuse_preview(path: Path, replace: bool, inputs: list[Path]) -> None:
    """Refuse to replace a file by a preview; the error explains why this file would be written."""
    from seaglint.store.outputs import refuse_existing

    if path.exists() and not replace:
        raise DataError(
            f"{path}: --preview writes this file, which exists already (of another run, or your own); "
            "replace it with --overwrite, give -o another name, or leave --preview out"
        )
    refuse_existing(path, overwrite=replace, inputs=inputs)


def two_numbers(separator: str, hint: str) -> Callable[[str, str], tuple[float, float]]:
    """Return a reader of options with two numbers: it takes the text and the option, and raises ``hint`` for other texts."""

    def read(text: str, option: str) -> tuple[float, float]:
        try:
            first, second = (float(part) for part in text.split(separator))
        except ValueError:
            raise DataError(f"{option} {text}: give {hint}") from None
        return first, second

    return read


def parse_frames(text: str | range | None, held: int | range, *, steps: bool = False) -> range:
    """Return the frame numbers of an option, from 0 and without the end, as in Python.

    ``held`` are the existing frames of a run, or the number of frames of a scenario; ``steps`` allows steps larger than 1. ``text`` is the
    field of a request, which is read only here, where the number of frames is known.

    >>> parse_frames("37:38", 100), parse_frames("90:", 100), parse_frames(None, 3)
    (range(37, 38), range(90, 100), range(0, 3))
    >>> parse_frames(":20:2", range(10, 30), steps=True)
    range(10, 20, 2)
    """
    frames, why = (range(held), f" (sensor.frames = {held})") if isinstance(held, int) else (held, "")
    if text is None:
        return frames
    match = isinstance(text, str) and re.fullmatch(r"\s*(\d*)\s*(:?)\s*(\d*)\s*(?:(:)\s*(\d*)\s*)?", text)
    if not match or not (match[1] or match[2]) or (match[4] and not (steps and match[2])):
        more = ", :20 or 0:100:2 (every other)" if steps else " or :20"
        raise ScenarioError(f"--frames {text}: is not a range of frames; write 37, 37:38 (the end not included), 10:{more}")
    first = int(match[1] or frames.start)
    # A number without a colon is one frame; a colon without an end runs to the last.
    end = int(match[3]) if match[3] else frames.stop if match[2] else first + 1
    step = int(match[5] or 1)
    if step == 0:
        raise ScenarioError(f"--frames {text}: a step of 0 never ends; give 1 or more")
    if not frames.start <= first < end <= frames.stop:
        raise ScenarioError(f"--frames {text}: is outside the sequence; allowed: {frames.start}:{frames.stop}, first before end{why}")
    return range(first, end, step)
