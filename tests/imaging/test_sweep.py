"""What is visible: the sweep against a slow ray marcher in plain Python, and the round sea's horizon."""

import numpy as np
import pytest
from render_scenes import BAND, RangeFog, black_water, camera, elfouhaily, furnace, one_tile, read, sea_view, shown, swept_scene

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import horizon_depression, surface_range
from seaglint.facet.sky import NO_SKY
from seaglint.imaging.sweep import sweep, walk
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

BLACK = float(planck_wavenumber(furnace().wavenumber_cm, 288.15) @ BAND.weights(furnace().wavenumber_cm))
SLOPES = SlopeStatistics(0.05, 0.05, 0.5)


def _fog_view(height):
    """A black sea in a fog that tells the range; the radiance of a row is the mean of exp(-arc/SCALE) over what it shows."""
    return sea_view(RangeFog.for_band(BAND.min_um, BAND.max_um), SLOPES, height, water=black_water())


@pytest.mark.parametrize("height", [2.0, 2000.0, pytest.param(30.0, marks=pytest.mark.validation)])
def test_calm_ranges_and_horizon_are_those_of_the_conventions(height):
    horizon = np.degrees(horizon_depression(height))
    eye = camera(height, -0.8 * horizon, -3.0 * horizon, 440)
    seen = shown(swept_scene(_fog_view(height), eye), 0.0).radiance[:, 0] / BLACK
    # fine rays per row: 0 above the horizon, exp(-arc/SCALE) below
    inside = (np.arange(64) + 0.5) / 64 - 0.5
    arcs = surface_range(height, -(eye.elevations[:, None] - inside * eye.row_step))
    expected = np.where(np.isnan(arcs), 0.0, np.exp(-np.nan_to_num(arcs) / RangeFog.SCALE)).mean(axis=1)
    # four pieces per row and a spline over log range
    np.testing.assert_allclose(seen, expected, rtol=5e-3, atol=2e-3 * expected.max())
    assert np.all(seen[eye.elevations - 0.5 * eye.row_step > -horizon_depression(height)] == 0.0)


def _march(waves, time, height, azimuth, elevations, step, last):
    """Arc of the first sea point on each ray over a sphere; NaN for the sky. Rays are tested at every step, then bisected."""
    tiles = waves.coefficients(time)
    spacing, turn = [t.spacing for t in waves.tiles], [t.rotation for t in waves.tiles]

    def sea(arc):
        x, y = arc * np.sin(azimuth), arc * np.cos(azimuth)
        return sum(read(t, d, a, x, y)[..., 0] for t, d, a in zip(tiles, spacing, turn, strict=True))

    def above(elevation, arc, level=None):
        """Height of the ray over the sea (of ``level``, where known) where it stands above the sea point at ``arc``."""
        psi = arc / EFFECTIVE_EARTH_RADIUS
        radius = EFFECTIVE_EARTH_RADIUS + height
        # the ray meets the radius vector at psi where radius cos(e) = rho cos(e + psi)
        rho = radius * np.cos(elevation) / np.cos(elevation + psi)
        return rho - EFFECTIVE_EARTH_RADIUS - (sea(arc) if level is None else level)

    arcs = np.arange(step, last, step)
    levels = sea(arcs)
    found = np.full(elevations.size, np.nan)
    for i, elevation in enumerate(elevations):
        under = above(elevation, arcs, levels) < 0.0
        if under.any():
            far = arcs[np.argmax(under)]
            near = max(far - step, 1e-6)
            for _ in range(20):
                middle = 0.5 * (near + far)
                near, far = (middle, far) if above(elevation, np.array(middle)) > 0.0 else (near, middle)
            found[i] = far
    return found


@pytest.mark.parametrize(
    ("height", "top", "bottom", "azimuth"),
    [(3.0, 0.6, -3.0, 40.0), (3.0, -3.0, -20.0, 200.0), pytest.param(12.0, 0.1, -2.0, 310.0, marks=pytest.mark.validation)],
)
def test_visible_ranges_match_a_ray_marcher(height, top, bottom, azimuth):
    """One line of sight over steep waves: every row's mean transmittance, where crests hide troughs and stand out against the sky."""
    waves, rows, rays = one_tile(), 40, 24
    eye = camera(height, top, bottom, rows, azimuth=azimuth, width=1e-4)
    seen = shown(swept_scene(_fog_view(height), eye, waves, step=0.05), 7.0).radiance[:, 0] / BLACK
    inside = (np.arange(rays) + 0.5) / rays - 0.5
    elevations = (eye.elevations[:, None] - inside * eye.row_step).ravel()
    arcs = _march(waves, 7.0, height, np.radians(azimuth), elevations, 0.1, 7000.0 if top > -1.0 else 400.0)
    expected = np.where(np.isnan(arcs), 0.0, np.exp(-np.nan_to_num(arcs) / RangeFog.SCALE)).reshape(rows, rays).mean(axis=1)
    jumps = np.abs(np.diff(arcs, prepend=arcs[0])) > 10.0
    assert jumps.sum() > 3 or top <= -3.0  # the scene does hide something
    # 24 rays place an edge in a row to 1/48; hidden stretches make such edges
    np.testing.assert_allclose(seen, expected, rtol=2e-3, atol=0.025)
    assert seen.mean() == pytest.approx(expected.mean(), rel=3e-3)


