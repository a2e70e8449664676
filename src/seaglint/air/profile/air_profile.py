"""Profiles of pressure, temperature, water vapour and gases from the sea to 100 km: model atmospheres, and soundings that one continues.

**Numbers.** The shipped file holds LOWTRAN7's input: model atmospheres, band laws, aerosols, sunlight outside the air. It is built by
``tools/build_lowtran_numbers.py`` for 0.7-14.7 um in channels every 5 cm-1 and contains no results.

**Soundings** end below 100 km. Above their last level a model atmosphere continues them:

- Ozone: the model's, joined to the sounding above the highest level with ozone.
- Humidity: relative humidity differs least between airs of different temperature, so the model's relative humidity continues in the air of
  the sounding. In the stratosphere, where air is dry by its history, the model's mixing ratio continues.

References
----------
Anderson, G. P., et al. (1986), AFGL atmospheric constituent profiles (0-120 km), AFGL-TR-86-0110, Table 1; the numbers are taken from
LOWTRAN7 (block data MLATMB). Between them LOWTRAN7 interpolates by Lagrange's cubic (subroutine DEFALT).

Manabe, S., and R. T. Wetherald (1967), Thermal equilibrium of the atmosphere with a given distribution of relative humidity, J. Atmos.
Sci. 24, 241-259.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from io import BytesIO
from lzma import LZMAError
from types import MappingProxyType
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject

FILE: Final = "lowtran7_numbers.npz"

#: Height over which the ratio of the sounding's last ozone to the model's falls to 1/e [m]: about a scale height of ozone aloft.
OZONE_JOIN_M: Final = 5000.0

LARGEST_RATIO: Final = 1e3  #: Largest ratio at the join, either way.

BOLTZMANN: Final = 1.380649e-23  #: [J K-1].

DOBSON: Final = 2.6867e20  #: Molecules of one Dobson unit [m-2].

MODEL_HEIGHTS: Final = 1e3 * np.array([*range(26), 30, 35, 40, 45, 50, 70, 100], dtype=np.float64)  #: Levels of LOWTRAN7's own models [m].

ZERO_CELSIUS: Final = 273.15

STANDARD_PRESSURE: Final = 1013.25  #: [hPa].

#: Gases of the profiles, the first seven by model.
GASES: Final = ("H2O", "CO2", "O3", "N2O", "CO", "CH4", "O2", "NO", "SO2", "NO2", "NH3", "HNO3")

_AIR: Final = 2.6868e19  #: Molecules of standard air [cm-3] in LOWTRAN7 (2.68675e19 where it computes number densities from humidities).

_AIR_OF_HUMIDITY: Final = 2.68675e19

_GRAM_OF_MOLECULES: Final = 2.989e-23  #: LOWTRAN7's factor from molecules per cm3 of water, in parts per million, to g m-3.

_MOLECULES_OF_GRAM: Final = 6.022045e23 / 18.015 * 1e-6  #: Molecules per cm3 of 1 g m-3 of water.

#: Height over which the ratio of the sounding's last humidity to the model's falls to 1/e [m]: the scale height of water vapour.
HUMIDITY_JOIN_M: Final = 2000.0

TROPOSPHERE_HPA: Final = 200.0  #: Pressure down to which the relative humidity is the model's [hPa].

#: Pressure from which on the mixing ratio is the model's [hPa]; between both its logarithm is interpolated.
STRATOSPHERE_HPA: Final = 100.0


@lru_cache(maxsize=1)
def lowtran_numbers() -> Mapping[str, Any]:
    """Return the arrays of the file by name, and its ``sha256``; read once a process, read-only.

    Raises
    ------
    DataError
        If the file in the package is missing or damaged.
    """
    try:
        content = resources.files("seaglint.air").joinpath("data", FILE).read_bytes()
        with np.load(BytesIO(content)) as archive:
            arrays: dict[str, Any] = {name: archive[name] for name in archive.files}
    except (OSError, ValueError, KeyError, BadZipFile, LZMAError) as error:
        raise DataError(f"the numbers of LOWTRAN7 {FILE} in the package are damaged ({error}); install seaglint again") from error
    for name, array in arrays.items():
        if array.dtype == np.float32:
            arrays[name] = array.astype(np.float64)
        arrays[name].flags.writeable = False
    return MappingProxyType(arrays | {"sha256": hashlib.sha256(content).hexdigest()})


def numbers_provenance() -> JsonObject:
    """Source of the file."""
    numbers = lowtran_numbers()
    recorded: JsonObject = json.loads(str(numbers["provenance"]))
    return recorded | {"sha256": str(numbers["sha256"])}


def channels_of(wavenumber_cm: FloatArray) -> FloatArray:
    """Indices [(n,)] of channels among the channels of the file.

    Raises
    ------
    DomainError
        Channels that the file does not hold.
    """
    grid = lowtran_numbers()["wavenumber_cm"]
    keep = np.clip(np.searchsorted(grid, wavenumber_cm - 1e-6), 0, grid.size - 1)
    if not np.allclose(grid[keep], wavenumber_cm, rtol=0.0, atol=1e-6):
        raise DomainError(
            f"LOWTRAN7's numbers are held every 5 cm-1 from {grid[0]:g} to {grid[-1]:g} cm-1 "
            f"({1e4 / grid[-1]:.2g}-{1e4 / grid[0]:.3g} um); choose a band inside"
        )
    return np.asarray(keep)


def joined_ozone(height: FloatArray, of_model: FloatArray, given: FloatArray) -> FloatArray:
    """Ozone [1e-6 of the volume, (levels,)] of a sounding, with the model's above its highest known level.

    The ratio of both at that level goes to 1 as ``exp(-(z - z_last) / 5 km)`` in its logarithm, so that no step is made. Missing values
    between known levels are linear in height; below the lowest known level its value holds.

    Parameters
    ----------
    height, of_model : ndarray
        Ascending levels [m] and the model's ozone there [1e-6 of the volume]; (levels,).
    given : ndarray
        The sounding's ozone at the first of these levels [1e-6 of the volume], NaN where missing.
    """
    known = np.flatnonzero(np.isfinite(given))
    if not known.size:
        return of_model
    last = int(known[-1])
    ratio = np.clip(given[last] / of_model[last], 1.0 / LARGEST_RATIO, LARGEST_RATIO)
    # the power falls from 1 to 0, which takes the ratio to 1 evenly in its logarithm
    above = of_model[last + 1 :] * ratio ** np.exp(-(height[last + 1 :] - height[last]) / OZONE_JOIN_M)
    return np.concatenate([np.interp(height[: last + 1], height[known], given[known]), above])


def ozone_dobson(height: FloatArray, pressure: FloatArray, temperature: FloatArray, ozone: FloatArray) -> float:
    """Ozone above the lowest level [Dobson units] of levels [m], [hPa], [K], [1e-6 of the volume], exponential between them."""
    density = 1e-6 * ozone * 100.0 * pressure / (BOLTZMANN * temperature)
    return sum_between(height, density) / DOBSON


def saturation_density(temperature: ArrayLike) -> FloatArray:
    """Density of saturated vapour over water [g m-3]: ``A exp(18.9766 - 14.9595 A - 2.43882 A^2)``, A = 273.15/T (LOWTRAN7's F).

    >>> round(float(saturation_density(288.15)), 2)
    12.82
    """
    a = ZERO_CELSIUS / np.asarray(temperature, dtype=np.float64)
    return np.asarray(a * np.exp(18.9766 - 14.9595 * a - 2.43882 * a * a))


def air_molecules(pressure: ArrayLike, temperature: ArrayLike) -> FloatArray:
    """Molecules of air [cm-3] at a pressure [hPa] and temperature [K]."""
    return np.asarray(_AIR * np.asarray(pressure) / STANDARD_PRESSURE * ZERO_CELSIUS / np.asarray(temperature))


@dataclass(frozen=True, eq=False)
class AirProfile:
    """Air at ascending levels from the sea to 100 km."""

    name: str  #: Name of the air in messages.
    height: FloatArray  #: Heights of the levels [m, (levels,)].
    pressure: FloatArray  #: Pressure [hPa, (levels,)].
    temperature: FloatArray  #: Temperature [K, (levels,)].
    vapour: FloatArray  #: Water vapour [g m-3, (levels,)].
    gas: FloatArray  #: Mixing ratios of ``GASES`` [1e-6 of the volume, (12, levels)].
    earth_radius: float  #: LOWTRAN7's radius of the Earth for the latitude of the model [m].
    season: str  #: ``spring`` (and summer) or ``fall`` (and winter), which the aerosol above 2 km follows.
    haze_humidity: float | None = None  #: Relative humidity of the Navy's haze [%]; None for the humidity of the lowest level.

    @property
    def relative_humidity(self) -> FloatArray:
        """Relative humidity over water [%, (levels,)], at most 100."""
        return np.asarray(np.clip(100.0 * self.vapour / saturation_density(self.temperature), 0.0, 100.0))

    @property
    def precipitable_water(self) -> float:
        """Water vapour of the whole air above the sea [kg m-2], exponential between levels."""
        return self.water_above(0.0)

    def water_above(self, height: float) -> float:
        """Water vapour of the air above a height [kg m-2, from m], exponential between levels."""
        z, vapour = self.height, self.vapour
        if height > z[0]:
            first = int(np.searchsorted(z, height, side="right"))
            low, high = vapour[first - 1 : first + 1] if first < z.size else (0.0, 0.0)
            share = (height - z[first - 1]) / (z[first] - z[first - 1]) if first < z.size else 0.0
            # density at the height itself: exponential in the layer, linear next to a zero
            at = low ** (1.0 - share) * high**share if min(low, high) > 0.0 else (1.0 - share) * low + share * high
            z, vapour = np.append(height, z[first:]), np.append(at, vapour[first:])
        return 1e-3 * sum_between(z, vapour)


def sum_between(height: FloatArray, density: FloatArray) -> float:
    """Integral of a density over heights [m, (levels,)], exponential between levels: in its unit times m."""
    a, b = density[:-1], density[1:]
    exponential = (a > 0.0) & (b > 0.0) & (np.abs(a - b) > 1e-9 * a)
    # the mean of an exponential is (a - b)/ln(a/b); equal or zero densities take the arithmetic mean
    ratio = np.where(exponential, a, np.e) / np.where(exponential, b, 1.0)
    mean = np.where(exponential, (a - b) / np.log(ratio), 0.5 * (a + b))
    return float(np.sum(mean * np.diff(height)))


def _model_index(model: str) -> int:
    models = lowtran_numbers()["models"].tolist()
    if model not in models:
        raise DomainError(f"model = {model!r} is not one of {', '.join(models)}", name="model", value=model, allowed=", ".join(models))
    return int(models.index(model))


def _cubic(height: FloatArray, tables: FloatArray) -> FloatArray:
    """Lagrange's cubic through the four levels of the models around heights [m], as in DEFALT: (..., heights)."""
    nodes = 1e3 * lowtran_numbers()["model_height"]
    upper = np.clip(np.searchsorted(nodes, height - 1e-9), 1, nodes.size - 1)
    # two levels on each side; at the ends of the models the four nearest
    first = np.clip(upper - 2, 0, nodes.size - 4)
    four = first[:, None] + np.arange(4)
    z = nodes[four]
    weights = np.ones(four.shape)
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[:, i] *= (height - z[:, j]) / (z[:, i] - z[:, j])
    return np.asarray(np.sum(tables[..., four] * weights, axis=-1))


def model_levels(model: str, height: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Pressure [hPa], temperature [K], vapour [g m-3] and gases [1e-6, (12, n)] of a model atmosphere at heights [m, (n,)]."""
    numbers, m = lowtran_numbers(), _model_index(model)
    z = np.asarray(height, dtype=np.float64)
    pressure = np.exp(_cubic(z, np.log(numbers["model_pressure"][m])))
    temperature = _cubic(z, numbers["model_temperature"][m])
    gas = np.concatenate([_cubic(z, numbers["model_gas"][m]), _cubic(z, numbers["trace_gas"])])
    gas[-1] *= 1e3  # DEFALT: nitric acid in another unit
    vapour = _GRAM_OF_MOLECULES * gas[0] * air_molecules(pressure, temperature)
    return pressure, temperature, vapour, gas


def earth_radius_of(model: str) -> float:
    """LOWTRAN7's radius of the Earth for a model atmosphere [m]."""
    return {"tropical": 6378.39e3, "subarctic-summer": 6356.91e3, "subarctic-winter": 6356.91e3}.get(model, 6371.23e3)


def model_profile(model: str) -> AirProfile:
    """One of LOWTRAN7's six model atmospheres at its own levels.

    Raises
    ------
    DomainError
        An unknown model.

    Examples
    --------
    >>> model_profile("midlatitude-summer").temperature[:2]
    array([294.2, 289.7])
    """
    pressure, temperature, vapour, gas = model_levels(model, MODEL_HEIGHTS)
    season = "fall" if model in ("midlatitude-winter", "subarctic-winter") else "spring"
    return AirProfile(model, MODEL_HEIGHTS, pressure, temperature, vapour, gas, earth_radius_of(model), season)


def sounding_profile(
    name: str,
    model: str,
    height: FloatArray,
    pressure: FloatArray,
    temperature: FloatArray,
    relative_humidity: FloatArray,
    above: FloatArray | None = None,
    *,
    ozone_ppmv: FloatArray | None = None,
) -> AirProfile:
    """Sounding from the sea up, with the gases of a model atmosphere and its air above.

    Parameters
    ----------
    name : str
        Name for messages.
    model : str
        Model atmosphere.
    height, pressure, temperature, relative_humidity : ndarray
        Ascending levels, the first at the sea: [m], [hPa], [K], over water [%]; (levels,).
    above : ndarray, optional
        Levels of the model above [m]; by default its own.
    ozone_ppmv : ndarray, optional
        Ozone of the sounding [1e-6 of the volume, (levels,)], NaN where missing; the model's is joined to it above. By default the model's.

    Returns
    -------
    AirProfile
        The sounding's levels and those of the model atmosphere above it.

    Notes
    -----
    Levels of the model closer than 200 m to the sounding's last one are left out. Season and radius of the Earth are LOWTRAN7's for
    users' profiles.
    """
    if above is None:
        above = MODEL_HEIGHTS[height[-1] + 200.0 < MODEL_HEIGHTS]
    z = np.concatenate([height, above])
    p, kelvin, vapour, gas = model_levels(model, z)
    n = height.size
    p[:n], kelvin[:n] = pressure, temperature
    # LOWTRAN7 converts humidities with a slightly different number of molecules of air than mixing ratios
    molecules = saturation_density(temperature) * _MOLECULES_OF_GRAM * relative_humidity / 100.0
    vapour[:n] = _GRAM_OF_MOLECULES * molecules / (_AIR_OF_HUMIDITY / _AIR) * 1e6
    if ozone_ppmv is not None:
        ozone = GASES.index("O3")
        gas[ozone] = joined_ozone(z, gas[ozone], ozone_ppmv)
    return AirProfile(name, z, p, kelvin, vapour, gas, 6371.23e3, "spring")


def continued_humidity(
    model: str, height: FloatArray, pressure: FloatArray, temperature: FloatArray, relative_humidity: FloatArray
) -> FloatArray:
    """Relative humidity over water [%, (levels,)] with its missing values above the last known one filled by a model atmosphere's.

    The ratio of both at the last known level goes to 1 as ``exp(-(z - z_last) / 2 km)``, and air is never above saturation.

    Parameters
    ----------
    model : str
        Model atmosphere.
    height, pressure, temperature : ndarray
        Ascending levels [m], [hPa], [K].
    relative_humidity : ndarray
        Over water [%]; NaN above the last known level.
    """
    known = np.isfinite(relative_humidity)
    if known.all():
        return relative_humidity
    last = int(np.flatnonzero(known)[-1])
    z, p, kelvin = height[last:], pressure[last:], temperature[last:]
    model_p, model_kelvin, vapour, _ = model_levels(model, z)
    of_model = 100.0 * vapour / saturation_density(model_kelvin)
    # the model's mixing ratio in this air: densities are as the pressures over the temperatures
    of_ratio = 100.0 * vapour * (p / model_p) * (model_kelvin / kelvin) / saturation_density(kelvin)
    share = np.clip(np.log(TROPOSPHERE_HPA / p) / np.log(TROPOSPHERE_HPA / STRATOSPHERE_HPA), 0.0, 1.0)
    # from the model's relative humidity to its mixing ratio over the logarithm of pressure
    law = np.exp((1.0 - share) * np.log(of_model) + share * np.log(of_ratio))
    start = np.clip(relative_humidity[last] / law[0], 1.0 / LARGEST_RATIO, LARGEST_RATIO)
    joined = law * start ** np.exp(-(z - z[0]) / HUMIDITY_JOIN_M)
    out = relative_humidity.copy()
    out[last + 1 :] = np.clip(joined[1:], 0.0, 100.0)
    return out
