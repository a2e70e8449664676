"""Comparison of a user's measured spectrum of sky or sea with the spectrum of a scenario.

LOWTRAN7's channels lie every 5 cm-1 and are averages over 20 cm-1. A finer spectrum is averaged to that with a triangle; of a coarser one
ours is averaged to its resolution.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import GRID_STEP_CM
from seaglint.air.sun_and_sky import brightness_temperature
from seaglint.base.conventions import FloatArray, horizon_depression, view_zenith
from seaglint.base.errors import DataError
from seaglint.base.limits import PROFILE_BAND_UM
from seaglint.facet.sea_view import SeaView, sea_arc
from seaglint.facet.surface_spectra import SeaSurface
from seaglint.formats.tables.spectra import MeasuredLight, SpectraBeside, read_spectrum, spectrum_of_columns
from seaglint.optics.band import Band, triangular_average
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.atmosphere_table import LowtranAtmosphere, TableAtmosphereSettings
from seaglint.studies.build import scenario_physics
from seaglint.studies.measured.measured_numbers import SPECTROSCOPIES, band_difference

OURS_CM: Final = 20.0  #: Resolution of LOWTRAN7's channels [cm-1].

FINE_SHARE: Final = 0.9  #: Resolution, in parts of ours, below which a spectrum is averaged [1].

COARSEST_SHARE: Final = 0.5  #: Largest part of a spectrum that one of its samples may average over [1].

SUNNY_UM: Final = 5.5  #: Wavelength above which sunlight is left out [um].

#: Most parts of a spectrum in which mirrored and scattered sunlight is summed; inside a part it has the shape of direct sunlight.
BLOCKS: Final = 24

#: Bands of the table, where the spectrum covers them [um].
USUAL_BANDS: Final = (
    *((1.5, 1.8), (2.0, 2.4), (3.0, 5.0), (3.5, 4.1), (4.4, 5.0), (5.5, 7.5)),
    *((8.0, 9.2), (9.2, 10.0), (10.0, 12.0), (8.0, 12.0), (13.0, 14.0)),
)


@dataclass(frozen=True)
class ComparedBand:
    """A band of a compared spectrum."""

    band_um: tuple[float, float]  #: Its wavelengths [um].
    ours_k: float  #: Our apparent temperature [K].
    measured_k: float  #: Measured apparent temperature [K].
    difference_k: float  #: Ours less measured, of the temperatures [K].
    difference_percent: float  #: Ours less measured, of the band radiances [%].
    rms_k: float  #: Root of the mean square difference of the samples' brightness temperatures [K].


@dataclass(frozen=True, eq=False)
class SpectrumComparison:
    """Measured spectrum beside the spectrum of a scenario."""

    wavenumber_cm: FloatArray  #: Samples of the comparison [cm-1, (n,)].
    measured: FloatArray  #: Measured radiance at the resolution of the comparison [W m-2 sr-1 per cm-1, (n,)].
    ours: FloatArray  #: Our radiance at that resolution [W m-2 sr-1 per cm-1, (n,)].
    resolution_cm: float  #: That resolution, full width at half maximum [cm-1].
    elevation_deg: float  #: Direction looked at [deg]; negative towards the sea.
    bands: tuple[ComparedBand, ...]  #: Numbers by band.
    notes: tuple[str, ...]  #: Averages, omissions and assumptions.
    name: str  #: Name of the spectrum.

    def beside(self) -> SpectraBeside:
        """Return brightness temperatures for a picture."""
        kelvin = [brightness_temperature(self.wavenumber_cm, light) for light in (self.measured, self.ours)]
        title = f"{Path(self.name).name}, elevation {self.elevation_deg:g} deg, {self.resolution_cm:g} cm-1"
        return SpectraBeside(title, "brightness temperature [K]", self.wavenumber_cm, kelvin[0], {"seaglint": kelvin[1]})

    def columns(self) -> dict[str, FloatArray]:
        """Return the spectra by column names."""
        nu = self.wavenumber_cm
        names = ("measured", "ours")
        light = dict(zip(names, (self.measured, self.ours), strict=True))
        out = {"wavenumber_cm": nu, "wavelength_um": 1e4 / nu}
        out |= {f"{name}_radiance_w_m2_sr_cm": values for name, values in light.items()}
        return out | {f"{name}_brightness_temperature_k": brightness_temperature(nu, values) for name, values in light.items()}

    def lines(self) -> list[str]:
        """Return the table by band as text."""
        out = [f"{'band um':>11} {'ours K':>9} {'measured K':>11} {'diff. K':>8} {'diff. %':>8} {'rms K':>7}"]
        for row in self.bands:
            band = f"{row.band_um[0]:.4g}-{row.band_um[1]:.4g}"
            temperatures = f"{row.ours_k:9.2f} {row.measured_k:11.2f} {row.difference_k:+8.2f}"
            out.append(f"{band:>11} {temperatures} {row.difference_percent:+8.1f} {row.rms_k:7.2f}")
        return out


THERMAL_CM: Final = 1800.0  #: Wavenumber below which sunlight counts for nothing [cm-1].

BELIEVABLE_K: Final = (60.0, 360.0)  #: Temperatures of sky and sea [K].


def compare_spectrum(
    spectrum: str | Path | Mapping[str, ArrayLike] | MeasuredLight,
    scenario: Scenario,
    *,
    resolution_cm: float | None = None,
    zenith_deg: float | None = None,
    depression_deg: float | None = None,
    spectroscopy: str | None = None,
) -> SpectrumComparison:
    """Compare a measured spectrum with the spectrum of a scenario; see :func:`sg.compare_spectrum`.

    Raises
    ------
    SeaglintError
        A spectrum without unit, negative, too short or outside the air's wavelengths; a direction or resolution that cannot be.
    """
    light = stated_spectrum(spectrum)
    if spectroscopy is not None and spectroscopy not in SPECTROSCOPIES:
        raise DataError(f"spectroscopy = '{spectroscopy}' is not one of {', '.join(SPECTROSCOPIES)}")
    elevation = _elevation(scenario, zenith_deg, depression_deg)
    light, notes = _inside(light)
    width, more = _resolution(light, resolution_cm)
    notes += more
    parts, measured = _sampled(light, width)
    ours_width = max(width, OURS_CM)
    ours = [_ours(scenario, nu, elevation, ours_width, spectroscopy) for nu in parts]
    nu = np.concatenate(parts)
    ours_joined, measured_joined = np.concatenate(ours), np.concatenate(measured)
    if not ours_joined.any():
        raise DataError("the scenario has no light in this direction: no air above the sensor, or a black sky; choose another direction")
    notes += _unbelievable(nu, measured_joined)
    bands = tuple(row for part, mine, theirs in zip(parts, ours, measured, strict=True) for row in _bands(part, mine, theirs))
    return SpectrumComparison(nu, measured_joined, ours_joined, ours_width, math.degrees(elevation), bands, tuple(notes), light.name)


def _unbelievable(nu: FloatArray, measured: FloatArray) -> list[str]:
    """Return a line on a spectrum beyond 5.5 um with temperatures that no sky or sea has."""
    thermal = nu < THERMAL_CM
    if not thermal.any():
        return []
    kelvin = brightness_temperature(nu[thermal], measured[thermal])
    middle = float(np.median(kelvin)) if np.isfinite(kelvin).all() else math.inf
    if BELIEVABLE_K[0] <= middle <= BELIEVABLE_K[1]:
        return []
    what = "no temperature" if math.isinf(middle) else f"{middle:.0f} K"
    return [f"the measured spectrum has {what} in the median beyond 5.5 um, which no sky or sea has; is its unit right?"]


def stated_spectrum(spectrum: str | Path | Mapping[str, ArrayLike] | MeasuredLight) -> MeasuredLight:
    """Return the spectrum of a file or of columns; a spectrum is returned unchanged.

    Raises
    ------
    DataError
        As ``seaglint.formats.tables.spectra.read_spectrum``.
    """
    if isinstance(spectrum, MeasuredLight):
        return spectrum
    return spectrum_of_columns(spectrum) if isinstance(spectrum, Mapping) else read_spectrum(spectrum)


def _elevation(scenario: Scenario, zenith_deg: float | None, depression_deg: float | None) -> float:
    """Return the elevation of the line of sight [rad]."""
    if zenith_deg is not None and depression_deg is not None:
        raise DataError("zenith_deg and depression_deg are both given; give the one for the sky or the one for the sea")
    height = scenario.sensor.height_m
    dip = horizon_depression(height)
    if zenith_deg is not None:
        if not 0.0 <= zenith_deg <= 90.0:
            raise DataError(f"zenith_deg = {zenith_deg:g} is outside 0-90, the sky; give depression_deg for the sea")
        return math.radians(90.0 - zenith_deg)
    if depression_deg is not None:
        if not math.degrees(dip) < depression_deg <= 90.0:
            raise DataError(
                f"depression_deg = {depression_deg:g} does not meet the sea: seen from {height:g} m it begins "
                f"{math.degrees(dip):.3f} deg below the horizontal and ends at 90"
            )
        return -math.radians(depression_deg)
    return math.radians(scenario.sensor.elevation_deg)


def _inside(light: MeasuredLight) -> tuple[MeasuredLight, list[str]]:
    """Return the part of a spectrum that the air's band laws cover, and notes."""
    low, high = PROFILE_BAND_UM
    nu = light.wavenumber_cm
    keep = (nu >= 1e4 / high) & (nu <= 1e4 / low)
    ends = f"{1e4 / nu[-1]:.4g}-{1e4 / nu[0]:.4g} um"
    if np.count_nonzero(keep) < 3:
        raise DataError(f"{light.name}: its {ends} lie outside the {low:g}-{high:g} um of the air's band laws; choose another part")
    notes = [] if keep.all() else [f"{light.name}: of {ends} only what lies within {low:g}-{high:g} um is compared"]
    return replace(light, wavenumber_cm=nu[keep], radiance=light.radiance[keep]), notes


