"""Calm seas of scenarios: the same from both sides of the Sun and for every wind that does not blow, and no step up to 2 m/s."""

import numpy as np
import pytest

from seaglint.facet.glint import glint
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build.waves_and_slopes import slopes
from seaglint.studies.mean.evaluate_cases import SLOPE_KINDS, slopes_of
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence.labelled_frames import image

LAWS = ["cox-munk-isotropic", "cox-munk-anisotropic", "cox-munk-gram-charlier", "cox-munk-slick", "breon-henriot", "spectrum"]
SENSOR = {"pixels": [25, 16], "fov_deg": [40, 23], "elevation_deg": -12, "azimuth_deg": 180, "height_m": 30}


def scene(kind: str, wind: float, wind_from: float, band=(3.5, 5.0), zenith: float = 75.0, **tables):
    return parse_scenario(
        {
            "wind": {"speed_m_s": wind, "from_deg": wind_from},
            "sea": {"slopes": {"kind": kind}},
            "sun": {"zenith_deg": zenith, "azimuth_deg": 180.0},
            "band": {"min_um": band[0], "max_um": band[1]},
            "sensor": SENSOR,
            "render": {"gaussian_facets": True, "subpixel_glint": "off", "tile_size": 256},
        }
        | tables
    )


def glint_chance(kind: str, wind: float, wind_from: float, zenith: float, spectrum: str = "elfouhaily") -> np.ndarray:
    """Chance that a point mirrors the Sun, over views from the nadir side to 1 deg below the horizon, both sides of the Sun alike."""
    tables = {"sea": {"slopes": {"kind": kind}, "spectrum": {"kind": spectrum}}}
    statistics = slopes(scene(kind, wind, wind_from, **tables))
    views, aside = np.radians([50.0, 70.0, 80.0, 85.0, 89.0])[:, None], np.radians([-25.0, -9.0, -2.0, 2.0, 9.0, 25.0])
    return np.asarray(glint(views, aside, np.radians(zenith), np.pi, statistics).chance)


@pytest.mark.parametrize("spectrum", ["elfouhaily", "flat"])
@pytest.mark.parametrize("kind", LAWS)
def test_glint_of_a_calm_is_symmetric_about_the_sun(kind: str, spectrum: str) -> None:
    for zenith in (40.0, 85.0):
        found = [glint_chance(kind, 0.0, wind_from, zenith, spectrum) for wind_from in (0.0, 180.0, 230.0, 90.0)]
        for one in found:
            np.testing.assert_allclose(one, one[:, ::-1], rtol=1e-6, atol=1e-12 * one.max())
            np.testing.assert_allclose(one, found[0], rtol=1e-6, atol=1e-12 * one.max())


@pytest.mark.parametrize("spectrum", ["elfouhaily", "flat"])
@pytest.mark.parametrize("kind", LAWS)
def test_glint_has_no_step_up_to_three_metres_a_second(kind: str, spectrum: str) -> None:
    """Random winds, and those where laws join, each against one 0.01 mm/s stronger: within 0.1 % of the largest chance."""
    if (kind, spectrum) == ("spectrum", "flat"):
        return  # a mirror at any wind
    rng = np.random.default_rng([LAWS.index(kind), len(spectrum)])
    joins = np.array([0.5, 1.52672, 1.95367, 1.98864, 2.37539, 2.41935]) - 5e-6
    for wind in np.concatenate([[0.0], joins, rng.uniform(0.0, 3.0, 8)]):
        wind_from, zenith = rng.uniform(0.0, 360.0), rng.choice([40.0, 75.0, 86.0])
        low, high = (glint_chance(kind, w, wind_from, zenith, spectrum) for w in (wind, wind + 1e-5))
        assert np.abs(high - low).max() < 1e-3 * low.max(), wind


@pytest.mark.parametrize("band", [(3.5, 5.0), (8.0, 12.0)])
def test_maps_and_images_of_a_calm_are_symmetric(band: tuple[float, float]) -> None:
    """The peak is one whatever the direction of no wind, and the left of the picture is its right turned over."""
    pictures = [
        make(scene("cox-munk-anisotropic", 0.0, wind_from, band))["radiance"].to_numpy()
        for make in (mean, image)
        for wind_from in (230.0, 180.0)
    ]
    for made in pictures:
        np.testing.assert_allclose(made, made[:, ::-1], rtol=2e-5)  # single precision, and the sphere of the Earth is walked by columns
    for one, other in (pictures[:2], pictures[2:]):
        np.testing.assert_allclose(one, other, rtol=2e-5)
    isotropic = mean(scene("cox-munk-isotropic", 0.0, 0.0, band))["radiance"].to_numpy()
    np.testing.assert_allclose(pictures[0], isotropic, rtol=2e-2)  # shadows of 1.67 bands by the breadth of ripples, 1.59 by their variance


def test_maps_and_images_come_out_of_a_calm_evenly() -> None:
    for make in (mean, image):
        calm, light = (make(scene("cox-munk-anisotropic", wind, 230.0))["radiance"].to_numpy().astype(float) for wind in (0.0, 0.01))
        assert np.abs(light - calm).max() < 0.03 * calm.max()


@pytest.mark.parametrize("kind", SLOPE_KINDS)
def test_cases_have_the_sea_of_scenarios_in_light_winds(kind: str) -> None:
    for wind in (0.0, 0.2, 1.3, 2.6):
        rows, whole = slopes_of(kind, wind, np.radians(50.0), False), slopes(scene(kind, wind, 230.0))
        assert rows.directed == whole.directed
        for name in ("mss_up", "mss_cross", "coefficients"):
            assert getattr(rows, name) == pytest.approx(getattr(whole, name), rel=1e-9), name
        assert np.array(rows.nesting) == pytest.approx(np.array(whole.nesting), rel=1e-6, abs=1e-12)


def test_slopes_of_a_spectrum_keep_the_residual_where_the_wind_sea_vanishes() -> None:
    """A model of the wind sea falls to the clean sea's residual; waves that are given and a flat sea stay what they are."""
    swell = {"kind": "jonswap", "significant_height_m": 0.5, "peak_period_s": 9.0, "from_deg": 300.0}
    systems = {"kind": "systems", "systems": [swell, {"kind": "elfouhaily"}]}
    of = {
        name: slopes(scene("spectrum", 0.0, 200.0, sea={"slopes": {"kind": "spectrum"}, "spectrum": table}))
        for name, table in {"wind": {"kind": "elfouhaily"}, "swell": swell, "both": systems, "flat": {"kind": "flat"}}.items()
    }
    assert of["wind"].is_isotropic
    assert of["wind"].mss == pytest.approx(0.003)
    assert of["flat"].is_flat
    assert of["swell"].directed is None
    assert of["both"].mss_up == pytest.approx(max(of["swell"].mss_up, 0.0015))
    assert of["both"].mss_cross == pytest.approx(max(of["swell"].mss_cross, 0.0015))
