"""Sky and sea at the sea horizon, in mean maps and pictures: one step between them, and no line beside it."""

import itertools

import numpy as np
import pytest

from seaglint.api import image
from seaglint.base.conventions import horizon_depression
from seaglint.formats.lowtran.deck import MODELS
from seaglint.optics.band import apparent_temperature
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics

BANDS = ((3.5, 5.0), (8.0, 12.0))
BUMP = 0.1  # K: what may be seen beside the step from sea to sky

OFF = np.radians(np.geomspace(1e-4, 0.1, 40))  # from the sea horizon [rad]


def scenario(model, height, wind, edges, **sensor):
    return parse_scenario(
        {
            "sensor": {"height_m": height, "pixels": [4, 4], "azimuth_deg": 10.0} | sensor,
            "sun": {"zenith_deg": 60.0, "azimuth_deg": 180.0},
            "band": {"min_um": edges[0], "max_um": edges[1]},
            "wind": {"speed_m_s": wind},
            "sea": {"resolve_waves": False},
            "atmosphere": {"model": model},
        }
    )


def bump(temperature):
    """How far a profile comes back from its largest or its smallest value so far, whichever is less."""
    return min(np.max(np.maximum.accumulate(temperature) - temperature), np.max(temperature - np.minimum.accumulate(temperature)))


GRID = list(itertools.product(MODELS, (2.0, 5.0, 15.0, 40.0, 100.0), (0.0, 2.0, 7.0, 13.0, 20.0)))
FEW = [(model, height, 7.0) for model, height in zip(MODELS, (2.0, 5.0, 5.0, 15.0, 40.0, 100.0), strict=True)]
# The others with both bands by turns: neighbours in model, height or wind have the other band.
CASES = [(*case, edges) for case in FEW for edges in BANDS] + [
    pytest.param(*case, BANDS[number % 2], marks=pytest.mark.validation) for number, case in enumerate(GRID) if case not in FEW
]


@pytest.mark.parametrize(("model", "height", "wind", "edges"), CASES)
def test_mean_maps_have_one_step_at_the_horizon(model, height, wind, edges):
    view = scenario_physics.view(scenario(model, height, wind, edges))
    sky, sea = (
        apparent_temperature(mean_radiance(view, side - horizon_depression(height), [0.2]).total, view.band, view.atmosphere.wavenumber_cm)[
            :, 0
        ]
        for side in (OFF, -OFF)
    )
    assert bump(sky) < BUMP
    assert bump(sea) < BUMP
    assert np.ptp(sky) < 1.0  # a bright band of layers is up to 2 K


ROWS = 60


@pytest.mark.parametrize("roll", [0.0, 5.0], ids=["level", "rolled"])
@pytest.mark.parametrize(("model", "height"), [("midlatitude-summer", 5.0), ("us-standard-1976", 2.0), ("tropical", 100.0)])
def test_pictures_have_one_step_at_the_horizon(model, height, roll):
    dip = np.degrees(horizon_depression(height))
    picture = scenario(model, height, 7.0, BANDS[0], pixels=[3, ROWS], fov_deg=[0.012, 0.24], elevation_deg=-dip, roll_deg=roll)
    view = scenario_physics.view(picture)
    column = apparent_temperature(image(picture, time=0.0).radiance.to_numpy()[:, 1], view.band, view.atmosphere.wavenumber_cm)
    sky, sea = column[: ROWS // 2 - 1], column[ROWS // 2 + 1 :]
    assert bump(sky) < BUMP
    assert bump(sea) < BUMP
    # The sky goes on evenly where layers would make it rise by 1.5 K: above the horizon no row differs from the next by 0.1 K.
    assert np.max(np.abs(np.diff(sky))) < BUMP
