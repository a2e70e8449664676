"""Moving-target indication: registration of frames, their differences, and the integration of registered frames.

Frames are registered first where the camera moves: the shift between two images is estimated to a fraction of a pixel by phase correlation.
Differences cancel clutter that stays longer than ``lag`` frames (self-shadowing waves) and leave moving objects; integration averages
clutter that disappears sooner (glints) and keeps objects that stay.

References
----------
Kuglin and Hines 1975, Proc. IEEE Conf. Cybernetics and Society, 163; Guizar-Sicairos, Thurman and Fienup 2008, Opt. Lett. 33, 156
(refinement by a small discrete Fourier transform around the peak).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.errors import DataError, DomainError
from seaglint.detection.interface import Frames

FINENESS = 50  #: Number of parts of a pixel to which a shift is refined: far finer than the noise.


def _prepared(image: ArrayLike) -> NDArray[np.float64]:
    x = np.asarray(image, np.float64)
    finite = np.isfinite(x)
    if not finite.any():
        raise DataError("a frame without any value cannot be registered; leave it out or switch registration off")
    x = np.where(finite, x, x[finite].mean())
    # The border of an image correlates with itself at shift 0; a Hann window takes it away.
    window = np.outer(np.hanning(x.shape[0] + 2)[1:-1], np.hanning(x.shape[1] + 2)[1:-1])
    return np.asarray((x - (x * window).sum() / window.sum()) * window)


def displacement(earlier: ArrayLike, later: ArrayLike) -> tuple[float, float]:
    """Return the motion of the scene from one image to the next, (rows, columns) [px]: ``later(x) = earlier(x - displacement)``.

    The cross-power spectrum is whitened by its square root only: fully whitened, frequencies without signal would vote like the others.

    Raises
    ------
    DataError
        Images of different shapes, or without any value.
    """
    if np.shape(earlier) != np.shape(later):
        raise DataError(f"images of shapes {np.shape(earlier)} and {np.shape(later)} cannot be registered; give equal shapes")
    first = _peak_displacement(np.asarray(earlier), np.asarray(later))
    # A second time on the common part of both images: parts in one image alone bias the estimate towards 0 under the window.
    whole = [round(d) for d in first]
    shape = np.shape(earlier)
    if not any(whole) or any(n - abs(d) < 16 for n, d in zip(shape, whole, strict=True)):
        return first
    # The parts of both images that show the same scene, by the whole pixels of the first estimate.
    before = tuple(slice(max(-d, 0), n - max(d, 0)) for d, n in zip(whole, shape, strict=True))
    after = tuple(slice(max(d, 0), n - max(-d, 0)) for d, n in zip(whole, shape, strict=True))
    rest = _peak_displacement(np.asarray(earlier)[before], np.asarray(later)[after])
    return (whole[0] + rest[0], whole[1] + rest[1]) if max(abs(rest[0]), abs(rest[1])) < 1.5 else first


def _peak_displacement(earlier: NDArray[np.floating], later: NDArray[np.floating]) -> tuple[float, float]:
    a, b = np.fft.fft2(_prepared(earlier)), np.fft.fft2(_prepared(later))
    cross = b * a.conj()
    size = np.abs(cross)
    if not size.any():
        return 0.0, 0.0
    cross /= np.sqrt(np.maximum(size, 1e-12 * size.max()))
    rows, columns = cross.shape
    peak = np.unravel_index(int(np.argmax(np.fft.ifft2(cross).real)), cross.shape)
    # Shifts beyond half the image are negative ones.
    centre = [float((p + n // 2) % n - n // 2) for p, n in zip(peak, cross.shape, strict=True)]
    fy, fx = np.fft.fftfreq(rows), np.fft.fftfreq(columns)
    # Twice a small transform about the peak, tenths of a pixel first: a whole padded one would cost FINENESS squared as much.
    for step in (0.1, 1.0 / FINENESS):
        offsets = step * np.arange(-10, 11)
        y, x = centre[0] + offsets, centre[1] + offsets
        fine = np.exp(2j * np.pi * np.outer(y, fy)) @ cross @ np.exp(2j * np.pi * np.outer(fx, x))
        i, j = np.unravel_index(int(np.argmax(fine.real)), fine.shape)
        centre = [float(y[i]), float(x[j])]
    return centre[0], centre[1]


def moved(frame: ArrayLike, by: tuple[float, float]) -> Frames:
    """Return an image moved by (rows, columns) [px], cubic spline; NaN where it has no value, unit of the input."""
    from scipy.ndimage import shift

    x = np.asarray(frame, np.float64)
    if by == (0.0, 0.0):
        return x.astype(np.float32)
    missing = np.isnan(x)
    if missing.any():
        # A pixel with any share of a missing one in it is missing, too.
        blurred = shift(missing.astype(np.float64), by, order=1, mode="constant", cval=1.0) > 1e-6
        out = shift(np.where(missing, np.nanmean(x), x), by, order=3, mode="constant", cval=np.nan)
        return np.where(blurred, np.nan, out).astype(np.float32)
    return np.asarray(shift(x, by, order=3, mode="constant", cval=np.nan), np.float32)


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
    """Return the displacement of two frames; 0 where one of them has no values, so that differences and sums have none either."""
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
                # The shift of the scene, and the motion of the target in addition.
                total += moved(frame, (shift[0] + back * self.velocity[0], shift[1] + back * self.velocity[1]))
            out[k] = total / self.count
        return out
