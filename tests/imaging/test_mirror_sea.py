"""The sea of mirrors: what it must do on seas known by heart, and the sweep and the mean map beside it."""

import csv
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mirror_sea import CutSpectrum, MirrorSea, RoundSpectrum, lattice, meets, mirror_sea, ripple_tiles, traced
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import surface_range
from seaglint.facet.legs import BOTH
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField
from truth_table import BESIDE, HEIGHT, LONGEST_RIPPLE, PIXELS, WINDS, camera_at, compare, disc_radius, four_suns, line, mapped, view_of

NO_SHIFT = np.zeros((2, 2))


def sea_of_one_lattice(height, slope, spacing):
    """A tile of long waves over ripples of no height."""
    n = height.shape[0]
    flat = np.zeros((3, n, n), np.float32)
    flat[0] = height
    slopes = np.zeros((3, n, n, 2), np.float32)
    slopes[0] = slope
    steepest = max(float(np.abs(slope).max()), 0.01)
    return MirrorSea(
        flat, slopes, np.tile([1.0 / spacing, 1.0, 0.0], (3, 1)), (float(height.max()), 0.0, 0.0), (steepest, steepest, steepest), 0.01
    )


def calm():
    return sea_of_one_lattice(np.zeros((16, 16)), np.zeros((16, 16, 2)), 1.0)


@cache
def fields(wind, shortest=0.015, spectrum=CutSpectrum):
    """Long waves and ripples of a sea that runs towards the sensor."""
    waves = spectrum.of(ElfouhailySpectrum(wind, math.pi), shortest)
    long = WaveField.create(waves, plan_tiles(waves, LONGEST_RIPPLE, 512), 1)
    return long, WaveField.create(waves, ripple_tiles(LONGEST_RIPPLE, shortest), 2)


@pytest.mark.parametrize("depression_deg", [1.0, 10.0])
def test_rays_meet_a_calm_sea_where_the_sphere_is(depression_deg):
    d = math.radians(depression_deg)
    r, behind = meets(calm(), (0.0, 0.0, HEIGHT), (0.0, 1.0, -math.tan(d)), EFFECTIVE_EARTH_RADIUS, NO_SHIFT)
    assert r == pytest.approx(float(surface_range(HEIGHT, d)), rel=1e-3)
    assert behind - r < 1e-5


def test_a_calm_sea_mirrors_the_sun_where_it_stands():
    """Pixels of 0.05 deg over 10 deg down: a disc of half a degree about the Sun 10 deg high fills those within half a degree."""
    edges = (-math.radians(1.0), math.radians(0.05), math.radians(-9.0), math.radians(0.05))
    suns = np.array([[math.radians(80.0), 0.0, math.radians(0.5)]])
    found = traced(calm(), (0.0, 0.0, HEIGHT), edges, (40, 40), suns, np.ones(2), 50, np.random.default_rng(1))[..., 0, :].mean(axis=2)
    assert found[..., 0] == pytest.approx(found[..., 1])
    level = math.pi * math.radians(0.5) ** 2
    share = found[..., 1] * level
    assert share.max() == pytest.approx(1.0)
    # the disc's area in the pixels' angles, azimuths shortened by the cosine of elevation
    assert share.sum() * math.radians(0.05) ** 2 * math.cos(math.radians(10.0)) == pytest.approx(level, rel=0.02)


def test_a_crest_hides_and_shades():
    n = 256
    x = np.arange(n) * 0.1
    height = np.tile(0.3 * np.exp(-(((x - 12.0) / 0.5) ** 2)), (n, 1))
    slope = np.stack([np.gradient(height, 0.1, axis=1), np.zeros((n, n))], axis=-1)
    sea = sea_of_one_lattice(height, slope, 0.1)
    low, high = (0.0, 5.0, 0.1), (1.0, 0.0, 0.01)
    assert 11.0 < meets(sea, low, high, EFFECTIVE_EARTH_RADIUS, NO_SHIFT)[0] < 12.0
    assert meets(sea, low, (1.0, 0.0, 0.05), EFFECTIVE_EARTH_RADIUS, NO_SHIFT)[0] < 0.0
    assert meets(sea, (13.5, 5.0, 0.01), high, EFFECTIVE_EARTH_RADIUS, NO_SHIFT)[0] > 20.0  # the next period's


