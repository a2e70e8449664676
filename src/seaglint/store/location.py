"""Location of a sequence, a folder or an object store behind a URL, and creation of its arrays before the first frame.

A folder is written under another name and renamed when whole, and locks claim it for its writers. An object store has neither: its
sequence has its final name from the start, an attribute marks it as unfinished until the end, and its writers are not checked.

The content of a frame is cut into shards of the same frames, and a shard is a file: two processes that write into one file lose each
other's entries without an error, so each shard is written by one process. Within a shard every frame is a chunk that is read alone.
"""

from __future__ import annotations

import glob
import shutil
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from datetime import UTC
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import BackendError, DataError, StorageError
from seaglint.base.free_form import Attributes
from seaglint.base.machine import processor
from seaglint.base.optional import missing
from seaglint.base.schema import VARIABLES
from seaglint.store.layout import FORMAT, GROUP, UNFINISHED, Layout
from seaglint.store.outputs import ELSEWHERE, library_errors, refuse_inputs, require_folder, storage_errors
from seaglint.store.shards import CHECKSUM, DONE, OVER
from seaglint.store.staging import remove_stages, staged, token
from seaglint.store.writers import Claim, Share, exclusive, shared

if TYPE_CHECKING:
    from seaglint.store.staged_store import StagedStore

WHOLE: Final = "whole"  #: Name of the claim on a sequence alone, in the names of stages.


def make_arrays(store: Any, layout: Layout) -> None:
    """Make a store with coordinates and empty images; its attributes are written last and mark it as complete.

    ``store`` is a store of Zarr, or its location.
    """
    import zarr

    frames, rows, columns = layout.shape
    unit = layout.frames_per_unit

    def shards(itemsize: int, size: tuple[int, ...]) -> dict[str, Any]:
        return {"chunks": (1, *size), "compressors": _compressor(itemsize), **({"shards": (unit, *size)} if unit > 1 else {})}

    begun: Attributes = {"seaglint_format": FORMAT, UNFINISHED: {"made": False}}
    group: Any = zarr.open_group(store, mode="w-", zarr_format=3, attributes=begun)
    directions = () if layout.turning else ("azimuth", "elevation")
    dated = () if layout.start is None else ("utc",)
    coordinates = " ".join((*directions, "frame", *dated, *(() if layout.band is None else ("wavelength",)), *layout.poses))
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
    # The checksum of a frame covers these arrays, in this order.
    truths = tuple(f"{GROUP}/{name}" for name in layout.truth.arrays) if layout.truth is not None else ()
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


PATIENCE: Final = 60.0  #: How long a share waits for another one that is making the empty store [s].


def partial_path(output: Path) -> Path:
    """Return the folder of an unfinished sequence."""
    return output.with_name(output.name + ".partial")


def attributes(store: Path | str) -> Attributes:
    """Return the attributes of a store; empty where they cannot be read."""
    import zarr

    try:
        return dict(zarr.open_group(store, mode="r", zarr_format=3).attrs)
    except Exception:  # whatever is wrong with it, it is no sequence of ours
        return {}


