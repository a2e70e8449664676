"""Table ``[sea.slopes]``: kinds of slope statistics, one record each."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, StrictBool

from seaglint.base.limits import BREON_HENRIOT_WIND, COX_MUNK_SLICK_WIND, COX_MUNK_WIND
from seaglint.scenario.records.record import Record, default_tag

Range = tuple[float, float]


class CoxMunkIsotropic(Record):
    """Cox and Munk 1954, clean sea, the same variance in all directions."""

    winds: ClassVar[Range] = COX_MUNK_WIND
    kind: Literal["cox-munk-isotropic"] = "cox-munk-isotropic"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class CoxMunkAnisotropic(Record):
    """Cox and Munk 1954, clean sea, upwind and crosswind variances."""

    winds: ClassVar[Range] = COX_MUNK_WIND
    kind: Literal["cox-munk-anisotropic"] = "cox-munk-anisotropic"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class CoxMunkGramCharlier(Record):
    """Cox and Munk 1954, clean sea, with skewness (steep lee faces) and peakedness."""

    winds: ClassVar[Range] = COX_MUNK_WIND
    kind: Literal["cox-munk-gram-charlier"] = "cox-munk-gram-charlier"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class CoxMunkSlick(Record):
    """Cox and Munk 1954, sea under an oil slick; up to 14 m/s."""

    winds: ClassVar[Range] = COX_MUNK_SLICK_WIND
    kind: Literal["cox-munk-slick"] = "cox-munk-slick"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class BreonHenriot(Record):
    """Breon and Henriot 2006, open ocean seen from a satellite, with skewness and peakedness; up to 15 m/s."""

    winds: ClassVar[Range] = BREON_HENRIOT_WIND
    kind: Literal["breon-henriot"] = "breon-henriot"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class SpectrumSlopes(Record):
    """Gaussian slopes with the variances of sea.spectrum, all its waves."""

    kind: Literal["spectrum"] = "spectrum"


class FlatSlopes(Record):
    """A mirror: no slopes."""

    kind: Literal["flat"] = "flat"


Slopes = Annotated[
    Annotated[
        CoxMunkIsotropic | CoxMunkAnisotropic | CoxMunkGramCharlier | CoxMunkSlick | BreonHenriot | SpectrumSlopes | FlatSlopes,
        Field(discriminator="kind"),
    ],
    default_tag("kind", "cox-munk-anisotropic"),
]
