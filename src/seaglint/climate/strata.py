"""Strata of the probability of glint: by month, hour, bearing and latitude, and by the winds and Suns that bring it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.draws import SamplingPlan, estimate

BEARINGS: Final = np.arange(0.0, 361.0, 30.0)
WINDS: Final = np.array([0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 14.0, 20.0, np.inf])
SUNS: Final = np.array([-90.0, 0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0])
LATITUDES: Final = np.arange(-90.0, 91.0, 10.0)


@dataclass(frozen=True)
class Stratum:
    """Stratum of draws between two values of a quantity."""

    by: str  #: Quantity, with its unit.
    #: ``low``, ``high``: Its range; the upper end is outside.
    low: float
    high: float
    share: float  #: Share of all draws [1].
    #: ``value``, ``interval_low``, ``interval_high``: Chance of glint among these draws, and its 95 % interval [1].
    value: float
    interval_low: float
    interval_high: float
    contribution: float  #: Share of all glint that these draws bring [1]; NaN without any.


def strata(
    values: FloatArray,
    plan: SamplingPlan,
    quantities: dict[str, tuple[FloatArray, FloatArray]],
    most: float = 1.0,
    *,
    weight: FloatArray | None = None,
) -> list[Stratum]:
    """Strata of draws by each quantity: values of every draw [(total,)] and the edges of its classes; NaN counts nowhere.

    ``weight`` is what each draw stands for [(total,)]; all the same where it is not given.
    """
    result = []
    each = np.ones(values.size) if weight is None else weight
    whole, total = float(values @ each), float(each.sum())
    for name, (what, edges) in quantities.items():
        place = np.digitize(what, edges)
        for i in range(1, edges.size):
            inside = np.where(place == i, each, 0.0)
            count = float(inside.sum())
            if count == 0.0:
                continue
            e = estimate(values, plan, weight=inside, most=most)
            part = float(values @ inside) / whole if whole > 0.0 else float("nan")
            result.append(Stratum(name, float(edges[i - 1]), float(edges[i]), count / total, e.value, e.low, e.high, part))
    return result
