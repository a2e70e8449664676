"""Parts of a sounding that are continued: humidity below its first and above its last one, air above its last level."""

from __future__ import annotations

from dataclasses import dataclass

from seaglint.air.profile.air_profile import AirProfile
from seaglint.files.soundings.sounding import LOW_TOP, Sounding


@dataclass(frozen=True)
class Continuation:
    """Part of the air that the sounding does not have."""

    height: float  #: Height from which on it is, or up to which [m].
    share: float  #: Share of the precipitable water there [1].
    text: str  #: What ends where, and the share.
    below: bool = False  #: True for the part below that height.


def percent(share: float) -> str:
    """Return a share in per cent, with two figures.

    >>> percent(0.1432), percent(2e-5), percent(0.0)
    ('14 %', '0.002 %', '0 %')
    """
    return f"{float(f'{100.0 * share:.2g}'):.6g} %"


def continuations(sounding: Sounding, profile: AirProfile, model: str, sensor: float | None = None) -> tuple[Continuation, ...]:
    """Return the parts of a sounding's profile that a model atmosphere continues; those above 20 km without humidity of the sounding too.

    Parameters
    ----------
    sounding : Sounding
        The sounding.
    profile : AirProfile
        Its profile up to 100 km.
    model : str
        The model atmosphere.
    sensor : float, optional
        Height of a sensor [m]; a sounding that ends below it is noted at any height.
    """
    out = []
    whole, humid, top = profile.precipitable_water, sounding.humidity_top, sounding.top
    begins = sounding.humidity_begins
    if begins is not None:
        share = 1.0 - profile.water_above(begins) / whole
        text = f"humidity begins at {begins:.0f} m; below it is the relative humidity of that level, {percent(share)} of the water vapour"
        out.append(Continuation(begins, share, text, below=True))
    if humid < top:
        share = profile.water_above(humid) / whole
        text = f"humidity ends at {1e-3 * humid:.1f} km; above it is that of {model}, {percent(share)} of the water vapour"
        out.append(Continuation(humid, share, text))
    below = sensor is not None and sensor > top
    if top < LOW_TOP or below:
        share = profile.water_above(top) / whole
        where = f", below the sensor at {1e-3 * sensor:.1f} km" if below and sensor is not None else ""
        text = f"the sounding ends at {1e-3 * top:.1f} km{where}; above it is the air of {model}, {percent(share)} of the water vapour"
        out.append(Continuation(top, share, text))
    return tuple(out)
