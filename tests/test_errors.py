"""Errors tell programs what was refused by fields; their text is for people, and nothing reads it."""

from __future__ import annotations

import ast
import pickle
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.lowtran_table import BatchAtmosphere
from seaglint.air.protocol import require_height, require_range, wavenumber_grid
from seaglint.base.conventions import horizon_depression
from seaglint.base.errors import DomainError, Mistake, ScenarioError
from seaglint.facet.emissivity import emissivity
from seaglint.formats.lowtran.deck import Aerosol
from seaglint.formats.lowtran.lowtran_sample import lowtran_atmosphere
from seaglint.imaging.upright_scene import require_above
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance
from seaglint.scenario.load import parse_scenario
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wind_profile import wind_at_height

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize(
    ("ask", "name", "value", "allowed"),
    [
        (lambda: cox_munk_isotropic(21.0), "wind_speed", 21.0, (0.0, 20.0)),
        (lambda: ElfouhailySpectrum(31.0), "wind_speed", 31.0, (0.5, 30.0)),
        (lambda: wind_at_height(10.0, 0.5), "height", 0.5, (1.0, 100.0)),
        (lambda: angular_frequency([1.0, -2.0]), "wavenumber", -2.0, "0 rad/m or more"),
        (lambda: emissivity([0.1, 4.0], cox_munk_isotropic(5.0), hale_querry_sea(), [2500.0]), "view_zenith", 4.0, "0 to below pi rad"),
        (lambda: plan_tiles(ElfouhailySpectrum(7.0), -1.0, 128), "shortest_wave", -1.0, "above 0 m"),
        (lambda: horizon_depression(-3.0), "sensor_height", -3.0, "above 0 m"),
        (lambda: require_height(1.0, 2.0, 9.0, "go up"), "sensor_height", 1.0, (2.0, 9.0)),
        (lambda: require_range([1.0, -2.0]), "range_m", -2.0, "0 m or more"),
        (lambda: wavenumber_grid(5.0, 3.0), "band_um", (5.0, 3.0), "0 < min_um < max_um"),
        (lambda: Band.rectangular(5.0, 3.0), "band_um", (5.0, 3.0), "0 < min_um < max_um"),
        (lambda: planck_wavenumber([2000.0], -3.0), "temperature", -3.0, "above 0 K"),
        (lambda: reflectance([0.5, 1.5], 1.3), "cos_incidence", 1.5, (0.0, 1.0)),
        (lambda: exoatmospheric_irradiance(np.array([2500.0, 1.0])), "wavenumber_cm", 1.0, None),
        (lambda: hale_querry_sea().index([np.nan]), "wavelength_um", None, None),
        (lambda: IsothermalAtmosphere(-1.0, np.array([2000.0])), "temperature", -1.0, "above 0 K"),
        (lambda: BatchAtmosphere.load("tropical", (3.0, 5.0)).path([21.0], [10.0], [0.1]), "wind_speed", 21.0, (0.0, 20.0)),
        (lambda: BatchAtmosphere.load("tropical", (3.0, 7.0)), "band_um", (3.0, 7.0), None),
        (lambda: BatchAtmosphere.load("tropical", (3.0, 5.0)).path([5.0], [1.0], [0.1]), "sensor_height", 1.0, (2.0, 10_000.0)),
        (lambda: Aerosol(wind=25.0).card(), "wind_speed", 25.0, (0.0, 20.0)),
        (lambda: lowtran_atmosphere("tropical", Aerosol(), 30.0, (3.0, 40.0)), "band_um", (3.0, 40.0), (0.2, 28.0)),
        (lambda: require_above(5.0, 4.0, 3.0), "sensor_height", 4.0, "above 5.00 m"),
    ],
)
def test_what_physics_refuses_is_told_by_fields(ask, name, value, allowed):
    with pytest.raises(DomainError) as caught:
        ask()
    assert caught.value.name == name
    if value is not None:
        assert caught.value.value == value
    if allowed is not None:
        assert caught.value.allowed == allowed


