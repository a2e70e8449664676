"""Data behind LOWTRAN7's transmittances and scattering, from a run: profiles, band laws, aerosol, phase functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.air.scattering.gas_bands import GasBands
from seaglint.air.scattering.scattered_line import HUMIDITIES
from seaglint.air.scattering.scattering_laws import NO_BAND, AerosolLaws, AirLevels, ScatteringAir, SpectralLaws, continuum_coefficients
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import BackendError
from seaglint.files.lowtran import cache, engine
from seaglint.files.lowtran.deck import Haze, LowtranAir, LowtranCase

#: Scattering angles of the Mie data base [deg] (DATA ANG of PHASEF).
PHASE_ANGLES_DEG: Final = np.array([*range(0, 13, 2), *range(16, 41, 4), *range(50, 121, 10), *range(125, 181, 5)], dtype=np.float64)

#: Wavelengths of the Mie data base [um] (DATA WAVE).
PHASE_WAVELENGTHS_UM: Final = np.array(
    [
        *(0.2, 0.3, 0.55, 0.6943, 1.06, 1.536, 2.0, 2.5, 2.7, 3.0, 3.2, 3.39, 5.0, 6.0, 7.2, 7.9, 8.7, 9.2, 10.0, 10.59),
        *(12.5, 15.0, 17.2, 18.5, 21.3, 30.0, 40.0),
    ]
)

_LEVELS, _COLUMNS, _NODES, _MODELS, _FUNCTIONS = 34, 63, 47, 26, 70

#: Aerosol models of the phase functions above the boundary layer: troposphere at 70 %, background stratosphere, meteoric dust.
ALOFT: Final = (18, 21, 26)

_FOGS: Final[dict[Haze, int]] = {"advective-fog": 24, "radiative-fog": 25}

#: Aerosol models before the four for rising humidity.
HUMID: Final[dict[Haze, int]] = {
    "rural-23km": 0, "rural-5km": 0, "navy-maritime": 4, "maritime-23km": 4, "urban": 8, "tropospheric": 16,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Dump:
    """Output file of a run, as read."""

    earth_radius: float  #: [km].
    #: ``tops``, ``humidity``, ``height``, ``pressure``, ``temperature``, ``refractivity``: Profiles as in
    #: :class:`~seaglint.air.scattering.scattering_laws.AirLevels`.
    tops: FloatArray
    humidity: FloatArray
    height: FloatArray
    pressure: FloatArray
    temperature: FloatArray
    refractivity: FloatArray
    density: FloatArray  #: All of LOWTRAN7's columns [(63, levels)].
    #: ``node_um``, ``node_extinction``, ``node_absorption``: Boundary-layer aerosol at LOWTRAN7's wavelengths [um], [1], [1]; (47,).
    node_um: FloatArray
    node_extinction: FloatArray
    node_absorption: FloatArray
    phase: FloatArray  #: Phase functions [sr-1, (26 aerosol models, wavelengths, angles)].
    wavenumber_cm: FloatArray  #: [cm-1, (n,)].
    #: ``abb``, ``log_coefficient``, ``power``, ``column``: Continuum coefficients (n, 17), and per gas (n, 11).
    abb: FloatArray
    log_coefficient: FloatArray
    power: FloatArray
    column: NDArray[np.int64]
    #: ``extinction``, ``absorption``, ``asymmetry``: Aerosols of the five regions [(n, 5)].
    extinction: FloatArray
    absorption: FloatArray
    asymmetry: FloatArray

    @classmethod
    def of(cls, raw: FloatArray) -> Dump:
        """Parse the doubles that the driver wrote."""
        sizes = (1, 4, *[_LEVELS] * 5, _COLUMNS * _LEVELS, *[_NODES] * 3, PHASE_WAVELENGTHS_UM.size * _MODELS)
        sizes = (*sizes, PHASE_ANGLES_DEG.size * _FUNCTIONS)
        edges = np.cumsum(sizes)
        if raw.size < edges[-1] or (raw.size - edges[-1]) % 66:
            raise BackendError("LOWTRAN7 wrote no laws; does the path reach its end, and is the profile sound?")
        radius, tops, humidity, height, pressure, kelvin, n, density, um, extinction, absorption, which, functions = np.split(
            raw[: edges[-1]], edges[:-1]
        )
        levels = int(np.argmax(height)) + 1
        number = which.reshape(_MODELS, PHASE_WAVELENGTHS_UM.size).astype(np.int64) - 1
        channels = raw[edges[-1] :].reshape(-1, 66)
        v, abb, log, power, column, ext, absorbed, asymmetry = np.split(channels, np.cumsum([1, 17, 11, 11, 11, 5, 5]), axis=1)
        return cls(
            float(radius[0]),
            tops,
            humidity[:levels],
            height[:levels],
            pressure[:levels],
            kelvin[:levels],
            n[:levels],
            density.reshape(_LEVELS, _COLUMNS).T[:, :levels],
            um,
            extinction,
            absorption,
            functions.reshape(_FUNCTIONS, -1)[number],
            v[:, 0],
            abb,
            log,
            power,
            column.astype(np.int64),
            ext,
            absorbed,
            asymmetry,
        )

    def spectral(self) -> SpectralLaws:
        """Return continua and bands."""
        banded = (self.log_coefficient > NO_BAND) & (self.column > 0)
        return SpectralLaws(
            self.wavenumber_cm,
            continuum_coefficients(self.abb),
            GasBands.of(
                np.where(banded, self.column, 0).T,
                np.where(banded, self.power, 0.0).T,
                np.where(banded, self.power * self.log_coefficient * np.log(10.0), 0.0).T,
            ),
        )

    def levels(self, columns: list[int]) -> AirLevels:
        """Return the atmosphere with some of LOWTRAN7's columns."""
        return AirLevels(
            self.earth_radius,
            self.height,
            self.pressure,
            self.temperature,
            self.refractivity,
            self.humidity,
            self.tops,
            self.density[[c - 1 for c in columns]],
        )

    def log_phase(self, haze: Haze) -> FloatArray:
        """Return the logarithm of the phase functions on the channels [(KINDS - 1, n, angles)]; linear in wavelength, as in LOWTRAN7."""
        below = [_FOGS[haze]] * len(HUMIDITIES) if haze in _FOGS else [HUMID.get(haze, 4) + 1 + i for i in range(len(HUMIDITIES))]
        table = np.log(self.phase[[number - 1 for number in (*below, *ALOFT)]])
        um = 1e4 / self.wavenumber_cm
        left = np.clip(np.searchsorted(PHASE_WAVELENGTHS_UM, um, side="right") - 1, 0, PHASE_WAVELENGTHS_UM.size - 2)
        part = (um - PHASE_WAVELENGTHS_UM[left]) / (PHASE_WAVELENGTHS_UM[left + 1] - PHASE_WAVELENGTHS_UM[left])
        out = (1.0 - part[:, None]) * table[:, left] + part[:, None] * table[:, left + 1]
        if haze == "desert":  # LOWTRAN7 takes Henyey and Greenstein's function there
            out[: len(HUMIDITIES)] = np.log(_henyey_greenstein(self.asymmetry[:, :1], np.radians(PHASE_ANGLES_DEG)))
        return np.asarray(out)

    def aerosol(self, haze: Haze) -> AerosolLaws:
        """Return the aerosols on the channels."""
        regions = len(self.tops)
        return AerosolLaws(
            self.extinction[:, :regions].T, self.absorption[:, :regions].T, np.radians(PHASE_ANGLES_DEG), self.log_phase(haze)
        )


