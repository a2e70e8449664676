"""From a scenario to the slope statistics of its sea."""

from __future__ import annotations

import logging
from functools import lru_cache
from typing import Final, assert_never

import numpy as np

from seaglint.base.conventions import travel_azimuth
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import sea_slopes as wanted_slopes
from seaglint.scenario.records.sea_spectrum import FlatSea
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.slopes.from_spectrum import nested_in, spectrum_slopes
from seaglint.sea.slopes.light_winds import at_least_residual
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, flat
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.studies.prepare.wave_spectra import has_wind_sea, spectrum

log = logging.getLogger(__name__)

FEW_SLOPES: Final = 0.6  #: Slope variance of a spectrum over that of Cox and Munk's fit below which short waves are missing.


def slopes(scenario: Scenario) -> SlopeStatistics:
    """Slope statistics of the whole sea, with the covariances of the scenario's longer waves; isotropic laws have no direction at all."""
    sea = spectrum(scenario)
    made = _law(scenario, sea)
    if isinstance(scenario.sea.slopes, wanted_slopes.CoxMunkIsotropic) or isinstance(scenario.sea.spectrum, FlatSea):
        return made
    if made.directed is None or made.directed >= 1.0:
        return made if sea is None else _nested(made, sea)
    without_wind = scenario.model_copy(update={"wind": scenario.wind.model_copy(update={"speed_m_s": 0.0})})
    return _nested(made, sea, spectrum(without_wind))


@lru_cache(maxsize=256)
def _nested(made: SlopeStatistics, waves: DirectionalSpectrum | None, calm: DirectionalSpectrum | None = None) -> SlopeStatistics:
    return nested_in(made, waves, calm)


def _law(scenario: Scenario, sea: DirectionalSpectrum | None) -> SlopeStatistics:
    """Slope statistics by the scenario's slope law, which may be that of its waves."""
    speed, to = scenario.wind.speed_m_s, travel_azimuth(np.radians(scenario.wind.from_deg))
    match scenario.sea.slopes:
        case wanted_slopes.CoxMunkIsotropic(extrapolate=extrapolate):
            return cox_munk_isotropic(speed, extrapolate=extrapolate)
        case wanted_slopes.CoxMunkAnisotropic(extrapolate=extrapolate):
            return cox_munk_anisotropic(speed, to, extrapolate=extrapolate)
        case wanted_slopes.CoxMunkGramCharlier(extrapolate=extrapolate):
            return cox_munk_gram_charlier(speed, to, extrapolate=extrapolate)
        case wanted_slopes.CoxMunkSlick(extrapolate=extrapolate):
            return cox_munk_slick(speed, to, extrapolate=extrapolate)
        case wanted_slopes.BreonHenriot(extrapolate=extrapolate):
            return breon_henriot(speed, to, extrapolate=extrapolate)
        case wanted_slopes.SpectrumSlopes():
            made = SlopeStatistics(0.0, 0.0, to) if sea is None else spectrum_slopes(sea)
            if has_wind_sea(scenario):
                made = at_least_residual(made)
            if made.is_flat:
                return made
            _warn_of_few_slopes(made.mss, speed)
            return made
        case wanted_slopes.FlatSlopes():
            return flat()
        case other:
            assert_never(other)


@lru_cache(maxsize=64)
def _warn_of_few_slopes(mss: float, speed: float) -> None:
    """Say once that a spectrum lacks the short waves that carry most of the slopes."""
    expected = cox_munk_isotropic(speed, extrapolate=True).mss
    if mss < FEW_SLOPES * expected:
        log.warning(
            "seaglint: sea.slopes.kind = 'spectrum': all waves of sea.spectrum have a slope variance of %.2g, and the sea at %.3g m/s has "
            "%.2g (Cox and Munk): short waves are missing, glint is too narrow and too bright; "
            "set sea.slopes.kind = 'cox-munk-anisotropic'",
            mss,
            speed,
            expected,
        )
