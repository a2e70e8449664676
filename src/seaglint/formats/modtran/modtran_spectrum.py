"""Spectrum of one line of sight from any of MODTRAN's files: columns by meaning, checked, separated, in SI units.

Names of columns come from public source and readers: ``tape7`` of MODTRAN 4 and 5 (headers in subroutine ``T7HEAD``), pyradi's
``rymodtran`` (underscores for blanks), and the table of names in JSON, spectral library and tape7 of MODTRAN 6 in the tests of
github.com/brianschubert/pymod6 (``tests/test_io.py``).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError

Column = Literal[
    "wavenumber", "wavelength_um", "wavelength_nm", "transmittance", "thermal", "thermal_scattered", "surface", "scattered", "single",
    "ground", "direct", "total", "sun", "sun_outside", "sun_at_observer", "depth",
]  # fmt: skip

#: Meaning of a column by its name in capitals without anything but letters and digits.
NAMES: Final[dict[str, Column]] = {
    **dict.fromkeys(("FREQ", "FREQCM1", "WAVENUMBER", "FREQUENCY"), "wavenumber"),
    **dict.fromkeys(("WAVLENMCRN", "WAVLENUM", "WAVELENGTHUM", "WAVELENGTHMICRONS"), "wavelength_um"),
    **dict.fromkeys(("WAVLENNM", "WAVELENGTHNM"), "wavelength_nm"),
    **dict.fromkeys(("TOTTRANS", "TRANS", "TRAN", "TOTALTRANSMITTANCE", "TOTALTRANS"), "transmittance"),
    **dict.fromkeys(("PTHTHRML", "ATMOS", "THRMLEM", "PATHEMISSION"), "thermal"),
    **dict.fromkeys(("THRMLSCT", "PATHTHERMALSCAT"), "thermal_scattered"),
    **dict.fromkeys(("SURFEMIS", "SURFACEEMISSION"), "surface"),
    **dict.fromkeys(("SOLSCAT", "PATH", "MULTSCAT", "PATHMULTIPLESCAT"), "scattered"),
    **dict.fromkeys(("SINGSCAT", "SNGLSCAT", "SINGLE", "PATHSINGLESCAT"), "single"),
    **dict.fromkeys(("GRNDRFLT", "GROUND", "GROUNDREFLECT"), "ground"),
    **dict.fromkeys(("DRCTRFLT", "DIRECT", "DIRECTREFLECT"), "direct"),
    **dict.fromkeys(("TOTALRAD", "TOTALRADIANCE"), "total"),
    "SOLTR": "sun",
    "SOLAR": "sun_outside",
    **dict.fromkeys(("SOLOBS", "SOLATOBS", "IRRADIANCEATOBSERVER"), "sun_at_observer"),
    **dict.fromkeys(("DEPTH", "NATLOGPATHTRANS"), "depth"),
}

SPECTRAL: Final[tuple[Column, ...]] = ("wavenumber", "wavelength_um", "wavelength_nm")

PER_SQUARE_METRE: Final = 1e4  #: Factor from W cm-2 to W m-2.

AGREES: Final = 2e-2  #: Relative tolerance of the total radiance against its parts: three printed digits of up to five parts.


def column_of(label: str) -> Column | None:
    """Return the meaning of a column's name; None for one that is not used.

    >>> column_of("TOT TRANS"), column_of("path multiple scat"), column_of("HNO3")
    ('transmittance', 'scattered', None)
    """
    return NAMES.get(re.sub(r"[^A-Z0-9]", "", label.upper()))


@dataclass(frozen=True)
class ModtranSight:
    """Line of sight as a file states it; NaN where it does not.

    Heights in km and angles in degrees as MODTRAN has them: ``zenith_deg`` is the zenith angle of the line at H1 (ANGLE, OBSZEN), 180
    straight down. ``mode`` is IEMSCT (0 transmittance, 1 thermal, 2 thermal and solar, 3 sunlight), ``kind`` ITYPE (2 between heights,
    3 to space).
    """

    mode: int
    kind: int
    height_km: float
    zenith_deg: float
    end_km: float = np.nan
    azimuth_deg: float = np.nan
    solar_zenith_deg: float = np.nan


@dataclass(frozen=True, eq=False)
class ModtranSpectrum:
    """Spectrum of one line of sight in SI units."""

    where: str  #: File and case, as error messages call it.
    sight: ModtranSight | None  #: Geometry that the file states.
    wavenumber_cm: FloatArray  #: Ascending channels [cm-1, (n,)].
    transmittance: FloatArray | None  #: Transmittance [1, (n,)].
    thermal: FloatArray | None  #: Radiance of the path, emitted (and scattered thermal) [W m-2 sr-1 per cm-1, (n,)].
    scattered: FloatArray | None  #: Sunlight scattered into the path [W m-2 sr-1 per cm-1, (n,)].
    sun: FloatArray | None  #: Sunlight normal to the beam at H1 [W m-2 per cm-1, (n,)].

    def need(self, name: Literal["transmittance", "thermal", "scattered", "sun"]) -> FloatArray:
        """Return one of the four spectra; raise an error where the file has none.

        Raises
        ------
        DataError
            Naming the columns that hold it.
        """
        values: FloatArray | None = getattr(self, name)
        if values is None:
            columns, mode = _COLUMNS[name]
            raise DataError(f"{self.where}: has no {columns}; run it again with {mode}")
        return values


_COLUMNS: Final = {
    "transmittance": ("transmittance (TOT_TRANS, TRANS)", "IEMSCT = 1, 2 or 3"),
    "thermal": ("thermal path radiance (PTH_THRML, ATMOS, THRML_EM)", "IEMSCT = 1 or 2, RT_THERMAL_ONLY or RT_SOLAR_AND_THERMAL"),
    "scattered": ("scattered sunlight (SOL_SCAT, PATH, MULT_SCAT)", "IEMSCT = 2, RT_SOLAR_AND_THERMAL"),
    "sun": ("sunlight (SOL TR, SOL@OBS, SOL_AT_OBS)", "IEMSCT = 3, or 2 from the sea"),
}


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of one case as printed: W cm-2 (sr-1) per unit ``per``; rows as in the file, ``line`` is the number of the first.

    ``labels`` are the names of the columns in the file, for error messages; ``fine_depth`` is true for an optical depth of four digits,
    which is finer than four decimals of transmittance.
    """

    path: Path
    case: str
    columns: Mapping[Column, FloatArray]
    labels: tuple[str, ...]
    sight: ModtranSight | None = None
    line: int | None = None
    fine_depth: bool = False

    @property
    def where(self) -> str:
        """Return file and case."""
        return f"{self.path}: {self.case}"

    def at(self, row: int) -> str:
        """Return file, case and line of a row."""
        return f"{self.where}: " + (f"line {self.line + row}" if self.line is not None else f"sample {row + 1}")


