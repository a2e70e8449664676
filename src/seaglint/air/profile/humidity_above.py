"""Humidity above the highest level of a sounding that has one: that of a model atmosphere, joined to the sounding.

Relative humidity is what differs least between airs of different temperature, so it is the model's relative humidity that goes on in the
air of the sounding. Where air is dry by its history, in the stratosphere, it is the model's mixing ratio.

References
----------
Manabe, S., and R. T. Wetherald (1967), Thermal equilibrium of the atmosphere with a given distribution of relative humidity, J. Atmos.
Sci. 24, 241-259.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import model_levels, saturation_density
from seaglint.base.conventions import FloatArray

#: Height over which the ratio of the sounding's last humidity to the model's falls to 1/e [m]: the scale height of water vapour.
JOIN_M: Final = 2000.0

LARGEST_RATIO: Final = 1e3  #: Largest ratio at the join, either way.

TROPOSPHERE_HPA: Final = 200.0  #: Pressure down to which the relative humidity is the model's [hPa].

#: Pressure from which on the mixing ratio is the model's [hPa]; between both its logarithm is interpolated.
STRATOSPHERE_HPA: Final = 100.0


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
    law = np.exp((1.0 - share) * np.log(of_model) + share * np.log(of_ratio))
    start = np.clip(relative_humidity[last] / law[0], 1.0 / LARGEST_RATIO, LARGEST_RATIO)
    joined = law * start ** np.exp(-(z - z[0]) / JOIN_M)
    out = relative_humidity.copy()
    out[last + 1 :] = np.clip(joined[1:], 0.0, 100.0)
    return out
