"""Sweeps whose cases are computed when their values are read, with Dask."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.optional import optional
from seaglint.base.threads import thread_limit
from seaglint.scenario.model import Scenario
from seaglint.studies.sweep.case_arrays import CaseResult
from seaglint.studies.sweep.case_results import computer
from seaglint.studies.sweep.sweep_case import CaseFailure, SweepSettings, compute_case, require_places, require_shape

Shapes = tuple[tuple[str, tuple[int, ...], str], ...]  #: Names of arrays, with the shape and the type of those of one case.


def lazy_arrays(settings: SweepSettings, compute: Callable[[Scenario], CaseResult]) -> tuple[CaseResult, dict[str, Any]]:
    """Return the first case, and Dask arrays over all cases by name, with a piece for each case.

    Raises
    ------
    BackendError
        Dask is not installed.
    SeaglintError
        A first case that cannot be computed.
    """
    dask, array = optional("dask", "a lazy sweep"), optional("dask.array", "a lazy sweep")
    outcome = compute_case(replace(settings, keep_going=False), compute, 0)
    assert isinstance(outcome, CaseResult)  # a failure was raised
    fixed = {name: one for name, one in outcome.coordinates.items() if one.dims == (name,)}
    named = {name: one.values for name, one in (outcome.coordinates | outcome.variables).items() if name not in fixed}
    places = {name: one.values for name, one in fixed.items()}
    shapes = tuple((name, values.shape, _kind(values, settings.keep_going).str) for name, values in named.items())
    count, shape = settings.plan.count, settings.plan.shape
    cases = [dask.delayed(_case, pure=False)(settings, number, shapes, places) for number in range(count)]
    ones = (1,) * len(shape)
    arrays = {
        name: _joined(array, [array.from_delayed(case[name], (*ones, *size), dtype=np.dtype(kind)) for case in cases], shape)
        for name, size, kind in shapes
    }
    return outcome, {**arrays, **{name: one.values for name, one in fixed.items()}}


def _kind(values: NDArray[Any], keep_going: bool) -> np.dtype[Any]:
    """Return the type of an array over all cases: whole numbers have none that is missing."""
    return np.dtype(np.float64) if keep_going and values.dtype.kind in "biu" else values.dtype


def _joined(array: Any, parts: list[Any], shape: tuple[int, ...]) -> Any:
    """Return arrays of one case each as one array over all of them."""
    for axis in range(len(shape) - 1, -1, -1):
        size = shape[axis]
        parts = [array.concatenate(parts[first : first + size], axis=axis) for first in range(0, len(parts), size)]
    return parts[0]


def _case(settings: SweepSettings, number: int, shapes: Shapes, places: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return the arrays of a case, with a dimension of one value for each key."""
    ones = (1,) * len(settings.plan.shape)
    with thread_limit(settings.threads):
        outcome = compute_case(settings, computer(settings.what, settings.at), number)
    if isinstance(outcome, CaseFailure):
        return {name: np.full((*ones, *size), np.nan if np.dtype(kind).kind in "fc" else 0, dtype=kind) for name, size, kind in shapes}
    arrays = outcome.coordinates | outcome.variables
    for name, size, _ in shapes:
        require_shape(settings, number, name, arrays.get(name), size)
    for name, values in places.items():
        require_places(settings, number, name, arrays.get(name), values)
    return {name: arrays[name].values.reshape(*ones, *size).astype(kind, copy=False) for name, size, kind in shapes}
