"""Image sequences on disk: a Zarr 3 store, complete or marked as unfinished, written by one process or several.

Frames are written to ``NAME.partial``; the folder gets its name when the last frame is in. A frame counts once it is marked in
``frame_done``, which is written after its pixels: whatever interrupts the work, a frame is whole or absent. A shard of frames is a unit of
work that one process writes; a share is every n-th unit. Missing pixels are NaN (with a fill of 0, Zarr would not write chunks that are all
zero, and a black frame could not be distinguished from a missing one).
"""

from __future__ import annotations

import logging
import time
import warnings
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes
from seaglint.base.machine import processor
from seaglint.store.layout import FORMAT, UNFINISHED, Layout
from seaglint.store.location import PATIENCE, Place, attributes, is_ours, partial_path, place_of
from seaglint.store.missing_frames import Interrupted, MissingUnits, Spread, open_group
from seaglint.store.outputs import ELSEWHERE, FILE_ENDINGS, storage_errors
from seaglint.store.provenance import PROCESSORS_MIXED, differences
from seaglint.store.shards import CHECKSUM, DONE, Frame, Shards, forget_damaged, listed
from seaglint.store.writers import Share, shares_of
from seaglint.version import __version__

if TYPE_CHECKING:
    import xarray as xr


def consolidate(store: Any) -> None:
    """Copy the arrays' metadata into those of the store: ``xarray.open_zarr`` then reads one file and does not warn."""
    import zarr

    with warnings.catch_warnings():
        # Zarr 3 calls this an extension of its format; readers that do not know it pass it over.
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        zarr.consolidate_metadata(store, zarr_format=3)


__all__ = ["Frame", "Interrupted", "check_output", "finish_sequence", "is_sequence", "open_sequence", "partial_path", "write_sequence"]

log = logging.getLogger(__name__)


def write_sequence(
    output: str | Path,
    layout: Layout,
    frame: Frame,
    *,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
    share: Share | None = None,
    spread: Spread | None = None,
    attempts: int = 1,
) -> Path | str:
    """Compute the missing frames, and give the store its name when it is complete.

    Parameters
    ----------
    output : path
        Folder to make, customarily ``*.zarr``, or a URL that fsspec opens: ``s3://bucket/run.zarr``.
    layout : Layout
        Coordinates, frames and provenance.
    frame : callable
        ``frame(number)`` returns the images (ny, nx) of a frame, one for each of the layout's variables.
    resume : bool
        Continue ``output.partial``. A complete sequence is left unchanged; without either, all frames are computed.
        Frames that do not fit their checksums are made again.
    overwrite : bool
        Replace an existing sequence at ``output``, once the new one is complete.
    progress : callable, optional
        ``progress(done, total)``.
    share : Share, optional
        Make its units alone, in the unfinished sequence that is there or is made, at the same time as other shares or not; the name is
        given by ``finish_sequence``.
    spread : callable, optional
        Has the units made elsewhere; see ``seaglint.store.missing_frames.Spread``. Without it they are made here, one after the other.
    attempts : int
        Number of attempts of a frame that raises here before it is left out and named at the end; at 1 its error is raised at once.

    Returns
    -------
    path
        ``output``.

    Raises
    ------
    DataError
        The output exists, was made from something else, another process writes it, or frames raised too often.
    StorageError
        No room or no rights; the frames done stay.
    Interrupted
        After SIGINT or SIGTERM, when the frame at hand is in; where others make them, when they had a moment to end their units.
    """
    _require_joining(share, overwrite=overwrite)
    place = _checked_name(output, resume=resume, overwrite=overwrite)
    # A share always joins an existing sequence.
    continued = resume or share is not None

    def remedy() -> str:
        if place.resumable():
            return f"what is done stays in {place.work}: make room and go on with the same settings and resume=True"
        return "nothing was written; make room or choose another place"

    if not _stands(place, layout, resume=continued, overwrite=overwrite):
        with ExitStack() as claims:
            with storage_errors(place.work, remedy):
                claim: Any = claims.enter_context(place.claim(share))
            # Another process may have finished between the first look and the claim.
            if not _stands(place, layout, resume=continued, overwrite=overwrite):
                _require_free(place, resume=continued, overwrite=overwrite)
                with storage_errors(place.work, remedy):
                    place.remove_stages(claim)
                    stage = claims.enter_context(place.staging(claim))
                    shards, units = _joined(place, stage, layout, share, continued=continued)

                def note(kind: str) -> None:
                    with storage_errors(place.work, remedy):
                        _settle(place, stage, kind)

                missing = MissingUnits(place, stage, shards, units, claim, layout.frames, remedy, progress)
                if spread is None:
                    missing.make_here(frame, attempts)
                else:
                    missing.make_by_workers(spread, note)
                missing.require_all()
                if share is None:
                    with storage_errors(place.output, remedy):
                        _finish(place, stage, claim)
                return place.output
    if progress is not None:
        progress(len(layout.frames), len(layout.frames))
    return place.output


