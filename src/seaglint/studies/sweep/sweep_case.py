"""One case of a sweep: its settings, its result, or why it failed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from seaglint.base.errors import DataError, ScenarioError, SeaglintError, one_line
from seaglint.scenario.model import Scenario
from seaglint.studies.sweep.case_arrays import CaseResult
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
