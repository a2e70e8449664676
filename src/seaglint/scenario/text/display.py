"""HTML of a scenario for notebooks: keys that differ from the defaults, and the compass."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from seaglint.base.errors import ScenarioError
from seaglint.base.representation import ABSENT, as_text, card, notes, table
from seaglint.scenario.keys import key_at
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import SunPosition, sun_position
from seaglint.scenario.text.compass import compass
from seaglint.scenario.text.write import differing


def scenario_html(scenario: Scenario) -> str:
    """Return the HTML of a scenario: a table of keys that differ from the defaults, and a compass of wind, Sun and view."""
    rows = [(key, value, _default(key)) for key, value in _flat(differing(scenario), "")]
    body = table(("key", "value", "default"), rows) if rows else notes(["all values are the defaults"])
    sun = _sun(scenario)
    facts = [f"wind {scenario.wind.speed_m_s:g} m/s from {scenario.wind.from_deg:g}°"]
    facts.append(f"view towards {scenario.sensor.azimuth_deg:g}°, elevation {scenario.sensor.elevation_deg:g}°")
    if sun is not None:
        facts.append(f"Sun: zenith angle {_degrees(sun.zenith)}, azimuth {_degrees(sun.azimuth)}")
    return card("seaglint scenario", body, compass(scenario, sun) + notes(facts))


def _sun(scenario: Scenario) -> SunPosition | None:
    try:
        return sun_position(scenario)
    except ScenarioError:  # [likelihood] alone: time and place vary
        return None


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.1f}°"


def _flat(tables: Mapping[str, Any], above: str) -> Iterator[tuple[str, Any]]:
    """Return dotted keys and their values; items of lists by their index."""
    for name, value in tables.items():
        key = f"{above}.{name}".lstrip(".")
        if isinstance(value, Mapping):
            yield from _flat(value, key)
        elif isinstance(value, list | tuple) and value and all(isinstance(item, Mapping) for item in value):
            for place, item in enumerate(value):
                yield from _flat(item, f"{key}[{place}]")
        else:
            yield key, value


def _default(key: str) -> str:
    known = key_at(tuple(part.split("[")[0] for part in key.split(".")))
    if known is None or known.info.is_required() or known.info.default is None or isinstance(known.info.default, BaseModel):
        return ABSENT
    return as_text(known.info.default)


Scenario.html = scenario_html
