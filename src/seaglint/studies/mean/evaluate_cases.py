"""Results for tables of cases, row by row: the air, scattered sunlight, and the emissivity and mean radiance of the sea.

Each function takes the cases of a CSV file (``seaglint.formats.tables.input_tables``) and returns columns by name, in the order of the
rows; ``labelled_cases`` makes a dataset of them, with bands as an axis. Slope models are named in the rows. Continuous air is summed
ray by ray with LOWTRAN7's band laws.
"""

from __future__ import annotations

import os
import re
from collections.abc import Hashable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import product
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.air.lowtran_table import BatchAtmosphere, table_models
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.base.conventions import FloatArray, Progress, horizon_depression, travel_azimuth
from seaglint.base.errors import DomainError
from seaglint.base.limits import COX_MUNK_WIND, NAVY_AEROSOL_WIND, TOP_OF_AIR, WIND_PROFILE
from seaglint.base.parameters import documented
from seaglint.formats.tables.input_tables import Cases, Column
from seaglint.optics.band import Band, apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.moonlight import MEAN_MOON_DISTANCE, moon_radius, moon_to_sun
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.scenario.records.sea_tables import Sea
from seaglint.sea.slopes.cox_munk import WIND_HEIGHT, cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic
from seaglint.sea.slopes.from_spectrum import nested_in, spectrum_slopes
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, at_least_residual
from seaglint.sea.spectra.campaign_draws import ShortWaveLevels, drawn_sea
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.studies.build.waves_and_slopes import elfouhaily
from seaglint.studies.sea_draws import COUNT, HIGH, LOW, SeaUnknown, levels_of, sea_line
from seaglint.studies.study_requests import AirRequest, EvaluationRequest, MeanCasesRequest

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.facet.sea_view import SeaView
    from seaglint.facet.surface_spectra import SeaSurface

Columns = dict[str, FloatArray | list[str]]

#: Column of the cases of the mean that may be missing: where the wind comes from, clockwise from the Sun's azimuth.
WIND_FROM: Final = "wind_from_deg"

#: Others that may be missing, together: the Moon, its azimuth clockwise from the Sun's.
MOON: Final = ("moon_zenith_deg", "moon_azimuth_deg", "moon_phase_deg")

SLOPES: Final = "slopes"  #: Another that may be missing: the slope model of each row, one of ``SLOPE_KINDS``.

SLOPE_KINDS: Final = ("cox-munk-isotropic", "cox-munk-anisotropic", "cox-munk-gram-charlier")

SHORTEST_WAVE: Final = Sea().shortest_wave_m  #: Shortest wave that is geometry, as in a scenario [m].

EXTRAPOLATED: Final = "extrapolated"  #: Column with the names of the extrapolated columns of each row, if extrapolation is requested.

ATMOSPHERE_INPUTS: Final = (
    "atmosphere", "wind_speed_m_s", "sensor_height_m", "depression_deg", "solar_zenith_deg", "sky_zenith_deg",
)  # fmt: skip
EMISSIVITY_INPUTS: Final = ("wavelength_um", "wind_speed_m_s", "zenith_deg")
MEAN_INPUTS: Final = (
    "atmosphere", "wind_speed_m_s", "sensor_height_m", "depression_deg", "solar_zenith_deg", "relative_azimuth_deg", "sea_temperature_k",
    "ifov_mrad",
)  # fmt: skip

MEAN_COLUMNS: Final = ("radiance_W_m2_sr", "apparent_temperature_K", "std_W_m2_sr")  #: Columns of the mean radiance, for each band.

TABLE_SEED: Final = 1  #: Seed of the seas that are drawn for a table, a scenario's default.

SCATTERED_INPUTS: Final = (
    "kind", "atmosphere", "wind_speed_m_s", "sensor_height_m", "elevation_deg", "azimuth_from_sun_deg", "solar_zenith_deg",
)  # fmt: skip

#: Units by the ending of a column's name, longer endings first.
UNITS: Final = {"_W_m2_sr": "W m-2 sr-1", "_W_m2": "W m-2", "_K": "K", "_k": "K", "_deg": "degree", "_m_s": "m s-1", "_um": "um", "_m": "m"}

SHARES: Final = ("emissivity", "tau_mean", COUNT)  #: Columns without a unit.

_CHUNK: Final = 1024  #: Rows at a time: their spectra (2 MB each) stay near the processor.

_THREADS: Final = min(os.cpu_count() or 1, 4)


