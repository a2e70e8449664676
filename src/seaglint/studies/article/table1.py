"""The source article's Table 1, computed anew: false alarms of the Laplacian filter in a rendered two-second glint sequence.

The article does not describe the scene of its recording. Ours is that of its Fig. 4 (sensor at 100 m, 5 m/s of wind from 45 degrees
beside the Sun), seen at the depressions of its Fig. 5 (1.5 to 6 degrees) with the Sun 30 degrees high and waves down to half a metre.
The rates depend on wind, Sun and range; ``tools/false_alarm_table.py`` says how.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Analysis, AnalysisOptions, Recording, analyze
from seaglint.analysis.summary import AlarmSummary
from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.free_form import JsonObject
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.image_grid import Camera
from seaglint.imaging.scene import Scene, image
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.studies.article.article_row import ArticleRow
from seaglint.studies.article.figures import GLINT_BAND, GLINT_HEIGHT, IMAGE_WIND_DIRECTIONS, IMAGE_WINDS
from seaglint.studies.prepare import prepare
from seaglint.studies.sequence.render_sequence import prepare_sequence

FRAME_RATE: Final = 25.0
"""Frames per second [Hz]."""

FRAMES: Final = 50
"""Frames of the sequence: the article's lasts about two seconds."""

DEPRESSIONS_DEG: Final = (1.5, 6.0)
"""Depressions that the image spans [deg]: the sea from 1 to 4 km."""

PIXELS: Final = (448, 140)
"""Pixels along and up, nearly as many as in 256 x 256: the corridor and sea on both its sides are in the picture."""

SUN: Final = 60.0
"""Zenith angle of the Sun [deg]."""

SHORTEST_WAVE: Final = 0.5
"""Shortest wave that is geometry [m]: as short as the pixels are wide at the near edge."""

CORRIDOR_SHARE: Final = 0.5
"""Mean mirrored Sun, as a share of its row's largest, from which a pixel belongs to the corridor."""

ARTICLE: Final[dict[str, dict[float, tuple[float | None, float | None]]]] = {
    "glint": {3.0: (0.0096, 0.270), 3.5: (0.0050, 0.202)},
    "background": {3.0: (0.014, 0.292), 3.5: (None, None)},
}
"""Table 1: false-alarm rate and correlation time [s] by region and threshold; None where the article has "not measured"."""


def _silent(done: int, total: int) -> None:
    """Ignore progress."""


def scene(wind_speed: float = IMAGE_WINDS[1], solar_zenith_deg: float = SUN, frames: int = FRAMES) -> Scenario:
    """Scenario of the sequence, at another wind or Sun too.

    Parameters
    ----------
    wind_speed : float
        Wind at 10 m [m/s].
    solar_zenith_deg : float
        Zenith angle of the Sun [deg].
    frames : int
        Number of frames.

    Returns
    -------
    Scenario
    """
    low, high = DEPRESSIONS_DEG
    height_deg = high - low
    south = 180.0
    return parse_scenario(
        {
            "sun": {"zenith_deg": solar_zenith_deg, "azimuth_deg": south},
            "sensor": {
                "height_m": GLINT_HEIGHT,
                "azimuth_deg": south,
                "elevation_deg": -0.5 * (low + high),
                "fov_deg": [height_deg * PIXELS[0] / PIXELS[1], height_deg],
                "pixels": list(PIXELS),
                "frame_rate_hz": FRAME_RATE,
                "frames": frames,
            },
            "band": {"min_um": GLINT_BAND[0], "max_um": GLINT_BAND[1]},
            "wind": {"speed_m_s": wind_speed, "from_deg": south + IMAGE_WIND_DIRECTIONS[1]},
            "sea": {"shortest_wave_m": SHORTEST_WAVE},
        }
    )


def sequence(scene: Scene, times: FloatArray, report: Progress = _silent) -> NDArray[np.float32]:
    """Radiance of a standing sensor at times [s, (frames,)], (frames, rows, columns) [W m-2 sr-1]."""
    images = []
    report(0, times.size)
    for time in times.tolist():
        images.append(image(scene, scene.pose, time).radiance)
        report(len(images), times.size)
    return np.stack(images)


def corridor(view: SeaView, camera: Camera) -> NDArray[np.bool_]:
    """Mask of the glint corridor: at least half of the row's brightest mean mirrored Sun, (rows, columns).

    The mean-radiance model knows nothing of the frames, so that no bright wave puts itself into the region.
    """
    sun = mean_radiance(view, camera.elevations, camera.azimuths).sun
    return np.asarray((sun > 0.0) & (sun >= CORRIDOR_SHARE * sun.max(axis=1, keepdims=True)))


