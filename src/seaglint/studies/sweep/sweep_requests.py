"""Request for a sweep over keys of a scenario.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal, get_args

from seaglint.base.parameters import Parameter
from seaglint.studies.reading_requests import WorkRequest

Quantity = Literal["mean", "image", "sensor", "atmosphere", "likelihood"]  #: Quantity that a sweep computes for each case.

QUANTITIES: Final[tuple[str, ...]] = get_args(Quantity)

MOST_CASES: Final = 100_000  #: Cases of a sweep at most, unless more are allowed.


@dataclass(frozen=True)
class SweepRequest(WorkRequest):
    """Request to compute one quantity over every combination of some values of a scenario's keys."""

    vary: Annotated[
        tuple[str, ...],
        Parameter(
            "key of the scenario with its values; STOP is included; repeatable, all combinations are computed",
            metavar="KEY=A,B,C|START:STOP:STEP",
            python="Values by key of the scenario, such as ``{'wind.speed_m_s': [2, 5, '20 kn']}``. All combinations are computed. A key "
            "may be a whole table (``'sea.slopes'``), its values tables; ``'band'`` also takes pairs of wavelengths [um].",
        ),
    ] = ()
    what: Annotated[
        Any,
        Parameter(
            "quantity of each case: mean, image, sensor, atmosphere or likelihood",
            metavar="WHAT",
            form="name",
            python="``mean`` radiance of the sea, ``image`` at time 0, figures of merit of the ``sensor``, transmittance and radiance of "
            "the ``atmosphere``, ``likelihood`` of glint; or a function of a scenario that returns a number, numbers by name, or arrays of "
            "xarray.",
        ),
    ] = "mean"
    at: Annotated[
        tuple[str, ...],
        Parameter(
            "view angles instead of the picture's pixels, for mean and atmosphere: view_zenith_deg at the sea, 0 is straight down, and "
            "view_azimuth_deg of the line of sight, clockwise from north; repeatable",
            metavar="ANGLE=A,B,C|START:STOP:STEP",
            python="View angles instead of the picture's pixels, for ``mean`` and ``atmosphere``: ``view_zenith_deg``, the zenith angle at "
            "the sea of the direction to the sensor, 0 is straight down, and ``view_azimuth_deg``, the azimuth of the line of sight, "
            "clockwise from north, by default the sensor's.",
        ),
    ] = ()
    threads: Annotated[
        int | None,
        Parameter("processor threads of each process; default: all", "Run", least=1, detail="Results do not depend on them."),
    ] = None
    keep_going: Annotated[
        bool, Parameter("leave cases that fail without values (NaN) and compute the others; without it the first failure ends the sweep")
    ] = False
    most_cases: Annotated[int, Parameter("largest number of cases that is computed", least=1)] = MOST_CASES
