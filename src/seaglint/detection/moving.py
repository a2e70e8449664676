"""Moving-target indication: differences of frames, and integration of registered frames.

Both register frames first where the camera moves (:mod:`seaglint.detection.registration`). Differences cancel clutter that stays longer
than ``lag`` frames (self-shadowing waves) and lay bare what moves; integration averages clutter that is gone sooner (glints) and keeps
what stays.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from seaglint.base.errors import DomainError
from seaglint.detection.interface import Frames
from seaglint.detection.registration import displacement, moved

_SPLINE_REACH = 12  #: Reach of the cubic spline of a moved frame [px]: its weights fall by 0.27 a pixel, here below 1e-6.


@dataclass(frozen=True)
class FrameDifference:
    """Difference of a frame and the frame ``lag`` earlier.

    Parameters
    ----------
    lag : int
        Frames between the two, at least 1 [frames].
    register : bool
        Whether the earlier frame is moved onto the later one first.
    """

    lag: int = 1
    register: bool = False
    name: str = field(default="frame-difference", init=False)
    calibrated: bool = field(default=False, init=False)
    null_law: None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if self.lag < 1:
            raise DomainError(f"lag = {self.lag} frames; give at least 1")

    @property
    def reach(self) -> int | None:
        """Reach of the statistic: 0, or the whole frame where frames are registered [px]."""
        return None if self.register else 0

    @property
    def linear(self) -> bool:
        """True if frames are not registered."""
        return not self.register

    @property
    def lead(self) -> int:
        """Number of earlier frames, equal to the lag [frames]."""
        return self.lag

    def __call__(self, frames: Frames) -> Frames:
        """Differences, shape (k - lag, rows, columns), unit of the input."""
        if not self.register:
            return frames[self.lag :] - frames[: -self.lag]
        pairs = zip(frames[self.lag :], frames[: -self.lag], strict=True)
        return np.stack([later - moved(earlier, _displacement(earlier, later)) for later, earlier in pairs])


def _displacement(earlier: Frames, later: Frames) -> tuple[float, float]:
    """Displacement of two frames; none where one of them has no values, so that differences and sums have none either."""
    if not (np.isfinite(earlier).any() and np.isfinite(later).any()):
        return 0.0, 0.0
    return displacement(earlier, later)


@dataclass(frozen=True)
class RegisteredIntegration:
    """Mean of the latest ``count`` frames, moved onto the latest.

    Parameters
    ----------
    count : int
        Frames averaged, at least 2.
    register : bool
        Whether frames are registered to the latest by phase correlation; without it the camera is taken to be still.
    velocity : (float, float)
        Motion of the target in rows and columns per frame [px], on top of the scene's; frames are added along its track.
    """

    count: int = 8
    register: bool = True
    velocity: tuple[float, float] = (0.0, 0.0)
    name: str = field(default="integration", init=False)
    calibrated: bool = field(default=False, init=False)
    null_law: None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if self.count < 2:
            raise DomainError(f"count = {self.count} frames; give at least 2")

    @property
    def reach(self) -> int | None:
        """Reach of the spline of a moved frame, or the whole frame where frames are registered [px]."""
        if self.register:
            return None
        return 0 if self.velocity == (0.0, 0.0) else _SPLINE_REACH + int(np.ceil(self.lead * max(abs(v) for v in self.velocity)))

    @property
    def linear(self) -> bool:
        """True if frames are not registered by their content."""
        return not self.register

    @property
    def lead(self) -> int:
        """Number of frames before the latest [frames]."""
        return self.count - 1

    def __call__(self, frames: Frames) -> Frames:
        """Means, shape (k - count + 1, rows, columns), unit of the input; NaN where a frame moved out of view."""
        out = np.empty((frames.shape[0] - self.lead, *frames.shape[1:]), np.float32)
        for k in range(out.shape[0]):
            latest = frames[k + self.lead]
            total = latest.astype(np.float64)
            for back in range(1, self.count):
                frame = frames[k + self.lead - back]
                shift = _displacement(frame, latest) if self.register else (0.0, 0.0)
                total += moved(frame, (shift[0] + back * self.velocity[0], shift[1] + back * self.velocity[1]))
            out[k] = total / self.count
        return out
