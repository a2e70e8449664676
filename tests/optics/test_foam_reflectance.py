"""Emissivity of foam against published measurements, and its limits."""

from pathlib import Path

import numpy as np
import pytest

from seaglint.optics.foam_reflectance import BUBBLES, diffuse_reflectance, foam_emissivity, foam_reflectance
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import hale_querry_sea, segelstein

WATERS = {"hale-querry-sea": hale_querry_sea(), "segelstein": segelstein()}

#: Effective reflectance of whitecaps (Whitlock et al. 1982 times Koepke's 0.4) as 6S tabulates it, every 0.1 um from 1 um.
WHITECAPS = [0.2, 0.19, 0.175, 0.155, 0.13, 0.08, 0.1, 0.105, 0.1, 0.08, 0.045, 0.055, 0.065, 0.06, 0.055, 0.04]

LONG_WAVE = np.linspace(8.0, 14.0, 121)


def _difference(wavelength_um, angle_deg, water):
    """Emissivity of foam minus that of smooth water."""
    cosine, nu = np.cos(np.radians(angle_deg)), 1e4 / np.asarray(wavelength_um)
    return foam_emissivity(cosine, nu, water) - (1.0 - reflectance(cosine, water.index(nu)))


@pytest.mark.parametrize("water", WATERS.values(), ids=WATERS.keys())
def test_difference_at_85_deg_is_branchs(water):
    """Branch et al. 2016: 0.23 at 8.9 um and 85 deg."""
    assert float(_difference(8.9, 85.0, water)) == pytest.approx(0.23, abs=0.01)


@pytest.mark.parametrize("water", WATERS.values(), ids=WATERS.keys())
def test_difference_at_65_deg_is_niclos(water):
    """Niclos et al. 2007: about 0.04 in 8-14 um at 65 deg; they give one digit."""
    assert float(_difference(LONG_WAVE, 65.0, water).mean()) == pytest.approx(0.04, abs=0.01)


@pytest.mark.parametrize("angle_deg", [0.0, 25.0, 45.0])
def test_difference_is_negligible_at_small_angles(angle_deg):
    """Niclos et al. 2007 find no effect below 45 deg; their emissivities are good to some 0.01."""
    assert float(_difference(LONG_WAVE, angle_deg, WATERS["hale-querry-sea"]).mean()) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("water", WATERS.values(), ids=WATERS.keys())
def test_foam_emits_more_than_water_at_large_angles_and_the_difference_grows(water):
    """Branch et al. 2016: at all wavelengths of 3.5-5.5 and 8-14 um, and growing from 65 to 85 deg."""
    wavelength = np.concatenate([np.linspace(3.5, 5.5, 41), LONG_WAVE])
    difference = np.stack([_difference(wavelength, angle, water) for angle in (65.0, 70.0, 75.0, 80.0, 85.0)])
    assert difference.min() > 0.015
    assert np.diff(difference, axis=0).min() > 0.0


@pytest.mark.parametrize(("conditions", "wavelength_um", "angle_deg"), [
    ("8-14 µm, 25°", LONG_WAVE, 25.0), ("8-14 µm, 45°", LONG_WAVE, 45.0), ("8-14 µm, 65°", LONG_WAVE, 65.0), ("8.9 µm, 85°", 8.9, 85.0),
])  # fmt: skip
def test_the_page_says_what_the_code_gives(conditions, wavelength_um, angle_deg):
    page = (Path(__file__).parents[2] / "docs/validation/sea.md").read_text(encoding="utf-8")
    row = next(line for line in page.splitlines() if f"| {conditions} |" in line)
    told = [float(cell) for cell in row.strip("| ").split(" | ")[3:]]
    ours = [float(np.mean(_difference(wavelength_um, angle_deg, water))) for water in WATERS.values()]
    assert told == pytest.approx(ours, abs=6e-4)


def test_diffuse_reflectance_is_that_of_whitecaps_where_it_was_measured():
    water, nu = WATERS["hale-querry-sea"], 1e4 / np.arange(1.0, 2.55, 0.1)
    ours = diffuse_reflectance(nu, water) + (1.0 - BUBBLES) * reflectance(1.0, water.index(nu))
    assert np.sqrt(np.mean((ours - WHITECAPS) ** 2)) < 0.017
    assert np.corrcoef(ours, WHITECAPS)[0, 1] > 0.94


@pytest.mark.parametrize("water", WATERS.values(), ids=WATERS.keys())
def test_energy_is_conserved_at_all_wavelengths_and_angles(water):
    cosine, nu = np.linspace(0.0, 1.0, 101)[:, None], 1e4 / np.linspace(0.65, 14.0, 500)
    reflected, emitted = foam_reflectance(cosine, nu, water), foam_emissivity(cosine, nu, water)
    assert reflected.min() > 0.0
    assert reflected.max() < 1.0
    np.testing.assert_allclose(reflected + emitted, 1.0, rtol=1e-15)
    # the bubbles reflect less than the light that falls on them
    assert diffuse_reflectance(nu, water).max() < BUBBLES


def test_water_that_absorbs_nothing_gives_white_bubbles_and_black_water_black_ones():
    water = WATERS["hale-querry-sea"]
    assert float(diffuse_reflectance(1e4 / 0.65, water)) == pytest.approx(0.22, rel=0.05)
    assert float(diffuse_reflectance(1e4 / 3.0, water)) < 1e-5
