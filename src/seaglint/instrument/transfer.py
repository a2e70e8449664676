r"""Sampling of a fine picture of the radiance by the detector's pixels: blur and integration in one pass, with the sensor's aliasing.

The picture has ``n x n`` pixels in each pixel of the detector, each the mean over its area. In frequency the detector's mean is then

.. math::

    \hat L_{det} = \hat L_{fine}\; H_{optics}(|f|)\;
    \frac{\mathrm{sinc}(f_x w)\,\mathrm{sinc}(f_y w)}{\mathrm{sinc}(f_x c)\,\mathrm{sinc}(f_y c)}

with the width ``w`` of the sensitive square and ``c`` of a fine pixel. At a fill factor of 1 the quotient is the transfer of a sum over
``n x n`` fine pixels exactly; sampling at the detector's pitch folds the spectrum, which is the aliasing of the sensor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
import scipy.fft
import scipy.ndimage
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.limits import SHAKEN
from seaglint.instrument.detector import crosstalk_mtf, square_mtf
from seaglint.instrument.optics import Blur, jitter_mtf, motion_mtf

MARGIN: Final = 8  #: Least number of pixels by which the picture's border is continued.

MOST_OVERSAMPLING: Final = 15  #: Largest number of fine pixels along a side of a detector's pixel.

#: Largest share of folded and lost energy along each side of a pixel, of a scene of equal energy at all frequencies.
#:
#: A picture of means over fine pixels that resolves the optics' cut-off exactly folds up to this share (optics whose cut-off is half a
#: cycle in a pixel). Of a scene whose energy falls with the frequency, as that of waves does, a tenth of this share is folded.
FOLDED: Final = 1.0 / 16.0

AIRY_RINGS: Final = 6.0  #: Margin in units of the blur's diameter (wavelength times f-number).

#: Largest share of an edge's step that may wrap around over the margin from the picture's other side.
#:
#: The wings of diffraction fall only with the distance: an edge ``x`` away contributes the share ``s / (2 pi^2 x)``, with the fall ``s`` of
#: the transfer at frequency 0. A margin of six rings admits 0.005, which raises the whole MTF of a slanted edge by 0.01.
WINGS: Final = 0.001

#: Largest margin for those wings [pixels], or half the picture's side where that is more: wider margins cost more than they change.
MOST_MARGIN: Final = 64


#: Memory of a transfer and its use per fine pixel, margins included: tables in double precision during preparation, then spectra [bytes].
BYTES_PER_FINE_PIXEL: Final = 40


@dataclass(frozen=True)
class Sampling:
    """Sampling of the picture by the detector."""

    step: float  #: Angle between pixels [rad].
    width: float  #: Angle of the sensitive square's side [rad].
    oversampling: int  #: Number of fine pixels along a side of a pixel.
    crosstalk: float = 0.0  #: Share that goes to the four neighbours [1].
    smear: tuple[float, float] = (0.0, 0.0)  #: Steady movement of the line of sight during an exposure, along rows and across them [rad].
    circle: bool = False  #: True for a picture of a full circle, whose first column follows its last.
    #: True for values that are light without extent in the middle of pixels, or independent of their neighbours; False for means over
    #: pixels of a field that is continuous.
    points: bool = False
    cells: float = 0.0  #: Side of the cells from which the picture's pixels were averaged [rad]; 0 for a picture that was drawn in them.


def sensor_mtf(blur: Blur, sampling: Sampling, along: FloatArray, across: FloatArray, grain: tuple[float, ...] = ()) -> FloatArray:
    """Return the transfer from the radiance at the aperture to the pixels [1]: optics, sensitive square, crosstalk and movement.

    Pictures, MTF, the response to a point and NEI all use this function.

    Parameters
    ----------
    blur : Blur
        Optics with their jitter.
    sampling : Sampling
        Pixels, crosstalk and movement.
    along, across : ndarray
        Frequencies along rows and across them, which broadcast [cycles rad-1].
    grain : tuple of float
        Sides of the squares over which values of a picture are means [rad]; their blur is divided out.

    Returns
    -------
    ndarray
        Transfer [1]; 0 beyond the optics' cut-off.
    """
    frequency, table = blur.table()
    total = np.asarray(np.interp(np.hypot(along, across), frequency, table, right=0.0))
    if sampling.crosstalk:
        total *= crosstalk_mtf(along, across, sampling.crosstalk, sampling.step)
    for f in (along, across):
        side = square_mtf(f, sampling.width)
        for width in grain:
            side = side / square_mtf(f, width)
        total *= side
    if any(sampling.smear):
        total *= motion_mtf(along * sampling.smear[0] + across * sampling.smear[1], 1.0)
    if blur.jitter_apart:
        total *= jitter_mtf(along, blur.jitter_apart) * jitter_mtf(across, blur.jitter_apart)
    return total


def margins(blur: Blur, sampling: Sampling, shape: tuple[int, int]) -> tuple[int, int]:
    """Return the number of pixels by which a picture of ``shape`` (rows, columns) is continued above and below, and left and right.

    Jitter and movement count up to the side of the picture, or ``MOST_MARGIN``.
    """
    step, jitter = sampling.step, blur.optics.jitter
    frequency, table = blur.table()
    wings = float(table[0] - table[1]) / float(frequency[1]) / (2.0 * math.pi**2 * WINGS * step)
    rings = AIRY_RINGS / (blur.optics.cutoff(blur.wavelength) * step)
    out = []
    for side, smear in zip(shape, (sampling.smear[1], sampling.smear[0]), strict=True):
        most = max(side, MOST_MARGIN)
        # four standard deviations of jitter on top of the optics
        shaken = min(4.0 * jitter / step, most)
        out.append(math.ceil(max(MARGIN + rings + shaken, min(wings, max(0.5 * side, MOST_MARGIN))) + min(abs(smear) / step, most)))
    return out[0], out[1]


def padded_shape(blur: Blur, sampling: Sampling, shape: tuple[int, int]) -> tuple[int, int]:
    """Return rows and columns of a picture with its ``margins`` in the transform; a full circle has no margins at its sides."""
    above, left = margins(blur, sampling, shape)
    rows = int(scipy.fft.next_fast_len(shape[0] + 2 * above, real=True))
    return rows, shape[1] if sampling.circle else int(scipy.fft.next_fast_len(shape[1] + 2 * left, real=True))


def needed_oversampling(step: float, cutoff: float) -> int:
    """Return the number of fine pixels along a side of pixels ``step`` [rad] apart, for optics of a cut-off [cycles rad-1].

    >>> needed_oversampling(0.15e-3, 0.1 / 3.5e-6)
    9
    """
    return int(min(max(math.ceil(2.0 * step * cutoff * (1.0 - 1e-9)), 1), MOST_OVERSAMPLING))


def folded_share(blur: Blur, sampling: Sampling, oversampling: int) -> float:
    r"""Return the error of the energy on the pixels from a drawing with ``oversampling`` columns or rows in a pixel [1].

    The scene has equal energy at all frequencies. Means over fine pixels of side ``c`` fold it onto lower frequencies, where the blur of
    the means is divided out; frequencies beyond half of the drawing's are lost:

    .. math:: \frac{\int_{|f|<1/2c} |H|^2 (\mathrm{sinc}^{-2}(f c) - 1)\,df + \int_{|f|>1/2c} |H|^2\,df}{\int |H|^2\,df}

    with the transfer ``H`` of the sensor, integrated over the frequencies across.
    """
    highest = float(blur.table()[0][-1])
    f = (np.arange(_FREQUENCIES) + 0.5) / _FREQUENCIES * highest
    energy = (sensor_mtf(blur, replace(sampling, smear=(0.0, 0.0)), f[None, :], f[:, None]) ** 2).sum(axis=0)
    turns = f * sampling.step / oversampling
    seen = turns < 0.5
    folded = energy[seen] @ (1.0 / np.sinc(turns[seen]) ** 2 - 1.0)
    return float((folded + energy[~seen].sum()) / energy.sum())


_FREQUENCIES: Final = 512  #: Number of frequencies along each axis for ``folded_share``, up to the cut-off.


def sufficient_oversampling(blur: Blur, sampling: Sampling, most: int) -> int:
    """Return the least number of fine pixels along a side of a pixel, up to ``most``, whose ``folded_share`` is ``FOLDED``."""
    return next((n for n in range(1, most) if folded_share(blur, sampling, n) <= FOLDED), most)


def require_divides(shape: tuple[int, int], oversampling: int) -> tuple[int, int]:
    """Return the size of the detector under a fine picture; raise for sizes that do not divide.

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


