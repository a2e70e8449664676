"""Sensor model of a scenario's sensor tables, and the attributes of its counts."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DomainError, Mistake, ScenarioError
from seaglint.base.free_form import Attributes
from seaglint.base.reports import REPORTS
from seaglint.formats.tables.spectra import read_response
from seaglint.imaging.camera.pose import Track
from seaglint.instrument.bolometer import ThermalPixels
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import blur_px, integration_time_for, read_noise_for
from seaglint.instrument.noise import DetectorNoise
from seaglint.instrument.optics import SensorOptics
from seaglint.instrument.photons import Photons
from seaglint.instrument.scan import ScanPattern
from seaglint.optics.band import Band
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.sensor_table import PhotonDetector
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import slopes

RATED_FRAMES: Final = 65  #: Largest number of frames at which the platform's movement is evaluated for figures of merit.


def require_sensor(scenario: Scenario) -> None:
    """Refuse a scenario without a detector.

    Raises
    ------
    ScenarioError
        Naming the tables that are missing.
    """
    if not scenario.sensor.senses:
        raise ScenarioError(
            "sensor.optics and sensor.detector are missing: a sensor needs both; add the tables [sensor.optics] and [sensor.detector], or "
            "choose a preset as sensor"
        )


def sensor_model(scenario: Scenario, seed: int | None = None, over: Band | None = None) -> SensorModel:
    """Return the sensor of a scenario.

    Parameters
    ----------
    scenario : Scenario
        With ``[sensor.optics]`` and ``[sensor.detector]``.
    seed : int, optional
        Of its noise; the scenario's by default.
    over : Band, optional
        Band of the radiance; the scenario's by default.

    Raises
    ------
    ScenarioError
        No detector, or a response that does not match the scene's band.
    """
    require_sensor(scenario)
    sensor, source = scenario.sensor, scenario.sensor.detector
    assert sensor.optics is not None
    assert source is not None
    photons = _photons(scenario_physics.band(scenario) if over is None else over, source)
    frame = 1.0 / sensor.frame_rate_hz
    given = sensor.optics
    optics = given.build(
        SensorOptics,
        aperture=sensor.aperture_m,
        focal_length=sensor.focal_length_m,
        # A scanner's motion blurs along rows as drift does.
        drift=(1e-6 * given.drift_along_urad_s + scan_rate(scenario), 1e-6 * given.drift_across_urad_s),
        solid_angle_law=given.solid_angle,
    )
    detector: PhotonPixels | ThermalPixels
    if isinstance(source, PhotonDetector):
        dwell = _dwell(scenario) if source.integration_time_s is None else source.integration_time_s
        detector = source.build(PhotonPixels, integration_time=dwell)
    else:
        detector = source.build(ThermalPixels, full_scale_temperature=source.full_scale_k)
    model = SensorModel(
        photons,
        optics,
        detector,
        DetectorNoise(),
        scenario.seed if seed is None else seed,
        frame,
        scanning=scan_rate(scenario) != 0.0,
        # Only a full turn of equal angles closes, so that blur continues across the seam.
        circle=sensor.fov_deg[0] >= 360.0 - 1e-9 and sensor.projection == "equal-angle",
    )
    return _with_room(_with_stated_netd(_with_noise(model, scenario), scenario))


def _with_stated_netd(model: SensorModel, scenario: Scenario) -> SensorModel:
    """Return the sensor with the read noise or the integration time that gives the NETD of its data sheet, if one is stated."""
    source = scenario.sensor.detector
    if not isinstance(source, PhotonDetector) or source.netd_k is None or not isinstance(model.detector, PhotonPixels):
        return model
    try:
        if source.integration_time_s is None:
            # Noise depends on the integration time through the correction temperatures, so it is built again.
            time = integration_time_for(model, source.netd_k, source.netd_temperature_k, _dwell(scenario))
            return _with_noise(replace(model, detector=replace(model.detector, integration_time=time)), scenario)
        read = read_noise_for(model, source.netd_k, source.netd_temperature_k)
        return replace(model, detector=replace(model.detector, read_noise=read))
    except DomainError as error:
        key = "sensor.detector.netd_k"
        mistake = Mistake(key, source.netd_k, error.allowed, f"{key} = {source.netd_k:g}: {error}")
        raise ScenarioError(mistake.text, mistakes=(mistake,)) from error


def _with_room(model: SensorModel) -> SensorModel:
    """Return the sensor; refuse dark current that fills its wells, report dark current and warm optics that do together."""
    line, detector = model.readout, model.detector
    if not isinstance(detector, PhotonPixels) or detector.well_capacity is None:
        return model
    if line.dark >= detector.well_capacity:
        key = "sensor.detector.dark_current_e_s"
        text = (
            f"{key} = {detector.dark_current:g} fills the well of {detector.well_capacity:g} electrons in an integration of "
            f"{detector.integration_time:g} s; lower it, or shorten the integration"
        )
        raise ScenarioError(text, mistakes=(Mistake(key, detector.dark_current, None, text),))
    if line.background >= line.capacity:
        REPORTS.warning(
            "sensor.detector: dark current and warm optics give %.4g electrons in an integration of %g s, and the well holds %g: every "
            "pixel is saturated; shorten the integration, or cool optics and detector",
            line.background, detector.integration_time, detector.well_capacity,
        )  # fmt: skip
    return model


def _photons(over: Band, detector: Any) -> Photons:
    if not isinstance(detector, PhotonDetector):
        return Photons(over)
    if detector.quantum_efficiency_file is None:
        return Photons(over, None, detector.quantum_efficiency)
    try:
        return Photons(over, read_response(detector.quantum_efficiency_file, whole=True), detector.quantum_efficiency)
    except DomainError as error:
        key = "sensor.detector.quantum_efficiency_file"
        mistake = Mistake(key, error.value, error.allowed, f"{key} = '{detector.quantum_efficiency_file}': {error}")
        raise ScenarioError(mistake.text, mistakes=(mistake,)) from error


def _with_noise(model: SensorModel, scenario: Scenario) -> SensorModel:
    settings = scenario.sensor.noise
    if settings is None:
        return model
    line, corrected = model.readout, None
    if settings.corrected_at_k is not None:
        # The correction is made on the signal without dark current.
        first, second = (float(line.units(model.photons.radiance(t))) - line.dark for t in settings.corrected_at_k)
        corrected = (first, second)
    return replace(model, noise=settings.build(DetectorNoise, corrected_at=corrected))


def scan(scenario: Scenario) -> ScanPattern:
    """Return the times at which columns and rows are taken."""
    settings = scenario.sensor.scan
    if settings is None:
        return ScanPattern()
    period = 1.0 / scenario.sensor.frame_rate_hz if settings.period_s is None else settings.period_s
    return settings.build(ScanPattern, period=0.0 if settings.kind == "staring" else period, leftwards=settings.direction == "left")


def scan_rate(scenario: Scenario) -> float:
    """Return the movement of a scanner's line of sight along rows [rad s-1]; 0 if all columns have one instant."""
    pattern = scan(scenario)
    if pattern.kind == "staring" or pattern.period == 0.0:
        return 0.0
    rate = math.radians(scenario.sensor.fov_deg[0]) / pattern.period
    return -rate if pattern.leftwards else rate


