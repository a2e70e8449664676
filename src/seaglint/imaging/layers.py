"""Layers of a frame: the parts of the radiance and the geometry of a pixel, from the kernels to the file.

Kernels add to *channels*, one row of sums for each; layers are made of channels and named as the variables of files are.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DomainError
from seaglint.base.jit import njit
from seaglint.base.schema import LAYERS

TOTAL: Final = 0  #: Channel of all radiance [W m-2 sr-1].

SUN: Final = 1  #: Mirrored Sun [W m-2 sr-1].

#: Mean of the variances of sparkles below a pixel [W2 m-4 sr-2]; in a picture with sparkles the sunlight that those of many cells add to
#: the mean over the facets [W m-2 sr-1].
SPREAD: Final = 2

EMITTED: Final = 3  #: Emission of the sea behind the path [W m-2 sr-1].

PATH: Final = 4  #: Radiance of the path [W m-2 sr-1].

DISTANCE: Final = 5  #: Distance to the sea times the share of the pixel that the sea fills [m].

COVERAGE: Final = 6  #: Share of the pixel that the sea fills [1].

SLOPE: Final = 7  #: Slope of the sea away from the sensor times the share of the pixel that the sea fills [1].

FOAM: Final = 8  #: Share of the pixel that is foam [1].

CHANNELS: Final = 9  #: Number of all channels.

FEWEST: Final = 3  #: Number of channels that every frame has: the first three.

SKY: Final = 9  #: Plane of the mirrored sky, and of the sky itself: total radiance less Sun, emission and path.

LEAST_SEEN: Final = 1e-9  #: Least share of sea in a pixel that sees any; smaller ones are rounding.

#: Layer for sensors, which no file has: the sunlight of sparkles less its mean over the facets, where neighbouring pixels are independent.
SPARKLE: Final = "sparkle_radiance"

_PLANES: Final = {
    "path_radiance": (PATH,),
    "emitted_radiance": (EMITTED,),
    "sky_radiance": (SKY,),
    "glint_radiance": (SUN,),
    "range": (DISTANCE, COVERAGE),
    "coverage": (COVERAGE,),
    "foam_share": (FOAM,),
    "slope": (SLOPE, COVERAGE),
    "glint_share": (),
    "object_id": (),
    SPARKLE: (SPREAD,),
}

LIT: Final = frozenset({"glint_radiance", "glint_share", "object_id", SPARKLE})  #: Layers that need only the channels of every frame.


class Layers(Mapping[str, NDArray[np.float32]]):
    """Layers of one frame: images (rows, columns) under the names of ``seaglint.base.schema.VARIABLES``.

    Every frame has the layers ``radiance`` and ``glint_radiance``. Others on request are:

    - ``range``: distance from the sensor to the sea, mean over the visible sea in a pixel; NaN without visible sea,
    - ``coverage``: share of the pixel that the sea fills,
    - ``foam_share``: share of the pixel that is foam,
    - ``slope``: slope of the resolved waves along the line of sight,
    - ``object_id``: number of the object in the pixel; 0 without an object.
    """

    def __init__(self, images: Mapping[str, NDArray[np.float32]]) -> None:
        self._images = dict(images)

    def __getitem__(self, name: str) -> NDArray[np.float32]:
        return self._images[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._images)

    def __len__(self) -> int:
        return len(self._images)

    @property
    def radiance(self) -> NDArray[np.float32]:
        """Radiance at the aperture [W m-2 sr-1]."""
        return self._images["radiance"]

    @property
    def glint_radiance(self) -> NDArray[np.float32]:
        """Reflected sunlight in the radiance [W m-2 sr-1]."""
        return self._images["glint_radiance"]


def require_layers(names: Collection[str]) -> tuple[str, ...]:
    """Return the names of requested layers, in the order of ``seaglint.base.schema.LAYERS``.

    Raises
    ------
    DomainError
        A name that is not the name of a layer.
    """
    for name in names:
        if name not in LAYERS and name != SPARKLE:
            raise DomainError(f"layer '{name}' is not one of {', '.join(LAYERS)}; leave it out or give one of them")
    return tuple(name for name in (*LAYERS, SPARKLE) if name in names)


def channels_for(names: Collection[str]) -> int:
    """Return the number of channels that the kernels must fill for some layers: ``FEWEST`` for the mirrored Sun alone."""
    return FEWEST if set(names) <= LIT else CHANNELS


def planes_for(names: Collection[str]) -> NDArray[np.int64]:
    """Return the planes needed for some layers [(planes,)]; total and Sun are the first two."""
    planes = [TOTAL, SUN]
    for name in names:
        planes += [plane for plane in _PLANES[name] if plane not in planes]
    return np.array(planes, np.int64)


BLOCK = 16  #: Rows that are transposed together [1]: columns and rows of a block stay in the processor's cache.


@njit
def upright(columns: np.ndarray, planes: np.ndarray, out: np.ndarray, part: tuple[int, int]) -> None:
    """Transpose columns (columns, channels, rows) into ``planes``, ``out`` (planes, rows, columns), for a part of the blocks of rows."""
    for block in range(part[0], part[1]):
        for column in range(out.shape[2]):
            for row in range(BLOCK * block, min(BLOCK * block + BLOCK, out.shape[1])):
                for k in range(planes.shape[0]):
                    if planes[k] == SKY:
                        # sky is what remains of the total: no channel of its own
                        rest = columns[column, SUN, row] + columns[column, EMITTED, row] + columns[column, PATH, row]
                        out[k, row, column] = columns[column, TOTAL, row] - rest
                    else:
                        out[k, row, column] = columns[column, planes[k], row]


def mean_over_sea(weighted: NDArray[Any], coverage: NDArray[Any]) -> NDArray[Any]:
    """Return the mean over the visible sea in a pixel of ``DISTANCE`` [m] or ``SLOPE`` [1], from the plane and ``COVERAGE``.

    NaN without sea.
    """
    visible = coverage > LEAST_SEEN
    return np.where(visible, weighted / np.where(visible, coverage, 1.0), np.nan).astype(weighted.dtype)


def share_of_glint(glint: NDArray[Any], radiance: NDArray[Any]) -> NDArray[Any]:
    """Return the share of reflected sunlight in the radiance [1]; 0 without light."""
    return np.asarray(np.divide(glint, radiance, out=np.zeros_like(radiance), where=radiance > 0.0))


def layers_of(planes: NDArray[Any], kinds: NDArray[np.int64], names: Collection[str]) -> Layers:
    """Return the layers of a frame from its planes (planes, rows, columns), with the ``kinds`` of ``planes_for``."""
    by_kind = {int(kind): plane for kind, plane in zip(kinds, planes, strict=True)}
    images = {"radiance": by_kind[TOTAL], "glint_radiance": by_kind[SUN]}
    for name in names:
        if _PLANES[name]:
            images[name] = by_kind[_PLANES[name][0]]
    for name, plane in (("range", DISTANCE), ("slope", SLOPE)):
        if name in names:
            images[name] = mean_over_sea(by_kind[plane], by_kind[COVERAGE])
    if "glint_share" in names:
        images["glint_share"] = share_of_glint(images["glint_radiance"], images["radiance"])
    if "object_id" in names:
        images["object_id"] = np.zeros_like(images["radiance"])
    return Layers(images)


def summed(parts: Sequence[Layers]) -> Layers:
    """Return the image of parts that lie behind each other; each part is a sum over its share of the pixels and has a ``coverage``."""

    def total(images: list[NDArray[Any]]) -> NDArray[np.float32]:
        return np.asarray(np.sum(images, axis=0), np.float32)

    # means do not add: the first two are weighted with the coverage, the share of glint follows from the sums
    means = {"range", "slope", "glint_share"} & set(parts[0])
    layers = {name: total([part[name] for part in parts]) for name in parts[0] if name not in means}
    for name in means - {"glint_share"}:
        layers[name] = mean_over_sea(total([np.nan_to_num(part[name]) * part["coverage"] for part in parts]), layers["coverage"])
    if "glint_share" in means:
        layers["glint_share"] = share_of_glint(layers["glint_radiance"], layers["radiance"])
    return Layers(layers)
