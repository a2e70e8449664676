r"""Optical depth of absorber amounts in channels by continua and band laws of LOWTRAN7's form, and gases that replace a profile's.

.. math:: d(\nu) = \sum_k c_k(\nu) W_k + \sum_b (C_b(\nu) W_b)^{a_b}

Lines of a band saturate (``a_b < 1``): the depth of a path follows from its whole amounts, not from a sum over its parts.

**Numbers.** They are LOWTRAN7's own, or numbers with which the bands agree with LBLRTM; the sums do not depend on the choice. The second
ones have LOWTRAN7's form and its shape within bands. In each band of RRTMGP's, a gas that RRTMGP holds there has

.. math:: d = F (C/C_0)^s (C_0 W)^a

with LOWTRAN7's coefficients :math:`C`, their mean :math:`C_0` over the band, the power :math:`s` of their contrast, and a factor :math:`F`,
a power :math:`a` and exponents of pressure and temperature for this band; continua have factors. Other gases, and all gases beyond 3350
cm-1, are LOWTRAN7's; between 3250 and 3350 cm-1 the depths are weighted sums of both.

References
----------
Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177. Pincus, R., E. J. Mlawer and J. S. Delamere (2019), Balancing
accuracy, efficiency, and flexibility in radiation calculations for dynamical models, J. Adv. Model. Earth Syst. 11, 3074-3089; the fit:
``tools/fit_lblrtm.py``. Pierluissi, J. H., and C. E. Maragoudakis (1986), AFGL-TR-86-0272; LOWTRAN7's subroutines TRANS, DBLTX and O2CONT.
Lan, X., P. Tans and K. W. Thoning, Trends in globally-averaged CO2, NOAA Global Monitoring Laboratory: 424.6 ppmv at Mauna Loa in 2024.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib import resources
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.absorber_densities import LOWTRAN_SCALED
from seaglint.air.profile.air_profile import GASES, AirProfile, air_molecules, channels_of, lowtran_numbers, numbers_provenance, sum_between
from seaglint.air.scattering.gas_bands import CONTINUA, DEEPEST, GasBands
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject

Spectroscopy = Literal["lblrtm", "lowtran7"]

FILE: Final = "lblrtm_bands.csv"

BAND_GASES: Final = ("H2O", "CO2", "O3", "N2O", "CO", "CH4")  #: Gases of the file in the order of LOWTRAN7's rows of bands.

#: Rows of the continua that have a factor in the file.
CONTINUUM_TERMS: Final = {"N2": (1,), "H2O-self": (2,), "H2O-self-cold": (3,), "H2O-air": (4,), "O2": (7, 8, 9)}

#: Temperature [K] of the law by which LBLRTM's continuum of water by itself grows in cold air, ``exp(1800 K / T)``.
SELF_KELVIN: Final = 1800.0

FIRST_COLUMN: Final = 101  #: Number of the first scaled amount of the file; LOWTRAN7's own are below.

EXTRA_ROWS: Final = 2  #: Rows in addition to LOWTRAN7's: second terms of a gas, and LOWTRAN7's own terms in the join of both.

FITTED_UP_TO, LOWTRAN_FROM = (
    3250.0,
    3350.0,
)  #: Wavenumbers [cm-1] up to which the file reaches, and from which on the numbers are LOWTRAN7's.

#: LOWTRAN7's numbers of all absorbers linear in the amount: the absorbers of scattered light, and O2.
LINEAR: Final = (*CONTINUA, 63, 1, 2)

TODAY_CO2_PPMV: Final = 425.0  #: Carbon dioxide of today [1e-6 of the volume of dry air]; LOWTRAN7's models have 330.

_DOBSON: Final = 2.6867e16  #: Molecules per cm2 of 1 Dobson unit.

GRAM_PER_HPA: Final = 216.68  #: Water vapour of 1 hPa at 1 K [g m-3].


@dataclass(frozen=True, eq=False)
class BandNumbers:
    """Band laws on the channels of LOWTRAN7's file."""

    continuum: FloatArray  #: Coefficients of the amounts 6, 4, 5, 9, 10, 11, 8, 63, 1, 2 [(10, n)].
    column: NDArray[np.int64]  #: Rows of bands: number of the scaled amount, 0 without a band [(rows, n)].
    power: FloatArray  #: Their power of the scaled amount [1, (rows, n)].
    log_coefficient: FloatArray  #: Their logarithm of the depth of amount 1 [1, (rows, n)].
    #: Gas and exponents of relative pressure and of 273.15 K / T of each scaled amount, by number.
    scaled: Mapping[int, tuple[str, float, float]]
    #: Temperature of the law by which water's own continuum grows in cold air [K]; 0 for LOWTRAN7's, linear from 296 down to 260 K. One law
    #: serves all channels of a sum: see ``cold_law``.
    cold_kelvin: float
    provenance: JsonObject  #: Where the numbers are from.

    def cold_law(self, wavenumber_cm: FloatArray) -> float:
        """Return ``cold_kelvin`` for some channels [K]: LOWTRAN7's where all numbers are its own."""
        return 0.0 if wavenumber_cm[0] >= LOWTRAN_FROM else self.cold_kelvin


