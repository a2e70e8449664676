"""Figures of merit of a scenario's sensor, with the noise budget for the mean of its scene."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from seaglint.base.free_form import JsonObject
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.data_sheet import SensorDataSheet
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import figures
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import TABLES
from seaglint.scenario.records.sensor_table import PhotonDetector
from seaglint.studies.build.sensor_model import platform_rates, sensor_model
from seaglint.studies.mean.air_contrast import AirContrast, air_contrast
from seaglint.studies.mean.mean_map import mean

MEAN_PIXELS = (24, 12)  #: Grid of the mean map from which the scene's mean radiance is taken for a noise budget.


@dataclass(frozen=True)
class SensorDescription:
    """Figures of merit of a scenario's sensor."""

    seed: int  #: Seed of the fixed pattern and the noise.
    sheet: SensorDataSheet  #: Figures of merit, with the noise budget for the mean of the scene.
    scenario: JsonObject  #: Scenario as one table.
    #: Key of the detector that follows from the stated NETD, with its value; empty without a stated NETD.
    from_netd: dict[str, float] = field(default_factory=dict)
    air: AirContrast | None = None  #: Air over the water and its share of a contrast; None if the air's temperature is unknown.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text, as ``seaglint sensor --json`` prints them."""
        air = None if self.air is None else self.air.as_dict()
        return {"seed": self.seed, **self.sheet.as_dict(), "from_netd": self.from_netd, "air": air, "scenario": self.scenario}


def describe_sensor(scenario: Scenario, frequencies: Sequence[float] = ()) -> SensorDescription:
    """Compute figures of merit of a scenario's sensor, with the noise budget for its mean scene and the MTF at frequencies [cycles mrad-1].

    Raises
    ------
    SeaglintError
        No sensor, or a scene that cannot be computed.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> tables = {"optics": {"aperture_m": 0.05, "f_number": 4.0}, "detector": {"pitch_um": 15.0}}
    >>> sheet = describe_sensor(parse_scenario({"sensor": tables})).sheet
    >>> round(sheet.ifov_mrad, 6), sheet.oversampling
    (0.075, 2)
    """
    model = sensor_model(scenario)
    rates = platform_rates(scenario, model.exposure_time)
    return SensorDescription(
        seed=model.seed,
        sheet=figures(model, mean_radiance(scenario), rates, [1e3 * frequency for frequency in frequencies]),
        scenario=json.loads(scenario.model_dump_json(exclude_none=True)),
        from_netd=_from_netd(scenario, model),
        air=air_contrast(scenario),
    )


def _from_netd(scenario: Scenario, model: SensorModel) -> dict[str, float]:
    source = scenario.sensor.detector
    if not isinstance(source, PhotonDetector) or source.netd_k is None or not isinstance(model.detector, PhotonPixels):
        return {}
    if source.integration_time_s is None:
        return {"integration_time_s": model.detector.integration_time}
    return {"read_noise_e": model.detector.read_noise}


def mean_radiance(scenario: Scenario) -> float:
    """Return the mean radiance over the field of view [W m-2 sr-1] from a mean map of few pixels; a moving sensor is at its start."""
    sensor = scenario.sensor
    # The mean needs neither detector nor turned picture; an upright grid of few pixels is fastest.
    plain = sensor.model_copy(
        update={
            **dict.fromkeys(TABLES),
            "projection": "equal-angle",
            "roll_deg": 0.0,
            "pixels": MEAN_PIXELS,
            "elevation_deg": float(np.clip(sensor.elevation_deg, -90.0 + 0.5 * sensor.fov_deg[1], 90.0 - 0.5 * sensor.fov_deg[1])),
        }
    )
    result = mean(scenario.model_copy(update={"sensor": plain, "platform": None}))
    return float(np.nanmean(np.asarray(result["radiance"], np.float64)))
