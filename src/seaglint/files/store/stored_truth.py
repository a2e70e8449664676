"""Truth of objects beside a sequence: the group ``truth`` of its Zarr store.

Arrays have the frames and objects of the sequence. A mask is a bit of ``object_mask``: object ``n`` (from 0) is bit ``n % 64`` of its plane
``n // 64``. Masks of objects may overlap; ``object_id`` holds the number, from 1, of the one that covers most of a pixel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.schema import VARIABLES
from seaglint.objects.drawing.truth_names import NUMBERS

GROUP: Final = "truth"  #: Name of the group.

TRUTHS: Final = (*NUMBERS, "object_mask", "object_id")  #: Names of the arrays of the group.

BITS: Final = 64  #: Number of objects in a plane of masks.


@dataclass(frozen=True)
class Truth:
    """Objects whose truth a sequence holds, by name."""

    names: tuple[str, ...]

    @property
    def planes(self) -> int:
        """Return the number of planes of masks."""
        return -(-len(self.names) // BITS)

    @property
    def bytes_per_pixel(self) -> int:
        """Return the size of masks and numbers in a pixel."""
        return sum(size * np.dtype(VARIABLES[name].dtype).itemsize for name, size in (("object_mask", self.planes), ("object_id", 1)))

    def make(self, group: Any, shape: tuple[int, int, int], shards: Callable[[int, tuple[int, ...]], dict[str, Any]]) -> None:
        """Make the empty arrays of ``frames, rows, columns``; ``shards(itemsize, size)`` returns their division into shards."""
        frames, rows, columns = shape
        count, planes = len(self.names), self.planes
        unit = group["frame_done"].chunks[0]
        held: Any = group.create_group(GROUP, attributes={"objects": list(self.names)})
        for name in NUMBERS:
            about = VARIABLES[name].attributes
            held.create_array(
                name,
                shape=(frames, count),
                chunks=(unit, count),
                dtype="float64",
                fill_value=np.nan,
                dimension_names=("time", "object"),
                attributes=about,
            )
        for name, dimensions, size in (
            ("object_mask", ("time", "plane", "y", "x"), (planes, rows, columns)),
            ("object_id", ("time", "y", "x"), (rows, columns)),
        ):
            dtype = np.dtype(VARIABLES[name].dtype)
            held.create_array(
                name,
                shape=(frames, *size),
                dtype=dtype,
                fill_value=0,
                **shards(dtype.itemsize, size),
                dimension_names=dimensions,
                attributes=VARIABLES[name].attributes,
            )


def unpacked(planes: NDArray[np.uint64], count: int) -> Iterator[NDArray[np.bool_]]:
    """Yield the masks (rows, columns) of so many objects from their bits [(planes, rows, columns)].

    Examples
    --------
    >>> masks = [np.eye(3, dtype=bool), ~np.eye(3, dtype=bool)]
    >>> bool((np.stack(list(unpacked(packed(masks), 2))) == masks).all())
    True
    """
    for n in range(count):
        yield (planes[n // BITS] >> np.uint64(n % BITS)) & np.uint64(1) > 0


def packed(masks: Sequence[NDArray[np.bool_]]) -> NDArray[np.uint64]:
    """Pack masks (rows, columns) into bits [(planes, rows, columns)]."""
    out = np.zeros((-(-len(masks) // BITS), *masks[0].shape), np.uint64)
    for number, mask in enumerate(masks):
        out[number // BITS][mask] |= np.uint64(1) << np.uint64(number % BITS)
    return out
