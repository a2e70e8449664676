"""Readers of NetCDF and Zarr, of seaglint or of other programs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.base.schema import default_image
from seaglint.files.netcdf import drop_quietly, open_netcdf
from seaglint.files.recording.arrays import ArrayFacts, ArrayReading, choose, of_array, text_of
from seaglint.files.recording.axes import letter_of
from seaglint.files.recording.decoding import Decoding, in_type, of_attributes
from seaglint.files.recording.frame_times import SAME, frame_rate_of, rate_of_times
from seaglint.files.recording.hdf5_arrays import open_hdf5, unwritten_note, unwritten_numbers, with_default_fill

MOST_NAMED: Final = 16  #: Largest number of channels that a message names.

_METADATA: Final = ("zarr.json", ".zgroup", ".zarray", ".zmetadata")


def is_zarr(path: Path) -> bool:
    """Return true for the folder of a Zarr store, of a group or of one array."""
    return path.is_dir() and any((path / name).exists() for name in _METADATA)


def open_labelled_netcdf(path: Path, how: ArrayReading) -> Recording:
    """Open NetCDF: a variable of its root, otherwise one of its groups."""
    dataset = open_netcdf(path, chunks=None, decode_times=False, mask_and_scale=False)
    with path.open("rb") as file:
        hdf5 = file.read(4) == b"\x89HDF"
    if hdf5 and not (_images(dataset) if how.variable is None else how.variable in dataset.variables):
        dataset.close()
        return open_hdf5(path, how, netcdf=True)
    return of_dataset(dataset, str(path), how, netcdf=True)


def open_zarr(path: Path, how: ArrayReading, *, ours: bool = False) -> Recording:
    """Open a Zarr store of version 2 or 3, with or without names of dimensions; of ``ours`` the chunks are known to be whole."""
    import xarray as xr
    import zarr

    try:
        node: Any = zarr.open(str(path), mode="r")
    except Exception as error:
        raise _unreadable(path, error) from error
    if isinstance(node, zarr.Array):
        return _of_zarr_array(node, str(path), how)
    try:
        dataset = xr.open_dataset(str(path), engine="zarr", chunks=None, decode_times=False, consolidated=False, mask_and_scale=False)
        labelled = bool(_images(dataset)) if how.variable is None else how.variable in dataset.variables
    except Exception as error:
        drop_quietly(error)
        labelled = False
    arrays = {str(name): member for name, member in _members(node) if _can_be_images(member)}
    if labelled:
        name = _chosen(dataset, how.variable, str(path))
        if ours or name not in arrays:
            return of_dataset(dataset, str(path), replace(how, variable=name))
        if arrays[name].metadata.zarr_format == 2:
            # xarray puts the fill value of the store, which is no attribute, in the place of the attribute.
            dataset[name].attrs.pop("_FillValue", None)
            dataset[name].attrs |= {key: value for key, value in arrays[name].attrs.items() if key == "_FillValue"}
        how = replace(how, variable=name, missing=(*how.missing, *_packed_fill(arrays[name])))
        return of_dataset(dataset, str(path), how).with_notes(*_fill_notes(arrays[name], how.missing))
    name = choose(arrays, how.variable, path)
    return _of_zarr_array(arrays[name], f"{path}:{name}", how)


def _members(group: Any) -> list[tuple[str, Any]]:
    import zarr

    return [(name, member) for name, member in group.members(max_depth=None) if isinstance(member, zarr.Array)]


def _can_be_images(array: Any) -> bool:
    return array.ndim >= 2 and array.size > 1 and np.dtype(array.dtype).kind in "uifb" and "flag_meanings" not in array.attrs


def _of_zarr_array(array: Any, source: str, how: ArrayReading) -> Recording:
    attributes = dict(array.attrs)
    decoding, notes = of_attributes(attributes, np.dtype(array.dtype), source)
    names = tuple(attributes.get("_ARRAY_DIMENSIONS") or getattr(array.metadata, "dimension_names", None) or ())
    facts = ArrayFacts(
        frame_rate_of(attributes),
        None if notes else text_of(attributes.get("units")),
        tuple(map(str, names)) if all(names) else (),
        decoding,
        notes=(*notes, *_fill_notes(array, how.missing)),
    )
    return of_array(array, source, replace(how, missing=(*how.missing, *_packed_fill(array))), facts)


def _packed_fill(array: Any) -> tuple[float, ...]:
    """Return the fill value of packed numbers of version 2 that no attribute calls missing: there xarray writes ``_FillValue`` so."""
    attributes, fill = dict(array.attrs), array.fill_value
    packed = array.metadata.zarr_format == 2 and ("scale_factor" in attributes or "add_offset" in attributes)
    stated = "_FillValue" in attributes or "missing_value" in attributes
    return () if not packed or stated or fill is None or fill == 0 else (fill,)


def _fill_notes(array: Any, masked: tuple[float, ...]) -> tuple[str, ...]:
    """Return notes on the fill value: it fills chunks that are not there, and is a number where it stands in one.

    The first, middle and last frames are looked at. Version 3 has no reader that masks its usual fill value, 0.
    """
    notes = []
    attributes = dict(array.attrs)
    there, whole = int(array.nchunks_initialized), int(array.nchunks)
    fill = array.fill_value
    if there < whole:
        notes.append(unwritten_note(whole - there, whole, fill))
    dtype = np.dtype(array.dtype)
    if fill is None or "_FillValue" in attributes or "missing_value" in attributes or not in_type([fill], dtype) or fill in masked:
        return tuple(notes)
    if array.metadata.zarr_format == 3 and fill == 0:
        return tuple(notes)
    frames = sorted({0, array.shape[0] // 2, array.shape[0] - 1}) if array.ndim > 2 else [slice(None)]
    if there == whole and any(bool(np.any(np.asarray(array[i]) == fill)) for i in frames):
        notes.append(
            f"the store's fill value {float(fill):.9g} also occurs as data and counts as a number, as no attribute calls it missing; "
            f"--missing {float(fill):.9g} masks it"
        )
    return tuple(notes)


def _unreadable(path: Path, error: Exception) -> DataError:
    reason = " ".join(str(error).split())[:200] or type(error).__name__
    return DataError(f"{path}: cannot be read as Zarr ({reason})")


def _images(dataset: Any) -> dict[str, Any]:
    """Return the variables that can be images: two axes that are longer than one, and no categories."""
    return {
        str(name): variable
        for name, variable in dataset.data_vars.items()
        if variable.dtype.kind in "uifb" and variable.ndim >= 2 and variable.size > 1 and "flag_meanings" not in variable.attrs
        and not str(name).endswith(("_bnds", "_bounds"))
    }  # fmt: skip


def _chosen(dataset: Any, requested: str | None, source: str) -> str:
    images = _images(dataset)
    if requested is not None and requested in dataset.variables and dataset[requested].ndim >= 2:
        return requested
    return choose(images, requested or default_image(images), source)


def of_dataset(dataset: Any, source: str, how: ArrayReading, *, netcdf: bool = False) -> Recording:
    """Return the image variable of an :class:`xarray.Dataset`: the chosen one, the default (counts before radiance), or the only
    one; read when needed.
    """
    name = _chosen(dataset, how.variable, source)
    chosen = dataset[name]
    attributes = dict(chosen.attrs)
    notes: tuple[str, ...] = ()
    if is_decoded(chosen):
        decoding = range_of_decoded(chosen, f"{source}:{name}")
    else:
        decoding, notes = of_attributes(attributes, chosen.dtype, f"{source}:{name}")
    units = None if notes else text_of(attributes.get("units"))
    if netcdf:
        decoding = with_default_fill(decoding, attributes, chosen.dtype)
    full = attributes.get("saturation_counts")
    rate, rate_notes = _rate(dataset, chosen)
    if netcdf:
        notes = (*notes, *unwritten_numbers(_Lazy(chosen), attributes))
    facts = ArrayFacts(
        rate,
        units,
        tuple(map(str, chosen.dims)),
        decoding,
        None if full is None else float(full),
        channels=_channel_names(dataset, chosen),
        notes=(*notes, *rate_notes),
        blur_px=stored_blur(dataset, name),
    )
    return of_array(_Lazy(chosen), f"{source}:{name}", how, facts)


def is_decoded(variable: Any) -> bool:
    """Return true for a variable to which xarray has applied scale, offset or fill value."""
    return any(name in variable.encoding for name in ("scale_factor", "add_offset", "_FillValue", "missing_value"))


def range_of_decoded(variable: Any, source: str) -> Decoding:
    """Return the valid range of a variable that xarray has decoded, which does not apply it: its attributes are of the packed numbers."""
    packing = {name: variable.encoding[name] for name in ("scale_factor", "add_offset") if name in variable.encoding}
    stored = np.dtype(variable.encoding.get("dtype", variable.dtype))
    ends = {name: value for name, value in variable.attrs.items() if name in ("valid_min", "valid_max", "valid_range")}
    packed, _ = of_attributes({**packing, **ends}, stored, source)
    low, high = (None if end is None else packed.offset + packed.scale * end for end in (packed.low, packed.high))
    if packed.scale < 0.0:
        low, high = high, low
    # A number at the end of the range is rounded when it is unpacked.
    step = 1e-6 * abs(packed.scale) if packing else 0.0
    return Decoding(low=None if low is None else low - step, high=None if high is None else high + step)


def _channel_names(dataset: Any, images: Any) -> tuple[str, ...]:
    """Return the names that a coordinate gives to the channels of images."""
    along = next((name for name in images.dims if letter_of(str(name)) == "c"), None)
    if along is None or along not in dataset.variables or dataset[along].dims != (along,) or dataset[along].size > MOST_NAMED:
        return ()
    return tuple(f"{value:g}" if isinstance(value, float) else str(value) for value in dataset[along].to_numpy().tolist())


#: Variables of our files that a sensor made; the others are its aperture's radiance averaged over pixels, and what follows from it.
_OF_SENSOR: Final = ("signal", "electrons")


def stored_blur(dataset: Any, name: str) -> float | None:
    """Return the blur of images that seaglint made [px], 0 without a sensor; None for all others."""
    stated = dataset[name].attrs.get("sensor_blur_px")
    if stated is None and name in _OF_SENSOR:
        stated = dataset.attrs.get("sensor_blur_px")
    if stated is not None:
        return float(stated)
    # Of all our files those of a rendered scene state its air; a texture has the blur of what it was made from.
    return 0.0 if name not in _OF_SENSOR and "atmosphere_table" in dataset.attrs else None


class _Lazy:
    """Labelled variable that is read by slices."""

    def __init__(self, variable: Any) -> None:
        self._variable, self.shape, self.dtype = variable.variable, variable.shape, variable.dtype

    def __getitem__(self, key: Any) -> NDArray[Any]:
        return np.asarray(self._variable[key].to_numpy())


def stored_frame_rate(dataset: Any, images: Any) -> float | None:
    """Return the frames per second [Hz] of images in a dataset.

    That of the time coordinate where this is even and the attributes say something else: a selection of every other frame keeps the
    attributes.
    """
    return _rate(dataset, images)[0]


def _rate(dataset: Any, images: Any) -> tuple[float | None, tuple[str, ...]]:
    """Return the frame rate [Hz] of images, and a note where it is not that of the attributes, or where times give none.

    Times are a coordinate along the images' own dimension: a file may have others, of its weather.
    """
    stated = frame_rate_of(dict(images.attrs)) or frame_rate_of(dataset.attrs)
    along = next((str(name) for name in images.dims if letter_of(str(name)) == "t"), None)
    names = [along, "time", "t"] if along is not None else []
    name = next((n for n in names if n in dataset.variables and dataset[n].dims == (along,)), None)
    if name is None:
        return stated, ()
    times = dataset[name]
    rate, why = rate_of_times(times.to_numpy(), times.attrs)
    if rate is None:
        return stated, () if stated is not None or why is None else (why,)
    if stated is not None and abs(rate / stated - 1.0) > SAME:
        return rate, (f"the frame rate is {rate:.6g} Hz by the times; the attribute says {stated:.6g} Hz",)
    return rate if stated is None else stated, ()
