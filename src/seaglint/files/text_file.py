"""Reader and writer of text and JSON files: errors of one line, and files that are written completely or not at all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from seaglint.base.errors import DataError
from seaglint.files.outputs import moved_when_whole


def read_text(path: Path, hint: str) -> str:
    """Return the text of a file in UTF-8, with its line ends and without the mark that some programs put at the beginning.

    Raises
    ------
    DataError
        The file is missing, cannot be read or is no text; the message ends with ``hint``, which says what to give instead.
    """
    try:
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; {hint}") from None
    except UnicodeDecodeError as error:
        raise DataError(f"{path}: is not UTF-8 text (byte {error.start}); {hint}") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}); {hint}") from None


def read_json(path: Path, hint: str) -> Any:
    """Return the value that a JSON file holds.

    Raises
    ------
    DataError
        As :func:`read_text`, and for a text that is no JSON or is cut.
    """
    return parsed_json(path, read_text(path, hint), hint)


def parsed_json(path: Path, text: str, hint: str) -> Any:
    """Return the value of a JSON text that was read from a file.

    Raises
    ------
    DataError
        It is no JSON, or is cut.
    """
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        at = f"line {error.lineno}: {error.msg}" if isinstance(error, json.JSONDecodeError) else "a number or its nesting is too long"
        raise DataError(f"{path}: is no JSON, or is cut short ({at}); {hint}") from None


def write_text(text: str, output: Path) -> None:
    """Write a text in UTF-8 with line ends as they are.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    with moved_when_whole(output) as partial:
        partial.write_bytes(text.encode())


def json_text(value: Any, *, indent: int | None = 2) -> str:
    """Return a value as JSON, without the NaN that JSON does not know."""
    return json.dumps(value, indent=indent, ensure_ascii=False, allow_nan=False)


def write_json(value: Any, output: Path, *, indent: int | None = 2) -> None:
    """Write a value as JSON.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    write_text(json_text(value, indent=indent) + "\n", output)
