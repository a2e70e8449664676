"""Readers of files of named arrays, of seaglint or of other programs: HDF5, MATLAB of all versions, NetCDF and Zarr.

MATLAB stores the first axis of an array as the fastest one. Its version 7.3 is HDF5, whose last axis is the fastest: the axes there are
reversed, as the attribute ``MATLAB_class`` shows. Arrays that MATLAB's ``h5write`` writes are reversed too, without any attribute.

Attributes of our own files, band and directions of the pixels, are read into a ``Source``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes
from seaglint.base.schema import default_image
from seaglint.formats.recording.arrays import ArrayFacts, ArrayReading, choose, of_array, text_of
from seaglint.formats.recording.frame_axes import RATE_NAMES, SAME, frame_rate_of, letter_of, rate_of_times
from seaglint.formats.recording.stored_values import DEFAULT_FILLS, Decoding, in_type, of_attributes
from seaglint.optics.band import Band
from seaglint.store.netcdf import drop_quietly, open_netcdf
from seaglint.store.outputs import library_errors, reason_of
from seaglint.store.provenance import stored_band

if TYPE_CHECKING:
    import xarray as xr


#: Classes of MATLAB arrays that are numbers.
_MATLAB_NUMBERS: Final = (*("double", "single", "logical", "int8", "uint8", "int16", "uint16"), *("int32", "uint32", "int64", "uint64"))

#: Axes that are turned by the corner where a picture begins (HDF5 image specification 1.2, DISPLAY_ORIGIN).
_FLIPS: Final[dict[str, tuple[str, ...]]] = {"UL": (), "LL": ("y",), "UR": ("x",), "LR": ("y", "x")}


def open_hdf5(path: Path, how: ArrayReading, *, netcdf: bool = False) -> Recording:
    """Open a dataset of an HDF5 file: its only one that can be images, or ``variable``.

    Parameters
    ----------
    path : Path
        The file.
    how : ArrayReading
        What the user states.
    netcdf : bool
        True for a NetCDF 4 file, whose numbers have default fill values.
    """
    import h5py

    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise DataError(f"{path}: cannot be read as HDF5 ({error})") from error
    datasets: dict[str, Any] = {}
    scalars: Attributes = {}

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#refs#") or item.shape is None:
            return
        if item.size == 1 and name in RATE_NAMES and item.dtype.kind in "uif":
            scalars[name] = item[()]
        if item.ndim >= 2 and item.size > 1 and item.dtype.kind in "uifb" and _is_array(item):
            datasets[name] = item

    file.visititems(visit)
    # Categories and palettes are no images; they are read in a file without other arrays, or by name.
    likely = {name: item for name, item in datasets.items() if not _is_auxiliary(item, file)}
    name = choose(datasets if how.variable is not None or not likely else likely, how.variable, path)
    array, source = datasets[name], f"{path}:{name}"
    attributes = dict(array.attrs)
    rate = frame_rate_of(attributes) or frame_rate_of(dict(file.attrs)) or frame_rate_of(scalars)
    rate_notes: tuple[str, ...] = ()
    if rate is None:
        rate, rate_notes = _rate_of_scale(array)
    matlab = text_of(attributes.get("MATLAB_class"))
    decoding, notes = of_attributes(attributes, array.dtype, source)
    units = None if notes else text_of(attributes.get("units", attributes.get("unit")))
    if netcdf:
        decoding = with_default_fill(decoding, attributes, array.dtype)
        notes = (*notes, *unwritten_numbers(array, attributes))
    decoding, picture_notes = _picture(attributes, decoding, array.dtype, source)
    picture_notes = (*picture_notes, *_scale_elsewhere(array, file, attributes, source))
    notes = (*notes, *rate_notes, *picture_notes, *_unwritten(array))
    facts = ArrayFacts(_names(array, attributes), frame_rate=rate, units=units, decoding=decoding, notes=notes)
    if matlab is not None:
        return of_array(_Reversed(array), source, how, replace(facts, names=(), order="yxt"))
    return _turned(of_array(array, source, how, facts), text_of(attributes.get("DISPLAY_ORIGIN")), source)


def _is_array(item: Any) -> bool:
    matlab = text_of(item.attrs.get("MATLAB_class"))
    return (matlab is None or matlab in _MATLAB_NUMBERS) and "MATLAB_empty" not in item.attrs and "MATLAB_sparse" not in item.attrs


def _is_auxiliary(item: Any, file: Any) -> bool:
    """Return true for arrays that are no images: palettes, scales of dimensions, flags, sparse arrays."""
    kind = text_of(item.attrs.get("CLASS"))
    parent = file[item.name.rpartition("/")[0] or "/"]
    return kind in ("PALETTE", "DIMENSION_SCALE") or "flag_meanings" in item.attrs or "MATLAB_sparse" in parent.attrs


def _rate_of_scale(array: Any) -> tuple[float | None, tuple[str, ...]]:
    """Return the frame rate [Hz] of the scale of the dimension of times, and a note where it gives none."""
    for size, dimension in zip(array.shape, array.dims, strict=True):
        for scale in dimension.values():
            if letter_of(str(scale.name)) == "t" and scale.shape == (size,):
                rate, why = rate_of_times(scale[...], dict(scale.attrs))
                return rate, () if why is None else (why,)
    return None, ()


def _scale_elsewhere(array: Any, file: Any, attributes: Attributes, source: str) -> tuple[str, ...]:
    """Refuse a scale or offset of the file or group that differs from the array's; note one that the array lacks."""
    notes = []
    for holder in dict.fromkeys(("/", array.parent.name)):
        for name in ("scale_factor", "add_offset"):
            theirs, ours = file[holder].attrs.get(name), attributes.get(name)
            if theirs is None:
                continue
            if ours is None:
                notes.append(f"{name} of {holder} is not applied: it is no attribute of the array")
            elif not np.array_equal(np.ravel(theirs), np.ravel(ours)):
                raise DataError(f"{source}: {name} stands in two places that contradict each other, the array and {holder}; leave one out")
    return tuple(notes)