def test_lattices_carry_the_spectrum():
    """Read between their points they have the heights and slopes of the plane waves that they are made of."""
    waves, ripples = fields(7.0)
    for field, which in ((waves, 2), (ripples, 0), (ripples, 1)):
        height, slope = lattice(field, which, 0.0)
        east, north, _, real, imaginary = field.plane_waves()[which].T
        energy = 0.5 * (real**2 + imaginary**2)
        for values, expected in ((height, energy), (slope[..., 0], energy * east**2), (slope[..., 1], energy * north**2)):
            half = [0.5 * (values + np.roll(values, 1, axis)) for axis in (0, 1)]
            middle = 0.5 * (half[0] + np.roll(half[0], 1, 1))
            # the mean square of a bilinear surface from nodes, edges' and cells' middles (Simpson's rule)
            mean = (4.0 * np.mean(values**2) + 8.0 * (np.mean(half[0] ** 2) + np.mean(half[1] ** 2)) + 16.0 * np.mean(middle**2)) / 36.0
            assert mean == pytest.approx(expected.sum(), rel=2e-3)


def test_ripples_and_waves_add_up_to_the_slopes_of_the_spectrum():
    waves, ripples = fields(7.0)
    found = []
    for seed in range(4):
        parts = [part for field in (waves, ripples) for part in field.reseeded(seed).plane_waves()]
        found.append(sum(float(np.sum(0.5 * (p[:, 3] ** 2 + p[:, 4] ** 2) * (p[:, 0] ** 2 + p[:, 1] ** 2))) for p in parts))
    assert np.mean(found) == pytest.approx(sum(waves.spectrum.mss()), rel=0.01)


def test_steep_views_of_a_high_sun_are_the_slope_density():
    """Nothing hides and nothing shades: rays alone must give ``q/(4 cos^4(beta) v_z)``."""
    waves, ripples = fields(3.0)
    view = view_of(waves, 50.0)
    camera = camera_at(30.0)
    radius = disc_radius(view, 30.0)
    edges = (camera.azimuth - 0.5 * camera.width, camera.column_step, camera.top, camera.row_step)
    suns, rng = np.array([[view.solar_zenith, 0.0, radius]]), np.random.default_rng(4)
    found = []
    for i in range(4):
        sea = mirror_sea(waves.reseeded(i), ripples.reseeded(i))
        for place in rng.uniform(0.0, 1000.0, (8, 2)):
            found.append(traced(sea, (*place, HEIGHT), edges, PIXELS, suns, np.ones(2), 100, rng)[..., 0, :].mean(axis=(0, 1, 2)))
    unshaded, shaded = np.mean(found, axis=0)
    error = np.std(found, axis=0, ddof=1)[1] / math.sqrt(len(found))
    expected = np.mean([mapped(one, camera, np.ones(2)) for one in four_suns(view, radius)])
    assert shaded == unshaded
    assert error < 0.02 * expected
    assert shaded == pytest.approx(expected, abs=3.0 * error)


def test_halves_and_seeds():
    """The same numbers give the same radiances whatever the threads."""
    waves, ripples = fields(3.0)
    sea = mirror_sea(waves, ripples)
    suns = np.array([[math.radians(75.0), 0.0, 0.03]])
    one, two = (
        traced(sea, (0.0, 0.0, HEIGHT), (0.0, 1e-3, -0.05, 1e-3), (4, 3), suns, np.ones(2), 20, np.random.default_rng(1), threads)
        for threads in (1, 3)
    )
    assert np.array_equal(one, two)
    assert not np.array_equal(one[:, :, 0], one[:, :, 1])


def test_sweep_and_mirrors_agree_at_one_place():
    """7 m/s from 50 deg beside the Sun 15 deg high, 3 deg down."""
    (row,) = compare(7.0, 50.0, depressions=(3.0,), suns=(75.0,), seas=6, rays=60, legs=False)
    print(line(row))
    assert row.mean_error < 0.03
    assert row.mean == pytest.approx(1.0, abs=0.03 + 2.0 * row.mean_error)


