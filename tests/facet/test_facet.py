"""Radiance of one facet against plain sums over slopes and over the solar disc."""

import numpy as np
import pytest
from render_scenes import BAND, SEA_TEMPERATURE, WarmSky, sea_view, table_air

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.facet import solar_disc, thermal
from seaglint.facet.facet_sunlight import FacetOptics, FacetTables, sun_factor
from seaglint.facet.facet_tables import sun_terms
from seaglint.facet.legs import SMITHS
from seaglint.facet.path_basis import TOGETHER, fewest_terms, path_basis
from seaglint.facet.roughness import Sight, line_of_sight, roughness_of
from seaglint.facet.sunlight import sunlight, visible_sun
from seaglint.facet.thermal import SlopeQuadrature, thermal_axes, thermal_sources, thermal_table
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.sea.shadowing.smith import leg_passage_kernel
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

DIRECTIONAL = SlopeStatistics(0.02, 0.008, wind_to_azimuth=0.9)
ROUGH = SlopeStatistics(0.05, 0.05)
SMALL = SlopeStatistics(0.004, 0.006, wind_to_azimuth=-0.4)


def _roughness(slopes, sun_azimuth):
    return roughness_of(slopes, sun_azimuth, SMITHS)


def _sight(slopes, azimuth, sun_azimuth):
    """Line of sight that leaves the sensor at an azimuth, as the sea sees it."""
    deviation = float(np.sqrt(slopes.mss_along(azimuth)))
    return Sight(-np.sin(azimuth), -np.cos(azimuth), azimuth, leg_passage_kernel(azimuth + np.pi - sun_azimuth), deviation)


def _factor(sun, rough, sight, grazing, slope):
    """Glint factor and cosine of incidence of a single ray."""
    return sun_factor(sun, rough, solar_disc.no_disc_line(), sight, grazing, slope)


def _vector(zenith, azimuth):
    return np.array([np.sin(zenith) * np.sin(azimuth), np.sin(zenith) * np.cos(azimuth), np.cos(zenith)])


def _slope_grid(slopes, n=801, reach=6.0):
    """Slopes (east, north) on a fine grid about zero, and their probabilities."""
    x = np.linspace(-reach, reach, n)
    up, cross = np.meshgrid(x * np.sqrt(slopes.mss_up), x * np.sqrt(slopes.mss_cross), indexing="ij")
    s, c = np.sin(slopes.wind_to_azimuth), np.cos(slopes.wind_to_azimuth)
    share = np.exp(-0.5 * (x[:, None] ** 2 + x**2))
    return up * s + cross * c, up * c - cross * s, share / share.sum()


def _turned_to(direction, tilt, slopes):
    """Mean of max(0, d_z - d_h . s) over the roughness, and the same without the cut."""
    east, north, share = _slope_grid(slopes)
    projection = direction[2] - direction[0] * (tilt[0] + east) - direction[1] * (tilt[1] + north)
    return float((share * np.maximum(projection, 0.0)).sum()), direction[2] - direction[0] * tilt[0] - direction[1] * tilt[1]


def _disc(zenith, azimuth, rings=60):
    """Directions spread evenly over the solar disc, (n, 3)."""
    n = rings * rings
    radius = SOLAR_ANGULAR_RADIUS * np.sqrt((np.arange(n) + 0.5) / n)
    angle = np.arange(n) * np.pi * (3.0 - np.sqrt(5.0))
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    above = np.array([-np.cos(zenith) * np.sin(azimuth), -np.cos(zenith) * np.cos(azimuth), np.sin(zenith)])
    centre = _vector(zenith, azimuth)
    d = np.hypot(x, y)
    points = np.cos(d)[:, None] * centre + np.sinc(d / np.pi)[:, None] * (x[:, None] * right + y[:, None] * above)
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def _glint_by_hand(slopes, tilt, view, sun, both_legs):
    """``q S (1 + Lambda_v)/(4 cos^4(beta) A+)`` averaged over points of the disc; areas summed over slopes on a grid."""
    v = _vector(*view)
    area, mean = _turned_to(v, tilt, slopes)
    lit_area, lit_mean = _turned_to(_vector(*sun), tilt, slopes)
    if lit_mean <= 0.0:
        return 0.0
    lambda_view, lambda_sun = area / mean - 1.0, lit_area / lit_mean - 1.0
    # legs on opposite sides are independent given the height, on one side the lower ray decides: Smith's two limits
    seen = {"opposite": 1.0 + lambda_view + lambda_sun, "same": 1.0 + max(lambda_view, lambda_sun)}[both_legs]
    m = v + _disc(*sun)
    s = -m[:, :2] / m[:, 2:]
    q = slopes.density(s[:, 0] - tilt[0], s[:, 1] - tilt[1])
    return float(np.mean(0.25 * q * (1.0 + (s**2).sum(axis=1)) ** 2)) / area * (1.0 + lambda_view) / seen


