"""Prepared scenes reused for scenarios that differ in seed and objects alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol, Self, TypeVar

from seaglint.scenario.model import Scenario


class Shareable(Protocol):
    """A scene made ready, from which others can be had."""

    def with_sea_of(self, scenario: Scenario) -> Self:
        """Return the scene with another scenario's seed and objects."""
        ...


Made = TypeVar("Made", bound=Shareable)


@dataclass(eq=False)
class Kept:
    """Cache of the latest prepared scene; memory does not grow with the number of scenes.

    Notes
    -----
    The bytes of a scene do not depend on what was kept.
    """

    _latest: tuple[str, Any] | None = field(default=None, repr=False)

    def sequence(self, scenario: Scenario, settings: str, prepare: Callable[[], Made]) -> Made:
        """The scene of a scenario, from the latest one where only seed and objects differ.

        Parameters
        ----------
        scenario : Scenario
            What is drawn.
        settings : str
            What else it depends on.
        prepare : callable
            Makes it from nothing.
        """
        if scenario.platform is not None and scenario.platform.floats:
            return prepare()  # its way depends on the sea
        key = settings + scenario.model_copy(update={"seed": 0, "objects": None}).model_dump_json()
        if self._latest is not None and self._latest[0] == key:
            latest: Made = self._latest[1]
            return latest.with_sea_of(scenario)
        self._latest = None  # two at a time would be twice the memory
        made = prepare()
        self._latest = (key, made)
        return made