def _resolution(light: MeasuredLight, stated: float | None) -> tuple[float, list[str]]:
    """Return the resolution of a spectrum [cm-1], and notes on it."""
    notes = []
    nu = light.wavenumber_cm
    width = light.resolution_cm if stated is None else stated
    if width is None:
        width = float(np.median(np.diff(nu)))
        notes.append(f"{light.name}: has no column or comment resolution_cm; {width:.3g} cm-1, the spacing of its samples, is taken")
    if not 0.0 < width < np.inf:
        raise DataError(f"resolution_cm = {width:g} is not a width above 0 cm-1")
    if width < FINE_SHARE * OURS_CM:
        notes.append(f"{light.name}: averaged from {width:.3g} to {OURS_CM:g} cm-1, the resolution of the band laws")
    elif width > OURS_CM:
        span = float(nu[-1] - nu[0])
        if width > COARSEST_SHARE * span:
            raise DataError(
                f"resolution_cm = {width:g} is more than half of the spectrum's {span:.0f} cm-1: it is one number, not a spectrum; "
                "compare it with 'seaglint mean' in its band"
            )
        notes.append(f"{light.name}: ours is averaged from {OURS_CM:g} to its {width:.3g} cm-1")
    return width, notes


def _sampled(light: MeasuredLight, width: float) -> tuple[list[FloatArray], list[FloatArray]]:
    """Return the parts of the spectrum without gaps, on multiples of 5 cm-1, at 20 cm-1 or coarser: wavenumbers and radiances."""
    nu = light.wavenumber_cm
    # An average needs samples everywhere; a spectrum that is not averaged is linear between its samples.
    gap = 1.001 * (OURS_CM if width < FINE_SHARE * OURS_CM else 2.0 * width)
    # A gap divides the spectrum, because an average across it would invent samples.
    starts = np.concatenate([[0], np.flatnonzero(np.diff(nu) > gap) + 1, [nu.size]])
    # Widths of triangles add by their squares; an average begins its width inside the samples, so that none is cut.
    more = math.sqrt(OURS_CM**2 - width**2) if width < FINE_SHARE * OURS_CM else 0.0
    grids, values = [], []
    for first, end in pairwise(starts):
        at, radiance = nu[first:end], light.radiance[first:end]
        grid = _multiples(float(at[0]) + more, float(at[-1]) - more)
        if grid.size < 3:
            continue
        grids.append(grid)
        values.append(triangular_average(at, radiance, grid, more) if more > 0.0 else np.interp(grid, at, radiance))
    if not grids:
        raise DataError(
            f"{light.name}: its samples leave nothing to compare: parts without a gap wider than {gap:.3g} cm-1 have to be at least "
            f"{2.0 * more + 2.0 * GRID_STEP_CM:.0f} cm-1 long; give more samples, or the resolution of each (resolution_cm)"
        )
    return grids, values


