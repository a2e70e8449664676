"""Ranges of validity that both physics and scenario files check, each defined here once.

They are plain numbers, so that reading them loads no other package. Ranges of a single model are in the file of that model.
"""

from __future__ import annotations

import math
from typing import Final

#: Wind speeds at 10 m for which the roughness law of the sea is evaluated [m/s]; far wider than the data behind it.
WIND_PROFILE: Final = (0.0, 40.0)

#: Winds at 10 m for which Elfouhaily's spectrum is evaluated [m/s]; the data behind it are of 2-24 m/s.
ELFOUHAILY_WIND: Final = (0.5, 30.0)

COX_MUNK_WIND: Final = (0.0, 20.0)  #: Wind speeds for which Cox and Munk's fits of a clean sea are used without ``extrapolate`` [m/s].

#: Wind speeds for which Cox and Munk's fit of a slick sea is used without ``extrapolate`` [m/s]: the winds of all their photographs.
#:
#: Stronger winds break the slick.
COX_MUNK_SLICK_WIND: Final = (0.0, 14.0)

#: Winds at 10 m for which Bréon and Henriot's fit is used without ``extrapolate`` [m/s].
#:
#: The limit is a choice: c21 grows with the square of the wind, and the mass added where the series turns negative is 8e-5 at 15 m/s and
#: 1.8e-3 at 20 m/s.
BREON_HENRIOT_WIND: Final = (0.0, 15.0)

#: Winds at 10 m of the measurements behind the laws of foam coverage, by the name of the law [m/s].
#:
#: A tenth of Monahan's observations are between 12 and 17 m/s. Callaghan's law begins at 3.7 m/s, below which it has no foam; satellites
#: give none below 2 m/s.
FOAM_WINDS: Final = {
    "monahan-1980": (0.0, 17.0),
    "monahan-1980-robust": (0.0, 17.0),
    "callaghan-2008": (0.0, 23.09),
    "salisbury-2013": (2.0, 20.0),
}

#: Winds of the Navy maritime aerosol, and of the air tables made with it [m/s]; LOWTRAN7 silently takes any stronger wind for 20 m/s.
NAVY_AEROSOL_WIND: Final = (0.0, 20.0)

#: Largest rms jitter of a line of sight: the greater of a share of the picture's smaller side and a number of pixels.
#:
#: With more jitter, blur takes most of the light of a picture from outside the picture, where the scene is unknown.
SHAKEN: Final = (0.25, 16.0)

SMEARED: Final = 64.0  #: Largest drift of a line of sight in an exposure for pictures with a shorter side [pixels].

TABLE_HEIGHTS: Final = (2.0, 10_000.0)  #: Sensor heights that the air tables cover [m].

TABLE_BANDS_UM: Final = ((2.0, 5.5), (7.5, 14.0))  #: Wavelengths that the air tables cover [um]; a band lies inside one of them.

LOWTRAN_HEIGHTS: Final = (0.01, 50_000.0)  #: Sensor heights for which LOWTRAN7 is run [m]: the valid range of the geometry.

#: Height above which there is no air [m]: the top of the model atmospheres, and the greatest height of a sensor.
TOP_OF_AIR: Final = 100_000.0

PROFILE_HEIGHTS: Final = (0.01, TOP_OF_AIR)  #: Sensor heights for air from a profile [m].

#: Wavelengths for which LOWTRAN7's program is run [um]: its bands end at 50 000 cm-1, its Navy aerosol at 250 cm-1.
LOWTRAN_BAND_UM: Final = (0.2, 28.0)

PROFILE_BAND_UM: Final = (0.7, 14.7)  #: Wavelengths of the band laws for air from a profile [um].

WIDEST_PINHOLE_DEG: Final = 170.0  #: Largest field of view of a plane image [deg]; at 180 deg the image would be infinite.

MOST_SPEED: Final = 1000.0  #: Largest speed between two keyframes [m/s]; a higher one is probably a mistyped number.

MOST_TURN: Final = math.radians(720.0)  #: Largest rate of any angle between two keyframes [rad/s]: two turns a second.
