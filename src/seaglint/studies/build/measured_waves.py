"""Waves of a scenario from measured wavenumber spectra: of a file, or of one of the campaigns in the package."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import travel_azimuth
from seaglint.base.errors import DomainError, Mistake, ScenarioError
from seaglint.base.free_form import JsonObject
from seaglint.scenario.records import sea_tables as requested_sea
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.sea.spectra.campaigns import campaign_table
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.saturation import SaturationSpectrum
from seaglint.sea.spectra.saturation_table import SaturationTable, mixed

log = logging.getLogger(__name__)

MANY_SLOPES: Final = 3.0  #: Slope variance of a measured spectrum over that of Cox and Munk's fit from which a line reports it.

_KEYS: Final = ("from_deg", "spreading_deg", "shorter_waves", "longer_waves")  # keys that the physics refuses by their names


@dataclass(frozen=True)
class Waves:
    """A spectrum, None for a sea without waves, and the sources of spectra from files."""

    spectrum: DirectionalSpectrum | None
    #: For the provenance, one for every file and measured sea: its name and format, and what of it is used.
    sources: tuple[JsonObject, ...] = ()


def measured_waves(system: requested_sea.MeasuredWaves, speed: float, wind_to: float, key: str) -> Waves:
    """Return the waves of a measured wavenumber spectrum; its table in the scenario has the dotted name ``key``.

    Joins with a model, and a slope variance far above Cox and Munk's, are reported once.

    Raises
    ------
    ScenarioError
        A wind outside the measured ones, or keys that do not fit the table.
    DataError
        A file that cannot be used.
    """
    try:
        return _waves(system, _stamp(system), speed, wind_to, key)
    except DomainError as error:
        name = "wind.speed_m_s" if error.name == "wind_speed" else f"{key}.{error.name}" if error.name in _KEYS else None
        if name is None:
            raise
        # a text on one of the keys continues its name, as for other files of waves
        text = f"{name}: {error}" if error.name == "wind_speed" else f"{name} {error}"
        raise ScenarioError(text, mistakes=(Mistake(name, error.value, error.allowed, text),)) from error


def has_winds(system: requested_sea.MeasuredWaves) -> bool:
    """Return true where a measured spectrum is of stated winds, false where it holds for any."""
    return _table(system, _stamp(system)).winds.size > 0


def _stamp(system: requested_sea.MeasuredWaves) -> tuple[int, int]:
    """Return size and time of a file or the files of a store, by which a changed one is read again."""
    if not isinstance(system, requested_sea.WavenumberFile):
        return 0, 0
    path = system.path
    states = [part.stat() for part in (path.rglob("*") if path.is_dir() else [path]) if part.is_file()]
    return sum(state.st_size for state in states), max((state.st_mtime_ns for state in states), default=0)


@lru_cache(maxsize=32)
def _table(system: requested_sea.MeasuredWaves, stamp: tuple[int, int]) -> SaturationTable:
    match system:
        case requested_sea.WavenumberFile(path=path):
            from seaglint.formats.waves.wavenumber_spectra import read_wavenumber_spectra

            return read_wavenumber_spectra(path)
        case requested_sea.AsitSea(kind=name) | requested_sea.RadyoSea(kind=name):
            return campaign_table(name)
        case other:
            raise AssertionError(other)


@lru_cache(maxsize=32)  # a scenario's waves are built several times, and quantities of a spectrum are cached by its identity
def _waves(system: requested_sea.MeasuredWaves, stamp: tuple[int, int], speed: float, wind_to: float, key: str) -> Waves:
    table = _table(system, stamp)
    to = None if system.from_deg is None else travel_azimuth(np.radians(system.from_deg))
    width = None if system.spreading_deg is None else float(np.radians(system.spreading_deg))
    parts = table.parts(speed, wind_to, to_azimuth=to, width=width, longer=system.longer_waves, shorter=system.shorter_waves)
    spectrum = mixed(parts)
    name = system.path.name if isinstance(system, requested_sea.WavenumberFile) else system.kind
    directions = "delta or half width of the table" if table.has_directions else "width as stated" if width else "Elfouhaily's at the wind"
    joins = _joined([row.wind for _, row in table.shares(speed)], [one for _, one in parts], system)
    log.info("seaglint: %s = '%s' (%s): %s; directions: %s", key, system.kind, name, joins, directions)
    _report_many_slopes(sum(spectrum.mss()), speed, name)
    report: JsonObject = {
        "file" if isinstance(system, requested_sea.WavenumberFile) else "measured_sea": name,
        "format": system.kind,
        "directions": directions,
        "joins": joins,
        "winds_m_s": [row.wind for _, row in table.shares(speed) if row.wind is not None],
        "weights": [share for share, _ in parts],
        "significant_height_m": spectrum.significant_height(),
        "slope_variance": sum(spectrum.mss()),
    }
    if isinstance(system, requested_sea.WavenumberFile):
        report["sha256"] = digest(system.path)
    return Waves(spectrum, (report,))


def _joined(winds: Sequence[float | None], rows: Sequence[SaturationSpectrum], system: requested_sea.MeasuredWaves) -> str:
    """Return the ranges of the interpolated rows of a measured spectrum and their joins in one sentence."""
    longest, shortest = zip(*(one.joins() for one in rows), strict=True)
    ranges = _each([f"{low.wavenumber:.4g}-{high.wavenumber:.4g}" for low, high in zip(longest, shortest, strict=True)])
    at = "" if None in winds else f" at {_each([f'{wind:.4g}' for wind in winds])} m/s"
    ends = []
    for joins, choice, word in ((longest, system.longer_waves, "below"), (shortest, system.shorter_waves, "above")):
        if choice == "cut":
            ends.append(f"no waves {word}")
        elif all(join.model == 0.0 for join in joins):
            ends.append(f"no waves {word} (Elfouhaily's spectrum has none there either)")
        else:
            measured, model = (_each([f"{getattr(join, name):.3g}" for join in joins]) for name in ("measured", "model"))
            ends.append(f"Elfouhaily's spectrum {word} (saturation {measured} measured, {model} modelled)")
    return f"measured {ranges} rad/m{at}, with {' and '.join(ends)}"


def _each(texts: Sequence[str]) -> str:
    """Return the texts of the rows in words, once where they are equal."""
    return " and ".join(dict.fromkeys(texts))


@lru_cache(maxsize=64)
def _report_many_slopes(mss: float, speed: float, name: str) -> None:
    """Report once a slope variance far above Cox and Munk's."""
    expected = cox_munk_isotropic(speed, extrapolate=True).mss
    if mss >= MANY_SLOPES * expected:
        log.warning(
            "seaglint: %s has a slope variance of %.2g at %.3g m/s, %.2g times Cox and Munk's (%.2g); check the units: wavenumbers in "
            "rad/m or cycles/m, and which of saturation, elevation_m3 and slope_m the values are",
            name,
            mss,
            speed,
            mss / expected,
            expected,
        )


def digest(path: Path) -> str:
    """Return the digest of a file; of the folder of a store, of the names and contents of all its files."""
    import hashlib

    if path.is_file():
        return hashlib.sha256(path.read_bytes()).hexdigest()
    total = hashlib.sha256()
    for file in sorted(part for part in path.rglob("*") if part.is_file()):
        total.update(file.relative_to(path).as_posix().encode() + b"\0" + file.read_bytes())
    return total.hexdigest()
