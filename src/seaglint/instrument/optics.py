r"""Optics: transmitted light on the focal plane, and sharpness.

Spatial frequencies ``f`` are cycles per radian at the aperture. Each cause of blur has a transfer function (MTF), and the total transfer is
their product:

.. math::

    \text{diffraction} &= \langle \text{overlap of two pupils shifted by } f\lambda/D \rangle_\lambda
    \quad\Bigl(\tfrac{2}{\pi}(\arccos v - v\sqrt{1-v^2})\text{ for a clear circle, } v = f\lambda/D\Bigr) \\
    \text{wavefront} &= 1 - (W/0.18)^2\,(1 - 4(v-\tfrac12)^2) \\
    \text{jitter} &= \exp(-2\pi^2 s^2 f^2) \qquad \text{motion} = \mathrm{sinc}(f\,\omega t)

References
----------
J. W. Goodman, Introduction to Fourier Optics, 3rd ed., 6.3-6.4 (pupils and their autocorrelation, defocus); R. R. Shannon, The Art and
Science of Optical Design (1997), 4.8 (wavefront error); G. C. Holst, Electro-Optical Imaging System Performance (jitter, motion).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

SHANNON_LIMIT: Final = 0.18  #: Rms wavefront error [waves] at which Shannon's fit reaches 0 at half the cut-off; it holds below.

PUPIL_POINTS: Final = 512  #: Number of points across the overlap of two pupils: MTFs within 1e-5.

NODES: Final = 512  #: Number of nodes of a tabulated MTF between 0 and the cut-off; linear between them it is within 1e-5.

SHARPEST: Final = 0.0045  #: Product of jitter and the table's step up to which linear interpolation of its transfer is within 1e-4.

SolidAngle = Literal["sine", "thin-lens"]


@dataclass(frozen=True)
class SensorOptics:
    r"""Optics of a sensor: pupil, transmittance, blur, distortion."""

    aperture: float  #: Diameter of the entrance pupil [m].
    focal_length: float  #: Focal length [m].
    transmission: float = 1.0  #: Transmittance of the optics, in the band [1].
    obscuration: float = 0.0  #: Diameter of the central obscuration over the diameter of the pupil [1].
    wavefront_error: float = 0.0  #: Rms error of the wavefront at the mean wavelength [waves].
    defocus: float = 0.0  #: Peak error of the wavefront by defocus, at the pupil's edge, at the mean wavelength [waves].
    jitter: float = 0.0  #: Rms movement of the line of sight during an exposure, in each direction [rad].
    drift: tuple[float, float] = (0.0, 0.0)  #: Steady movement of the line of sight, along and across rows [rad s-1].
    temperature: float = 293.15  #: Temperature of warm optics, which radiate into the detector [K].
    emissivity: float = 0.0  #: Emissivity of the optics [1].
    #: F-number of the cold shield; if it is lower than the f-number of the optics, the housing around them (black, at ``temperature``)
    #: radiates into the detector. None for a shield that fits.
    cold_shield_f_number: float | None = None
    stray_share: float = 0.0  #: Share of the light that is scattered evenly over the picture [1].
    cos4: bool = False  #: Illumination falls with the fourth power of the field angle's cosine.
    #: Relative radial shift of the picture's corners; it grows with the square of the distance from the axis; positive is pincushion [1].
    distortion: float = 0.0
    #: :math:`\pi/(4F^2)` of optics that obey the sine condition (point and extended sources then agree), or :math:`\pi/(4F^2+1)`.
    solid_angle_law: SolidAngle = "sine"

    def __post_init__(self) -> None:
        if not 0.0 <= self.obscuration < 1.0:
            raise DomainError(
                f"obscuration = {self.obscuration:g} leaves no pupil; give a share of the diameter from 0 to below 1",
                name="obscuration",
                value=self.obscuration,
                allowed="0 to below 1",
            )
        if not 0.0 <= self.wavefront_error <= SHANNON_LIMIT:
            raise DomainError(
                f"wavefront error = {self.wavefront_error:g} waves is beyond Shannon's fit; give 0 to {SHANNON_LIMIT:g} waves rms",
                name="wavefront_error",
                value=self.wavefront_error,
                allowed=(0.0, SHANNON_LIMIT),
            )

    @property
    def f_number(self) -> float:
        """Focal length over aperture [1]."""
        return self.focal_length / self.aperture

    @property
    def open_share(self) -> float:
        """Open share of the pupil's area, without the obscuration [1]."""
        return 1.0 - self.obscuration**2

    @property
    def solid_angle(self) -> float:
        """Projected solid angle of light on a detector on the axis, without the obscuration [sr], by the sine condition."""
        return cone(self.f_number, self.solid_angle_law) * self.open_share

    @property
    def pupil_area(self) -> float:
        """Open area of the pupil [m2]."""
        return 0.25 * math.pi * self.aperture**2 * self.open_share

    @property
    def housing_solid_angle(self) -> float:
        """Solid angle of warm housing within an oversized cold shield [sr]."""
        if self.cold_shield_f_number is None or self.cold_shield_f_number >= self.f_number:
            return 0.0
        return cone(self.cold_shield_f_number, self.solid_angle_law) - cone(self.f_number, self.solid_angle_law)

    def cutoff(self, wavelength: float) -> float:
        """Return the cut-off frequency of the optics at a wavelength [m] [cycles rad-1]."""
        return self.aperture / wavelength


