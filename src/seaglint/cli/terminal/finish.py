"""The end of a work that was cut into shares: the message after a share, and the check of the whole."""

from __future__ import annotations

from pathlib import Path

from seaglint.base.errors import DataError
from seaglint.cli.terminal.messages import log
from seaglint.cli.terminal.options import place_given


def require_one_way(*, shard: str | None, overwrite: bool) -> None:
    """Refuse ``--finish`` with what makes or replaces frames.

    Raises
    ------
    DataError
        Another option does that.
    """
    for name, given in (("--shard", shard is not None), ("--overwrite", overwrite)):
        if given:
            raise DataError(f"--finish checks and names what is there, and {name} makes frames; give one of the two")


def finish_store(scenario: str, output: str | None, sensor: str | None) -> Path | str:
    """Check a store and name it; where no output is given, ``scenario`` is the store. Returns where it is.

    Raises
    ------
    SeaglintError
        See :func:`seaglint.files.store.store.finish_sequence`.
    """
    from seaglint.files.store.store import finish_sequence, open_sequence
    from seaglint.scenario.load import load_scenario

    if output is None and scenario.lower().endswith(".toml"):
        raise DataError(f"--finish: which store of {scenario}? Name it with -o run.zarr, or alone: seaglint render --finish run.zarr")
    store = place_given(scenario if output is None else output)
    expected = None if output is None else load_scenario(Path(scenario), sensor=sensor).model_dump_json(exclude_none=True)
    if not finish_sequence(store, expected):
        log(f"{store}: is finished already")
        return store
    with open_sequence(store) as dataset:
        log(f"{store}: {dataset.sizes['time']} frames, all there and as their checksums say")
    return store


def tell_share(store: Path | str, share: object) -> None:
    """Say how far the whole is when a share of it is done."""
    from seaglint.files.store.location import place_of
    from seaglint.files.store.store import open_sequence

    place = place_of(store)
    if place.taken():
        log(f"{store}: is finished already; share {share} has nothing to do")
        return
    with open_sequence(place.work, allow_partial=True) as dataset:
        done = dataset["frame_done"].to_numpy()
    message = f"{place.work}: share {share} is done; {int(done.sum())} of {done.size} frames are there"
    log(f"{message}; next: seaglint render --finish {store}" if done.all() else message)