def _multiples(low: float, high: float) -> FloatArray:
    """Return multiples of the channels' step from ``low`` to ``high`` [cm-1]."""
    first, last = math.ceil(low / GRID_STEP_CM - 1e-9), math.floor(high / GRID_STEP_CM + 1e-9)
    return GRID_STEP_CM * np.arange(first, last + 1, dtype=np.float64)


def _ours(scenario: Scenario, nu: FloatArray, elevation: float, width: float, spectroscopy: str | None) -> FloatArray:
    """Return the spectrum of the scenario at some of the channels [W m-2 sr-1 per cm-1, (n,)], averaged to a resolution."""
    # Widths of triangles add by their squares.
    more = math.sqrt(max(width**2 - OURS_CM**2, 0.0))
    low, high = PROFILE_BAND_UM
    # The average at the edges needs channels beyond them, as far as the band laws reach.
    wide = _multiples(max(float(nu[0]) - more - GRID_STEP_CM, 1e4 / high), min(float(nu[-1]) + more + GRID_STEP_CM, 1e4 / low))
    view = scenario_physics.view(_of_band(scenario, wide, spectroscopy))
    grid = view.atmosphere.wavenumber_cm
    full = scene_spectrum(view, elevation, math.radians(scenario.sensor.azimuth_deg))
    return triangular_average(grid, full, nu, more) if more > GRID_STEP_CM else np.interp(nu, grid, full)


