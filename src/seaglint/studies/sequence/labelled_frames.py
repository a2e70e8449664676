"""Labelled datasets of a scenario without files: one image, or the frames of its sequence with the arrays of a store."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from datetime import UTC, timedelta
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError, DomainError
from seaglint.base.schema import NUMBERS, VARIABLES
from seaglint.formats.dataset.dataset_writing import category_of
from seaglint.imaging.camera.pose import pixel_directions, pose_at
from seaglint.imaging.layers import require_layers
from seaglint.scenario.model import Scenario
from seaglint.store.layout import Layout, unpacked
from seaglint.store.netcdf import plain_attributes
from seaglint.store.provenance import band_attributes
from seaglint.studies.sequence import render_sequence as plain
from seaglint.studies.sequence import sensed_sequence
from seaglint.studies.sequence.out_of_view import report_out_of_view
from seaglint.studies.sequence.render_sequence import prepare_sequence

if TYPE_CHECKING:
    import xarray as xr


def image(scenario: Scenario, time: float = 0.0, layers: Collection[str] = ()) -> xr.Dataset:
    """Compute the image of a scenario at a time, as a labelled dataset.

    Parameters
    ----------
    scenario : Scenario
        Scenario to render; its ``render.layers`` are ignored.
    time : float
        Time from the start [s].
    layers : collection of str
        Further images, of ``seaglint.base.schema.LAYERS``.

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1, (y, x)] and the layers; ``azimuth`` and ``elevation`` of the pixels at that time as coordinates, and the
        place of a moving sensor.

    Raises
    ------
    DomainError
        A time that is not finite or outside the platform's track, or an unknown layer.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> tables = {"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}}
    >>> small = parse_scenario(tables)
    >>> list(image(small, layers=["range"]).data_vars)
    ['radiance', 'range']
    """
    import xarray as xr

    if not math.isfinite(time):
        raise DomainError(f"time = {time:g} s is not finite; give seconds from the start")
    requested = require_layers([layers] if isinstance(layers, str) else layers)
    # An image has one time, so objects of later frames are not reported.
    report_out_of_view(scenario, times=np.array([time]))
    settings = scenario.render.model_copy(update={"layers": requested, "apparent_temperature": False})
    run = prepare_sequence(scenario.model_copy(update={"render": settings}), range(1))
    layer_values = run.at(time)
    directions = pixel_directions(*run.scene_at(time).directions(run.track.at(time)))
    return xr.Dataset(
        {name: (("y", "x"), layer_values[name].astype(VARIABLES[name].dtype, copy=False)) for name in ("radiance", *requested)},
        coords={**directions, "time": float(time), **pose_at(run.track, time)},
        attrs=plain_attributes({**run.layout.attributes, "title": "Infrared image of the sea", **band_attributes(run.layout.band)}),
    )


SIDES = ("left", "top", "width", "height")  #: Numbers of a box, in COCO's order [px].


def frame_datasets(
    scenario: Scenario, frames: range | None = None, *, electrons: bool = False, radiance: bool = False
) -> Iterator[xr.Dataset]:
    """Prepare a scenario, then make its frames one after the other.

    Parameters
    ----------
    scenario : Scenario
        What to render.
    frames : range, optional
        Numbers of the frames, counted from 0; all of the scenario by default.
    electrons, radiance : bool
        With a detector: electrons, and radiance at the aperture averaged over pixels, beside counts.

    Returns
    -------
    iterator of xarray.Dataset
        The images of each frame and the truth of its objects.

    Raises
    ------
    SeaglintError
        A condition outside the models, frames that the scenario does not have, or electrons of a scenario without a detector.
    """
    numbers = require_numbers(frames, scenario.sensor.frames)
    report_out_of_view(scenario, numbers)
    if scenario.sensor.senses:
        layout, images = sensed_sequence.prepared_frames((scenario, numbers, electrons, radiance))
    elif electrons or radiance:
        raise DataError("electrons and radiance need a detector, and the scenario has no [sensor.detector]; leave them out, or add one")
    else:
        layout, images = plain.prepared_frames((scenario, numbers))
    objects = scenario.model_dump(mode="json", exclude_none=True).get("objects", ())
    classes = tuple(category_of(item, {}) for item in objects)
    return (labelled_frame(layout, position, images(number), classes) for position, number in enumerate(layout.frames))


def require_numbers(frames: range | None, count: int) -> range:
    """Return the numbers of frames, by default all of the scenario.

    Raises
    ------
    DataError
        No range, an empty one, or frames that the scenario does not have.
    """
    if frames is None:
        return range(count)
    if not isinstance(frames, range):
        raise DataError(f"frames = {frames!r} is no range of numbers; give e.g. range(0, {count}), or leave it out for all frames")
    if len(frames) == 0:
        raise DataError(f"frames = {frames!r} is empty; give e.g. range(0, {count}), or leave it out for all frames")
    if min(frames[0], frames[-1]) < 0 or max(frames[0], frames[-1]) >= count:
        raise DataError(f"frames = {frames!r}: the scenario has frames 0 to {count - 1}; give some of them, or raise sensor.frames")
    return frames


def labelled_frame(layout: Layout, position: int, arrays: Mapping[str, NDArray[Any]], classes: tuple[str, ...] = ()) -> xr.Dataset:
    """Return the arrays of a frame as a dataset with the coordinates, units and attributes of its store.

    Parameters
    ----------
    layout : Layout
        Layout of the sequence.
    position : int
        Position of the frame in the layout.
    arrays : mapping
        Arrays by variable, with the truth of objects.
    classes : tuple of str
        Class of each object.
    """
    import xarray as xr

    number = layout.frames[position]
    time = number / layout.frame_rate
    whole = layout.azimuth_deg.ndim == 2
    directions = {} if layout.turning else {"azimuth": layout.azimuth_deg, "elevation": layout.elevation_deg}
    axes = {"azimuth": ("y", "x") if whole else ("x",), "elevation": ("y", "x") if whole else ("y",)}
    coordinates: dict[str, Any] = {
        "time": ((), time, VARIABLES["time"].attributes),
        "frame": ((), number),
        **{name: (axes[name], values, VARIABLES[name].attributes) for name, values in directions.items()},
        **{name: ((), float(values[position]), VARIABLES[name].attributes) for name, values in layout.poses.items()},
    }
    if layout.start is not None:
        # NumPy's datetimes have no zone; they are UTC by convention.
        moment = layout.start.astimezone(UTC).replace(tzinfo=None) + timedelta(seconds=time)
        coordinates["utc"] = ((), np.datetime64(moment, "ns"))
    variables: dict[str, Any] = {
        name: (("y", "x"), np.asarray(arrays[name], VARIABLES[name].dtype), {**VARIABLES[name].attributes, **layout.details.get(name, {})})
        for name in layout.variables
    }
    variables |= {name: ((), np.float32(arrays[name]), VARIABLES[name].attributes) for name in layout.per_frame}
    if layout.truth is not None:
        coordinates["object"] = ("object", np.arange(len(layout.truth.names)), {"long_name": "number of the object"})
        coordinates["side"] = ("side", list(SIDES))
        variables |= _truth(layout.truth.names, classes, arrays)
    return xr.Dataset(variables, coordinates, plain_attributes(layout.all_attributes))


def _truth(names: tuple[str, ...], classes: tuple[str, ...], arrays: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return classes, boxes, masks and truth numbers of the objects of a frame as variables."""
    numbers = {name: np.asarray(arrays.get(name, np.full(len(names), np.nan)), np.float64) for name in NUMBERS}
    masks = np.stack(list(unpacked(arrays["object_mask"], len(names))))
    responses = {}
    if "response_mask" in arrays:
        planes = np.stack(list(unpacked(arrays["response_mask"], len(names))))
        responses = {"response_masks": (("object", "y", "x"), planes, {"long_name": "pixels of an object's response after the optics"})}
    boxes = np.stack([numbers[f"bbox_{side}_px"] for side in SIDES], axis=-1)
    about = {"units": "1", "long_name": "first column and row, and number of columns and rows, that an object touches"}
    return {
        "classes": ("object", np.array(classes, dtype=object), {"long_name": "class of the object: its preset, else its kind of shape"}),
        "names": ("object", np.array(names, dtype=object), {"long_name": "name of the object"}),
        "boxes": (("object", "side"), boxes, about),
        "masks": (("object", "y", "x"), masks, {"long_name": "pixels that an object touches"}),
        **responses,
        "object_id": (("y", "x"), np.asarray(arrays["object_id"], np.uint16), VARIABLES["object_id"].attributes),
        **{name: ("object", values, VARIABLES[name].attributes) for name, values in numbers.items()},
    }
