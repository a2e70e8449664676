import numpy as np
import pytest
from shadowing_laws import saunders

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.errors import DomainError
from seaglint.facet.emissivity import facet_nodes
from seaglint.facet.glint import direction, glint
from seaglint.facet.legs import VIEWER, Shadowing
from seaglint.facet.sunlight import visible_sun
from seaglint.sea.shadowing.smith import visible_area
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, flat

EPS = SOLAR_ANGULAR_RADIUS


def _eq8(theta, azimuth, solar_zenith, solar_azimuth, slopes):
    """Chance by the point formula of the article's Eq. 8, written with the angles of its Fig. 1."""
    relative = azimuth - solar_azimuth
    cos2w = np.cos(theta) * np.cos(solar_zenith) + np.sin(theta) * np.sin(solar_zenith) * np.cos(relative)
    w = 0.5 * np.arccos(cos2w)
    beta = np.arccos((np.cos(theta) + np.cos(solar_zenith)) / (2 * np.cos(w)))
    p = np.exp(-(np.tan(beta) ** 2) / slopes.mss) / (np.pi * slopes.mss)
    return np.pi * EPS**2 * p * saunders(theta, slopes.mss_up) / (4 * np.cos(beta) ** 4 * np.cos(theta)), np.cos(w)


@pytest.mark.parametrize("wind", [5.0, 10.0, 15.0])
@pytest.mark.parametrize("depression", [5.0, 20.0, 45.0, 80.0])
@pytest.mark.parametrize("relative", [0.0, 10.0, 60.0])
def test_rough_sea_is_the_point_formula(wind, depression, relative):
    slopes = cox_munk_isotropic(wind)
    theta, azimuth = np.radians(90.0 - depression), np.radians(180.0 + 30.0 + relative)
    got = glint(theta, azimuth, np.radians(40.0), np.radians(30.0), slopes, VIEWER)
    chance, cos_incidence = _eq8(theta, azimuth, np.radians(40.0), np.radians(30.0), slopes)
    # (image of the disc / rms slope)^2 / 8 times He2 of the slope: below 0.3 % here, to six standard deviations
    assert got.chance == pytest.approx(chance, rel=6e-3)
    assert got.cos_incidence == pytest.approx(cos_incidence, rel=1e-12)


def _drawn(slopes, theta, azimuth, sun_zenith, sun_azimuth, n=1_000_000):
    """Share of visible facets, drawn at random, that mirror the part of the disc above the horizon; and its standard error."""
    rng = np.random.default_rng(7)
    up, cross = rng.normal(0.0, 1.0, (2, n)) * np.sqrt([[slopes.mss_up], [slopes.mss_cross]])
    a = slopes.wind_to_azimuth
    s = np.array([up * np.sin(a) + cross * np.cos(a), up * np.cos(a) - cross * np.sin(a)])
    v = np.array([float(c) for c in direction(theta, azimuth)])
    projection = v[2] - v[0] * s[0] - v[1] * s[1]
    weight = np.maximum(projection, 0.0)
    r = 2.0 * projection * np.array([-s[0], -s[1], np.ones(n)]) / (1.0 + s[0] ** 2 + s[1] ** 2) - v[:, None]
    sun = np.array([float(c) for c in direction(sun_zenith, sun_azimuth)])
    hit = ((sun @ r > np.cos(EPS)) & (r[2] > 0.0)) * weight / weight.mean()
    return hit.mean(), hit.std() / np.sqrt(n)


@pytest.mark.parametrize("mss", [1e-6, 1e-4, 5e-3, *(pytest.param(m, marks=pytest.mark.validation) for m in (1e-8, 1e-5, 1e-3))])
@pytest.mark.parametrize("zenith", [30.0, 80.0])
def test_chance_is_the_share_of_facets_drawn_at_random(mss, zenith):
    """Independent route: draw visible facets, mirror the view, count hits on the disc."""
    slopes = SlopeStatistics(mss, mss)
    theta, azimuth, sun_zenith = np.radians(zenith), 0.3, np.radians(zenith) - 0.5 * EPS
    expected, error = _drawn(slopes, theta, azimuth, sun_zenith, azimuth + np.pi)
    got = float(glint(theta, azimuth, sun_zenith, azimuth + np.pi, slopes, VIEWER).chance)
    # four standard errors of the million draws, plus 0.2 % for the quadrature
    assert got == pytest.approx(expected, abs=4.0 * error + 2e-3 * expected)
    assert 0.0 <= got <= 1.0


