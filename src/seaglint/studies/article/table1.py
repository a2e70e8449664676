"""The source article's Table 1: false alarms of the Laplacian filter in a rendered two-second glint sequence.

The article does not describe the scene of its recording. Ours is the scene of its Fig. 4 (sensor at 100 m, 5 m/s of wind from 45 degrees
beside the Sun), seen at the depressions of its Fig. 5 (1.5 to 6 degrees) with the Sun 30 degrees high and waves down to half a metre.
The rates depend on wind, Sun and range; ``docs/figures/false_alarm_table.py`` computes this dependence.

The article's pictures come from a sensor, the General Dynamics Advanced Imaging Sensor, of which it states neither pixels nor blur.
Correlation times need a blur: it joins neighbouring glints and prolongs them. So the same frames are counted twice, as rendered and
through a detector (``BLUR_PX``), and again with other blurs (``BLURS_PX``).

Its glint below a pixel has a correlation time of 70 ms (``CORRELATION_TIME``). The same sea is rendered a second time with sparkles that
follow from its waves (``sea.glint.correlation = "waves"``), and is counted as rendered and through the detector.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Analysis, AnalysisOptions, Recording, analyze
from seaglint.analysis.region import AlarmSummary
from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.free_form import JsonObject, TomlTables
from seaglint.clutter.false_alarms import FalseAlarmRate, FalseAlarms
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Scene, image
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.figures_of_merit import blur_px as beyond_pixel
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.studies.article.figures import GLINT_BAND, GLINT_HEIGHT, IMAGE_WIND_DIRECTIONS, IMAGE_WINDS, ignore_progress, reported
from seaglint.studies.article.headline import ArticleRow, SensedRow
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.sensor_model import sensor_model
from seaglint.studies.sequence.render_sequence import prepare_sequence

FRAME_RATE: Final = 25.0  #: Frames per second [Hz].

FRAMES: Final = 50  #: Frames of the sequence: the article's lasts about two seconds.

DEPRESSIONS_DEG: Final = (1.5, 6.0)  #: Depressions that the image spans [deg]: the sea from 1 to 4 km.

#: Pixels along and up, nearly as many as in 256 x 256: the corridor and sea on both its sides are in the picture.
PIXELS: Final = (448, 140)

SUN: Final = 60.0  #: Zenith angle of the Sun [deg].

SHORTEST_WAVE: Final = 0.5  #: Shortest wave that is geometry [m]: as short as the pixels are wide at the near edge.

CORRELATION_TIME: Final = 0.07  #: The article's correlation time of glint at a point [s].

Correlation = Literal["time", "waves"]  #: What sets the sparkles of a picture: the article's time, or the waves.

CORRIDOR_SHARE: Final = 0.5  #: Mean mirrored Sun, as a share of its row's largest, from which a pixel belongs to the corridor.

#: Blur of the detector beyond its pixels, a standard deviation [px of 0.56 mrad].
#:
#: Assumed: the article does not state the blur of its sensor. Its Fig. 4 takes detectors of 1.0 mrad, which pixels of 0.56 mrad sample
#: about twice, as scanners do. With this blur of 0.67 mrad the transfer of the whole sensor has fallen to a tenth, the usual limit of
#: resolution, at the Nyquist frequency of such detectors, 0.5 cycles/mrad.
BLUR_PX: Final = 1.2

#: Blurs with which rates and correlation times are computed too [px], to show their dependence on the assumed blur.
BLURS_PX: Final = (0.8, 1.0, 1.2, 1.5)

F_NUMBER: Final = 2.1  #: F-number of the optics, usual in cooled cameras.

#: Pitch of the pixels [um]: assumed; at F/2.1 the aperture is the 2 in. of the seeker to whose noise the article compares its clutter.
PITCH_UM: Final = 60.0

FILL_FACTOR: Final = 0.9  #: Sensitive share of a pixel's area: assumed, as in the ready sensors.

INTEGRATION_TIME: Final = 1e-3  #: Integration time [s]: assumed, short against the frame of 0.04 s, because waves do not move within it.

MARGIN: Final = 6  #: Pixels that are rendered beyond each border of the picture, five blurs of 1.2: their light blurs into it.

#: Table 1: false-alarm rate and correlation time [s] by region and threshold; None where the article has "not measured".
ARTICLE: Final[dict[str, dict[float, tuple[float | None, float | None]]]] = {
    "glint": {3.0: (0.0096, 0.270), 3.5: (0.0050, 0.202)},
    "background": {3.0: (0.014, 0.292), 3.5: (None, None)},
}


def scene(
    wind_speed: float = IMAGE_WINDS[1],
    solar_zenith_deg: float = SUN,
    frames: int = FRAMES,
    margin: int = 0,
    sensor: TomlTables | None = None,
    correlation: Correlation = "time",
) -> Scenario:
    """Return the scenario of the sequence, also at another wind or Sun.

    Parameters
    ----------
    wind_speed : float
        Wind at 10 m [m/s].
    solar_zenith_deg : float
        Zenith angle of the Sun [deg].
    frames : int
        Number of frames.
    margin : int
        Pixels beyond each border of the picture.
    sensor : dict, optional
        Further keys of ``[sensor]``: its optics and detector.
    correlation : {"time", "waves"}
        Sparkles by the article's correlation time, or by the waves that are no geometry.

    Returns
    -------
    Scenario
    """
    low, high = DEPRESSIONS_DEG
    # Pixels are square in angle; a margin adds pixels without changing their size.
    step = (high - low) / PIXELS[1]
    pixels = [size + 2 * margin for size in PIXELS]
    south = 180.0
    return parse_scenario(
        {
            "sun": {"zenith_deg": solar_zenith_deg, "azimuth_deg": south},
            "sensor": {
                "height_m": GLINT_HEIGHT,
                "azimuth_deg": south,
                "elevation_deg": -0.5 * (low + high),
                "fov_deg": [step * size for size in pixels],
                "pixels": pixels,
                "frame_rate_hz": FRAME_RATE,
                "frames": frames,
                **(sensor or {}),
            },
            "atmosphere": {"spectroscopy": "lowtran7"},
            "band": {"min_um": GLINT_BAND[0], "max_um": GLINT_BAND[1]},
            "wind": {"speed_m_s": wind_speed, "from_deg": south + IMAGE_WIND_DIRECTIONS[1]},
            "sea": {"shortest_wave_m": SHORTEST_WAVE, "glint": _glint(correlation)},
        }
    )


def _glint(correlation: Correlation) -> dict[str, str | float]:
    return {"correlation": "waves"} if correlation == "waves" else {"correlation": "time", "correlation_time_s": CORRELATION_TIME}


def sequence(scene: Scene, times: FloatArray, report: Progress = ignore_progress) -> NDArray[np.float32]:
    """Return the radiance of a standing sensor at times [s, (frames,)], (frames, rows, columns) [W m-2 sr-1]."""
    return np.stack([image(scene, scene.pose, time).radiance for _, time in reported(times.tolist(), report)])


def corridor(view: SeaView, camera: Camera) -> NDArray[np.bool_]:
    """Return the mask of the glint corridor: at least half of the row's brightest mean mirrored Sun, (rows, columns).

    The mean-radiance model is independent of the frames, so that no bright wave adds itself to the region.
    """
    sun = mean_radiance(view, camera.elevations, camera.azimuths).sun
    return np.asarray((sun > 0.0) & (sun >= CORRIDOR_SHARE * sun.max(axis=1, keepdims=True)))


def detector(blur_px: float = BLUR_PX) -> SensorModel:
    """Return the detector through which the pictures are seen, without noise: noise of cooled detectors is a thousandth of this clutter.

    Parameters
    ----------
    blur_px : float
        Blur beyond the pixel, a standard deviation [px]; it is given to the sensor as jitter, whose transfer is a Gaussian.

    Returns
    -------
    SensorModel
    """
    ifov = np.radians((DEPRESSIONS_DEG[1] - DEPRESSIONS_DEG[0]) / PIXELS[1])
    tables: TomlTables = {
        "optics": {"f_number": F_NUMBER, "jitter_urad": 1e6 * blur_px * float(ifov)},
        "detector": {"pitch_um": PITCH_UM, "fill_factor": FILL_FACTOR, "integration_time_s": INTEGRATION_TIME},
    }
    return sensor_model(scene(sensor=tables))


Rates = dict[str, list[FalseAlarmRate]]  #: Rates at the article's thresholds by region.


def blurred_rates(frames: NDArray[np.float32], mask: NDArray[np.bool_]) -> Rates:
    """Return the rates inside and outside the corridor as the analysis counts them, without its fits and without pixels at the border.

    Parameters
    ----------
    frames : ndarray
        Pictures, (frames, rows, columns).
    mask : ndarray of bool
        The corridor, (rows, columns).
    """
    laplacian = Laplacian()
    # Filtered pixels at the border depend on repeated pixels, which are no sea.
    edge = laplacian.margin
    filtered = laplacian.apply(frames)[:, edge:-edge, edge:-edge]
    inner = mask[edge:-edge, edge:-edge]
    out: Rates = {}
    for region, pixels in (("glint", inner), ("background", ~inner)):
        alarms = FalseAlarms(tuple(sorted(ARTICLE["glint"])))
        alarms.add(standardise(filtered, pixels))
        out[region] = alarms.rates()
    return out


@dataclass(frozen=True)
class Table1:
    """The analyses of a rendered sequence, without and with the detector, beside the article's numbers."""

    scenario: Scenario
    analysis: Analysis
    through_detector: Analysis
    by_blur: dict[float, Rates]
    waves: Analysis
    waves_through_detector: Analysis

    def rows(self) -> dict[str, ArticleRow]:
        """Return the article's value and ours by region, threshold and quantity; absent values are None."""
        out: dict[str, ArticleRow] = {}
        sensed = _alarms(self.through_detector)
        waves, waves_sensed = _alarms(self.waves), _alarms(self.waves_through_detector)
        for (region, threshold), alarm in _alarms(self.analysis).items():
            rate, time = ARTICLE[region][threshold]
            ratio = None if rate is None else rate / alarm.gaussian_rate
            name, through_detector = f"{region}_{threshold:g}_sigma", sensed[region, threshold]
            interval = {"interval_95": _interval(alarm), "note": alarm.note}
            interval |= {"detector_interval_95": _interval(through_detector), "detector_note": through_detector.note}
            both = waves[region, threshold], waves_sensed[region, threshold]
            for prefix, one in zip(("waves", "waves_detector"), both, strict=True):
                interval |= {f"{prefix}_interval_95": _interval(one), f"{prefix}_note": one.note}
            blurred = self._of_blurs(region, threshold)
            times = {f"blur_{blur:g}_px": _seconds(value) for blur, value in blurred.items()}
            ratios = {f"blur_{blur:g}_px": value.ratio for blur, value in blurred.items()}
            out[f"rate_{name}"] = SensedRow(rate, alarm.rate, "1", interval, through_detector.rate, *(one.rate for one in both))
            out[f"times_gaussian_{name}"] = SensedRow(ratio, alarm.ratio, "1", ratios, through_detector.ratio, *(one.ratio for one in both))
            seconds = (alarm.correlation_time_s, through_detector.correlation_time_s, *(one.correlation_time_s for one in both))
            out[f"correlation_time_{name}"] = SensedRow(time, seconds[0], "s", times, *seconds[1:])
        return out

    def columns(self) -> dict[str, FloatArray]:
        """Return columns of a CSV file, one row for each threshold: as rendered, through the detector, with other blurs, by waves."""
        thresholds = sorted(ARTICLE["glint"])
        alarms, sensed = _alarms(self.analysis), _alarms(self.through_detector)
        keys = ("rate", "rate_low", "rate_high", "ratio", "correlation_time_s")
        columns: dict[str, Sequence[float | None]]
        columns = {"threshold_sigma": thresholds, "gaussian_rate": [alarms["glint", m].gaussian_rate for m in thresholds]}
        for region, article in ARTICLE.items():
            columns[f"{region}_article_rate"] = [article[m][0] for m in thresholds]
            columns[f"{region}_article_correlation_time_s"] = [article[m][1] for m in thresholds]
            columns |= {f"{region}_{key}": [getattr(alarms[region, m], key) for m in thresholds] for key in keys}
        columns["detector_blur_px"] = [BLUR_PX for _ in thresholds]
        for region in ARTICLE:
            columns |= {f"{region}_detector_{key}": [getattr(sensed[region, m], key) for m in thresholds] for key in keys}
        for blur in self.by_blur:
            for region in ARTICLE:
                values = [self._of_blurs(region, m)[blur] for m in thresholds]
                name = f"{region}_blur_{blur:g}_px"
                columns[f"{name}_rate"] = [value.rate for value in values]
                columns[f"{name}_correlation_time_s"] = [_seconds(value) for value in values]
        for prefix, analysis in (("waves", self.waves), ("waves_detector", self.waves_through_detector)):
            by_waves = _alarms(analysis)
            for region in ARTICLE:
                columns |= {f"{region}_{prefix}_{key}": [getattr(by_waves[region, m], key) for m in thresholds] for key in keys}
        return {name: np.array(values, dtype=np.float64) for name, values in columns.items()}  # None becomes NaN

    def settings(self) -> JsonObject:
        """Return the settings that all rows share."""
        # Settings are read from the scenario, so that they follow its changes.
        s, sun = self.scenario, self.scenario.sun
        recording = self.analysis.recording
        ifov = round(float(1e3 * np.radians(s.sensor.ifov_deg[0])), 4)
        return {
            "frames": recording.frames,
            "frame_rate_hz": recording.frame_rate,
            "pixels": list(s.sensor.pixels),
            "ifov_mrad": ifov,
            "sensor_height_m": s.sensor.height_m,
            "elevation_deg": s.sensor.elevation_deg,
            "band_um": [s.band.min_um, s.band.max_um],
            "wind_speed_m_s": s.wind.speed_m_s,
            "solar_zenith_deg": None if sun is None else sun.zenith_deg,
            "shortest_wave_m": s.sea.shortest_wave_m,
            "sparkles": "by a correlation time, except in the columns of waves, where the waves that are no geometry decide",
            "glint_correlation_time_s": s.sea.glint.correlation_time_s,
            "filter": self.analysis.options.filter.name,
            "sigma_of": "the region in each frame",
            "regions": f"glint: mean mirrored Sun at least {CORRIDOR_SHARE:g} of its row's largest; background: the rest of the sea",
            "detector": "assumed, as the article states neither pixels nor blur of its sensor; without noise",
            "detector_blur_px": BLUR_PX,
            "detector_blur_mrad": round(BLUR_PX * ifov, 3),
            "detector_f_number": F_NUMBER,
            "detector_pitch_um": PITCH_UM,
            "detector_fill_factor": FILL_FACTOR,
            "detector_integration_time_s": INTEGRATION_TIME,
        }

    def _of_blurs(self, region: str, threshold: float) -> dict[float, FalseAlarmRate]:
        """Return the rate of each blur in a region at a threshold."""
        return {blur: next(rate for rate in rates[region] if rate.threshold_sigma == threshold) for blur, rates in self.by_blur.items()}