def require_steady(jitter: float, shape: tuple[int, int]) -> None:
    """Raise for an rms jitter [pixels] that is too wide for a picture of ``shape``.

    Raises
    ------
    DomainError
        Jitter beyond ``SHAKEN``.
    """
    most = max(SHAKEN[0] * min(shape), SHAKEN[1])
    if jitter > most:
        raise DomainError(
            f"jitter = {jitter:.4g} pixels rms is too wide for a picture of {shape[0]} x {shape[1]} pixels; allowed are up to {most:g} "
            "pixels: lower the jitter or give a larger picture",
            name="jitter",
            value=jitter,
            allowed=f"up to {most:g} pixels",
        )


@dataclass(frozen=True, eq=False)
class Transfer:
    """Blur and sampling of pictures of one size; make it with ``of``."""

    sampling: Sampling
    shape: tuple[int, int]  #: Numbers of rows and columns of the detector.
    before: tuple[int, int]  #: Pixels of margin above and to the left.
    padded: tuple[int, int]  #: Numbers of rows and columns with the margins.
    filter: NDArray[np.complex64] = field(repr=False)

    @classmethod
    def of(cls, blur: Blur, sampling: Sampling, fine_shape: tuple[int, int]) -> Transfer:
        """Prepare the transfer for fine pictures (rows, columns).

        Raises
        ------
        DomainError
            A picture that the oversampling does not divide, or jitter beyond ``SHAKEN``.
        """
        n, step = sampling.oversampling, sampling.step
        shape = require_divides(fine_shape, n)
        require_steady(blur.optics.jitter / step, shape)
        rows, columns = padded_shape(blur, sampling, shape)
        margin = margins(blur, sampling, shape)
        before = (margin[0], 0 if sampling.circle else margin[1])
        x = scipy.fft.rfftfreq(n * columns, step / n)
        y = scipy.fft.fftfreq(n * rows, step / n)
        # means over fine pixels, and of cells: as they were drawn (not of points), and as squares under the pixels
        drawn = sampling.cells or step / n
        grain = () if sampling.points else (drawn,)
        if sampling.cells:
            grain = (*grain, sampling.cells, step / n)
        total = sensor_mtf(blur, sampling, x[None, :], y[:, None], grain)
        # the middle of a pixel is (n - 1) / 2 fine pixels behind the middle of its first fine pixel
        middle = 0.5 * (n - 1) * step / n
        phase = np.exp(2j * np.pi * x * middle)[None, :] * np.exp(2j * np.pi * y * middle)[:, None]
        return cls(sampling, shape, before, (rows, columns), (total * phase).astype(np.complex64))

    def __call__(self, fine: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the mean radiance on each pixel's sensitive square [units of ``fine``, (rows, columns), or (time, rows, columns)]."""
        if fine.ndim == 3:
            return np.stack([self(picture) for picture in fine])
        n, (rows, columns) = self.sampling.oversampling, self.padded
        if fine.shape != (self.shape[0] * n, self.shape[1] * n):
            raise DomainError(
                f"a picture of {fine.shape} for a sensor prepared for {(self.shape[0] * n, self.shape[1] * n)}; prepare another"
            )
        level = np.float32(fine.mean(dtype=np.float64))  # the transformed values are small: single precision rounds little
        padded = np.pad(fine - level, [_pads(n * self.before[i], n * self.shape[i], n * self.padded[i]) for i in (0, 1)], mode="edge")
        spectrum = scipy.fft.rfft2(padded)
        spectrum *= self.filter
        # taking every n-th row of the result is a sum over n parts of its spectrum: the transform along columns is n times shorter
        folded = spectrum.reshape(n, rows, -1).sum(axis=0) / np.float32(n)
        lines = scipy.fft.ifft(folded, axis=0)
        out = scipy.fft.irfft(lines, n * columns, axis=1)[:, ::n]
        top, left = self.before
        return np.asarray(out[top : top + self.shape[0], left : left + self.shape[1]] + level * self.filter[0, 0].real, np.float32)


def isolated(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the excess of each pixel over the brightest of its eight neighbours, or 0 [units of ``picture``, (rows, columns)].

    The extent of light in a single fine pixel is not known from the picture: the mean over the pixel is taken as the mean of a point in it.
    """
    around = scipy.ndimage.maximum_filter(picture, footprint=_AROUND, mode="nearest")
    return np.asarray(np.maximum(picture - around, 0.0), np.float32)


_AROUND: Final = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], bool)


def _pads(before: int, size: int, whole: int) -> tuple[int, int]:
    return before, whole - size - before
