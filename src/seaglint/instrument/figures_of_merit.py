r"""Figures of merit of a sensor, as in a data sheet, and settings of a photon detector for a stated NETD.

With the electrons ``N`` of a blackbody that fills the field and their noise ``sigma``

.. math:: \mathrm{NETD} = \frac{\sigma(T)}{dN/dT} \qquad \mathrm{SiTF} = \frac{1}{g}\frac{dN}{dT} \qquad
    \mathrm{NEI} = \frac{\sigma}{A_{pupil}\,\tau\,t\,K\,s}

``s`` is the share of a point's light that falls on its pixel. All figures are for the complete noise of the sensor, also if the switches
``temporal`` and ``fixed_pattern`` of a scenario omit parts of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.data_sheet import BudgetAtMean, ConversionError, SensorDataSheet, TransferCurves
from seaglint.instrument.detector import PhotonPixels, crosstalk_mtf, square_mtf
from seaglint.instrument.optics import motion_mtf
from seaglint.instrument.transfer import sensor_mtf

BACKGROUND: Final = 300.0  #: Temperature of the blackbody for NETD, SiTF and related figures [K].

MTF_POINTS: Final = 41  #: Number of frequencies of a printed MTF, from 0 to twice the Nyquist frequency.


#: Number of frequencies in a ripple of the transfer of pixel, crosstalk and movement, in the integral over a point's light.
RIPPLE_POINTS: Final = 8

LEAST_POINTS: Final = 512  #: Least number of frequencies along each half axis of that integral.
MOST_POINTS: Final = 1024  #: Largest number of frequencies along each half axis of that integral.

BLUR_POINTS: Final = 4097  #: Number of frequencies up to the optics' cut-off at which the transfer is compared with a half.


@dataclass(frozen=True)
class Budget:
    """Temporal noise of a pixel by its causes, rms in units of the signal, with the mean signal."""

    signal: float
    parts: dict[str, float]

    @property
    def total(self) -> float:
        """Total noise: root of the sum of squares."""
        return math.sqrt(sum(value**2 for value in self.parts.values()))


def mtf(model: SensorModel, frequency: ArrayLike, rates: tuple[float, float] = (0.0, 0.0)) -> dict[str, dict[str, FloatArray]]:
    """Return the transfer along rows and across them, by cause, at frequencies [cycles rad-1]; ``total`` is their product.

    >>> from seaglint.optics.band import Band
    >>> from seaglint.instrument.optics import SensorOptics
    >>> from seaglint.instrument.detector import PhotonPixels
    >>> from seaglint.instrument.photons import Photons
    >>> eye = SensorModel(Photons(Band.rectangular(3.5, 5.0)), SensorOptics(0.05, 0.2), PhotonPixels(15e-6))
    >>> round(float(mtf(eye, [0.5 / eye.ifov])["along"]["detector"][0]), 4)
    0.6366
    """
    f = np.atleast_1d(np.asarray(frequency, np.float64))
    width, smear = model.detector.active_width / model.optics.focal_length, model.smear(rates)
    out = {}
    for number, name in enumerate(("along", "across")):
        parts = {**model.blur.parts(f), "detector": square_mtf(f, width)}
        if isinstance(model.detector, PhotonPixels) and model.detector.crosstalk:
            parts["crosstalk"] = crosstalk_mtf(f, np.zeros(f.size), model.detector.crosstalk, model.ifov)
        if smear[number]:
            parts["motion"] = motion_mtf(f, smear[number])
        axes = (f, np.zeros(f.size)) if number == 0 else (np.zeros(f.size), f)
        out[name] = {**parts, "total": sensor_mtf(model.blur, model.sampling(1, rates), *axes)}
    return out


def blur_px(model: SensorModel) -> float:
    r"""Return the blur of a sensor beyond its pixels, as a standard deviation [px].

    The result is the standard deviation of a Gaussian with a transfer of a half at the frequency where the product ``H`` of optics,
    crosstalk and steady movement is a half:

    .. math:: s = \frac{1}{p f_{1/2}}\sqrt{\frac{\ln 2}{2\pi^2}}, \qquad H(f_{1/2}) = \tfrac12

    with the pixel's angle ``p``; the root mean square of both axes. It does not include the integration over the pixel, which rendered
    pictures have too. A second moment is no alternative, as the second moment of diffraction is infinite.

    Examples
    --------
    >>> from seaglint.optics.band import Band
    >>> from seaglint.instrument.optics import SensorOptics
    >>> from seaglint.instrument.detector import PhotonPixels
    >>> from seaglint.instrument.photons import Photons
    >>> photons = Photons(Band.rectangular(3.5, 5.0))
    >>> optics = SensorOptics(0.2, 0.1, jitter=1.8e-4)
    >>> shaken = SensorModel(photons, optics, PhotonPixels(15e-6))
    >>> round(blur_px(shaken), 2)  # 1.2 of jitter, and some diffraction
    1.23
    """
    frequency: FloatArray = np.linspace(0.0, model.optics.cutoff(1e-6 * model.photons.band.min_um), BLUR_POINTS)
    squares = []
    sampling = replace(model.sampling(1), width=0.0)
    zero: FloatArray = np.zeros(BLUR_POINTS)
    for axes in ((frequency, zero), (zero, frequency)):
        beyond = sensor_mtf(model.blur, sampling, *axes)
        # linear between the points; the transfer is 0 at the cut-off, so that it falls to a half before
        after = int(np.flatnonzero(beyond <= 0.5)[0])
        step = (beyond[after - 1] - 0.5) / (beyond[after - 1] - beyond[after])
        half = frequency[after - 1] + step * (frequency[after] - frequency[after - 1])
        squares.append(math.log(2.0) / (2.0 * (math.pi * half * model.ifov) ** 2))
    return math.sqrt(sum(squares) / len(squares))


def budget(model: SensorModel, radiance: float) -> Budget:
    """Return the noise budget of a pixel at a radiance at the aperture [W m-2 sr-1]."""
    line, noise, detector = model.readout, model.noise, model.detector
    signal = float(line.units(radiance))
    parts: dict[str, float] = {}
    if isinstance(detector, PhotonPixels):
        # shot noise: the variance of electrons is their mean
        parts["scene"] = math.sqrt(line.per_radiance * radiance)
        parts["optics"] = math.sqrt(max(line.background - line.dark, 0.0))
        parts["dark"] = math.sqrt(line.dark)
        parts["read"] = detector.read_noise
    else:
        parts["detector"] = model.read_rms
    # a converter's steps are uniform errors: step over the root of 12
    parts |= {"one_over_f": noise.one_over_f, "quantisation": line.gain / math.sqrt(12.0)}
    parts |= {name: getattr(noise, name) for name in ("frame", "row_temporal", "column_temporal")}
    return Budget(signal, parts)


def fixed_pattern(model: SensorModel, radiance: float) -> float:
    """Return the rms of fixed differences between pixels at a radiance [units]."""
    noise, line = model.noise, model.readout
    light = float(line.units(radiance)) - line.dark
    if noise.corrected_at is None:
        gain, offset, (first, second) = noise.gain_spread * light, noise.offset_spread, (0.0, 0.0)
    else:
        gain, offset, (first, second) = 0.0, 0.0, noise.corrected_at
    # zero at the two signals of the correction; without correction both are 0
    curved = noise.curvature_spread * (light - first) * (light - second) / min(line.full_scale, 1e15)
    return math.sqrt(gain**2 + offset**2 + curved**2)


def three_d(model: SensorModel, radiance: float) -> dict[str, float]:
    """Return the seven components of 3-D noise at a radiance [units]; for a scanner, differences between pixels are between rows."""
    temporal, noise = budget(model, radiance), model.noise
    common = ("frame", "row_temporal", "column_temporal")
    pattern, scanning = fixed_pattern(model, radiance), model.scanning
    pixel = math.sqrt(sum(value**2 for name, value in temporal.parts.items() if name not in common))
    return {
        "T": noise.frame,
        # one pixel of a scanner draws a whole row: its pattern is the row's
        "V": math.hypot(noise.row, pattern) if scanning else noise.row,
        "H": noise.column,
        "TV": noise.row_temporal,
        "TH": noise.column_temporal,
        "VH": 0.0 if scanning else pattern,
        "TVH": pixel,
    }


def signal_slope(model: SensorModel, temperature: float) -> float:
    """Return the signal for each kelvin of a blackbody [units K-1], with the conversion of the chain."""
    return model.readout.per_radiance * model.photons.radiance_slope(temperature)


def point_response(model: SensorModel, rates: tuple[float, float] = (0.0, 0.0)) -> float:
    """Return the contrast of a point at the centre of a pixel, relative to its light spread evenly over the whole pixel [1].

    ``s = (1 - stray) p^2 int H_optics H_detector H_crosstalk H_motion d^2f`` with the pixel's angle ``p``: a point of the intensity ``I``
    at the distance ``R`` adds ``s I / (R^2 p^2)`` to the radiance of its pixel. The response does not include the fill factor, as the
    radiance of a pixel is a mean over its sensitive area; ``point_share`` includes it.
    """
    sampling, jitter = model.sampling(1, rates), model.optics.jitter
    # up to the cut-off, or to where jitter leaves 1e-12; several points in the shortest ripple
    end = model.optics.cutoff(1e-6 * model.photons.band.min_um)
    end = min(end, 1.2 / jitter) if jitter else end
    widest = max(sampling.step, *(abs(smear) for smear in sampling.smear))
    count = min(max(math.ceil(RIPPLE_POINTS * widest * end), LEAST_POINTS), MOST_POINTS)
    f = np.asarray((np.arange(count) + 0.5) * (end / count), np.float64)
    # the transfer is real: the half of positive frequencies along rows counts twice
    total = sensor_mtf(model.blur, sampling, f[None, :], np.concatenate([-f[::-1], f])[:, None])
    return float((1.0 - model.optics.stray_share) * 2.0 * np.sum(total) * (end / count) ** 2 * model.ifov**2)


def point_share(model: SensorModel, rates: tuple[float, float] = (0.0, 0.0)) -> float:
    """Return the share of the light of a point at the centre of a pixel on its sensitive area [1]: the response times the fill factor."""
    return model.detector.fill_factor * point_response(model, rates)


def figures(
    model: SensorModel, scene_radiance: float | None = None, rates: tuple[float, float] = (0.0, 0.0), frequencies: Sequence[float] = ()
) -> SensorDataSheet:
    """Return all figures of merit of a sensor.

    Parameters
    ----------
    model : SensorModel
        The sensor.
    scene_radiance : float, optional
        Mean radiance of the noise budget [W m-2 sr-1]; the radiance of a blackbody at 300 K by default.
    rates : (float, float)
        Movement of the line of sight by the platform [rad s-1].
    frequencies : sequence of float
        Frequencies of the MTF [cycles rad-1]; by default from 0 to twice the Nyquist frequency.

    Returns
    -------
    SensorDataSheet
        The figures, each with its unit.
    """
    line, detector, optics, photons = model.readout, model.detector, model.optics, model.photons
    photon = isinstance(detector, PhotonPixels)
    background = float(photons.radiance(BACKGROUND))
    mean = background if scene_radiance is None else scene_radiance
    noise, slope = budget(model, background), signal_slope(model, BACKGROUND)
    nyquist = 0.5 / model.ifov
    frequency = np.asarray(frequencies, np.float64) if frequencies else np.linspace(0.0, 2.0 * nyquist, MTF_POINTS)
    transfer = mtf(model, frequency, rates)
    at_mean = budget(model, mean)
    # the dark: noise without light from the scene
    floor = budget(model, 0.0).total
    time = detector.integration_time if isinstance(detector, PhotonPixels) else model.frame_interval
    # units for each watt on the sensitive area
    per_watt = line.per_radiance / (detector.active_area * optics.solid_angle * optics.transmission)
    ceiling = (line.full_scale - line.background) / line.per_radiance
    response = point_response(model, rates)
    share = model.detector.fill_factor * response
    curves = TransferCurves(
        frequency_cycles_per_mrad=(1e-3 * frequency).tolist(),
        along=transfer["along"]["total"].tolist(),
        across=transfer["across"]["total"].tolist(),
        nyquist_cycles_per_mrad=1e-3 * nyquist,
        parts={
            direction: {name: part.tolist() for name, part in parts.items() if name != "total"} for direction, parts in transfer.items()
        },
    )
    return SensorDataSheet(
        detector="photon" if photon else "thermal",
        band_um=[photons.band.min_um, photons.band.max_um],
        mean_wavelength_um=1e6 * photons.wavelength,
        aperture_m=optics.aperture,
        focal_length_m=optics.focal_length,
        f_number=optics.f_number,
        solid_angle_sr=optics.solid_angle,
        ifov_mrad=1e3 * model.ifov,
        oversampling=model.oversampling,
        background_k=BACKGROUND,
        netd_k=noise.total / slope,
        sitf_counts_per_k=slope / line.gain,
        nei_w_m2=noise.total / (per_watt * optics.pupil_area * optics.transmission * share),
        nep_w=noise.total / per_watt,
        point_share=share,
        point_response=response,
        electrons_per_count=line.gain if photon else None,
        nw_per_count=None if photon else line.gain,
        offset_counts=line.offset,
        radiance_per_count=line.radiance_scale,
        radiance_at_zero_counts=line.radiance_offset,
        dynamic_range_db=20.0 * math.log10(max((line.full_scale - line.background) / floor, 1e-9)) if floor > 0.0 else None,
        saturation_temperature_k=_finite(float(photons.apparent_temperature(ceiling))),
        saturation_radiance=ceiling,
        mtf=curves,
        noise_budget=BudgetAtMean(
            scene_radiance=mean,
            scene_apparent_temperature_k=_finite(float(photons.apparent_temperature(mean))),
            signal=at_mean.signal,
            parts=at_mean.parts,
            total_temporal=at_mean.total,
            fixed_pattern=fixed_pattern(model, mean),
        ),
        three_d_noise=three_d(model, mean),
        conversion_error=ConversionError(
            reference_k=photons.temperature,
            at_280_k=photons.error(280.0) if photon else 0.0,
            at_320_k=photons.error(320.0) if photon else 0.0,
            sunlight=photons.sunlight_error if photon else 0.0,
        ),
        time_s=time,
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


SHORTEST = 1e-9  #: Shortest integration time of the search [s].


def netd(model: SensorModel, temperature: float) -> float:
    """Return the noise-equivalent temperature difference against a blackbody [K].

    It is the temporal noise of a pixel before the blackbody over the slope of its signal against temperature, without a limit by the well.

    Parameters
    ----------
    model : SensorModel
        The sensor.
    temperature : float
        Temperature of the blackbody [K].

    Returns
    -------
    float
        NETD [K].
    """
    return budget(model, float(model.photons.radiance(temperature))).total / signal_slope(model, temperature)


def read_noise_for(model: SensorModel, stated: float, temperature: float) -> float:
    r"""Return the read noise with which a photon detector has a stated NETD [electrons].

    .. math:: \sigma_r^2 = (\mathrm{NETD}\, dS/dT)^2 - \sigma_0^2

    with the slope of the signal ``S`` against temperature and all other temporal noise :math:`\sigma_0`.

    Parameters
    ----------
    model : SensorModel
        Sensor with a photon detector; its read noise is ignored.
    stated : float
        Stated NETD [K].
    temperature : float
        Temperature of the blackbody for which it is stated [K].

    Returns
    -------
    float
        Read noise [electrons].

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
    """Return the integration time with which a photon detector has a stated NETD [s].

    Parameters
    ----------
    model : SensorModel
        Sensor with a photon detector; its integration time is ignored.
    stated : float
        Stated NETD [K].
    temperature : float
        Temperature of the blackbody for which it is stated [K].
    longest : float
        Longest integration time that a frame allows [s].

    Returns
    -------
    float
        Integration time [s].

    Raises
    ------
    DomainError
        No integration time up to the longest has this NETD, or the pixel is full before.
    """
    pixels = _photon_pixels(model)

    def log_ratio(time: float) -> float:
        return math.log(netd(exposed(time), temperature) / stated)

    def exposed(time: float) -> SensorModel:
        return replace(model, detector=replace(pixels, integration_time=time))

    if log_ratio(longest) > 0.0:
        raise DomainError(
            f"NETD = {1e3 * stated:.4g} mK is below the {1e3 * netd(exposed(longest), temperature):.4g} mK of the longest integration, "
            f"{longest:.4g} s; give a higher one, a lower frame rate or a faster lens",
            name="netd",
            value=stated,
            allowed=f"from {netd(exposed(longest), temperature):.4g} K",
        )
    if log_ratio(SHORTEST) < 0.0:
        raise DomainError(
            f"NETD = {1e3 * stated:.4g} mK is reached by any integration time; give a lower one, or integration_time_s",
            name="netd",
            value=stated,
            allowed=f"up to {netd(exposed(SHORTEST), temperature):.4g} K",
        )
    # NETD falls with the integration time over many decades: the root is sought in the logarithms of both
    time = math.exp(brentq(lambda x: log_ratio(math.exp(x)), math.log(SHORTEST), math.log(longest), xtol=1e-10))
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
    """Return the photon detector of a model; raise for a thermal detector."""
    if not isinstance(model.detector, PhotonPixels):
        raise DomainError("a thermal detector states its NETD itself; read noise and integration time are a photon detector's")
    return model.detector
