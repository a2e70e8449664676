"""Frames of stored runs written as files of other programs, one frame after the other: one file per family of formats."""

from typing import Final

from seaglint.formats.export.file_formats import ExportFormat, Fits, Hdf5, Npy, Raw, Tiff

#: All formats of numbers, in the order of help texts and of lists in errors.
FORMATS: Final[tuple[type[ExportFormat], ...]] = (Hdf5, Tiff, Fits, Npy, Raw)


def endings() -> tuple[str, ...]:
    """Return all endings of files of numbers.

    >>> ".tiff" in endings()
    True
    """
    return tuple(ending for form in FORMATS for ending in (*form.endings, *form.aliases))


def format_of(ending: str) -> type[ExportFormat] | None:
    """Return the format of an ending in lower case; None of one that no format has."""
    return next((form for form in FORMATS if ending in (*form.endings, *form.aliases)), None)
