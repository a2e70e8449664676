"""The source article's Figs. 5 and 12: the chance of glint against the azimuth from the Sun, and two bodies over a glinting sea.

Settings of the article for Fig. 5: 3-5 um, band means, isotropic slopes, one shadowed leg; depressions of 1.5 to 6 deg; time uniform over
the day and the year, place uniform over the North Atlantic; a single look with its clouds, a trajectory over all depressions, and one
widened by a field of view of 4 x 4 deg, both hidden by an overcast sky alone. The article does not state height and weather: 30 m and the
packaged table here.

The caption's threshold of 0.25 W cm-2 sr-1 is 2500 W m-2 sr-1. The Sun itself shows some 1e5 W m-2 sr-1 in 3-5 um, but of a sea with
1 m/s of wind or more few facets mirror it: glint stays below a few hundred W m-2 sr-1. A thousandth of the caption's number,
0.25 mW cm-2 sr-1, is 2.5 W m-2 sr-1; 0.25 W m-2 sr-1 is computed too.

Fig. 12 shows two bodies that close over a glinting sea, seen by a third that follows one of them. The article prints one frame of 100, the
view of a defending missile's seeker on a sea-skimming one in solar glint, over a sea 14 km long and 3.5 km wide on average. It does not
state heights, speeds and shapes; here they are taken from ``examples/approach.toml``, the same scene.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.free_form import TomlTables
from seaglint.climate.draws import estimate
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import draw
from seaglint.studies.sequence.render_sequence import render
from seaglint.studies.sequence.scene_objects import bodies_of

THRESHOLDS: Final = (2.5, 0.25)  #: 0.25 mW cm-2 sr-1, and the number of the caption in W m-2 sr-1 [W m-2 sr-1].

PRINTED: Final = 2500.0  #: The caption's 0.25 W cm-2 sr-1 [W m-2 sr-1].

CASES: Final = ("single-look", "trajectory", "field-of-view")
#: Azimuths from the Sun [deg].
AZIMUTHS: Final = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.5, 15.0, 20.0, 25.0, 30.0, 40.0, 60.0, 90.0, 180.0])
NORTH_ATLANTIC: Final = {"latitudes_deg": [35.0, 65.0], "longitudes_deg": [-70.0, 0.0]}
HEIGHT: Final = 30.0
SAMPLES: Final = 8192


@dataclass(frozen=True, eq=False)
class Fig5:
    """Both panels: columns by name, where ``case`` counts ``CASES``, and the results of the printed threshold."""

    columns: dict[str, FloatArray]
    brightest: float  #: Brightest glint of all draws [W m-2 sr-1].
    printed: float  #: Largest chance of the caption's threshold at any azimuth [1].


def scenario(case: str, weather: Path | None, mode: str = "article", samples: int = SAMPLES) -> TomlTables:
    """Return the tables of the scenario of one case."""
    table: TomlTables = {"case": case, "samples": samples, "threshold_w_m2_sr": list(THRESHOLDS), **NORTH_ATLANTIC}
    if weather is not None:
        table["weather"] = str(weather)
    sea: TomlTables = {"water": "article", "slopes": {"kind": "cox-munk-isotropic"}} if mode == "article" else {}
    return {
        "atmosphere": {"spectroscopy": "lowtran7"},
        "band": {"min_um": 3.0, "max_um": 5.0},
        "sensor": {"height_m": HEIGHT},
        "mean": {"mode": mode},
        "sea": sea,
        "likelihood": table,
    }


def figure_5(weather: Path | None = None, *, mode: str = "article", samples: int = SAMPLES, report: Progress | None = None) -> Fig5:
    """Compute both panels.

    Parameters
    ----------
    weather : Path, optional
        Weather table; the packaged North Atlantic where nothing is given.
    mode : {"article", "spectral"}
        Radiance as in the article, or per wavenumber.
    samples : int
        Draws for each azimuth.
    report : callable, optional
        Called with (steps done, all of them).

    Notes
    -----
    (a) is the chance at one azimuth, the same to both sides of the Sun for winds from anywhere. The caption's (b), "for any azimuth less
    than theta_T", can be read in two ways, and both are computed: that some azimuth up to theta_T from the Sun's, of those in
    ``AZIMUTHS`` to both sides, exceeds (``probability_within``; the same draws look at all azimuths), and that a look in a direction
    drawn evenly among them does (``probability_averaged``, the mean of (a) up to theta_T).
    """
    progress = report or (lambda done, total: None)
    rows: list[tuple[float, ...]] = []
    brightest, printed = 0.0, 0.0
    total = len(CASES) * (2 * AZIMUTHS.size - 1)
    done = 0
    for number, case in enumerate(CASES):
        model = LikelihoodModel.of(parse_scenario(scenario(case, weather, mode, samples)))
        within: dict[float, FloatArray] = {}
        for azimuth in AZIMUTHS.tolist():
            sides = []
            # Winds come from anywhere, so both sides of the Sun are equally probable; azimuth 0 has one side.
            for side in (1.0, -1.0) if azimuth > 0.0 else (1.0,):
                progress(done, total)
                sides.append(draw(model, azimuth=side * np.radians(azimuth)))
                done += 1
            brightest = max(brightest, *(float(d.radiance.max()) for d in sides))
            printed = max(printed, *(float(np.average(d.illuminated * (d.radiance > PRINTED), weights=d.weight)) for d in sides))
            for threshold in THRESHOLDS:
                above = [(d.radiance > threshold).astype(np.float64) for d in sides]
                # The largest over all azimuths so far: glint at any azimuth up to this one.
                within[threshold] = np.maximum(within.get(threshold, np.zeros(1)), np.max(above, axis=0))
                # The mean of both sides uses all looks.
                both = np.mean([d.illuminated * a for d, a in zip(sides, above, strict=True)], axis=0)
                at_azimuth = estimate(both, sides[0].plan, weight=sides[0].weight)
                at_any_azimuth = estimate(sides[0].illuminated * within[threshold], sides[0].plan, weight=sides[0].weight)
                chances = [value for one in (at_azimuth, at_any_azimuth) for value in (one.value, one.low, one.high)]
                rows.append((number, threshold, azimuth, *chances))
    progress(total, total)
    names = (
        "case", "threshold_w_m2_sr", "azimuth_deg", "probability", "interval_low", "interval_high",
        "probability_within", "within_low", "within_high",
    )  # fmt: skip
    table = np.array(rows)
    columns = {name: table[:, i] for i, name in enumerate(names)}
    return Fig5({**columns, "probability_averaged": _averaged(columns)}, brightest, printed)


def _averaged(columns: dict[str, FloatArray]) -> FloatArray:
    """Return the mean of (a) over azimuths from the Sun's to each, by trapezia [1]."""
    out = np.empty(columns["probability"].size)
    for number in range(len(CASES)):
        for threshold in THRESHOLDS:
            at = (columns["case"] == number) & (columns["threshold_w_m2_sr"] == threshold)
            chance, azimuth = columns["probability"][at], columns["azimuth_deg"][at]
            sums = np.cumsum(0.5 * (chance[1:] + chance[:-1]) * np.diff(azimuth))
            out[at] = np.concatenate([chance[:1], sums / azimuth[1:]])
    return out


