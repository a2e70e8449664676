"""Mean maps of cameras that have no grid of azimuth and elevation, against images, closed forms and maps of grids."""

import numpy as np
import pytest
import xarray as xr

import seaglint as sg
from seaglint.base.conventions import horizon_depression
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.optics.band import Band
from seaglint.plot.preview import draw
from seaglint.radiance.article import article_radiance
from seaglint.radiance.mean_radiance import MeanModel
from seaglint.scenario.load import parse_scenario
from seaglint.store.netcdf import open_netcdf, write_netcdf
from seaglint.studies.build import scenario_physics
from seaglint.studies.file_contents import describe, lines
from seaglint.studies.mean import mean_map
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence.render_sequence import prepare_sequence

SENSOR = {"pixels": [24, 18], "fov_deg": [16, 12], "frames": 1, "azimuth_deg": 180}
SWINGING = {"keyframes": [{"time_s": 0, "roll_deg": 10, "height_m": 50}, {"time_s": 1, "roll_deg": -5, "height_m": 50}]}
DOWN = {"projection": "pinhole", "elevation_deg": -90, "fov_deg": [60, 50]}
VIEWS = {
    "pinhole": ({"projection": "pinhole", "elevation_deg": -4}, {}),
    "rolled": ({"roll_deg": 30, "elevation_deg": -10}, {}),
    "pinhole, rolled": ({"projection": "pinhole", "roll_deg": -70, "elevation_deg": -20, "fov_deg": [40, 30]}, {}),
    "panorama on a heeling ship": ({"roll_deg": 5, "elevation_deg": -8, "fov_deg": [360, 20], "pixels": [180, 20]}, {}),
    "platform": ({"elevation_deg": -7}, {"platform": SWINGING}),
    "straight down": (DOWN, {"sun": {"zenith_deg": 20, "azimuth_deg": 180}}),
    "straight down, seam in view": (DOWN | {"azimuth_deg": 0}, {"sun": {"zenith_deg": 20, "azimuth_deg": 180}}),
    "nadir at the border": (DOWN | {"elevation_deg": -70, "fov_deg": [60, 40]}, {"sun": {"zenith_deg": 30, "azimuth_deg": 170}}),
}


def scenario_with_sensor(sensor, **more):
    base = {"sea": {"resolve_waves": False}, "sun": {"zenith_deg": 60, "azimuth_deg": 180}, "wind": {"speed_m_s": 7, "from_deg": 140}}
    return parse_scenario(base | {"sensor": SENSOR | sensor} | more)


SEVERAL = {"pinhole", "panorama on a heeling ship", "straight down", "nadir at the border"}
"""Views in which every branch of the geometry is met; the others are for the long comparisons."""


@pytest.mark.parametrize(
    ("sensor", "more"),
    [pytest.param(*view, id=name, marks=() if name in SEVERAL else pytest.mark.validation) for name, view in VIEWS.items()],
)
def test_the_picture_without_waves_is_the_map(sensor, more):
    """Two routes: facets of pictures lean under oblique wind as those of maps."""
    scenario = scenario_with_sensor(sensor, **more)
    found, image = mean(scenario), prepare_sequence(scenario).at(0.0).radiance
    assert found.azimuth.dims == found.elevation.dims == ("y", "x")
    pose = scenario_physics.track(scenario).at(0.0)
    pixel = max(np.divide(scenario.sensor.fov_deg, scenario.sensor.pixels))
    off = np.abs(found.elevation.to_numpy() + np.degrees(horizon_depression(pose.height))) > 2.0 * pixel
    ratio = image / found.radiance.to_numpy()
    # As far as the tables of facets go; in the two rows of pixels next to the horizon the picture itself is 2 to 4 % off.
    np.testing.assert_allclose(ratio[off], 1.0, rtol=2e-3)
    assert np.sqrt(np.mean((ratio[off] - 1.0) ** 2)) < 3e-4
    assert image.mean() == pytest.approx(float(found.radiance.mean()), rel=1e-3)


def test_facets_lean_across_the_light_of_a_low_sun_as_in_the_map():
    """Sun 10 deg high, where its leg leans too; tables of facets seen and lit are good to 0.3 % here."""
    sensor = {"projection": "pinhole", "elevation_deg": -8}
    scenario = scenario_with_sensor(sensor, sun={"zenith_deg": 80, "azimuth_deg": 180})
    found, image = mean(scenario), prepare_sequence(scenario).at(0.0).radiance
    off = found.elevation.to_numpy() + np.degrees(horizon_depression(scenario_physics.track(scenario).at(0.0).height)) < -2.0
    np.testing.assert_allclose((image / found.radiance.to_numpy())[off], 1.0, rtol=4e-3)


