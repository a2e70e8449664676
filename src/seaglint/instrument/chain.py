"""Chain of the whole sensor, frame by frame: radiance at the aperture, radiance on the focal plane, signal, counts."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.random import stream
from seaglint.instrument.bolometer import NANO, ThermalPixels
from seaglint.instrument.detector import FULL_SCALE_TEMPERATURE, PhotonPixels, Readout
from seaglint.instrument.noise import DetectorNoise, Pattern, temporal_noise
from seaglint.instrument.optics import Blur, SensorOptics, cos4_falloff, distorted_places
from seaglint.instrument.photons import Photons
from seaglint.instrument.transfer import (
    BYTES_PER_FINE_PIXEL,
    Sampling,
    Transfer,
    isolated,
    needed_oversampling,
    padded_shape,
    sufficient_oversampling,
)

CACHED: Final = 4  #: Number of transfers of different sizes or smears that are cached.

SHORT_BELOW: Final = 0.95  #: Share of the well above which the shorter exposure is used.


@dataclass(frozen=True, eq=False)
class Exposure:
    """Signal of one frame of a sensor, or of several."""

    signal: NDArray[np.uint16]  #: Counts [(rows, columns) or (time, rows, columns), uint16].
    #: Signal before the converter: electrons, or nanowatts of a thermal detector, noise and background in it [shape of ``signal``].
    units: NDArray[np.float32]
    saturated: int  #: Number of pixels that are full or at the end of the converter.

    @property
    def saturated_share(self) -> float:
        """Share of the pixels that are saturated [1]."""
        return self.saturated / self.signal.size


@dataclass(frozen=True, eq=False)
class Drawn:
    """Properties of a picture of this program that a sensor needs besides its radiance."""

    #: Sunlight in the radiance that is independent from pixel to pixel (``seaglint.imaging.layers.SPARKLE``) [W m-2 sr-1, (rows,
    #: columns)]; None of a picture whose layers are not known.
    sparkle: NDArray[np.float32] | None = None
    cells: float = 0.0  #: Side of the cells from which its pixels were averaged [rad]; 0 for none.


@dataclass(frozen=True, eq=False)
class SensorModel:
    """Sensor model of optics, detector and noise for one band."""

    photons: Photons  #: Band and quantum efficiency.
    optics: SensorOptics  #: Optics in front of the detector.
    detector: PhotonPixels | ThermalPixels  #: The pixels.
    noise: DetectorNoise = field(default_factory=DetectorNoise)  #: Noise of the pixels.
    seed: int = 1  #: Seed of all random numbers.
    frame_interval: float = 0.04  #: Time from frame to frame [s].
    #: True for a scanner: columns are directions of the scan, each on the optical axis, not places on the focal plane.
    scanning: bool = False
    circle: bool = False  #: True for pictures of a full circle.
    _transfers: OrderedDict[tuple[Sampling, tuple[int, int]], Transfer] = field(default_factory=OrderedDict, repr=False)
    _patterns: dict[tuple[int, int], Pattern] = field(default_factory=dict, repr=False)

    @property
    def ifov(self) -> float:
        """Angle between pixels [rad]."""
        return self.detector.pitch / self.optics.focal_length

    @property
    def exposure_time(self) -> float:
        """Time over which movement of the line of sight blurs [s]; 0 for a thermal detector, which has only its lag."""
        return self.detector.integration_time if isinstance(self.detector, PhotonPixels) else 0.0

    @cached_property
    def blur(self) -> Blur:
        """Transfer of the optics."""
        return Blur.of(self.optics, *self.photons.spectrum)

    @cached_property
    def finest(self) -> int:
        """Fine pixels along a pixel's side that resolve the optics' cut-off at the shortest wavelength."""
        return needed_oversampling(self.ifov, self.optics.cutoff(1e-6 * self.photons.band.min_um))

    @cached_property
    def oversampling(self) -> int:
        """Fine pixels along a pixel's side in drawings: the fewest with little folded energy, at most ``finest``.

        See ``sufficient_oversampling``.
        """
        return sufficient_oversampling(self.blur, self.sampling(1), self.finest)

    @cached_property
    def readout(self) -> Readout:
        """Straight line from radiance to counts."""
        optics, detector, photons = self.optics, self.detector, self.photons
        warm = optics.emissivity * optics.solid_angle + optics.housing_solid_angle
        # warm optics and housing are blackbodies; their electrons have the conversion of the scene
        glow = float(photons.radiance(optics.temperature)) * warm * detector.active_area if warm > 0.0 else 0.0
        light = detector.active_area * optics.solid_angle * optics.transmission
        if isinstance(detector, ThermalPixels):
            per_watt = detector.absorptance * NANO
            full = light * per_watt * float(photons.radiance(detector.full_scale_temperature)) + glow * per_watt
            gain = full / (detector.top_count - detector.offset)
            return Readout(light * per_watt, glow * per_watt, 0.0, math.inf, gain, detector.offset, detector.top_count)
        per_joule = photons.electrons_per_joule * detector.integration_time
        dark = detector.dark_current * detector.integration_time
        background = dark + glow * per_joule
        capacity = math.inf if detector.well_capacity is None else detector.well_capacity * detector.range_factor
        if detector.gain is not None:
            gain = detector.gain
        else:
            hot = light * per_joule * float(photons.radiance(FULL_SCALE_TEMPERATURE)) + background
            # the converter ends at the full well, or at a hot blackbody without a well
            gain = (capacity if math.isfinite(capacity) else hot) / (detector.top_count - detector.offset)
        return Readout(light * per_joule, background, dark, capacity, gain, detector.offset, detector.top_count)

    @cached_property
    def read_rms(self) -> float:
        """Noise of a reading without shot noise [units]: read noise of a photon detector, whole noise of a thermal detector."""
        detector = self.detector
        if isinstance(detector, PhotonPixels):
            return detector.read_noise
        cone = math.pi / (4.0 * detector.netd_f_number**2)
        slope = self.photons.radiance_slope(detector.netd_temperature)
        return detector.netd * detector.active_area * cone * detector.absorptance * slope * NANO

    def smear(self, rates: tuple[float, float] = (0.0, 0.0)) -> tuple[float, float]:
        """Return the movement of the line of sight in an exposure by drift and platform [rad], from rates of the platform [rad s-1]."""
        drift = self.optics.drift
        return (drift[0] + rates[0]) * self.exposure_time, (drift[1] + rates[1]) * self.exposure_time

    def sampling(self, oversampling: int, rates: tuple[float, float] = (0.0, 0.0), *, points: bool = False, cells: float = 0.0) -> Sampling:
        """Return the sampling of pictures that are ``oversampling`` times finer, with the line of sight moving at ``rates`` [rad s-1].

        ``points`` and ``cells`` as in ``Sampling``.
        """
        detector = self.detector
        share = detector.crosstalk if isinstance(detector, PhotonPixels) else 0.0
        width = detector.active_width / self.optics.focal_length
        return Sampling(self.ifov, width, oversampling, share, self.smear(rates), self.circle, points, cells)

    def transfer(
        self,
        shape: tuple[int, int],
        oversampling: int,
        rates: tuple[float, float] = (0.0, 0.0),
        *,
        points: bool = False,
        cells: float = 0.0,
    ) -> Transfer:
        """Return blur and sampling of fine pictures of ``shape`` (rows, columns), with ``sampling``; the latest are cached."""
        key = (self.sampling(oversampling, rates, points=points, cells=cells), shape)
        cached = self._transfers.get(key)
        if cached is None:
            cached = self._transfers[key] = Transfer.of(self.blur, key[0], shape)
            while len(self._transfers) > CACHED:
                self._transfers.popitem(last=False)
        self._transfers.move_to_end(key)
        return cached

    def transfer_bytes(self, shape: tuple[int, int], oversampling: int, rates: tuple[float, float] = (0.0, 0.0)) -> int:
        """Return the memory for blur and sampling of pictures of ``shape`` (rows, columns of the detector) [bytes]."""
        rows, columns = padded_shape(self.blur, self.sampling(oversampling, rates), shape)
        return rows * columns * oversampling**2 * BYTES_PER_FINE_PIXEL

    def focal_plane(
        self,
        radiance: NDArray[np.float32],
        oversampling: int = 1,
        rates: tuple[float, float] = (0.0, 0.0),
        added: NDArray[np.float32] | None = None,
        *,
        drawn: Drawn | None = None,
    ) -> NDArray[np.float32]:
        """Return the radiance on each pixel: blurred, distorted and vignetted.

        Parameters
        ----------
        radiance : ndarray
            Radiance at the aperture, ``oversampling`` times finer than the pixels [W m-2 sr-1, (rows, columns) or (time, rows, columns)].
        oversampling : int
            Fine pixels along a pixel's side.
        rates : (float, float)
            Movement of the line of sight by the platform, along and across rows [rad s-1].
        added : ndarray, optional
            Radiance added on the pixels, already blurred and distorted (``seaglint.instrument.local_light``), before stray light and
            vignetting [W m-2 sr-1, (rows, columns)]; for single pictures.
        drawn : Drawn, optional
            For a picture of this program, in which each fine pixel is the mean of a scene over it. In any other picture, isolated light of
            a fine pixel (``isolated``) is taken as a point in its middle.

        Returns
        -------
        ndarray
            Mean radiance on the pixels behind optics without losses [W m-2 sr-1, (rows, columns), with time before them where
            ``radiance`` has it].

        Raises
        ------
        DataError
            Values that are no radiances.
        """
        # order of the optics: distortion, blur and sampling (with ``added``, which has both), stray light, vignetting
        if radiance.ndim == 3:
            return np.stack([self.focal_plane(picture, oversampling, rates, drawn=drawn) for picture in radiance])
        require_radiance(radiance)
        optics = self.optics
        shape = (radiance.shape[0], radiance.shape[1])
        apart, cells = (None, 0.0) if drawn is None else (drawn.sparkle, drawn.cells)
        if optics.distortion:
            places = distorted_places(shape, optics.distortion)
            radiance = map_coordinates(radiance, places, order=1, mode="nearest").astype(np.float32)
            if apart is not None:
                apart = map_coordinates(apart, places, order=1, mode="nearest").astype(np.float32)
        if drawn is None:
            apart = isolated(radiance)
        if apart is not None and apart.any():
            points = self.transfer(shape, oversampling, rates, points=True, cells=cells)(apart)
            out = self.transfer(shape, oversampling, rates, cells=cells)(radiance - apart) + points
        else:
            out = self.transfer(shape, oversampling, rates, cells=cells)(radiance)
        if added is not None:
            out = out + added
        if optics.stray_share:
            out = ((1.0 - optics.stray_share) * out + optics.stray_share * out.mean(dtype=np.float64)).astype(np.float32)
        if optics.cos4:
            rows, columns = out.shape
            x, y = ((np.arange(size) - 0.5 * (size - 1)) * self.ifov for size in (columns, rows))
            out = (out * cos4_falloff(np.zeros(columns) if self.scanning else x, y)).astype(np.float32)
        return out

    def expose(self, seen: NDArray[np.float32], frame: int = 0, time: float | None = None) -> Exposure:
        """Return the signal of the pixels for given radiances.

        Parameters
        ----------
        seen : ndarray
            Radiance from ``focal_plane`` [W m-2 sr-1, (rows, columns) or (time, rows, columns)].
        frame : int
            Number of the frame (of the first frame) in the whole sequence; noise is a function of it.
        time : float, optional
            Time of the frame [s]; its number times the frame interval by default.
        """
        if seen.ndim == 3:
            begin = frame * self.frame_interval if time is None else time
            frames = [self.expose(picture, frame + k, begin + k * self.frame_interval) for k, picture in enumerate(seen)]
            signals = np.stack([one.signal for one in frames]), np.stack([one.units for one in frames])
            return Exposure(*signals, sum(one.saturated for one in frames))
        line, noise = self.readout, self.noise
        shape = (seen.shape[0], seen.shape[1])
        pattern = self._pattern(shape)
        when = frame * self.frame_interval if time is None else time
        # gain and curvature act on light alone; dark signal is added after them
        light = pattern.response(np.maximum(line.per_radiance * seen.astype(np.float64), 0.0) + (line.background - line.dark))
        dark = pattern.dark(shape) + line.dark
        detector = self.detector
        reading: FloatArray | float = 1.0
        if isinstance(detector, PhotonPixels):
            mean, well = light + dark, math.inf if detector.well_capacity is None else detector.well_capacity
            units = self._collected(mean, frame, well, 0)
            full = units >= well
            if detector.short_integration_time is not None:
                factor = detector.range_factor
                # fewer electrons in proportion to the time, scaled back after the shot noise
                second = self._collected(mean / factor, frame, well, 1) * factor
                short = units > SHORT_BELOW * well
                units, full = np.where(short, second, units), second >= well * factor
                reading = np.where(short, factor, 1.0)  # the short exposure is read with the same noise and then scaled
        else:
            units, full = light + dark, np.zeros(shape, np.bool_)
        added = temporal_noise(noise, self.seed, frame, shape, self.read_rms)
        units = pattern.added(when, units if added is None else units + reading * added)
        counts = line.counts(units)
        saturated = int(np.count_nonzero(full | (counts >= line.top_count)))
        return Exposure(counts.astype(np.uint16), units.astype(np.float32), saturated)

    def _collected(self, mean: FloatArray, frame: int, well: float, exposure: int) -> FloatArray:
        """Return the electrons in the wells, from light and dark current, with their shot noise, limited to the well."""
        if self.noise.temporal:
            # NumPy's Poisson numbers end at 2^63; wells end long before
            most = np.clip(mean, 0.0, 1e15)
            mean = stream(self.seed, "sensor shot", frame, exposure).poisson(most).astype(np.float64)
        return np.minimum(mean, well)

    def _pattern(self, shape: tuple[int, int]) -> Pattern:
        cached = self._patterns.get(shape)
        if cached is None:
            full = min(self.readout.full_scale, 1e15)
            cached = self._patterns[shape] = Pattern.of(self.noise, self.seed, shape, full, scanning=self.scanning)
        return cached

    def sense(self, radiance: NDArray[np.float32], frame: int = 0, oversampling: int = 1) -> Exposure:
        """Return the signal by ``focal_plane`` and ``expose``, without the lag of a thermal detector, which needs more frames."""
        return self.expose(self.focal_plane(radiance, oversampling), frame)

    def apparent_temperature(self, counts: FloatArray | NDArray[np.uint16]) -> FloatArray:
        """Return the apparent temperature at the aperture from counts [K]."""
        return self.photons.apparent_temperature(self.readout.radiance(counts))

    def reseeded(self, seed: int) -> SensorModel:
        """Return another detector of this kind, with other noise."""
        return replace(self, seed=seed, _transfers=self._transfers, _patterns={})


def require_radiance(radiance: NDArray[np.float32], name: str = "radiance") -> None:
    """Raise for values that are not radiances; the message has them under ``name``.

    Raises
    ------
    DataError
        Values that are not finite, or negative.
    """
    bad = int(radiance.size - np.count_nonzero(np.isfinite(radiance)))
    if bad:
        row, column = np.argwhere(~np.isfinite(radiance))[0]
        raise DataError(
            f"{name}: {bad} of {radiance.size} pixels are not finite (first in row {row}, column {column}); "
            "a sensor needs a radiance in every pixel: fill them in or cut them off"
        )
    least = float(radiance.min())
    if least < 0.0:
        count = int(np.count_nonzero(radiance < 0.0))
        row, column = np.argwhere(radiance < 0.0)[0]
        raise DataError(
            f"{name}: {count} of {radiance.size} pixels are negative (least {least:g} W m-2 sr-1, first in row {row}, column {column}); "
            "give radiance at the aperture, not differences or temperatures in degC"
        )