@dataclass(frozen=True)
class Local:
    """Sequence in a folder on a local or shared disk."""

    output: Path

    def __str__(self) -> str:
        return str(self.output)

    @property
    def name(self) -> str:
        """Return the name of the location for other processes."""
        return str(self.output.absolute())

    @property
    def work(self) -> Path:
        """Return the location of the unfinished sequence."""
        return partial_path(self.output)

    @property
    def errors(self) -> Path:
        """Return the folder of tracebacks."""
        return self.work.with_name(self.work.name + ".errors")

    def check(self, inputs: Iterable[str | Path] = ()) -> None:
        """Refuse locations that can never be written."""
        with storage_errors(self.output, ELSEWHERE):
            refuse_inputs(self.output, inputs)
            require_folder(self.output)

    def taken(self) -> bool:
        """Return true where the final name exists."""
        return self.output.exists()

    def begun(self) -> bool:
        """Return true where the name of the unfinished sequence exists."""
        return self.work.exists()

    def resumable(self) -> bool:
        """Return true where the finished part can be resumed."""
        return (self.work / "zarr.json").exists()

    def require_there(self) -> None:
        """Require that the folder still exists; frames written into a moved one would make an unreadable store in its place."""
        if not (self.work / "zarr.json").exists():
            raise DataError(f"{self.work}: was moved or removed during writing; put it back and go on with resume=True, or begin anew")

    @contextmanager
    def claim(self, share: Share | None = None) -> Iterator[Claim]:
        """Claim the unfinished sequence alone; a share claims it together with other shares."""
        if share is None:
            with exclusive(self.work) as claim:
                yield claim
        else:
            part = self.work.with_name(f"{self.work.name}.share-{share.index}-of-{share.count}")
            with shared(self.work), exclusive(part) as claim:
                yield claim

    @property
    def stages(self) -> Path:
        """Return the folder of the stages, in which units are written before they are moved into the unfinished sequence."""
        return self.work.with_name(self.work.name + ".units")

    def stage(self, claim: Claim) -> Path:
        """Return the stage of a claim."""
        return self.stages / f"{self._claimed(claim)}-{claim.token}"

    def _claimed(self, claim: Claim) -> str:
        return claim.folder.name.removeprefix(self.work.name).removeprefix(".") or WHOLE

    def staging(self, claim: Claim) -> AbstractContextManager[Path]:
        """Provide the stage of a claim for the duration of the context."""
        return staged(self.stages, self.stage(claim).name)

    def remove_stages(self, claim: Claim) -> None:
        """Remove the stages of earlier owners: of the same share, or all where the sequence is claimed alone."""
        part = self._claimed(claim)
        remove_stages(self.stages, "" if part == WHOLE else f"{part}-", self.stage(claim).name)

    def store(self, stage: Path) -> StagedStore:
        """Return the Zarr store of the unfinished sequence, which is written through a stage."""
        from seaglint.store.staged_store import StagedStore

        return StagedStore(self.work, stage)

    @contextmanager
    def settling(self) -> Iterator[None]:
        """Claim the sequence alone among shares, while the empty store is made or its attributes change."""
        with exclusive(self.work.with_name(self.work.name + ".new"), PATIENCE):
            yield

    def create(self, layout: Layout, stage: Path, *, replace: bool = True) -> None:
        """Make the empty store, replacing an existing one."""
        from seaglint.store.staged_store import StagedStore

        with suppress(FileNotFoundError):
            self.work.rename(stage / token())
        # Metadata that stands is complete: the group is made in the stage, so that an interrupted start leaves no half.
        fresh = stage / token()
        fresh.mkdir()
        make_arrays(StagedStore(fresh, stage), layout)
        fresh.rename(self.work)

    def keep_traceback(self, name: str, text: str) -> None:
        """Write a traceback beside the sequence."""
        self.errors.mkdir(exist_ok=True)
        (self.errors / name).write_text(text, encoding="utf-8")

    def sweep(self) -> None:
        """Remove tracebacks and what killed processes left: half-written chunks beside their place, and locks of shares."""
        for path in filter(Path.is_file, self.work.rglob("*.partial")):
            path.unlink()
        for path in self.work.parent.glob(f"{glob.escape(self.work.name)}.share-*-of-*.lock"):
            with suppress(OSError):
                path.unlink()
        shutil.rmtree(self.errors, ignore_errors=True)

    def give_name(self) -> None:
        """Move the complete sequence to its final name; the old one is deleted last."""
        # The old sequence exists until the new one has its name: an interruption loses neither.
        old = self.output.with_name(self.output.name + ".old")
        if self.output.exists():
            if old.exists():
                shutil.rmtree(old)
            self.output.rename(old)
        self.work.rename(self.output)
        if old.exists():
            shutil.rmtree(old)

    @property
    def bytes(self) -> int:
        """Return the size of all files."""
        return sum(file.stat().st_size for file in self.output.rglob("*") if file.is_file())


