"""Levels of detail whose facets have few bands left."""

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.imaging.upright_scene import SweptScene
from seaglint.scenario.load import parse_scenario
from seaglint.sea.shadowing.seen_and_lit import coupled_bands
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.studies.sequence.render_sequence import prepare_sequence


def _scenario(**tables):
    base = {
        "sun": {"zenith_deg": 75, "azimuth_deg": 180},
        "sensor": {"pixels": [48, 32], "fov_deg": [0.4, 0.3], "elevation_deg": -15, "azimuth_deg": 180},
        "wind": {"speed_m_s": 7},
        "sea": {"shortest_wave_m": 0.05},
        "render": {"tile_size": 1024},
    }
    return parse_scenario({name: base.get(name, {}) | tables.get(name, {}) for name in base | tables})


def test_facets_with_little_more_than_one_band():
    """Half of the slopes on facets is more than one band for either leg alone, less than one for what both do together."""
    run = prepare_sequence(_scenario(sea={"shortest_wave_m": 0.5}))
    assert isinstance(run.scene, SweptScene)
    assert run.scene.tables is not None
    bands, view = run.scene.tables.levels, run.scene.view
    assert not bands.smith
    assert bands.nested.shape[1] > 1
    facets = SlopeStatistics(0.5 * view.slopes.mss_up, 0.5 * view.slopes.mss_cross)
    law = view.hiding.facet_law(view.slopes, facets)
    assert 1.0 < law.bands < 2.0
    assert coupled_bands(np.array(0.1), np.array(0.1), law.bands, law.deviation) < 1.2
    image = run.at(0.0)
    assert np.isfinite(image.radiance).all()
    assert image.glint_radiance.mean() > 1e-3


@pytest.mark.parametrize("step", [1e-4, 0.05])
def test_steps_that_do_not_suit_the_waves_are_refused(step):
    with pytest.raises(DomainError, match=r"render.step_m = .* m does not suit waves down to 0.05"):
        prepare_sequence(_scenario(render={"step_m": step}))


def test_facets_of_next_to_no_slopes_shade_less_than_smiths():
    run = prepare_sequence(_scenario())
    assert isinstance(run.scene, SweptScene)
    assert run.scene.tables is not None
    assert run.scene.tables.levels.smith
    east, _, north, towards, *shelter = run.scene.tables.levels.roughness[0, :7]
    slopes = run.scene.view.slopes
    law = run.scene.view.hiding.facet_law(slopes, SlopeStatistics(north, east))
    assert law.bands < 0.9
    assert towards == pytest.approx(law.bands * np.sqrt(north), rel=1e-6)
    assert shelter == pytest.approx(law.shelter)