def slope_kinds(cases: Cases, directed: bool) -> NDArray[np.str_]:
    """Return the slope model of every row; models with a direction need the wind's direction."""
    if SLOPES not in cases.header:
        return np.full(len(cases), SLOPE_KINDS[1 if directed else 0])
    kinds = np.array(cases.choice(SLOPES, SLOPE_KINDS))
    if not directed:
        cases.check(
            kinds == SLOPE_KINDS[0],
            SLOPES,
            lambda row: f"'{kinds[row]}' depends on the wind's direction; add a column {WIND_FROM}, or give '{SLOPE_KINDS[0]}'",
        )
    return kinds


def slopes_of(kind: str, speed: float, towards: float, extrapolate: bool) -> SlopeStatistics:
    """Return the slopes of a wind at 10 m towards an azimuth [rad], over waves of Elfouhaily's spectrum, a scenario's default."""
    statistics = _law(kind, speed, towards, extrapolate)
    return statistics if kind == SLOPE_KINDS[0] else replace(statistics, nesting=_nesting(kind, speed, extrapolate))


def _law(kind: str, speed: float, towards: float, extrapolate: bool) -> SlopeStatistics:
    if kind == SLOPE_KINDS[0]:
        return cox_munk_isotropic(speed, extrapolate=extrapolate)
    directed = cox_munk_anisotropic if kind == SLOPE_KINDS[1] else cox_munk_gram_charlier
    return directed(speed, towards, extrapolate=extrapolate)


@lru_cache(maxsize=4096)
def _nesting(kind: str, speed: float, extrapolate: bool) -> tuple[tuple[float, float, float, float], ...]:
    """Return the covariances of the longer waves along and across the wind, whatever its direction."""
    statistics = _law(kind, speed, 0.0, extrapolate)
    return nested_in(statistics, elfouhaily(speed, statistics.wind_to_azimuth) if speed > 0.0 else None).nesting


