r"""Spectral emissivity of hot carbon dioxide and water vapour: the exponential wide-band model of Edwards.

Lines of a band of strength :math:`\alpha` have mean intensities per spacing that fall exponentially from the head or centre of the band,

.. math:: \kappa(\nu) = \frac{\alpha}{\omega} \exp\left(-\frac{|\nu - \nu_0|}{\omega}\right),

with :math:`2 |\nu - \nu_0|` in bands with two wings. A path of :math:`X` grams of the gas per square metre absorbs

.. math:: \varepsilon(\nu) = \min\left(\kappa X,\ \sqrt{\beta \kappa X},\ 1\right)

on the average over its lines, for weak lines, for strong lines, and for lines that overlap so much that the gas is opaque (for
:math:`\beta > 1` without the root: weak lines overlap already). The integral over the band is Edwards' absorption in its three regimes,
linear, root and logarithm, to which the parameters were fitted. (The smooth transmittance of Goody's statistical model instead gives total
emissivities 20 % below Leckner's.) Transmittances of bands that overlap multiply. The bands have
:math:`\omega = \omega_0 \sqrt{T/T_0}`, :math:`\beta = \beta_0 \sqrt{T_0/T}\, \Phi(T)/\Phi(T_0)\, P_e` and

.. math:: \alpha = \alpha_0 \frac{(1 - e^{-\sum u_k \delta_k})\, \Psi(T)}{(1 - e^{-\sum u_{0,k} \delta_k})\, \Psi(T_0)},\quad
   P_e = \left[\frac{p}{p_0} (1 + (b-1)\, x)\right]^n,

where :math:`\Psi` and :math:`\Phi` are sums over the vibrational levels, :math:`x` is the mole fraction, :math:`T_0` = 100 K and
:math:`p_0` = 1 atm.

Total emissivities at 400-2000 K agree with Leckner's (1972) within 18 %, mostly within 10 %. Spectra are means over some 25 cm-1. Soot and
other gases are not included. ``plume_emissivity`` tabulates emissivities of plumes along chords of all lengths, at the samples of a
band.

References
----------
Edwards, D. K., and W. A. Menard (1964), Applied Optics 3, 621-625; Edwards, D. K. (1976), Advances in Heat Transfer 12, 115-193;
parameters as in Modest, M. F. (2013), Radiative Heat Transfer, 3rd ed., section 11.10 and table 11.3;
Leckner, B. (1972), Combustion and Flame 19, 33-48.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy import constants
from scipy.sparse import csr_array

from seaglint.base.conventions import FloatArray
from seaglint.objects.body import GasPlume
from seaglint.optics.blackbody import SECOND_RADIATION

REFERENCE: Final = 100.0  #: Temperature at which the bands' parameters are given [K].

_LEVELS: Final = np.arange(600)  #: Vibrational levels of the sums: at 4000 K the last of the lowest mode is below 1e-30.


@dataclass(frozen=True)
class WideBand:
    """Parameters of a band of a gas at 100 K."""

    wavenumber_cm: float  #: Upper head of the band, or its centre where ``both`` is true [cm-1].
    steps: tuple[tuple[int, ...], ...]  #: Change of the quantum number of each vibration.
    exponent: float  #: Exponent of the effective pressure [1].
    strength: tuple[float, ...]  #: Integrated mass absorption [cm-1 / (g m-2)]; several for bands at one place, with ``steps`` for each.
    overlap: float  #: Widths of lines over their spacing, times pi [1].
    width: float  #: Wavenumbers over which the intensity falls to 1/e [cm-1].
    both: bool  #: True for a band with two wings.


@dataclass(frozen=True)
class Gas:
    """Molecule with its vibrations and bands."""

    molar_mass: float  #: Molar mass [g mol-1].
    vibrations_cm: tuple[float, ...]  #: Wavenumbers of its vibrations [cm-1].
    degeneracy: tuple[int, ...]  #: Number of vibrations at each of them.
    #: Self-broadening over broadening by nitrogen: a part that falls with the root of the temperature, and a constant [1].
    broadening: tuple[float, float]
    bands: tuple[WideBand, ...]  #: Its bands.


#: Carbon dioxide: 15, 10.4, 9.4, 4.3, 2.7 and 2.0 um.
CARBON_DIOXIDE: Final = Gas(
    44.0095,
    (1351.0, 667.0, 2396.0),
    (1, 2, 1),
    (0.0, 1.3),
    (
        WideBand(667.0, ((0, 1, 0),), 0.7, (19.0,), 0.06157, 12.7, True),
        WideBand(960.0, ((-1, 0, 1),), 0.8, (2.47e-9,), 0.04017, 13.4, True),
        WideBand(1060.0, ((0, -2, 1),), 0.8, (2.48e-9,), 0.11888, 10.1, True),
        WideBand(2410.0, ((0, 0, 1),), 0.8, (110.0,), 0.24723, 11.2, False),
        WideBand(3660.0, ((1, 0, 1),), 0.65, (4.0,), 0.13341, 23.5, True),
        WideBand(5200.0, ((2, 0, 1),), 0.65, (0.066,), 0.39305, 34.5, True),
    ),
)

#: Water vapour: rotation, 6.3, 2.7, 1.87 and 1.38 um.
WATER_VAPOUR: Final = Gas(
    18.01528,
    (3652.0, 1595.0, 3756.0),
    (1, 1, 1),
    (8.6, 0.5),
    (
        WideBand(140.0, ((0, 0, 0),), 1.0, (44205.0,), 0.14311, 69.3, True),
        WideBand(1600.0, ((0, 1, 0),), 1.0, (41.2,), 0.09427, 56.4, True),
        WideBand(3760.0, ((0, 2, 0), (1, 0, 0), (0, 0, 1)), 1.0, (0.19, 2.30, 22.40), 0.13219, 60.0, True),
        WideBand(5350.0, ((0, 1, 1),), 1.0, (3.0,), 0.08169, 43.1, True),
        WideBand(7250.0, ((1, 0, 1),), 1.0, (2.5,), 0.11628, 32.0, True),
    ),
)

#: Wavenumbers of band heads, above which a band ends at once [cm-1].
HEADS: Final = tuple(band.wavenumber_cm for gas in (CARBON_DIOXIDE, WATER_VAPOUR) for band in gas.bands if not band.both)


def emissivity(wavenumber_cm: ArrayLike, path: ArrayLike, temperature: float, co2_share: float, h2o_share: float) -> FloatArray:
    """Return the spectral emissivity of a mixture of gases at 1 atm [1, (paths, n)], a mean over some 25 cm-1.

    Parameters
    ----------
    wavenumber_cm : array_like
        Wavenumbers [cm-1, (n,)].
    path : array_like
        Lengths of paths through the gas [m, (paths,)].
    temperature : float
        Temperature of the gas [K].
    co2_share, h2o_share : float
        Mole fractions of carbon dioxide and water vapour [1].

    Returns
    -------
    ndarray
        Emissivity [1, (paths, n)].

    Examples
    --------
    >>> emissivity([2100.0, 2250.0, 2500.0], [1.0], 1000.0, 0.1, 0.1).round(2)
    array([[0.04, 1.  , 0.  ]])
    """
    nu, length = np.asarray(wavenumber_cm, np.float64), np.asarray(path, np.float64)
    transmittance = np.ones((length.size, nu.size))
    for gas, share in ((CARBON_DIOXIDE, co2_share), (WATER_VAPOUR, h2o_share)):
        if share <= 0.0:
            continue
        # grams of the gas per square metre, by the law of ideal gases
        column = length[:, None] * share * gas.molar_mass * constants.atm / (constants.R * temperature)
        for band in gas.bands:
            strength, overlap, width = band_at(gas, band, temperature, share)
            weak = strength / width * _shape(band, nu, width) * column
            absorbed = np.minimum(weak, np.sqrt(overlap * weak)) if overlap < 1.0 else weak
            transmittance *= 1.0 - np.minimum(absorbed, 1.0)
    return np.asarray(1.0 - transmittance)


def _shape(band: WideBand, nu: FloatArray, width: float) -> FloatArray:
    """Return the mean intensity of lines over the intensity at the head or centre [1]; 0 above a head."""
    if band.both:
        return np.asarray(np.exp(-2.0 * np.abs(nu - band.wavenumber_cm) / width))
    below = band.wavenumber_cm - nu
    return np.asarray(np.where(below >= 0.0, np.exp(-np.maximum(below, 0.0) / width), 0.0))


@lru_cache(maxsize=256)
def band_at(gas: Gas, band: WideBand, temperature: float, share: float) -> tuple[float, float, float]:
    """Return strength [cm-1 / (g m-2)], line overlap [1] and width [cm-1] of a band at a temperature [K], for a share of the gas in 1 atm.

    Components at one place add: their strengths, and the roots of strength times overlap (Modest 2013, section 11.10).
    """
    ratio = REFERENCE / temperature
    # effective pressure in atm: the module's P_e at p = p_0
    pressure = (1.0 + (gas.broadening[0] * ratio**0.5 + gas.broadening[1] - 1.0) * share) ** band.exponent
    strengths, overlaps = [], []
    for steps, strength in zip(band.steps, band.strength, strict=True):
        if not any(steps):  # rotation: no vibration changes, and Edwards has a separate law
            strengths.append(strength * float(np.exp(-9.0 * ratio**0.5)))
            overlaps.append(band.overlap * ratio**0.5)
            continue
        populated, mean = _levels(gas, steps, temperature)
        populated_cold, mean_cold = _levels(gas, steps, REFERENCE)
        strengths.append(strength * populated / populated_cold)
        overlaps.append(band.overlap * ratio**0.5 * mean / mean_cold)
    total = float(sum(strengths))
    joined = float(sum((a * b) ** 0.5 for a, b in zip(strengths, overlaps, strict=True))) ** 2 / total
    return total, joined * pressure, band.width * ratio**-0.5


def _levels(gas: Gas, steps: tuple[int, ...], temperature: float) -> tuple[float, float]:
    """Return Psi times the share without stimulated emission, and Phi, of the module's formulas [1]."""
    psi = phi = 1.0
    quanta = SECOND_RADIATION / temperature * np.asarray(gas.vibrations_cm)
    for u, step, g in zip(quanta, steps, gas.degeneracy, strict=True):
        first = max(-step, 0)
        v = _LEVELS[first:].astype(np.float64)
        upper = _rising(v + 1.0, g + abs(step) - 1) * np.exp(-u * v)
        every = _LEVELS.astype(np.float64)
        lower = _rising(every + 1.0, g - 1) * np.exp(-u * every)
        # sums over the levels of each vibration factorise
        psi *= float(upper.sum() / lower.sum())
        phi *= float(np.sqrt(upper).sum() ** 2 / upper.sum())
    return psi * float(-np.expm1(-quanta @ np.asarray(steps))), phi


