"""Rates of a detector over seas between the campaigns: the same detector, contrasts and phases of waves, other short waves."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from seaglint.base.free_form import JsonObject, TableRow
from seaglint.scenario.model import Scenario
from seaglint.store.detection_results import DetectorResult
from seaglint.studies.detect.detection_requests import SceneRequest
from seaglint.studies.sea_draws import COUNT, SeaUnknown, sea_draws

Request = TypeVar("Request", bound=SceneRequest)


def of_same_contrast(request: Request, judged: DetectorResult) -> Request:
    """Return the request with the contrasts at the aperture of a result, so that a rougher sea changes the rates and not the objects."""
    contrasts = tuple(float(row["contrast_aperture"]) for row in judged.result["sweep"])
    return replace(request, contrast=contrasts, temperature_difference=None, intensity=None, sea_draws=None)


def with_unknown_sea(
    scenario: Scenario, request: Request, judged: DetectorResult, run: Callable[[int, Scenario, Request], DetectorResult]
) -> DetectorResult:
    """Return a result with the intervals of its rates over drawn seas; ``run`` evaluates the request in the sea of a number."""
    if request.sea_draws is None:
        return judged
    same = of_same_contrast(request, judged)
    seas = [run(number, sea, same) for number, sea in enumerate(sea_draws(scenario, request.sea_draws))]
    return joined(judged, seas)


def joined(judged: DetectorResult, seas: Sequence[DetectorResult]) -> DetectorResult:
    """Return a result with the ends of the intervals of P_fa, P_d and the needed contrast over the results of drawn seas."""
    result, rows = copy.deepcopy(judged.result), copy.deepcopy(judged.rows)
    false = _interval("p_fa", [sea.result for sea in seas])
    result |= {COUNT: len(seas), **false}
    for k, entry in enumerate(result["sweep"]):
        found = _interval("p_d", [sea.result["sweep"][k] for sea in seas])
        entry |= {**found, COUNT: len(seas)}
        rows[k] |= {**found, **false, COUNT: len(seas)}
    design = result.get("design")
    if design is not None and design.get("contrast") is not None and design.get("contrast_unit") == "W m-2 sr-1":
        # Seas in which no contrast suffices have no value, and the interval then has none.
        needed = _interval("contrast", [sea.result.get("design") or {} for sea in seas])
        design |= needed
        for row in rows:
            row |= {f"design_{key}": value for key, value in needed.items()}
    return replace(judged, result=result, rows=rows)


def _interval(name: str, results: Sequence[JsonObject | TableRow]) -> TableRow:
    values = [np.nan if (value := result.get(name)) is None else float(value) for result in results]
    ends: TableRow = SeaUnknown.of(np.array(values)).as_dict(name)
    return ends