def _dwell(scenario: Scenario) -> float:
    """Return the default integration time [s]: a whole frame, or the time in which a scanner moves by a pixel."""
    pattern = scan(scenario)
    if pattern.kind == "staring" or pattern.period == 0.0:
        return 1.0 / scenario.sensor.frame_rate_hz
    return pattern.period / scenario.sensor.pixels[0]


def line_of_sight_rates(track: Track, time: float, exposure: float, projection: str) -> tuple[float, float]:
    """Return the movement of the middle of the picture by the platform in an exposure, along rows and across them [rad s-1].

    Objects in the picture move in the opposite direction; the blur is equal.
    """
    if not track.turns or exposure <= 0.0:
        return (0.0, 0.0)
    # At the ends of the track the exposure is shifted inside it, so that its length remains.
    end = min(time + 0.5 * exposure, float(track.time[-1]))
    begin = max(end - exposure, float(track.time[0]))
    if end <= begin:
        return (0.0, 0.0)
    first, last = track.at(begin).attitude, track.at(end).attitude
    azimuth, elevation = last.azimuth - first.azimuth, last.elevation - first.elevation
    # Columns of an equal-angle picture are steps of azimuth; on a plane picture they are angles across the line of sight.
    along = azimuth if projection == "equal-angle" else azimuth * math.cos(0.5 * (first.elevation + last.elevation))
    roll = first.roll
    right, up = along * math.cos(roll) - elevation * math.sin(roll), along * math.sin(roll) + elevation * math.cos(roll)
    return right / (end - begin), -up / (end - begin)


def platform_rates(scenario: Scenario, exposure: float) -> tuple[float, float]:
    """Return the root mean square of ``line_of_sight_rates`` over the scenario's frames [rad s-1]; signs are not known to an MTF."""
    platform, sensor = scenario.platform, scenario.sensor
    if platform is None:
        return (0.0, 0.0)
    waves = scenario_physics.sea(scenario, slopes(scenario)).waves if platform.floats else None
    track = scenario_physics.track(scenario, waves)
    times = np.linspace(0.0, (sensor.frames - 1) / sensor.frame_rate_hz, min(sensor.frames, RATED_FRAMES))
    rates = np.array([line_of_sight_rates(track, float(time), exposure, sensor.projection) for time in times])
    along, across = np.sqrt((rates**2).mean(axis=0))
    return float(along), float(across)


def sensor_attributes(model: SensorModel, oversampling: int) -> Attributes:
    """Return the attributes with which a file of counts is converted to radiance and temperature."""
    line, photon = model.readout, isinstance(model.detector, PhotonPixels)
    unit = "electrons" if photon else "nanowatts absorbed"
    return {
        "gain": line.gain,
        "offset": line.offset,
        "gain_units": f"{unit} per count",
        "background": line.background,
        "units_per_radiance": line.per_radiance,
        "radiance_scale": line.radiance_scale,
        "radiance_offset": line.radiance_offset,
        "counts_to_radiance": "radiance = signal * radiance_scale + radiance_offset [W m-2 sr-1]",
        "oversampling": oversampling,
        "oversampling_needed": model.oversampling,
        "sensor_ifov_mrad": 1e3 * model.ifov,
        "sensor_blur_px": blur_px(model),
        "sensor_seed": model.seed,
    }