def _rising(start: FloatArray, count: int) -> FloatArray:
    """Return the product of ``count`` numbers from ``start`` on [1]: (v + count)! / v! for v + 1; factors 1/(g-1)! cancel."""
    out = np.ones_like(start)
    for k in range(count):
        out = out * (start + k)
    return out


#: Number of tabulated chords, even in the root of their length: absorption of short chords grows as the root, and linear interpolation has
#: an error of 1e-4 for a grey plume of emissivity 0.999999.
CHORDS: Final = 257

FINE_STEP: Final = 1.0  #: Largest step of the wavenumbers that are averaged over a sample of the band [cm-1].


def chord_shares() -> FloatArray:
    """Return the tabulated shares of the longest chord [1, (chords,)]."""
    return np.linspace(0.0, 1.0, CHORDS) ** 2


def longest_chord(plume: GasPlume) -> float:
    """Return the length of a plume of gases along its longest axis [m]; 0 for a grey plume, with chords relative to each direction."""
    return 0.0 if plume.emissivity is not None else 2.0 * max(plume.semi_axes)


def plume_emissivity(plume: GasPlume, wavenumber_cm: FloatArray) -> FloatArray:
    """Return the emissivity along chords of ``chord_shares`` at the samples of a band [1, (chords, n)]."""
    if plume.emissivity is not None:
        grey = -np.expm1(chord_shares() * math.log1p(-plume.emissivity))
        return np.repeat(grey[:, None], wavenumber_cm.size, axis=1)
    nu = np.ascontiguousarray(wavenumber_cm, np.float64)
    return _tabulated(plume.temperature, plume.co2_share, plume.h2o_share, longest_chord(plume), nu.tobytes())


