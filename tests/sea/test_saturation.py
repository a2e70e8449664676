"""Wavenumber spectra by a table of the saturation: energy within the table and beyond it, directions, winds."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.base.errors import DataError, DomainError
from seaglint.sea.spectra.campaigns import CAMPAIGNS, campaign_spectrum, campaign_table, campaign_winds
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.saturation import SaturationSpectrum, width_of_half
from seaglint.sea.spectra.saturation_table import SaturationRow, SaturationTable

SEAS = [(name, float(wind)) for name in CAMPAIGNS for wind in campaign_winds(name)]

WAVENUMBERS = np.geomspace(5.0, 1000.0, 47)


def powers(exponent: float, **given: object) -> SaturationSpectrum:
    """Spectrum whose saturation is a power of the wavenumber, 0.01 at 5 rad/m."""
    if "width" not in given:
        given.setdefault("delta", np.full(WAVENUMBERS.size, 0.3))
    return SaturationSpectrum(WAVENUMBERS, 0.01 * (WAVENUMBERS / 5.0) ** exponent, **given)  # type: ignore[arg-type]


@pytest.mark.parametrize("exponent", [-0.6, 0.25])
@pytest.mark.parametrize(("low", "high"), [(5.0, 1000.0), (7.3, 91.0), (333.0, 350.0)])
def test_power_law_has_its_closed_integrals(exponent: float, low: float, high: float) -> None:
    """Height and slope variances of a power law between any wavenumbers are the closed ones; quadrature and interpolation are exact."""
    sea = powers(exponent)
    closed = 0.01 / exponent * ((high / 5.0) ** exponent - (low / 5.0) ** exponent)
    assert sum(sea.mss(high, low)) == pytest.approx(closed, rel=1e-9)
    n = exponent - 2.0
    closed = 0.01 / 5.0**exponent / n * (high**n - low**n)
    assert sea.height_variance(high, low) == pytest.approx(closed, rel=1e-9)


def test_zero_between_positive_values_is_a_straight_line() -> None:
    """With a value of 0 the saturation is linear in log k: a triangle of its area, and nothing else."""
    k = np.array([10.0, 20.0, 40.0, 80.0])
    sea = SaturationSpectrum(k, np.array([0.0, 0.01, 0.0, 0.0]), delta=np.zeros(4))
    assert sum(sea.mss()) == pytest.approx(0.01 * np.log(2.0), rel=1e-9)


@pytest.mark.parametrize("given", [{"delta": np.linspace(-0.4, 0.9, 47)}, {"width": np.radians(np.linspace(20.0, 60.0, 47))}])
@pytest.mark.parametrize("turn_deg", [0.0, 35.0, 200.0])
def test_harmonics_are_those_of_the_spreading(given: dict[str, object], turn_deg: float) -> None:
    """The distribution integrates to 1, and its harmonics about the wind are the stated ones, for table and models alike."""
    wind = np.radians(70.0)
    to = wind + np.radians(turn_deg)
    model = ElfouhailySpectrum(8.0, to)
    sea = powers(-0.2, wind_to_azimuth=wind, to_azimuth=to, longer=model, shorter=model, **given)
    azimuth = np.arange(7200) * (2.0 * np.pi / 7200)
    for k in (1.0, 6.0, 200.0, 990.0, 3000.0):
        share = sea.spreading(k, azimuth) * (2.0 * np.pi / 7200)
        assert share.sum() == pytest.approx(1.0, abs=1e-6)
        second = np.sum(share * np.exp(2j * (azimuth - wind)))
        # 7200 directions: the edge of the half plane is a step
        assert complex(float(sea.second_harmonic(k)), float(sea.cross_harmonic(k))) == pytest.approx(second, abs=2e-4)


@pytest.mark.parametrize("degrees", [5.0, 30.0, 75.0, 140.0])
def test_half_width_is_where_the_distribution_halves(degrees: float) -> None:
    """At the half width the distribution is half its maximum."""
    sea = powers(0.1, width=np.full(47, width_of_half(np.radians(degrees))))
    peak, half = (float(sea.spreading(50.0, np.radians(angle))) for angle in (0.0, degrees))
    assert half == pytest.approx(0.5 * peak, rel=1e-9)


def test_models_join_the_table_without_changing_it() -> None:
    """Bands of the table have the table's slope variance, bands beyond it the model's."""
    model = ElfouhailySpectrum(8.0)
    alone, joined = powers(-0.2), powers(-0.2, longer=model, shorter=model)
    assert joined.mss(1000.0, 5.0) == pytest.approx(alone.mss(1000.0, 5.0), rel=1e-9)
    assert joined.mss(5.0) == pytest.approx(model.mss(5.0), rel=1e-6)
    assert joined.mss(np.inf, 1000.0) == pytest.approx(model.mss(np.inf, 1000.0), rel=1e-6)
    longest, shortest = joined.joins()
    assert (longest.wavenumber, longest.measured, longest.longer) == (5.0, pytest.approx(0.01), True)
    assert shortest.model == pytest.approx(1e9 * float(model.omnidirectional(1000.0)), rel=1e-9)
    assert alone.joins()[1].model == 0.0


@pytest.mark.parametrize(("name", "wind"), SEAS)
def test_campaigns_hold_their_tables(name: str, wind: float) -> None:
    """At each wind of a campaign the slope variance over the table's range is the table's own, by the trapezoidal rule."""
    row = next(row for row in campaign_table(name).rows if row.wind == wind)
    sea = campaign_spectrum(name, wind, 0.3)
    last = float(row.wavenumber[-1])
    # the steps of longer waves are up to a factor of 3, over which trapezoids and log-log pieces differ
    short = row.wavenumber > 5.0
    expected = SaturationRow(row.wavenumber[short], row.saturation[short]).slope_variance
    # over steps of 0.14 in log k they differ by 0.3 %
    assert sum(sea.mss(last, float(row.wavenumber[short][0]))) == pytest.approx(expected, rel=0.005)
    assert sea.wavenumber_range[1] == last
    assert sea.cross_harmonic(50.0) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_spectra_are_continuous_in_the_wind(name: str) -> None:
    """Just beside a wind of the table the sea is the table's, and halfway the mean of its neighbours."""
    winds = campaign_winds(name)
    low, high = float(winds[1]), float(winds[2])

    def variances(wind: float) -> np.ndarray:
        sea = campaign_spectrum(name, wind)
        return np.array([*sea.mss(100.0, 20.0), *sea.mss(10.0), sea.height_variance()])

    assert variances(low + 1e-4) == pytest.approx(variances(low), rel=1e-2)
    assert variances(0.5 * (low + high)) == pytest.approx(0.5 * (variances(low) + variances(high)), rel=1e-6)


