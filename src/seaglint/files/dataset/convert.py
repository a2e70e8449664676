"""A finished scene store becomes pictures and a record of what is in them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from seaglint.base.errors import DataError
from seaglint.files.counts import count_line, pictures
from seaglint.files.dataset import format_named
from seaglint.files.dataset.grey_levels import Bits, PictureLevels
from seaglint.files.dataset.grey_picture import write_picture
from seaglint.files.dataset.masks import box_of, compressed
from seaglint.files.dataset.part import DatasetFrame, DatasetObject, DatasetScene, Entry, Piece, known
from seaglint.files.store.object_labels import Label, Labels, run_lengths
from seaglint.files.store.store import open_sequence
from seaglint.objects.drawing.truth import LEAST_CLUTTER, SURROUND

if TYPE_CHECKING:
    import xarray as xr

BLUR: Final = 2  #: Pixels around masks into which optics spread an object: left out of its surroundings.


@dataclass(frozen=True)
class ConversionSettings:
    """How scenes are written."""

    folder: str  #: Of the data set, or of the unfinished one.
    format: str  #: Name of one of :data:`seaglint.files.dataset.FORMATS`.
    bits: Bits  #: Of a pixel.
    image: str  #: Ending of pictures.
    classes: Mapping[str, str]  #: Category of an object by its name; its preset, or the kind of its shape, where nothing is said.


def convert(entry: Entry, settings: ConversionSettings) -> DatasetScene:
    """Write a scene's pictures, and its record last.

    Raises
    ------
    DataError
        No finished sequence.
    StorageError
        No room or no rights.
    """
    folder, form = Path(settings.folder), format_named(settings.format)
    with open_sequence(entry.store) as dataset:
        variable = pictures(dataset)
        levels = _levels(variable, settings.bits, entry) if form.pictures else None
        frames = [int(number) for number in dataset["frame"].to_numpy()]
        times = [float(time) for time in dataset["time"].to_numpy()]
        numbered = tuple(
            DatasetFrame(f"{entry.name}_{frame:06d}", frame, round(time, 9)) for frame, time in zip(frames, times, strict=True)
        )
        scenario = json.loads(dataset.attrs["scenario"])
        objects = scenario.get("objects") or []
        for index, picture in enumerate(numbered):
            if levels is not None:
                about = {"scene": entry.name, "frame": picture.frame, "time_s": picture.time_s, **levels.attributes}
                path = form.image_path(folder, entry.split, picture.name, settings.image)
                write_picture(path, levels.of(variable[index].to_numpy()), about)
        rows = tuple(_rows(Labels.of(entry.store), variable)) if objects else ()
        part = DatasetScene(
            scene=entry.name,
            split=entry.split,
            seed=int(dataset.attrs["seed"]),
            shape=(int(variable.shape[1]), int(variable.shape[2])),
            frame_rate_hz=float(scenario["sensor"]["frame_rate_hz"]),
            levels=levels,
            names=tuple(item["name"] for item in objects),
            categories=tuple(category_of(item, settings.classes) for item in objects),
            pictures=numbered,
            rows=rows,
            parameters=dict(entry.parameters),
        )
    part.write(folder)
    return part


def _levels(variable: xr.DataArray, bits: Bits, entry: Entry) -> PictureLevels:
    """Lines that hold all frames of the scene."""
    least = [float(variable[i].min()) for i in range(variable.shape[0])]
    most = [float(variable[i].max()) for i in range(variable.shape[0])]
    low, high = min(least), max(most)
    if not np.isfinite([low, high]).all():
        raise DataError(f"{entry.store}: its pictures have pixels without a value; render it again")
    if variable.name == "signal":
        return PictureLevels.of_counts(int(low), int(high), bits, count_line(variable))
    return PictureLevels.of_radiance(low, high, bits)


def category_of(item: Mapping[str, Any], classes: Mapping[str, str]) -> str:
    """Return the class of an object by its name, preset or kind of shape; those that a template drew are named NAME-1, NAME-2, ..."""
    name = str(item["name"])
    drawn, _, number = name.rpartition("-")
    category = classes.get(name) or (classes.get(drawn) if number.isdecimal() else None)
    return str(category or item.get("preset") or item["shape"]["kind"])


def _rows(labels: Labels, variable: xr.DataArray) -> list[DatasetObject]:
    """Truth of all frames."""
    rows = []
    slope, _ = count_line(variable)
    for index, (_, group) in enumerate(groupby(labels, key=lambda label: label.frame)):
        several = list(group)
        values = np.asarray(variable[index].to_numpy(), np.float64)
        spread = binary_dilation(np.logical_or.reduce([label.mask for label in several]), iterations=BLUR)
        for label in several:
            numbers = {name: known(value) for name, value in label.values.items()}
            found_here = local_contrast(values, label.mask, spread)
            contrast, snr = (None, None) if found_here is None else (found_here[0] * slope, found_here[1])
            rows.append(DatasetObject(index, label.number, numbers, contrast, snr, tuple(pieces(label))))
    return rows


def pieces(label: Label) -> list[Piece]:
    """Boxes and masks of what is seen of an object: the box is the mask's; one over the seam of a panorama is cut there."""
    mask = label.mask
    if not mask.any():
        return []
    columns = mask.shape[1]
    left, width = label.values["bbox_left_px"], label.values["bbox_width_px"]
    cut = left + width > columns
    halves = [np.arange(columns) >= left, np.arange(columns) < left] if cut else [np.ones(columns, bool)]
    parts = [mask & half for half in halves]
    return [Piece(box_of(part), int(part.sum()), compressed(run_lengths(part))) for part in parts if part.any()]


def local_contrast(values: NDArray[np.float64], mask: NDArray[np.bool_], covered: NDArray[np.bool_]) -> tuple[float, float] | None:
    r"""Contrast and signal-to-noise ratio of an object in the delivered picture.

    The contrast is :math:`\bar v_t - \bar v_b`, the ratio :math:`|\bar v_t - \bar v_b| / \sigma_b`, with the mean over the mask, and mean
    and standard deviation of the pixels within 10 of the mask's box that no object covers or blurs into. None where the object is out of
    view, or its surroundings have fewer than 8 such pixels or do not vary.

    Parameters
    ----------
    values : ndarray
        Counts or radiance.
    mask : ndarray
        Of the object.
    covered : ndarray
        Pixels that are no surroundings of any object.
    """
    if not mask.any():
        return None
    left, top, width, height = box_of(mask)
    where = (slice(max(top - SURROUND, 0), top + height + SURROUND), slice(max(left - SURROUND, 0), left + width + SURROUND))
    around = values[where][~covered[where]]
    spread = float(around.std()) if around.size >= LEAST_CLUTTER else 0.0
    if spread == 0.0:
        return None
    contrast = float(values[mask].mean()) - float(around.mean())
    return contrast, abs(contrast) / spread
