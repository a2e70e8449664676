"""Facets on waves that are geometry are as often seen and lit as on a sea whose waves are all geometry, brute force in one plane."""

import numpy as np
import pytest

import facet_bands
from facet_bands import differences
from seaglint.sea.shadowing.nested import bands_of_facets


def test_facets_on_waves_are_seen_and_lit_as_all_waves_are(monkeypatch):
    """Bands by their share of the slope variance miss by 0.08, 0.04 rms."""
    monkeypatch.setattr(facet_bands, "POINTS", 2**21)
    off = np.abs(differences(12.0, [0.5], 1))
    assert np.nanmax(off) < 0.04
    assert np.sqrt(np.nanmean(off**2)) < 0.02


@pytest.mark.validation
@pytest.mark.parametrize(("wind", "largest", "rms"), [(3.0, 0.13, 0.04), (7.0, 0.07, 0.03), (20.0, 0.06, 0.03)])
def test_facets_on_waves_at_other_winds(wind, largest, rms):
    off = np.abs(differences(wind, [0.25, 2.0, 16.0], 2))
    assert np.nanmax(off) < largest
    assert np.sqrt(np.nanmean(off**2)) < rms


def test_bands_of_facets_go_from_none_to_all():
    assert bands_of_facets(1.0, 4.0) == 4.0
    assert bands_of_facets(0.0, 4.0) == 0.0
    assert bands_of_facets(0.3, 1.0) == 1.0, "Smith's law stays Smith's"
    assert bands_of_facets(0.3, 1.001) == pytest.approx(1.0, abs=0.01)
    found = [bands_of_facets(share, 5.0) for share in np.linspace(0.0, 1.0, 50)]
    assert np.all(np.diff(found) >= 0.0)
