r"""Sampling of a fine picture of the radiance by the detector's pixels: blur and integration in one pass, with the sensor's aliasing.

The picture has ``n x n`` pixels in each of the detector's, each the mean over its area. In frequency the detector's mean is then

.. math::

    \hat L_{det} = \hat L_{fine}\; H_{optics}(|f|)\;
    \frac{\mathrm{sinc}(f_x w)\,\mathrm{sinc}(f_y w)}{\mathrm{sinc}(f_x c)\,\mathrm{sinc}(f_y c)}

with the width ``w`` of the sensitive square and ``c`` of a fine pixel. At a fill factor of 1 the quotient is the transfer of a sum over
``n x n`` fine pixels exactly; sampling at the detector's pitch folds the spectrum, which is the sensor's own aliasing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import scipy.fft
import scipy.ndimage
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.instrument.detector import crosstalk_mtf, square_mtf
from seaglint.instrument.optics import Blur, motion_mtf

MARGIN: Final = 8
"""Least number of pixels by which the picture's border is continued."""

MOST_OVERSAMPLING: Final = 15
"""Largest number of fine pixels along a side of a detector's."""

AIRY_RINGS: Final = 6.0
"""Margin in units of the blur's diameter (wavelength times f-number)."""

WINGS: Final = 0.001
"""Largest share of an edge's step that may wrap around over the margin from the picture's other side.

The wings of diffraction fall only as the distance: of an edge ``x`` away the share ``s / (2 pi^2 x)`` is left, with the fall ``s`` of the
transfer at frequency 0. A margin of six rings lets through 0.005, which raises the whole MTF of a slanted edge by 0.01.
"""

MOST_MARGIN: Final = 64
"""Largest margin for those wings [pixels], or half the picture's side where that is more: wider ones cost more than they change."""


@dataclass(frozen=True)
class Sampling:
    """Sampling of the picture by the detector.

    Attributes
    ----------
    step : float
        Angle between pixels [rad].
    width : float
        Angle of the sensitive square's side [rad].
    oversampling : int
        Fine pixels along a side of a pixel.
    crosstalk : float
        Share that goes to the four neighbours.
    smear : (float, float)
        Steady movement of the line of sight during an exposure, along rows and across them [rad].
    circle : bool
        Whether the picture goes all round, so that its last column is followed by the first.
    """

    step: float
    width: float
    oversampling: int
    crosstalk: float = 0.0
    smear: tuple[float, float] = (0.0, 0.0)
    circle: bool = False
    points: bool = False
    """Whether the picture's values are light without extent in the middle of its pixels, rather than means over them."""


def needed_oversampling(step: float, cutoff: float) -> int:
    """Fine pixels along a side of pixels ``step`` [rad] apart for optics of a cut-off [cycles rad-1].

    >>> needed_oversampling(0.15e-3, 0.1 / 3.5e-6)
    9
    """
    return int(min(max(math.ceil(2.0 * step * cutoff * (1.0 - 1e-9)), 1), MOST_OVERSAMPLING))


def require_divides(shape: tuple[int, int], oversampling: int) -> tuple[int, int]:
    """Size of the detector under a fine picture; refuse sizes that do not divide.

    Raises
    ------
    DomainError
        A picture that is no whole number of pixels.
    """
    rows, columns = shape
    if oversampling < 1 or rows % oversampling or columns % oversampling:
        fits = [n for n in range(1, MOST_OVERSAMPLING + 1) if rows % n == 0 and columns % n == 0]
        raise DomainError(
            f"oversampling = {oversampling} does not divide a picture of {rows} rows and {columns} columns; give one of "
            f"{', '.join(map(str, fits))}, or cut the picture to {rows // max(oversampling, 1) * oversampling} x "
            f"{columns // max(oversampling, 1) * oversampling}",
            name="oversampling",
            value=oversampling,
            allowed=", ".join(map(str, fits)),
        )
    return rows // oversampling, columns // oversampling


