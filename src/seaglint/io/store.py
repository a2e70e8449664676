"""Image sequences on disk: a Zarr 3 store with one chunk per frame, whole or plainly unfinished.

Frames go to ``NAME.partial``; the folder gets its name when the last frame is in. A frame counts once ``frame_done`` says
so, which is written after its pixels: whatever interrupts the work, a frame is whole or absent. One process at a time writes there.
Missing pixels are NaN (with a fill of 0, Zarr would not write chunks that are all zero, and a black frame could not be told from
a missing one).
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from datetime import UTC
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.errors import DataError, SeaglintError
from seaglint.io.claim import Claim, exclusive
from seaglint.io.consolidated import consolidate
from seaglint.io.failures import storage_errors
from seaglint.io.layout import FORMAT, Layout
from seaglint.io.outputs import ELSEWHERE, refuse_inputs, require_folder
from seaglint.io.provenance import differences
from seaglint.io.stopping import stop_on_signal
from seaglint.io.truth import GROUP, TRUTHS
from seaglint.schema import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

Frame = Callable[[int], Mapping[str, NDArray[Any]]]
"""Images of one frame by variable (ny, nx), and its truth, given its number in the whole sequence."""

Progress = Callable[[int, int], None]
"""Called with (frames done, frames in all): once at the start and after each frame."""

_OTHER_KINDS: Final = frozenset({".nc", ".nc4", ".h5", ".hdf5", ".toml", ".csv", ".png", ".mp4", ".html", ".ply", ".npy", ".json"})
"""Endings that say another kind of file is meant."""


class Interrupted(SeaglintError):  # noqa: N818 (an answer to a request, not a mistake)
    """Stopped on request between two frames; what is done stays and can be resumed."""

    exit_code = 130


def partial_path(output: Path) -> Path:
    """Folder in which an unfinished sequence lies."""
    return output.with_name(output.name + ".partial")


def write_sequence(
    output: str | Path,
    layout: Layout,
    frame: Frame,
    *,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Compute the frames that are missing, one after the other, and give the store its name when it is whole.

    Parameters
    ----------
    output : path
        Folder to make, customarily ``*.zarr``.
    layout : Layout
        Coordinates, frames and provenance.
    frame : callable
        ``frame(number)`` returns the images (ny, nx) of a frame, one for each of the layout's variables.
    resume : bool
        Go on with ``output.partial``. A sequence that is whole already is left as it is; where nothing is there, all is computed.
    overwrite : bool
        Replace what stands at ``output``, once the new sequence is whole.
    progress : callable, optional
        ``progress(done, total)``.

    Returns
    -------
    Path
        ``output``.

    Raises
    ------
    DataError
        The output exists, was made from something else, or another process writes it.
    StorageError
        No room or no rights; the frames done stay.
    Interrupted
        After SIGINT or SIGTERM, when the frame at hand is in.
    """
    output = _checked_name(output, resume=resume, overwrite=overwrite)
    partial = partial_path(output)

    def remedy() -> str:
        if (partial / "zarr.json").exists():
            return f"what is done stays in {partial}: make room and run the same command with --resume"
        return "nothing was written; make room or choose another place"

    if not _stands(output, layout, resume=resume, overwrite=overwrite):
        with ExitStack() as held:
            with storage_errors(partial, remedy):
                claim = held.enter_context(exclusive(partial))
            # Another process may have finished between the first look and the claim.
            if not _stands(output, layout, resume=resume, overwrite=overwrite):
                _require_free(partial, resume=resume, overwrite=overwrite)
                _fill(partial, layout, frame, claim, remedy, resume=resume, progress=progress)
                with storage_errors(output, remedy):
                    _sweep(partial)
                    _require_whole(partial, claim)
                    consolidate(partial)
                    _give_name(partial, output)
                return output
    if progress is not None:
        progress(len(layout.frames), len(layout.frames))
    return output


def check_output(output: str | Path, *, resume: bool = False, overwrite: bool = False, inputs: Iterable[str | Path] = ()) -> Path:
    """Path of a sequence to be written, refused where that can be told without its layout: before anything is computed.

    Raises
    ------
    DataError
        A folder missing, an ending of another kind of file, one of the ``inputs``, something there that may not be replaced.
    StorageError
        Nothing can be written in the folder.
    """
    output = _checked_name(output, resume=resume, overwrite=overwrite)
    partial = partial_path(output)
    with storage_errors(output, ELSEWHERE):
        refuse_inputs(output, inputs)
        if output.exists() and not resume:
            _require_replaceable(output, overwrite=overwrite)
        elif partial.exists() and not output.exists():
            with exclusive(partial):  # who writes there now is told first
                _require_free(partial, resume=resume, overwrite=overwrite)
    return output


