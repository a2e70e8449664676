"""Cases of a sweep: a scenario with keys set to every combination of their values."""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.errors import ScenarioError
from seaglint.base.free_form import TomlTables
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.setting import set_key
from seaglint.scenario.text.write import differing
from seaglint.studies.sweep.swept_keys import SweptKey, swept_keys

#: Keys that most of the preparation depends on, in the order in which cases change them, the slowest first.
_OF_THE_AIR: Final = ("band", "atmosphere", "place", "time", "wind.speed_m_s", "wind", "sensor.height_m", "sea.temperature_k")

MOST_CHECKED: Final = 5000  #: Number of values of all keys up to which they are checked beforehand: a second for each thousand.


@dataclass(frozen=True, eq=False)
class SweepPlan:
    """Scenario and swept keys of a sweep. Make it with :meth:`of`."""

    base: TomlTables  #: Tables of the scenario.
    folder: Path | None  #: Folder from which relative paths count.
    keys: tuple[SweptKey, ...]  #: Swept keys, in the order of the dimensions.

    @classmethod
    def of(cls, source: Scenario | str | Path | Mapping[str, Any], vary: Mapping[str, Any]) -> SweepPlan:
        """Return the plan of a sweep over a scenario, its file, or its tables.

        Raises
        ------
        ScenarioError
            A scenario with mistakes, or a key that does not exist.
        DataError
            Values that are none.
        """
        base, folder = _tables(source)
        plan = cls(base, folder, swept_keys(base, vary, folder))
        plan.require_base(source)
        return plan

    def require_base(self, source: Scenario | str | Path | Mapping[str, Any]) -> None:
        """Refuse a scenario with mistakes, as its file has them; a key that is varied may be missing in it.

        Raises
        ------
        ScenarioError
            Every mistake.
        """
        try:
            if isinstance(source, str | Path):
                load_scenario(Path(source))
            else:
                parse_scenario(self.base, base=self.folder)
        except ScenarioError as error:
            try:
                self.scenario(0)
            except ScenarioError:
                raise error from None

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each key."""
        return tuple(len(key.values) for key in self.keys)

    @property
    def count(self) -> int:
        """Number of cases."""
        return math.prod(self.shape)

    def order(self) -> list[int]:
        """Return the numbers of all cases, in an order in which neighbours share most of their preparation."""
        ranks = [_rank(key.name) for key in self.keys]
        axes = sorted(range(len(self.keys)), key=lambda axis: (ranks[axis], axis))
        return [int(number) for number in np.arange(self.count).reshape(self.shape).transpose(axes).ravel()]

    def together(self) -> int:
        """Return the number of neighbours in :meth:`order` that differ in nothing that most of the preparation depends on."""
        return math.prod(size for key, size in zip(self.keys, self.shape, strict=True) if _rank(key.name) == len(_OF_THE_AIR))

    def places(self, number: int) -> tuple[int, ...]:
        """Return the place of a case along each dimension."""
        return tuple(int(place) for place in np.unravel_index(number, self.shape))

    def named(self, number: int) -> str:
        """Return what a case sets, for messages."""
        return ", ".join(key.said(place) for key, place in zip(self.keys, self.places(number), strict=True))

    def scenario(self, number: int) -> Scenario:
        """Return the scenario of a case.

        Raises
        ------
        ScenarioError
            Naming the case.
        """
        tables, name = copy.deepcopy(self.base), f"sweep, {self.named(number)}"
        for key, place in zip(self.keys, self.places(number), strict=True):
            set_key(tables, key.name, copy.deepcopy(key.values[place]), name)
        try:
            return parse_scenario(tables, name=name, base=self.folder)
        except ScenarioError as error:
            first = str(error).splitlines()[0]
            raise ScenarioError(first, mistakes=error.mistakes[:1]) from None

    def check(self) -> None:
        """Refuse values that no scenario may have before anything is computed: each value of a key beside the first ones of the others.

        Raises
        ------
        ScenarioError
            Naming the case.
        """
        place = np.cumprod([1, *self.shape[:0:-1]])[::-1]
        if sum(self.shape) <= MOST_CHECKED:
            for size, step in zip(self.shape, place, strict=True):
                for value in range(size):
                    self.scenario(value * int(step))

    def base_scenario(self) -> Scenario:
        """Return the scenario without changes; its first case where the scenario needs what is varied."""
        try:
            return parse_scenario(self.base, base=self.folder)
        except ScenarioError:
            return self.scenario(0)


def _rank(name: str) -> int:
    return next((i for i, prefix in enumerate(_OF_THE_AIR) if name == prefix or name.startswith(f"{prefix}.")), len(_OF_THE_AIR))


def _tables(source: Scenario | str | Path | Mapping[str, Any]) -> tuple[TomlTables, Path | None]:
    """Return the tables of a scenario as its file has them, and the folder that paths count from."""
    if isinstance(source, Scenario):
        return differing(source), None
    if isinstance(source, Mapping):
        return copy.deepcopy(dict(source)), None
    path = Path(source)
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig")), path.parent.absolute()
    except (OSError, ValueError, RecursionError):
        load_scenario(path)  # it says what is wrong
        raise


def chunks(order: Sequence[int], together: int, workers: int) -> list[tuple[int, ...]]:
    """Split cases into units of work: neighbours that share their preparation stay together while there is enough for all workers.

    >>> chunks(range(6), 3, 1)
    [(0, 1, 2), (3, 4, 5)]
    >>> chunks(range(6), 6, 2)
    [(0,), (1,), (2,), (3,), (4,), (5,)]
    """
    size = max(min(together, len(order) // (2 * workers)), 1) if workers > 1 else max(together, 1)
    return [tuple(order[first : first + size]) for first in range(0, len(order), size)]
