"""Writer of text and JSON files, completely or not at all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from seaglint.files.outputs import moved_when_whole


def write_text(text: str, output: Path) -> None:
    """Write a text in UTF-8 with line ends as they are.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    with moved_when_whole(output) as partial:
        partial.write_text(text, encoding="utf-8", newline="\n")


def write_json(value: Any, output: Path, *, indent: int | None = 2) -> None:
    """Write a value as JSON, without the NaN that JSON does not know.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    write_text(json.dumps(value, indent=indent, ensure_ascii=False, allow_nan=False) + "\n", output)
