"""Levels of grey pictures: linear relations from the level of a pixel to counts and radiance, in 8 or 16 bits.

Pictures have 8 bits by default, since common readers clip or rescale 16: ``cv2.imread`` keeps the upper byte, Pillow's ``convert("L")`` the
values below 256. Each scene has its own relation by default. One relation for a whole data set would hide objects: of 60 labels of
``examples/small-objects.toml`` with a signal-to-noise ratio above 3, 41 lose more than a tenth of it, as glint in a few scenes fills the
range; with a relation for each scene none does (``docs/figures/dataset_ranges.py``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

Bits = Literal[8, 16]
Depth = Literal["8", "16", "both"]
ImageKind = Literal["png", "tiff"]
LevelScale = Literal["scene", "frame"]

MOST_CLIPPED: Final = 10.0  #: Largest share of pixels of a frame that may be clipped at each end [%].


@dataclass(frozen=True)
class PictureLevels:
    """Linear relation of the levels of a picture: ``value = offset + scale * level``."""

    bits: Bits  #: Bits of a level.
    scale: float  #: Step of a level, in the values that the levels were made of: counts, or radiance [W m-2 sr-1].
    offset: float  #: Value of level 0, in the same unit.
    radiance_scale: float  #: Radiance of a step [W m-2 sr-1].
    radiance_offset: float  #: Radiance of level 0 [W m-2 sr-1].
    counts: bool  #: True where the levels were made from a detector's counts.

    @classmethod
    def of_counts(cls, low: float, high: float, bits: Bits, line: tuple[float, float]) -> PictureLevels:
        """Return the levels of counts between ``low`` and ``high``, whose radiance is ``line[0] * count + line[1]``.

        In 16 bits levels are the counts themselves. In 8 bits the counts from ``low`` to ``high`` fill the levels; steps are never finer
        than a count.

        >>> PictureLevels.of_counts(1000, 1100, 8, (2.0, 5.0)).radiance_offset
        2005.0
        """
        scale, offset = (1.0, 0.0) if bits == 16 else (max((high - low) / 255.0, 1.0), float(low))
        return cls(bits, scale, offset, line[0] * scale, line[0] * offset + line[1], True)

    @classmethod
    def of_radiance(cls, low: float, high: float, bits: Bits) -> PictureLevels:
        """Return the levels of radiance between ``low`` and ``high`` [W m-2 sr-1], which fill their range."""
        # A scene of one value would have steps of 0.
        scale = (high - low) / ((1 << bits) - 1) or 1.0
        return cls(bits, scale, low, scale, low, False)

    def of(self, values: NDArray[Any]) -> tuple[NDArray[Any], int]:
        """Return the nearest levels of counts or radiance, and the number of pixels clipped to the first or last level.

        Raises
        ------
        DataError
            A value that is no number.
        """
        levels, most = np.rint((np.asarray(values, np.float64) - self.offset) / self.scale), (1 << self.bits) - 1
        if not np.isfinite(levels).all():
            raise DataError("the picture has values that are no numbers; render the scene again")
        beyond = int(np.count_nonzero((levels < 0) | (levels > most)))
        return np.clip(levels, 0, most).astype(np.uint8 if self.bits == 8 else np.uint16), beyond

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Return the relations by their names in tables and pictures."""
        lines: dict[str, float | int | str] = {
            "bits": self.bits,
            "radiance_scale": self.radiance_scale,
            "radiance_offset": self.radiance_offset,
            "radiance_error": 0.5 * abs(self.radiance_scale),
            "radiance_units": "W m-2 sr-1",
        }
        return {**lines, "count_scale": self.scale, "count_offset": self.offset} if self.counts else lines