@pytest.mark.parametrize("offset", [-0.0045, 0.0035])
@pytest.mark.parametrize("slopes", [SlopeStatistics(1e-6, 1e-6), SlopeStatistics(4e-6, 5e-7, 1.0)], ids=["isotropic", "directional"])
def test_facets_drawn_at_random_see_a_sun_beside_the_mirror_direction(offset, slopes):
    expected, error = _drawn(slopes, np.radians(85.0), 0.3, np.radians(85.0), 0.3 + np.pi + offset)
    got = float(glint(np.radians(85.0), 0.3, np.radians(85.0), 0.3 + np.pi + offset, slopes, VIEWER).chance)
    assert got == pytest.approx(expected, abs=4.0 * error + 5e-3 * expected)  # draws, and points on the chords


@pytest.mark.parametrize("elevation", [0.1, -0.15, *(pytest.param(e, marks=pytest.mark.validation) for e in (0.25, 0.0))])
@pytest.mark.parametrize("slopes", [SlopeStatistics(1e-3, 1e-3), SlopeStatistics(4e-4, 3e-3, 0.8)], ids=["isotropic", "directional"])
def test_facets_drawn_at_random_see_a_cut_sun_cut(elevation, slopes):
    theta, sun_zenith = np.radians(89.8), np.radians(90.0 - elevation)
    expected, error = _drawn(slopes, theta, 0.3, sun_zenith, 0.3005 + np.pi)
    got = float(glint(theta, 0.3, sun_zenith, 0.3005 + np.pi, slopes, VIEWER).chance)
    assert got == pytest.approx(expected, abs=4.0 * error + 5e-3 * expected)  # draws, and points on the cut disc


@pytest.mark.parametrize("mss", [(2e-5, 4e-6), (0.04, 0.01)], ids=["narrow", "wide"])
@pytest.mark.parametrize("turn", [0.5, 2.0, 4.0])
def test_the_compass_does_not_matter(mss, turn):
    """View, Sun and wind turned together see the same glint."""
    fixed = glint(1.0, 0.3, 1.004, 0.3 + np.pi + 0.004, SlopeStatistics(*mss, 0.9)).chance
    turned = glint(1.0, 0.3 + turn, 1.004, 0.3 + np.pi + 0.004 + turn, SlopeStatistics(*mss, 0.9 + turn)).chance
    assert float(turned) == pytest.approx(float(fixed), rel=1e-3)  # the hexagon of points turns with the Sun, the window too
    mirrored = glint(1.0, 0.3, 1.004, 0.3 + np.pi + 0.4, SlopeStatistics(*mss, -0.3)).chance
    other = glint(1.0, 0.3, 1.004, 0.3 + np.pi - 0.4, SlopeStatistics(*mss, 0.9)).chance
    assert float(mirrored) == pytest.approx(float(other), rel=1e-3, abs=1e-30)  # mirror image about the view's own azimuth


# Saunders' factor at slope variance 0.0316 along the view, from an independent calculation: 80 deg 0.92141, 85 deg 0.71082.
LAMBDA_80, LAMBDA_85 = 1 / 0.92141 - 1, 1 / 0.71082 - 1


