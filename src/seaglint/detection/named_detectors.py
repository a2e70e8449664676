"""Selection of detectors by name: those of this package with default settings, and a user's own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.clutter.filters import TopHat, autocovariance
from seaglint.detection.cfar import CellAveraging, OrderedStatistic
from seaglint.detection.interface import Detector, Frames, load
from seaglint.detection.matched import LocalMatched, Matched
from seaglint.detection.moving import FrameDifference, RegisteredIntegration
from seaglint.detection.patch_image import PatchImage
from seaglint.detection.spatial import DirectionalBackground, FilterThreshold, laplacian_of_gaussian
from seaglint.detection.spot import GaussianSpot, SpotShape
from seaglint.detection.temporal import TemporalProfile, TrackBeforeDetect

_PLAIN: Final[dict[str, Callable[[], Detector]]] = {
    "ca-cfar": CellAveraging,
    "os-cfar": OrderedStatistic,
    "os-cfar-exponential": lambda: OrderedStatistic(clutter="exponential"),
    "frame-difference": FrameDifference,
    "integration": RegisteredIntegration,
    "threshold": FilterThreshold,
    "top-hat": lambda: FilterThreshold(TopHat(), "top-hat"),
    "max-mean": lambda: DirectionalBackground("mean"),
    "max-median": lambda: DirectionalBackground("median"),
    "patch-image": PatchImage,
    "temporal-profile": TemporalProfile,
    "track-before-detect": TrackBeforeDetect,
}

_SHAPED: Final = ("matched", "matched-global", "matched-local", "log")

CORE: Final = 0.999  #: Share of its energy that a signature keeps where covariances are estimated.

NAMES: Final = (*_PLAIN, *_SHAPED)  #: Names of the detectors of this package; the last ones need the object's shape.


def named(name: str) -> Detector:
    """Detector with default settings (:data:`NAMES`, those without an object's shape), or ``package.module:function``.

    Raises
    ------
    DataError
        Unknown name.
    """
    plain = _PLAIN.get(_key(name))
    if plain is not None:
        return plain()
    if ":" in name:
        return load(name)
    if _key(name) in _SHAPED:
        raise DataError(f"detector {name!r} needs the shape of the object it looks for; seaglint detect has it")
    raise _unknown(name, tuple(_PLAIN))


def named_for(name: str, shape: SpotShape, background: Callable[[], Frames]) -> Detector:
    """Detector by name for objects of a known shape.

    Parameters
    ----------
    name : str
        One of :data:`NAMES`, or ``package.module:function``.
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
            return Matched(signature)
        case "matched-global":
            kept = core_of(signature)
            return Matched(kept, autocovariance(background(), max(kept.shape) - 1))
        case "matched-local":
            return LocalMatched(core_of(signature), background())
        case "log":
            # The scale at which a spot answers most is its own; of a sampled one that of its second moment.
            scale = shape.sigma if isinstance(shape, GaussianSpot) else _width(signature)
            return FilterThreshold(laplacian_of_gaussian(float(np.clip(scale, 0.5, 10.0))), "log")
    if ":" not in name and _key(name) not in _PLAIN:
        raise _unknown(name, NAMES)
    return named(name)


def core_of(signature: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the smallest middle of a signature that keeps 99.9 % of its energy: faint edges ask for covariances of many more pixels.

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
    """Standard deviation of the positive part along an axis [px]."""
    s = np.maximum(signature, 0.0)
    axis = np.arange(s.shape[0]) - s.shape[0] // 2
    return float(np.sqrt((s * (axis[:, None] ** 2 + axis**2)).sum() / (2.0 * s.sum())))


def _key(name: str) -> str:
    return name.strip().lower().replace("_", "-")


def _unknown(name: str, known: tuple[str, ...]) -> DataError:
    return DataError(f"detector {name!r} is unknown; choose {', '.join(known)}, or package.module:function of your own")
