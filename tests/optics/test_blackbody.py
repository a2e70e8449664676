import numpy as np
import pytest
from scipy import constants

from seaglint.base.errors import DomainError
from seaglint.optics.blackbody import planck_wavenumber


@pytest.mark.parametrize("temperature", [200.0, 288.15, 1000.0, 5800.0])
def test_all_wavenumbers_together_give_stefan_boltzmann(temperature):
    nu = np.linspace(1e-3, 40.0, 20001) * temperature  # 40 T cm-1 is 58 kT: nothing is left beyond
    total = np.pi * np.trapezoid(planck_wavenumber(nu, temperature), nu)
    assert total == pytest.approx(constants.sigma * temperature**4, rel=1e-6)  # step error of the trapezoid


def test_peak_obeys_wiens_law_per_wavenumber():
    nu = np.linspace(400.0, 900.0, 50001)
    peak = nu[np.argmax(planck_wavenumber(nu, 300.0))]
    assert peak == pytest.approx(constants.value("Wien frequency displacement law constant") * 300.0 / constants.c / 100.0, rel=1e-4)


def test_per_wavenumber_agrees_with_the_law_per_wavelength():
    lam = 4.0e-6
    h, c, k = constants.h, constants.c, constants.k
    per_metre = 2 * h * c**2 / lam**5 / np.expm1(h * c / (lam * k * 300.0))
    wavenumbers_per_metre = 0.01 / lam**2  # |d nu / d lambda|, nu in cm-1
    assert float(planck_wavenumber(2500.0, 300.0)) * wavenumbers_per_metre == pytest.approx(per_metre, rel=1e-12)


def test_cold_bodies_underflow_quietly():
    assert planck_wavenumber(3300.0, 2.0) == 0.0


@pytest.mark.parametrize(("nu", "t"), [(1000.0, 0.0), (1000.0, -3.0), (0.0, 300.0), (1000.0, np.nan)])
def test_refuses_what_has_no_meaning(nu, t):
    with pytest.raises(DomainError, match="> 0"):
        planck_wavenumber(nu, t)
