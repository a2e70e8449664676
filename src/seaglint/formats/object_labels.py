"""Labels of a sequence's objects, from its truth, as CSV and as COCO's JSON with masks as run lengths.

Masks are of the objects' responses after the optics, or geometric: the pixels that an object touches at the aperture. Sequences without a
detector have geometric masks alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.base.reports import REPORTS
from seaglint.base.schema import NUMBERS
from seaglint.formats.tables.table_text import csv_text
from seaglint.store.layout import GROUP, unpacked
from seaglint.store.outputs import refuse_existing, write_json, write_text
from seaglint.store.sequence_store import open_sequence

if TYPE_CHECKING:
    import xarray as xr

MOST_NAMED: Final = 5  #: Objects in no frame that are named; more are counted.

RESPONSE: Final = "response"  #: Masks of the responses after the optics.
GEOMETRIC: Final = "geometric"  #: Masks of the pixels that objects touch at the aperture.

MASKS: Final = (RESPONSE, GEOMETRIC)  #: Kinds of masks; the first is the default.

BLOCK: Final = 64  #: Frames whose numbers are read at once: a request to a store costs a millisecond however little it reads.


@dataclass(frozen=True, eq=False)
class Label:
    """Label of one object in one frame: its number from 0, name, numbers by variable, and mask (rows, columns)."""

    frame: int
    number: int
    name: str
    values: Mapping[str, float]
    mask: NDArray[np.bool_]
    masks: str = GEOMETRIC  #: Kind of the mask.

    def side(self, name: str) -> float:
        """Return ``left``, ``top``, ``width`` or ``height`` of the mask's box [px]; across a panorama's seam it ends beyond the edge."""
        return self.values[f"{'response' if self.masks == RESPONSE else 'bbox'}_{name}_px"]


@dataclass(frozen=True, eq=False)
class Labels:
    """Labels of a finished sequence, with masks read frame by frame. Those of a store are opened by ``of``."""

    path: Path
    names: tuple[str, ...]
    frames: tuple[int, ...]
    shape: tuple[int, int]
    arrays: Mapping[str, Any]  #: Numbers of the objects and planes of their masks by name, with the frames first.
    masks: str = field(default=RESPONSE)  #: Kind of masks, one of ``MASKS``; geometric where the sequence has no others.

    def __post_init__(self) -> None:
        if "response_mask" not in self.arrays:
            object.__setattr__(self, "masks", GEOMETRIC)

    @classmethod
    def of(cls, path: str | Path, masks: str = RESPONSE) -> Labels:
        """Open the labels of a store with masks of a kind.

        Raises
        ------
        DataError
            No finished sequence, one without objects, or an unknown kind of masks.
        """
        import zarr

        path = Path(path)
        require_masks(masks)
        with open_sequence(path) as dataset:
            frames = tuple(int(n) for n in dataset["frame"].to_numpy())
        root: Any = zarr.open_group(path, mode="r", zarr_format=3)
        if GROUP not in root:
            raise DataError(f"{path}: holds no objects; labels are of sequences whose scenario has [[objects]]: add some and render again")
        arrays = dict(root[GROUP].arrays())
        return cls(path, tuple(str(name) for name in root[GROUP].attrs["objects"]), frames, arrays["object_id"].shape[1:], arrays, masks)

    def never_seen(self) -> list[str]:
        """Return a text for each object that no frame shows: name, reason, and place in the first frame."""
        if not self.frames or any(name not in self.arrays for name in ("visible_share", "truncated_share", "bearing_deg", "range_m")):
            return []  # of an earlier version
        visible = np.nan_to_num(self.arrays["visible_share"][:]).max(axis=0) > 0.0
        cut = np.nan_to_num(self.arrays["truncated_share"][:])
        why = ("is hidden behind the horizon, waves or other objects", "is outside the picture", "is outside the picture or hidden")
        reasons = [
            why[0] if most <= 0.0 else why[1] if least >= 1.0 else why[2]
            for least, most in zip(cut.min(axis=0), cut.max(axis=0), strict=True)
        ]
        azimuth, arc = self.arrays["bearing_deg"][0], self.arrays["range_m"][0]
        return [
            f"'{name}' {reasons[n]} (azimuth {round(float(azimuth[n]) % 360.0, 2) % 360.0:.4g} deg, "
            f"{float(arc[n]) / 1000.0:.3g} km away in frame {self.frames[0]})"
            for n, name in enumerate(self.names)
            if not visible[n]
        ]

    def __iter__(self) -> Iterator[Label]:
        """Yield one label for each object of each frame."""
        # Sequences of earlier versions lack some numbers.
        unknown = np.full((BLOCK, len(self.names)), np.nan)
        for first in range(0, len(self.frames), BLOCK):
            places = slice(first, first + BLOCK)
            numbers = {name: np.asarray(self.arrays[name][places]) if name in self.arrays else unknown for name in NUMBERS}
            for n, frame in enumerate(self.frames[places]):
                planes = self.arrays["response_mask" if self.masks == RESPONSE else "object_mask"]
                masks = unpacked(planes[first + n], len(self.names))
                for number, (name, mask) in enumerate(zip(self.names, masks, strict=True)):
                    yield Label(frame, number, name, {key: float(values[n, number]) for key, values in numbers.items()}, mask, self.masks)


def require_masks(masks: str) -> str:
    """Check the name of a kind of masks."""
    if masks not in MASKS:
        raise DataError(f"masks = {masks!r}: is not one of {', '.join(MASKS)}; give one of them")
    return masks


def report_never_seen(labels: Labels) -> None:
    """Report the objects that no frame shows, with their place and the reason."""
    unseen = labels.never_seen()
    if unseen:
        more = f"; and {len(unseen) - MOST_NAMED} more" if len(unseen) > MOST_NAMED else ""
        text = "%s: no frame shows %d of %d objects: %s%s; turn the sensor (sensor.azimuth_deg, sensor.elevation_deg), or move them"
        REPORTS.warning(text, labels.path, len(unseen), len(labels.names), "; ".join(unseen[:MOST_NAMED]), more)


def label_dataset(labels: Labels) -> xr.Dataset:
    """Return labels as a dataset over ``frame`` and ``object``: all numbers, and ``classes``, the names; masks stay in the store."""
    import xarray as xr

    from seaglint.base.schema import VARIABLES

    shape = (len(labels.frames), len(labels.names))
    values = {name: np.full(shape, np.nan) for name in NUMBERS}
    for position, label in enumerate(labels):
        for name, array in values.items():
            array[divmod(position, shape[1])] = label.values[name]
    return xr.Dataset(
        {name: (("frame", "object"), array, VARIABLES[name].attributes) for name, array in values.items()},
        {
            "frame": ("frame", list(labels.frames), {"long_name": "number of the frame"}),
            "object": ("object", list(range(shape[1])), {"long_name": "number of the object"}),
            "classes": ("object", list(labels.names), {"long_name": "name of the object"}),
        },
        {"title": "Labels of objects", "source": str(labels.path)},
    )


def run_lengths(mask: NDArray[np.bool_]) -> list[int]:
    """Return the lengths of runs of a mask, column by column from its upper left corner, the first outside it (COCO's counts)."""
    flat = mask.T.ravel()  # column by column, as COCO counts
    runs = np.diff(np.concatenate([[0], np.flatnonzero(np.diff(flat)) + 1, [flat.size]])).tolist()
    return [0, *runs] if flat.size and flat[0] else runs


def write_labels(labels: Labels, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write labels as CSV or COCO JSON, chosen by the ending.

    Raises
    ------
    DataError
        Another ending, or the output exists.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = require_labels_name(output)
    refuse_existing(output, overwrite=overwrite, inputs=[labels.path])
    if output.suffix.lower() != ".csv":
        write_json(_coco(labels), output, indent=None)
        return output
    cells = (
        (label.frame, label.name, *("" if math.isnan(value) else f"{value:.9g}" for value in map(label.values.__getitem__, NUMBERS)))
        for label in labels
    )
    write_text(csv_text([("frame", "object", *NUMBERS), *cells]), output)
    return output


def require_labels_name(output: str | Path) -> Path:
    """Check that a name has the ending of one of the forms of labels."""
    output = Path(output)
    if output.suffix.lower() not in (".csv", ".json"):
        raise DataError(f"{output}: labels are written as .csv or .json (COCO); give a name that ends in one of them")
    return output


def _coco(labels: Labels) -> JsonObject:
    """Return COCO's dictionary: an image for each frame, a category for each name, an annotation for each object in view.

    Images have no ``file_name``, as a store holds no pictures that one could open.
    """
    rows, columns = labels.shape
    # COCO counts categories from 1.
    categories = {name: number for number, name in enumerate(dict.fromkeys(labels.names), 1)}
    annotations = [
        {
            "id": number,
            "image_id": label.frame,
            "category_id": categories[label.name],
            "track_id": label.number,
            "bbox": [label.side(name) for name in ("left", "top", "width", "height")],
            "area": int(label.mask.sum()),
            "iscrowd": 0,
            "segmentation": {"size": [rows, columns], "counts": run_lengths(label.mask)},
            "attributes": {name: None if math.isnan(label.values[name]) else label.values[name] for name in NUMBERS},
        }
        for number, label in enumerate((label for label in labels if label.mask.any()), 1)
    ]
    return {
        "info": {"description": f"Objects of {labels.path.name}", "version": "1"},
        "images": [{"id": n, "width": columns, "height": rows} for n in labels.frames],
        "categories": [{"id": number, "name": name, "supercategory": "object"} for name, number in categories.items()],
        "annotations": annotations,
    }
