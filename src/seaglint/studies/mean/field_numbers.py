"""Numbers of a scenario's field of view, from lines of sight spread over it, with their intervals over drawn seas."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.free_form import TableRow
from seaglint.base.threads import single_threaded_algebra
from seaglint.facet.sea_view import SeaView
from seaglint.scenario.model import Scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import slopes
from seaglint.studies.mean.mean_map import components_along
from seaglint.studies.sea_draws import COUNT, HIGH, LOW, SeaUnknown, require_drawn, sea_draws

#: Largest number of rows and of columns whose pixels are computed, spread evenly over the picture: glint varies over degrees.
SIDE: Final = 32

#: Numbers of the field [W m-2 sr-1]: mean radiance and radiance of the brightest pixel at the aperture, and the standard deviation of glint
#: in a pixel, root mean square over the pixels.
FIELD_NUMBERS: Final = ("mean_radiance_W_m2_sr", "brightest_radiance_W_m2_sr", "glint_std_W_m2_sr")


@single_threaded_algebra()
def field_numbers(scenario: Scenario, draws: int) -> TableRow:
    """Return ``FIELD_NUMBERS`` of the sea in view at time 0, and of each the ends of its interval over drawn seas.

    Up to ``SIDE`` rows and columns of pixels are computed at their middles, with standard refraction; without sea in view numbers are None.
    Air, Sun and camera are prepared once: a drawn sea costs its waves and their light alone.
    """
    require_drawn(scenario)
    track, imager = scenario_physics.track(scenario), scenario_physics.imager(scenario)
    pose = track.at(0.0)
    across, down = (np.unique(np.linspace(0, n - 1, min(n, SIDE)).round()) + 0.5 for n in (imager.columns, imager.rows))
    points = (np.tile(across, down.size), np.repeat(down, across.size))
    sight = imager.directions(pose.attitude, *points)
    elevation, azimuth = np.arcsin(np.clip(sight[:, 2], -1.0, 1.0)), np.arctan2(sight[:, 0], sight[:, 1])
    sea = elevation < -horizon_depression(pose.height)
    names = [f"{name}{ending}" for name in FIELD_NUMBERS for ending in ("", f"_{LOW}", f"_{HIGH}")]
    if not sea.any():
        return {**dict.fromkeys(names), COUNT: draws}
    solid_angle = imager.solid_angle(pose.attitude, *points)
    view = scenario_physics.standing_view(scenario, pose.height)

    def numbers(of: Scenario, seen: SeaView) -> FloatArray:
        values = components_along(scenario, seen, scenario_physics.glint_correlation(of))(elevation[sea], azimuth[sea], solid_angle[sea])
        radiance = values[:4].sum(axis=0)
        return np.array([radiance.mean(), radiance.max(), math.sqrt(values[4].mean())])

    own = numbers(scenario, view)
    unknown = SeaUnknown.of([numbers(drawn, replace(view, slopes=slopes(drawn))) for drawn in sea_draws(scenario, draws)])
    ends = zip(own.tolist(), unknown.low.tolist(), unknown.high.tolist(), strict=True)
    return {**dict(zip(names, (value for row in ends for value in row), strict=True)), COUNT: draws}