@lru_cache(maxsize=2)
def band_numbers(spectroscopy: Spectroscopy) -> BandNumbers:
    """Return the numbers of a spectroscopy; read once a process, read-only.

    Raises
    ------
    DataError
        If a file in the package is missing or damaged.
    """
    numbers = lowtran_numbers()
    column, power = numbers["band_column"].astype(np.int64), numbers["band_power"]
    lowtran = BandNumbers(
        numbers["continuum"],
        column,
        power,
        np.log(10.0) * power * numbers["band_log10"],
        LOWTRAN_SCALED,
        0.0,
        {**numbers_provenance(), "spectroscopy": "lowtran7"},
    )
    return lowtran if spectroscopy == "lowtran7" else _refitted(lowtran, numbers["wavenumber_cm"])


def _refitted(lowtran: BandNumbers, nu: FloatArray) -> BandNumbers:
    """Replace LOWTRAN7's numbers by the numbers of the file."""
    try:
        content = resources.files("seaglint.air").joinpath("data", FILE).read_bytes()
        lines = [line for line in content.decode("utf-8").splitlines() if not line.startswith("#")]
        rows = [(row["term"], int(row["from_cm"]), int(row["to_cm"]), row) for row in csv.DictReader(lines)]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise DataError(f"the band laws {FILE} in the package are damaged ({error}); install seaglint again") from error
    continuum, scaled = lowtran.continuum.copy(), dict(lowtran.scaled)
    column, power, log = (
        np.concatenate([a, np.zeros((EXTRA_ROWS, nu.size), a.dtype)]) for a in (lowtran.column, lowtran.power, lowtran.log_coefficient)
    )
    lowest, highest = min(low for _, low, _, _ in rows), max(high for _, _, high, _ in rows)
    for term, low, high, row in rows:
        # the lowest numbers serve down to the first channel, the highest ones through the join
        inside = (nu >= (low if low > lowest else 0.0)) & (nu < (high if high < highest else LOWTRAN_FROM))
        joined = np.clip((nu[inside] - FITTED_UP_TO) / (LOWTRAN_FROM - FITTED_UP_TO), 0.0, 1.0)
        factor = float(row["factor"])
        if term in CONTINUUM_TERMS:
            for linear in CONTINUUM_TERMS[term]:
                continuum[linear, inside] *= factor * (1.0 - joined) + joined
            continue
        gas = BAND_GASES.index(term)
        has_band = lowtran.column[gas, inside] > 0
        channels, joined = np.flatnonzero(inside)[has_band], joined[has_band]
        number = FIRST_COLUMN + len(scaled) - len(lowtran.scaled)
        scaled[number] = (term, float(row["pressure_exponent"]), float(row["temperature_exponent"]))
        a, s = float(row["power"]), float(row["contrast"])
        # logarithm of the coefficient itself; the record holds it times its power
        log_c = lowtran.log_coefficient[gas, channels] / lowtran.power[gas, channels]
        band = (nu[channels] >= low) & (nu[channels] <= high)
        mean = float(np.log(np.mean(np.exp(log_c[band]))))
        # overlapping bands of one gas: the second law takes one of the further rows
        overlapping = bool((column[gas, channels] >= FIRST_COLUMN).any())
        target = _free_row(column, lowtran.column.shape[0], channels) if overlapping else gas
        column[target, channels], power[target, channels] = number, a
        log[target, channels] = np.log(factor) + s * (log_c - mean) + a * mean + np.log(1.0 - joined)
        join = channels[joined > 0.0]  # both depths, weighted, so that nothing jumps in any air
        if join.size:
            target = _free_row(column, lowtran.column.shape[0], join)
            column[target, join], power[target, join] = lowtran.column[gas, join], lowtran.power[gas, join]
            log[target, join] = lowtran.log_coefficient[gas, join] + np.log(joined[joined > 0.0])
    for array in (continuum, column, power, log):
        array.flags.writeable = False
    source: JsonObject = {
        **lowtran.provenance,
        "spectroscopy": "lblrtm",
        "bands": "RRTMGP's long-wave k-distributions of LBLRTM (RTE+RRTMGP), fitted by tools/fit_lblrtm.py",
        "bands_sha256": hashlib.sha256(content).hexdigest(),
    }
    return BandNumbers(continuum, column, power, log, scaled, SELF_KELVIN, source)


def _free_row(column: NDArray[np.int64], first: int, channels: NDArray[np.intp]) -> int:
    """Return the first of the further rows that has no band on some channels."""
    return next(row for row in range(first, column.shape[0]) if not column[row, channels].any())