@pytest.mark.validation
@pytest.mark.parametrize("wind", [7.0, 5.0])
def test_mirrors_and_convex_hulls_find_the_same_low_suns(reference_dir, wind):
    """Profiles of an independent calculation, isotropic sea with waves to 1 cm: within their error, ours and 2 %."""
    with (reference_dir / "low_sun.csv").open() as stream:
        rows = [row for row in csv.DictReader(stream) if row["case"] == f"U{wind:g} elf iso 1cm"]
    table = {
        (float(r["view_depression_deg"]), float(r["sun_elevation_deg"])): (float(r["lit_and_seen_over_smith"]), float(r["standard_error"]))
        for r in rows
    }
    waves, ripples = fields(wind, 0.01, RoundSpectrum)
    elevations, rng = (5.0, 10.0, 15.0), np.random.default_rng(3)
    views = [replace(view_of(waves, 90.0 - e), shadowing=BOTH) for e in elevations]
    found = {d: [] for d in (1.0, 2.0, 5.0, 10.0)}
    for i in range(6):
        sea = mirror_sea(waves.reseeded(i), ripples.reseeded(100 + i))
        for d, rows_of in found.items():
            camera = camera_at(d)
            edges = (camera.azimuth - 0.5 * camera.width, camera.column_step, camera.top, camera.row_step)
            suns = np.array([(v.solar_zenith, 0.0, disc_radius(v, d)) for v in views])
            for place in rng.uniform(0.0, 3000.0, (6, 2)):
                rows_of.append(traced(sea, (*place, HEIGHT), edges, PIXELS, suns, np.ones(2), 200, rng)[..., 1].mean(axis=(0, 1, 2)))
    for d, rows_of in found.items():
        mean, error = np.mean(rows_of, axis=0), np.std(rows_of, axis=0, ddof=1) / math.sqrt(len(rows_of))
        for j, e in enumerate(elevations):
            smith = np.mean([mapped(one, camera_at(d), np.ones(2)) for one in four_suns(views[j], disc_radius(views[j], d))])
            expected, own = table[d, e]
            print(f"{d:g} deg down, Sun {e:g} deg high: {mean[j] / smith:.4f} +- {error[j] / smith:.4f}, {expected:.4f} +- {own:.4f}")
            assert mean[j] / smith == pytest.approx(expected, abs=0.02 * expected + 3.0 * math.hypot(own, error[j] / smith))


DOWN = (1.0, 2.0, 3.0, 5.0, 10.0)
MEAN = {50.0: (0.03,) * 5, 75.0: (0.03,) * 5, 80.0: (0.05,) * 5, 85.0: (0.18, 0.08, 0.08, 0.08, 0.07)}
LIGHT = {50.0: (0.11, 0.05), 80.0: (0.07, 0.04), 85.0: (0.13, 0.07)}
"""Departures of the mean at depressions ``DOWN`` by the Sun's zenith angle, and in a wind of 3 m/s at the first two."""

CONTRAST = {
    50.0: (0.1, 0.06, 0.05, 0.05, 0.05),
    75.0: (0.1, 0.06, 0.05, 0.05, 0.05),
    80.0: (0.15, 0.1, 0.05, 0.05, 0.05),
    85.0: (0.35, 0.3, 0.25, 0.15, 0.05),
}
"""Departures of the pixels' contrast."""


def allowed(row):
    """Departures of the mean and of the contrast: 3 and 5 %, and what the law of facets misses under low Suns and in light winds.

    Facets are hidden about the tilt of longer waves as on endless planes: those tilted away from a low Sun get no light, those towards it
    too much, and places behind crests are seen too rarely. The sum is right where few of them count.
    """
    k = DOWN.index(row.depression)
    mean = LIGHT[row.sun][k] if row.wind == 3.0 and row.sun in LIGHT and k < 2 else MEAN[row.sun][k]
    return mean, CONTRAST[row.sun][k]


def beyond(row):
    """Figures of a row beyond their bars by more than three standard errors."""
    mean, contrast = allowed(row)
    out = ["mean"] if abs(row.mean - 1.0) > mean + 3.0 * row.mean_error else []
    # pixels that differ by less than a fifth of their mean have no contrast to speak of, and rays hardly know it
    known = row.truth_deviation > 0.2 and row.slope_error < 0.06
    return out + (["contrast"] if known and abs(row.slope - 1.0) > contrast + 3.0 * row.slope_error else [])


@pytest.mark.validation
@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize("wind", WINDS)
def test_sweep_and_mirrors_agree(wind, beside):
    """All of the table: the mean of the glint, and how pixels differ, ripples averaged out."""
    rows = list(compare(wind, beside, seas=12, rays=250, legs=False))
    print("\n".join(line(row) for row in rows))
    missed = [f"{', '.join(beyond(row))}: {line(row)}" for row in rows if beyond(row)]
    assert not missed
