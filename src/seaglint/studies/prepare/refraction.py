"""Refraction of a scenario's pictures: standard, or by the profile of its air."""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.air.profile.profile_atmosphere import ProfileAtmosphere
from seaglint.base.errors import ScenarioError
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.bending import Bending
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import atmosphere_table as wanted_air

AIR_AT: Final = 10.0  #: Height of the air whose temperature stands for the lowest air [m].


def bends_by_profile(scenario: Scenario) -> bool:
    """Return true where lines of sight are to bend as in the scenario's own air."""
    air = scenario.atmosphere
    return isinstance(air, wanted_air.TableAtmosphereSettings | wanted_air.LowtranAtmosphere) and air.refraction == "profile"


def bending(scenario: Scenario, view: SeaView) -> Bending | None:
    """Bending of the lines of sight of an upright sensor; None with standard refraction.

    Raises
    ------
    ScenarioError
        Shadows of objects, which are drawn with standard refraction alone.
    """
    if not bends_by_profile(scenario):
        return None
    if scenario.render.object_shadows:
        raise ScenarioError(
            "render.object_shadows = true and atmosphere.refraction = 'profile': shadows on the glint are drawn with standard "
            "refraction alone; leave one of them out"
        )
    assert isinstance(view.atmosphere, ProfileAtmosphere)  # of the two kinds of air above
    profile = view.atmosphere.sums.profile
    lowest = float(np.interp(min(view.sensor_height, AIR_AT), profile.height, profile.temperature))
    return Bending(view.atmosphere.index, view.sensor_height, lowest)


def require_standard_refraction(scenario: Scenario) -> None:
    """Refuse refraction by the profile for cameras that are not upright scans of equal angles at one height.

    Raises
    ------
    ScenarioError
        Saying what it needs.
    """
    if bends_by_profile(scenario):
        raise ScenarioError(
            "atmosphere.refraction = 'profile' is for an upright camera at one height with sensor.projection = 'equal-angle' and "
            "sensor.roll_deg = 0; change the sensor or leave atmosphere.refraction out ('standard')"
        )
