"""Worker in this process: one unit after the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from seaglint.cluster.job import ATTEMPTS, Done, Failed, Job, Record, Settings, Unit, attempt


class Here:
    """Worker that is the calling process itself."""

    count = 1

    @contextmanager
    def map(self, job: Job[Settings, Unit, Record], units: Iterable[Unit]) -> Iterator[Iterator[Done[Unit, Record] | Failed[Unit]]]:
        """Yield the outcomes of all units in their order; see :class:`seaglint.cluster.job.Workers`."""
        work = job.start(job.settings)

        def outcomes() -> Iterator[Done[Unit, Record] | Failed[Unit]]:
            for unit in units:
                for tried in range(1, ATTEMPTS + 1):
                    outcome = attempt(work, unit, "here", tried)
                    if isinstance(outcome, Done):
                        break
                yield outcome

        yield outcomes()
