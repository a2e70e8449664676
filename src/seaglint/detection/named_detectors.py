"""Detectors by name: the detectors of ``seaglint.detection.detector_names`` with default settings, and a user's detector."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.clutter.filters import autocovariance
from seaglint.detection.detector_names import DETECTORS, NAMES, OWN, PLAIN
from seaglint.detection.interface import Detector, Frames, load
from seaglint.detection.spatial import laplacian_of_gaussian
from seaglint.detection.spot import GaussianSpot, SpotShape

CORE: Final = 0.999  #: Share of its energy that a signature keeps where covariances are estimated.


def named(name: str) -> Detector:
    """Return the detector of a name in ``PLAIN`` with default settings, or of a path as for ``seaglint.detection.interface.load``.

    Raises
    ------
    DataError
        Unknown name, or the name of a detector that needs the object's shape.
    """
    if _key(name) in PLAIN:
        return _made(name)
    if ":" in name:
        return load(name)
    if _key(name) in NAMES:
        raise DataError(f"detector {name!r} needs the shape of the object it looks for; seaglint detect has it")
    raise _unknown(name, PLAIN)


def named_for(name: str, shape: SpotShape, background: Callable[[], Frames]) -> Detector:
    """Return the detector of a name for objects of a known shape.

    Parameters
    ----------
    name : str
        One of ``NAMES``, or a path as for ``seaglint.detection.interface.load``.
    shape : SpotShape
        Shape of the objects.
    background : callable
        Frames without objects, shape (k, rows, columns), from which covariances are estimated; called where they are needed.

    Raises
    ------
    DataError
        Unknown name.
    """
    signature: NDArray[np.float64] = shape.stamps(np.zeros((1, 2)))[0]
    match _key(name):
        case "matched":
            return _made(name, signature)
        case "matched-global":
            core = core_of(signature)
            return _made(name, core, autocovariance(background(), max(core.shape) - 1))
        case "matched-local":
            return _made(name, core_of(signature), background())
        case "log":
            # A spot has its largest response at its own scale; of a sampled spot that is the width of its second moment.
            scale = shape.sigma if isinstance(shape, GaussianSpot) else _width(signature)
            return _made(name, laplacian_of_gaussian(float(np.clip(scale, 0.5, 10.0))), "log")
    if ":" not in name and _key(name) not in PLAIN:
        raise _unknown(name, NAMES)
    return named(name)


def require_known(name: str) -> None:
    """Check the name of a detector.

    Raises
    ------
    DataError
        It is none of ``NAMES``.
    """
    if _key(name) not in (*NAMES, *PLAIN):
        raise _unknown(name, NAMES)


def _made(name: str, *arguments: Any) -> Detector:
    """Return a detector of the package, of its entry's class."""
    entry = next(entry for entry in DETECTORS if entry.name == _key(name))
    module, _, function = entry.made_by.partition(".")
    made: Detector = getattr(import_module(f"seaglint.detection.{module}"), function)(*arguments, **entry.settings)
    return made


def core_of(signature: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the smallest middle of a signature that keeps 99.9 % of its energy: faint edges need covariances of many more pixels.

    Examples
    --------
    >>> core_of(np.pad(np.ones((3, 3)), 4, constant_values=1e-3)).shape
    (3, 3)
    """
    energy = float((signature**2).sum())
    rows, columns = (n // 2 for n in signature.shape)
    for half in range(1, max(rows, columns)):
        down, right = min(half, rows), min(half, columns)
        middle = signature[rows - down : rows + down + 1, columns - right : columns + right + 1]
        if float((middle**2).sum()) >= CORE * energy:
            return middle
    return signature


def _width(signature: NDArray[np.float64]) -> float:
    """Return the standard deviation of the positive part along an axis [px]."""
    s = np.maximum(signature, 0.0)
    axis = np.arange(s.shape[0]) - s.shape[0] // 2
    return float(np.sqrt((s * (axis[:, None] ** 2 + axis**2)).sum() / (2.0 * s.sum())))


def _key(name: str) -> str:
    return name.strip().lower().replace("_", "-")


def _unknown(name: str, known: tuple[str, ...]) -> DataError:
    return DataError(f"detector {name!r} is unknown; choose {', '.join(known)}, or {OWN} of your own")