def cone(f_number: float, law: SolidAngle = "sine") -> float:
    r"""Return the projected solid angle of a cone of light [sr].

    >>> round(cone(2.0), 4), round(cone(2.0, "thin-lens"), 4)
    (0.1963, 0.1848)
    """
    # pi sin^2 of half the cone: sin = 1/(2F), or tan = 1/(2F) of a thin lens
    return math.pi / (4.0 * f_number**2 + (1.0 if law == "thin-lens" else 0.0))


def pupil_mtf(v: ArrayLike, obscuration: float = 0.0, defocus: float = 0.0) -> FloatArray:
    r"""Return the transfer of an annular pupil [1]: the overlap of two, shifted by ``v`` diameters, with the phase of defocus.

    Parameters
    ----------
    v : array_like
        Frequency over the cut-off, ``f lambda / D`` [1].
    obscuration : float
        Inner over outer diameter [1].
    defocus : float
        Path error at the pupil's edge [waves]; beyond half a wave contrast reverses and values are negative.

    Returns
    -------
    ndarray
        Transfer [1, shape of ``v``]; 0 from ``v = 1`` on.

    Notes
    -----
    The chord of the overlap at each place along the shift is exact, the integral along it a sum of ``PUPIL_POINTS`` midpoints in the
    angle whose sine is the place, which takes up the square roots at the ends.

    Examples
    --------
    >>> v = 0.5
    >>> closed = 2 / np.pi * (np.arccos(v) - v * np.sqrt(1 - v * v))
    >>> bool(abs(pupil_mtf(v) - closed) < 1e-5)
    True
    """
    given = np.minimum(np.abs(np.asarray(v, np.float64)), 1.0)
    angle = (np.arange(PUPIL_POINTS) + 0.5) / PUPIL_POINTS * 0.5 * np.pi
    s, end = given[..., None], (1.0 - given)[..., None]
    x, dx = end * np.sin(angle), end * np.cos(angle) * (0.5 * np.pi / PUPIL_POINTS)
    upper = np.sqrt(np.maximum(1.0 - (x + s) ** 2, 0.0))
    # half of the overlap is integrated, where the nearer of the two inner circles is the wider gap; it covers the other one's gap
    lower = np.sqrt(np.maximum(obscuration**2 - (x - s) ** 2, 0.0))
    chord = np.maximum(upper - lower, 0.0)
    wave = np.cos(8.0 * np.pi * defocus * s * x) if defocus else 1.0
    return np.asarray(np.sum(4.0 * chord * wave * dx, axis=-1) / (np.pi * (1.0 - obscuration**2)))


def wavefront_mtf(v: ArrayLike, rms: float) -> FloatArray:
    """Return Shannon's factor [1] for an rms wavefront error [waves] at a frequency over the cut-off, 1 beyond it.

    >>> round(float(wavefront_mtf(0.5, 0.09)), 2)
    0.75
    """
    part = np.clip(np.abs(np.asarray(v, np.float64)), 0.0, 1.0)
    return np.asarray(1.0 - (rms / SHANNON_LIMIT) ** 2 * (1.0 - 4.0 * (part - 0.5) ** 2))


def jitter_mtf(frequency: ArrayLike, rms: float) -> FloatArray:
    """Return the transfer [1] of random movement, rms [rad] in each direction, at frequencies [cycles rad-1]."""
    return np.asarray(np.exp(-2.0 * (np.pi * rms * np.asarray(frequency, np.float64)) ** 2))


def motion_mtf(frequency: ArrayLike, angle: float) -> FloatArray:
    """Return the transfer [1] of steady movement through an angle [rad]; it reverses contrast beyond its first zero."""
    return np.asarray(np.sinc(np.asarray(frequency, np.float64) * angle))


