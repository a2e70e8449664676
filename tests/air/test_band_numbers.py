"""Band laws that agree with LBLRTM: against RRTMGP's paths and skies, and in the engine that does not know them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fitted_bands
from seaglint.air.profile.absorber_densities import cold_share
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import GASES, lowtran_numbers, model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.band_laws import FIRST_COLUMN, BandLaws, OwnGases, band_numbers, ozone_column, with_gases
from seaglint.air.profile.homogeneous_path import homogeneous_spectrum
from seaglint.base.errors import ScenarioError
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build.scenario_physics import atmosphere, band

ALL = np.arange(680.0, 14291.0, 5.0)
NONE = HazeWeather("none")


def test_lowtran7_is_as_it_was():
    held, laws = lowtran_numbers(), BandLaws.of(ALL, "lowtran7")
    np.testing.assert_array_equal(laws.continuum, held["continuum"])
    assert laws.columns[10:] == sorted({int(c) for c in np.unique(held["band_column"])} - {0})
    assert laws.cold_kelvin == 0.0


def depths(spectroscopy, kelvin, pressure, vapour, length):
    """Optical depths of even air in 3200-3500 cm-1."""
    found = homogeneous_spectrum(
        temperature_k=kelvin,
        pressure_hpa=pressure,
        vapour_pressure_hpa=vapour,
        length_km=length,
        band_um=(1e4 / 3500.0, 1e4 / 3200.0),
        ppmv={"CO2": 425.0, "CH4": 1.9, "N2O": 0.33},
        spectroscopy=spectroscopy,
        haze=NONE,
    )
    return found.wavenumber_cm, -np.log(found.transmittance)


@pytest.mark.parametrize(
    "air", [(215.0, 100.0, 5e-4, 1000.0), (230.0, 250.0, 0.01, 100.0), (250.0, 700.0, 0.3, 0.1), (300.0, 1013.0, 26.0, 5.0)]
)
def test_one_spectroscopy_goes_over_into_the_other_without_a_step(air):
    nu, ours = depths("lblrtm", *air)
    ratio = ours / depths("lowtran7", *air)[1]
    # beyond, the share of water's continuum that is cold has another law where channels below the join are summed with them
    np.testing.assert_allclose(ratio[nu >= 3350.0], 1.0, rtol=0.02)
    join = (nu >= 3240.0) & (nu <= 3370.0)
    assert np.abs(np.diff(np.log(ratio[join]))).max() < 0.05


def test_beyond_the_join_all_numbers_are_lowtran7s():
    nu = np.arange(3350.0, 14291.0, 5.0)
    for model in ("tropical", "subarctic-winter"):
        both = [AirSums(model_profile(model), NONE, nu, 4000.0, spectroscopy=s).along(20.0, 1.6) for s in ("lblrtm", "lowtran7")]
        np.testing.assert_allclose(both[0].transmittance, both[1].transmittance, rtol=1e-12, atol=1e-15)


def test_gases_that_rrtmgp_lacks_keep_lowtran7s_numbers():
    """Ozone in 820-980 and 2680-2860 cm-1, ammonia, nitric acid and nitrogen dioxide everywhere."""
    ours, own = band_numbers("lblrtm"), band_numbers("lowtran7")
    nu = lowtran_numbers()["wavenumber_cm"]
    ozone = ((nu >= 820.0) & (nu < 980.0)) | ((nu >= 2680.0) & (nu < 3250.0))
    np.testing.assert_array_equal(ours.log_coefficient[2, ozone], own.log_coefficient[2, ozone])
    np.testing.assert_array_equal(ours.column[6:11], own.column[6:11])
    np.testing.assert_array_equal(ours.continuum[5], own.continuum[5])
    assert (ours.column[0, nu < 3350.0] >= FIRST_COLUMN).mean() > 0.9


def test_the_file_holds_physical_numbers():
    """Factors on depth within 1/3-3, of the continuum by air from 1/12, powers to 1, exponents of pressure not below 0."""
    for gas, n, _ in (band_numbers("lblrtm").scaled[c] for c in band_numbers("lblrtm").scaled if c >= FIRST_COLUMN):
        assert gas in GASES
        assert n >= 0.0
    own, ours = lowtran_numbers()["continuum"][:, :510], band_numbers("lblrtm").continuum[:, :510]
    ratio = ours[own > 0.0] / own[own > 0.0]
    assert ratio.min() >= 1.0 / 12.0 - 1e-3
    assert ratio.max() <= 3.0 + 1e-3
    assert band_numbers("lblrtm").power.max() <= 1.0


def test_water_grows_with_cold_as_an_exponential():
    """``exp(1800 K (1/T - 1/296 K))``, 1 more at 260 K than at 296 K in units of the cold share."""
    kelvin = np.array([230.0, 260.0, 280.0, 296.0, 310.0])
    law = np.exp(1800.0 * (1.0 / kelvin - 1.0 / 296.0))
    np.testing.assert_allclose(cold_share(kelvin, 1800.0), (law - 1.0) / (law[1] - 1.0), rtol=1e-12)
    np.testing.assert_array_equal(cold_share(np.array([200.0, 278.0, 320.0]), 0.0), [1.0, 0.5, 0.0])


REFERENCE = Path(__file__).parents[3] / "shared/reference/modern_air"
needs_reference = pytest.mark.skipif(not REFERENCE.is_dir(), reason="RRTMGP's reference values are not at hand")

HELD = {low: f"H2O {below}" if low not in fitted_bands.DRY else below for low, (below, _) in fitted_bands.HELD.items()}
"""Gases that RRTMGP holds in the lower air, by lower edge of the band [cm-1]; ozone in 2080-2250 it holds above, where skies have it."""
HELD[2080] += " O3"

SKY_BARS = {
    700: (2.0, 0.5), 820: (5.0, 1.0), 980: (4.0, 1.1), 1080: (5.0, 1.0), 1180: (2.0, 0.5), 1800: (2.0, 0.5), 2080: (6.0, 1.3),
    2250: (2.0, 0.5), 2390: (5.0, 1.0), 2680: (2.0, 0.5),
}  # fmt: skip
"""Per cent or kelvin within which skies agree."""


def only(profile, names):
    """Profile with some of its gases, and oxygen and nitrogen."""
    gas = profile.gas.copy()
    for row, name in enumerate(GASES):
        if name not in (*names, "O2"):
            gas[row] = 0.0
    vapour = profile.vapour if "H2O" in names else 1e-12 * profile.vapour
    return replace(profile, gas=gas, vapour=vapour)


@pytest.mark.parametrize("zenith", [0.0, 1.2])
def test_air_of_one_gas_passes_less_with_more_of_it(zenith):
    for band_edges, names in ((b, names) for b, names in HELD.items() if b != 2250):
        nu = np.arange(band_edges, band_edges + 90.0, 5.0)
        less, more = (
            AirSums(only(with_gases(model_profile("subarctic-summer"), OwnGases(co2_ppmv=c, ch4_ppmv=1.0 + c / 400.0, ozone_du=c)),
                         names.split()), NONE, nu).passed(0.0, zenith).mean()
            for c in (200.0, 600.0)
        )  # fmt: skip
        assert more <= less


def test_gases_of_ones_own_come_out():
    profile = with_gases(model_profile("tropical"), OwnGases(425.0, 1.93, 0.338, 300.0))
    vapour_hpa = profile.vapour[0] * profile.temperature[0] / 216.68
    dry = 1.0 - vapour_hpa / profile.pressure[0]
    assert profile.gas[GASES.index("CO2"), 0] == pytest.approx(425.0 * dry, rel=1e-9)
    assert profile.gas[GASES.index("CH4"), 0] == pytest.approx(1.93 * dry, rel=1e-9)
    assert profile.gas[GASES.index("N2O"), 0] == pytest.approx(0.338 * dry, rel=1e-9)
    assert ozone_column(profile) == pytest.approx(300.0, rel=1e-9)
    # US Standard Atmosphere 1976: 345 DU in its tables of ozone
    assert ozone_column(model_profile("us-standard-1976")) == pytest.approx(345.0, rel=0.02)


def test_scenarios_have_todays_carbon_dioxide_and_the_articles_do_not():
    table = {"band": {"min_um": 4.5, "max_um": 4.8}}
    ours, own, half = (parse_scenario({**table, "atmosphere": air}) for air in ({}, {"spectroscopy": "lowtran7"}, {"co2_ppmv": 212.5}))
    assert atmosphere(ours, band(ours)).provenance["co2_ppmv"] == 425.0
    assert "co2_ppmv" not in atmosphere(own, band(own)).provenance
    passed = [atmosphere(s, band(s)).transmittance(20.0, 5000.0).mean() for s in (ours, half)]
    assert passed[0] < passed[1]


@pytest.mark.parametrize(
    ("key", "value"),
    [("co2_ppmv", -1.0), ("co2_ppmv", 1e5), ("ch4_ppmv", -0.1), ("n2o_ppmv", 1e5), ("ozone_du", -3.0), ("spectroscopy", "hitran")],
)
def test_impossible_gases_are_refused(key, value):
    with pytest.raises(ScenarioError, match=key):
        parse_scenario({"atmosphere": {key: value}})


@needs_reference
@pytest.mark.parametrize("model", ["tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter"])
def test_skies_are_rrtmgps(model):
    from seaglint.air.profile.air_profile import MODEL_HEIGHTS, model_levels
    from seaglint.optics.blackbody import planck_wavenumber

    rows = np.genfromtxt(REFERENCE / "skies.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    rows = rows[rows["model"] == model]
    # the reference has LOWTRAN7's cubic between its levels, 50 m apart
    z = np.unique(np.concatenate([np.arange(0.0, 3e3, 50.0), np.arange(3e3, 12e3, 250.0), MODEL_HEIGHTS]))
    names = ("pressure", "temperature", "vapour", "gas")
    base = replace(model_profile(model), height=z, **dict(zip(names, model_levels(model, z), strict=True)))
    columns = [name for name in rows.dtype.names if name.startswith("radiance")]
    for column, low in zip(columns, HELD, strict=True):
        high = int(column.split("_")[1][len(str(low)) :])
        nu = np.arange(low, high + 1.0, 5.0)
        weight = np.full(nu.size, 5.0)
        weight[[0, -1]] = 2.5
        for co2 in (330.0, 425.0):
            gas = base.gas.copy()
            gas[1] = co2
            air = AirSums(only(replace(base, gas=gas), HELD[low].split()), NONE, nu)
            for row in rows[rows["co2_ppmv"] == co2]:
                ours, truth = float(air.along(0.0, np.radians(float(row["zenith_deg"]))).emitted @ weight), float(row[column])
                slope = (planck_wavenumber(nu, 251.0) - planck_wavenumber(nu, 250.0)) @ weight / (planck_wavenumber(nu, 250.0) @ weight)
                percent, kelvin = SKY_BARS[low]
                assert abs(ours / truth - 1.0) < max(0.01 * percent, kelvin * slope)