@dataclass(frozen=True, eq=False)
class Transfer:
    """Blur and sampling of pictures of one size; make it with :meth:`of`."""

    sampling: Sampling
    shape: tuple[int, int]
    """Numbers of rows and columns of the detector."""
    before: tuple[int, int]
    """Pixels of margin above and to the left."""
    padded: tuple[int, int]
    """Numbers of rows and columns with the margins."""
    filter: NDArray[np.complex64] = field(repr=False)

    @classmethod
    def of(cls, blur: Blur, sampling: Sampling, fine_shape: tuple[int, int]) -> Transfer:
        """Prepare the transfer for fine pictures (rows, columns).

        Raises
        ------
        DomainError
            A picture that the oversampling does not divide.
        """
        n, step = sampling.oversampling, sampling.step
        shape = require_divides(fine_shape, n)
        spread = AIRY_RINGS / (blur.optics.cutoff(blur.wavelength) * step) + 4.0 * blur.optics.jitter / step
        frequency, table = blur.table()
        wings = float(table[0] - table[1]) / float(frequency[1]) / (2.0 * math.pi**2 * WINGS * step)
        margin = tuple(
            math.ceil(max(MARGIN + spread, min(wings, max(0.5 * side, MOST_MARGIN))) + abs(smear) / step)
            for side, smear in zip(shape, (sampling.smear[1], sampling.smear[0]), strict=True)
        )
        rows = int(scipy.fft.next_fast_len(shape[0] + 2 * margin[0], real=True))
        # A full circle needs no margin: the last column is followed by the first.
        columns = shape[1] if sampling.circle else int(scipy.fft.next_fast_len(shape[1] + 2 * margin[1], real=True))
        before = (margin[0], 0 if sampling.circle else margin[1])
        x = scipy.fft.rfftfreq(n * columns, step / n)
        y = scipy.fft.fftfreq(n * rows, step / n)
        total = product(blur, sampling, x[None, :], y[:, None], 0.0 if sampling.points else step / n)
        # A pixel's middle is half of n - 1 fine pixels behind its first one's.
        middle = 0.5 * (n - 1) * step / n
        phase = np.exp(2j * np.pi * x * middle)[None, :] * np.exp(2j * np.pi * y * middle)[:, None]
        return cls(sampling, shape, before, (rows, columns), (total * phase).astype(np.complex64))

    def __call__(self, fine: NDArray[np.float32]) -> NDArray[np.float32]:
        """Mean radiance on each pixel's sensitive square [units of ``fine``, (rows, columns), or (time, rows, columns)]."""
        if fine.ndim == 3:
            return np.stack([self(picture) for picture in fine])
        n, (rows, columns) = self.sampling.oversampling, self.padded
        if fine.shape != (self.shape[0] * n, self.shape[1] * n):
            raise DomainError(
                f"a picture of {fine.shape} for a sensor prepared for {(self.shape[0] * n, self.shape[1] * n)}; prepare another"
            )
        level = np.float32(fine.mean(dtype=np.float64))  # the transformed values are small: single precision rounds little
        given = np.pad(fine - level, [_pads(n * self.before[i], n * self.shape[i], n * self.padded[i]) for i in (0, 1)], mode="edge")
        spectrum = scipy.fft.rfft2(given)
        spectrum *= self.filter
        folded = spectrum.reshape(n, rows, -1).sum(axis=0) / np.float32(n)
        lines = scipy.fft.ifft(folded, axis=0)
        out = scipy.fft.irfft(lines, n * columns, axis=1)[:, ::n]
        top, left = self.before
        return np.asarray(out[top : top + self.shape[0], left : left + self.shape[1]] + level * self.filter[0, 0].real, np.float32)


def product(blur: Blur, sampling: Sampling, along: FloatArray, across: FloatArray, grain: float = 0.0) -> FloatArray:
    """Transfer of optics, crosstalk, the sensitive square and steady movement together [1, broadcast shape].

    Parameters
    ----------
    blur : Blur
        Transfer of the optics.
    sampling : Sampling
        Pixels and movement; its oversampling does not matter.
    along, across : ndarray
        Frequencies along rows and across them [cycles rad-1].
    grain : float
        Angle of the picture's own pixels, whose means they are: the blur of these is divided out [rad].
    """
    total = np.interp(np.hypot(along, across), *blur.table(), right=0.0)
    if sampling.crosstalk:
        total *= crosstalk_mtf(along, across, sampling.crosstalk, sampling.step)
    sides = [square_mtf(frequency, sampling.width) / square_mtf(frequency, grain) for frequency in (along, across)]
    total *= sides[0] * sides[1]
    if any(sampling.smear):
        total *= motion_mtf(along * sampling.smear[0] + across * sampling.smear[1], 1.0)
    return np.asarray(total)


def isolated(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """What each pixel has above the brightest of its eight neighbours, 0 where it has less [units of ``picture``, (rows, columns)].

    Light that falls into one fine pixel alone has no extent that the picture tells: the mean over the pixel is that of a point in it.
    """
    around = scipy.ndimage.maximum_filter(picture, footprint=_AROUND, mode="nearest")
    return np.asarray(np.maximum(picture - around, 0.0), np.float32)


_AROUND: Final = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], bool)


def _pads(before: int, size: int, whole: int) -> tuple[int, int]:
    return before, whole - size - before
