"""Sensors that several tests share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from seaglint.instrument.chain import SensorModel
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.noise import DetectorNoise
from seaglint.instrument.optics import SensorOptics
from seaglint.instrument.photons import Photons
from seaglint.optics.band import Band

QUIET = DetectorNoise(temporal=False, fixed_pattern=False)


def camera(noise: DetectorNoise = QUIET, *, optics: SensorOptics | None = None, **detector) -> SensorModel:
    """A mid-wave camera, F/2, without noise unless told."""
    given = {"pitch": 15e-6, "integration_time": 2e-3, "well_capacity": 7e6, "bit_depth": 14, **detector}
    return SensorModel(Photons(Band.rectangular(3.5, 5.0)), optics or SensorOptics(0.05, 0.1), PhotonPixels(**given), noise, seed=3)


def flat(model: SensorModel, temperature: float, size: int = 128) -> np.ndarray:
    """Radiance of a blackbody that fills the field [(size, size)]."""
    return np.full((size, size), float(model.photons.radiance(temperature)), np.float32)


def reseeded(model: SensorModel, seed: int) -> SensorModel:
    """Another detector of the kind."""
    return replace(model, seed=seed, _patterns={})