@pytest.mark.parametrize(
    ("error", "fields"),
    [
        (DomainError("height = 3 m", name="height", value=3.0, allowed=(5.0, 9.0)), ("name", "value", "allowed")),
        (DomainError("a sea without slopes"), ("name", "value", "allowed")),
        (ScenarioError("x.toml: ...", mistakes=(Mistake("sensor.height_m", 3.0, (5.0, 9.0), "..."),)), ("mistakes",)),
    ],
)
def test_fields_cannot_change_and_travel_between_processes(error, fields):
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    for field in fields:
        assert getattr(again, field) == getattr(error, field)
        with pytest.raises(AttributeError):
            setattr(error, field, None)


@pytest.mark.parametrize(
    ("values", "key", "value", "allowed"),
    [
        ({"sensor": {"height_m": -3}}, "sensor.height_m", -3, "above 0 to 100000 m"),
        ({"sensor": {"height_m": 0.001}}, "sensor.height_m", 0.001, (0.01, 100_000.0)),
        ({"wind": {"speed_m_s": 25}}, "wind.speed_m_s", 25.0, (0.0, 20.0)),
        ({"sensor": {"frames": "many"}}, "sensor.frames", "many", "1 to 10000000"),
        (
            {"sea": {"spectrum": {"kind": "nix"}}},
            "sea.spectrum.kind",
            "nix",
            "'elfouhaily', 'pierson-moskowitz', 'jonswap', 'file', 'wavenumber-file', 'asit-2019', 'radyo-2008', 'systems', 'flat'",
        ),
        ({"mean": {"shadowing": "nix"}}, "mean.shadowing", "nix", "'nested', 'both', 'viewer'"),
        ({"sensor": {"hieght_m": 3}}, "sensor.hieght_m", 3, None),
        ({"sea": {"spectrum": {"kind": "file"}}}, "sea.spectrum.path", None, None),
    ],
)
def test_a_mistake_in_a_scenario_keeps_key_value_and_range(values, key, value, allowed):
    with pytest.raises(ScenarioError) as caught:
        parse_scenario(values, name="my.toml")
    (mistake,) = caught.value.mistakes
    assert (mistake.key, mistake.value, mistake.allowed) == (key, value, allowed)
    assert str(caught.value) == f"my.toml: {mistake.text}"


SEARCHES = {"startswith", "endswith", "removeprefix", "removesuffix", "partition", "rpartition", "find", "index", "replace", "count"}


def searches(handler: ast.ExceptHandler) -> Iterator[str]:
    """Where the text of a caught exception is searched in."""
    spoken = {f"str({handler.name})", f"{handler.name}.args"}
    for node in ast.walk(handler):
        if isinstance(node, ast.Assign) and ast.unparse(node.value) in spoken:
            spoken |= {ast.unparse(target) for target in node.targets}
    for node in ast.walk(handler):
        if isinstance(node, ast.Compare) and spoken & {ast.unparse(side) for side in (node.left, *node.comparators)}:
            yield ast.unparse(node)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            of_text = ast.unparse(node.func.value) in spoken and node.func.attr in SEARCHES
            by_pattern = ast.unparse(node.func.value) == "re" and spoken & {ast.unparse(argument) for argument in node.args}
            if of_text or by_pattern:
                yield ast.unparse(node)
        if isinstance(node, ast.Subscript) and ast.unparse(node.value) == f"{handler.name}.args":
            yield ast.unparse(node)


def test_nothing_searches_in_the_text_of_an_error():
    found = []
    for path in sorted(path for folder in ("src", "tools", "benchmarks", "docs/figures") for path in (ROOT / folder).rglob("*.py")):
        handlers = [n for n in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(n, ast.ExceptHandler) and n.name]
        found += [f"{path.relative_to(ROOT)}: {text}" for handler in handlers for text in searches(handler)]
    assert found == []


def test_such_a_search_would_be_found():
    code = "try:\n    f()\nexcept E as error:\n    text = str(error)\n    if 'height' in text or text.startswith('x') or error.args[0]: g()"
    (handler,) = (node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.ExceptHandler))
    assert len(list(searches(handler))) == 3
