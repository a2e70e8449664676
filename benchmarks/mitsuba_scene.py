"""The scene of the comparison with a general ray tracer, on our side.

One periodic tile of 1024 m with a 1 m lattice, wind 10 m/s towards the sensor, which stands at 30 m and looks straight at the Sun; 1024 x
512 pixels of equal angles, 16 x 8 deg. No air: the comparison is about geometry and light. Waves down to 4 m are geometry, the rest is
roughness.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.facet.facet_tables import facet_slopes
from seaglint.facet.legs import FacetLaw
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Accuracy
from seaglint.imaging.upright_scene import SweptScene
from seaglint.scenario.load import parse_scenario
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.tiles import Tile
from seaglint.sea.wave_field import WaveField
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import spectrum

LENGTH = 1024.0
POINTS = 1024
RANGE = 14 * 1024.0
"""How far the ray tracer's tiles reach [m]; the sweep goes on to the horizon."""

SHORTEST_WAVE = 4.0
HEIGHT = 30.0
SUN_ZENITHS = (50.0, 80.0)
PIXELS = (1024, 512)
ROWS_UNDER_HORIZON = 3.0


def scene(
    sun_zenith_deg: float, pixels: tuple[int, int] = PIXELS, *, length: float = LENGTH, points: int = POINTS
) -> tuple[SeaView, Camera, WaveField]:
    """View, camera and sea of the comparison."""
    scenario = parse_scenario(
        {
            "sun": {"zenith_deg": sun_zenith_deg, "azimuth_deg": 180},
            "sensor": {"height_m": HEIGHT, "pixels": list(pixels), "fov_deg": [16, 8], "elevation_deg": -3.4, "azimuth_deg": 180},
            "wind": {"speed_m_s": 10, "from_deg": 180},
            "atmosphere": {"source": "none"},
        }
    )
    every_wave = spectrum(scenario)
    assert every_wave is not None
    waves = WaveField.create(every_wave, (Tile(length, points, 0.0, 0.0, 2.0 * np.pi * points / (SHORTEST_WAVE * length)),), 1)
    view = scenario_physics.view(scenario)
    # the ray tracers' facets do not lean
    return replace(view, shadowing=replace(view.shadowing, lean=False)), scenario_physics.camera(scenario), waves


def renderer(view: SeaView, camera: Camera, waves: WaveField, *, step: float | None = None, detail: float = 2.0) -> SweptScene:
    """Our renderer of the scene with one setting of its accuracy, one line a column; ``detail`` is its ``shortest_wave_columns``."""
    accuracy = Accuracy(step=step, lines_per_column=1, shortest_wave_columns=detail)
    return SweptScene.prepare(view, camera, waves, accuracy=accuracy)


def facets_left(view: SeaView, waves: WaveField) -> tuple[SlopeStatistics, FacetLaw]:
    """Slopes and law of hiding of the facets where all waves of the tile are geometry, as the renderer has them."""
    facets = facet_slopes(view.slopes, waves.resolved_mss(), waves.spectrum.wind_to_azimuth, waves.resolved_covariance())
    return facets, view.hiding.facet_law(view.slopes, facets)


def compared_rows(camera: Camera) -> slice:
    """Rows more than :data:`ROWS_UNDER_HORIZON` pixels under the horizon of the calm sea."""
    first = (camera.top + horizon_depression(camera.height)) / camera.row_step + ROWS_UNDER_HORIZON
    return slice(math.ceil(first), camera.rows)


def rms_over_mean(image: FloatArray, reference: FloatArray) -> float:
    """Root mean square difference of two images over the mean of the second [1]."""
    return float(np.sqrt(np.mean((image - reference) ** 2)) / np.mean(reference))