def continuous_rays(model: str, wavenumber_cm: FloatArray, *cases: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return transmittance, path, sunlight and sky [(cases, n)] in continuous air, ray by ray.

    ``cases``: wind [m s-1], height [m], depression, zenith angles of Sun and sky [rad].
    """
    out = np.empty((4, cases[0].size, wavenumber_cm.size))
    for i, (wind, height, depression, sun, sky) in enumerate(zip(*(values.tolist() for values in cases), strict=True)):
        sums = _at_wind(model, wind, wavenumber_cm)
        # A depression at the horizon's dip must end on the sea; the margin keeps rounding from lifting it.
        down = sums.along(height, 0.5 * np.pi + max(depression, sums.air.dip(height) * (1.0 + 1e-9)))
        # A Sun below the horizontal of the sea gives no direct light there.
        lit = sums.passed(0.0, sun) * sums.laws.source if sun <= 0.5 * np.pi else np.zeros(wavenumber_cm.size)
        out[:, i] = down.transmittance[-1], down.emitted, lit, sums.along(0.0, sky).emitted
    return out[0], out[1], out[2], out[3]


def continuous_light(model: str, wavenumber_cm: FloatArray, *cases: FloatArray) -> FloatArray:
    """Return the thermal radiance [(cases, n)] of continuous air along rays to the sea or the sky.

    ``cases``: wind [m s-1], height [m], elevation [rad].
    """
    out = np.empty((cases[0].size, wavenumber_cm.size))
    for i, (wind, height, elevation) in enumerate(zip(*(values.tolist() for values in cases), strict=True)):
        out[i] = _at_wind(model, wind, wavenumber_cm).along(height, 0.5 * np.pi - elevation).emitted
    return out


def _at_wind(model: str, wind: float, wavenumber_cm: FloatArray) -> AirSums:
    # The aerosol model ends at this wind; stronger winds take its strongest aerosol.
    blown = min(wind, NAVY_AEROSOL_WIND[1])
    return AirSums(model_profile(model), HazeWeather(wind=blown, wind_24h=blown), wavenumber_cm, spectroscopy="lowtran7")


@dataclass(frozen=True)
class NamedBand:
    """A rectangular band and the text of its request."""

    label: str
    band: Band

    @property
    def edges(self) -> tuple[float, float]:
        """Wavelengths [um]."""
        return self.band.min_um, self.band.max_um


def parse_bands(texts: Sequence[str]) -> list[NamedBand]:
    """Return bands of ``a-b`` in micrometres, each with its text as label.

    Raises
    ------
    DomainError
        No band, one twice, or one that is not two ascending wavelengths.

    Examples
    --------
    >>> [(b.label, b.edges) for b in parse_bands(["3.0-5.0"])]
    [('3.0-5.0', (3.0, 5.0))]
    """
    if not texts:
        raise DomainError("no band given; give at least one band, such as 3.0-5.0")
    bands = []
    for text in texts:
        match = re.fullmatch(r"\s*(\d+\.?\d*|\.\d+)-(\d+\.?\d*|\.\d+)\s*", text)
        if not match or not 0.0 < float(match[1]) < float(match[2]):
            raise DomainError(f"band '{text}' is not two ascending wavelengths in um; write it as 3.0-5.0")
        bands.append(NamedBand(text.strip(), Band.rectangular(float(match[1]), float(match[2]))))
    if twice := {b.label for b in bands if sum(other.label == b.label for other in bands) > 1}:
        raise DomainError(f"band {min(twice)} is asked for twice; name each band once")
    return bands


@documented(AirRequest)
def evaluate_atmosphere(
    cases: Cases, bands: Sequence[NamedBand], *, levels: str = "lowtran", extrapolate: bool = False, progress: Progress | None = None
) -> Columns:
    """Compute band values of the air between sea and sensor, of sunlight and of the sky.

    Parameters
    ----------
    cases : Cases
        With the columns ``ATMOSPHERE_INPUTS``; depression is the depression of LOWTRAN7's refracted ray at the sensor.
    {request}
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    dict
        Per band ``tau_mean`` (flat over wavenumber), ``path_radiance_W_m2_sr`` and ``sky_radiance_W_m2_sr`` (thermal only, the sky
        seen from the sea), ``sun_normal_irradiance_W_m2`` (at the sea, normal to the beam, Sun at 1 au) and ``sun_times_tau_W_m2`` (its
        product with transmittance, per wavenumber).

    Raises
    ------
    DataError
        A column missing, or a value that cannot be used; names row and column.
    DomainError
        A band outside the tables.
    """
    cases.require(ATMOSPHERE_INPUTS)
    airs = _airs(cases, bands, extrapolate)
    wind, height, marks = _wind_and_height(cases, next(iter(airs[bands[0].label].values())), extrapolate)
    depression = _angles(cases, "depression_deg", -90.0, 90.0)
    sun, sky = _angles(cases, "solar_zenith_deg", 0.0, 180.0), _angles(cases, "sky_zenith_deg", 0.0, 90.0)
    groups = groups_of(cases.text("atmosphere"))
    dip = np.empty(len(cases))
    for model, rows in groups:
        dip[rows] = airs[bands[0].label][str(model)].dip(height[rows])
    _require_sea(cases, depression, dip)
    # A part has one model and one band, so threads never write the same numbers.
    parts = [(name, band, rows[i : i + _CHUNK]) for name, rows in groups for band in bands for i in range(0, rows.size, _CHUNK)]
    quantities = ("tau_mean", "path_radiance_W_m2_sr", "sun_normal_irradiance_W_m2", "sun_times_tau_W_m2", "sky_radiance_W_m2_sr")
    columns: dict[str, FloatArray] = {f"{quantity}[{band.label}]": np.empty(len(cases)) for band in bands for quantity in quantities}

    def fill(part: tuple[Hashable, NamedBand, NDArray[np.intp]]) -> int:
        model, band, rows = part
        air = airs[band.label][str(model)]
        weights = band.band.weights(air.wavenumber_cm)
        if levels == "continuous":
            tau, path, light, above = continuous_rays(
                str(model), air.wavenumber_cm, wind[rows], height[rows], depression[rows], sun[rows], sky[rows]
            )
        else:
            tau, path = air.path(wind[rows], height[rows], depression[rows])
            light, above = air.solar_irradiance(wind[rows], sun[rows]), air.sky_radiance(wind[rows], sky[rows])
        values = (tau @ weights / weights.sum(), path @ weights, light @ weights, (light * tau) @ weights, above @ weights)
        for quantity, value in zip(quantities, values, strict=True):
            columns[f"{quantity}[{band.label}]"][rows] = value
        return int(rows.size)

    done, total = 0, len(cases) * len(bands)
    with ThreadPoolExecutor(_THREADS) as pool:  # NumPy releases the interpreter; each part has separate rows
        for count in pool.map(fill, parts):
            done += count
            _report(progress, done, total)
    return {**columns, **marks}


@documented(EvaluationRequest)
def evaluate_emissivity(cases: Cases, *, extrapolate: bool = False, progress: Progress | None = None) -> Columns:
    """Compute the emissivity of the wind-roughened sea: isotropic Cox-Munk slopes, salt water, first sea-to-sea reflection.

    Parameters
    ----------
    cases : Cases
        With the columns ``EMISSIVITY_INPUTS``; the wind is taken as the one at 12.5 m that the fit is made for.
    {request}
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    dict
        Column ``emissivity`` [1].

    Raises
    ------
    DataError
        A column missing, or a value that cannot be used; names row and column.
    """
    # Imported here, as it loads kernels of Numba: the command for the air does without them.
    from seaglint.facet.emissivity import emissivity

    cases.require(EMISSIVITY_INPUTS)
    water = hale_querry_sea()
    low, high = float(water.wavelength_um[0]), float(water.wavelength_um[-1])
    wavelength = cases.within(Column("wavelength_um", low, high, what="um of the water's index"))
    zenith = _angles(cases, "zenith_deg", 0.0, 90.0)
    wind, beyond = _ranged(cases, "wind_speed_m_s", COX_MUNK_WIND, WIND_PROFILE, "m/s of the Cox-Munk fit", extrapolate)
    values = np.empty(len(cases))
    done = 0
    for key, all_rows in groups_of(wind.tolist()):
        slopes = cox_munk_isotropic(float(str(key)), height=WIND_HEIGHT, extrapolate=extrapolate)
        # Rows of one wind share their facets: all wavelengths of a chunk are taken at all of its angles.
        for rows in (all_rows[i : i + 128] for i in range(0, all_rows.size, 128)):
            _report(progress, done, len(cases))
            angles, angle = np.unique(zenith[rows], return_inverse=True)
            waves, wave = np.unique(wavelength[rows], return_inverse=True)
            values[rows] = emissivity(angles, slopes, water, 1e4 / waves)[angle, wave]
            done += rows.size
    _report(progress, done, len(cases))
    return {"emissivity": values, **({EXTRAPOLATED: _marks({"wind_speed_m_s": beyond})} if extrapolate else {})}


def drawn_slopes(levels: ShortWaveLevels, speed: float, towards: float, directed: bool) -> SlopeStatistics:
    """Return the slopes of a drawn sea at a wind at 10 m towards an azimuth [rad]; in an isotropic sea all directions have their mean."""
    along = _drawn_along(levels, speed)
    if directed:
        return replace(along, wind_to_azimuth=towards)
    return SlopeStatistics(0.5 * along.mss, 0.5 * along.mss)


@lru_cache(maxsize=4096)
def wind_sea(speed: float, levels: ShortWaveLevels | None = None) -> DirectionalSpectrum | None:
    """Return the waves of a wind at 10 m [m/s] that blows to the north: Elfouhaily's, or of a drawn sea; None without wind."""
    if speed <= 0.0:
        return None
    waves = elfouhaily(speed, 0.0)
    return waves if levels is None else drawn_sea(speed, levels, 0.0, waves)


@lru_cache(maxsize=4096)
def _drawn_along(levels: ShortWaveLevels, speed: float) -> SlopeStatistics:
    """Return the slopes of a drawn sea with longer waves of Elfouhaily's spectrum along and across the wind."""
    sea = wind_sea(speed, levels)
    return nested_in(at_least_residual(SlopeStatistics(0.0, 0.0) if sea is None else spectrum_slopes(sea)), sea)


@documented(MeanCasesRequest)
def evaluate_mean(
    cases: Cases, bands: Sequence[NamedBand], *, extrapolate: bool = False, sea_draws: int | None = None, progress: Progress | None = None
) -> Columns:
    """Compute the mean radiance of the sea, its apparent temperature, and the standard deviation of glint in a pixel.

    Cox-Munk slopes of the wind at 10 m, isotropic where it has no direction, salt water, both legs shadowed, Sun at 1 au, glint that
    fluctuates with the waves of Elfouhaily's spectrum shorter than 2 m; geometry of the command ``mean`` (straight rays over an effective
    Earth).

    Parameters
    ----------
    cases : Cases
        With the columns ``MEAN_INPUTS``; a relative azimuth of 0 looks towards the Sun, the pixel is ``ifov_mrad`` square. With the
        column ``WIND_FROM`` as well, slopes are Cox and Munk's along and across that wind; 0 comes from the Sun's side. The column
        ``SLOPES`` chooses another of their models, the columns ``MOON`` add a Moon at its mean distance.
    {request}
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    dict
        Per band ``radiance_W_m2_sr``, ``apparent_temperature_K``, ``std_W_m2_sr``; with ``sea_draws`` of each also
        ``..._sea_unknown_low`` and ``..._sea_unknown_high``, and the column ``sea_draws``. The seas are drawn with the seed
        ``TABLE_SEED``, at the wind of each row; between rows their levels are the same.

    Raises
    ------
    DataError
        A column missing, or a value that cannot be used; names row and column.
    DomainError
        A band outside the tables.
    """
    # Numba comes with these, as above.
    from seaglint.facet.sea_view import LOWER_LIMB, BandSum, LightDisc, Moonlight, SeaView
    from seaglint.facet.surface_spectra import SeaSurface
    from seaglint.studies.build.profile_air import model_air

    cases.require(MEAN_INPUTS)
    covered = next(iter(_airs(cases, bands, extrapolate)[bands[0].label].values()))
    wind, height, marks = _wind_and_height(cases, covered, extrapolate, (covered.height_range[0], TOP_OF_AIR))
    depression = _angles(cases, "depression_deg", -90.0, 90.0)
    sun, azimuth = _angles(cases, "solar_zenith_deg", 0.0, 180.0), _angles(cases, "relative_azimuth_deg", -360.0, 360.0)
    temperature = cases.within(Column("sea_temperature_k", 260.0, 320.0, what="K"))
    ifov = 1e-3 * cases.within(Column("ifov_mrad", 0.0, 1000.0, above=True, what="mrad"))
    _require_sea(cases, depression, np.array([horizon_depression(h) for h in height]))
    directed = WIND_FROM in cases.header
    wind_from = _angles(cases, WIND_FROM, -360.0, 360.0) if directed else np.zeros(len(cases))
    kinds = slope_kinds(cases, directed)
    moonlit = any(name in cases.header for name in MOON)
    if moonlit:
        cases.require(MOON)
    moons = np.zeros((len(cases), 3))
    for i, (name, lowest, highest) in enumerate(zip(MOON, (0.0, -360.0, 0.0), (180.0, 360.0, 180.0), strict=True)):
        moons[:, i] = _angles(cases, name, lowest, highest) if moonlit else 0.0
    water = hale_querry_sea()
    levels = [] if sea_draws is None else levels_of(TABLE_SEED, sea_draws)
    # Both ends of the interval follow the value, as a reader of the table expects them.
    endings = ("", *((f"_{LOW}", f"_{HIGH}") if levels else ()))
    columns = {
        f"{quantity}{ending}[{band.label}]": np.empty(len(cases)) for band in bands for quantity in MEAN_COLUMNS for ending in endings
    }
    done, total = 0, len(cases) * len(bands)
    for band in bands:
        for key, same_air in groups_of(zip(cases.text("atmosphere"), wind.tolist(), strict=True)):
            model, speed = key if isinstance(key, tuple) else ("", 0.0)
            air = model_air(model, speed, band.edges)
            over = BandSum.of(band.band, air)
            # Tables of the sky are made once per air; the blackbody of other temperatures is exchanged below.
            surface = SeaSurface.create(air, water, float(temperature[same_air[0]]), over.grid)
            of_rows = (height, sun, temperature, azimuth, wind_from, kinds, *moons.T)
            views = zip(*(values[same_air].tolist() for values in of_rows), strict=True)
            for (at, solar_zenith, kelvin, towards, origin, kind, *of_moon), of_air in (
                (k, r) for k, r in groups_of(views) if isinstance(k, tuple)
            ):
                _report(progress, done, total)
                rows = same_air[of_air]
                slopes = slopes_of(kind, speed, float(travel_azimuth(origin)), extrapolate)
                moon = None
                if moonlit:
                    disc = LightDisc(moon_radius(MEAN_MOON_DISTANCE), partial(moon_to_sun, phase=of_moon[2]), of_moon[2], LOWER_LIMB)
                    moon = Moonlight(of_moon[0], of_moon[1], disc)
                view = SeaView(air, band.band, water, slopes, kelvin, at, solar_zenith, moon=moon)
                # What costs most, the table of the sky, is that of the air alone.
                of_kelvin = replace(surface, blackbody=planck_wavenumber(over.wavenumber_cm, kelvin))
                solid_angle = ifov[rows] ** 2
                results = partial(_mean_results, elevation=-depression[rows], azimuth=towards, surface=of_kelvin, pixel=solid_angle)
                for quantity, values in zip(MEAN_COLUMNS, results(view, waves=wind_sea(speed)), strict=True):
                    columns[f"{quantity}[{band.label}]"][rows] = values
                if levels and speed == 0.0:
                    # without wind nothing is drawn, and nothing is known of how unknown a calm is
                    for quantity, end in product(MEAN_COLUMNS, (LOW, HIGH)):
                        columns[f"{quantity}_{end}[{band.label}]"][rows] = np.nan
                elif levels:
                    to = float(travel_azimuth(origin))
                    seas = [
                        results(replace(view, slopes=drawn_slopes(level, speed, to, kind != SLOPE_KINDS[0])), waves=wind_sea(speed, level))
                        for level in levels
                    ]
                    for quantity, drawn in zip(MEAN_COLUMNS, zip(*seas, strict=True), strict=True):
                        ends = SeaUnknown.of(np.array(drawn))
                        columns[f"{quantity}_{LOW}[{band.label}]"][rows] = ends.low
                        columns[f"{quantity}_{HIGH}[{band.label}]"][rows] = ends.high
                done += rows.size
    _report(progress, done, total)
    return {**columns, **({COUNT: np.full(len(cases), sea_draws)} if levels else {}), **marks}


@documented(AirRequest)
def evaluate_scattered(
    cases: Cases, bands: Sequence[NamedBand], *, levels: str = "lowtran", extrapolate: bool = False, progress: Progress | None = None
) -> Columns:
    """Compute sunlight that the air scatters once into paths to the sea and into the clear sky, and their thermal radiance.

    Parameters
    ----------
    cases : Cases
        With the columns ``SCATTERED_INPUTS``; elevation is the elevation of LOWTRAN7's refracted ray at the sensor, below 0 for
        paths; the Sun's zenith angle at the sensor is without refraction, as LOWTRAN7 takes it.
    {request}
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    dict
        Per band ``scattered_W_m2_sr``, 0 in 7.5-14 um where the air scatters hardly any light, and ``thermal_W_m2_sr``; Sun at 1 au.

    Raises
    ------
    DataError
        A column missing, or a value that cannot be used; names row and column.
    DomainError
        A band outside the tables.
    """
    from seaglint.air.profile.profile_scattering import scattered_cases, scatters_in

    cases.require(SCATTERED_INPUTS)
    airs = _airs(cases, bands, extrapolate)
    covered = next(iter(airs[bands[0].label].values()))
    is_path = np.array([kind == "path" for kind in cases.choice("kind", ("path", "sky"))])
    wind, windy = _ranged(cases, "wind_speed_m_s", covered.wind_range, WIND_PROFILE, "m/s of the atmosphere tables", extrapolate)
    heights = (0.0, covered.height_range[1])
    height, high = _ranged(cases, "sensor_height_m", heights, (0.0, TOP_OF_AIR), "m of the atmosphere tables", extrapolate)
    lowest = 1e-3 if extrapolate else covered.height_range[0]
    cases.check(~is_path | (height >= lowest), "sensor_height_m", lambda i: f"{height[i]:g} m is below {lowest:g} m, the lowest of paths")
    elevation = _angles(cases, "elevation_deg", -90.0, 90.0)
    azimuth, sun = _angles(cases, "azimuth_from_sun_deg", -360.0, 360.0), _angles(cases, "solar_zenith_deg", 0.0, 180.0)
    groups = groups_of(zip(cases.text("atmosphere"), is_path.tolist(), strict=True))
    dip = np.empty(len(cases))
    for key, rows in groups:
        dip[rows] = airs[bands[0].label][_model_of(key)].dip(height[rows])
    # Rows of the sky pass this check with an infinite depression.
    _require_sea(cases, np.where(is_path, -elevation, np.inf), dip, "elevation_deg", -1.0)
    cases.check(
        is_path | (elevation >= -dip * (1.0 - 1e-9)),
        "elevation_deg",
        lambda i: f"{np.degrees(elevation[i]):.6g} deg sees the sea, whose horizon lies at {-np.degrees(dip[i]):.6g} deg; say kind = path",
    )
    columns = {f"{q}_W_m2_sr[{band.label}]": np.zeros(len(cases)) for band in bands for q in ("scattered", "thermal")}
    parts = [(key, all_rows[i : i + _CHUNK]) for key, all_rows in groups for i in range(0, all_rows.size, _CHUNK)]
    done, total = 0, len(cases) * len(bands)
    # Scattered sunlight is computed in bands where the air scatters; elsewhere its column remains 0.
    lit_bands = [band for band in bands if scatters_in(band.edges)]
    for key, rows in parts:
        _report(progress, done, total)
        for band in bands:
            air = airs[band.label][_model_of(key)]
            if levels == "continuous":
                thermal = continuous_light(_model_of(key), air.wavenumber_cm, wind[rows], height[rows], elevation[rows])
            elif is_path[rows[0]]:
                thermal = air.path(wind[rows], height[rows], -elevation[rows])[1]
            else:
                thermal = air.sky_radiance(wind[rows], 0.5 * np.pi - elevation[rows], height[rows])
            columns[f"thermal_W_m2_sr[{band.label}]"][rows] = thermal @ band.band.weights(air.wavenumber_cm)
        lines = np.stack([wind, height, elevation, azimuth, sun], axis=1)[rows]
        light = scattered_cases(_model_of(key), lines, [band.band for band in lit_bands], continuous=levels == "continuous")
        for band, values in zip(lit_bands, light, strict=True):
            columns[f"scattered_W_m2_sr[{band.label}]"][rows] = values
        done += rows.size * len(bands)
    _report(progress, done, total)
    return {**columns, **({EXTRAPOLATED: _marks({"wind_speed_m_s": windy, "sensor_height_m": high})} if extrapolate else {})}


def _mean_results(
    view: SeaView, *, elevation: FloatArray, azimuth: float, surface: SeaSurface, pixel: FloatArray, waves: DirectionalSpectrum | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the values of ``MEAN_COLUMNS`` at elevations of one azimuth [rad], in pixels [sr], over waves that run to the north."""
    from seaglint.radiance.lit_variance import WaveGlint
    from seaglint.radiance.mean_radiance import mean_radiance
    from seaglint.radiance.variance import sea_variance

    components = mean_radiance(view, elevation, [azimuth], surface)
    # the variance depends on the azimuths from the wind alone: turned to one wind, rows of all directions share its tables
    to, moon = view.slopes.wind_to_azimuth, view.moon
    turned = replace(
        view,
        slopes=replace(view.slopes, wind_to_azimuth=0.0),
        solar_azimuth=view.solar_azimuth - to,
        moon=None if moon is None else replace(moon, azimuth=moon.azimuth - to),
    )
    variance = sea_variance(turned, components, elevation, pixel, WaveGlint(waves, SHORTEST_WAVE))
    radiance = components.total[:, 0]
    return radiance, apparent_temperature(radiance, view.band, view.atmosphere.wavenumber_cm), np.sqrt(variance[:, 0])


def widest_sea_lines(columns: Columns) -> list[str]:
    """Return the interval 'sea unknown' of the radiance, of the row of each band where it is widest, in plain words; empty without one."""
    lines, (quantity, unit) = [], (MEAN_COLUMNS[0], "W m-2 sr-1")
    for label in [name.removeprefix(f"{quantity}_{LOW}") for name in columns if name.startswith(f"{quantity}_{LOW}")]:
        value, low, high = (np.asarray(columns[f"{quantity}{ending}{label}"]) for ending in ("", f"_{LOW}", f"_{HIGH}"))
        if np.all(np.isnan(high)):
            continue
        row = int(np.nanargmax((high - low) / value))
        line = sea_line(float(low[row]), float(high[row]), int(np.asarray(columns[COUNT])[row]), unit=unit, value=float(value[row]))
        lines.append(f"widest in row {row + 1}, {label.strip('[]')} um, radiance {value[row]:.4g} {unit}; {line}")
    return lines


def _model_of(key: Hashable) -> str:
    return str(key[0]) if isinstance(key, tuple) else str(key)


def groups_of(keys: Iterable[Hashable]) -> list[tuple[Hashable, NDArray[np.intp]]]:
    """Return the rows that share a key, in order of first appearance.

    >>> [(key, rows.tolist()) for key, rows in groups_of("abca")]
    [('a', [0, 3]), ('b', [1]), ('c', [2])]
    """
    groups: dict[Hashable, list[int]] = {}
    for row, key in enumerate(keys):
        groups.setdefault(key, []).append(row)
    return [(key, np.array(rows)) for key, rows in groups.items()]


def _report(progress: Progress | None, done: int, total: int) -> None:
    if progress is not None:
        progress(done, total)


def _airs(cases: Cases, bands: Sequence[NamedBand], extrapolate: bool) -> dict[str, dict[str, BatchAtmosphere]]:
    """Return tables by band and model; wrong bands and names are refused here, before any work."""
    names = sorted(set(cases.choice("atmosphere", table_models())))
    tables: dict[str, dict[str, BatchAtmosphere]] = {}
    with ThreadPoolExecutor(_THREADS) as pool:  # unpacking takes most of it, several at a time
        for band in bands:
            loaded = pool.map(lambda name, band=band: BatchAtmosphere.load(name, band.edges, extrapolate=extrapolate), names)
            tables[band.label] = dict(zip(names, loaded, strict=True))
    return tables


def _wind_and_height(
    cases: Cases, air: BatchAtmosphere, extrapolate: bool, heights: tuple[float, float] | None = None
) -> tuple[FloatArray, FloatArray, Columns]:
    """Return winds [m s-1], heights [m], and with ``extrapolate`` a column of marks for values outside the table or ``heights``."""
    wind, windy = _ranged(cases, "wind_speed_m_s", air.wind_range, WIND_PROFILE, "m/s of the atmosphere tables", extrapolate)
    what = "m of the atmosphere tables" if heights is None else "m"
    height, high = _ranged(cases, "sensor_height_m", heights or air.height_range, (1e-3, TOP_OF_AIR), what, extrapolate)
    return wind, height, {EXTRAPOLATED: _marks({"wind_speed_m_s": windy, "sensor_height_m": high})} if extrapolate else {}


def _ranged(
    cases: Cases, name: str, covered: tuple[float, float], possible: tuple[float, float], what: str, extrapolate: bool
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the values of a column, and a mask of those outside the covered range, which are refused without ``extrapolate``."""
    advice = "as far as extrapolation goes" if extrapolate else f"{what}; --extrapolate goes beyond and marks the row"
    values = cases.within(Column(name, *(possible if extrapolate else covered), what=advice))
    return values, (values < covered[0]) | (values > covered[1])


def _marks(beyond: dict[str, NDArray[np.bool_]]) -> list[str]:
    """Return per row the names of the columns outside their range, separated by blanks."""
    flags = zip(*(flags.tolist() for flags in beyond.values()), strict=True)
    return [" ".join(name for name, flag in zip(beyond, row, strict=True) if flag) for row in flags]


def _angles(cases: Cases, name: str, low: float, high: float) -> FloatArray:
    """Return the angles of a column of degrees [rad]."""
    return np.radians(cases.within(Column(name, low, high, what="deg")))


def _require_sea(cases: Cases, depression: FloatArray, dip: FloatArray, column: str = "depression_deg", sign: float = 1.0) -> None:
    """Refuse lines of sight that end in the sky; ``sign`` is -1 for a column of elevations."""

    def message(row: int) -> str:
        angle, horizon = sign * np.degrees(depression[row]), sign * np.degrees(dip[row])
        kind = "a depression" if sign > 0.0 else "an elevation"
        return f"{angle:.6g} deg misses the sea, whose horizon lies at {horizon:.6g} deg; give {kind} between that and {sign * 90.0:g} deg"

    cases.check(depression > dip, column, message)


def labelled_cases(cases: Cases, results: Columns) -> xr.Dataset:
    """Return cases and their results over ``case``; columns ``name[band]`` become ``name`` over ``case`` and ``band``.

    Parameters
    ----------
    cases : Cases
        The cases.
    results : mapping
        Columns by name, as ``seaglint.studies.mean.evaluate_cases`` gives them.
    """
    import xarray as xr

    parts: dict[str, dict[str, Any]] = {}
    variables: dict[str, Any] = {name: ("case", _plain(cases.text(name)), _about(name)) for name in cases.header}
    for name, values in results.items():
        match = re.fullmatch(r"(.+)\[(.+)\]", name)
        if match:
            parts.setdefault(match[1], {})[match[2]] = values
        else:
            variables[name] = ("case", np.asarray(values), _about(name))
    labels = list(next(iter(parts.values()), {}))
    variables |= {
        name: (("case", "band"), np.stack([columns[label] for label in labels], axis=-1), _about(name)) for name, columns in parts.items()
    }
    return xr.Dataset(variables, {"band": ("band", labels, {"units": "um"})} if labels else {})


def _plain(cells: list[str]) -> Any:
    """Return cells as numbers where all are numbers, else as text."""
    try:
        return np.array(cells, np.float64)
    except ValueError:
        return np.array(cells)


def _about(name: str) -> dict[str, str]:
    """Return the attributes of a column, its units by the ending of the name."""
    quantity = name.removesuffix(f"_{LOW}").removesuffix(f"_{HIGH}")
    unit = "1" if name in SHARES else next((unit for ending, unit in UNITS.items() if quantity.endswith(ending)), None)
    return {} if unit is None else {"units": unit}
