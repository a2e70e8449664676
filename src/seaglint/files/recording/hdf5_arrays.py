"""Reader of HDF5, MATLAB's files of all versions among it.

MATLAB stores the first axis of an array as the fastest one. Its version 7.3 is HDF5, whose last axis is the fastest: the axes there are
reversed, and the attribute ``MATLAB_class`` says so. Arrays that MATLAB's ``h5write`` writes are reversed too, and nothing says so.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes
from seaglint.files.recording.arrays import ArrayFacts, ArrayReading, choose, of_array, text_of
from seaglint.files.recording.axes import letter_of
from seaglint.files.recording.decoding import DEFAULT_FILLS, Decoding, of_attributes
from seaglint.files.recording.frame_times import RATE_NAMES, frame_rate_of, rate_of_times

#: Classes of MATLAB arrays that are numbers.
_MATLAB_NUMBERS: Final = (
    *("double", "single", "logical", "int8", "uint8", "int16", "uint16"),
    *("int32", "uint32", "int64", "uint64"),
)

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
    # Categories and palettes are no images; they are read where nothing else is there, or by name.
    likely = {name: item for name, item in datasets.items() if not _is_beside(item, file)}
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
    facts = ArrayFacts(rate, units, _names(array, attributes), decoding, notes=(*notes, *rate_notes, *picture_notes, *_unwritten(array)))
    if matlab is not None:
        return of_array(_Reversed(array), source, how, replace(facts, names=(), order="yxt"))
    return _turned(of_array(array, source, how, facts), text_of(attributes.get("DISPLAY_ORIGIN")), source)


def _is_array(item: Any) -> bool:
    matlab = text_of(item.attrs.get("MATLAB_class"))
    return (matlab is None or matlab in _MATLAB_NUMBERS) and "MATLAB_empty" not in item.attrs and "MATLAB_sparse" not in item.attrs


def _is_beside(item: Any, file: Any) -> bool:
    """Return true for what stands beside images: palettes, scales of dimensions, flags, sparse arrays."""
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
    """Refuse a scale or offset of the file or group that differs from that of the array; note one that stands there alone."""
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
    """Return the names of a dataset's dimensions: those of a colour picture, its labels, or those of its scales."""
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
    """Return a decoding that masks the NetCDF library's fill value of a type, where the file states none of its own."""
    if "_FillValue" in attributes or "missing_value" in attributes:
        return decoding
    kind = dtype if decoding.unsigned is None else decoding.unsigned
    # Unwritten floats hold 1e37, which no picture has. Fill values of integers may be data: they count as numbers, with a note.
    fill = DEFAULT_FILLS.get(f"{kind.kind}{kind.itemsize}") if kind.kind == "f" else None
    return decoding if fill is None else replace(decoding, missing=(*decoding.missing, float(kind.type(fill))))


def unwritten_numbers(array: Any, attributes: Attributes) -> tuple[str, ...]:
    """Return a note where NetCDF's fill value of an integer type stands among the numbers, with nothing said of missing ones.

    The first, middle and last frames are looked at. Full scale of unsigned numbers, which is their fill value, is reported as saturated.
    """
    dtype = np.dtype(array.dtype)
    fill = DEFAULT_FILLS.get(f"{dtype.kind}{dtype.itemsize}")
    if dtype.kind != "i" or fill is None or "_FillValue" in attributes or "missing_value" in attributes:
        return ()
    frames = sorted({0, array.shape[0] // 2, array.shape[0] - 1}) if len(array.shape) > 2 else [slice(None)]
    if not any(bool(np.any(np.asarray(array[i]) == fill)) for i in frames):
        return ()
    return (f"{fill} occurs, which NetCDF writes where nothing was written, and counts as a number; --missing {fill} masks it",)


def _picture(attributes: Attributes, decoding: Decoding, dtype: np.dtype[Any], source: str) -> tuple[Decoding, tuple[str, ...]]:
    """Honour the attributes of an HDF5 image (HDF5 image and palette specification, version 1.2)."""
    if text_of(attributes.get("CLASS")) != "IMAGE":
        return decoding, ()
    kind = text_of(attributes.get("IMAGE_SUBCLASS"))
    if kind == "IMAGE_INDEXED":
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

    try:
        sizes = {name: (tuple(shape), kind) for name, shape, kind in whosmat(str(path))}
        images = {
            name: shape
            for name, (shape, kind) in sizes.items()
            if kind in _MATLAB_NUMBERS and sum(size > 1 for size in shape) >= 2 and min(shape) > 0
        }
        if not images:
            held = ", ".join(f"{name} ({kind})" for name, (_, kind) in sizes.items()) or "nothing"
            remedy = "save the array itself, in MATLAB: x = s.frames; save('x.mat', 'x', '-v7.3')"
            raise DataError(f"{path}: holds no array of numbers with rows and columns, but {held}; {remedy}")
        name = choose(images, how.variable, path)
        rates = [key for key in RATE_NAMES if sizes.get(key, ((), ""))[0] == (1, 1)]
        arrays: Any = loadmat(str(path), variable_names=[name, *rates])
        if name not in arrays:
            raise DataError(f"{path}: {name} cannot be read; save it with -v7.3")
    except DataError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise DataError(f"{path}: cannot be read as a MATLAB file ({reason}); save it with -v7.3, and the array as numbers") from error
    rate = frame_rate_of({key: arrays[key] for key in rates})
    return of_array(arrays[name], f"{path}:{name}", how, ArrayFacts(rate, order="yxt"))