FRAMES: Final = 100  #: Frames of the article's sequence.

PIXELS: Final = 512  #: Pixels along each side.

FRAME_RATE: Final = 10.0  #: Frames per second [Hz]; the article does not state its rate.

SPEED: Final = 50.0  #: Speed of the viewpoint [m/s].

_ATTACKING: Final[TomlTables] = {
    "name": "attacking body",
    "temperature_k": 320,
    "emissivity": 0.9,
    "keyframes": [
        {"time_s": 0, "east_m": -330, "north_m": -5000, "height_m": 14},
        {"time_s": 5, "east_m": -110, "north_m": -3150, "height_m": 10},
        {"time_s": 10, "east_m": 20, "north_m": -1320, "height_m": 12},
    ],
    "shape": {
        "kind": "union",
        "parts": [
            {"kind": "cylinder", "radius_m": 0.8, "length_m": 9, "pitch_deg": 90},
            {"kind": "cone", "radius_m": 0.8, "length_m": 2.5, "at_m": [0, 5.74, 0], "pitch_deg": -90, "temperature_k": 350},
            {"kind": "box", "size_m": [6, 1.6, 0.15], "at_m": [0, -0.5, 0]},
            {"kind": "box", "size_m": [0.15, 1.2, 1.6], "at_m": [0, -3.8, 1.2]},
            {"kind": "plume", "semi_axes_m": [0.7, 5, 0.7], "at_m": [0, -9.6, 0], "temperature_k": 650, "emissivity": 0.2},
        ],
    },
}