def _checked_name(output: str | Path, *, resume: bool, overwrite: bool) -> Path:
    """What can be told from the name and its folder."""
    output = Path(output)
    if resume and overwrite:
        raise DataError("--resume keeps what is there and --overwrite replaces it; give one of the two")
    if output.suffix.lower() in _OTHER_KINDS:
        raise DataError(
            f"{output}: a sequence is a Zarr store; give a name that ends in .zarr "
            f"(a mean map, {output.stem}.nc, is made by 'seaglint mean')"
        )
    with storage_errors(output, ELSEWHERE):
        require_folder(output)
    return output


def _fill(
    partial: Path, layout: Layout, frame: Frame, claim: Claim, remedy: Callable[[], str], *, resume: bool, progress: Progress | None
) -> None:
    """Compute and write the frames that are missing."""
    with storage_errors(partial, remedy):
        group = _open_partial(partial, layout) if resume and partial.exists() else _create_partial(partial, layout)
        done = np.asarray(group["frame_done"][:], dtype=bool)
    count, wanted = int(done.sum()), (*layout.variables, *layout.per_frame, *(TRUTHS if layout.truth is not None else ()))
    if progress is not None:
        progress(count, done.size)
    with stop_on_signal() as stopped:
        for index in np.flatnonzero(~done):
            if stopped:
                raise Interrupted(
                    f"stopped after {count} of {done.size} frames, kept in {partial}; go on with the same command and --resume"
                )
            images = frame(layout.frames[int(index)])
            with storage_errors(partial, remedy):
                claim.require()
                _require_there(partial)
                _write_frame(group, int(index), {name: images[name] for name in wanted})
            count += 1
            if progress is not None:
                progress(count, done.size)


def _stands(output: Path, layout: Layout, *, resume: bool, overwrite: bool) -> bool:
    """Refuse what may not be replaced; true when the whole sequence is there already."""
    if not output.exists():
        return False
    if resume:
        _require_same(output, layout)
        return True
    _require_replaceable(output, overwrite=overwrite)
    return False


def _require_replaceable(output: Path, *, overwrite: bool) -> None:
    if not overwrite:
        raise DataError(f"{output}: exists already; choose another name, or replace it with --overwrite")
    _require_ours(output)


def _sweep(partial: Path) -> None:
    """Remove chunks that a killed process left half-written: Zarr writes them beside their place."""
    for path in filter(Path.is_file, partial.rglob("*.partial")):
        path.unlink()


def _require_free(partial: Path, *, resume: bool, overwrite: bool) -> None:
    """Refuse to begin anew where an unfinished sequence lies."""
    if partial.exists() and not resume:
        if not overwrite:
            raise DataError(f"{partial}: an unfinished sequence is there; go on with --resume, or begin anew with --overwrite")
        _require_ours(partial)


def _require_there(partial: Path) -> None:
    """Without this, frames written into a folder that was moved away would make an unreadable one in its place."""
    if not (partial / "zarr.json").exists():
        raise DataError(f"{partial}: was moved or removed while it was written; put it back and go on with --resume, or begin anew")


def _require_whole(partial: Path, claim: Claim) -> None:
    """Nothing gets its final name unless it is still ours and has every frame on disk, whatever was counted on the way."""
    import zarr

    claim.require()
    _require_there(partial)
    group: Any = zarr.open_group(partial, mode="r", zarr_format=3)
    done = np.asarray(group["frame_done"][:], dtype=bool)
    if not done.all():
        missing = f"{int((~done).sum())} of {done.size} frames are missing"
        raise DataError(f"{partial}: {missing} though all were written; see that no other program works there and go on with --resume")


def _require_ours(path: Path) -> None:
    """Nothing is deleted that seaglint did not write: a mistyped name must not cost a folder."""
    if _attributes(path).get("seaglint_format") != FORMAT:
        raise DataError(f"{path}: is not a seaglint sequence and is left alone; choose another name or remove it yourself")


def _attributes(path: Path) -> dict[str, Any]:
    import zarr

    try:
        return dict(zarr.open_group(path, mode="r", zarr_format=3).attrs)
    except Exception:  # whatever is wrong with it, it is no sequence of ours
        return {}


def _require_same(path: Path, layout: Layout) -> None:
    found = _attributes(path)
    if found.get("seaglint_format") != FORMAT:
        raise DataError(f"{path}: is not a readable seaglint sequence; choose another name or remove it yourself")
    import zarr

    group: Any = zarr.open_group(path, mode="r", zarr_format=3)
    differ = differences(found, layout.all_attributes)
    if [int(number) for number in group["frame"][:]] != list(layout.frames):
        differ.append("frames")
    if differ:
        raise DataError(f"{path}: was made with another {', '.join(differ)}; resume with the same settings, or begin anew with --overwrite")


