from dataclasses import replace

import numpy as np
import pytest

from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.errors import DomainError
from seaglint.facet.glint import glint
from seaglint.facet.legs import BOTH, NESTED, VIEWER, Shadowing
from seaglint.facet.sea_view import BandSum, SeaView
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.sea.shadowing.nested import bands_of
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic

BAND = Band.rectangular(3.5, 4.2)
AIR = VacuumAtmosphere.for_band(3.0, 5.0)
VIEW = SeaView(AIR, BAND, sea_water.hale_querry_sea(), cox_munk_isotropic(5.0), 288.15, 30.0, 1.2, sun_distance_factor=1.03)


def test_a_flat_spectrum_sums_to_the_bands_width():
    over = BandSum.of(BAND, AIR)
    assert over(np.full(AIR.wavenumber_cm.size, 2.0)) == pytest.approx(2.0 * (1e4 / 3.5 - 1e4 / 4.2), rel=1e-9)
    np.testing.assert_array_equal(over.wavenumber_cm, AIR.wavenumber_cm[over.grid])
    spectra = np.stack([AIR.wavenumber_cm, np.ones_like(AIR.wavenumber_cm)])
    np.testing.assert_allclose(over(spectra), spectra[:, over.grid] @ over.weights, rtol=1e-14)


def test_sunlight_in_the_band_is_of_the_whole_disc_at_the_suns_distance():
    expected = 1.03 * AIR.solar_irradiance(1.2)[VIEW.in_band.grid]
    np.testing.assert_allclose(VIEW.irradiance, expected, rtol=1e-14)
    cut = replace(VIEW, solar_zenith=0.5 * np.pi + 0.5 * SOLAR_ANGULAR_RADIUS)
    np.testing.assert_allclose(cut.irradiance, expected, rtol=1e-14)  # no air: the same from any height
    assert not replace(VIEW, solar_zenith=1.6).irradiance.any()


def test_the_words_of_shadowing_name_law_and_legs():
    assert [Shadowing.of(word) for word in ("both", "viewer", "nested")] == [BOTH, VIEWER, NESTED]
    assert [s.word for s in (BOTH, VIEWER, NESTED, Shadowing.of("nested", 3))] == ["both", "viewer", "nested", "nested"]
    assert [s.law_bands(VIEW.slopes) for s in (BOTH, Shadowing.of("nested", 3))] == [1.0, 3]
    assert NESTED.law_bands(VIEW.slopes) == bands_of(VIEW.slopes.mss)
    assert Shadowing.of("both", 2).bands_for(VIEW.slopes) == 2


def test_refusals_of_views_say_what_to_do():
    with pytest.raises(DomainError, match="choose 'nested', 'nested-viewer', 'both', 'viewer'"):
        Shadowing.of("none")
    with pytest.raises(DomainError, match="outside 1-64"):
        glint(1.5, 0.0, 1.2, 0.0, VIEW.slopes, Shadowing(bands=65))
