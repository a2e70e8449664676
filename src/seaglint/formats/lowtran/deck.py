"""One line of sight through one atmosphere as LOWTRAN7's input cards (its file TAPE5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.base.errors import DomainError
from seaglint.base.limits import NAVY_AEROSOL_WIND

#: LOWTRAN7's model atmospheres and their numbers on card 1.
MODELS = {
    "tropical": 1,
    "midlatitude-summer": 2,
    "midlatitude-winter": 3,
    "subarctic-summer": 4,
    "subarctic-winter": 5,
    "us-standard-1976": 6,
}

Haze = Literal[
    "none", "rural-23km", "rural-5km", "navy-maritime", "maritime-23km", "urban", "tropospheric", "advective-fog", "radiative-fog", "desert"
]

#: Boundary-layer aerosols and their numbers on card 2 (IHAZE); 7 is LOWTRAN7's user-defined one.
HAZES: dict[Haze, int] = dict(zip(get_args(Haze), (0, 1, 2, 3, 4, 5, 6, 8, 9, 10), strict=True))

MOST_LEVELS = 33  #: Largest number of levels of a user's profile; LOWTRAN7 has room for 34.

STEP_CM = 5  #: Step of LOWTRAN7's spectral samples [cm-1]; its resolution is 20.


@dataclass(frozen=True)
class Aerosol(HazeWeather):
    """Boundary-layer aerosol (card 2): air mass is ICSTL of the Navy model, which uses both winds; the desert model uses the first."""

    haze: Haze = "navy-maritime"  #: One of ``HAZES``.

    def card(self) -> str:
        """Return card 2. Calm is written as 0.001 m/s, because 0 means "the default wind of the model atmosphere"."""
        if self.haze == "navy-maritime" and max(self.wind, self.wind_24h) > NAVY_AEROSOL_WIND[1]:
            message = (
                f"wind = {max(self.wind, self.wind_24h):g} m/s is above {NAVY_AEROSOL_WIND[1]:g} m/s of the Navy maritime aerosol; "
                "choose a weaker wind or another atmosphere.haze"
            )
            raise DomainError(message, name="wind_speed", value=max(self.wind, self.wind_24h), allowed=NAVY_AEROSOL_WIND)
        # IHAZE, ISEASN, IVULCN, ICSTL, ICLD and IVSA: seasons, volcanoes, clouds and army models are not used.
        numbers = f"{HAZES[self.haze]:5d}{0:5d}{0:5d}{self.air_mass:5d}{0:5d}{0:5d}"
        winds = f"{max(self.wind, 1e-3):10.5f}{max(self.wind_24h, 1e-3):10.5f}"
        return f"{numbers}{self.visibility_km or 0.0:10.3f}{winds}{0.0:10.3f}{0.0:10.3f}"


@dataclass(frozen=True)
class ProfileLevel:
    """One level of a profile: height [km], pressure [hPa], temperature [K], relative humidity [%]; all but the height None: the model's."""

    height_km: float
    pressure_hpa: float | None = None
    temperature_k: float | None = None
    relative_humidity: float | None = None

    def card(self, model: int) -> str:
        """Return card 2C1; all gases but water vapour are taken from model atmosphere ``model``."""
        if self.pressure_hpa is None:
            return f"{self.height_km:10.5f}" + f"{0.0:10.3E}" * 5 + f"{model:d}" * 14
        # Nine digits in ten columns: the format E10.3 of the card takes more digits than it prints.
        fields = (f"{value:10.7g}" for value in (self.pressure_hpa, self.temperature_k, self.relative_humidity))
        numbers = "".join(_with_point(field) for field in fields)
        return f"{self.height_km:10.5f}{numbers}" + f"{0.0:10.3E}" * 2 + "AAH" + f"{model:d}" * 11


def _with_point(field: str) -> str:
    """Return a number with a decimal point, since a Fortran E format reads one without it as thousandths."""
    digits, e, power = field.strip().partition("e")
    return f"{digits if '.' in digits else digits + '.'}{e}{power}".rjust(10)


@dataclass(frozen=True)
class LowtranAir:
    """Properties shared by all lines of sight of an atmosphere: model or profile, aerosol, spectral range [cm-1]."""

    model: str
    aerosol: Aerosol
    v1: int
    v2: int
    levels: tuple[ProfileLevel, ...] = ()

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise DomainError(
                f"model = {self.model!r} is not one of {', '.join(MODELS)}", name="model", value=self.model, allowed=", ".join(MODELS)
            )
        if len(self.levels) > MOST_LEVELS:
            raise DomainError(f"a profile of {len(self.levels)} levels is beyond the {MOST_LEVELS} that LOWTRAN7 takes; thin it out")

    @property
    def samples(self) -> int:
        """Return the number of spectral samples."""
        return (self.v2 - self.v1) // STEP_CM + 1


@dataclass(frozen=True)
class LowtranCase:
    """A line of sight: from ``height_km`` at ``zenith_deg``, down to the sea or to ``end_km``, up to space, or up to the Sun.

    Where ``arc_deg``, the angle at the Earth's centre, is given, the zenith angle is not: LOWTRAN7 finds the ray between both ends.
    With ``sun``, its azimuth from the line of sight and its zenith angle at the sensor without refraction [deg], sunlight that the air
    scatters once into a path or sky is computed too; ``multiple`` adds LOWTRAN7's estimate of multiply scattered light.
    """

    air: LowtranAir
    kind: Literal["path", "sky", "sun"]
    height_km: float
    zenith_deg: float
    end_km: float = 0.0
    arc_deg: float = 0.0
    sun: tuple[float, float] | None = None
    multiple: bool = False

    def deck(self) -> str:
        """Return the cards 1 to 5.

        IEMSCT is 1 (thermal radiance), 2 (scattered sunlight besides, Mie phase functions, IDAY = 93) or 3 (transmitted sunlight,
        IDAY = 0: 1 au), ITYPE 2 (to H2, 0 the sea) or 3 (to space); TBOUND = 0.001 K, so that the sea adds nothing.
        """
        air, profile = self.air, self.air.levels
        iemsct = 3 if self.kind == "sun" else 1 if self.sun is None else 2
        itype = 2 if self.kind == "path" else 3
        number = MODELS[air.model]
        card1 = (
            f"{7 if profile else number:5d}{itype:5d}{iemsct:5d}{int(self.multiple):5d}"
            + f"{0:5d}" * 7
            + f"{1 if profile else 0:5d}{0:5d}   0.001   0.00"
        )
        lines = [card1, air.aerosol.card()]
        if profile:
            lines += [f"{len(profile):5d}{0:5d}{0:5d}sounding", *(level.card(number) for level in profile)]
        # Heights and angles fill their ten columns, cut and not rounded, so that no digit is lost.
        end = f"{self.end_km:10.8f}"[:10] if self.end_km else f"{0.0:10.3f}"
        between = f"{0.0:10.3f}" + f"{self.arc_deg:10.8f}"[:10] if self.arc_deg else ""
        lines.append(f"{self.height_km:10.8f}"[:10] + end + f"{self.zenith_deg:10.7f}"[:10] + between)
        if self.sun is not None:
            lines += ["    2    2   93    0", "".join(f"{angle:10.7f}"[:10] for angle in self.sun)]
        lines.append(f"{air.v1:10.1f}{air.v2:10.1f}{STEP_CM:10.1f}")
        return "\n".join((*lines, f"{0:5d}", ""))
