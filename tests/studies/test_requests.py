"""Functions of the studies take what the requests of the commands describe."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Annotated, Any

import pytest

from seaglint.base.parameters import Parameter, documented
from seaglint.studies.likelihood.best_looks import best_looks
from seaglint.studies.likelihood.chance_map import likelihood_map
from seaglint.studies.likelihood.ship_track import along_track
from seaglint.studies.mean.evaluate_cases import evaluate_atmosphere, evaluate_emissivity, evaluate_mean, evaluate_scattered
from seaglint.studies.study_requests import (
    BandsRequest,
    CompareRequest,
    EvaluationRequest,
    FitRequest,
    LikelihoodRequest,
    MeanCasesRequest,
    PlaceRequest,
    SampleRequest,
)

FUNCTIONS: list[tuple[Callable[..., Any], type, set[str]]] = [
    (evaluate_atmosphere, BandsRequest, {"bands", "extrapolate"}),
    (evaluate_emissivity, EvaluationRequest, {"extrapolate"}),
    (evaluate_mean, MeanCasesRequest, {"bands", "extrapolate", "sea_draws"}),
    (evaluate_scattered, BandsRequest, {"bands", "extrapolate"}),
    (likelihood_map, LikelihoodRequest, {"step"}),
    (along_track, LikelihoodRequest, {"track", "forecast", "wind_spread", "cover_spread"}),
    (best_looks, LikelihoodRequest, {"date"}),
]


@pytest.mark.parametrize(("function", "request_type", "shared"), FUNCTIONS, ids=lambda given: getattr(given, "__name__", ""))
def test_names_and_defaults_are_those_of_the_request(function: Callable[..., Any], request_type: type, shared: set[str]) -> None:
    parameters, records = inspect.signature(function).parameters, {field.name: field for field in fields(request_type)}
    assert parameters.keys() & records.keys() == shared
    with_default = {name: parameters[name].default for name in shared if parameters[name].default is not inspect.Parameter.empty}
    assert with_default == {name: records[name].default for name in with_default}
    # each is described once, by the request
    described = (function.__doc__ or "").partition("    Returns\n")[0]
    assert [len(re.findall(rf"^    {name} : ", described, flags=re.MULTILINE)) for name in shared] == [1] * len(shared)


@dataclass(frozen=True)
class _Near:
    distance: Annotated[float, Parameter("to the sea [m]", subject="distance")] = 1.0
    picture: Annotated[Any, Parameter("PNG of the sea", python="Array of radiance.")] = None


@dataclass(frozen=True)
class _Far:
    distance: Annotated[float, Parameter("to the horizon [m]", subject="distance")] = 1.0
    height: Annotated[float, Parameter("height of the sensor [m]; see `distance`")] = 2.0


def test_documentation_takes_the_text_of_the_first_request_and_the_words_of_python() -> None:
    @documented(_Near, _Far)
    def function(distance: float, height: float, picture: Any) -> None:
        """Look.

        {request}
        """

    lines = [line.strip() for line in (function.__doc__ or "").splitlines() if line.strip()]
    assert lines[1:] == [
        *("distance : float", "Distance to the sea [m]."),
        *("height : float", "Height of the sensor [m]; see ``distance``."),
        *("picture : Any", "Array of radiance."),
    ]


@pytest.mark.parametrize("request_type", [FitRequest, CompareRequest, SampleRequest, PlaceRequest])
def test_a_request_that_a_function_takes_describes_its_own_fields(request_type: type) -> None:
    entries = re.findall(r"^    (\w+) : ", request_type.__doc__ or "", flags=re.MULTILINE)
    assert entries == [field.name for field in fields(request_type)]


def test_a_request_is_described_in_the_words_of_python() -> None:
    assert "    size : (int, int)\n        Columns and rows of the picture.\n" in (SampleRequest.__doc__ or "")
    assert "    regions : tuple of str\n" in (CompareRequest.__doc__ or "")
