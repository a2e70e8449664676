r"""Emissivity and reflectance of sea foam in the infrared, by wavelength and angle.

Water absorbs so strongly in the infrared that light leaves foam in three ways only. Part of the foam's area is a film of water that is
nearly horizontal and mirrors like the water beside it; the rest is bubbles, cavities that trap the light that enters them and emit like a
blackbody. Where water absorbs least (near 3.8 um, and below 2.5 um), the bubbles return a little light diffusely:

.. math:: \rho_f(\omega, \lambda) = (1 - b)\,\rho_w(\omega, \lambda) + d(\lambda), \qquad \epsilon_f = 1 - \rho_f

with :math:`\rho_w` Fresnel's reflectance of the sea water, the share of bubbles b and the diffuse reflectance
:math:`d = d_0 \exp(-\sqrt{\alpha l})`, the law of a scattering medium that absorbs, with :math:`\alpha = 4 \pi k / \lambda`. The mirrored
part is reciprocal as water is, the diffuse part is Lambert's.

b comes from the two measurements of foam minus water at large angles: +0.04 in 8-14 um at 65 deg (Niclos et al. 2007, which find nothing
at small angles) and +0.23 at 8.9 um and 85 deg (Branch et al. 2016, the largest difference that they report). They ask for shares
of 0.48 and 0.41. Foam whose reflecting walls had all directions would be 0.46 above water at 85 deg, twice the measured difference.

:math:`d_0` and l are fitted to the effective reflectance of whitecaps in 1-2.5 um, of Whitlock et al. 1982 with Koepke's 0.4 for foam of a
mean age, as the program 6S tabulates it; between 2.5 and 14 um no measurement of the diffuse part is known to us.

References
----------
Branch, Chickadee and Jessup 2016, Remote Sens. Environ. 184, 15; Niclos, Caselles, Valor and Coll 2007, J. Geophys. Res. 112, C12020;
Whitlock, Bartlett and Gurganus 1982, Geophys. Res. Lett. 9, 719; Koepke 1984, Appl. Opt. 23, 1816;
Kokhanovsky 2004, J. Geophys. Res. 109, C05021 (reflectance of foam against the absorption of water).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import WaterIndex

#: Share of foam that is bubbles, black but for the diffuse reflectance [1]; the rest mirrors like water.
BUBBLES: Final = 0.4

DIFFUSE: Final = 0.22  #: Diffuse reflectance of foam of a mean age where water does not absorb [1] (Koepke 1984).

ABSORBING_LENGTH: Final = 0.77e-3  #: Length of water that diffusely reflected light has crossed, in the law of its absorption [m].


def diffuse_reflectance(wavenumber_cm: ArrayLike, water: WaterIndex) -> FloatArray:
    """Diffuse reflectance of foam [1], of the shape of the wavenumbers [cm-1].

    Within 0.015 rms of the effective reflectance of whitecaps in 1-2.5 um, less the part that mirrors. Its largest value in 3-14 um is
    0.012, near 3.8 um.
    """
    nu = np.asarray(wavenumber_cm, dtype=np.float64)
    absorption = 4.0 * np.pi * water.index(nu).imag * nu * 100.0
    return np.asarray(DIFFUSE * np.exp(-np.sqrt(absorption * ABSORBING_LENGTH)))


def foam_reflectance(cos_incidence: ArrayLike, wavenumber_cm: ArrayLike, water: WaterIndex) -> FloatArray:
    """Directional-hemispherical reflectance of foam [1]; cosine of incidence and wavenumbers [cm-1] broadcast.

    >>> from seaglint.optics.sea_water import hale_querry_sea
    >>> round(float(foam_reflectance(np.cos(np.radians(85.0)), 1e4 / 8.9, hale_querry_sea())), 3)
    0.34
    """
    mirrored = reflectance(cos_incidence, water.index(np.asarray(wavenumber_cm, dtype=np.float64)))
    return np.asarray((1.0 - BUBBLES) * mirrored + diffuse_reflectance(wavenumber_cm, water))


def foam_emissivity(cos_incidence: ArrayLike, wavenumber_cm: ArrayLike, water: WaterIndex) -> FloatArray:
    """Directional emissivity of foam [1], arguments as of ``foam_reflectance``."""
    return np.asarray(1.0 - foam_reflectance(cos_incidence, wavenumber_cm, water))
