"""Messages on lists: every list key of every table says whether it is no list, which of its values is wrong, or how many it must have."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import pytest
from pydantic import BaseModel

from seaglint.base.errors import ScenarioError
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.keys import Key, fields_of, is_list, list_length, tag_name
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.quantities import Quantity


class ListKey(NamedTuple):
    """List key, its place in messages, and the scenario that holds one value of it."""

    key: Key
    place: str
    scenario: Callable[[Any], dict[str, Any]]


def walk(
    record: type[BaseModel], above: tuple[str, ...], wrap: Callable[[Any], dict[str, Any]], over: tuple[type, ...]
) -> Iterator[ListKey]:
    for key in fields_of(record, above):
        name = key.path[-1]

        def holds(value: Any, name: str = name) -> dict[str, Any]:
            return wrap({name: value})

        listed = is_list(key.info.annotation)
        if listed or list_length(key.info.annotation) is not None:
            yield ListKey(key, dotted(holds(None)), holds)
        for inner in key.records:
            if inner not in over:  # shapes are made of shapes
                tag = {} if len(key.records) == 1 else {tag_name(key.path): inner.model_fields[tag_name(key.path)].default}

                def table(value: Any, holds: Any = holds, tag: Any = tag, listed: bool = listed) -> dict[str, Any]:
                    return holds([tag | value] if listed else tag | value)

                yield from walk(inner, key.path, table, (*over, *key.records))


def dotted(raw: Any) -> str:
    """Return the place of the only key without a tag, as messages write it."""
    path = ""
    while raw is not None:
        if isinstance(raw, list):
            path, raw = f"{path}[0]", raw[0]
        else:
            name = list(raw)[-1]
            path, raw = f"{path}.{name}", raw[name]
    return path.lstrip(".")


LISTS = list(walk(Scenario, (), dict, ()))
BY_PLACE = {f"{one.place}-{number}": one for number, one in enumerate(LISTS)}
NUMBERS = [place for place, one in BY_PLACE.items() if one.key.quantities and not one.key.records]
FIXED = [place for place in NUMBERS if list_length(BY_PLACE[place].key.info.annotation) is not None]


def lines(one: ListKey, value: Any) -> list[str]:
    """Return the lines on a key, without the names of objects."""
    try:
        parse_scenario(one.scenario(value))
    except ScenarioError as error:
        plain = [re.sub(r"^scenario: ", "", re.sub(r" \('[^']*'\)", "", line)) for line in str(error).split("\n")]
        # " = " or "[": another key may begin with the same letters.
        return [line for line in plain if line.startswith((f"{one.place} =", f"{one.place}[", f"{one.place} ("))]
    return []


def inside(quantity: Quantity) -> float:
    low = quantity.ge if quantity.ge is not None else quantity.gt if quantity.gt is not None else 0.0
    high = quantity.le if quantity.le is not None else low + 2.0
    middle = 0.5 * (low + high)
    return int(middle) if quantity.integer else middle


def quantities(one: ListKey, count: int) -> list[Quantity]:
    """Return the quantity of each value; one for all where the list may be of any length."""
    found = one.key.quantities
    return list(found) if len(found) == count else [found[0]] * count


def test_the_lists_that_there_are() -> None:
    found = {".".join(one.key.path) for one in LISTS}
    assert {
        "likelihood.months",
        "likelihood.threshold_w_m2_sr",
        "sensor.pixels",
        "objects",
        "objects.shape.size_m",
        "render.layers",
    } <= found
    assert len(LISTS) > 30


@pytest.mark.parametrize("value", [5, "five", True, {"a": 1}], ids=repr)
@pytest.mark.parametrize("place", BY_PLACE)
def test_what_is_no_list(place: str, value: Any) -> None:
    (line,) = lines(BY_PLACE[place], value)
    assert re.search(r"must be a list (of \d numbers )?in brackets", line), line
    length = list_length(BY_PLACE[place].key.info.annotation)
    assert length is None or f"a list of {length} numbers" in line


@pytest.mark.parametrize("place", BY_PLACE)
def test_empty_lists(place: str) -> None:
    one = BY_PLACE[place]
    found, length = lines(one, []), list_length(one.key.info.annotation)
    if length is not None:
        (line,) = found
        assert f"= [] has 0 values and must have {length}: {one.key.info.description}" in line
    elif found:
        (line,) = found
        assert re.search(r"= \[\] is empty; give 1 or more|= \[\] must hold one spectrum or more", line), line


@pytest.mark.parametrize("place", FIXED)
@pytest.mark.parametrize("more", [-1, 1])
def test_the_wrong_number_of_values(place: str, more: int) -> None:
    one = BY_PLACE[place]
    length = list_length(one.key.info.annotation)
    assert length is not None
    values = [inside(quantity) for quantity in quantities(one, length)]
    (line,) = lines(one, (values * 2)[: length + more])
    assert f"has {length + more} value{'' if length + more == 1 else 's'} and must have {length}" in line


WRONG: dict[str, Callable[[Quantity], Any]] = {
    "below": lambda quantity: -100_000 if quantity.integer else -1e6,
    "text": lambda quantity: "many",
    "a list": lambda quantity: [1],
    "true": lambda quantity: True,
    "infinite": lambda quantity: float("inf"),
}


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("place", NUMBERS)
def test_wrong_values_alone_are_named(place: str, wrong: str) -> None:
    one = BY_PLACE[place]
    length = list_length(one.key.info.annotation) or 3
    values: list[Any] = [inside(quantity) for quantity in quantities(one, length)]
    for number, quantity in enumerate(quantities(one, length)):
        given = WRONG[wrong](quantity)
        (line,) = lines(one, [*values[:number], given, *values[number + 1 :]])
        assert line.startswith(f"{one.place}[{number}] = "), line
        assert quantity.allowed in line
    if list_length(one.key.info.annotation) is None:  # wrong values alone: the list is no empty one
        assert [line.split(" = ")[0] for line in lines(one, [given, given])] == [f"{one.place}[0]", f"{one.place}[1]"]


@pytest.mark.parametrize(
    ("key", "value", "line"),
    [
        ("months", [0], "likelihood.months[0] = 0 is outside the allowed range: 1 to 12"),
        ("months", [13], "likelihood.months[0] = 13 is outside the allowed range: 1 to 12"),
        ("months", [1.5], "likelihood.months[0] = 1.5 is not a whole number (allowed: 1 to 12)"),
        ("months", [], "likelihood.months = [] is empty; give 1 or more (allowed: 1 to 12)"),
        ("threshold_w_m2_sr", [-1], "likelihood.threshold_w_m2_sr[0] = -1 is outside the allowed range: 0 W/m2/sr or more"),
        ("threshold_w_m2_sr", [], "likelihood.threshold_w_m2_sr = [] is empty; give 1 or more (allowed: 0 W/m2/sr or more)"),
    ],
)
def test_lines_of_the_likelihood(key: str, value: list[Any], line: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse_scenario({"likelihood": {key: value}})
    assert str(caught.value) == f"scenario: {line}"
    (mistake,) = caught.value.mistakes
    assert mistake.text == line


def test_tables_in_lists_have_two_brackets() -> None:
    with pytest.raises(
        ScenarioError, match=r"^scenario: platform\.keyframes\[0\] = 3 must be a table \[\[platform\.keyframes\]\]; allowed"
    ):
        parse_scenario({"platform": {"keyframes": [3]}})


ANY: list[Callable[[random.Random], Any]] = [
    lambda draw: draw.choice([None, True, "x", "12 kn", "", {}, [], [1], float("nan"), -1, 0, 1, 7, 1e9, -1e9, 1.5, 10**400]),
    lambda draw: draw.uniform(-100, 400),
]


@pytest.mark.parametrize("place", BY_PLACE)
def test_random_lists(place: str) -> None:
    """Whatever the list holds, no line calls it none, and each line has the place of a value or the number of values."""
    one, draw = BY_PLACE[place], random.Random(place)
    length = list_length(one.key.info.annotation)
    for _ in range(40):
        values = [draw.choice(ANY)(draw) for _ in range(draw.randrange(5))]
        for line in lines(one, values):
            assert "must be a list" not in line, line
            if line.startswith(f"{one.place} = "):
                wrong = length is not None and len(values) != length
                assert wrong or not values or "has" not in line.split("] ")[-1].split()[:1], line


@pytest.mark.parametrize(
    ("tables", "line"),
    [
        ({"vary": [{"key": "wind.speed_m_s", "law": "choice", "values": []}]}, "vary[0].values = [] is empty; give 1 or more"),
        ({"vary": [{"key": "wind.speed_m_s", "law": "choice", "values": 3}]}, "vary[0].values = 3 must be a list in brackets"),
        (
            {"vary": [{"key": "wind.speed_m_s", "law": "choice", "values": [3], "weights": [-1]}]},
            "vary[0].weights[0] = -1 is outside the allowed range: 0 or more",
        ),
        ({"vary": [{"law": "weather", "columns": []}]}, "vary[0].columns = [] is empty; give 1 or more"),
        ({"vary": [{"law": "weather", "columns": [3]}]}, "vary[0].columns[0] = 3 is not allowed: Input should be 'wind_speed_m_s'"),
        ({"dataset": {"split": [0.5, 0.5]}}, "dataset.split = [0.5, 0.5] has 2 values and must have 3"),
        ({"dataset": {"split": [0.5, 0.2, 0.2, 0.1]}}, "dataset.split = [0.5, 0.2, 0.2, 0.1] has 4 values and must have 3"),
        ({"dataset": {"split": 1}}, "dataset.split = 1 must be a list in brackets"),
        ({"dataset": {"split": [0.5, 0.5, "x"]}}, "dataset.split[2] = 'x' is not a number"),
    ],
)
def test_lists_of_ensembles(tables: dict[str, Any], line: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse_ensemble({"ensemble": {"scenes": 2}, "base": {}} | tables)
    assert str(caught.value).startswith(f"ensemble: {line}")
    assert "\n" not in str(caught.value)
