"""Detectors in time: the temporal profile of a pixel, and track-before-detect by dynamic programming.

References
----------
Silverman, Mooney and Caefer 1996, Proc. SPIE 2759, 162 (temporal profiles); Barniv 1985, IEEE Trans. AES 21, 144, and Tonissen and
Evans 1996, IEEE Trans. AES 32, 1440 (dynamic programming).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.clutter.filters import as_frames
from seaglint.detection.cfar import HIGHEST
from seaglint.detection.interface import GAUSSIAN_TAIL, Frames


@lru_cache(maxsize=8)
def _student(degrees: int) -> tuple[FloatArray, FloatArray]:
    """Ratios and their equivalent standard deviations z, by equal tails of Student's t and the Gaussian: dense around 0, up to 1e30."""
    from scipy.special import ndtri, stdtr

    # A grid dense about 0, where most values lie, up to ratios of tails below 1e-300.
    ratio = np.sinh(np.linspace(0.0, np.arcsinh(1e30), 20_001))
    z = np.minimum(-ndtri(np.maximum(stdtr(degrees, -ratio), 1e-300)), HIGHEST)
    return np.concatenate([-ratio[:0:-1], ratio]), np.concatenate([-z[:0:-1], z])


@dataclass(frozen=True)
class TemporalProfile:
    """Detector of a pixel against its own past: Student's ratio of the latest value to ``count`` earlier ones.

        T = (x - mean) / (s sqrt(1 + 1/n)),  Student's t with n - 1 degrees of freedom

    with mean and standard deviation s over n earlier frames that end ``guard`` frames before the latest. It finds what appears in a pixel
    whose clutter is steady in time, and nothing that was there all the while.

    Parameters
    ----------
    count : int
        Frames of the past, at least 3.
    guard : int
        Frames left out between them and the latest, at least 0.
    """

    count: int = 16
    guard: int = 0
    name: str = field(default="temporal-profile", init=False)
    calibrated: bool = field(default=True, init=False)
    reach: int = field(default=0, init=False)
    linear: bool = field(default=False, init=False)
    null_law: str = field(default=f"{GAUSSIAN_TAIL}, Gaussian clutter that is independent from frame to frame", init=False)

    def __post_init__(self) -> None:
        if self.count < 3 or self.guard < 0:
            raise DomainError(f"count = {self.count} and guard = {self.guard} frames; at least 3 and 0 are needed")

    @property
    def lead(self) -> int:
        """Number of frames before the latest [frames]."""
        return self.count + self.guard

    def __call__(self, frames: Frames) -> Frames:
        """Equivalent standard deviations, shape (k - lead, rows, columns) [1]; NaN where the past does not vary."""
        source = as_frames(frames)
        out = np.empty((source.shape[0] - self.lead, *source.shape[1:]), np.float32)
        n = self.count
        for k in range(out.shape[0]):
            past = source[k : k + n].astype(np.float64)
            with np.errstate(invalid="ignore", divide="ignore"):
                deviation = past.std(axis=0, ddof=1)
                ratio = (source[k + self.lead] - past.mean(axis=0)) / (deviation * np.sqrt(1.0 + 1.0 / n))
            nodes, z = _student(n - 1)
            out[k] = np.interp(np.where(deviation > 0, ratio, np.nan), nodes, z)
        return out


@dataclass(frozen=True)
class TrackBeforeDetect:
    """Detector by the largest sum of a pixel's brightness along all tracks that end in it.

        I_1 = z_1,  I_k(x) = z_k(x) + max over steps d of at most v of I_(k-1)(x + d),  T = I_n / sqrt(n)

    with z_k the frames. The maximum lifts the mean of noise, which a threshold above the measured mean takes off. No track passes through
    a missing pixel.

    Parameters
    ----------
    count : int
        Frames of a track, at least 2.
    speed : int
        Largest motion from frame to frame, rows and columns alike [px], at least 0.
    """

    count: int = 8
    speed: int = 1
    name: str = field(default="track-before-detect", init=False)
    calibrated: bool = field(default=False, init=False)
    linear: bool = field(default=False, init=False)
    null_law: None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if self.count < 2 or self.speed < 0:
            raise DomainError(f"count = {self.count} frames and speed = {self.speed} px a frame; at least 2 and 0 are needed")

    @property
    def lead(self) -> int:
        """Number of frames before the latest [frames]."""
        return self.count - 1

    @property
    def reach(self) -> int:
        """Greatest length of a track [px]."""
        return self.lead * self.speed

    def __call__(self, frames: Frames) -> Frames:
        """Statistic of the tracks that end in each pixel, shape (k - lead, rows, columns); NaN where the pixel is missing."""
        from scipy.ndimage import maximum_filter

        source = as_frames(frames)
        side = 2 * self.speed + 1
        # A missing pixel ends every track through it.
        z = np.where(np.isnan(source), -np.inf, source)
        out = np.empty((source.shape[0] - self.lead, *source.shape[1:]), np.float32)
        for k in range(out.shape[0]):
            total = z[k].astype(np.float64)
            for later in z[k + 1 : k + self.count]:
                # The best track into a pixel comes from its neighbourhood in the frame before.
                total = later + maximum_filter(total, side, mode="nearest")
            out[k] = np.where(np.isfinite(total), total, np.nan) / np.sqrt(self.count)
        return out