def _henyey_greenstein(asymmetry: FloatArray, angle: FloatArray) -> FloatArray:
    g = asymmetry
    return np.asarray((1.0 - g**2) / (4.0 * np.pi * (1.0 + g**2 - 2.0 * g * np.cos(angle)) ** 1.5))


def dump(program: engine.Engine, air: LowtranAir, timeout: float = engine.TIMEOUT) -> Dump:
    """Run LOWTRAN7 for its laws, or read them from the cache.

    Raises
    ------
    BackendError
        The program crashed, hung, or wrote none.

    Notes
    -----
    Hazes whose extinction follows the mean humidity of the path take that of the way straight up.
    """
    case = LowtranCase(air, "sky", 0.0, 0.0)
    key = cache.key_of(program.identity, "laws", case.deck())
    arrays = cache.fetch(key)
    if arrays is None:
        arrays = {"laws": engine.run_laws(program.program, case, timeout)}
        cache.keep(key, arrays)
    return Dump.of(arrays["laws"])


def live_air(program: engine.Engine, air: LowtranAir, source: FloatArray, timeout: float = engine.TIMEOUT) -> ScatteringAir:
    """Return the scattering air of one of LOWTRAN7's atmospheres, for sunlight ``source`` outside it [W m-2 per cm-1, (n,)].

    Raises
    ------
    BackendError
        As :func:`dump`.
    """
    laws = dump(program, air, timeout)
    spectral = laws.spectral()
    return ScatteringAir.of(spectral, laws.levels(spectral.columns), laws.aerosol(air.aerosol.haze), source)