def _names(array: Any, attributes: Attributes) -> tuple[str, ...]:
    """Return the names of a dataset's dimensions: of a colour picture, or from its labels or scales."""
    if text_of(attributes.get("IMAGE_SUBCLASS")) == "IMAGE_TRUECOLOR" and array.ndim == 3:
        return ("rgb", "y", "x") if text_of(attributes.get("INTERLACE_MODE")) == "INTERLACE_PLANE" else ("y", "x", "rgb")
    names = []
    for dimension in array.dims:
        label = dimension.label
        if not label and len(dimension):
            label = str(dimension[0].name).rpartition("/")[2]
        names.append(label)
    return tuple(names) if all(names) else ()


def with_default_fill(decoding: Decoding, attributes: Attributes, dtype: np.dtype[Any]) -> Decoding:
    """Return a decoding that masks the NetCDF library's fill value of a type, unless the file states one."""
    if _states_missing(attributes):
        return decoding
    kind = dtype if decoding.unsigned is None else decoding.unsigned
    # Unwritten floats hold about 1e37, which no picture has. Fill values of integers may be data: they count as numbers, with a note.
    fill = DEFAULT_FILLS.get(f"{kind.kind}{kind.itemsize}") if kind.kind == "f" else None
    return decoding if fill is None else replace(decoding, missing=(*decoding.missing, float(kind.type(fill))))


def unwritten_numbers(array: Any, attributes: Attributes) -> tuple[str, ...]:
    """Return a note where NetCDF's fill value of an integer type is among the numbers and no attribute states missing ones.

    Full scale of unsigned numbers, which is their fill value, is reported as saturated.
    """
    dtype = np.dtype(array.dtype)
    fill = DEFAULT_FILLS.get(f"{dtype.kind}{dtype.itemsize}")
    if dtype.kind != "i" or fill is None or _states_missing(attributes) or not _occurs(array, fill):
        return ()
    return (f"{fill} occurs, which NetCDF writes where nothing was written, and counts as a number; --missing {fill} masks it",)


def _states_missing(attributes: Attributes) -> bool:
    return "_FillValue" in attributes or "missing_value" in attributes


