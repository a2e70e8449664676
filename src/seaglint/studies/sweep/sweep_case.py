"""One case of a sweep: its settings, its result, or why it failed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError, ScenarioError, SeaglintError, one_line
from seaglint.scenario.model import Scenario
from seaglint.studies.sweep.case_arrays import CaseResult, NamedArray
from seaglint.studies.sweep.sweep_plan import SweepPlan
from seaglint.studies.sweep.view_angles import ViewAngles


@dataclass(frozen=True, eq=False)
class SweepSettings:
    """Settings of a sweep that each worker needs."""

    plan: SweepPlan
    what: str | Callable[[Scenario], Any]
    at: ViewAngles | None
    keep_going: bool = False
    threads: int | None = None

    @property
    def title(self) -> str:
        """Name of the quantity."""
        return self.what if isinstance(self.what, str) else getattr(self.what, "__name__", type(self.what).__name__)


@dataclass(frozen=True)
class CaseFailure:
    """Case that failed, in words."""

    text: str


Outcome = CaseResult | CaseFailure


def compute_case(settings: SweepSettings, compute: Callable[[Scenario], CaseResult], number: int) -> Outcome:
    """Return the result of a case, or its failure where the sweep goes on.

    Raises
    ------
    SeaglintError
        What the scenario or the models refuse, or what the user's function raised; the message names the case.
    """
    try:
        scenario = settings.plan.scenario(number)
        try:
            return compute(scenario)
        except ScenarioError as error:
            raise ScenarioError(f"sweep, {settings.plan.named(number)}: {line_of(error)}") from error
        except SeaglintError as error:
            raise DataError(f"sweep, {settings.plan.named(number)}: {line_of(error)}") from error
        except Exception as error:
            if not callable(settings.what):
                raise  # a defect, which keeps its traceback
            raise DataError(f"sweep, {settings.plan.named(number)}: the function {settings.title} raised {one_line(error)}") from error
    except SeaglintError as error:
        if not settings.keep_going:
            raise
        return CaseFailure(line_of(error))


def line_of(error: BaseException) -> str:
    """Return the text of an error in one line."""
    return " ".join(str(error).split())


def require_shape(
    settings: SweepSettings, number: int, name: str, array: NamedArray | None, shape: tuple[int, ...], dims: tuple[str, ...] | None = None
) -> None:
    """Refuse an array of a case that is not of the shape, and of the dimensions, of the first case.

    Raises
    ------
    DataError
        The message names the case.
    """
    if array is None or array.values.shape != shape or (dims is not None and array.dims != dims):
        found = "missing" if array is None else f"of the shape {array.values.shape}"
        raise DataError(
            f"sweep, {settings.plan.named(number)}: {name} is {found} and that of the first case of {shape}; vary only what leaves the "
            "picture's size the same"
        )


def require_places(settings: SweepSettings, number: int, name: str, array: NamedArray | None, places: NDArray[Any]) -> None:
    """Refuse a coordinate of a case that is not that of the first case.

    Raises
    ------
    DataError
        The message names the case.
    """
    if array is None or not np.array_equal(array.values, places):
        raise DataError(
            f"sweep, {settings.plan.named(number)}: the coordinate {name} is not that of the first case; return the same places in all "
            "cases, or a coordinate of another name along the dimension"
        )