@pytest.mark.parametrize(("name", "wind"), [("asit-2019", 2.0), ("asit-2019", 18.0), ("radyo-2008", 10.0)])
def test_winds_outside_a_campaign_are_refused(name: str, wind: float) -> None:
    """The error names the wind and the range."""
    winds = campaign_winds(name)
    with pytest.raises(DomainError, match=rf"a wind of {wind:g} m/s is outside the {winds[0]:g} to {winds[-1]:g} m/s of {name}"):
        campaign_spectrum(name, wind)


def test_table_without_wind_holds_for_any() -> None:
    """The table is the same at any wind, the joined model follows the wind."""
    table = SaturationTable((SaturationRow(WAVENUMBERS, np.full(47, 0.01)),))
    calm, light, windy = (table.at(wind) for wind in (0.0, 0.25, 12.0))
    for sea in (calm, light, windy):
        assert sum(sea.mss(1000.0, 5.0)) == pytest.approx(0.01 * np.log(200.0), rel=1e-9)
    assert calm.mss(5.0) == (0.0, 0.0)
    assert windy.mss(5.0) == pytest.approx(ElfouhailySpectrum(12.0).mss(5.0), rel=1e-6)


@pytest.mark.parametrize(
    ("wavenumber", "saturation", "given", "text"),
    [
        ([1.0, 2.0], [1.0, 1.0], {}, "2 wavenumbers"),
        ([1.0, 3.0, 2.0], [1.0, 1.0, 1.0], {}, "ascending"),
        ([1.0, 2.0, 3.0], [1.0, -1.0, 1.0], {}, "not negative"),
        ([1.0, 2.0, 3.0], [1.0, np.nan, 1.0], {}, "finite"),
        ([1.0, 2.0, 3.0], [0.0, 0.0, 0.0], {}, "0 everywhere"),
        ([1.0, 2.0, 3.0], [1.0, 1.0, 1.0], {"delta": np.array([0.0, 1.2, 0.0])}, "delta"),
        ([1.0, 2.0, 3.0], [1.0, 1.0, 1.0], {"delta": None}, "give one of them"),
    ],
)
def test_tables_that_are_no_spectrum_are_refused(wavenumber: list[float], saturation: list[float], given: dict, text: str) -> None:
    """Each error says what is wrong."""
    with pytest.raises((DataError, DomainError), match=text):
        SaturationSpectrum(np.array(wavenumber), np.array(saturation), **({"delta": np.zeros(len(wavenumber))} | given))
