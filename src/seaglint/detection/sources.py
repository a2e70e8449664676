"""Interface of frames without objects, in which detectors are judged."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from seaglint.detection.interface import Frames

if TYPE_CHECKING:  # SciPy comes with it
    from seaglint.detection.counting import Counting


class FrameSource(Protocol):
    """Frames without objects: a recording, or pictures rendered on demand.

    Of :class:`PlainFrames` a source inherits the members that it need not have.
    """

    @property
    def frames(self) -> int:
        """Number of frames."""
        ...

    @property
    def rows(self) -> int:
        """Rows of a frame [px]."""
        ...

    @property
    def columns(self) -> int:
        """Columns of a frame [px]."""
        ...

    @property
    def saturation(self) -> float | None:
        """Saturation value of a pixel [u]; None where it is unknown."""
        ...

    @property
    def sequence_length(self) -> int:
        """Number of frames of each independent sequence; 0 where all belong together."""
        ...

    @property
    def counting(self) -> Counting | None:
        """Counting of an object's light by the sensor; None where objects are added as they are."""
        ...

    @property
    def offset(self) -> float:
        """Level that :meth:`read` has subtracted from the source's own numbers [u]."""
        ...

    def read(self, start: int, stop: int) -> Frames:
        """Return frames ``start`` to ``stop`` (not included) as a copy, NaN where missing [u]."""
        ...


class PlainFrames:
    """Members of a source whose frames are one sequence of its own numbers, without a sensor's counting."""

    @property
    def sequence_length(self) -> int:
        """All frames belong together."""
        return 0

    @property
    def counting(self) -> Counting | None:
        """Objects are added as they are."""
        return None

    @property
    def offset(self) -> float:
        """Nothing is subtracted [u]."""
        return 0.0