def _open_partial(partial: Path, layout: Layout) -> Any:
    import zarr

    _require_same(partial, layout)
    return zarr.open_group(partial, mode="r+", zarr_format=3)


def _create_partial(partial: Path, layout: Layout) -> Any:
    import zarr

    if partial.exists():
        shutil.rmtree(partial)
    # Metadata that stands is complete: the group is made under another name first, so that an interrupted start leaves no half.
    fresh = partial.with_name(partial.name + ".new")
    if fresh.exists():
        shutil.rmtree(fresh)
    try:
        _make_arrays(fresh, layout)
        fresh.rename(partial)
    except BaseException:
        shutil.rmtree(fresh, ignore_errors=True)
        raise
    return zarr.open_group(partial, mode="r+", zarr_format=3)


def _make_arrays(fresh: Path, layout: Layout) -> None:
    import zarr

    frames, rows, columns = layout.shape
    group: Any = zarr.open_group(fresh, mode="w-", zarr_format=3, attributes=layout.all_attributes)
    directions = () if layout.turning else ("azimuth", "elevation")
    dated = () if layout.start is None else ("utc",)
    banded = () if layout.band is None else ("wavelength",)
    coordinates = " ".join((*directions, "frame", *dated, *banded, *layout.poses))
    for name in layout.variables:
        dtype = np.dtype(VARIABLES[name].dtype)
        group.create_array(
            name,
            shape=(frames, rows, columns),
            chunks=(1, rows, columns),
            dtype=dtype,
            fill_value=np.nan if dtype.kind == "f" else 0,
            compressors=_compressor(dtype.itemsize),
            dimension_names=("time", "y", "x"),
            attributes={**VARIABLES[name].attributes, **layout.details.get(name, {}), "coordinates": coordinates},
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
    # One chunk per frame here too: two processes that write into one chunk lose each other's entries without a word.
    for name, kind, fill in (("frame_done", "uint8", 0), *((name, "float32", np.nan) for name in layout.per_frame)):
        about = VARIABLES[name].attributes
        group.create_array(name, shape=(frames,), chunks=(1,), dtype=kind, fill_value=fill, dimension_names=("time",), attributes=about)
    if layout.truth is not None:
        layout.truth.make(group, layout.shape, _compressor)


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


def _write_frame(group: Any, index: int, images: Mapping[str, NDArray[Any]]) -> None:
    for name, image in images.items():
        if name in TRUTHS and GROUP in group:
            group[GROUP][name][index] = image
        if name in group:  # object_id is truth, and a layer where one asks for it
            group[name][index] = np.asarray(image, dtype=VARIABLES[name].dtype)
    group["frame_done"][index] = 1


def _give_name(partial: Path, output: Path) -> None:
    """Put the whole sequence in the place of the old one, which is deleted last."""
    old = output.with_name(output.name + ".old")
    if output.exists():
        if old.exists():
            shutil.rmtree(old)
        output.rename(old)
    partial.rename(output)
    if old.exists():
        shutil.rmtree(old)


def is_sequence(path: Path) -> bool:
    """Whether a folder was written by :func:`write_sequence`, finished or not."""
    return _attributes(path).get("seaglint_format") == FORMAT


def open_sequence(path: str | Path, *, allow_partial: bool = False) -> xr.Dataset:
    """Open a sequence lazily as an :class:`xarray.Dataset`.

    Raises
    ------
    DataError
        Nothing is there, it is no sequence, it is unfinished (unless ``allow_partial``), or a frame has gone missing.
    """
    path = Path(path)
    if not path.exists():
        partial = partial_path(path)
        hint = f"; {partial} is there, unfinished: render again with --resume" if partial.exists() else ""
        raise DataError(f"{path}: no such sequence{hint}")
    if _attributes(path).get("seaglint_format") != FORMAT:
        raise DataError(f"{path}: is not a seaglint sequence, or its zarr.json is cut; give a folder made by 'seaglint render'")
    import xarray as xr

    try:
        dataset = xr.open_dataset(str(path), engine="zarr", consolidated=False, chunks=None, decode_times=False)
        done = dataset["frame_done"].to_numpy().astype(bool)
    except Exception as error:
        raise DataError(f"{path}: the sequence is damaged ({error}); render it again") from error
    if not allow_partial and not done.all():
        missing = f"{int((~done).sum())} of {done.size} frames are missing"
        raise DataError(f"{path}: is unfinished, {missing}; render again with --resume")
    return dataset