@pytest.mark.kernel
@pytest.mark.parametrize("slopes", [DIRECTIONAL, SMALL, ROUGH], ids=["directional", "small", "rough"])
@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.12, -0.05), (0.06, 0.2)], ids=["level", "tilted", "turned from the Sun"])
@pytest.mark.parametrize(
    ("depression", "sun_zenith", "legs"),
    [
        (60.0, 30.0, "opposite"),
        (25.0, 65.0, "opposite"),
        (12.0, 75.0, "opposite"),
        (8.0, 82.0, "opposite"),
        (20.0, 84.0, "opposite"),
        (12.0, 80.0, "same"),
    ],
)
def test_sun_factor_is_the_average_over_disc_and_slopes(slopes, tilt, depression, sun_zenith, legs):
    sun_azimuth = 0.3
    azimuth = sun_azimuth + (0.0 if legs == "opposite" else np.pi)
    zenith, sun_z = np.radians(90.0 - depression), np.radians(sun_zenith)
    expected = _glint_by_hand(slopes, tilt, (zenith, azimuth + np.pi), (sun_z, sun_azimuth), legs)
    factor, _ = _factor(
        sunlight(sun_z, sun_azimuth, True),
        _roughness(slopes, sun_azimuth),
        _sight(slopes, azimuth, sun_azimuth),
        (np.cos(zenith), np.sin(zenith)),
        tilt,
    )
    # the disc's image is at most 0.4 of the rms slope here: fourth cumulants leave 0.5 %; beyond four deviations nothing is worth comparing
    assert factor == pytest.approx(expected, rel=6e-3, abs=1e-4 * 0.25 / slopes.mss)


@pytest.mark.kernel
@pytest.mark.parametrize(
    ("mss", "offset"),
    # in the tail of the narrowest slopes (2.5, 3e-4) the disc's edge is beyond a fourth cumulant: 40 % of 2 % of the peak
    [(mss, offset) for mss in (3e-4, 2e-3, 0.02) for offset in (0.0, 0.5, 1.5, 2.5) if (mss, offset) != (3e-4, 2.5)],
)
def test_low_sun_wide_disc_beside_narrow_slopes(mss, offset):
    """Sun 3 deg and sensor 2 deg above the facet: the disc's image is 0.9 to 0.1 of the combined spread of slopes."""
    slopes = SlopeStatistics(mss, mss)
    view, sun = (np.radians(88.0), np.pi), (np.radians(87.0), 0.0)
    centre = _vector(*view) + _vector(*sun)
    # across the view, where the image of the disc is long and the facet stays turned to both
    tilt = (offset * np.sqrt(mss + 0.25 * (SOLAR_ANGULAR_RADIUS / centre[2]) ** 2), -centre[1] / centre[2])
    v = _vector(*view)
    area, _ = _turned_to(v, tilt, slopes)
    m = v + _disc(*sun)
    s = -m[:, :2] / m[:, 2:]
    expected = np.mean(0.25 * slopes.density(s[:, 0] - tilt[0], s[:, 1] - tilt[1]) * (1.0 + (s**2).sum(axis=1)) ** 2) / area
    got, _ = _factor(sunlight(*sun, True), _roughness(slopes, 0.0), _sight(slopes, 0.0, 0.0), (np.cos(view[0]), np.sin(view[0])), tilt)
    area_sun, mean_sun = _turned_to(_vector(*sun), tilt, slopes)
    mean_view = v[2] - v[1] * tilt[1] - v[0] * tilt[0]
    legs = (area / mean_view) / (area / mean_view + area_sun / mean_sun - 1.0)
    share = SOLAR_ANGULAR_RADIUS**2 / 4 / centre[2] ** 2 / (mss + SOLAR_ANGULAR_RADIUS**2 / 4 / centre[2] ** 2)
    # what the sixth cumulant leaves, seen to fall with the cube of the disc's share of the variance
    assert got == pytest.approx(float(expected) * legs, rel=5e-3 + 0.5 * share**3)


@pytest.mark.kernel
def test_the_angle_of_incidence_is_half_the_angle_between_sun_and_viewer():
    sun_z, azimuth, view_z = 1.1, 0.2, 0.7
    _, cosine = _factor(
        sunlight(sun_z, 0.5, True),
        _roughness(DIRECTIONAL, 0.5),
        _sight(DIRECTIONAL, azimuth, 0.5),
        (np.cos(view_z), np.sin(view_z)),
        (0.0, 0.0),
    )
    between = np.arccos(_vector(view_z, azimuth + np.pi) @ _vector(sun_z, 0.5))
    assert cosine == pytest.approx(np.cos(0.5 * between), rel=1e-12)


