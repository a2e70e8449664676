"""Hot gases against Edwards' closed forms, Leckner's total emissivities and limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from edwards_bands import absorption, column, parameters, spectrum
from scipy import constants

from seaglint.objects.body import GasPlume
from seaglint.objects.combustion_gas import chord_shares, emissivity, longest_chord, plume_emissivity
from seaglint.optics.blackbody import planck_wavenumber

# Leckner (1972) as in Modest (2013), table 11.5: ln of the total emissivity by powers of T/1000 K (along) and of log10 of bar cm (down)
WATER = np.array([[-2.2118, -1.1987, 0.035596], [0.85667, 0.93048, -0.14391], [-0.10838, -0.17156, 0.045915]])
CARBON = np.array([[-3.9893, 2.7669, -2.1081, 0.39163], [1.2710, -1.1090, 1.0195, -0.21897], [-0.23678, 0.19731, -0.19544, 0.044644]])


@pytest.mark.parametrize(("table", "gas"), [(CARBON, 0), (WATER, 1)], ids=["co2", "h2o"])
@pytest.mark.parametrize("kelvin", [400.0, 600.0, 800.0, 1000.0, 1250.0, 1500.0, 2000.0])
def test_total_emissivities_are_leckners(table, gas, kelvin):
    nu = np.arange(2.5, 12_000.0, 5.0)
    share = 1e-3  # Leckner's are of a trace of the gas in 1 bar
    shares = (share, 0.0) if gas == 0 else (0.0, share)
    bar_cm = np.array([1.0, 3.0, 10.0, 30.0, 100.0])
    spectra = emissivity(nu, bar_cm / (100.0 * 1.01325 * share), kelvin, *shares)
    total = 5.0 * math.pi * (spectra @ planck_wavenumber(nu, kelvin)) / (constants.sigma * kelvin**4)
    powers = np.stack([np.log10(bar_cm) ** i for i in range(3)])
    leckner = np.exp((kelvin / 1000.0) ** np.arange(table.shape[1]) @ table.T @ powers)
    # both are fits to measured spectra, which agree no better
    np.testing.assert_allclose(total, leckner, rtol=0.2)


def random_gas(seed):
    rng = np.random.default_rng(seed)
    return float(rng.uniform(300.0, 2500.0)), float(10.0 ** rng.uniform(-4.0, -0.05)), float(10.0 ** rng.uniform(-3.0, 3.0))


SEEN_ALONE = {"co2 4.3 um": (1500.0, 2500.0), "h2o 1.38 um": (6400.0, 8300.0)}


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("name", SEEN_ALONE)
def test_a_band_absorbs_what_edwards_closed_forms_say(name, seed):
    kelvin, share, _ = random_gas(seed)
    alpha, _, omega = parameters(name, kelvin, share)
    depth = 10.0 ** np.random.default_rng(seed).uniform(-3.0, 2.0)  # at the head: all three regimes
    path = depth * omega / alpha / column(name, kelvin, share, 1.0)
    low, high = SEEN_ALONE[name]
    nu = np.arange(low, high, 0.05) + 0.025
    shares = (share, 0.0) if name.startswith("co2") else (0.0, share)
    seen = emissivity(nu, [path], kelvin, *shares)[0]
    # tails end at the borders, and wings of neighbours reach in
    assert 0.05 * seen.sum() == pytest.approx(absorption(name, kelvin, share, path), rel=1e-2)


ALONE = ("co2 4.3 um", "co2 2.7 um", "co2 9.4 um")


@pytest.mark.parametrize("seed", range(30))
def test_spectra_are_the_bands_written_out(seed):
    """Bands of carbon dioxide with rising, falling and no quantum numbers."""
    kelvin, share, path = random_gas(100 + seed)
    nu = np.concatenate([np.linspace(2200.0, 2500.0, 61) + 0.3, np.linspace(3500.0, 3800.0, 61)])
    separate = [spectrum(name, nu, kelvin, share, path) for name in ALONE]
    np.testing.assert_allclose(emissivity(nu, [path], kelvin, share, 0.0)[0], 1.0 - np.prod(1.0 - np.array(separate), axis=0), atol=1e-6)
    # the wings of 10.4 and 15 um reach 9.4 um, where a falling quantum number makes the band one of hot gas
    nu = np.linspace(1061.0, 1090.0, 30)
    assert (emissivity(nu, [path], kelvin, share, 0.0)[0] >= spectrum(ALONE[2], nu, kelvin, share, path) - 1e-9).all()
    thin = 1e-4 / column(ALONE[2], kelvin, share, 1.0)
    seen = emissivity([1060.0], [thin], kelvin, share, 0.0)[0, 0]
    assert seen == pytest.approx(spectrum(ALONE[2], np.array([1060.0]), kelvin, share, thin)[0], rel=0.25)


def test_a_thin_gas_absorbs_in_proportion_to_band_strength():
    nu = np.arange(2000.0, 2500.0, 0.1) + 0.05
    for kelvin in (300.0, 700.0, 1500.0):
        path = np.array([1e-5, 2e-5])
        whole = 0.1 * emissivity(nu, path, kelvin, 0.1, 0.0).sum(axis=1)
        assert whole[1] == pytest.approx(2.0 * whole[0], rel=1e-6)
        # the strength of a fundamental does not depend on the temperature
        assert whole[0] == pytest.approx(110.0 * column("co2 4.3 um", kelvin, 0.1, path[0]), rel=1e-3)


def test_a_thick_gas_is_a_blackbody_in_the_middle_of_its_band_and_none_above_its_head():
    seen = emissivity([2300.0, 2405.0, 2411.0], [10.0], 1200.0, 0.1, 0.0)[0]
    assert seen[:2] == pytest.approx(1.0)
    assert seen[2] < 1e-6


@pytest.mark.parametrize("seed", range(10))
def test_gases_absorb_independently_and_more_along_longer_paths(seed):
    kelvin, share, path = random_gas(200 + seed)
    nu = np.linspace(700.0, 5000.0, 400)
    both, alone, other = (
        emissivity(nu, [path, 1.1 * path], kelvin, *s) for s in ((0.4 * share, 0.6 * share), (0.4 * share, 0.0), (0.0, 0.6 * share))
    )
    np.testing.assert_allclose(1.0 - both, (1.0 - alone) * (1.0 - other), atol=1e-12)
    assert (both[1] >= both[0]).all()
    assert both.min() >= 0.0
    assert both.max() <= 1.0


@pytest.mark.parametrize("whole", [1e-3, 0.4, 0.95, 0.999_999])
def test_a_grey_plume_is_exponential_along_its_chords(whole):
    plume = GasPlume((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), 600.0, whole)
    assert longest_chord(plume) == 0.0
    table = plume_emissivity(plume, np.array([2000.0, 2500.0]))[:, 1]
    share = np.linspace(0.0, 1.0, 10_001)
    np.testing.assert_allclose(np.interp(np.sqrt(share), np.sqrt(chord_shares()), table), 1.0 - (1.0 - whole) ** share, atol=1e-4)


@pytest.mark.parametrize("step", [1.0, 5.0, 7.3])
def test_sums_over_samples_are_integrals_over_the_spectrum(step):
    """The head of the band at 2410 cm-1 is a step, of which samples alone would take too much or too little."""
    plume = GasPlume((0.0, 0.0, 0.0), (0.5, 2.0, 1.0), 900.0, None, 0.08, 0.1)
    nu = np.arange(2001.0, 3200.0, step)
    smooth = np.interp(np.arange(nu[0], nu[-1], 0.01) + 0.005, nu, planck_wavenumber(nu, 900.0))
    fine = np.arange(nu[0], nu[-1], 0.01)[: smooth.size] + 0.005
    table = plume_emissivity(plume, nu)
    weights = np.full(nu.size, step)
    weights[[0, -1]] *= 0.5
    for k in (20, 100, 256):
        whole = 0.01 * float(emissivity(fine, [4.0 * chord_shares()[k]], 900.0, 0.08, 0.1)[0] @ smooth)
        assert float(table[k] @ (weights * planck_wavenumber(nu, 900.0))) == pytest.approx(whole, rel=2e-3)
