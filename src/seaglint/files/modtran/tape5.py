"""Decks (``tape5``) of LOWTRAN7 and of MODTRAN 4 and 5: one case for each line of sight, all in one file (IRPT = 1).

Card layouts: LOWTRAN7's READ statements; MODTRAN's from its user's manual as public decks show it (GeoscienceAustralia/wagl,
``gaip/modtran_profiles.py``). Cards 2, 2C, 3, 3A1, 3A2 and 5 stand in the same columns in both; MODTRAN adds to card 1 its first five
columns, card 1A, and FWHM to card 4.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from seaglint.files.lowtran.deck import MODELS, STEP_CM, LowtranAir
from seaglint.files.modtran.lines import ModtranCase

FWHM_CM: Final = 20  #: Width of MODTRAN's slit function [cm-1], which is LOWTRAN7's resolution.

LOWTRAN7_CO2_PPMV: Final = 330.0  #: Carbon dioxide of LOWTRAN7's models [1e-6 of the volume].

AT_1_AU: Final = 93  #: Day of the year on which both programs take the Sun's mean distance (IDAY).

#: Temperature of the boundary (TBOUND, TPTEMP) [K]: the sea adds nothing, and 0 would mean that of the lowest air.
LEAST_BOUNDARY_TEMPERATURE: Final = "   0.001"


def deck(
    lines: Sequence[ModtranCase], air: LowtranAir, solar_zenith_deg: float | None, *, modtran: bool, co2_ppmv: float = LOWTRAN7_CO2_PPMV
) -> str:
    """Return the text of a deck with a case for each line; LOWTRAN7 has 330 ppmv of carbon dioxide, whatever ``co2_ppmv`` is."""
    cases = []
    for i, line in enumerate(lines):
        cards = [*_cards(line, air, solar_zenith_deg, co2_ppmv if modtran else None), f"{int(i + 1 < len(lines)):5d}"]
        cases.append("\n".join(cards))
    return "\n".join(cases) + "\n"


def _cards(line: ModtranCase, air: LowtranAir, solar_zenith_deg: float | None, co2_ppmv: float | None) -> Iterator[str]:
    modtran = co2_ppmv is not None
    lit = line.azimuth_deg is not None and solar_zenith_deg is not None
    mode = 3 if line.kind == "sun" else 2 if lit else 1
    kind, profile = (2 if line.kind == "path" else 3), air.levels
    model = 7 if profile else MODELS[air.model]
    between = f"{kind:5d}{mode:5d}" + f"{0:5d}" * 8 + f"{1 if profile else 0:5d}{0:5d}{LEAST_BOUNDARY_TEMPERATURE}"
    if modtran:
        # MODTRN = T, SPEED = M (slow), no correlated k; SURREF = 0.
        yield f"TM{model:3d}{between}{'0.00':>7}"
        yield f"FF{2:3d}{0:5d}{co2_ppmv:10.3f}{'0':>10}{'0':>10} F F F F F{0.0:10.3f}"
    else:
        yield f"{model:5d}{between}{'0.00':>7}"
    yield air.aerosol.card()
    if profile:
        yield f"{len(profile):5d}{0:5d}{0:5d}sounding"
        yield from (level.card(MODELS[air.model]) for level in profile)
    card3 = fixed(line.height_m / 1e3) + fixed(0.0) + fixed(line.zenith_deg)
    yield card3 + (f"{AT_1_AU:5d}" if mode == 3 else "")
    if mode == 2:
        # IPARM = 2: azimuth of the Sun from the line of sight, and its zenith angle, at H1; IPH = 2: Mie phase functions.
        yield f"{2:5d}{2:5d}{AT_1_AU:5d}{0:5d}"
        yield fixed(line.azimuth_deg or 0.0) + fixed(solar_zenith_deg or 0.0)
    grid = f"{air.v1:10.1f}{air.v2:10.1f}{STEP_CM:10.1f}"
    yield grid + (f"{FWHM_CM:10.1f}RW" if modtran else "")


def fixed(value: float) -> str:
    """Return a number in ten columns, the first blank, with as many decimals as fit; its point overrules the format's.

    >>> fixed(0.03), fixed(101.2345678901), fixed(90.1653187)
    (' 0.0300000', ' 101.23457', ' 90.165319')
    """
    return f"{value:10.{7 if value < 10.0 else 6 if value < 100.0 else 5}f}"
