"""Complex refractive index of sea water in the infrared.

The choice of a table matters: at 4 um Segelstein's n is lower by 0.017 than Hale and Querry's, which takes 8 % off the reflectance at nadir
(and off a high Sun's glint), and less towards grazing incidence.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

#: Difference of the real index of sea water of ordinary salinity and pure water [1] (Friedman 1969, Appl. Opt. 8, 2073).
SEA_OFFSET: Final = 0.006

ARTICLE_N: Final = 1.33  #: Real index of the source article, taken at 4 um, section "Computing temporally averaged sea radiance".

ARTICLE_ABSORPTION: Final = 200.0  #: Absorption coefficient of the source article [cm-1].


@dataclass(frozen=True, eq=False)
class WaterIndex:
    """Table of n and k against wavelength: n linear, k log-linear between its rows."""

    name: str  #: For provenance.
    wavelength_um: FloatArray  #: Ascending [um, (m,)]; the index is refused outside it.
    n: FloatArray  #: Real part [1, (m,)].
    k: FloatArray  #: Extinction coefficient [1, (m,)].

    def index(self, wavenumber_cm: ArrayLike) -> NDArray[np.complex128]:
        """Complex index ``n + i k`` at wavenumbers [cm-1], same shape; DomainError outside the table."""
        w = 1.0e4 / np.asarray(wavenumber_cm, dtype=np.float64)
        low, high = self.wavelength_um[0], self.wavelength_um[-1]
        if not np.all((w >= low) & (w <= high)):
            raise DomainError(
                f"wavelengths {float(np.min(w)):.4g}-{float(np.max(w)):.4g} um reach outside the {low:.4g}-{high:.4g} um of the "
                f"water index {self.name!r}; choose a band inside it or another index",
                name="wavelength_um",
                value=float(w[~((w >= low) & (w <= high))].ravel()[0]),
                allowed=(float(low), float(high)),
            )
        n = np.interp(w, self.wavelength_um, self.n)
        k = np.exp(np.interp(w, self.wavelength_um, np.log(self.k)))
        return np.asarray(n + 1j * k)


def _table(file: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    text = files("seaglint.optics").joinpath("data", file).read_text(encoding="utf-8")
    rows = np.loadtxt(text.splitlines(), delimiter=",", skiprows=3, dtype=np.float64)
    return rows[:, 0], rows[:, 1], rows[:, 2]


@cache
def hale_querry_sea() -> WaterIndex:
    """Index of Hale and Querry 1973 (pure water, 25 C) with n raised by 0.006 for salt: the default, 0.6-20 um.

    >>> m = hale_querry_sea().index(2500.0)
    >>> round(float(m.real), 3), round(float(m.imag), 4)
    (1.357, 0.0046)
    """
    w, n, k = _table("hale_querry_1973.csv")
    return WaterIndex("hale-querry-sea", w, n + SEA_OFFSET, k)


@cache
def segelstein() -> WaterIndex:
    """Index of Segelstein 1981 (pure water, 25 C) with n raised by 0.006 for salt, 0.6-20 um."""
    w, n, k = _table("segelstein_1981.csv")
    return WaterIndex("segelstein-sea", w, n + SEA_OFFSET, k)


@cache
def article() -> WaterIndex:
    """Index of the source article: n = 1.33 and an absorption of 200 cm-1, ``k = a lambda / 4 pi``.

    Two numbers for 4 um, used by the article over 3-5 um. The table holds them as constants over 2-14 um, unlike real water, which
    absorbs 60 times as much at 3 um, and at 8-12 um its n falls from 1.30 to 1.12.
    """
    w = np.geomspace(2.0, 14.0, 513)  # k is linear in wavelength; log-linear pieces this short follow it to 1e-6
    return WaterIndex("article", w, np.full_like(w, ARTICLE_N), ARTICLE_ABSORPTION * w * 1e-4 / (4.0 * np.pi))
