"""Creation of the arrays of a sequence before its first frame.

All that a frame writes is cut into shards of the same frames, and a shard is a file: two processes that write into one file lose each
other's entries without a word, so each shard is written by one process. Within a shard every frame is a chunk that is read alone.
"""

from __future__ import annotations

from datetime import UTC
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.free_form import Attributes
from seaglint.base.processor import processor
from seaglint.base.schema import VARIABLES
from seaglint.files.store.layout import FORMAT, UNFINISHED, Layout
from seaglint.files.store.manifest import CHECKSUM, DONE, OVER
from seaglint.files.store.stored_truth import GROUP, TRUTHS


def make_arrays(store: Path | str, layout: Layout) -> None:
    """Make a store with coordinates and empty images; its attributes are written last and mark it as complete."""
    import zarr

    frames, rows, columns = layout.shape
    unit = layout.frames_per_unit

    def shards(itemsize: int, size: tuple[int, ...]) -> dict[str, Any]:
        whole = {"shards": (unit, *size)} if unit > 1 else {}
        return {"chunks": (1, *size), "compressors": _compressor(itemsize), **whole}

    begun: Attributes = {"seaglint_format": FORMAT, UNFINISHED: {"made": False}}
    group: Any = zarr.open_group(store, mode="w-", zarr_format=3, attributes=begun)
    directions = () if layout.turning else ("azimuth", "elevation")
    dated = () if layout.start is None else ("utc",)
    banded = () if layout.band is None else ("wavelength",)
    coordinates = " ".join((*directions, "frame", *dated, *banded, *layout.poses))
    for name in layout.variables:
        dtype = np.dtype(VARIABLES[name].dtype)
        group.create_array(
            name,
            shape=(frames, rows, columns),
            dtype=dtype,
            fill_value=np.nan if dtype.kind == "f" else 0,
            dimension_names=("time", "y", "x"),
            attributes={**VARIABLES[name].attributes, **layout.details.get(name, {}), "coordinates": coordinates},
            **shards(dtype.itemsize, (rows, columns)),
        )
    numbers = np.asarray(layout.frames, dtype=np.int64)
    _put(group, "time", numbers / layout.frame_rate, ("time",))
    _put(group, "frame", numbers, ("time",))
    if layout.start is not None:
        start = layout.start.astimezone(UTC).replace(tzinfo=None).isoformat(sep=" ")  # as CF writes it
        _put(group, "utc", numbers / layout.frame_rate, ("time",), units=f"seconds since {start}", calendar="standard")
    whole = layout.azimuth_deg.ndim == 2
    if not layout.turning:
        _put(group, "azimuth", layout.azimuth_deg, ("y", "x") if whole else ("x",))
        _put(group, "elevation", layout.elevation_deg, ("y", "x") if whole else ("y",))
    for name, values in layout.poses.items():
        _put(group, name, np.asarray(values), ("time",))
    if layout.band is not None:
        low, high = layout.band.min_um, layout.band.max_um
        _put(group, "wavelength", np.asarray(0.5 * (low + high)), (), bounds="wavelength_bounds")
        _put(group, "wavelength_bounds", np.array([low, high]), ("bounds",))
    truths = tuple(f"{GROUP}/{name}" for name in TRUTHS) if layout.truth is not None else ()
    over = {OVER: " ".join((*layout.variables, *layout.per_frame, *truths))}
    for name, kind, fill, more in (
        (DONE, "uint8", 0, {}),
        (CHECKSUM, "uint64", 0, over),
        *((name, "float32", np.nan, {}) for name in layout.per_frame),
    ):
        about = {**VARIABLES[name].attributes, **more}
        group.create_array(name, shape=(frames,), chunks=(unit,), dtype=kind, fill_value=fill, dimension_names=("time",), attributes=about)
    if layout.truth is not None:
        layout.truth.make(group, layout.shape, shards)
    group.attrs.put({**layout.all_attributes, "processor": processor(), UNFINISHED: {}})


def _compressor(itemsize: int) -> Any:
    # Byte shuffling lets zstd find the slowly varying exponents: 512 x 256 frames shrink by about a quarter in a millisecond.
    from zarr.codecs import BloscCodec

    return BloscCodec(cname="zstd", clevel=3, shuffle="shuffle", typesize=itemsize)


def _put(group: Any, name: str, values: NDArray[Any], dimensions: tuple[str, ...], **more: str) -> None:
    array = group.create_array(
        name,
        shape=values.shape,
        dtype=values.dtype,
        chunks=tuple(max(size, 1) for size in values.shape) or "auto",
        dimension_names=dimensions,
        attributes={**VARIABLES[name].attributes, **more},
    )
    array[...] = values
