"""Work that the scaling report hands to workers, in a module of its own that they can import; as a script, many simulated Dask workers."""

from __future__ import annotations

import asyncio
import hashlib
import pickle
import resource
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple


class FrameRecord(NamedTuple):
    """What comes back of a frame."""

    frame: int
    checksum: str
    cpu_seconds: float
    peak_mb: float


def frames(scenario: Any) -> Callable[[int], FrameRecord]:
    """Frames of a scenario, rendered and thrown away."""
    from seaglint.base.threads import single_threaded_algebra
    from seaglint.studies.sequence.render_sequence import prepare_sequence

    run = prepare_sequence(scenario)

    def render(number: int) -> FrameRecord:
        began = time.process_time()
        with single_threaded_algebra():
            radiance = run.images(number)["radiance"]
        seconds = time.process_time() - began
        return FrameRecord(number, hashlib.sha256(radiance.tobytes()).hexdigest(), seconds, peak_mb())

    return render


def sleeping(seconds: float) -> Callable[[int], FrameRecord]:
    """Frames that take time and nothing else."""

    def work(number: int) -> FrameRecord:
        time.sleep(seconds)
        return FrameRecord(number, "0" * 64, seconds, peak_mb())

    return work


def peak_mb() -> float:
    """Largest memory of this process so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000.0


#: Time of a simulated unit [s]: with half a second a thousand slots take up to 2000 units a second, so that they are not the limit.
PAUSE = 0.5


async def simulated(unit: bytes, content: bytes, topic: str) -> None:
    """In the place of :func:`seaglint.cluster.remote.do`: sleeps in the worker's event loop, so that a unit costs no thread."""
    from seaglint.cluster.job import Done
    from seaglint.cluster.remote import publish

    began = time.perf_counter()
    await asyncio.sleep(PAUSE)
    key, number = pickle.loads(unit)
    record = FrameRecord(pickle.loads(number), "0" * 64, 0.0, 0.0)
    publish(topic, key, pickle.dumps(Done(record.frame, record, time.perf_counter() - began, "simulated")))


async def host(address: str, workers: int, threads: int) -> None:
    """Many workers of a scheduler in one process, until it goes."""
    from distributed import Worker

    made: list[Any] = [await Worker(address, nthreads=threads, dashboard=False, memory_limit=0) for _ in range(workers)]
    await asyncio.gather(*(worker.finished() for worker in made))


if __name__ == "__main__":
    asyncio.run(host(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))
