"""A small sequence in shards of four frames, for tests and the processes that they start."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from seaglint.objects.drawing.truth import NUMBERS
from seaglint.optics.band import Band
from seaglint.store.layout import Layout, Truth
from seaglint.store.provenance import provenance
from seaglint.store.sequence_store import write_sequence
from seaglint.store.shards import Frame
from seaglint.store.writers import Share

ROWS, COLUMNS = 3, 5

RAISES: set[int] = set()
"""Frames at which :func:`raising` raises."""


def layout(scenario_json='{"sea": {"wind": {"speed_m_s": 7.0}}}') -> Layout:
    """23 frames."""
    return Layout(
        azimuth_deg=np.arange(COLUMNS) * 1.0,
        elevation_deg=-np.arange(ROWS) * 1.0,
        frames=range(23),
        frame_rate=25.0,
        band=Band.rectangular(3.5, 5.0),
        per_frame=("saturated_share",),
        attributes=provenance("Sea radiance", scenario_json, 1),
        frames_per_unit=4,
    )


def pixels(number: int) -> np.ndarray:
    return np.full((ROWS, COLUMNS), number, np.float32) + np.arange(COLUMNS, dtype=np.float32) / 16


def frame(number: int) -> dict[str, np.ndarray]:
    return {"radiance": pixels(number), "saturated_share": np.float32(number / 32)}


def raising(number: int) -> dict[str, np.ndarray]:
    if number in RAISES:
        raise RuntimeError("a defect")
    return frame(number)


def slowly(number: int) -> dict[str, np.ndarray]:
    time.sleep(0.01)
    return frame(number)


def other_frame(number: int) -> dict[str, np.ndarray]:
    """Frames of another sea."""
    return {name: values + np.float32(1.0) for name, values in frame(number).items()}


def prepared_other(_: None) -> tuple[Layout, Frame]:
    return layout('{"sea": {"wind": {"speed_m_s": 9.0}}}'), other_frame


def many() -> Layout:
    """300 frames in shards of three."""
    return replace(layout(), frames=range(300), frames_per_unit=3)


def prepared(_: None) -> tuple[Layout, Frame]:
    return layout(), slowly


def prepared_many(_: None) -> tuple[Layout, Frame]:
    return many(), slowly


def with_truth() -> Layout:
    return replace(layout(), truth=Truth(("a", "b")))


def true_frame(number: int) -> dict[str, np.ndarray]:
    numbers = dict.fromkeys(NUMBERS, np.array([number, number + 1.0]))
    mask = np.zeros((1, ROWS, COLUMNS), np.uint64)
    return frame(number) | numbers | {"object_mask": mask, "object_id": np.full((ROWS, COLUMNS), number, np.uint16)}


def share(output: str, index: int, count: int) -> None:
    """A share, in a process of its own."""
    write_sequence(output, layout(), slowly, share=Share(index, count))


def slow(output: str) -> None:
    """A run that says when it begins."""
    print("begins", flush=True)
    write_sequence(output, layout(), slowly, resume=True)


def over_workers(output: str) -> None:
    """300 frames over two processes; says so at the start and after each unit."""
    from seaglint.cluster import LocalProcesses
    from seaglint.studies.sequence.sequence_work import spread_over

    def told(done: int, total: int) -> None:
        print(done, total, flush=True)

    with LocalProcesses(2) as workers:
        write_sequence(output, many(), slowly, resume=True, spread=spread_over(workers, prepared_many, None), progress=told)


def long_units(_: None) -> tuple[Layout, Frame]:
    """Units that take hours."""

    def long(number: int) -> dict[str, np.ndarray]:
        time.sleep(3600.0)
        return frame(number)

    return layout(), long


def over_long_units(output: str) -> None:
    """Two processes at units of hours."""
    from seaglint.cluster import LocalProcesses
    from seaglint.studies.sequence.sequence_work import spread_over

    def told(done: int, total: int) -> None:
        print(done, total, flush=True)

    with LocalProcesses(2) as workers:
        write_sequence(output, layout(), frame, spread=spread_over(workers, long_units, None), progress=told)
