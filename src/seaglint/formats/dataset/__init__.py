"""Labelled data sets for detectors: pictures with a scale, masks, boxes and tables, in the layouts that training programs read."""

from typing import Final

from seaglint.base.errors import DataError
from seaglint.formats.dataset.layouts import Coco, Sirst, Stores, Yolo
from seaglint.formats.dataset.scene_records import DatasetFormat
from seaglint.formats.dataset.sequence_layouts import CocoVideo, Mot, NudtMirsdt

#: All formats, in the order of help texts and of lists in errors.
FORMATS: Final[tuple[type[DatasetFormat], ...]] = (Coco, Yolo, Sirst, CocoVideo, Mot, NudtMirsdt, Stores)


def format_named(name: str) -> type[DatasetFormat]:
    """Return the format of a name.

    Raises
    ------
    DataError
        There is none of this name.

    Examples
    --------
    >>> format_named("mot").sequences
    True
    """
    for form in FORMATS:
        if form.name == name:
            return form
    raise DataError(f"format = {name!r}: is not one of {', '.join(form.name for form in FORMATS)}; give one of them")