def test_crests_lift_the_horizon_and_troughs_do_not_open_it():
    height = 5.0
    waves = elfouhaily(8.0)
    eye = camera(height, 1.0, -0.6, 320, width=20.0, columns=8)
    seen = shown(swept_scene(_fog_view(height), eye, waves), 0.0).radiance / BLACK
    calm = -horizon_depression(height)
    assert seen[eye.elevations > calm + np.arctan(3.0 * waves.significant_height / 1000.0)].max() == 0.0
    assert (seen > 0.0).any(axis=1)[eye.elevations > calm].any()
    assert np.all(seen[eye.elevations < calm - 4.0 * eye.row_step] > 0.0)


def test_most_of_a_row_shows_the_near_side_of_waves():
    """Mean visible slope along the view is turned to the viewer: facing sides show larger than lee sides."""
    height = 3.0
    waves = one_tile()
    arcs = _march(waves, 0.0, height, 0.7, np.radians(np.linspace(-1.0, -5.0, 400)), 0.05, 500.0)
    tile = waves.coefficients(0.0)[0]
    x, y = arcs * np.sin(0.7), arcs * np.cos(0.7)
    found = read(tile, waves.tiles[0].spacing, waves.tiles[0].rotation, x, y)
    assert np.mean(found[:, 1] * np.sin(0.7) + found[:, 2] * np.cos(0.7)) > 0.02


@pytest.mark.kernel
@pytest.mark.parametrize("arc", [1.0, 3e3, 5e5])
def test_arcs_on_the_round_sea_are_those_of_the_circle(arc):
    cosine, reach, drop = walk.bend(arc)
    psi = arc / EFFECTIVE_EARTH_RADIUS
    assert cosine == pytest.approx(np.cos(psi), rel=1e-15)
    assert reach == pytest.approx(EFFECTIVE_EARTH_RADIUS * np.sin(psi), rel=1e-10)
    assert drop == pytest.approx(2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2, rel=1e-10)


@pytest.mark.kernel
def test_elevation_is_the_arc_tangent():
    for tangent in (-50.0, -0.1001, -0.0999, -1e-4, 0.0, 0.05, 2.0):
        assert walk.elevation(tangent) == pytest.approx(np.arctan(tangent), rel=1e-13, abs=1e-12)


def _pieces_into_rows(edges, radiance, rows=7):
    """Pieces between falling-together edges [rad], the radiance leaning as the sweep has it, into rows of 1 mrad from 7 mrad down."""
    image = np.zeros((3, rows))
    lines = sweep.Rows(rows * 1e-3, 1e3, rows, -1.0, 1.0, NO_SKY)
    centre = 0.5 * (edges[1:] + edges[:-1])
    light = np.stack([radiance(centre), 0.5 * radiance(centre), np.zeros_like(centre)], axis=1)
    for j in range(centre.size):
        before, here, after = centre[max(j - 1, 0)], centre[j], centre[min(j + 1, centre.size - 1)]
        width = edges[j + 1] - edges[j]
        lean = (*(sweep.leaning(light, j, k, before, here, after, width) for k in range(2)), 0.0, 0.0)
        sweep.add_rows(image, lines, (edges[j], edges[j + 1]), 1.0, light[j], lean)
    return image


@pytest.mark.kernel
def test_rows_of_a_linear_radiance_are_its_means():
    """Whatever the pieces, a ramp over them comes out as the mean over every row; and the pieces' whole is kept."""
    edges = np.sort(np.random.default_rng(1).uniform(0.0, 7e-3, 40))
    edges[0], edges[-1] = 0.0, 7e-3
    image = _pieces_into_rows(edges, lambda e: 2.0 + 300.0 * e)
    middle = 1e-3 * (6.5 - np.arange(7))
    # the outermost pieces have no neighbour on one side, and half the lean is all they may take
    np.testing.assert_allclose(image[0, 1:-1], 2.0 + 300.0 * middle[1:-1], rtol=1e-12)
    np.testing.assert_allclose(image[1], 0.5 * image[0], rtol=1e-12)
    width = np.diff(edges)
    total = (width * (2.0 + 300.0 * 0.5 * (edges[1:] + edges[:-1]))).sum()
    assert 1e-3 * image[0].sum() == pytest.approx(total, rel=1e-12)


@pytest.mark.kernel
def test_leaning_never_makes_radiance_negative():
    edges = np.linspace(0.0, 7e-3, 8)
    image = _pieces_into_rows(edges, lambda e: np.where(np.abs(e - 3.5e-3) < 1e-4, 5.0, 1e-3))
    assert image[:2].min() > 0.0


@pytest.mark.parametrize("seed", range(4))
def test_columns_share_the_tables_next_to_them_in_whatever_part(seed):
    """Every column has the same tables alone, in any part of the columns, and across north; they are half a range away at most."""
    random = np.random.default_rng(seed)
    width = float(random.uniform(0.02, 0.99)) * sweep.SHARED
    azimuths = float(random.choice([-np.pi, -0.004, 0.0, 3.1, 2.0 * np.pi - 0.01])) + width * (np.arange(80) + random.random())
    alone = np.array([sweep.sharing(azimuths, width, k, k + 1)[1] for k in range(80)])
    assert np.all(np.abs(alone - azimuths) <= 0.5 * sweep.SHARED * (1.0 + 1e-9))
    first, end = sorted(random.choice(80, 2, replace=False))
    begin, found = first, []
    while begin < end:
        after, shared = sweep.sharing(azimuths, width, begin, end)
        assert begin < after <= end
        found += [shared] * (after - begin)
        begin = after
    assert found == alone[first:end].tolist()
    assert sweep.sharing(azimuths, sweep.SHARED, 3, 80) == (4, azimuths[3])