@pytest.mark.parametrize("kind", ["cox-munk-anisotropic", "cox-munk-gram-charlier", "cox-munk-isotropic", "flat"])
def test_lines_of_sight_are_those_of_a_grid(kind):
    scenario = scenario_with_sensor({}, sea={"slopes": {"kind": kind}})
    model = MeanModel.prepare(scenario_physics.view(scenario))
    rows, columns = np.radians([10.0, 0.1, -0.3, -2.0, -30.0, -90.0]), np.radians([150.0, 179.0, 181.0, -100.0])
    grid, lines_of_sight = model.map(rows, columns), model.along(np.repeat(rows, columns.size), np.tile(columns, rows.size))
    for part in ("path", "emission", "sky", "sun", "chance", "cos_incidence"):
        values = np.broadcast_to(getattr(grid, part), (rows.size, columns.size))
        # the sky is tabulated for lines of sight
        np.testing.assert_allclose(getattr(lines_of_sight, part)[:, 0], values.ravel(), rtol=1e-6 if part == "sky" else 1e-12, atol=1e-300)


def test_lines_of_sight_of_the_articles_mode_are_those_of_a_grid():
    view = scenario_physics.article_view(scenario_with_sensor({}))
    rows, columns = np.radians([1.0, -2.0, -30.0]), np.radians([150.0, 181.0])
    grid = article_radiance(view, rows, columns).total
    own = article_radiance(view, np.repeat(rows, 2), np.tile(columns, 3)[:, None]).total
    np.testing.assert_allclose(own[:, 0], grid.ravel(), rtol=1e-12)


@pytest.mark.parametrize(
    ("imager", "closed_form"),
    [
        (Imager("pinhole", 1.2, 0.8, 300, 200), 4.0 * np.arcsin(np.sin(0.6) * np.sin(0.4))),
        (Imager("equal-angle", 1.2, 0.8, 300, 200), 1.2 * (np.sin(0.1) - np.sin(-0.7))),
    ],
)
def test_solid_angles_of_pixels_add_up(imager, closed_form):
    turned = imager.solid_angle(Attitude(0.5, -0.3, 0.7), np.arange(300) + 0.5, np.arange(200)[:, None] + 0.5)
    # midpoints of 0.004 rad: 1e-5 of a cosine
    assert turned.sum() == pytest.approx(closed_form, rel=1e-5)


@pytest.mark.parametrize("mode", ["spectral", "article"])
@pytest.mark.parametrize("view", ["pinhole", "straight down, seam in view"])
def test_one_temperature_is_one_radiance(mode, view):
    """White furnace: air, sky and sea at 288.15 K, and no Sun."""
    warm = {"atmosphere": {"source": "isothermal", "temperature_k": 288.15}, "sea": {"temperature_k": 288.15}}
    found = mean(scenario_with_sensor(VIEWS[view][0], mean={"mode": mode}, **warm))
    expected = Band.rectangular(3.5, 5.0).radiance(288.15, np.arange(1990.0, 2870.0, 5.0))
    np.testing.assert_allclose(found.radiance, expected, rtol=1e-5)  # splines of the article's mode, float32
    assert float(found.elevation.min()) > -90.0


