"""Temperature of the air over the water of a scenario, and the share of a contrast that the air transmits."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.profile.profile_atmosphere import ProfileAtmosphere
from seaglint.base.conventions import surface_range
from seaglint.base.errors import SeaglintError
from seaglint.base.free_form import JsonObject
from seaglint.facet.sea_view import BandSum
from seaglint.formats.soundings.air_summary import REFERENCE_HEIGHT
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.scenario.records import atmosphere_table as requested_air
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.profile_air import ComputedAir

if TYPE_CHECKING:
    from collections.abc import Sequence

    from seaglint.air.protocol import Atmosphere
    from seaglint.scenario.model import Scenario

RANGES: Final = (2_000.0, 5_000.0, 10_000.0)  #: Ranges of which the contrast is stated before a range is searched [m].

BEYOND: Final = 5_000.0  #: Range without objects and with no sea in the middle of the picture [m].

_STEP: Final = 0.5  #: Half of the temperature difference whose contrast is taken [K].


@dataclass(frozen=True)
class AirContrast:
    """Air over the water, and the share of a contrast that it transmits."""

    air_k: float  #: Temperature of the air at 10 m [K].
    water_k: float  #: Temperature of the water [K].
    air_minus_water_k: float  #: Their difference [K].
    ranges_m: tuple[float, ...]  #: Distances along the sea [m].
    #: Share of the in-band contrast between two bodies of about the water's temperature that the air leaves there [1].
    contrast_left: tuple[float, ...]
    place: str  #: Object or sea at those distances; empty if the distances were given.
    air_stated: bool  #: Whether the scenario states the air's temperature: ``air_minus_sea_k``, a sounding, an isothermal air.
    water_stated: bool  #: Whether the scenario states the water's temperature.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self) | {"ranges_m": list(self.ranges_m), "contrast_left": list(self.contrast_left)}

    @property
    def line(self) -> str | None:
        """Sentence for people; None where both temperatures are stated.

        Examples
        --------
        >>> print(AirContrast(294.2, 288.15, 6.05, (5000.0,), (0.4,), "boat", False, True).line)
        air at 10 m 294.2 K, 6.0 K above the water; it leaves 40 % of a contrast at 5 km (boat); to state it: atmosphere.air_minus_sea_k
        """
        assumed_keys = [
            key for key, stated in (("atmosphere.air_minus_sea_k", self.air_stated), ("sea.temperature_k", self.water_stated)) if not stated
        ]
        if not assumed_keys:
            return None
        difference = self.air_minus_water_k
        above = f"{abs(difference):.1f} K {'above' if difference >= 0.0 else 'below'} the water"
        shares = ", ".join(f"{100.0 * share:.2g} %" for share in self.contrast_left)
        ranges = ", ".join(f"{1e-3 * at:.2g}" for at in self.ranges_m)
        place = f" ({self.place})" if self.place else ""
        pronoun = "it" if len(assumed_keys) == 1 else "them"
        return (
            f"air at 10 m {self.air_k:.1f} K, {above}; it leaves {shares} of a contrast at {ranges} km{place}; "
            f"to state {pronoun}: {' and '.join(assumed_keys)}"
        )


def air_contrast(scenario: Scenario, ranges: Sequence[float] | None = None) -> AirContrast | None:
    """Return the air over the water of a scenario, and the share of a contrast that it leaves.

    Parameters
    ----------
    scenario : Scenario
        With its band, sensor and air.
    ranges : sequence of float, optional
        Distances along the sea [m]; by default the distance of the nearest object, or of the sea in the middle of the picture, or
        ``BEYOND`` if the middle shows no sea.

    Returns
    -------
    AirContrast or None
        None where the temperature of the air is not known: air of a file, of the Fortran program, or none.

    Notes
    -----
    The share applies to a small difference of temperature at the water's temperature: it is the transmittance, weighted over the band by
    its response times the slope of Planck's law.
    """
    height = scenario_physics.track(scenario).at(0.0).height
    if not isinstance(scenario.atmosphere, ComputedAir | requested_air.IsothermalAtmosphereSettings):
        return None
    band = scenario_physics.band(scenario)
    air = scenario_physics.atmosphere(scenario, band)
    kelvin = _kelvin(air)
    if kelvin is None:
        return None
    place, at = ("", tuple(ranges)) if ranges is not None else _distance(scenario, height)
    over, water = BandSum.of(band, air), scenario.sea.temperature_k
    # The slope of Planck's law, as the difference over one kelvin.
    warm, cold = (planck_wavenumber(over.wavenumber_cm, water + step) for step in (_STEP, -_STEP))
    weights = over.weights * (warm - cold)
    left = np.clip(air.transmittance(height, np.asarray(at), 0.0), 0.0, 1.0)[..., over.grid] @ weights / weights.sum()
    return AirContrast(
        air_k=kelvin,
        water_k=water,
        air_minus_water_k=kelvin - water,
        ranges_m=at,
        contrast_left=tuple(float(share) for share in left),
        place=place,
        air_stated=_states_air(scenario),
        water_stated="temperature_k" in scenario.sea.model_fields_set,
    )


def air_line(scenario: Scenario, ranges: Sequence[float] | None = None) -> str | None:
    """Return the sentence of ``air_contrast``; None where both temperatures are stated, or the air's is not known.

    It is None also for a scenario that a model refuses: the computation that follows reports the reason.
    """
    try:
        contrast = air_contrast(scenario, ranges)
    except SeaglintError:
        return None
    return None if contrast is None else contrast.line


def _states_air(scenario: Scenario) -> bool:
    """Return whether a scenario states the temperature of its air: a model atmosphere has that of a climate, whatever the water."""
    match scenario.atmosphere:
        case requested_air.LowtranAtmosphere(sounding=sounding, air_minus_sea_k=difference):
            return sounding is not None or difference is not None
        case requested_air.TableAtmosphereSettings(air_minus_sea_k=difference):
            return difference is not None
        case _:
            return True


def _kelvin(air: Atmosphere) -> float | None:
    """Return the temperature of air at 10 m [K]; None where it is not known."""
    match air:
        case ProfileAtmosphere():
            profile = air.sums.profile
            return float(np.interp(REFERENCE_HEIGHT, profile.height, profile.temperature))
        case IsothermalAtmosphere():
            return air.temperature
        case _:
            return None


def _distance(scenario: Scenario, height: float) -> tuple[str, tuple[float, ...]]:
    """Return the distance of the nearest object whose place is stated in metres, else of the sea in the middle of the picture, else one."""
    if placed := [item for item in scenario.objects or () if item.east_m is not None or item.north_m is not None]:
        far = [math.hypot(item.east_m or 0.0, item.north_m or 0.0) for item in placed]
        nearest = int(np.argmin(far))
        return placed[nearest].name, (far[nearest],)
    middle = float(surface_range(height, -math.radians(scenario.sensor.elevation_deg)))
    if math.isfinite(middle):
        return "the sea in the middle of the picture", (middle,)
    return "the middle of the picture sees no sea", (BEYOND,)