def spectrum_of(table: Table) -> ModtranSpectrum:
    """Check the columns of a case and convert them to a spectrum.

    Raises
    ------
    DataError
        Columns missing, wavenumbers repeated or unsorted, -99 or other impossible values, nothing but zeros.
    """
    nu, reverse, per = _wavenumbers(table)
    if "transmittance" not in table.columns and "sun_at_observer" not in table.columns:
        raise DataError(f"{table.where}: its columns are {', '.join(table.labels)}; TOT_TRANS (TRANS) is missing; give the output of a run")
    for name, values in table.columns.items():
        if name not in SPECTRAL:
            _possible(table, name, values)
    scale = PER_SQUARE_METRE * per

    def ascending(values: FloatArray | None, factor: FloatArray | float) -> FloatArray | None:
        if values is None:
            return None
        out = values * factor
        return out[::-1].copy() if reverse else out

    thermal, scattered = _parted(table)
    sun = table.columns.get("sun", table.columns.get("sun_at_observer"))
    _require_light(table, thermal, sun)
    return ModtranSpectrum(
        where=table.where, sight=table.sight, wavenumber_cm=nu[::-1].copy() if reverse else nu,
        transmittance=ascending(_transmittance(table), 1.0),
        thermal=ascending(thermal, scale), scattered=ascending(scattered, scale), sun=ascending(sun, scale),
    )  # fmt: skip


def _wavenumbers(table: Table) -> tuple[FloatArray, bool, FloatArray | float]:
    """Return wavenumbers in the file's order [cm-1], whether they fall, and the factor that makes printed values per cm-1."""
    name = next((name for name in SPECTRAL if name in table.columns), None)
    if name is None:
        raise DataError(f"{table.where}: its columns are {', '.join(table.labels)}; FREQ (WAVLEN) is missing; give the output of a run")
    x = table.columns[name]
    if x.size < 2:
        raise DataError(f"{table.where}: has {x.size} spectral samples; at least 2 are needed: widen V1 to V2")
    bad = ~(np.isfinite(x) & (x > 0.0))
    if bad.any():
        row = int(np.argmax(bad))
        raise DataError(f"{table.at(row)}: {name} = {x[row]:g} is not above 0; run the case again with V1 above 0")
    # The median step shows the order of the file even if single samples are wrong.
    steps = np.diff(x)
    rising = float(np.sign(np.median(steps))) or 1.0
    wrong = steps * rising <= 0.0
    if wrong.any():
        row = int(np.argmax(wrong)) + 1
        how = "repeats the one before" if steps[row - 1] == 0.0 else "is out of order"
        raise DataError(f"{table.at(row)}: {name} = {x[row]:g} {how}; give each wavenumber once, in order, one case after the other")
    if name == "wavenumber":
        return x, rising < 0.0, 1.0
    # W cm-2 per um -> per cm-1: |d lambda / d nu| = lambda^2 / 1e4; per nm the files have microwatts (XFLAG = N), 1e-3 of it.
    um = x if name == "wavelength_um" else 1e-3 * x
    return 1e4 / um, rising > 0.0, um**2 * (1e-4 if name == "wavelength_um" else 1e-7)


