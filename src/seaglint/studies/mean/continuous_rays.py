"""Spectra of the air for cases one by one, in continuous air with LOWTRAN7's band laws, as the tables of cases have them."""

from __future__ import annotations

import numpy as np

from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.hazes import HazeWeather
from seaglint.base.conventions import FloatArray
from seaglint.base.limits import NAVY_AEROSOL_WIND


def continuous_rays(model: str, wavenumber_cm: FloatArray, *cases: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Transmittance, path, sunlight and sky [(cases, n)] in continuous air, ray by ray.

    ``cases``: wind [m s-1], height [m], depression, zenith angles of Sun and sky [rad].
    """
    out = np.empty((4, cases[0].size, wavenumber_cm.size))
    for i, (wind, height, depression, sun, sky) in enumerate(zip(*(values.tolist() for values in cases), strict=True)):
        sums = _at_wind(model, wind, wavenumber_cm)
        down = sums.along(height, 0.5 * np.pi + max(depression, sums.air.dip(height) * (1.0 + 1e-9)))
        lit = sums.passed(0.0, sun) * sums.laws.source if sun <= 0.5 * np.pi else np.zeros(wavenumber_cm.size)
        out[:, i] = down.transmittance[-1], down.emitted, lit, sums.along(0.0, sky).emitted
    return out[0], out[1], out[2], out[3]


def continuous_light(model: str, wavenumber_cm: FloatArray, *cases: FloatArray) -> FloatArray:
    """Thermal radiance [(cases, n)] of continuous air along rays to the sea or the sky.

    ``cases``: wind [m s-1], height [m], elevation [rad].
    """
    out = np.empty((cases[0].size, wavenumber_cm.size))
    for i, (wind, height, elevation) in enumerate(zip(*(values.tolist() for values in cases), strict=True)):
        out[i] = _at_wind(model, wind, wavenumber_cm).along(height, 0.5 * np.pi - elevation).emitted
    return out


def _at_wind(model: str, wind: float, wavenumber_cm: FloatArray) -> AirSums:
    blown = min(wind, NAVY_AEROSOL_WIND[1])
    return AirSums(model_profile(model), HazeWeather(wind=blown, wind_24h=blown), wavenumber_cm, spectroscopy="lowtran7")