@pytest.mark.kernel
def test_a_smooth_facet_mirrors_points_of_the_disc_only():
    sun, view = (1.0, 0.3), (1.0, 0.3 + np.pi)
    none = SlopeStatistics(0.0, 0.0)
    sight = _sight(none, 0.3, 0.3)
    peak = 1.0 / (np.pi * SOLAR_ANGULAR_RADIUS**2)
    for turn, expected in ((0.0, peak), (0.45, peak), (0.55, 0.0), (-0.45, peak), (-0.55, 0.0)):
        # a facet tilted by half an angle turns the ray by all of it
        tilt = np.tan(0.5 * turn * 2.0 * SOLAR_ANGULAR_RADIUS)
        got, _ = _factor(
            sunlight(*sun, True), _roughness(none, 0.3), sight, (np.cos(view[0]), np.sin(view[0])), (tilt * np.sin(0.3), tilt * np.cos(0.3))
        )
        assert got == pytest.approx(expected)


@pytest.mark.kernel
@pytest.mark.parametrize("sun_zenith", [30.0, 60.0, 80.0, 85.0])
def test_a_table_of_the_disc_along_a_line_of_sight_serves_all_its_facets(sun_zenith):
    """Down to the bound of smoothness below which single rays' own formula is used."""
    sun, sines = sunlight(np.radians(sun_zenith), 0.3, True), np.array([0.004, 0.9])
    tabled = 0
    for mss in (3e-4, 3e-3, 0.03):
        slopes = SlopeStatistics(mss, 0.7 * mss, 0.6)
        rough, sight = _roughness(slopes, 0.3), _sight(slopes, 0.45, 0.3)
        line = solar_disc.disc_line(sun, rough, sight, tuple(sines), np.empty(solar_disc.DISC_ROWS))
        tabled += line.rows.shape[0] > 0
        for sine in np.linspace(*sines, 50):
            grazing = (sine, np.sqrt(1.0 - sine**2))
            mirror = -(np.array([sight.east, sight.north]) * grazing[1] + np.array([sun.east, sun.north])) / (sine + sun.up)
            for offset in ((0.0, 0.0), (1.0, -0.5), (-2.0, 1.5), (0.5, 3.0)):
                slope = tuple(mirror + np.sqrt(mss) * np.array(offset))
                got, expected = sun_factor(sun, rough, line, sight, grazing, slope), _factor(sun, rough, sight, grazing, slope)
                assert got == pytest.approx(expected, rel=1e-3)
    assert tabled >= (1 if sun_zenith > 80.0 else 2)


@pytest.mark.kernel
def test_no_sun_no_glint():
    got = _factor(sunlight(1.0, 0.0, False), _roughness(SMALL, 0.0), _sight(SMALL, 0.0, 0.0), (0.5, 0.8), (0.0, 0.0))
    assert got == (0.0, 0.0)


def _thermal_by_hand(view, slopes, tilt, zenith, azimuth, arc):
    """Emission and mirrored sky behind the air: every slope on a grid, its Fresnel reflectance and its sky, spectrally."""
    air, water = view.atmosphere, view.water
    grid = np.flatnonzero(BAND.weights(air.wavenumber_cm))
    nu, weights = air.wavenumber_cm[grid], BAND.weights(air.wavenumber_cm)[grid]
    east, north, share = (a.ravel() for a in _slope_grid(slopes, 81, 5.0))
    s = np.stack([east + tilt[0], north + tilt[1]])
    v = _vector(zenith, azimuth + np.pi)
    projection = v[2] - v[:2] @ s
    seen = projection > 0.0
    weight = (share * projection)[seen] / (share * projection)[seen].sum()
    nz2 = 1.0 / (1.0 + (s[:, seen] ** 2).sum(axis=0))
    rise = 2.0 * projection[seen] * nz2 - v[2]
    incidence = np.minimum(projection[seen] * np.sqrt(nz2), 1.0)
    black = planck_wavenumber(nu, SEA_TEMPERATURE)
    total = np.zeros(nu.size)
    for part in np.array_split(np.arange(weight.size), 8):
        up = rise[part] > 0.0
        rho = reflectance(incidence[part][:, None], water.index(nu)) * up[:, None]
        sky = air.sky_radiance(np.arccos(np.clip(rise[part], 0.0, 1.0)), 0.0)[:, grid]
        total += weight[part] @ (rho * sky + (1.0 - rho) * black)
    return float((weights * air.transmittance(view.sensor_height, np.array([arc]))[0, grid]) @ total)