def _occurs(array: Any, number: Any) -> bool:
    """Return true where a number is in the first, middle or last frame, which are read in place of all."""
    frames = sorted({0, array.shape[0] // 2, array.shape[0] - 1}) if len(array.shape) > 2 else [slice(None)]
    return any(bool(np.any(np.asarray(array[i]) == number)) for i in frames)


def _picture(attributes: Attributes, decoding: Decoding, dtype: np.dtype[Any], source: str) -> tuple[Decoding, tuple[str, ...]]:
    """Honour the attributes of an HDF5 image (HDF5 image and palette specification, version 1.2)."""
    if text_of(attributes.get("CLASS")) != "IMAGE":
        return decoding, ()
    if text_of(attributes.get("IMAGE_SUBCLASS")) == "IMAGE_INDEXED":
        raise DataError(f"{source}: holds indices of a palette (IMAGE_INDEXED), which are no measure of radiance; give the grey original")
    if text_of(attributes.get("INTERLACE_MODE")) == "INTERLACE_LINE":
        raise DataError(f"{source}: has channels line by line (INTERLACE_LINE), which is not read; write them as INTERLACE_PIXEL")
    white_is_zero = attributes.get("IMAGE_WHITE_IS_ZERO")
    if white_is_zero is not None and bool(np.ravel(white_is_zero)[0]):
        if dtype.kind not in "ui":
            raise DataError(f"{source}: white is zero (IMAGE_WHITE_IS_ZERO) in {dtype}, whose white is not known; write black as zero")
        return replace(decoding, white=float(np.iinfo(dtype).max) if dtype.kind == "u" else -1.0), ()
    return decoding, ()


def _unwritten(array: Any) -> tuple[str, ...]:
    """Return a note on chunks that were never written: they hold the fill value of the dataset."""
    if array.chunks is None:
        unwritten = array.id.get_storage_size() == 0 and array.external is None and not array.is_virtual
        return (f"nothing was written: all values are the fill value {_plain(array.fillvalue)}",) if unwritten else ()
    whole = int(np.prod([-(-size // chunk) for size, chunk in zip(array.shape, array.chunks, strict=True)]))
    there = int(array.id.get_num_chunks())
    return (unwritten_note(whole - there, whole, array.fillvalue),) if there < whole else ()


def unwritten_note(absent: int, whole: int, fill: Any) -> str:
    """Return the note on chunks that are not there."""
    nan = isinstance(fill, float | np.floating) and bool(np.isnan(fill))
    what = "missing" if nan else f"the fill value {_plain(fill)}, and count as numbers"
    return f"{absent} of {whole} chunks are not there: their values are {what}"


def _plain(value: Any) -> str:
    return f"{value:.9g}" if isinstance(value, int | float | np.number) else str(value)


class _Reversed:
    """Array whose axes are in the opposite order."""

    def __init__(self, array: Any) -> None:
        self._array, self.dtype, self.shape = array, array.dtype, tuple(array.shape)[::-1]

    def __getitem__(self, key: tuple[Any, ...]) -> NDArray[Any]:
        return np.asarray(self._array[key[::-1]]).transpose()


def _turned(recording: Recording, origin: str | None, source: str) -> Recording:
    """Turn pictures whose first pixel is not the upper left one."""
    # The upper left corner needs no turn; an unknown corner must not count as it.
    if origin is None or not _FLIPS.get(origin, ("?",)):
        return recording
    if origin not in _FLIPS:
        raise DataError(f"{source}: DISPLAY_ORIGIN = '{origin}'; allowed are {', '.join(_FLIPS)}")
    axes = tuple({"y": 1, "x": 2}[letter] for letter in _FLIPS[origin])
    read = recording.read_block
    return replace(recording, read_block=lambda a, b: np.flip(read(a, b), axes)).with_notes(
        f"pictures begin at the {'lower' if 'L' in origin[0] else 'upper'} {'left' if origin[1] == 'L' else 'right'} corner and are turned"
    )


def open_matlab(path: Path, how: ArrayReading) -> Recording:
    """Open a MATLAB file: version 7.3 as HDF5, versions 4 to 7 by SciPy, as a whole.

    Raises
    ------
    DataError
        No array of numbers, or a damaged file.
    """
    with path.open("rb") as file:
        head = file.read(520)
    if head.startswith(b"\x89HDF") or head[512:516] == b"\x89HDF":
        return open_hdf5(path, how)
    from scipy.io import loadmat, whosmat

    with library_errors(f"{path}: cannot be read as a MATLAB file", "save it with -v7.3, and the array as numbers"):
        sizes = {name: (tuple(shape), kind) for name, shape, kind in whosmat(str(path))}
        images = {
            name: shape
            for name, (shape, kind) in sizes.items()
            if kind in _MATLAB_NUMBERS and sum(size > 1 for size in shape) >= 2 and min(shape) > 0
        }
        if not images:
            content = ", ".join(f"{name} ({kind})" for name, (_, kind) in sizes.items()) or "nothing"
            remedy = "save the array itself, in MATLAB: x = s.frames; save('x.mat', 'x', '-v7.3')"
            raise DataError(f"{path}: holds no array of numbers with rows and columns, but {content}; {remedy}")
        name = choose(images, how.variable, path)
        rates = [key for key in RATE_NAMES if sizes.get(key, ((), ""))[0] == (1, 1)]
        arrays: Any = loadmat(str(path), variable_names=[name, *rates])
        if name not in arrays:
            raise DataError(f"{path}: {name} cannot be read; save it with -v7.3")
    rate = frame_rate_of({key: arrays[key] for key in rates})
    return of_array(arrays[name], f"{path}:{name}", how, ArrayFacts(frame_rate=rate, order="yxt"))


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
        raise DataError(f"{path}: cannot be read as Zarr ({reason_of(error)})") from error
    if isinstance(node, zarr.Array):
        return _of_zarr_array(node, str(path), how)
    try:
        dataset = xr.open_dataset(str(path), engine="zarr", chunks=None, decode_times=False, consolidated=False, mask_and_scale=False)
        labelled = bool(_images(dataset)) if how.variable is None else how.variable in dataset.variables
    except Exception as error:
        drop_quietly(error)
        labelled = False
    members = node.members(max_depth=None)
    arrays = {str(name): member for name, member in members if isinstance(member, zarr.Array) and _can_be_images(member)}
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


def _can_be_images(array: Any) -> bool:
    return array.ndim >= 2 and array.size > 1 and np.dtype(array.dtype).kind in "uifb" and "flag_meanings" not in array.attrs


def _of_zarr_array(array: Any, source: str, how: ArrayReading) -> Recording:
    attributes = dict(array.attrs)
    decoding, notes = of_attributes(attributes, np.dtype(array.dtype), source)
    names = tuple(attributes.get("_ARRAY_DIMENSIONS") or getattr(array.metadata, "dimension_names", None) or ())
    facts = ArrayFacts(
        tuple(map(str, names)) if all(names) else (),
        frame_rate=frame_rate_of(attributes), units=None if notes else text_of(attributes.get("units")), decoding=decoding,
        notes=(*notes, *_fill_notes(array, how.missing)),
    )  # fmt: skip
    return of_array(array, source, replace(how, missing=(*how.missing, *_packed_fill(array))), facts)


def _packed_fill(array: Any) -> tuple[float, ...]:
    """Return the fill value of packed numbers of version 2 that no attribute calls missing: there xarray writes ``_FillValue`` so."""
    attributes, fill = dict(array.attrs), array.fill_value
    packed = array.metadata.zarr_format == 2 and ("scale_factor" in attributes or "add_offset" in attributes)
    return () if not packed or _states_missing(attributes) or fill is None or fill == 0 else (fill,)


def _fill_notes(array: Any, masked: tuple[float, ...]) -> tuple[str, ...]:
    """Return notes on the fill value: it fills absent chunks, and counts as a number in present ones.

    Version 3 has no reader that masks its usual fill value, 0.
    """
    notes = []
    attributes = dict(array.attrs)
    there, whole = int(array.nchunks_initialized), int(array.nchunks)
    fill = array.fill_value
    if there < whole:
        notes.append(unwritten_note(whole - there, whole, fill))
    if fill is None or _states_missing(attributes) or not in_type([fill], np.dtype(array.dtype)) or fill in masked:
        return tuple(notes)
    if array.metadata.zarr_format == 3 and fill == 0:
        return tuple(notes)
    if there == whole and _occurs(array, fill):
        notes.append(
            f"the store's fill value {float(fill):.9g} also occurs as data and counts as a number, as no attribute calls it missing; "
            f"--missing {float(fill):.9g} masks it"
        )
    return tuple(notes)


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
        tuple(map(str, chosen.dims)), _channel_names(dataset, chosen), blur_px=stored_blur(dataset, name),
        frame_rate=rate, units=units, decoding=decoding, saturation=None if full is None else float(full), notes=(*notes, *rate_notes),
    )  # fmt: skip
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


#: Variables of our files that a sensor made; the others are its aperture's radiance averaged over pixels, or derived from it.
_OF_SENSOR: Final = ("signal", "electrons")


def stored_blur(dataset: Any, name: str) -> float | None:
    """Return the blur of images that seaglint made [px], 0 without a sensor; None for all others."""
    stated = dataset[name].attrs.get("sensor_blur_px")
    if stated is None and name in _OF_SENSOR:
        stated = dataset.attrs.get("sensor_blur_px")
    if stated is not None:
        return float(stated)
    # Only files of a rendered scene state its air; the blur of a texture is the blur of its source.
    return 0.0 if name not in _OF_SENSOR and "atmosphere_table" in dataset.attrs else None


class _Lazy:
    """Labelled variable that is read by slices."""

    def __init__(self, variable: Any) -> None:
        self._variable, self.shape, self.dtype = variable.variable, variable.shape, variable.dtype

    def __getitem__(self, key: Any) -> NDArray[Any]:
        return np.asarray(self._variable[key].to_numpy())


def stored_frame_rate(dataset: Any, images: Any) -> float | None:
    """Return the frames per second [Hz] of images in a dataset.

    Where it is even, the time coordinate overrules the attributes: a selection of every other frame has the attributes of all frames.
    """
    return _rate(dataset, images)[0]


def _rate(dataset: Any, images: Any) -> tuple[float | None, tuple[str, ...]]:
    """Return the frame rate [Hz] of images, and a note where it differs from the attributes, or where times give no rate.

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


@dataclass(frozen=True)
class Source:
    """Attributes of a recording beside its pixel values."""

    band: Band | None = None
    step: tuple[float, float] | None = None  #: Angle between columns and between rows [rad].
    azimuth_deg: FloatArray | None = None
    elevation_deg: FloatArray | None = None
    frames: range | None = None  #: Numbers of the frames in the sequence that they belong to.

    @classmethod
    def of(cls, dataset: xr.Dataset) -> Source:
        """Return the attributes of a labelled dataset, where it has them."""
        try:
            band = stored_band(dataset.attrs)
        except (KeyError, TypeError, ValueError):
            band = None
        axes = [dataset[name].to_numpy().astype(np.float64) if name in dataset.variables else None for name in ("azimuth", "elevation")]
        azimuth, elevation = (a if a is not None and a.ndim == 1 and a.size > 1 else None for a in axes)
        if azimuth is None or elevation is None:
            return cls(band, frames=_numbers(dataset))
        step = tuple(float(np.radians(abs(a[-1] - a[0]) / (a.size - 1))) for a in (azimuth, elevation))
        return cls(band, (step[0], step[1]), azimuth, elevation, _numbers(dataset))


def _numbers(dataset: xr.Dataset) -> range | None:
    """Return the numbers of consecutive frames."""
    if "frame" not in dataset.variables:
        return None
    numbers = np.atleast_1d(dataset["frame"].to_numpy())
    if numbers.ndim != 1 or numbers.size == 0 or numbers.dtype.kind not in "iu" or np.any(np.diff(numbers) != 1) or numbers[0] < 0:
        return None
    return range(int(numbers[0]), int(numbers[-1]) + 1)


def _of_zarr(path: Path) -> Source | None:
    """Return the attributes of a Zarr store; None for one without names of dimensions, which has none of ours."""
    import xarray as xr

    try:
        dataset = xr.open_dataset(str(path), engine="zarr", chunks=None, decode_times=False, consolidated=False)
    except (KeyError, ValueError, FileNotFoundError):
        return None
    with dataset:
        return Source.of(dataset)


def source_of(path: Path) -> Source | None:
    """Return the attributes of a Zarr store or NetCDF file; None for other files.

    Raises
    ------
    DataError
        A file that cannot be read.
    """
    with library_errors(f"{path}: cannot be read", "is the file whole?"):
        if is_zarr(path):
            return _of_zarr(path)
        if path.suffix.lower() in (".nc", ".nc4"):
            with open_netcdf(path, decode_times=False) as dataset:
                return Source.of(dataset)
    return None