@dataclass(frozen=True)
class Remote:
    """Sequence in a store behind a URL that fsspec opens."""

    output: str

    def __str__(self) -> str:
        return self.output

    @property
    def name(self) -> str:
        """Return the name of the location for other processes."""
        return self.output

    @property
    def work(self) -> str:
        """Return the location of the unfinished sequence."""
        return self.output

    @property
    def errors(self) -> str:
        """Return the location of tracebacks."""
        return f"{self.output}.errors"

    @property
    def _files(self) -> Any:
        import fsspec

        files: Any = fsspec.url_to_fs(self.output)[0]
        files.invalidate_cache()  # others write there too
        return files

    def check(self, inputs: Iterable[str | Path] = ()) -> None:
        """Refuse locations that cannot be reached."""
        with _reached(self.output):
            self._files.exists(self.output)

    def taken(self) -> bool:
        """Return true where something other than an unfinished sequence exists."""
        with _reached(self.output):
            return bool(self._files.exists(self.output)) and not self.begun()

    def begun(self) -> bool:
        """Return true where an unfinished sequence exists."""
        return UNFINISHED in attributes(self.output)

    def resumable(self) -> bool:
        """Return true where the finished part can be resumed."""
        return self.begun()

    def require_there(self) -> None:
        """Do nothing: objects in a store are not moved, and a check costs a request."""

    @contextmanager
    def claim(self, share: Share | None = None) -> Iterator[_Unwatched]:
        """Return a context without a claim, since object stores have no locks."""
        yield _Unwatched()

    def settling(self) -> Any:
        """Return a context without a claim, since object stores have no locks."""
        return nullcontext()

    def staging(self, claim: Any) -> AbstractContextManager[None]:
        """Return a context without a stage, since object stores cannot rename."""
        return nullcontext()

    def remove_stages(self, claim: Any) -> None:
        """Do nothing, since there are no stages."""

    def store(self, stage: None) -> str:
        """Return the location for Zarr."""
        return self.output

    def create(self, layout: Layout, stage: None, *, replace: bool = True) -> None:
        """Make the empty store; ``replace`` an existing one."""
        with _reached(self.output):
            if replace and self._files.exists(self.output):
                self._files.rm(self.output, recursive=True)
                type(self._files).clear_instance_cache()  # Zarr's own client remembers what was there
            make_arrays(self.output, layout)

    def keep_traceback(self, name: str, text: str) -> None:
        """Write a traceback beside the sequence."""
        self._files.pipe_file(f"{self.errors}/{name}", text.encode())

    def sweep(self) -> None:
        """Remove tracebacks; objects are complete or absent."""
        if self._files.exists(self.errors):
            self._files.rm(self.errors, recursive=True)

    def give_name(self) -> None:
        """Do nothing: the sequence has its final name already."""

    @property
    def bytes(self) -> int:
        """Return the size of all objects."""
        return int(self._files.du(self.output))


@dataclass(frozen=True)
class _Unwatched:
    """Substitute for a claim where there are no locks."""

    folder: None = None
    token: str = ""

    def require(self) -> None:
        """Do nothing, since there is no claim."""


Place = Local | Remote


def place_of(output: str | Path) -> Place:
    """Return the location of an output: a URL with ``://`` is remote, unless it is one of files.

    Raises
    ------
    DataError
        A URL of a kind that fsspec does not know.
    BackendError
        One whose package is not installed.
    """
    # A path is always local; a text may be a URL.
    text = str(output)
    if isinstance(output, Path) or "://" not in text:
        return Local(Path(output))
    protocol = text.split("://", 1)[0]
    if protocol in ("file", "local"):
        return Local(Path(text.split("://", 1)[1]))
    try:
        import fsspec

        fsspec.get_filesystem_class(protocol)
    except ImportError as error:
        what = f"{text}: {protocol}://"
        if protocol in ("s3", "s3a"):
            raise missing(what, "s3fs") from error
        if error.name == "fsspec":
            raise BackendError(f"{what} needs fsspec, which is not installed; pip install fsspec") from error
        raise BackendError(f"{what} needs a package that is not installed; install the package that fsspec names: {error}") from error
    except ValueError as error:
        raise DataError(
            f"{text}: {protocol}:// is no kind of place that is known; give a folder, or a URL like s3://bucket/run.zarr"
        ) from error
    return Remote(text.rstrip("/"))


def _reached(url: str) -> AbstractContextManager[None]:
    """Return a context that reports exceptions of clients of object stores in one line."""
    return library_errors(f"{url}: cannot be reached", "check address, name and rights", StorageError)


def is_ours(store: Path | str) -> bool:
    """Return true where a store is a sequence of seaglint."""
    return attributes(store).get("seaglint_format") == FORMAT