@dataclass(frozen=True, eq=False)
class BandLaws:
    """Laws of some channels. Make them with ``of``."""

    wavenumber_cm: FloatArray  #: Channels [cm-1, (n,)].
    continuum: FloatArray  #: Coefficients in the order of ``LINEAR`` [(10, n)].
    gases: GasBands  #: Bands.
    source: FloatArray  #: Sunlight outside the air at 1 au [W m-2 per cm-1, (n,)].
    numbers: BandNumbers  #: Exponents of the amounts, and where the numbers are from.

    @classmethod
    def of(cls, wavenumber_cm: FloatArray, spectroscopy: Spectroscopy = "lblrtm") -> BandLaws:
        """Laws of channels of the file [cm-1, (n,)].

        Raises
        ------
        DomainError
            Channels that the file does not hold.
        """
        keep, numbers = channels_of(wavenumber_cm), band_numbers(spectroscopy)
        gases = GasBands.of(numbers.column[:, keep], numbers.power[:, keep], numbers.log_coefficient[:, keep])
        return cls(wavenumber_cm, numbers.continuum[:, keep], gases, lowtran_numbers()["source"][keep], numbers)

    @cached_property
    def cold_kelvin(self) -> float:
        """Temperature of the law by which water's own continuum grows in cold air [K]; 0 for LOWTRAN7's."""
        return self.numbers.cold_law(self.wavenumber_cm)

    @cached_property
    def columns(self) -> list[int]:
        """Numbers of continua and bands, in the order of amounts."""
        return [*LINEAR, *self.gases.numbers]

    def optical_depth(self, amount: FloatArray) -> FloatArray:
        """Optical depth [1, (paths, n)] of amounts [(paths, columns)] in the order of ``columns``."""
        column, power, coefficient = self._saturating
        rows = amount[:, len(LINEAR) :]
        depth = amount[:, : len(LINEAR)] @ self.continuum + np.maximum(rows[:, column], 0.0) ** power @ coefficient
        return np.asarray(np.clip(depth, 0.0, DEEPEST))

    @cached_property
    def _saturating(self) -> tuple[NDArray[np.int64], FloatArray, FloatArray]:
        """Columns and powers of the amounts that saturate, and their coefficients on all channels [(laws, n)].

        One matrix product over all channels, most of them 0, is faster than a sum over stretches of channels.
        """
        laws = sorted({(band.column, band.power) for band in self.gases.bands})
        coefficient = np.zeros((len(laws), self.wavenumber_cm.size))
        for band in self.gases.bands:
            coefficient[laws.index((band.column, band.power)), band.where] += band.coefficient
        return np.array([law[0] for law in laws], np.int64), np.array([law[1] for law in laws]), coefficient


@dataclass(frozen=True)
class OwnGases:
    """Gases that replace the gases of a profile; None leaves the profile's."""

    co2_ppmv: float | None = None  #: Carbon dioxide [1e-6 of dry air], the same at all heights.
    ch4_ppmv: float | None = None  #: Methane [1e-6 of dry air] at the lowest level; above in proportion to the profile's.
    n2o_ppmv: float | None = None  #: Nitrous oxide, as ``ch4_ppmv`` [1e-6 of dry air].
    ozone_du: float | None = None  #: Ozone column from the sea up [Dobson units].

    def of(self, spectroscopy: Spectroscopy) -> OwnGases:
        """Return the gases with carbon dioxide of today, unless LOWTRAN7's numbers require LOWTRAN7's gases."""
        return replace(self, co2_ppmv=TODAY_CO2_PPMV) if self.co2_ppmv is None and spectroscopy != "lowtran7" else self


def dry_share(profile: AirProfile) -> FloatArray:
    """Part of the molecules of a profile's air that is not water vapour [1, (levels,)]."""
    return np.asarray(1.0 - profile.vapour * profile.temperature / GRAM_PER_HPA / profile.pressure)


def ozone_column(profile: AirProfile) -> float:
    """Ozone of a profile from its lowest level up [Dobson units], exponential between levels."""
    molecules = air_molecules(profile.pressure, profile.temperature) * 1e-6 * profile.gas[GASES.index("O3")]
    return 100.0 * sum_between(profile.height, molecules) / _DOBSON


def with_gases(profile: AirProfile, gases: OwnGases) -> AirProfile:
    """Return the profile with some of its gases replaced.

    >>> from seaglint.air.profile.air_profile import model_profile
    >>> air = with_gases(model_profile("us-standard-1976"), OwnGases(co2_ppmv=425.0, ozone_du=300.0))
    >>> round(float(air.gas[1, -1])), round(ozone_column(air))
    (425, 300)
    """
    if gases == OwnGases():
        return profile
    gas, dry = profile.gas.copy(), dry_share(profile)
    if gases.co2_ppmv is not None:
        gas[GASES.index("CO2")] = gases.co2_ppmv * dry
    for name, ppmv in (("CH4", gases.ch4_ppmv), ("N2O", gases.n2o_ppmv)):
        if ppmv is not None:
            row = GASES.index(name)
            gas[row] *= ppmv * dry[0] / gas[row, 0]
    if gases.ozone_du is not None:
        gas[GASES.index("O3")] *= gases.ozone_du / ozone_column(profile)
    return replace(profile, gas=gas)