@pytest.mark.parametrize(
    ("view", "sun", "expected"),
    [(85.0, 80.0, (1 + LAMBDA_85) / (1 + LAMBDA_85 + LAMBDA_80)), (80.0, 85.0, (1 + LAMBDA_80) / (1 + LAMBDA_85 + LAMBDA_80))],
)
def test_second_leg_takes_what_smith_says(view, sun, expected):
    slopes = SlopeStatistics(0.0316, 0.0316)
    both, viewer = (
        float(glint(np.radians(view), np.pi, np.radians(sun), 0.0, slopes, Shadowing.of(legs)).chance) for legs in ("both", "viewer")
    )
    assert both / viewer == pytest.approx(expected, rel=2e-5)  # printed digits


@pytest.mark.parametrize("zenith", [1.0, 45.0, 85.0, 89.5])
def test_mirror_shows_the_whole_disc_and_nothing_beside_it(zenith):
    theta = np.radians(zenith)
    offset = np.array([0.0, 0.5, 0.99, 1.01, 3.0]) * EPS
    chance = [float(glint(theta - d, np.pi, theta, 0.0, flat()).chance) for d in offset]
    np.testing.assert_allclose(chance, [1, 1, 1, 0, 0], atol=5e-3)  # Gauss points on the chords of a disc


@pytest.mark.parametrize("wind", [0.0, 0.5, 3.0])
def test_chance_never_exceeds_one_anywhere(wind):
    theta = np.radians(np.linspace(0.0, 90.0, 91))[:, None]
    azimuth = np.radians(np.linspace(90.0, 270.0, 19))
    for zenith in np.radians([0.0, 45.0, 85.0, 89.0, 89.9]):
        chance = glint(theta, azimuth, zenith, 0.0, cox_munk_isotropic(wind)).chance
        assert np.all((chance >= 0.0) & (chance <= 1.0))


def _round_the_sun(theta, zenith, azimuth, slopes, law):
    if slopes.is_isotropic:
        return glint(theta, -azimuth, zenith, 0.0, slopes, Shadowing.of(law)).chance
    return np.array([float(glint(theta, 0.0, zenith, a, slopes, Shadowing.of(law)).chance) for a in azimuth[::10]]) * 10.0


@pytest.mark.parametrize(
    ("slopes", "law", "view"),
    [
        (cox_munk_isotropic(8.0), "viewer", 60.0),
        (cox_munk_isotropic(8.0), "nested-viewer", 84.0),
        pytest.param(cox_munk_anisotropic(12.0, 0.6), "nested-viewer", 75.0, marks=pytest.mark.validation),
        pytest.param(cox_munk_gram_charlier(12.0, 0.6), "nested-viewer", 75.0, marks=pytest.mark.validation),
        pytest.param(cox_munk_gram_charlier(8.0, 0.6), "viewer", 60.0, marks=pytest.mark.validation),
    ],
)
def test_all_suns_together_see_every_facet_once(slopes, law, view):
    """Energy: over all positions of a small Sun, chance / disc adds up to the share of facets that mirror the sky."""
    theta = np.radians(view)
    cosine, weight = np.polynomial.legendre.leggauss(160 if slopes.is_isotropic else 32)
    cosine, weight = 0.5 + 0.5 * cosine, 0.5 * weight
    azimuth = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    total = 0.0
    for c, w in zip(cosine, weight, strict=True):
        # the view stays where facet_nodes has it, at azimuth 0; the Sun goes round
        p = _round_the_sun(theta, float(np.arccos(c)), azimuth, slopes, law)
        total += w * p.sum() * (azimuth[1] - azimuth[0]) / (np.pi * EPS**2)
    nodes = facet_nodes(theta, slopes, 0.0, Shadowing.of(law).law_bands(slopes))
    assert total == pytest.approx(nodes.weight[~nodes.meets_sea].sum(), rel=2e-3)  # Suns cut by the horizon count in part


@pytest.mark.parametrize("elevation", [-0.5, -0.27, -0.1, 0.0, 0.1, 0.2, 0.27, 1.0])
def test_sun_cut_by_the_horizon(elevation):
    share, zenith = visible_sun(np.radians(90.0 - elevation))
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-1.0, 1.0, (2, 400_000)) * EPS
    y = y[x * x + y * y < EPS**2] + np.radians(elevation)
    assert share == pytest.approx(np.mean(y > 0.0), abs=4e-3)  # 4 standard errors of 300 000 points
    if share > 0.02:
        assert np.pi / 2 - zenith == pytest.approx(y[y > 0.0].mean(), rel=0.02)


