"""Light of foam on a facet, for kernels, and the share of the sea that is foam, for means.

By the law of ``seaglint.optics.foam_reflectance`` foam is water of which a share is replaced by bubbles: what mirrors in it are the facets
of the sea beside it, with their slopes, sky and glint. So a place whose share of foam is F has

    L = (1 - F) water + F foam,    foam = (1 - b) water + bubbles

and the bubbles' light depends on the path alone: a blackbody at the sea's temperature, less their diffuse reflectance, with which they
reflect the mean sky and the Sun. Foam's emission and reflected sky are therefore correct for every slope for which the water's are.

The bubbles' light is computed in ``seaglint.facet.foam_light``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.errors import DomainError
from seaglint.base.jit import kernel
from seaglint.facet.sunlight import Sunlight
from seaglint.optics.foam_reflectance import BUBBLES


@dataclass(frozen=True)
class FoamCover:
    """Foam on the sea of a view, for means."""

    share: float  #: Mean share of the sea's visible area that is foam [1].

    def __post_init__(self) -> None:
        if not 0.0 <= self.share <= 1.0:
            raise DomainError(
                f"share of foam = {self.share:g} is outside 0..1; give the part of the sea's area that is foam, e.g. 0.01",
                name="foam_share",
                value=self.share,
                allowed=(0.0, 1.0),
            )

    @property
    def bubbles(self) -> float:
        """Share of the sea that is bubbles [1]."""
        return BUBBLES * self.share

    @property
    def mirroring(self) -> float:
        """Share of the sea that mirrors like water [1]: the water, and the part of the foam that is not bubbles."""
        return 1.0 - self.bubbles


class FoamTables(NamedTuple):
    """Light of foam's bubbles at the places of a path, through it [W m-2 sr-1, (m,)]; empty for a sea without foam.

    ``mirroring``: share of foam that mirrors like water [1]. ``emitted``: the bubbles' emission; ``sky``: the sky that they reflect,
    thermal and scattered sunlight; ``sun``: sunlight of a whole disc at normal incidence that they reflect, Sun at the sensor's foot.
    """

    mirroring: float
    emitted: np.ndarray
    sky: np.ndarray
    sun: np.ndarray


NO_FOAM: Final = FoamTables(1.0, np.zeros(0), np.zeros(0), np.zeros(0))  #: Tables of a sea without foam.


@kernel
def _at(values: np.ndarray, at: tuple[int, float]) -> float:
    """Value between two places of the path; ``at`` as for ``facet_thermal``."""
    i, f = at
    if f == 0.0:
        return float(values[i])
    return float(values[i] + f * (values[i + 1] - values[i]))


@kernel
def foam_thermal(foam: FoamTables, at: tuple[int, float], warm: float) -> float:
    """Emission and reflected sky of a facet of foam [W m-2 sr-1]; ``warm`` is the same of water, of ``facet_thermal``, at the same facet.

    ``at``: row of the path and the fraction of the step to the next one.
    """
    return foam.mirroring * warm + _at(foam.emitted, at) + _at(foam.sky, at)


@kernel
def foam_emission(foam: FoamTables, at: tuple[int, float], emitted: float) -> float:
    """Emission alone of a facet of foam [W m-2 sr-1], ``emitted`` the emission alone of water; arguments as of ``foam_thermal``."""
    return foam.mirroring * emitted + _at(foam.emitted, at)


@kernel
def mixed_light(foam: FoamTables, at: tuple[int, float], share: float, warm: float, glint: float, bubbles: float) -> tuple[float, float]:
    """Emission and reflected sky, and reflected sunlight of a place with a share of foam [W m-2 sr-1].

    ``warm``: emission and reflected sky of its water; ``glint``: Sun that its water mirrors; ``bubbles``: ``foam_sunlight`` at the place.
    """
    return (1.0 - share) * warm + share * foam_thermal(foam, at, warm), mirroring_share(foam, share) * glint + share * bubbles


@kernel
def mirroring_share(foam: FoamTables, share: float) -> float:
    """Share of a place with a share of foam that mirrors like water [1]."""
    return 1.0 - share * (1.0 - foam.mirroring)


@kernel
def foam_sunlight(foam: FoamTables, at: tuple[int, float], sun: Sunlight, slope: tuple[float, float]) -> float:
    """Sunlight that foam on a facet of slope ``slope`` (east, north) reflects diffusely [W m-2 sr-1], of a whole disc at the place.

    To it is added ``foam.mirroring`` times the water's glint. ``sun`` is the Sun at the place; the visible share of its disc, the shadow of
    waves and ``strength_kernel`` are factors of the caller, as for ``facet_sunlight``.
    """
    if not sun.shining:
        return 0.0
    # cosine of incidence on the tilted facet, whose normal is (-s_east, -s_north, 1) over its length
    rise = sun.up - sun.east * slope[0] - sun.north * slope[1]
    if rise <= 0.0:
        return 0.0
    return _at(foam.sun, at) * rise / math.sqrt(1.0 + slope[0] * slope[0] + slope[1] * slope[1])
