"""Choice of the absorption with which the air of a profile is summed."""

from __future__ import annotations

import inspect
from dataclasses import replace
from typing import Any, Final, Literal, get_args

import numpy as np

from seaglint.air.profile.air_profile import GASES, AirProfile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.hazes import HazeWeather
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

Spectroscopy = Literal["lblrtm", "lowtran7"]
"""Numbers refitted to today's line-by-line models, or LOWTRAN7's own."""

_KEYWORD: Final = "spectroscopy"


def available_spectroscopies() -> tuple[Spectroscopy, ...]:
    """Return the choices that this version of the air has, the default first."""
    every: tuple[Spectroscopy, ...] = get_args(Spectroscopy)
    return every if _KEYWORD in inspect.signature(AirSums).parameters else ("lowtran7",)


def chosen_spectroscopies(name: str) -> tuple[Spectroscopy, ...]:
    """Return the choices that a word names: one of them, or ``both`` for all that there are.

    Raises
    ------
    DomainError
        A word that names none.

    Examples
    --------
    >>> chosen_spectroscopies("lowtran7")
    ('lowtran7',)
    """
    known = available_spectroscopies()
    if name == "both":
        return known
    for one in known:
        if one == name:
            return (one,)
    allowed = ", ".join([*known, "both"])
    raise DomainError(f"spectroscopy = '{name}' is not one of {allowed}", name=_KEYWORD, value=name, allowed=allowed)


def sums_with(spectroscopy: Spectroscopy, profile: AirProfile, haze: HazeWeather, wavenumber_cm: FloatArray) -> AirSums:
    """Return the sums of a profile and haze on channels [cm-1, (n,)] with an absorption."""
    more: dict[str, Any] = {_KEYWORD: spectroscopy} if _KEYWORD in inspect.signature(AirSums).parameters else {}
    return AirSums(profile, haze, wavenumber_cm, **more)


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
