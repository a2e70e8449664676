"""Interface of a format of exported runs: its endings, its files, and how frames are written."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seaglint.files.export.encoding import NumberFormat
    from seaglint.files.export.stack import Stack


class ExportFormat:
    """Format of an exported run; each is a class, listed in ``FORMATS`` of :mod:`seaglint.files.export`."""

    endings: ClassVar[tuple[str, ...]]  #: Endings of its files, in lower case.
    aliases: ClassVar[tuple[str, ...]] = ()  #: Other endings of the same files, which the help leaves out.
    note: ClassVar[str] = ""  #: Remark of the help on it.

    @classmethod
    def require(cls) -> None:
        """Refuse before the work where a library is missing.

        Raises
        ------
        BackendError
            The library is not installed.
        """

    @classmethod
    def header_path(cls, output: Path) -> Path | None:
        """Return the file of a JSON header beside the output; None where the format has a header of its own."""
        return None

    @classmethod
    def stored(cls, numbers: NumberFormat, stack: Stack) -> NumberFormat:
        """Return the numbers as this format stores them; other than requested where its readers would mistake them."""
        return numbers

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write frames one after the other."""
        raise NotImplementedError
