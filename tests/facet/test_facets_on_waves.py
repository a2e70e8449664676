"""Facets on waves that are geometry are as often seen and lit as on a sea whose waves are all geometry, brute force in one plane."""

import math

import numpy as np
import pytest

from hidden_facets import SunLook, clean_sea, in_plane, on_geometry, sampled, two_lines
from seaglint.facet.legs import BOTH, NESTED
from seaglint.sea.shadowing.nested import NO_SHELTER, bands_of_facets, shelter_of_facets
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic


def _facets_over_all_waves(sea, cut, looks, draws):
    """Ratio of facets seen and lit, those on waves longer than a cut over those of all waves, where enough are left; its error."""
    found, error = sampled(two_lines(sea, (0.0, math.pi), min(look.depression for look in looks), step=1.03), looks, draws)
    kept = found[:, 1] > 10.0 * error[:, 1]
    left = [look for look, keep in zip(looks, kept, strict=True) if keep]
    return on_geometry(sea, cut, left, draws // 2) / found[kept, 1], error[kept, 1] / found[kept, 1]


def test_facets_on_waves_are_seen_and_lit_as_all_waves_are():
    looks = [SunLook(math.radians(d), math.radians(e)) for d, e in ((1.0, 3.0), (1.0, 10.0), (3.0, 5.0), (7.0, 2.0))]
    ratio, error = _facets_over_all_waves(clean_sea(5.0, sizes=(200, 24)), 1.0, looks, 20_000)
    assert ratio.size == 4
    assert np.all(np.abs(ratio - 1.0) < 0.15 + 3.0 * error)


@pytest.mark.validation
@pytest.mark.parametrize("wind", [3.0, 7.0, 12.0])
@pytest.mark.parametrize("cut", [0.25, 3.0, 20.0])
def test_facets_on_waves_at_other_winds(wind, cut):
    """Facets of most ripples lose up to two thirds of what is rare, with Sun and view at 1 deg and below."""
    low = in_plane((0.5, 1.0, 3.0), (1.0, 2.0, 3.0))
    ratio, error = _facets_over_all_waves(clean_sea(wind), cut, low, 100_000)
    print(wind, cut, np.round(ratio, 2))
    assert np.all(ratio > 0.3 - 3.0 * error)
    assert np.all(ratio < 1.45 + 3.0 * error)
    ratio, error = _facets_over_all_waves(clean_sea(wind), cut, in_plane((3.0, 7.0), (5.0, 10.0, 15.0)), 40_000)
    print(wind, cut, np.round(ratio, 2))
    assert np.all(np.abs(ratio - 1.0) < 0.2 + 3.0 * error)


def test_shelter_ends_where_facets_carry_all_slopes():
    assert shelter_of_facets(1.0) == pytest.approx(NO_SHELTER)
    grown = np.array([shelter_of_facets(share) for share in np.linspace(0.0, 1.0, 50)])
    assert np.all(np.diff(grown, axis=0) < 0.0)


def test_smiths_law_has_no_shelter():
    """Of Smith's facets no geometry is thought to know more."""
    slopes = cox_munk_anisotropic(7.0, 0.3)
    half = cox_munk_anisotropic(3.0, 0.3)
    assert BOTH.facet_law(slopes, half).shelter == NO_SHELTER
    assert BOTH.facet_law(slopes, half).bands == 1.0
    assert NESTED.facet_law(slopes, half).shelter == shelter_of_facets(half.mss / slopes.mss)
    assert NESTED.facet_law(slopes, slopes).bands == NESTED.law_bands(slopes)


def test_bands_of_facets_go_from_none_to_all():
    assert bands_of_facets(1.0, 4.0) == 4.0
    assert bands_of_facets(0.0, 4.0) == 0.0
    assert bands_of_facets(0.3, 1.0) == 1.0, "Smith's law stays Smith's"
    assert bands_of_facets(0.3, 1.001) == pytest.approx(1.0, abs=0.01)
    found = [bands_of_facets(share, 5.0) for share in np.linspace(0.0, 1.0, 50)]
    assert np.all(np.diff(found) >= 0.0)
