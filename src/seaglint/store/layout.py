"""Layout of a sequence, known before its first frame, and of the truth of its objects: the group ``truth`` of its Zarr store.

Arrays of the truth have the frames and objects of the sequence. A mask is a bit of ``object_mask``: object ``n`` (from 0) is bit ``n % 64``
of its plane ``n // 64``. Masks of objects may overlap; ``object_id`` holds the number, from 1, of the object that covers most of a pixel.
With a detector ``response_mask`` has the masks of the objects' responses after the optics in the same bits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.free_form import Attributes
from seaglint.base.schema import NUMBERS, VARIABLES
from seaglint.optics.band import Band
from seaglint.store.provenance import band_attributes
from seaglint.version import __version__

GROUP: Final = "truth"  #: Name of the group.

_IMAGES: Final = ("object_mask", "object_id", "response_mask")  #: Names of the images of the group.

BITS: Final = 64  #: Number of objects in a plane of masks.


@dataclass(frozen=True)
class Truth:
    """Objects whose truth a sequence holds, by name."""

    names: tuple[str, ...]
    mask_share: float | None = None  #: Share of its peak from which a pixel belongs to the mask of a response; None without a detector.

    @property
    def images(self) -> tuple[str, ...]:
        """Return the names of the images of the group."""
        return _IMAGES if self.mask_share is not None else _IMAGES[:-1]

    @property
    def arrays(self) -> tuple[str, ...]:
        """Return the names of all arrays of the group."""
        return (*NUMBERS, *self.images)

    @property
    def planes(self) -> int:
        """Return the number of planes of masks."""
        return -(-len(self.names) // BITS)

    @property
    def bytes_per_pixel(self) -> int:
        """Return the size of masks and numbers in a pixel."""
        return sum(np.dtype(VARIABLES[name].dtype).itemsize * (1 if name == "object_id" else self.planes) for name in self.images)

    def make(self, group: Any, shape: tuple[int, int, int], shards: Callable[[int, tuple[int, ...]], dict[str, Any]]) -> None:
        """Make the empty arrays of ``frames, rows, columns``; ``shards(itemsize, size)`` returns their division into shards."""
        frames, rows, columns = shape
        count, planes = len(self.names), self.planes
        unit = group["frame_done"].chunks[0]
        about = {"objects": list(self.names), **({} if self.mask_share is None else {"mask_share": self.mask_share})}
        truth: Any = group.create_group(GROUP, attributes=about)
        for name in NUMBERS:
            truth.create_array(
                name, shape=(frames, count), chunks=(unit, count), dtype="float64", fill_value=np.nan,
                dimension_names=("time", "object"), attributes=VARIABLES[name].attributes,
            )  # fmt: skip
        for name in self.images:
            owners = name == "object_id"
            dimensions, size = (
                ("time", "y", "x") if owners else ("time", "plane", "y", "x"),
                (() if owners else (planes,)) + (rows, columns),
            )
            dtype = np.dtype(VARIABLES[name].dtype)
            truth.create_array(
                name, shape=(frames, *size), dtype=dtype, fill_value=0, **shards(dtype.itemsize, size),
                dimension_names=dimensions, attributes=VARIABLES[name].attributes,
            )  # fmt: skip


def unpacked(planes: NDArray[np.uint64], count: int) -> Iterator[NDArray[np.bool_]]:
    """Yield the masks (rows, columns) of so many objects from their bits [(planes, rows, columns)].

    Examples
    --------
    >>> masks = [np.eye(3, dtype=bool), ~np.eye(3, dtype=bool)]
    >>> bool((np.stack(list(unpacked(packed(masks), 2))) == masks).all())
    True
    """
    # One bit of a plane for each object: a sequence of many objects stays small.
    for n in range(count):
        yield (planes[n // BITS] >> np.uint64(n % BITS)) & np.uint64(1) > 0


def packed(masks: Sequence[NDArray[np.bool_]]) -> NDArray[np.uint64]:
    """Pack masks (rows, columns) into bits [(planes, rows, columns)]."""
    out = np.zeros((-(-len(masks) // BITS), *masks[0].shape), np.uint64)
    for number, mask in enumerate(masks):
        out[number // BITS][mask] |= np.uint64(1) << np.uint64(number % BITS)
    return out


FORMAT: Final = "seaglint-sequence-1"  #: Value of the attribute ``seaglint_format`` of seaglint's sequences.

UNFINISHED: Final = "unfinished"  #: Attribute of a sequence that is being written: the number of shares of its work.

MOST_UNITS: Final = 256  #: Largest number of shards of a sequence, unless they would exceed ``MOST_BYTES``.

MOST_BYTES: Final = 256_000_000  #: Largest size of the arrays of a shard before compression [bytes].


@dataclass(frozen=True)
class Layout:
    """Layout of a sequence, known before its first frame."""

    #: Azimuth of the pixel columns [deg, (nx,)], or of all pixels (ny, nx) where the image is no grid of azimuth and elevation.
    azimuth_deg: FloatArray
    elevation_deg: FloatArray  #: Elevation of the pixel rows, from the top [deg, (ny,)], or of all pixels (ny, nx).
    frames: range  #: Numbers of the frames, counted in the whole sequence.
    frame_rate: float  #: Frames per second [Hz].
    band: Band | None  #: Spectral response that the radiance is integrated over; None of textures.
    variables: tuple[str, ...] = ("radiance",)  #: Names of the per-frame variables.
    attributes: Mapping[str, Any] = field(default_factory=dict)  #: Attributes of provenance.
    #: Place and attitude of a moving sensor in every frame, by variable [(frames,)].
    poses: Mapping[str, FloatArray] = field(default_factory=dict)
    start: datetime | None = None  #: UTC of the first frame of the whole sequence, where a date is known.
    per_frame: tuple[str, ...] = ()  #: Names of the variables that have one number a frame, found with its images.
    details: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  #: Further attributes of variables, by name.
    truth: Truth | None = None  #: Objects whose truth is written beside the images.
    turning: bool = False  #: Flag of a changing attitude: azimuth and elevation are then those of the first frame and not stored.
    frames_per_unit: int = 1  #: Number of frames in a shard, which one process writes at once.

    @property
    def shape(self) -> tuple[int, int, int]:
        """Return frames, rows, columns."""
        return len(self.frames), self.elevation_deg.shape[0], self.azimuth_deg.shape[-1]

    @property
    def frame_bytes(self) -> int:
        """Return the size of a frame's images before compression."""
        _, rows, columns = self.shape
        truth = 0 if self.truth is None else self.truth.bytes_per_pixel
        return rows * columns * (truth + sum(np.dtype(VARIABLES[name].dtype).itemsize for name in self.variables))

    def in_units(self, frames: int) -> Layout:
        """Return the layout in the shards of a whole sequence of ``frames``, which are the same for all of its parts.

        >>> from seaglint.store.layout import Layout
        >>> small = Layout(np.zeros(8), np.zeros(4), range(5), 25.0, None)
        >>> [small.in_units(frames).frames_per_unit for frames in (1, 256, 257, 10_000)]
        [1, 1, 2, 40]
        """
        # As many frames as 256 shards need, and no more than fit into the memory of a shard.
        most = max(MOST_BYTES // max(self.frame_bytes, 1), 1)
        return replace(self, frames_per_unit=max(min(-(-frames // MOST_UNITS), most), 1))

    @property
    def all_attributes(self) -> Attributes:
        """Return the global attributes: provenance without a date, so that equal frames are equal files, format and band."""
        return {
            **self.attributes,
            **({"history": f"written by seaglint {__version__}"} if "history" in self.attributes else {}),
            "seaglint_format": FORMAT,
            "frame_rate_hz": self.frame_rate,
            **band_attributes(self.band),
        }
