"""Choice of the absorption with which the air of a profile is summed."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, get_args

import numpy as np

from seaglint.air.profile.air_profile import GASES, AirProfile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.band_numbers import Spectroscopy
from seaglint.air.profile.hazes import HazeWeather
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

#: Numbers fitted to today's line-by-line models, and LOWTRAN7's own.
SPECTROSCOPIES: Final[tuple[Spectroscopy, ...]] = get_args(Spectroscopy)


def chosen_spectroscopies(name: str) -> tuple[Spectroscopy, ...]:
    """Return the choices that a word names: one of them, or ``both``.

    Raises
    ------
    DomainError
        A word that names none.

    Examples
    --------
    >>> chosen_spectroscopies("lowtran7")
    ('lowtran7',)
    """
    chosen = tuple(one for one in SPECTROSCOPIES if name in (one, "both"))
    if not chosen:
        allowed = ", ".join([*SPECTROSCOPIES, "both"])
        raise DomainError(f"spectroscopy = '{name}' is not one of {allowed}", name="spectroscopy", value=name, allowed=allowed)
    return chosen


def sums_with(spectroscopy: Spectroscopy, profile: AirProfile, haze: HazeWeather, wavenumber_cm: FloatArray) -> AirSums:
    """Return the sums of a profile and haze on channels [cm-1, (n,)] with an absorption."""
    return AirSums(profile, haze, wavenumber_cm, spectroscopy=spectroscopy)


def with_gas(profile: AirProfile, gas: str, ppm: float) -> AirProfile:
    """Return a profile with a gas scaled to a mixing ratio at its lowest level [1e-6 of the volume]."""
    row = GASES.index(gas)
    held = profile.gas.copy()
    held[row] *= ppm / held[row, 0]
    return replace(profile, gas=held)


def without_gases(profile: AirProfile, gases: tuple[str, ...]) -> AirProfile:
    """Return a profile without some gases."""
    held = profile.gas.copy()
    held[[GASES.index(gas) for gas in gases]] = 0.0
    return replace(profile, gas=np.asarray(held))
