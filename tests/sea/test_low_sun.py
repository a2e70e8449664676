"""Glint of low Suns near the horizon: facets seen and lit, over Smith's law, against brute force without any law of hiding.

Bars are relative. Of Smith's share 1 to 5 % are left over winds of 5 m/s and more with Sun and view below 3 deg: differences from Smith's
law would hide a factor of ten.
"""

import csv
import math

import numpy as np
import pytest

from hidden_facets import SunLook, clean_sea, in_plane, of_law, of_smith, sampled, two_lines
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

BAR, RARE_BAR = 0.15, 0.35
"""Of shares above a tenth of Smith's law, and of smaller ones, whose brute force by rays in two dimensions differs by a tenth itself."""

# wind [m/s], depression and Sun's elevation [deg], seen and lit over Smith's law, standard error: rows of low_sun.csv, Elfouhaily's
# spectrum down to 1 cm, isotropic, with Cox and Munk's total slope variance.
BRUTE_FORCE = [
    (2, 0.5, 1, 0.17013, 0.00274),
    (2, 1, 2, 0.29101, 0.00140),
    (2, 2, 5, 0.70946, 0.00503),
    (2, 5, 10, 1.01618, 0.00555),
    (5, 0.5, 1, 0.02717, 0.00144),
    (5, 1, 1, 0.03628, 0.00090),
    (5, 1, 5, 0.23874, 0.00202),
    (5, 5, 2, 0.31787, 0.00181),
    (7, 0.5, 1, 0.01285, 0.00091),
    (7, 1, 1, 0.01655, 0.00093),
    (7, 1, 2, 0.02938, 0.00058),
    (7, 2, 2, 0.05062, 0.00099),
    (7, 2, 5, 0.18142, 0.00195),
    (7, 1, 10, 0.49888, 0.00674),
    (7, 5, 5, 0.40721, 0.00226),
]


def even_slopes(wind):
    """Isotropic slopes of Cox and Munk's total variance."""
    total = 0.003 + 0.00512 * wind
    return SlopeStatistics(0.5 * total, 0.5 * total)


def ours(wind, depression, elevation):
    look = SunLook(math.radians(depression), math.radians(elevation))
    slopes = even_slopes(wind)
    return of_law(look, slopes) / of_smith(look, slopes)


def off_by(found, wanted, error):
    """Difference over what the bar allows [1], two standard errors apart."""
    return abs(found - wanted) / ((BAR if wanted > 0.1 else RARE_BAR) * wanted + 2.0 * error)


@pytest.mark.parametrize("row", BRUTE_FORCE)
def test_facets_seen_and_lit_under_low_suns(row):
    assert off_by(ours(*row[:3]), *row[3:]) < 1.0


def test_all_of_the_table_of_low_suns(reference_dir):
    with (reference_dir / "low_sun.csv").open() as stream:
        rows = [row for row in csv.DictReader(stream) if row["case"] in {f"U{wind} elf iso 1cm" for wind in (2, 5, 7)}]
    assert len(rows) == 108
    ratios, worst = [], 0.0
    for row in rows:
        wind = float(row["case"].split()[0][1:])
        share = ours(wind, float(row["view_depression_deg"]), float(row["sun_elevation_deg"]))
        wanted = float(row["lit_and_seen_over_smith"])
        ratios.append(share / wanted)
        worst = max(worst, off_by(share, wanted, float(row["standard_error"])))
    assert worst < 1.0
    assert np.sqrt(np.mean(np.log(ratios) ** 2)) < 0.1


LADDERS = {"wind": np.arange(2.0, 18.01, 0.25), "depression": np.geomspace(0.5, 20.0, 60), "elevation": np.geomspace(0.7, 40.0, 60)}
OTHERS = [(0.5, 1.0), (1.0, 5.0), (3.0, 2.0), (10.0, 15.0)]
"""Depressions and elevations of the Sun, those that do not change [deg]."""


def _steps(along, at):
    """Steps of the logarithm of the share seen and lit up a ladder."""
    shares = []
    for place in LADDERS[along]:
        wind, depression, elevation = (at | {along: place}).values()
        shares.append(of_law(SunLook(math.radians(depression), math.radians(elevation)), even_slopes(wind)))
    return np.diff(np.log(shares))


@pytest.mark.parametrize("wind", [3.0, 7.0, 12.0])
@pytest.mark.parametrize("along", ["depression", "elevation"])
@pytest.mark.parametrize("others", OTHERS)
def test_shares_grow_evenly_with_view_and_sun(along, others, wind):
    """Higher legs hide less; no step between neighbours is out of line with the next."""
    steps = _steps(along, {"wind": wind, "depression": others[0], "elevation": others[1]})
    assert steps.min() > -1e-3
    assert np.abs(np.diff(steps)).max() < 0.04


@pytest.mark.parametrize("others", OTHERS)
def test_shares_fall_evenly_with_the_wind(others):
    """The number of bands stops growing at 6 m/s: a bend of the logarithm, by 0.085 in steps of a quarter of a metre per second."""
    steps = _steps("wind", {"wind": 0.0, "depression": others[0], "elevation": others[1]})
    assert steps.max() < 0.0
    assert np.abs(np.diff(steps)).max() < 0.1


def test_a_little_brute_force_of_our_own():
    """Over 3 m/s, by a coarse sea and few facets: it sees the law being wrong by a third."""
    looks = [SunLook(math.radians(d), math.radians(e)) for d, e in ((1.0, 2.0), (2.0, 2.0), (2.0, 5.0), (5.0, 10.0))]
    lines = two_lines(clean_sea(3.0, sizes=(200, 24)), (0.0, math.pi), math.radians(1.0), step=1.05)
    found, error = sampled(lines, looks, 20_000)
    for look, (_, both), (_, off) in zip(looks, found, error, strict=True):
        assert of_law(look, even_slopes(3.0)) == pytest.approx(both, rel=BAR, abs=3.0 * off)


@pytest.mark.validation
@pytest.mark.parametrize("wind", [3.0, 12.0])
def test_brute_force_of_other_winds(wind):
    looks, slopes = in_plane(), even_slopes(wind)
    found, error = sampled(two_lines(clean_sea(wind), (0.0, math.pi), math.radians(0.5)), looks, 200_000)
    told = 0
    for look, (_, both), (_, off) in zip(looks, found, error, strict=True):
        if both > 10.0 * off:
            told += 1
            smith = of_smith(look, slopes)
            assert off_by(of_law(look, slopes) / smith, both / smith, off / smith) < 1.0, look
    assert told > 40
