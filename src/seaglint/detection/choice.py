"""Detectors by name: those of this package with standard settings, and a user's own."""

from __future__ import annotations

from seaglint.detection.base import Detector, load
from seaglint.detection.cfar import CellAveraging, OrderedStatistic
from seaglint.detection.moving import FrameDifference, RegisteredIntegration
from seaglint.errors import DataError


def named(name: str) -> Detector:
    """Detector with standard settings: ``ca-cfar``, ``os-cfar``, ``os-cfar-exponential``, ``frame-difference``, ``integration``, or
    ``package.module:function``.

    Raises
    ------
    DataError
        Unknown name.
    """
    match name.strip().lower().replace("_", "-"):
        case "ca-cfar":
            return CellAveraging()
        case "os-cfar":
            return OrderedStatistic()
        case "os-cfar-exponential":
            return OrderedStatistic(clutter="exponential")
        case "frame-difference":
            return FrameDifference()
        case "integration":
            return RegisteredIntegration()
    if ":" in name:
        return load(name)
    raise DataError(
        f"detector {name!r} is unknown; choose ca-cfar, os-cfar, os-cfar-exponential, frame-difference, integration, or "
        "package.module:function of your own"
    )