ARCS = np.geomspace(20.0, 20_000.0, 50)


def _optics(basis, view, sun, axes, shape):
    """Facets of a sea with Smith's shadowing and no sunlight on them, and the path's coefficients for their table."""
    rough = roughness_of(view.slopes, sun.azimuth, SMITHS)
    table, coefficients = fewest_terms(
        thermal_table(thermal_sources(basis, view), rough, axes, shape, basis.phi.shape[0]), basis.coefficients, TOGETHER
    )
    dark = sun_terms(basis, np.zeros(basis.wavenumber_cm.size), view.water)
    none = np.zeros((1, 1, 1, 1, 0), np.float32)
    return FacetOptics(sun, rough, FacetTables(table.astype(np.float32), none, axes, np.ascontiguousarray(dark))), coefficients


@pytest.fixture(scope="module")
def basis():
    """Path basis of a sensor at 30 m."""
    return path_basis(table_air(8.0), BAND, 30.0, ARCS)


@pytest.fixture(scope="module", params=[DIRECTIONAL, SMALL], ids=["directional", "small"])
def tables(request, basis):
    """View of a sea, and the tables of its facets by night."""
    view = sea_view(table_air(8.0), request.param)
    axes, shape = thermal_axes(view.slopes, (0.002, 0.0015), (0.005, 0.6), (0.0, 0.7))
    sun = sunlight(*visible_sun(view.solar_zenith)[1:], 0.0, False)
    return view, *_optics(basis, view, sun, axes, shape)


@pytest.mark.parametrize(
    ("tilt", "grazing_deg", "azimuth"),
    [((0.0, 0.0), 1.0, 0.35), ((0.13, -0.08), 1.0, 0.1), ((-0.05, 0.17), 6.0, 0.6), ((0.13, -0.08), 25.0, 0.6)],
)
def test_thermal_radiance_of_a_facet_is_the_sum_over_its_slopes(basis, tables, tilt, grazing_deg, azimuth):
    """Through table, path basis and band sums together, against direct spectral sums."""
    view, optics, coefficients = tables
    zenith = np.radians(90.0 - grazing_deg)
    sight = line_of_sight(optics.sunlight, optics.roughness, azimuth)
    where = 30
    along = thermal.thermal_along(optics.tables.thermal, optics.tables.axes, sight)
    found = thermal.facet_thermal(optics.tables.axes, along, coefficients, (where, 0.0), sight, np.cos(zenith), tilt)
    # path basis 7e-4, linear interpolation between the tables' nodes 1e-3, Hermite nodes across
    assert found == pytest.approx(_thermal_by_hand(view, view.slopes, tilt, zenith, azimuth, ARCS[where]), rel=2e-3)


@pytest.mark.kernel
@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.2, 0.1), (-0.4, 0.05)])
def test_facet_average_of_a_uniform_surround_is_one(tilt):
    """A facet whose every light is 1 shows 1, whatever part of its slopes is seen."""
    ones = thermal.ThermalSources(np.full((9, 1), 0.25), np.full((9, 7, 1), 0.75), np.ones(1))
    nodes, weights = np.polynomial.legendre.leggauss(thermal.ALONG_NODES)
    cross, cross_weights = np.polynomial.hermite_e.hermegauss(thermal.CROSS_NODES)
    quadrature = SlopeQuadrature(nodes, weights, cross, cross_weights / cross_weights.sum())
    out = np.empty(1)
    thermal.mean_facet(ones, quadrature, _roughness(DIRECTIONAL, 0.0), (0.6, 0.8), 0.05, tilt, out)
    assert out[0] == pytest.approx(1.0, rel=1e-12)


def test_warm_sky_makes_grazing_facets_warmer():
    """Sanity of the signs: a facet tilted to the viewer mirrors higher, colder sky."""
    air = WarmSky.for_band(BAND.min_um, BAND.max_um)
    view = sea_view(air, SMALL)
    basis = path_basis(air, BAND, 30.0, np.array([100.0, 200.0]))
    axes, shape = thermal_axes(SMALL, (0.002, 0.002), (0.05, 0.2), (0.0, 0.1))
    optics, coefficients = _optics(basis, view, sunlight(1.0, 0.0, False), axes, shape)
    table = optics.tables.thermal
    # axis 2 is the slope towards the viewer, rising; a slope that falls towards the viewer is negative and faces it
    radiance = table[0, 0, :, table.shape[3] // 2] @ coefficients[0]
    assert radiance[0] < radiance[-1] * 0.999
