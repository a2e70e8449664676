"""Lines of files of observations. These have dirt: bad lines are left out and counted by kind, unless they are the larger part."""

from __future__ import annotations

import gzip
import zlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

Line = tuple[int, str]  #: Line of a file: its number from 1, and its text.


def shown(text: str, most: int = 60) -> str:
    r"""Return the beginning of a text for a message of one line.

    >>> shown("a\tb\x00" + "c" * 100, 8)
    'a?b?cccc...'
    """
    cut = "".join(sign if sign.isprintable() else "?" for sign in text[:most])
    return cut + "..." if len(text) > most else cut


def text_of(path: Path) -> str:
    """Return the content of a file as text, also of one packed by gzip; a byte that is no UTF-8 is one character.

    Raises
    ------
    DataError
        A file that is missing or cannot be read.
    """
    try:
        content = path.read_bytes()
        if content[:2] == b"\x1f\x8b":
            content = gzip.decompress(content)
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; give a file of weather or waves") from None
    except (OSError, EOFError, zlib.error) as error:
        raise DataError(f"{path}: cannot be read ({error}); is it whole?") from None
    return content.removeprefix(b"\xef\xbb\xbf").decode("latin-1")


def lines_of(text: str) -> list[Line]:
    r"""Return the lines of a text that are not empty; free text in a line may hold any other sign that Python ends lines at.

    >>> lines_of("a\x0bb\r\n\nc")
    [(1, 'a\x0bb'), (3, 'c')]
    """
    numbered = ((number, line.removesuffix("\r")) for number, line in enumerate(text.split("\n"), 1))
    return [(number, line) for number, line in numbered if line.strip(" ")]


def sound(path: Path, lines: Sequence[Line], faults: Sequence[str], what: str, remedy: str) -> tuple[NDArray[np.bool_], dict[str, int]]:
    """Return true for each line without a fault, and the number of the other lines by fault.

    Parameters
    ----------
    path : Path
        The file.
    lines, faults : sequences
        Its lines, and what is wrong with each: empty, or words such as ``without a year``.
    what, remedy : str
        A good line in words, and what to do.

    Raises
    ------
    DataError
        No lines, or more than half of them with a fault.
    """
    counts = Counter(fault for fault in faults if fault)
    bad = counts.total()
    if not lines:
        raise DataError(f"{path}: holds no records; bring the file again")
    if 2 * bad > len(lines):
        number, text = next(line for line, fault in zip(lines, faults, strict=True) if fault)
        kinds = ", ".join(f"{count} {fault}" for fault, count in counts.items())
        raise DataError(
            f"{path}: {bad} of {len(lines)} lines are no {what}: {kinds}; the first is line {number}: '{shown(text)}'; {remedy}"
        )
    return np.array([not fault for fault in faults]), dict(counts)