def _possible(table: Table, name: Column, values: FloatArray) -> None:
    # Differences may come out a little below 0; -99 marks values that were never computed.
    bad = ~np.isfinite(values)
    largest = float(np.max(np.abs(values), where=~bad, initial=0.0))
    if name in ("direct", "ground", "single", "thermal_scattered", "surface", "total"):
        bad |= values <= -9.0
    else:
        bad |= (values < -1e-4 * largest) | (values <= -9.0)
    if name == "transmittance":
        bad |= values > 1.0 + 1e-4
    if bad.any():
        row = int(np.argmax(bad))
        allowed = "0 to 1" if name == "transmittance" else "0 or more"
        why = "that is the mark for no value" if values[row] <= -9.0 else "the run failed or the column is another one"
        raise DataError(f"{table.at(row)}: {_label(name)} = {values[row]:g}, allowed: {allowed}; {why}, run the case again")


def _label(name: Column) -> str:
    return {"thermal": "thermal radiance", "scattered": "scattered radiance", "depth": "optical depth"}.get(name, name.replace("_", " "))


def _parted(table: Table) -> tuple[FloatArray | None, FloatArray | None]:
    """Return thermal and scattered radiance; the total decides which of the columns include the others.

    PTH_THRML and SOL_SCAT of tape7 are totals of which THRML_SCT and SING_SCAT are parts (MODTRAN 4 and 5, subroutine TRANS:
    ``SUMT = RADCUM + BBG + SUMSSR + RFSURF``). MODTRAN 6 calls the same columns path emission and path multiple scat; should they be
    parts there, their sum with the others is what meets TOTAL_RAD.
    """
    c = table.columns
    thermal, scattered = c.get("thermal"), c.get("scattered", c.get("single"))
    if thermal is None or "total" not in c:
        return thermal, scattered
    zero = np.zeros_like(thermal)
    part, single = c.get("thermal_scattered", zero), c.get("single", zero)
    sun = zero if scattered is None else scattered
    rest = c["total"] - c.get("surface", zero) - c.get("ground", zero)
    largest = float(np.max(np.abs(c["total"])))
    choices = [(thermal, sun), (thermal, sun + single), (thermal + part, sun), (thermal + part, sun + single)]
    misses = [float(np.mean(np.abs(a + b - rest))) for a, b in choices]
    # The first is tape7's own meaning; another must be clearly better than it and than rounding.
    best = int(np.argmin(misses))
    if misses[best] > 0.5 * misses[0] or misses[0] <= 5e-3 * largest:
        best = 0
    if misses[best] > AGREES * largest:
        raise DataError(
            f"{table.where}: its parts miss the total radiance (TOTAL_RAD) by {misses[best] / max(largest, 1e-300):.3g} times itself; "
            "columns have moved or are of another version, so give the tape7, CSV or JSON as MODTRAN 4-6 wrote it"
        )
    parts = choices[best]
    return parts[0], None if scattered is None else parts[1]


def _transmittance(table: Table) -> FloatArray | None:
    """Return the transmittance, from the printed optical depth where that has more digits than four decimals of transmittance."""
    printed, depth = table.columns.get("transmittance"), table.columns.get("depth")
    if printed is None:
        return None
    printed = np.minimum(printed, 1.0)
    if depth is None or depth.max() <= 0.0:
        return printed
    # The optical depth resolves small and large transmittances, where four decimals are coarse.
    exact = np.exp(-depth)
    off = np.abs(exact - printed) > 6e-4 + 2e-3 * printed
    if off.any():
        row = int(np.argmax(off))
        raise DataError(
            f"{table.at(row)}: transmittance {printed[row]:g} and optical depth {depth[row]:g} do not belong together; "
            "columns have moved or were edited, so give the file as MODTRAN wrote it"
        )
    return np.asarray(np.where((printed < 0.05) | (printed > 0.9), exact, printed)) if table.fine_depth else printed


def _require_light(table: Table, thermal: FloatArray | None, sun: FloatArray | None) -> None:
    """Refuse a case of zeros alone."""
    outside = table.columns.get("sun_outside")
    if thermal is not None and not thermal.any():
        raise DataError(f"{table.where}: thermal radiance is 0 everywhere; is IEMSCT 1 or 2, and did the run end well?")
    dark = sun is not None and not sun.any() and (outside is None or not outside.any())
    if thermal is None and "scattered" not in table.columns and dark:
        raise DataError(f"{table.where}: sunlight is 0 everywhere, outside the air too; run it again with the Sun above the horizon")