@dataclass(frozen=True)
class Table1:
    """The analysis of a rendered sequence beside the article's numbers."""

    scenario: Scenario
    analysis: Analysis

    def rows(self) -> dict[str, ArticleRow]:
        """Article's value and ours by region, threshold and quantity; absent ones are None."""
        out: dict[str, ArticleRow] = {}
        for region, threshold, alarm in self._alarms():
            rate, time = ARTICLE[region][threshold]
            ratio = None if rate is None else rate / alarm.gaussian_rate
            name = f"{region}_{threshold:g}_sigma"
            known = alarm.rate_low is not None
            interval = {"interval_95": [alarm.rate_low, alarm.rate_high] if known else None, "note": alarm.note}
            out[f"rate_{name}"] = ArticleRow(rate, alarm.rate, "1", interval)
            out[f"times_gaussian_{name}"] = ArticleRow(ratio, alarm.ratio, "1")
            out[f"correlation_time_{name}"] = ArticleRow(time, alarm.correlation_time_s, "s")
        return out

    def columns(self) -> dict[str, FloatArray]:
        """Return the rows as columns of a CSV file, one row for each threshold."""
        thresholds = sorted(ARTICLE["glint"])
        alarms = {(region, threshold): alarm for region, threshold, alarm in self._alarms()}
        columns: dict[str, Sequence[float | None]]
        columns = {"threshold_sigma": thresholds, "gaussian_rate": [alarms["glint", m].gaussian_rate for m in thresholds]}
        for region, article in ARTICLE.items():
            columns[f"{region}_article_rate"] = [article[m][0] for m in thresholds]
            columns[f"{region}_article_correlation_time_s"] = [article[m][1] for m in thresholds]
            for key in ("rate", "rate_low", "rate_high", "ratio", "correlation_time_s"):
                columns[f"{region}_{key}"] = [getattr(alarms[region, m], key) for m in thresholds]
        return {name: np.array(values, dtype=np.float64) for name, values in columns.items()}  # None becomes NaN

    def settings(self) -> JsonObject:
        """Return the settings that all rows share."""
        s, sun = self.scenario, self.scenario.sun
        recording = self.analysis.recording
        return {
            "frames": recording.frames,
            "frame_rate_hz": recording.frame_rate,
            "pixels": list(s.sensor.pixels),
            "ifov_mrad": round(float(1e3 * np.radians(s.sensor.ifov_deg[0])), 4),
            "sensor_height_m": s.sensor.height_m,
            "elevation_deg": s.sensor.elevation_deg,
            "band_um": [s.band.min_um, s.band.max_um],
            "wind_speed_m_s": s.wind.speed_m_s,
            "solar_zenith_deg": None if sun is None else sun.zenith_deg,
            "shortest_wave_m": s.sea.shortest_wave_m,
            "filter": self.analysis.options.filter.name,
            "sigma_of": "the region in each frame",
            "regions": f"glint: mean mirrored Sun at least {CORRIDOR_SHARE:g} of its row's largest; background: the rest of the sea",
        }

    def _alarms(self) -> list[tuple[str, float, AlarmSummary]]:
        regions = self.analysis.summary().present
        return [
            (name, alarm.threshold_sigma, alarm)
            for name in ARTICLE
            for alarm in regions[name].false_alarms
            if alarm.threshold_sigma in ARTICLE[name]
        ]


def table1(report: Progress = _silent, frames: int = FRAMES) -> Table1:
    """Render the sequence and count its false alarms.

    Parameters
    ----------
    report : callable
        Told how many of how many frames are rendered.
    frames : int
        Number of frames.

    Returns
    -------
    Table1

    Notes
    -----
    Of the sea's glints those of waves longer than half a metre are in the picture; shorter ones are a mean brightness of each facet.
    The sensor is perfect: no blur, no noise.

    References
    ----------
    Source article, Table 1 and Figs. 6 and 7.
    """
    scenario = scene(frames=frames)
    prepared = prepare_sequence(scenario).scene
    images = sequence(prepared, np.arange(frames) / FRAME_RATE, report)
    count, rows, columns = images.shape
    recording = Recording(
        "rendered glint sequence",
        count,
        rows,
        columns,
        lambda start, stop: images[start:stop],
        frame_rate=FRAME_RATE,
        units="W m-2 sr-1",
    )
    return Table1(scenario, analyze(recording, AnalysisOptions(mask=corridor(prepared.view, prepare.camera(scenario)))))
