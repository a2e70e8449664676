"""Computation of a sweep: one quantity of every case, assembled into a labelled dataset.

A case that fails is left without values if the sweep continues. With ``lazy`` cases are computed when their values are read, with Dask.
"""

from __future__ import annotations

import json
import logging
import pickle
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.errors import BackendError, DataError, ScenarioError, SeaglintError, one_line
from seaglint.base.free_form import Attributes
from seaglint.base.optional import optional
from seaglint.base.representation import duration, size_text
from seaglint.base.threads import thread_limit
from seaglint.cluster.job import Job, Workers, record_of
from seaglint.scenario.model import Scenario
from seaglint.store.netcdf import labelled, plain_attributes
from seaglint.store.provenance import provenance
from seaglint.studies.sequence.memory import require_room
from seaglint.studies.study_requests import MOST_CASES
from seaglint.studies.sweep.case_results import CaseResult, NamedArray, computer, forget_views
from seaglint.studies.sweep.sweep_plan import SweepPlan, ViewAngles, chunks

if TYPE_CHECKING:
    import xarray as xr


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
    """Return the result of a case, or its failure if the sweep continues after failures.

    Raises
    ------
    SeaglintError
        A scenario that is refused, or an error of the user's function; the message names the case.
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
    """Refuse an array of a case with other shape or dimensions than in the first case.

    Raises
    ------
    DataError
        The message names the case.
    """
    if array is None or array.values.shape != shape or (dims is not None and array.dims != dims):
        state = "missing" if array is None else f"of the shape {array.values.shape}"
        raise DataError(
            f"sweep, {settings.plan.named(number)}: {name} is {state} and that of the first case of {shape}; vary only what leaves the "
            "picture's size the same"
        )


def require_places(settings: SweepSettings, number: int, name: str, array: NamedArray | None, places: NDArray[Any]) -> None:
    """Refuse a coordinate of a case that differs from the first case.

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
    # Each case is a block of one value along every swept key.
    ones = (1,) * len(shape)
    arrays = {
        name: _joined(array, [array.from_delayed(case[name], (*ones, *size), dtype=np.dtype(kind)) for case in cases], shape)
        for name, size, kind in shapes
    }
    return outcome, {**arrays, **{name: one.values for name, one in fixed.items()}}


def _kind(values: NDArray[Any], keep_going: bool) -> np.dtype[Any]:
    """Return the type of an array over all cases: float for whole numbers that may be missing."""
    return np.dtype(np.float64) if keep_going and values.dtype.kind in "biu" else values.dtype


def _joined(array: Any, parts: list[Any], shape: tuple[int, ...]) -> Any:
    """Return arrays of one case each as one array over all of them."""
    # Blocks are joined along the last key first, because it varies fastest in the order of the cases.
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


log = logging.getLogger(__name__)

_BAND: Final = ("band_wavelength_um", "band_response")  #: Attributes that hold for the whole dataset where all cases have the same.

_MOST_NAMED: Final = 3  #: Failures that are named in an attribute or a message.


def sweep_worker(settings: SweepSettings) -> Callable[[tuple[int, ...]], list[tuple[int, Outcome]]]:
    """Return the function that computes some cases."""
    compute = computer(settings.what, settings.at)
    forget_views()

    def work(numbers: tuple[int, ...]) -> list[tuple[int, Outcome]]:
        out: list[tuple[int, Outcome]] = []
        for number in numbers:
            try:
                out.append((number, compute_case(settings, compute, number)))
            except SeaglintError as error:  # the failure would repeat in another worker
                return [*out, (number, CaseFailure(line_of(error)))]
        return out

    return work


