"""What rendered glint looks like to a statistician: its fall with range, its tails and how fast waves change it."""

import numpy as np
import pytest

from seaglint.clutter.fits import distances, fit
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence


def _scenario(**tables):
    base = {
        "sun": {"zenith_deg": 60, "azimuth_deg": 180},
        "sensor": {"pixels": [160, 120], "fov_deg": [4, 3], "elevation_deg": -1.7, "azimuth_deg": 180, "height_m": 30},
        "wind": {"speed_m_s": 10, "from_deg": 180},
    }
    return parse_scenario({name: base.get(name, {}) | tables.get(name, {}) for name in base | tables})


@pytest.mark.validation
@pytest.mark.parametrize(("correlation", "tolerance"), [("time", 0.05), ("waves", 0.08)])
def test_variance_falls_with_range_as_the_model_of_the_mean_says(correlation, tolerance):
    """Without resolved waves, to the horizon: variance over time of every pixel against the model of its mean, variance and footprint.

    With cells of one length this is Eq. 18 of the source article. From the waves, the model of the mean is computed apart from the facets
    of images: its table of variances by size, its directions and what is seen follow from the angle of incidence and the share lit.
    """
    scenario = _scenario(sea={"resolve_waves": False, "glint": {"correlation": correlation}}, render={"subpixel_glint": "on"})
    run = prepare_sequence(scenario)
    frames = np.array([run.at(0.5 * k).radiance for k in range(400)], dtype=float)
    view, camera = scenario_physics.view(scenario), scenario_physics.camera(scenario)
    found = mean_radiance(view, camera.elevations, camera.azimuths)
    solid_angle = camera.row_step * camera.column_step * np.cos(camera.elevations)
    expected = sea_variance(view, found, camera.elevations, solid_angle, scenario_physics.glint_correlation(scenario)).mean(axis=1)
    variance = frames.var(axis=0, ddof=1).mean(axis=1)
    sea = np.flatnonzero(camera.elevations < np.radians(-0.25))
    parts = np.array_split(sea, 8)
    ratio = [variance[p].sum() / expected[p].sum() for p in parts]
    standard = [float(np.sqrt(variance[p].mean()) / frames[:, p].mean()) for p in parts]
    print("depression: " + ", ".join(f"{-np.degrees(camera.elevations[p].mean()):.2f}" for p in parts))
    print("variance / model: " + ", ".join(f"{r:.3f}" for r in ratio))
    print("deviation / mean: " + ", ".join(f"{s:.4f}" for s in standard))
    assert ratio == pytest.approx(np.ones(8), abs=tolerance)
    # rows run from the horizon down; by the waves the model itself has its largest variance at 2.7 deg, and large cells scatter the rows
    last = len(parts) if correlation == "time" else 5
    assert np.all(np.diff([variance[p].mean() for p in parts[:last]]) > 0.0)


@pytest.mark.validation
@pytest.mark.parametrize("azimuth", [180.0, 196.0], ids=["inside the corridor", "outside"])
def test_radiances_have_long_tails(azimuth):
    """Reflected sunlight over its row's mean: beside the corridor a gamma density fits it, in the middle its tail lies between both.

    In the middle every pixel holds many facets that mirror the Sun. The cells are the article's, of 70 ms.
    """
    scenario = _scenario(
        sea={"glint": {"correlation": "time"}},
        sensor={"azimuth_deg": azimuth, "elevation_deg": -3.0, "fov_deg": [4, 2], "pixels": [160, 80]},
    )
    run = prepare_sequence(scenario)
    frames = []
    for seed in range(12):
        frames.append(run.reseeded(seed).at(10.0 * seed).glint_radiance.astype(float))
    values = np.array(frames)
    values /= values.mean(axis=(0, 2), keepdims=True)
    values = np.sort(values[values > 0.0].ravel())
    skewness = float(((values - values.mean()) ** 3).mean() / values.std() ** 3)
    found = {family: fit(values[:: values.size // 20_000 + 1], family) for family in ("gamma", "gaussian", "lognormal")}
    distance = {family: float(np.max(distances(f.cdf(values))[0])) for family, f in found.items()}
    tail = {family: float(np.mean(f.cdf(values) > 0.999) / 1e-3) for family, f in found.items()}
    print(
        f"azimuth {azimuth:g}: gamma shape {found['gamma'].shape:.2f}, skewness {skewness:.2f}, largest distance of distributions "
        + ", ".join(f"{name} {d:.3f}" for name, d in distance.items())
        + "; share beyond the fit's 0.999 quantile, in thousandths: "
        + ", ".join(f"{name} {t:.2f}" for name, t in tail.items())
    )
    assert tail["gamma"] < 1.0 < tail["gaussian"]
    if azimuth == 180.0:
        assert skewness > 0.1
        assert distance["gamma"] < 0.1
    else:
        assert skewness > 2.0
        assert distance["gamma"] < 0.25 * distance["gaussian"]


@pytest.mark.validation
@pytest.mark.parametrize("sun_zenith", [75.0, 80.0, 85.0])
def test_waves_change_glint_and_shadow_within_about_a_second(sun_zenith):
    """A 10 m/s sea without sparkles: time in which the correlation of a pixel falls to 1/e."""
    scenario = _scenario(
        sun={"zenith_deg": sun_zenith},
        sensor={"pixels": [128, 96], "elevation_deg": -4.0},
        sea={"shortest_wave_m": 2.0},
        render={"tile_size": 256, "subpixel_glint": "off"},
    )
    run = prepare_sequence(scenario)
    frames = np.array([run.at(0.1 * k).glint_radiance for k in range(60)], dtype=float)
    frames -= frames.mean(axis=(0, 2), keepdims=True)
    correlation = np.array([(frames[: 60 - k] * frames[k:]).mean() for k in range(30)])
    correlation /= correlation[0]
    below = int(np.argmax(correlation < np.exp(-1.0)))
    assert below > 0
    share = (correlation[below - 1] - np.exp(-1.0)) / (correlation[below - 1] - correlation[below])
    time = 0.1 * (below - 1 + share)
    print(f"Sun {sun_zenith:g}: {time:.2f} s")
    assert 0.3 < time < 2.0