@lru_cache(maxsize=16)
def _tabulated(temperature: float, co2_share: float, h2o_share: float, longest: float, wavenumber_cm: bytes) -> FloatArray:
    """Return means of the gases' emissivity over each sample [1, (chords, n)], weighted by the hat of linear interpolation between samples.

    The sum over the samples of the product with a quantity that is linear between samples is then the integral of the product.
    """
    nu = np.frombuffer(wavenumber_cm)
    pieces = max(math.ceil(float(np.diff(nu).max()) / FINE_STEP - 1e-9), 1)
    evenly = (nu[:-1, None] + np.diff(nu)[:, None] * (np.arange(pieces) / pieces)).ravel()
    # no piece lies on both sides of a head, where the spectrum has a step
    edges = np.unique(np.concatenate([evenly, nu[-1:], [head for head in HEADS if nu[0] < head < nu[-1]]]))
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    left = np.clip(np.searchsorted(nu, middle, side="right") - 1, 0, nu.size - 2)
    right = (middle - nu[left]) / (nu[left + 1] - nu[left])
    rows = np.arange(middle.size)
    hats = csr_array((np.concatenate([width * (1.0 - right), width * right]), (np.tile(rows, 2), np.concatenate([left, left + 1]))))
    spectra = emissivity(middle, longest * chord_shares(), temperature, co2_share, h2o_share)
    out = np.asarray(spectra @ hats / hats.sum(axis=0))
    # the table is cached: all callers share it
    out.setflags(write=False)
    return out
