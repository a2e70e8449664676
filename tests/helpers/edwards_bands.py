"""Edwards' wide bands written out level by level, for tests: parameters and formulas of Modest (2013), section 11.10."""

from __future__ import annotations

import math

import numpy as np
from scipy import constants

CO2 = (44.0095, ((1351, 1), (667, 2), (2396, 1)))
H2O = (18.01528, ((3652, 1), (1595, 1), (3756, 1)))
# gas, head or centre, one-sided, steps, b's, n, alpha0, beta0, omega0
BANDS = {
    "co2 4.3 um": (CO2, 2410.0, True, (0, 0, 1), (0.0, 1.3), 0.8, 110.0, 0.24723, 11.2),
    "co2 2.7 um": (CO2, 3660.0, False, (1, 0, 1), (0.0, 1.3), 0.65, 4.0, 0.13341, 23.5),
    "co2 9.4 um": (CO2, 1060.0, False, (0, -2, 1), (0.0, 1.3), 0.8, 2.48e-9, 0.11888, 10.1),
    "h2o 1.38 um": (H2O, 7250.0, False, (1, 0, 1), (8.6, 0.5), 1.0, 2.5, 0.11628, 32.0),
}


def parameters(name: str, kelvin: float, share: float) -> tuple[float, float, float]:
    """Alpha [cm-1 / (g m-2)], beta with the effective pressure [1], and omega [cm-1]."""
    gas, _, _, steps, (b_root, b_rest), n, alpha, beta, omega = BANDS[name]

    def sums(t: float) -> tuple[float, float]:
        above = below = roots = 1.0
        exponent = 0.0
        for (nu, g), step in zip(gas[1], steps, strict=True):
            u = constants.h * constants.c * 100.0 * nu / (constants.k * t)
            exponent += u * step
            up = [math.exp(math.lgamma(v + g + abs(step)) - math.lgamma(g) - math.lgamma(v + 1) - u * v) for v in range(max(-step, 0), 400)]
            above *= sum(up)
            roots *= sum(math.sqrt(x) for x in up) ** 2 / sum(up)
            below *= sum(math.exp(math.lgamma(v + g) - math.lgamma(g) - math.lgamma(v + 1) - u * v) for v in range(400))
        return (1.0 - math.exp(-exponent)) * above / below, roots

    (psi, phi), (psi0, phi0) = sums(kelvin), sums(100.0)
    pressure = (1.0 + (b_root * math.sqrt(100.0 / kelvin) + b_rest - 1.0) * share) ** n
    return alpha * psi / psi0, beta * math.sqrt(100.0 / kelvin) * phi / phi0 * pressure, omega * math.sqrt(kelvin / 100.0)


def column(name: str, kelvin: float, share: float, path: float) -> float:
    """Gas along a path [m] at 1 atm [g m-2]."""
    return share * 101325.0 * BANDS[name][0][0] / (8.31446261815324 * kelvin) * path


def absorption(name: str, kelvin: float, share: float, path: float) -> float:
    """Edwards' absorption of the whole band [cm-1]: linear, root and logarithm."""
    alpha, beta, omega = parameters(name, kelvin, share)
    tau = alpha * column(name, kelvin, share, path) / omega
    if beta >= 1.0:
        return omega * (tau if tau <= 1.0 else math.log(tau) + 1.0)
    if tau <= beta:
        return omega * tau
    if tau <= 1.0 / beta:
        return omega * (2.0 * math.sqrt(tau * beta) - beta)
    return omega * (math.log(tau * beta) + 2.0 - beta)


def spectrum(name: str, nu: np.ndarray, kelvin: float, share: float, path: float) -> np.ndarray:
    """Emissivity of one band at wavenumbers [cm-1]."""
    alpha, beta, omega = parameters(name, kelvin, share)
    _, place, one_sided, *_ = BANDS[name]
    x = (place - nu) / omega if one_sided else 2.0 * abs(nu - place) / omega
    weak = alpha / omega * np.exp(-np.where(x < 0.0, np.inf, x)) * column(name, kelvin, share, path)
    below = np.where(weak <= beta, weak, np.sqrt(weak * beta)) if beta < 1.0 else weak
    return np.minimum(below, 1.0)