_DEFENDING: Final[TomlTables] = {
    "name": "defending body",
    "temperature_k": 310,
    "emissivity": 0.9,
    "keyframes": [
        {"time_s": 0, "east_m": 15, "north_m": -230, "height_m": 52},
        {"time_s": 5, "east_m": 30, "north_m": -640, "height_m": 36},
        {"time_s": 10, "east_m": 8, "north_m": -1240, "height_m": 16},
    ],
    "shape": {
        "kind": "union",
        "parts": [
            {
                "kind": "difference",
                "parts": [
                    {"kind": "cylinder", "radius_m": 0.25, "length_m": 4.5, "pitch_deg": 90},
                    {"kind": "cylinder", "radius_m": 0.18, "length_m": 1, "at_m": [0, -2.25, 0], "pitch_deg": 90, "temperature_k": 600},
                ],
            },
            {"kind": "cone", "radius_m": 0.25, "length_m": 0.8, "at_m": [0, 2.64, 0], "pitch_deg": -90},
            {"kind": "box", "size_m": [1.5, 0.5, 0.04], "at_m": [0, -1.4, 0], "roll_deg": 45},
            {"kind": "box", "size_m": [1.5, 0.5, 0.04], "at_m": [0, -1.4, 0], "roll_deg": -45},
            {"kind": "plume", "semi_axes_m": [0.25, 2.5, 0.25], "at_m": [0, -4.6, 0], "temperature_k": 700, "emissivity": 0.1},
        ],
    },
}


def scene(pixels: int = PIXELS) -> Scenario:
    """Return the scenario of the sequence, with as many ``pixels`` along each side.

    Examples
    --------
    >>> scenario = scene()
    >>> scenario.sensor.frames, scenario.sensor.pixels, [item.name for item in scenario.objects]
    (100, (512, 512), ['attacking body', 'defending body'])
    """
    last = (FRAMES - 1) / FRAME_RATE
    return parse_scenario(
        {
            "seed": 12,
            "atmosphere": {"spectroscopy": "lowtran7"},
            "sun": {"zenith_deg": 66, "azimuth_deg": 180},
            "sensor": {
                "height_m": 60,
                "azimuth_deg": 180,
                "elevation_deg": -3.1,
                "fov_deg": [14, 7],
                "pixels": [pixels, pixels],
                "pixel_shape": "any",
                "frame_rate_hz": FRAME_RATE,
                "frames": FRAMES,
            },
            "platform": {"keyframes": [{"time_s": 0, "east_m": 0, "north_m": 0}, {"time_s": last, "east_m": 0, "north_m": -SPEED * last}]},
            "band": {"min_um": 3.5, "max_um": 5.0},
            "wind": {"speed_m_s": 7, "from_deg": 215},
            "sea": {"temperature_k": 290.15, "shortest_wave_m": 3},
            "render": {"lines_per_column": 2, "variance_error": 0.1, "tile_size": 256},
            "objects": [_ATTACKING, _DEFENDING],
        }
    )


@dataclass(frozen=True, eq=False)
class Trajectories:
    """Positions of sensor and bodies in the vertical plane of the line of sight."""

    time: FloatArray  #: Of the frames [s].
    ahead: dict[str, FloatArray]  #: Distance ahead of the sensor's start, along the sea, by name [m]; the sensor's name is ``"sensor"``.
    height: dict[str, FloatArray]  #: Height above the mean sea, by name [m].
    sight: tuple[float, float]  #: Elevations of the image's lower and upper edge [rad].


def trajectories(scenario: Scenario, frames: range) -> Trajectories:
    """Return the positions of sensor and bodies over some frames."""
    sensor, track = scenario.sensor, scenario_physics.track(scenario)
    time = np.asarray(frames) / sensor.frame_rate_hz
    start = track.at(0.0)
    azimuth = start.attitude.azimuth
    look, origin = np.array([math.sin(azimuth), math.cos(azimuth)]), np.array([start.east, start.north])
    poses = [track.at(float(t)) for t in time]
    places = {"sensor": np.array([[p.east, p.north, p.height] for p in poses])}
    for body in bodies_of(scenario)(None):
        places[body.name] = np.array([body.motion.at(float(t)).position for t in time])
    middle, half = start.attitude.elevation, 0.5 * math.radians(sensor.fov_deg[1])
    # Distances are projected on the first line of sight, the plane of the drawing.
    ahead = {name: (place[:, :2] - origin) @ look for name, place in places.items()}
    return Trajectories(time, ahead, {name: place[:, 2] for name, place in places.items()}, (middle - half, middle + half))


def shown_frame(frames: range) -> int:
    """Return the index of the frame that the figure shows, at 7/10 of the frames: both bodies are in front of the corridor."""
    return (7 * (len(frames) - 1)) // 10


def sequence(
    output: str | Path,
    frames: range | None = None,
    pixels: int = PIXELS,
    *,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Scenario:
    """Render the sequence into a store, with its labels; see ``seaglint.studies.sequence.render_sequence.render``."""
    scenario = scene(pixels)
    render(scenario, output, frames=frames, resume=resume, overwrite=overwrite, progress=progress)
    return scenario