def _seconds(rate: FalseAlarmRate) -> float | None:
    return None if rate.correlation_time is None else rate.correlation_time / FRAME_RATE


def _interval(alarm: AlarmSummary) -> list[float | None] | None:
    return [alarm.rate_low, alarm.rate_high] if alarm.rate_low is not None else None


def _alarms(analysis: Analysis) -> dict[tuple[str, float], AlarmSummary]:
    """Return the alarms by region and threshold, as far as the article has them."""
    return {
        (name, alarm.threshold_sigma): alarm
        for name in ARTICLE
        for alarm in analysis.regions[name].false_alarms
        if alarm.threshold_sigma in ARTICLE[name]
    }


def table1(report: Progress = ignore_progress, frames: int = FRAMES) -> Table1:
    """Render the sequence and count its false alarms, as rendered and through the detector.

    Parameters
    ----------
    report : callable
        Called with (frames rendered, frames in all).
    frames : int
        Number of frames.

    Returns
    -------
    Table1

    Notes
    -----
    Glints of waves longer than half a metre are in the picture; shorter waves are a mean brightness of each facet. The detector blurs
    pictures in its pixels, not finer ones: aliases that their sampling folds to low frequencies remain.

    References
    ----------
    Source article, Table 1 and Figs. 4, 6 and 7.
    """
    # Blur needs light from beyond the border, so a wider picture is rendered and cut afterwards.
    inner = np.s_[..., MARGIN:-MARGIN, MARGIN:-MARGIN]
    pictures: dict[Correlation, NDArray[np.float32]] = {}
    for number, correlation in enumerate(get_args(Correlation)):
        wide = scene(frames=frames, margin=MARGIN, correlation=correlation)
        prepared = prepare_sequence(wide).scene
        pictures[correlation] = sequence(prepared, np.arange(frames) / FRAME_RATE, _part(report, number * frames, 2 * frames))
        # The mean sea, and so the corridor, is the same for both.
        mask = corridor(prepared.view, scenario_physics.camera(wide))[inner]
    options = AnalysisOptions(mask=mask)
    # A set, because the assumed blur is usually one of the others too.
    blurred = {blur: detector(blur).focal_plane(pictures["time"])[inner] for blur in {BLUR_PX, *BLURS_PX}}
    own = beyond_pixel(detector())
    waves_blurred = detector(BLUR_PX).focal_plane(pictures["waves"])[inner]
    return Table1(
        scene(frames=frames),
        analyze(_recording("rendered glint sequence", pictures["time"][inner], 0.0), options),
        analyze(_recording("glint sequence through a detector", blurred[BLUR_PX], own), options),
        {blur: blurred_rates(blurred[blur], mask) for blur in BLURS_PX},
        analyze(_recording("rendered glint sequence, sparkles by waves", pictures["waves"][inner], 0.0), options),
        analyze(_recording("glint sequence, sparkles by waves, through a detector", waves_blurred, own), options),
    )


def _part(report: Progress, before: int, total: int) -> Progress:
    """Return a report of a part as progress of the whole."""

    def of_whole(done: int, _: int) -> None:
        if done or not before:
            report(before + done, total)

    return of_whole


def _recording(name: str, images: NDArray[np.float32], blur_px: float) -> Recording:
    count, rows, columns = images.shape
    return Recording(
        name, count, rows, columns, lambda start, stop: images[start:stop], frame_rate=FRAME_RATE, units="W m-2 sr-1", blur_px=blur_px
    )
