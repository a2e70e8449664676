"""Which tests of a part run, and in which order: plugins of pytest for the quick suite and for a choice of the validations."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from validations import Plan

LONG_FIRST = (
    "test_examples.py",
    "test_documentation.py",
    "test_architecture.py",
    "test_validations.py",
    "test_resolved_mean.py",
    "test_shards.py",
    "test_scattered_images.py",
    "test_averaging_down.py",
    "test_false_alarms.py",
    "test_performance.py",
    "test_autobinomial_fit.py",
    "test_table1.py",
)
"""Files with long tests: what two workers share out last must be short."""


def add_options(parser: pytest.Parser) -> None:
    """Add the option of a plan."""
    group = parser.getgroup("parts of the suite")
    group.addoption("--chosen", metavar="FILE", help="run the tests that a plan of tools/validations.py chooses, in its order")


def configure(config: pytest.Config) -> None:
    """Register the order that is requested."""
    # xdist would sort files by their number of tests, which says nothing about their time.
    config.option.loadscopereorder = False
    worker: str | None = getattr(config, "workerinput", {}).get("workerid")
    if config.option.chosen:
        config.pluginmanager.register(ChosenOrder(Path(config.option.chosen), first=worker in (None, "gw0")), "chosen-order")
    elif worker:
        config.pluginmanager.register(LongFirst(), "long-first")


class LongFirst:
    """Files of long tests first, each in one piece, where tests are shared out over workers."""

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Sort by file."""
        rank = {name: number for number, name in enumerate(LONG_FIRST)}
        items.sort(key=lambda item: rank.get(item.path.name, len(rank)))


class ChosenOrder:
    """The choice and the order of a plan.

    Parameters
    ----------
    path
        File of the plan.
    first
        Whether this process writes, beside the plan, the reason for which each test was chosen.
    """

    def __init__(self, path: Path, *, first: bool) -> None:
        self.path = path
        self.first = first

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        """Keep and sort what the plan chooses, of what other options have left."""
        plan = Plan.read(self.path)
        places = {item.nodeid: plan.place(item.nodeid) for item in items}
        if self.first:
            plan.write_reasons(self.path, {test: place.reason if place else "" for test, place in places.items()})
        left = [item for item in items if places[item.nodeid] is None]
        if left:
            config.hook.pytest_deselected(items=left)
        items[:] = sorted((item for item in items if places[item.nodeid]), key=lambda item: places[item.nodeid].rank)

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_make_scheduler(self, config: pytest.Config, log: Any) -> Any:
        """Share out tests in the plan's order, the cases of one function together.

        Files in one piece would let one worker end with a long file while the other is at tests of less weight.
        """
        from xdist.scheduler import LoadScopeScheduling

        plan = Plan.read(self.path)

        class ByFunction(LoadScopeScheduling):  # type: ignore[misc]
            def _split_scope(self, nodeid: str) -> str:
                place = plan.place(nodeid)
                return f"{nodeid.split('[')[0]} {place.reason if place else ''}"

        return ByFunction(config, log)