@dataclass(frozen=True, eq=False)
class Blur:
    """Transfer of the optics for the spectrum of a detector; make it with ``of``."""

    optics: SensorOptics  #: The optics.
    wavelength: float  #: Mean wavelength [m].
    frequency: FloatArray = field(repr=False)  #: Frequencies of the tables [cycles rad-1].
    diffraction: FloatArray = field(repr=False)  #: Mean transfer over the band without defocus [1].
    defocused: FloatArray = field(repr=False)  #: Mean transfer over the band with defocus [1].

    @classmethod
    def of(cls, optics: SensorOptics, wavelength: FloatArray, share: FloatArray) -> Blur:
        """Average over wavelengths [m], weighted with the share of the electrons at each."""
        mean = float(wavelength @ share)
        nodes = np.linspace(0.0, 1.0, NODES + 1)
        frequency = nodes * optics.cutoff(float(wavelength.min()))
        v = frequency[:, None] * wavelength / optics.aperture
        clear = pupil_mtf(nodes, optics.obscuration)
        # an error of the optical path is equal in metres, not in waves, at all wavelengths; 16 of them represent a defocused band
        diffraction = np.interp(v, nodes, clear) @ share
        if optics.defocus == 0.0:
            return cls(optics, mean, frequency, diffraction, diffraction)
        # parts without electrons have no mean wavelength: bands of less than 16 samples, and samples without response
        bins = [part for part in np.array_split(np.argsort(wavelength), 16) if share[part].sum() > 0.0]
        weight = np.array([share[part].sum() for part in bins])
        middle = np.array([(wavelength[part] @ share[part]) / w for part, w in zip(bins, weight, strict=True)])
        soft = np.stack(
            [
                np.interp(frequency * w / optics.aperture, nodes, pupil_mtf(nodes, optics.obscuration, optics.defocus * mean / w))
                for w in middle
            ],
            axis=1,
        )
        return cls(optics, mean, frequency, diffraction, soft @ weight)

    def parts(self, frequency: ArrayLike) -> dict[str, FloatArray]:
        """Return the transfer [1] of every cause of blur that is equal in all directions, at frequencies [cycles rad-1]."""
        f = np.abs(np.asarray(frequency, np.float64))
        optics = self.optics
        sharp = np.interp(f, self.frequency, self.diffraction, right=0.0)
        out = {"diffraction": sharp}
        if optics.defocus:
            soft = np.interp(f, self.frequency, self.defocused, right=0.0)
            # a factor on the sharp transfer, so that the product of all causes is the defocused one
            out["defocus"] = np.where(sharp > 1e-9, soft / np.maximum(sharp, 1e-9), 1.0)
        if optics.wavefront_error:
            out["wavefront"] = wavefront_mtf(f * self.wavelength / optics.aperture, optics.wavefront_error)
        if optics.jitter:
            out["jitter"] = jitter_mtf(f, optics.jitter)
        return out

    @property
    def jitter_apart(self) -> float:
        """Jitter that is not in ``table``, as its transfer falls too fast for the table's nodes [rad]; 0 for smaller jitter."""
        jitter = self.optics.jitter
        return jitter if jitter * float(self.frequency[1]) > SHARPEST else 0.0

    def table(self) -> tuple[FloatArray, FloatArray]:
        """Return frequencies from 0 to the cut-off [cycles rad-1] and the product of ``parts`` without ``jitter_apart`` [1]."""
        total = np.ones(self.frequency.size)
        for name, part in self.parts(self.frequency).items():
            if name != "jitter" or not self.jitter_apart:
                total = total * part
        return self.frequency, total


def cos4_falloff(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the relative illumination of the focal plane [1, (rows, columns)] at tangents of the field angle (columns,) and (rows,)."""
    return 1.0 / (1.0 + x[None, :] ** 2 + y[:, None] ** 2) ** 2


def distorted_places(shape: tuple[int, int], share: float) -> tuple[FloatArray, FloatArray]:
    """Return rows and columns of the undistorted picture at each pixel of a distorted one, each (rows, columns).

    A point at the radius ``r`` (1 at the corners) is drawn at ``r (1 + share r^2)``.
    """
    rows, columns = shape
    y, x = np.mgrid[0:rows, 0:columns].astype(np.float64)
    cy, cx = 0.5 * (rows - 1), 0.5 * (columns - 1)
    corner = math.hypot(0.5 * rows, 0.5 * columns)
    drawn = np.hypot(y - cy, x - cx) / corner
    r = drawn.copy()
    for _ in range(30):  # Newton's steps for r (1 + share r^2) = drawn
        r = r - (r * (1.0 + share * r * r) - drawn) / (1.0 + 3.0 * share * r * r)
    scale = np.where(drawn > 0.0, r / np.where(drawn > 0.0, drawn, 1.0), 1.0)
    return cy + (y - cy) * scale, cx + (x - cx) * scale