@dataclass(frozen=True)
class PictureOptions:
    """Bits and file type of pictures, and the range of values that 8 bits cover."""

    depth: Depth = "8"  #: Bits of a pixel; with both there is a picture of 16 bits beside each one of 8.
    image: ImageKind = "png"  #: Kind of file.
    scale: LevelScale = "scene"  #: Frames that share a relation in 8 bits.
    #: Values of the first and last level of all pictures in 8 bits: counts of scenes with a detector, else radiance [W m-2 sr-1].
    limits: tuple[float, float] | None = None
    clip: float = 0.0  #: Share of the pixels of a frame that may lie beyond each end of the range of 8 bits [%].

    @classmethod
    def of(
        cls,
        bits: int | str | None = None,
        image: str | None = None,
        scale: str | None = None,
        limits: Sequence[float] | None = None,
        clip: float | None = None,
    ) -> PictureOptions:
        """Return checked options; None is the default of each.

        Raises
        ------
        DataError
            An unknown value, or options of 8 bits with 16.
        """
        depth = "8" if bits is None else str(bits)
        if depth not in get_args(Depth):
            raise DataError(f"bits = {bits}: is not 8, 16 or both; give one of them")
        if image is not None and image not in get_args(ImageKind):
            raise DataError(f"image = {image!r}: is not one of png, tiff; give one of them")
        if scale is not None and scale not in get_args(LevelScale):
            raise DataError(f"scale = {scale!r}: is not one of scene, frame; give one of them, or `limits` for all pictures")
        if clip is not None and not 0.0 <= clip <= MOST_CLIPPED:
            raise DataError(f"clip = {clip:g}: is not a share of 0 to {MOST_CLIPPED:g} %; give the share of pixels clipped at each end")
        if limits is not None and not (len(limits) == 2 and np.isfinite(limits).all() and limits[0] < limits[1]):
            given = " ".join(f"{value:g}" for value in limits)
            raise DataError(f"limits = {given}: is no range; give two numbers, the lower one first")
        names = [name for name, value in (("scale", scale), ("limits", limits), ("clip", clip)) if value is not None]
        if depth == "16" and names:
            raise DataError(f"`{names[0]}` applies to pictures of 8 bits, and bits = 16; leave `{names[0]}` out, or give bits = 8 or both")
        if limits is not None and len(names) > 1:
            other = "scale" if scale is not None else "clip"
            raise DataError(f"`limits` and `{other}` both set the range of 8 bits; give one of the two")
        ends = None if limits is None else (float(limits[0]), float(limits[1]))
        return cls(depth, image or "png", scale or "scene", ends, clip or 0.0)  # type: ignore[arg-type]

    @property
    def named(self) -> dict[str, Any]:
        """Return the options by the names under which a data set records them."""
        shared = {"scale": self.scale, "clip": self.clip} if self.limits is None else {"scale": "limits", "limits": list(self.limits)}
        return {"bits": self.depth, "image": self.image, **({} if self.depth == "16" else shared)}

    @property
    def command(self) -> str:
        """Return the options of the command that differ from their defaults, each after a blank."""
        ends = "" if self.limits is None else f" --range {self.limits[0]!r} {self.limits[1]!r}"
        given = {"bits": (self.depth, "8"), "image": (self.image, "png"), "scale": (self.scale, "scene"), "clip": (self.clip, 0.0)}
        return "".join(f" --{name} {value}" for name, (value, default) in given.items() if value != default) + ends

    @property
    def bits(self) -> tuple[Bits, ...]:
        """Return the bits of the pictures of a frame: of the picture that labels name, then of the second one."""
        return {"8": (8,), "16": (16,), "both": (8, 16)}[self.depth]  # type: ignore[return-value]

    def levels(self, frames: Sequence[FrameRange], line: tuple[float, float] | None) -> list[tuple[PictureLevels, ...]]:
        """Return the relations of each frame of a scene, one for each of ``bits``.

        Parameters
        ----------
        frames : sequence of FrameRange
            Values of the frames.
        line : tuple or None
            Radiance of a count and of zero counts [W m-2 sr-1]; None for radiance.
        """
        least, most = min(frame.least for frame in frames), max(frame.most for frame in frames)
        # No frame has more pixels beyond the range of its scene than beyond its own.
        low, high = min(frame.low for frame in frames), max(frame.high for frame in frames)

        def relation(bits: Bits, ends: tuple[float, float]) -> PictureLevels:
            return PictureLevels.of_radiance(*ends, bits) if line is None else PictureLevels.of_counts(*ends, bits, line)

        shared = {16: relation(16, (least, most)), 8: relation(8, self.limits or (low, high))}
        if self.scale == "scene":
            return [tuple(shared[bits] for bits in self.bits)] * len(frames)
        return [tuple(shared[16] if bits == 16 else relation(8, (frame.low, frame.high)) for bits in self.bits) for frame in frames]


@dataclass(frozen=True)
class FrameRange:
    """Range of the values of a frame."""

    least: float  #: Smallest value.
    most: float  #: Largest value.
    low: float  #: Lower end of the range after clipping.
    high: float  #: Upper end of the range after clipping.

    @classmethod
    def of(cls, values: NDArray[Any], clip: float) -> FrameRange:
        """Return the range of a frame of which ``clip`` % of the pixels may lie beyond each end."""
        least, most = float(values.min()), float(values.max())
        if not clip:
            return cls(least, most, least, most)
        low, high = (float(value) for value in np.percentile(np.asarray(values, np.float64), (clip, 100.0 - clip)))
        # Where all pixels but a few have one value, the range between percentiles is empty.
        return cls(least, most, low, high) if low < high else cls(least, most, least, most)
