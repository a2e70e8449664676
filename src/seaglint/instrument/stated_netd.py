"""Photon detectors of a stated NETD: the read noise, or the integration time, that gives it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from scipy.optimize import brentq

from seaglint.base.errors import DomainError
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import budget, signal_slope

if TYPE_CHECKING:
    from seaglint.instrument.chain import SensorModel

SHORTEST = 1e-9  #: Shortest integration time tried [s].


def netd(model: SensorModel, temperature: float) -> float:
    """Noise-equivalent temperature difference against a blackbody [K].

    Temporal noise of a pixel that sees the blackbody over the slope of its signal against temperature, whatever the well holds.

    Parameters
    ----------
    model : SensorModel
        The sensor.
    temperature : float
        Of the blackbody [K].
    """
    return budget(model, float(model.photons.radiance(temperature))).total / signal_slope(model, temperature)


def read_noise_for(model: SensorModel, stated: float, temperature: float) -> float:
    r"""Read noise with which a photon detector has a stated NETD [electrons].

    .. math:: \sigma_r^2 = (\mathrm{NETD}\, dS/dT)^2 - \sigma_0^2

    with the slope of the signal ``S`` against temperature and all other temporal noise :math:`\sigma_0`.

    Parameters
    ----------
    model : SensorModel
        Sensor with a photon detector, whose own read noise is ignored.
    stated : float
        NETD [K].
    temperature : float
        Blackbody for which it is stated [K].

    Raises
    ------
    DomainError
        The other noise alone exceeds it.
    """
    quiet = replace(model, detector=replace(_photon_pixels(model), read_noise=0.0))
    slope, least = signal_slope(quiet, temperature), netd(quiet, temperature)
    if stated < least:
        raise DomainError(
            f"NETD = {1e3 * stated:.4g} mK is below the {1e3 * least:.4g} mK that the detector has without any read noise; "
            "give a higher one, a longer integration time or a faster lens",
            name="netd",
            value=stated,
            allowed=f"from {least:.4g} K",
        )
    return slope * math.sqrt(stated**2 - least**2)


def integration_time_for(model: SensorModel, stated: float, temperature: float, longest: float) -> float:
    """Integration time with which a photon detector has a stated NETD [s].

    Parameters
    ----------
    model : SensorModel
        Sensor with a photon detector, whose own integration time is ignored.
    stated : float
        NETD [K].
    temperature : float
        Blackbody for which it is stated [K].
    longest : float
        Longest integration time that a frame allows [s].

    Raises
    ------
    DomainError
        No integration time up to the longest gives it, or the pixel is full before.
    """
    pixels = _photon_pixels(model)

    def over(time: float) -> float:
        return math.log(netd(exposed(time), temperature) / stated)

    def exposed(time: float) -> SensorModel:
        return replace(model, detector=replace(pixels, integration_time=time))

    if over(longest) > 0.0:
        raise DomainError(
            f"NETD = {1e3 * stated:.4g} mK is below the {1e3 * netd(exposed(longest), temperature):.4g} mK of the longest integration, "
            f"{longest:.4g} s; give a higher one, a lower frame rate or a faster lens",
            name="netd",
            value=stated,
            allowed=f"from {netd(exposed(longest), temperature):.4g} K",
        )
    if over(SHORTEST) < 0.0:
        raise DomainError(
            f"NETD = {1e3 * stated:.4g} mK is reached by any integration time; give a lower one, or integration_time_s",
            name="netd",
            value=stated,
            allowed=f"up to {netd(exposed(SHORTEST), temperature):.4g} K",
        )
    time = math.exp(brentq(lambda x: over(math.exp(x)), math.log(SHORTEST), math.log(longest), xtol=1e-10))
    line = exposed(time).readout
    signal = float(line.units(model.photons.radiance(temperature)))
    if signal > line.full_scale:
        raise DomainError(
            f"NETD = {1e3 * stated:.4g} mK at {temperature:g} K needs {signal:.3g} electrons, and a pixel holds {line.full_scale:.3g}; "
            "give a higher one, or a larger well",
            name="netd",
            value=stated,
        )
    return time


def _photon_pixels(model: SensorModel) -> PhotonPixels:
    """The detector, which has to be one of photons."""
    if not isinstance(model.detector, PhotonPixels):
        raise DomainError("a thermal detector states its NETD itself; read noise and integration time are a photon detector's")
    return model.detector