def sweep(
    source: Scenario | str | Path | Mapping[str, Any],
    vary: Mapping[str, Any],
    *,
    what: str | Callable[[Scenario], Any] = "mean",
    at: Mapping[str, Any] | ViewAngles | None = None,
    workers: Workers | None = None,
    threads: int | None = None,
    keep_going: bool = False,
    most_cases: int = MOST_CASES,
    lazy: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compute one quantity over every combination of some values of a scenario's keys.

    Parameters
    ----------
    source : Scenario, path or mapping
        Scenario, its file, or its tables.
    vary : mapping
        Values by dotted key.
    what : str or callable
        Quantity; see ``seaglint.studies.sweep.case_results``.
    at : mapping, optional
        View angles; see ``ViewAngles``.
    workers : Workers, optional
        Workers that compute; this process by default.
    threads : int, optional
        Processor threads of the kernels.
    keep_going : bool
        Leave cases that fail without values.
    most_cases : int
        Largest number of cases.
    lazy : bool
        Compute a case when its values are read, with Dask.
    progress : callable, optional
        Called with (cases done, cases in all).

    Returns
    -------
    xarray.Dataset
        Dimensions are the swept keys, then the dimensions of the quantity.

    Raises
    ------
    SeaglintError
        A key that does not exist, too many cases, too little memory, or a case that fails.
    """
    angles = ViewAngles.of(at)
    if threads is None and angles is not None:
        threads = 1  # lines of sight are few: threads that wait for each other take more time than they save
    settings = SweepSettings(SweepPlan.of(source, vary), what, angles, keep_going, threads)
    compute = computer(what, settings.at)
    forget_views()
    with thread_limit(threads):
        if not keep_going:
            settings.plan.check()
        require_cases(settings, compute, most_cases)
        if lazy:
            template, values = lazy_arrays(settings, compute)
            return _dataset(settings, template, values, {})
        collected = CollectedCases(settings)
        for number, outcome in _outcomes(settings, compute, workers, progress):
            collected.add(number, outcome)
    return collected.dataset()


def require_cases(settings: SweepSettings, compute: Callable[[Scenario], CaseResult], most: int) -> None:
    """Refuse more cases than allowed; the message estimates their time and memory.

    Raises
    ------
    DataError
        With an estimate from the first and the last case.
    """
    count = settings.plan.count
    if count <= most:
        return
    seconds, size = 0.0, 0
    try:
        # The second timing counts, because the first case also compiles kernels and reads files.
        for number in (0, count - 1):  # the first one also compiles and prepares
            start = time.perf_counter()
            size = compute(settings.plan.scenario(number)).size
            seconds = time.perf_counter() - start
        cost = f", about {duration(count * seconds)} of computation on this machine and {size_text(count * size)} of memory"
    except Exception:  # the number is reason enough
        cost = ""
    raise DataError(
        f"a sweep of {' x '.join(map(str, settings.plan.shape))} = {count} cases{cost}: more than the {most} that are allowed; give fewer "
        f"values, or allow them with most_cases = {count}"
    )


def _can_be_sent(function: Callable[[Scenario], Any]) -> bool:
    """Return true for a function that other processes can import, unlike a function of a script, a notebook or another function."""
    if getattr(function, "__module__", None) == "__main__":
        return False
    try:
        pickle.dumps(function)
    except (AttributeError, TypeError, pickle.PicklingError):
        return False
    return True


def _outcomes(
    settings: SweepSettings, compute: Callable[[Scenario], CaseResult], workers: Workers | None, progress: Progress | None
) -> Iterator[tuple[int, Outcome]]:
    """Yield numbers and outcomes of all cases as they finish."""
    order, report = settings.plan.order(), progress or (lambda done, total: None)
    report(0, len(order))
    if workers is None:
        for done, number in enumerate(order, start=1):
            yield number, compute_case(settings, compute, number)
            report(done, len(order))
        return
    # Workers receive neighbouring cases, which share their preparation.
    units, done = chunks(order, settings.plan.together(), workers.count), 0
    try:
        with workers.map(Job(sweep_worker, settings), units) as outcomes:
            for outcome in outcomes:
                for number, result in record_of(outcome):
                    if isinstance(result, CaseFailure) and not settings.keep_going:
                        raise DataError(result.text)
                    yield number, result
                    done += 1
                report(done, len(order))
    except (AttributeError, ImportError, TypeError, pickle.PicklingError) as error:
        # Pickle raises several types of errors for a function that cannot be sent.
        if callable(settings.what) and (isinstance(error, ImportError) or not _can_be_sent(settings.what)):
            raise BackendError(
                f"the function {settings.title} cannot be sent to other processes, which cannot import it; define it in a module, in the "
                "working directory or installed, or leave workers out"
            ) from error
        raise


@dataclass(eq=False)
class CollectedCases:
    """Results of cases as they come in, in arrays over all cases."""

    settings: SweepSettings
    first: CaseResult | None = None
    arrays: dict[str, NDArray[Any]] = field(default_factory=dict)
    failures: dict[int, str] = field(default_factory=dict)
    band: Attributes | None = None

    def add(self, number: int, outcome: Outcome) -> None:
        """Add the outcome of a case.

        Raises
        ------
        DataError
            A result with other arrays than the first one.
        """
        if isinstance(outcome, CaseFailure):
            self.failures[number] = outcome.text
            return
        if self.first is None:
            self._begin(outcome)
        assert self.first is not None
        # The band is an attribute of the whole only if all cases share it.
        band: Attributes = {name: outcome.attributes[name] for name in _BAND if name in outcome.attributes}
        self.band = band if self.band is None or self.band == band else {}
        arrays, expected = _all(outcome), _all(self.first)
        if arrays.keys() != expected.keys():
            other = sorted(arrays.keys() ^ expected.keys())
            raise DataError(
                f"sweep, {self.settings.plan.named(number)}: has other variables than the first case ({', '.join(other)}); "
                "vary only what leaves the variables the same"
            )
        for name, array in arrays.items():
            require_shape(self.settings, number, name, array, expected[name].values.shape, expected[name].dims)
            if array.dims == (name,):
                require_places(self.settings, number, name, array, expected[name].values)
            self.arrays[name][number] = array.values

    def _begin(self, first: CaseResult) -> None:
        count = self.settings.plan.count
        require_room(
            count * first.size, f"the result of {count} cases", "give fewer values or pixels, or sweep in parts (in Python also lazy=True)"
        )
        self.first = first
        for name, array in _all(first).items():
            values = array.values
            # Whole numbers, booleans and texts cannot be missing, so their type changes if cases may fail.
            kind = values.dtype if values.dtype.kind in "fcmM" or not self.settings.keep_going else np.dtype(np.float64)
            if values.dtype.kind in "UO":
                kind = np.dtype(object)
            self.arrays[name] = np.full((count, *values.shape), _missing(kind), dtype=kind)

    def dataset(self) -> xr.Dataset:
        """Return the finished dataset.

        Raises
        ------
        DataError
            Every case failed.
        """
        if self.first is None:
            raise DataError(f"all {self.settings.plan.count} cases failed, the first with: {next(iter(self.failures.values()))}")
        shape = self.settings.plan.shape
        values = {name: array.reshape(*shape, *array.shape[1:]) for name, array in self.arrays.items()}
        result = _dataset(self.settings, self.first, values, self.failures, self.band)
        if idle := self._without_effect(values):
            log.warning("sweep: %s changes nothing of %s: the values are the same all along it", " and ".join(idle), self.settings.title)
            result.attrs["without_effect"] = ", ".join(idle)
        return result

    def _without_effect(self, values: Mapping[str, NDArray[Any]]) -> list[str]:
        """Return the swept keys along which all numbers are the same: the quantity does not depend on them."""
        assert self.first is not None
        numbers = [values[name] for name in self.first.variables if values[name].dtype.kind in "fciu"]
        return [
            name
            for axis, name in enumerate([key.name for key in self.settings.plan.keys])
            if self.settings.plan.shape[axis] > 1 and numbers and all(_same_along(array, axis) for array in numbers)
        ]


def _same_along(array: NDArray[Any], axis: int) -> bool:
    """Return true where all values along an axis are the same; missing ones are."""
    first = np.take(array, [0], axis=axis)
    # NaN is unequal to itself; two missing values count as equal.
    return bool(np.all((array == first) | ((array != array) & (first != first))))


def _missing(kind: np.dtype[Any]) -> Any:
    return np.nan if kind.kind in "fc" else np.array("NaT", kind) if kind.kind in "mM" else "" if kind.kind == "O" else 0


def _all(result: CaseResult) -> dict[str, NamedArray]:
    return {**result.coordinates, **result.variables}


def _dataset(
    settings: SweepSettings, first: CaseResult, values: Mapping[str, Any], failures: Mapping[int, str], band: Attributes | None = None
) -> xr.Dataset:
    """Return arrays over all cases as a labelled dataset; ``values`` are (keys..., dims...) by name."""
    import xarray as xr

    plan = settings.plan
    names = tuple(key.name for key in plan.keys)
    clash = sorted(set(names) & {*_all(first), *(dim for array in _all(first).values() for dim in array.dims)})
    if clash:
        raise DataError(f"{clash[0]} is a swept key and a name in the result too; give the result's another name")
    coords: dict[str, Any] = {key.name: (key.name, key.coordinate, key.attributes) for key in plan.keys}
    for name, array in first.coordinates.items():
        coords[name] = _coordinate(plan, name, array, values[name], failures)
    data = {name: ((*names, *array.dims), values[name], array.attributes) for name, array in first.variables.items()}
    base = plan.base_scenario()
    attributes = provenance(
        f"Sweep: {settings.title}",
        base.model_dump_json(exclude_none=True),
        base.seed,
        sweep=json.dumps({key.name: list(key.values) for key in plan.keys}, default=str),
        what=settings.title,
        notes=first.attributes.get("notes"),
        **(band or {}),
    )
    if failures:
        attributes |= {"failed_cases": len(failures), "failures": "; ".join(list(failures.values())[:_MOST_NAMED])}
    dataset = xr.Dataset(data, coords=coords, attrs=plain_attributes(attributes))
    return dataset if callable(settings.what) else labelled(dataset)  # names of a user's function are its own


def _coordinate(plan: SweepPlan, array_name: str, array: NamedArray, values: Any, failures: Mapping[int, str]) -> Any:
    """Return a coordinate of the quantity: without the swept keys where it is the same in all cases."""
    names = tuple(key.name for key in plan.keys)
    if array.dims == (array_name,):
        return array.dims, array.values, array.attributes
    if not isinstance(values, np.ndarray):  # lazy
        return (*names, *array.dims), values, array.attributes
    # Failed cases have no coordinate and are left out of the comparison.
    flat = values.reshape(plan.count, -1)
    good = flat[[number for number in range(plan.count) if number not in failures]] if failures else flat
    if all(np.array_equal(row, good[0]) for row in good[1:]):
        return array.dims, good[0].reshape(array.values.shape), array.attributes
    if array.dims == ():
        return names, flat.reshape(plan.shape), array.attributes
    return (*names, *array.dims), values, array.attributes
