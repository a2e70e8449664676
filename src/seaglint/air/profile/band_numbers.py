r"""Numbers of the band laws: LOWTRAN7's own, or those whose bands agree with LBLRTM. Whoever sums them does not know which.

The second ones have LOWTRAN7's form and its shape within bands. In each band of RRTMGP's, a gas that RRTMGP holds there has

.. math:: d = F (C/C_0)^s (C_0 W)^a

with LOWTRAN7's coefficients :math:`C`, their mean :math:`C_0` over the band, its power as :math:`s`, and a factor :math:`F`, a power
:math:`a` and exponents of pressure and temperature of its own; continua have factors. Other gases, and all beyond 3350 cm-1, are
LOWTRAN7's; between 3250 and 3350 cm-1 the depths are weighted sums of both.

References
----------
Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177. Pincus, R., E. J. Mlawer and J. S. Delamere (2019), Balancing
accuracy, efficiency, and flexibility in radiation calculations for dynamical models, J. Adv. Model. Earth Syst. 11, 3074-3089; the fit:
``tools/fit_lblrtm.py``.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.absorber_densities import LOWTRAN_SCALED
from seaglint.air.profile.lowtran_numbers import lowtran_numbers, numbers_provenance
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject

Spectroscopy = Literal["lblrtm", "lowtran7"]

FILE: Final = "lblrtm_bands.csv"

GASES: Final = ("H2O", "CO2", "O3", "N2O", "CO", "CH4")  #: Gases of the file in the order of LOWTRAN7's rows of bands.

#: Rows of the continua that have a factor in the file.
CONTINUA: Final = {"N2": (1,), "H2O-self": (2,), "H2O-self-cold": (3,), "H2O-air": (4,), "O2": (7, 8, 9)}

#: Temperature [K] of the law by which LBLRTM's continuum of water by itself grows in cold air, ``exp(1800 K / T)``.
SELF_KELVIN: Final = 1800.0

FIRST_COLUMN: Final = 101  #: Number of the first scaled amount of the file; LOWTRAN7's own are below.

MORE_ROWS: Final = 2  #: Rows beside LOWTRAN7's: second terms of a gas, and LOWTRAN7's own where one goes over into the other.

HIGHEST, JOINED = 3250.0, 3350.0  #: Wavenumbers [cm-1] up to which the file goes, and from which on the numbers are LOWTRAN7's.


@dataclass(frozen=True, eq=False)
class BandNumbers:
    """Band laws on the channels of LOWTRAN7's file."""

    continuum: FloatArray  #: Coefficients of the amounts 6, 4, 5, 9, 10, 11, 8, 63, 1, 2 [(10, n)].
    #: ``column``, ``power``, ``log_coefficient``: Rows of bands: number of the scaled amount (0: no band), its power, logarithm of the
    #: depth of amount 1; (rows, n).
    column: NDArray[np.int64]
    power: FloatArray
    log_coefficient: FloatArray
    #: Gas and exponents of relative pressure and of 273.15 K / T of each scaled amount, by number.
    scaled: Mapping[int, tuple[str, float, float]]
    #: Temperature of the law by which water's own continuum grows in cold air [K]; 0 for LOWTRAN7's, linear from 296 down to 260 K. One law
    #: serves all channels of a sum: see :meth:`cold_law`.
    cold_kelvin: float
    provenance: JsonObject  #: Where the numbers are from.

    def cold_law(self, wavenumber_cm: FloatArray) -> float:
        """Return :attr:`cold_kelvin` for some channels [K]: LOWTRAN7's where all numbers are its own."""
        return 0.0 if wavenumber_cm[0] >= JOINED else self.cold_kelvin


