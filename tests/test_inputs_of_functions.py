"""First inputs of every public function: a scenario is a path, a Scenario or its tables; anything else is an error of one line."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd
import pytest

import seaglint as sg
from seaglint.base.errors import DataError, ScenarioError, SeaglintError

SCENE = {
    "sensor": {"pixels": [8, 4], "fov_deg": [4, 2], "elevation_deg": -4, "height_m": 20, "frames": 1},
    "sea": {"resolve_waves": False},
    "band": {"min_um": 8, "max_um": 12},
}


def functions(place: Any, above: str = "") -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yield the public functions by their names."""
    for name in place.__all__:
        found = getattr(place, name)
        if inspect.isfunction(found):
            yield f"{above}{name}", found
        elif inspect.ismodule(found):
            yield from functions(found, f"{name}.")


FUNCTIONS = dict(functions(sg))


def first(function: Callable[..., Any], words: str) -> str | None:
    """Return the name of the first parameter whose type has these words."""
    parameters = inspect.signature(function).parameters.values()
    return next((one.name for one in parameters if words in str(one.annotation) and one.default is one.empty), None)


def scenario_parameter(function: Callable[..., Any]) -> str | None:
    return first(function, "SceneInput") or first(function, "Scenario | str | Path | Mapping")


SCENARIOS = {name: parameter for name, function in FUNCTIONS.items() if (parameter := scenario_parameter(function)) is not None}

#: What the other parameters without a default get.
OTHERS: dict[str, Any] = {
    "vary": {"wind.speed_m_s": [5.0]},
    "zenith_deg": [40.0],
    "bands": ["8-12"],
    "radiance": np.full((1, 4, 8), 1.0),
    "measured": "nothing.csv",
    "model": "nothing.nc",
    "output": "nothing/there.zarr",
    "source": "nothing.toml",
}

FOREIGN = {
    "None": None,
    "int": 3,
    "float": 1.5,
    "list": [1],
    "DataFrame": pd.DataFrame({"a": [1]}),
    "array": np.zeros(3),
    "bytes": b"x",
    "set": {1},
    "class": object,
}


def called(name: str, parameter: str, value: Any) -> Any:
    parameters = inspect.signature(FUNCTIONS[name]).parameters.values()
    needed = {one.name: OTHERS.get(one.name, "x") for one in parameters if one.default is one.empty and one.kind is not one.VAR_KEYWORD}
    return FUNCTIONS[name](**needed | {parameter: value})


def test_the_functions_that_take_scenarios() -> None:
    expected = {"mean", "image", "sweep", "likelihood", "render", "frames", "sense", "sensor", "load", "export_sea", "compare_spectrum"}
    expected |= {"detect", "detect_scene", "detect_range", "detect_design", "atmosphere.sky", "atmosphere.export", "texture.place"}
    assert expected <= SCENARIOS.keys()


@pytest.mark.parametrize("kind", FOREIGN)
@pytest.mark.parametrize("name", sorted(SCENARIOS.keys() - {"detect"}))
def test_what_is_no_scenario(name: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ScenarioError, match=r"is of type .*; give the path of a TOML file, its tables in a mapping") as caught:
        called(name, SCENARIOS[name], FOREIGN[kind])
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("tables", [{"sun": {"elevation_deg": 10}}, {"sun": 3}, {1: 2}, {None: 1}, {"a": SCENE}], ids=repr)
@pytest.mark.parametrize("name", SCENARIOS)
def test_tables_with_mistakes(name: str, tables: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ScenarioError) as caught:
        called(name, SCENARIOS[name], tables)
    assert str(caught.value).startswith("scenario: ")
    assert "\n" not in str(caught.value)


QUICK: dict[str, Callable[[Any], Any]] = {
    "load": sg.load,
    "mean": lambda scene: sg.mean(scene).radiance,
    "image": lambda scene: sg.image(scene).radiance,
    "sky": lambda scene: sg.atmosphere.sky(scene, zenith_deg=[40.0]),
    "sweep": lambda scene: sg.sweep(scene, {"wind.speed_m_s": [5.0]}, at={"view_zenith_deg": [60]}).radiance,
}


@pytest.mark.parametrize("name", QUICK)
def test_a_path_a_scenario_and_tables_are_the_same(name: str, tmp_path: Path) -> None:
    scene = sg.load(SCENE)
    path = tmp_path / "scene.toml"
    path.write_text(
        "[sensor]\npixels = [8, 4]\nfov_deg = [4, 2]\nelevation_deg = -4\nheight_m = 20\nframes = 1\n[sea]\nresolve_waves = false\n"
        "[band]\nmin_um = 8\nmax_um = 12\n"
    )
    numbers = {"pixels": np.array([8, 4]), "fov_deg": [np.int64(4), np.float32(2)], "frames": np.int64(1), "height_m": np.float32(20)}
    numpy = {**SCENE, "sensor": SCENE["sensor"] | numbers}
    forms = [path, str(path), scene, SCENE, MappingProxyType(SCENE), scene.model_dump(), numpy]
    expected = QUICK[name](scene)
    for form in forms[:2] + forms[3:]:
        found = QUICK[name](form)
        assert found == expected if name == "load" else found.equals(expected)


PATHS = {
    "info": "path",
    "init": "output",
    "labels": "run",
    "dataset": "source",
    "ensemble": "source",
    "texture.sample": "model",
    "weather.info": "table",
    "weather.build": "sources",
    "atmosphere.read": "files",
}


# For a list of paths a DataFrame is the list of its columns' names.
LISTS = ("weather.build", "atmosphere.read")
PAIRS = [(name, kind) for name in PATHS for kind in FOREIGN if name not in LISTS or kind != "DataFrame"]


@pytest.mark.parametrize(("name", "kind"), PAIRS)
def test_what_is_no_path(name: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(DataError, match=rf"^{PATHS[name]}(\[0\])? = .* is of type .*; give a path$") as caught:
        called(name, PATHS[name], FOREIGN[kind])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", sorted(FOREIGN.keys() - {"DataFrame"}))
@pytest.mark.parametrize("name", ["mean", "atmosphere", "emissivity", "scattered"])
def test_what_are_no_cases(name: str, kind: str) -> None:
    with pytest.raises(DataError, match=r"cases are of type .*; give a CSV file, a mapping of columns, a DataFrame or a Dataset"):
        called(f"evaluate.{name}", "cases", FOREIGN[kind])


@pytest.mark.parametrize("bands", [None, 3, [3], [(1,)], ["x", None], {"a": 1}])
def test_what_are_no_bands(bands: Any) -> None:
    with pytest.raises(SeaglintError) as caught:
        sg.evaluate.mean({"a": [1]}, bands=bands)
    assert "\n" not in str(caught.value)
