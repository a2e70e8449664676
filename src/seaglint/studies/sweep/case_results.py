"""One quantity of one scenario as named arrays: what a sweep computes for each of its cases."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.scenario.model import Scenario
from seaglint.studies.sweep.case_arrays import CaseResult, NamedArray
from seaglint.studies.sweep.sweep_requests import QUANTITIES

if TYPE_CHECKING:
    from seaglint.studies.sweep.view_angles import ViewAngles


Compute = Callable[[Scenario], CaseResult]  #: Function that computes the result of a scenario.


def computer(what: str | Callable[[Scenario], Any], at: ViewAngles | None) -> Compute:
    """Return the function that computes a quantity.

    Parameters
    ----------
    what : str or callable
        One of :data:`~seaglint.studies.sweep.sweep_requests.QUANTITIES`, or a function of a scenario.
    at : ViewAngles, optional
        View angles instead of the picture's pixels.

    Raises
    ------
    DataError
        An unknown quantity, or view angles for a quantity that has none.
    """
    if callable(what):
        if at is not None:
            raise DataError("at: view angles go with mean and atmosphere; a function of a scenario has its own, leave `at` out")
        return lambda scenario: of_any(what(scenario))
    if what not in QUANTITIES:
        raise DataError(f"what = '{what}' is not one of {', '.join(QUANTITIES)}; give one of them")
    if at is not None and what not in ("mean", "atmosphere"):
        raise DataError(f"at: view angles go with mean and atmosphere, not with what = '{what}'; leave `at` out")
    if at is None:
        return {**_COMPUTERS, "atmosphere": _air_of_rows}[what]
    from seaglint.studies.sweep.mean_at_angles import air_at, mean_at

    chosen = mean_at if what == "mean" else air_at
    return lambda scenario: chosen(scenario, at)


def of_dataset(dataset: Any) -> CaseResult:
    """Return the arrays of an xarray.Dataset."""

    def arrays(part: Mapping[Any, Any]) -> dict[str, NamedArray]:
        return {str(name): NamedArray(tuple(map(str, a.dims)), np.asarray(a.values), dict(a.attrs)) for name, a in part.items()}

    return CaseResult(arrays(dataset.data_vars), arrays(dataset.coords), dict(dataset.attrs))


def of_any(value: Any) -> CaseResult:
    """Return the arrays of what a user's function returned.

    Raises
    ------
    DataError
        A value that is no number, no text, no mapping of them, and nothing of xarray.

    Examples
    --------
    >>> of_any({"mean": 2.0, "name": "a"}).variables["mean"].values.item()
    2.0
    """
    import xarray as xr

    if isinstance(value, xr.Dataset):
        return of_dataset(value)
    if isinstance(value, xr.DataArray):
        return of_dataset(value.to_dataset(name=str(value.name or "value")))
    named = value if isinstance(value, Mapping) else {"value": value}
    out = {}
    for name, item in named.items():
        if isinstance(item, xr.DataArray):
            out[str(name)] = NamedArray(tuple(map(str, item.dims)), np.asarray(item.values), dict(item.attrs))
            continue
        array = np.asarray(item)
        if array.ndim or array.dtype.kind not in "biufcU":
            raise DataError(
                f"the function returned {type(item).__name__} for '{name}'; return a number, numbers by name, or arrays of xarray, which "
                "name their dimensions"
            )
        out[str(name)] = NamedArray((), array)
    return CaseResult(out)


def _mean(scenario: Scenario) -> CaseResult:
    from seaglint.studies.mean.mean_map import mean

    return of_dataset(mean(scenario))


def _image(scenario: Scenario) -> CaseResult:
    from seaglint.studies.sequence.image import image

    return of_dataset(image(scenario, 0.0, scenario.render.layers))


def _sensor(scenario: Scenario) -> CaseResult:
    """Numbers of the data sheet; those of its tables as ``table_name``."""
    from seaglint.studies.mean.sensor_figures import describe_sensor

    out: dict[str, NamedArray] = {}

    def walk(table: Mapping[str, Any], above: str) -> None:
        for name, value in table.items():
            key = f"{above}_{name}" if above else name
            if isinstance(value, Mapping):
                walk(value, key)
            elif value is None or isinstance(value, int | float):
                out[key] = NamedArray((), np.array(np.nan if value is None else value, dtype=np.float64))

    walk(describe_sensor(scenario).sheet.as_dict(), "")
    return CaseResult(out)


def _likelihood(scenario: Scenario) -> CaseResult:
    from seaglint.studies.likelihood.glint_chance import likelihood

    summary = likelihood(scenario).summary()
    rows = summary.results

    def column(values: list[float], long_name: str, units: str = "1") -> NamedArray:
        return NamedArray(("threshold",), np.array(values, dtype=np.float64), {"long_name": long_name, "units": units})

    return CaseResult(
        {
            "probability": column([row.probability for row in rows], summary.quantity),
            "probability_low": column([row.interval[0] for row in rows], "lower end of the 95 % interval of the probability"),
            "probability_high": column([row.interval[1] for row in rows], "upper end of the 95 % interval of the probability"),
            "sun_up": NamedArray((), np.array(summary.sun_up.share), {"long_name": "share of the draws with the Sun up", "units": "1"}),
        },
        {"threshold": column([row.threshold_w_m2_sr for row in rows], "threshold of the radiance of glint", "W m-2 sr-1")},
        {"notes": "\n".join(summary.notes)} if summary.notes else {},
    )


def _air_of_rows(scenario: Scenario) -> CaseResult:
    from seaglint.studies.sweep.mean_at_angles import air_of_rows

    return air_of_rows(scenario)


_COMPUTERS: Final[dict[str, Compute]] = {"mean": _mean, "image": _image, "sensor": _sensor, "likelihood": _likelihood}
