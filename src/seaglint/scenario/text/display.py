"""HTML of a scenario for notebooks: keys that differ from the defaults, and a compass.

The compass is SVG with wind, Sun and view at their azimuths, clockwise from north.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from pydantic import BaseModel

from seaglint.base.errors import ScenarioError
from seaglint.base.representation import ABSENT, as_text, card, notes, table
from seaglint.scenario.keys import key_at
from seaglint.scenario.model import Scenario
from seaglint.scenario.moon import MoonPosition, moon_position
from seaglint.scenario.sun import SunPosition, sun_position
from seaglint.scenario.text.toml_writing import differing

VIEW, WIND, SUN = "#3b9dd8", "#35a37a", "#e0a100"  #: Colours that stand out from a light and from a dark page.

_SIZE: Final = 240.0
_RADIUS: Final = 88.0


def _at(azimuth_deg: float, radius: float) -> str:
    """Return the point at an azimuth: north up, east to the right."""
    # SVG's y axis points down, so north is a smaller y.
    angle, middle = math.radians(azimuth_deg), 0.5 * _SIZE
    return f"{middle + radius * math.sin(angle):.1f},{middle - radius * math.cos(angle):.1f}"


def compass(scenario: Scenario, sun: SunPosition | None, azimuth_deg: float | None = None) -> str:
    """Return a compass with the wind, the Sun and the field of view as SVG.

    The Sun is on the rim at the horizon and in the centre at the zenith; below the horizon it is a ring outside. The arrow of the wind
    points to where the wind blows.

    Parameters
    ----------
    scenario : Scenario
        Its wind and sensor.
    sun : SunPosition or None
        The Sun; None draws none.
    azimuth_deg : float, optional
        Azimuth of the view's centre, where a platform turns it [deg]; the sensor's by default.
    """
    ticks = "".join(f'<path d="M{_at(a, _RADIUS)}L{_at(a, _RADIUS + (6 if a % 90 else 9))}"/>' for a in range(0, 360, 10))
    names = "".join(
        f'<text x="{place.split(",")[0]}" y="{place.split(",")[1]}" text-anchor="middle" dominant-baseline="central" '
        f'font-weight="{600 if len(name) == 1 else 400}">{name}</text>'
        for name, place in ((text, _at(a, _RADIUS + 20)) for a, text in _NAMES.items())
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_SIZE:g} {_SIZE:g}" width="{_SIZE:g}" height="{_SIZE:g}" role="img" '
        f'aria-label="compass: north up, azimuths clockwise" font-family="system-ui, sans-serif" font-size="11" fill="currentColor">'
        f'<g fill="none" stroke="currentColor" stroke-opacity=".45"><circle cx="{_SIZE / 2:g}" cy="{_SIZE / 2:g}" r="{_RADIUS:g}"/>'
        f'<g stroke-opacity=".2"><circle cx="{_SIZE / 2:g}" cy="{_SIZE / 2:g}" r="{_RADIUS / 3:.1f}"/>'
        f'<circle cx="{_SIZE / 2:g}" cy="{_SIZE / 2:g}" r="{_RADIUS * 2 / 3:.1f}"/></g>{ticks}</g>{names}'
        f"{_view(scenario, azimuth_deg)}{_wind(scenario)}{_sun_mark(sun)}</svg>"
    )


_NAMES: Final = {0: "N", 45: "NE", 90: "E", 135: "SE", 180: "S", 225: "SW", 270: "W", 315: "NW"}


def _view(scenario: Scenario, azimuth_deg: float | None) -> str:
    middle = scenario.sensor.azimuth_deg if azimuth_deg is None else azimuth_deg
    width = scenario.sensor.fov_deg[0]
    title = f"<title>view towards {middle % 360:.1f}°, {width:g}° wide</title>"
    if width >= 359.9:
        return f'<circle cx="{_SIZE / 2:g}" cy="{_SIZE / 2:g}" r="{_RADIUS:g}" fill="{VIEW}" fill-opacity=".25">{title}</circle>'
    left, right = _at(middle - width / 2, _RADIUS), _at(middle + width / 2, _RADIUS)
    arc = f"A{_RADIUS:g},{_RADIUS:g} 0 {int(width > 180)} 1 {right}"
    return (
        f'<path class="view" d="M{_SIZE / 2:g},{_SIZE / 2:g}L{left}{arc}Z" fill="{VIEW}" fill-opacity=".35" stroke="{VIEW}">{title}</path>'
    )


def _wind(scenario: Scenario) -> str:
    speed, azimuth = scenario.wind.speed_m_s, scenario.wind.from_deg
    title = f"<title>wind of {speed:.1f} m/s from {azimuth % 360:.1f}°</title>"
    # The arrow begins at the rim on the windward side and points to the centre; its length grows with the speed.
    begin, tip = _RADIUS - 2, _RADIUS - 2 - (20 + 2.2 * min(speed, 20))
    barbs = f"M{_at(azimuth, begin)}L{_at(azimuth, tip)}"
    # the head: two short lines back from the tip, on both sides
    side = math.degrees(math.atan2(6.0, tip + 10))
    head = "".join(f"M{_at(azimuth, tip)}L{_at(azimuth + sign * side, math.hypot(6.0, tip + 10))}" for sign in (-1, 1))
    return f'<path class="wind" d="{barbs}{head}" fill="none" stroke="{WIND}" stroke-width="3" stroke-linecap="round">{title}</path>'


def _sun_mark(sun: SunPosition | None) -> str:
    if sun is None:
        return ""
    zenith, azimuth = math.degrees(sun.zenith), math.degrees(sun.azimuth)
    up = zenith <= 90.0
    # The distance from the centre is proportional to the zenith angle.
    x, y = _at(azimuth, _RADIUS * zenith / 90.0 if up else _RADIUS + 4).split(",")
    look = f'fill="{SUN}"' if up else 'fill="none"'
    title = f"<title>Sun at {azimuth % 360:.1f}°, zenith angle {zenith:.1f}°</title>"
    return f'<circle class="sun" cx="{x}" cy="{y}" r="7" {look} stroke="{SUN}" stroke-width="2">{title}</circle>'


def scenario_html(scenario: Scenario) -> str:
    """Return the HTML of a scenario: a table of keys that differ from the defaults, and a compass of wind, Sun and view."""
    rows = [(key, value, _default(key)) for key, value in _flat(differing(scenario), "")]
    body = table(("key", "value", "default"), rows) if rows else notes(["all values are the defaults"])
    sun, moon = _sun(scenario), _moon(scenario)
    facts = [f"wind {scenario.wind.speed_m_s:.1f} m/s from {scenario.wind.from_deg:.1f}°"]
    facts.append(f"view towards {scenario.sensor.azimuth_deg:.1f}°, elevation {scenario.sensor.elevation_deg:.1f}°")
    if sun is not None:
        facts.append(f"Sun: zenith angle {_degrees(sun.zenith)}, azimuth {_degrees(sun.azimuth)}")
    if moon is not None:
        facts.append(
            f"Moon: zenith angle {_degrees(moon.zenith)}, azimuth {_degrees(moon.azimuth)}, phase angle {_degrees(moon.phase)}, "
            f"{100.0 * moon.lit_share:.0f} % lit"
        )
    return card("seaglint scenario", body, compass(scenario, sun) + notes(facts))


def _sun(scenario: Scenario) -> SunPosition | None:
    try:
        return sun_position(scenario)
    except ScenarioError:  # [likelihood] alone: time and place vary
        return None


def _moon(scenario: Scenario) -> MoonPosition | None:
    try:
        return moon_position(scenario)
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
