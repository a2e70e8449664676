"""A sensor's track on the waves, where its platform floats, at heights that the air covers."""

from __future__ import annotations

import numpy as np

from seaglint.base.errors import ScenarioError
from seaglint.base.limits import LOWTRAN_HEIGHTS, PROFILE_HEIGHTS
from seaglint.imaging.camera.pose import Track
from seaglint.objects.floating import Swell
from seaglint.objects.floating_track import MOST_SAMPLES, FloatingTrack
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.sensor_table import HIGHEST_SENSOR
from seaglint.sea.field import WaveField


def afloat(scenario: Scenario, floating: Track, waves: WaveField | None, where: str) -> Track:
    """The track itself, or afloat.

    Raises
    ------
    ScenarioError
        Heights that leave the atmosphere's; ``where`` begins the text.
    """
    platform, sensor = scenario.platform, scenario.sensor
    if platform is not None and platform.floats and waves is not None:
        width, length = platform.waterline_m
        heading = None if platform.heading_deg is None else float(np.radians(platform.heading_deg))
        times = np.linspace(0.0, (sensor.frames - 1) / sensor.frame_rate_hz, min(sensor.frames, MOST_SAMPLES))
        floating = FloatingTrack.create(floating, Swell.of(waves, (0.5 * width, 0.5 * length)), (width, length), heading, times)
    covered = {"table": PROFILE_HEIGHTS, "lowtran": PROFILE_HEIGHTS, "lowtran-fortran": LOWTRAN_HEIGHTS}
    lowest, highest = covered.get(scenario.atmosphere.source, (0.0, HIGHEST_SENSOR))
    if floating.lowest < lowest or floating.highest > highest:
        raise ScenarioError(
            f"{where}heights of {floating.lowest:g} to {floating.highest:g} m leave those of "
            f"atmosphere.source = '{scenario.atmosphere.source}'; allowed: {lowest:g} to {highest:g} m"
        )
    return floating
