"""Spectra of the air for cases one by one, in continuous air."""

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
    profile = model_profile(model)
    out = np.empty((4, cases[0].size, wavenumber_cm.size))
    for i, (wind, height, depression, sun, sky) in enumerate(zip(*(values.tolist() for values in cases), strict=True)):
        blown = min(wind, NAVY_AEROSOL_WIND[1])
        sums = AirSums(profile, HazeWeather(wind=blown, wind_24h=blown), wavenumber_cm)
        down = sums.along(height, 0.5 * np.pi + max(depression, sums.air.dip(height) * (1.0 + 1e-9)))
        lit = sums.passed(0.0, sun) * sums.laws.source if sun <= 0.5 * np.pi else np.zeros(wavenumber_cm.size)
        out[:, i] = down.transmittance[-1], down.emitted, lit, sums.along(0.0, sky).emitted
    return out[0], out[1], out[2], out[3]