def finish_sequence(output: str | Path, scenario_json: str | None = None) -> bool:
    """Check an unfinished sequence and give it its name: every frame exists, every checksum is right.

    Parameters
    ----------
    output : path
        The final name.
    scenario_json : str, optional
        Scenario that it must be of.

    Returns
    -------
    bool
        False where it has its name already.

    Raises
    ------
    DataError
        Nothing is there, it is of another scenario, somebody writes it, or frames are missing: these are named, with their shares.
    StorageError
        No room or no rights.
    """
    place = _checked_name(output, resume=False, overwrite=False)
    if place.taken():
        _require_scenario(place.output, scenario_json)
        return False
    if not place.begun():
        raise DataError(f"{place.work}: no such unfinished sequence; render it first, whole or in shares")
    remedy = f"what is done stays in {place.work}: make room and finish again"
    claim: Any
    with storage_errors(place.work, remedy), place.claim() as claim, place.staging(claim) as stage:
        if place.taken():
            return False
        _require_scenario(place.work, scenario_json)
        group = open_group(place, stage)
        shards, numbers = Shards(group), np.asarray(group["frame"][:])
        units = range(shards.count)
        forget_damaged(shards, units, numbers)
        missing = shards.missing(units)
        if missing:
            counts = attributes(place.work).get(UNFINISHED, {}).get("shares", [])
            absent = sorted({index // shards.frames_per_unit for index in missing})
            of = f" (of shares {shares_of(absent, counts)})" if counts else ""
            todo = "run these shares again, or all with resume=True" if counts else "render again with resume=True"
            raise DataError(f"{place.work}: {len(missing)} of {shards.frames} frames are missing: {listed(numbers[missing])}{of}; {todo}")
        place.remove_stages(claim)
        _finish(place, stage, claim)
    return True


def check_output(
    output: str | Path, *, resume: bool = False, overwrite: bool = False, inputs: Iterable[str | Path] = (), share: Share | None = None
) -> Path | str:
    """Return the path of a sequence to be written; what its layout does not decide is checked before anything is computed.

    Raises
    ------
    DataError
        A folder missing, an ending of another kind of file, one of the ``inputs``, something there that may not be replaced.
    StorageError
        Nothing can be written in the folder.
    """
    _require_joining(share, overwrite=overwrite)
    place = _checked_name(output, resume=resume, overwrite=overwrite, inputs=inputs)
    with storage_errors(place.output, ELSEWHERE):
        if place.taken() and not resume and share is None:
            _require_replaceable(place, overwrite=overwrite)
        elif place.begun() and not place.taken() and share is None:
            with place.claim():  # a process that writes there now is reported first
                _require_free(place, resume=resume, overwrite=overwrite)
    return place.output


def _checked_name(output: str | Path, *, resume: bool, overwrite: bool, inputs: Iterable[str | Path] = ()) -> Place:
    """Check the name and its folder."""
    place = place_of(output)
    if resume and overwrite:
        raise DataError("resume=True keeps what is there and overwrite=True replaces it; give one of the two")
    name = Path(str(output))
    if name.suffix.lower() in FILE_ENDINGS:
        raise DataError(
            f"{output}: a sequence is a Zarr store, a folder; give a name that ends in .zarr "
            f"(a mean map, {name.stem}.nc, is made by 'seaglint mean')"
        )
    place.check(inputs)
    return place


def _joined(place: Place, stage: Any, layout: Layout, share: Share | None, *, continued: bool) -> tuple[Shards, range]:
    """Return the empty store, or the begun one without its damaged frames, and the units of this share."""
    with place.settling():
        joins = continued and place.begun() and (_whole(place) or (share is not None and _wait_for(place)))
        if joins:
            _require_same(place.work, layout)
        else:
            place.create(layout, stage, replace=share is None)
    _settle(place, stage, processor(), share)
    shards = Shards(open_group(place, stage))
    units = range(shards.count) if share is None else share.units(shards.count)
    if joins:
        forget_damaged(shards, units, np.asarray(layout.frames))
    return shards, units


def _whole(place: Place) -> bool:
    """Return true where the empty store is complete: in an object store it grows under its name."""
    return bool(attributes(place.work).get(UNFINISHED, {}).get("made", True))


def _wait_for(place: Place) -> bool:
    """Wait for another share that may be making the empty store, where there are no locks."""
    until = time.monotonic() + PATIENCE
    while not _whole(place):
        if time.monotonic() > until:
            raise DataError(f"{place.work}: was begun and not completed; begin anew without a share and with overwrite=True, or remove it")
        time.sleep(0.5)
    return True


def _settle(place: Place, stage: Any, kind: str, share: Share | None = None) -> None:
    """Record in the store the types of processors that make it, and the number of shares of the work."""
    with place.settling():
        stored = attributes(place.work)
        known = set(filter(None, stored.get("processor", "").split("; ")))
        others = known | {kind}
        counts = stored.get(UNFINISHED, {}).get("shares", [])
        shares = sorted({*counts, share.count}) if share is not None else counts
        changed: Attributes = {}
        if others != known:
            changed = {"processor": "; ".join(sorted(others)), "processors_mixed": PROCESSORS_MIXED}
            log.warning("seaglint: %s: %s: %s", place.work, PROCESSORS_MIXED, changed["processor"])
        if shares != counts:
            changed[UNFINISHED] = {"shares": shares}
        if changed:
            open_group(place, stage).update_attributes(changed)


def _finish(place: Place, stage: Any, claim: Any) -> None:
    """Give the store its final name, if it is still claimed and has every frame on disk."""
    claim.require()
    place.require_there()
    group = open_group(place, stage)
    shards = Shards(group)
    missing = len(shards.missing(range(shards.count)))
    if missing:
        state = f"{missing} of {shards.frames} frames are missing"
        raise DataError(f"{place.work}: {state} though all were written; see that no other program works there and go on with resume=True")
    place.sweep()
    # Metadata are consolidated last, so that readers of the finished store find no attribute of an unfinished one.
    group.attrs.put({key: value for key, value in dict(group.attrs).items() if key != UNFINISHED})
    consolidate(place.store(stage))
    claim.require()
    place.give_name()


def _require_joining(share: Share | None, *, overwrite: bool) -> None:
    """Refuse a share that would replace what others made."""
    if share is not None and overwrite:
        raise DataError(f"share={share} joins what is there and overwrite=True replaces it; remove the old sequence before the first share")


def _stands(place: Place, layout: Layout, *, resume: bool, overwrite: bool) -> bool:
    """Refuse what may not be replaced; return true when the complete sequence exists already."""
    if not place.taken():
        return False
    if resume:
        _require_same(place.output, layout)
        return True
    _require_replaceable(place, overwrite=overwrite)
    return False


def _require_replaceable(place: Place, *, overwrite: bool) -> None:
    if not overwrite:
        raise DataError(f"{place}: exists already; choose another name, or replace it with overwrite=True")
    _require_ours(place.output)


def _require_free(place: Place, *, resume: bool, overwrite: bool) -> None:
    """Refuse to start again where an unfinished sequence lies."""
    if place.begun() and not resume:
        if not overwrite:
            raise DataError(f"{place.work}: an unfinished sequence is there; go on with resume=True, or begin anew with overwrite=True")
        _require_ours(place.work)


def _require_ours(path: Path | str) -> None:
    """Require that a folder was written by seaglint before it is deleted: a mistyped name must not cost a folder."""
    if not is_ours(path):
        raise DataError(f"{path}: is not a seaglint sequence and is left alone; choose another name or remove it yourself")


def _require_readable(path: Path | str) -> Attributes:
    stored = attributes(path)
    if stored.get("seaglint_format") != FORMAT:
        raise DataError(f"{path}: is not a readable seaglint sequence; choose another name or remove it yourself")
    if stored.get("seaglint_version") not in (None, __version__):
        raise DataError(
            f"{path}: is made by seaglint {stored['seaglint_version']}, and this is {__version__}; go on with that version, "
            "or begin anew with overwrite=True"
        )
    return stored


def _require_scenario(path: Path | str, scenario_json: str | None) -> None:
    stored = _require_readable(path)
    if scenario_json is not None:
        differ = differences({"scenario": stored.get("scenario")}, {"scenario": scenario_json})
        if differ:
            raise DataError(f"{path}: was made with another {', '.join(differ)}; finish it with the scenario that it was begun with")


def _require_same(path: Path | str, layout: Layout) -> None:
    stored = _require_readable(path)
    import zarr

    group: Any = zarr.open_group(path, mode="r", zarr_format=3)
    # The same attributes make the same frames: what is stored can be continued only then.
    differ = differences(stored, layout.all_attributes)
    if [int(number) for number in group["frame"][:]] != list(layout.frames):
        differ.append("frames")
    if CHECKSUM not in group:
        differ.append("layout, without checksums")
    elif not differ and group[DONE].chunks[0] != layout.frames_per_unit:
        differ.append("size of its shards")
    if differ:
        raise DataError(f"{path}: was made with another {', '.join(differ)}; resume with the same ones, or begin anew with overwrite=True")


def is_sequence(path: Path | str) -> bool:
    """Return true where a folder was written by ``write_sequence``, finished or not."""
    return is_ours(path)


def open_sequence(path: str | Path, *, allow_partial: bool = False) -> xr.Dataset:
    """Open a sequence lazily as an :class:`xarray.Dataset`.

    Parameters
    ----------
    path : path
        Folder, or a URL that fsspec opens.
    allow_partial : bool
        Also one that is not finished.

    Raises
    ------
    DataError
        Nothing is there, it is no sequence, it is unfinished (unless ``allow_partial``), or a frame has gone missing.
    """
    place = place_of(path)
    store = place.output
    if not place.taken() and not (place.work == store and place.begun()):
        hint = f"; {place.work} is there, unfinished: render again with resume=True" if place.begun() else ""
        raise DataError(f"{path}: no such sequence{hint}")
    stored = attributes(store)
    if stored.get("seaglint_format") != FORMAT:
        raise DataError(f"{path}: is not a seaglint sequence, or its zarr.json is cut; give a folder made by 'seaglint render'")
    import xarray as xr

    try:
        dataset = xr.open_dataset(str(store), engine="zarr", consolidated=False, chunks=None, decode_times=False)
        done = dataset[DONE].to_numpy().astype(bool)
    except Exception as error:
        raise DataError(f"{path}: the sequence is damaged ({error}); render it again") from error
    if not allow_partial and not done.all():
        missing = f"{int((~done).sum())} of {done.size} frames are missing"
        raise DataError(f"{path}: is unfinished, {missing}; render again with resume=True")
    if not allow_partial and UNFINISHED in stored:
        raise DataError(
            f"{path}: is unfinished though all frames are there; complete it with finish_sequence, or 'seaglint render' and finish=True"
        )
    return dataset