def test_a_view_straight_down_turns_with_the_scene():
    """Sun, wind and camera by 180 deg: the seam of azimuth lies elsewhere, the picture is the same."""
    one, other = (
        mean(
            scenario_with_sensor(
                DOWN | {"azimuth_deg": turn}, sun={"zenith_deg": 20, "azimuth_deg": 30 + turn}, wind={"speed_m_s": 7, "from_deg": 70 + turn}
            )
        )
        for turn in (0, 180)
    )
    assert float(one.glint_radiance.max()) > 0.1
    for name in ("radiance", "glint_radiance", "glint_std"):
        np.testing.assert_allclose(one[name], other[name], rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(
    ("mode", "waves"), [pytest.param("spectral", False, marks=pytest.mark.validation), ("spectral", True), ("article", False)]
)
def test_glint_of_coarse_pixels_is_that_of_fine_ones_averaged(mode, waves):
    """Cells are independent: the variance of a pixel is the mean of its parts' variances over their number. Parts of waves are alike."""
    sensor = {"projection": "pinhole", "elevation_deg": -12, "roll_deg": 20}
    sea = {"glint": {"correlation": "waves" if waves else "time"}}
    coarse, fine = (mean(scenario_with_sensor(sensor | {"pixels": pixels}, mean={"mode": mode}, sea=sea)) for pixels in ([12, 9], [36, 27]))
    for name, power in (("radiance", 1), ("glint_radiance", 1), ("glint_std", 2)):
        parts = fine[name].to_numpy().astype(np.float64).reshape(9, 3, 12, 3) ** power
        # nine lines of sight in a pixel of 1.3 deg against 81
        whole = coarse[name].to_numpy().astype(np.float64) ** power
        if power == 2 and waves:
            assert np.all(parts.mean(axis=(1, 3)) / 9.0 < whole)
            assert np.all(whole < parts.mean(axis=(1, 3)))
        else:
            np.testing.assert_allclose(parts.mean(axis=(1, 3)) / (9.0 if power == 2 else 1.0), whole, rtol=5e-3)


@pytest.mark.validation
def test_pixels_that_the_horizon_cuts_are_averaged():
    """A low Sun's glint may end in half a pixel: a coarse map is the fine one averaged there too."""
    sensor = {"projection": "pinhole", "elevation_deg": -1, "fov_deg": [4, 3], "roll_deg": 25}
    coarse, fine = (
        mean(scenario_with_sensor(sensor | {"pixels": pixels}, sun={"zenith_deg": 84, "azimuth_deg": 180}))
        for pixels in ([16, 12], [128, 96])
    )
    parts = fine.radiance.to_numpy().astype(np.float64).reshape(12, 8, 16, 8).mean(axis=(1, 3))
    np.testing.assert_allclose(coarse.radiance, parts, rtol=2e-3)


def test_a_moving_sensor_is_mapped_where_it_begins():
    scenario = scenario_with_sensor(VIEWS["platform"][0], **VIEWS["platform"][1])
    here, there = mean(scenario), mean(scenario_with_sensor({"elevation_deg": -7, "roll_deg": 10, "height_m": 50}))
    np.testing.assert_array_equal(here.radiance, there.radiance)
    assert (float(here.sensor_height), float(here.sensor_roll)) == (50.0, pytest.approx(10.0))
    # upright at the beginning: a grid, whatever comes later
    upright = mean(scenario_with_sensor({}, platform={"keyframes": [{"time_s": 0, "roll_deg": 0}, {"time_s": 1, "roll_deg": 5}]}))
    assert upright.azimuth.dims == ("x",)
    xr.testing.assert_equal(upright.radiance.variable, mean(scenario_with_sensor({})).radiance.variable)


@pytest.mark.validation
@pytest.mark.parametrize("view", ["pinhole", "straight down, seam in view", "platform"])
def test_a_map_with_directions_of_pixels_is_read_again(tmp_path, view):
    sensor, more = VIEWS[view]
    path = write_netcdf(mean(scenario_with_sensor(sensor, **more)), tmp_path / "m.nc")
    with open_netcdf(path) as stored:
        assert stored.radiance.dims == ("y", "x")
        assert {"azimuth", "elevation"} <= set(stored.radiance.coords)
        assert stored.azimuth.shape == stored.elevation.shape == (18, 24)
        assert stored.azimuth.units == "degree"
        figure = draw(stored)
        assert figure.axes[0].get_ylabel() == "row"
        kelvin = sg.apparent_temperature(stored)
        np.testing.assert_allclose(kelvin, stored.apparent_temperature, rtol=1e-5)
        assert {"azimuth", "elevation"} <= set(kelvin.coords)
        assert sg.analyze(stored).regions["all"].moments.mean == pytest.approx(float(stored.radiance.mean()), rel=1e-5)
    facts = describe(path)
    assert facts.pixels == [24, 18]
    assert any("azimuth" in line for line in lines(facts))


@pytest.mark.validation
@pytest.mark.parametrize(("sensor", "lines_of_azimuth"), [(DOWN, 8), ({"roll_deg": 5, "fov_deg": [200, 20], "pixels": [100, 10]}, 5)])
def test_pictures_round_the_nadir_have_lines_of_azimuth(sensor, lines_of_azimuth):
    figure = draw(mean(scenario_with_sensor(sensor)))
    labels = [text.get_text() for text in figure.axes[0].texts]
    assert sum(label.endswith("° az") for label in labels) == lines_of_azimuth


@pytest.mark.validation
@pytest.mark.parametrize("correlation", ["waves", "time"])
@pytest.mark.parametrize(("sensor", "sun"), [({"elevation_deg": -7}, 75), (DOWN, 20)])
def test_the_middle_of_a_small_pixel_serves(monkeypatch, sensor, sun, correlation):
    """A pixel of 1.7 mrad, in the glint of a Sun that is low and of one near the nadir: the middle against nine lines of sight."""
    raw = sensor | {"projection": "pinhole", "roll_deg": 10, "fov_deg": [2.4, 1.8]}
    tables = {"sun": {"zenith_deg": sun, "azimuth_deg": 185}, "sea": {"glint": {"correlation": correlation}}}
    middles = mean(scenario_with_sensor(raw, **tables))
    monkeypatch.setattr(mean_map, "SMALL", 0.0)
    averages = mean(scenario_with_sensor(raw, **tables))
    assert not np.array_equal(middles.radiance, averages.radiance)
    assert float(averages.glint_radiance.min()) > 0.0
    for name in ("radiance", "glint_radiance", "glint_std"):
        # variances from the waves are linear between the nodes of a table, and change their gradients there
        np.testing.assert_allclose(middles[name], averages[name], rtol=2e-3 if (name, correlation) == ("glint_std", "waves") else 2e-4)