def test_glint_fades_without_a_jump_as_the_sun_sets():
    elevation = np.radians(np.linspace(0.6, -0.4, 101))
    chance = np.array([float(glint(np.radians(85.0), np.pi, np.pi / 2 - e, 0.0, cox_munk_isotropic(5.0)).chance) for e in elevation])
    assert chance[-1] == 0.0
    assert np.all(np.diff(chance) <= 1e-9)
    assert np.max(-np.diff(chance)) < 0.05 * chance[0]


def test_directional_sea_is_brighter_across_a_wind_that_roughens_along():
    """With the Sun off to the side of the corridor, the wider spread along the wind wins when the wind blows across the view."""
    view, sun = (np.radians(60.0), np.radians(180.0 + 50.0)), (np.radians(60.0), 0.0)
    across = glint(*view, *sun, cox_munk_anisotropic(12.0, np.pi / 2 + 0.43)).chance
    along = glint(*view, *sun, cox_munk_anisotropic(12.0, 0.43)).chance
    assert across > 1.3 * along


SKEWED = [cox_munk_gram_charlier(9.0, 0.7), cox_munk_slick(9.0, 0.7), breon_henriot(9.0, 0.7)]


@pytest.mark.parametrize("slopes", [cox_munk_isotropic(9.0), cox_munk_anisotropic(9.0, 0.7), *SKEWED])
@pytest.mark.parametrize(("view", "sun"), [((75.0, 2.0), (50.0, 0.2)), ((86.0, 3.0), (70.0, 0.2)), ((40.0, 1.0), (82.0, 1.3))])
def test_reciprocal_in_viewer_and_sun(slopes, view, sun):
    """Helmholtz: p S / (4 cos^4 beta cos cos') is symmetric, so chance x cos(view) is."""
    a, b = (np.radians(view[0]), view[1]), (np.radians(sun[0]), sun[1])
    one = float(glint(*a, *b, slopes).chance) * np.cos(a[0])
    other = float(glint(*b, *a, slopes).chance) * np.cos(b[0])
    # The finite disc is on one side only, and averages the density's curvature there: up to 1 % where a wing or low light is steep.
    assert one == pytest.approx(other, rel=0.01)


@pytest.mark.parametrize("slopes", SKEWED, ids=["gram-charlier", "slick", "breon-henriot"])
@pytest.mark.parametrize("view", [(30.0, 0.4), (70.0, 2.0), (85.0, -1.0)])
@pytest.mark.parametrize("sun", [(35.0, 3.5), (65.0, -1.2)])
def test_skewed_density_is_the_point_formula(slopes, view, sun):
    """Kernel against the arrays of the slope model: p / (4 cos^4 beta A+) times the disc."""
    (theta, azimuth), (zenith, bearing) = (np.radians(view[0]), view[1]), (np.radians(sun[0]), sun[1])
    v, s = (np.array([float(c) for c in direction(*d)]) for d in ((theta, azimuth), (zenith, bearing)))
    total = v + s
    slope = -total[:2] / total[2]
    density = float(slopes.density(*slope))
    expected = np.pi * EPS**2 * density * (1.0 + slope @ slope) ** 2 / (4.0 * float(visible_area(theta, azimuth, slopes)))
    got = float(glint(theta, azimuth, zenith, bearing, slopes, VIEWER).chance)
    peak = float(slopes.density(0.0, 0.0)) * np.pi * EPS**2
    assert got == pytest.approx(expected, rel=0.01, abs=1e-6 * peak)  # curvature of the density on the disc


def test_view_from_below_is_refused():
    with pytest.raises(DomainError, match=r"0\.\.pi/2"):
        glint(2.0, 0.0, 1.0, 0.0, flat())