@lru_cache(maxsize=2)
def band_numbers(spectroscopy: Spectroscopy) -> BandNumbers:
    """Return the numbers of a spectroscopy; read once a process, read-only.

    Raises
    ------
    DataError
        If a file in the package is missing or damaged.
    """
    held = lowtran_numbers()
    column, power = held["band_column"].astype(np.int64), held["band_power"]
    own = BandNumbers(
        held["continuum"],
        column,
        power,
        np.log(10.0) * power * held["band_log10"],
        LOWTRAN_SCALED,
        0.0,
        {**numbers_provenance(), "spectroscopy": "lowtran7"},
    )
    return own if spectroscopy == "lowtran7" else _refitted(own, held["wavenumber_cm"])


def _refitted(own: BandNumbers, nu: FloatArray) -> BandNumbers:
    """Put the numbers of the file in the place of LOWTRAN7's."""
    try:
        content = resources.files("seaglint.air").joinpath("data", FILE).read_bytes()
        lines = [line for line in content.decode("utf-8").splitlines() if not line.startswith("#")]
        rows = [(row["term"], int(row["from_cm"]), int(row["to_cm"]), row) for row in csv.DictReader(lines)]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise DataError(f"the band laws {FILE} in the package are damaged ({error}); install seaglint again") from error
    continuum, scaled = own.continuum.copy(), dict(own.scaled)
    column, power, log = (
        np.concatenate([a, np.zeros((MORE_ROWS, nu.size), a.dtype)]) for a in (own.column, own.power, own.log_coefficient)
    )
    lowest, highest = min(low for _, low, _, _ in rows), max(high for _, _, high, _ in rows)
    for term, low, high, row in rows:
        # the lowest numbers serve down to the first channel, the highest ones through the join
        inside = (nu >= (low if low > lowest else 0.0)) & (nu < (high if high < highest else JOINED))
        joined = np.clip((nu[inside] - HIGHEST) / (JOINED - HIGHEST), 0.0, 1.0)
        factor = float(row["factor"])
        if term in CONTINUA:
            for linear in CONTINUA[term]:
                continuum[linear, inside] *= factor * (1.0 - joined) + joined
            continue
        gas = GASES.index(term)
        held = own.column[gas, inside] > 0
        here, joined = np.flatnonzero(inside)[held], joined[held]
        number = FIRST_COLUMN + len(scaled) - len(own.scaled)
        scaled[number] = (term, float(row["pressure_exponent"]), float(row["temperature_exponent"]))
        a, s = float(row["power"]), float(row["contrast"])
        log_c = own.log_coefficient[gas, here] / own.power[gas, here]
        band = (nu[here] >= low) & (nu[here] <= high)
        mean = float(np.log(np.mean(np.exp(log_c[band]))))
        second = bool((column[gas, here] >= FIRST_COLUMN).any())
        at = _free_row(column, own.column.shape[0], here) if second else gas
        column[at, here], power[at, here] = number, a
        log[at, here] = np.log(factor) + s * (log_c - mean) + a * mean + np.log(1.0 - joined)
        over = here[joined > 0.0]  # both depths, weighted, so that nothing jumps in any air
        if over.size:
            at = _free_row(column, own.column.shape[0], over)
            column[at, over], power[at, over] = own.column[gas, over], own.power[gas, over]
            log[at, over] = own.log_coefficient[gas, over] + np.log(joined[joined > 0.0])
    for array in (continuum, column, power, log):
        array.flags.writeable = False
    source: JsonObject = {
        **own.provenance,
        "spectroscopy": "lblrtm",
        "bands": "RRTMGP's long-wave k-distributions of LBLRTM (RTE+RRTMGP), fitted by tools/fit_lblrtm.py",
        "bands_sha256": hashlib.sha256(content).hexdigest(),
    }
    return BandNumbers(continuum, column, power, log, scaled, SELF_KELVIN, source)


def _free_row(column: NDArray[np.int64], first: int, here: NDArray[np.intp]) -> int:
    """Return the first of the further rows that has no band on some channels."""
    return next(row for row in range(first, column.shape[0]) if not column[row, here].any())