def _of_band(scenario: Scenario, nu: FloatArray, spectroscopy: str | None) -> Scenario:
    """Return the scenario over the wavelengths of channels, with air computed wherever the band laws reach."""
    air = scenario.atmosphere
    if isinstance(air, TableAtmosphereSettings):  # the same air, which knows no gap at 5.5-7.5 um
        shared = (type(air).model_fields.keys() & LowtranAtmosphere.model_fields.keys()) - {"source"}
        air = LowtranAtmosphere(**{name: getattr(air, name) for name in shared})
    if spectroscopy is not None and "spectroscopy" in type(air).model_fields:
        air = air.model_copy(update={"spectroscopy": spectroscopy})
    band = scenario.band.model_copy(update={"min_um": 1e4 / float(nu[-1]), "max_um": 1e4 / float(nu[0]), "response": None})
    return scenario.model_copy(update={"atmosphere": air, "band": band, "platform": None})


def scene_spectrum(view: SeaView, elevation: float, azimuth: float) -> FloatArray:
    """Return the mean radiance of a view in one direction on its air's samples [W m-2 sr-1 per cm-1, (n,)].

    Sunlight that the sea mirrors and the air scatters is summed in at most ``BLOCKS`` parts of the spectrum below 5.5 um; inside a part
    it has the shape of the direct sunlight behind the path.
    """
    air, height = view.atmosphere, view.sensor_height
    grid = air.wavenumber_cm
    if elevation > -horizon_depression(height):
        thermal, passed = air.sky_radiance(0.5 * np.pi - elevation, azimuth, height), np.ones(grid.size)
    else:
        zenith = float(view_zenith(height, -elevation))
        arc = sea_arc(height, np.array([0.5 * np.pi - zenith]))
        passed = air.transmittance(height, arc)[0]
        surface = SeaSurface.create(air, view.water, view.sea_temperature)
        leaving = surface.leaving(zenith, azimuth + np.pi, view.slopes, view.hiding.law_bands(view.slopes))
        thermal = air.path_radiance(height, arc)[0] + passed * (leaving.emission + leaving.sky)
    return np.asarray(thermal + _sunlight(view, elevation, azimuth, thermal, passed))


def _sunlight(view: SeaView, elevation: float, azimuth: float, thermal: FloatArray, passed: FloatArray) -> FloatArray:
    """Return mirrored and scattered sunlight [W m-2 sr-1 per cm-1, (n,)]."""
    grid = view.atmosphere.wavenumber_cm
    out = np.zeros(grid.size)
    sunny = np.flatnonzero(grid >= 1e4 / SUNNY_UM)
    if view.solar_zenith >= 0.5 * np.pi or sunny.size < 2:
        return out
    shape = passed * view.atmosphere.solar_irradiance(view.solar_zenith)
    # Mirrored and scattered sunlight is summed per part and distributed by the shape of the direct sunlight.
    edges = np.unique(np.linspace(sunny[0], grid.size - 1, min(BLOCKS, sunny.size - 1) + 1).round().astype(int))
    for first, last in pairwise(edges):
        band = Band.rectangular(1e4 / float(grid[last]), 1e4 / float(grid[first]))
        part = replace(view, band=band)
        weights = band.weights(grid)
        excess = float(mean_radiance(part, elevation, azimuth).total[0, 0]) - float(thermal @ weights)
        # An opaque part has no direct sunlight to give the shape.
        form = shape if float(shape @ weights) > 0.0 else np.ones(grid.size)
        # Parts share their edges; each edge belongs to the part that begins there, the last one to the last part.
        inside = slice(first, last + 1 if last == grid.size - 1 else last)
        out[inside] = max(excess, 0.0) * form[inside] / float(form @ weights)
    return out


def _bands(nu: FloatArray, ours: FloatArray, measured: FloatArray) -> list[ComparedBand]:
    """Return the numbers of the usual bands that a part of the spectrum covers, and of the whole part."""
    low, high = 1e4 / float(nu[-1]), 1e4 / float(nu[0])
    chosen = [band for band in USUAL_BANDS if low <= band[0] and band[1] <= high]
    kelvin = (brightness_temperature(nu, ours), brightness_temperature(nu, measured))
    rows = []
    for band in [*chosen, (low, high)]:
        difference = band_difference(nu, ours, measured, band, kelvin)
        rows.append(ComparedBand(band, difference.ours, difference.measured, difference.kelvin, difference.percent, difference.rms))
    return rows
