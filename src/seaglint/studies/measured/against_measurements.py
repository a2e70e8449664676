"""Comparison of this program with measurements and other models.

- Measured spectra of the sky, and of the sea from above, and MODTRAN 4's spectra. They are compared at LOWTRAN7's resolution: averages by
  a triangle of 20 cm-1 full width at half maximum, every 5 cm-1.
- Waves in a buoy's displacements, beside waves that the program draws from the buoy's spectrum.
- Band transmittances of homogeneous paths, and skies, of RRTMGP, which represents line-by-line models. RRTMGP's mixing ratios are per dry
  air, and its band means are weighted by the blackbody at the path's temperature. It leaves some gases out of some bands: so do ours here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import groupby
from typing import Final

import numpy as np

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import AirProfile, model_profile, sounding_profile
from seaglint.air.profile.band_laws import Spectroscopy
from seaglint.air.profile.homogeneous_path import even_air
from seaglint.air.sun_and_sky import brightness_temperature
from seaglint.base.conventions import FloatArray
from seaglint.formats.tables.spectra import SpectraBeside
from seaglint.formats.tables.table_text import csv_text
from seaglint.formats.waves.wave_records import DirectionalMoments, WaveChoice, spectrum_of
from seaglint.optics.band import Band, apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.sea.dispersion import wavenumber
from seaglint.sea.spectra.measured import MeasuredSpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField
from seaglint.studies.measured.buoy_records import record_rows
from seaglint.studies.measured.measured_numbers import (
    MeasuredRow,
    band_difference,
    chosen_spectroscopies,
    shipped,
    sums_with,
    with_gas,
    without_gases,
)

NO_HAZE: Final = HazeWeather("none")

BandRange = tuple[float, float]  #: Shortest and longest wavelength of a band [um].

#: Bands in which MODTRAN 4's zenith is compared [um].
SKY_BANDS: Final[dict[BandRange, str]] = {(3.6, 4.0): "a model", (4.0, 4.4): "a model", (8.2, 9.2): "a model", (10.0, 11.6): "a model"}

MODEL_REASONS: Final = {
    "lowtran7": "LOWTRAN7's water continuum by air is many times today's at 3.7-4.2 um; MODTRAN 4 has lines of 1996 and CKD 2.",
    "lblrtm": "MODTRAN 4 has lines of 1996 and the continuum CKD 2; measurements at 3.7-4.2 um lie above MT_CKD's.",
}

PATH_BANDS: Final = ((3.5, 4.15), (3.5, 5.0), (8.0, 12.0), (10.0, 12.0))  #: Bands in which MODTRAN 4's path is compared [um].

TITLE: Final = "CDIP buoy 067, San Nicolas Island 2022"

#: Bands of RRTMGP that are compared [cm-1].
BANDS_CM: Final = (
    *((700, 820), (820, 980), (980, 1080), (1080, 1180), (1180, 1390)),
    *((1800, 2080), (2080, 2250), (2250, 2390), (2390, 2680), (2680, 3250)),
)

NEVER: Final = ("NO", "SO2", "NO2", "NH3", "HNO3")  #: Gases that RRTMGP does not have.

#: Further gases that it does not have in a band.
ABSENT: Final[dict[tuple[int, int], tuple[str, ...]]] = {
    (820, 980): ("O3",),
    (1800, 2080): ("O3", "CO", "N2O"),
    (2250, 2390): ("O3",),
    (2390, 2680): ("O3", "CH4"),
    (2680, 3250): ("O3",),
}

#: Gases that it has in a band above ``TOP_HPA`` only, where paths of the band are not compared.
BELOW: Final[dict[tuple[int, int], tuple[str, ...]]] = {(2080, 2250): ("O3",)}

#: Bands in which RRTMGP leaves out the gases of the lower air above ``TOP_HPA``: paths there are not compared.
LOWER_CM: Final = ((820, 980), (1800, 2080), (2080, 2250), (2390, 2680))

TOP_HPA: Final = 100.0  #: Pressure above which RRTMGP has other gases [hPa]: 99.5, where its troposphere ends.

NEAR: Final = 60  #: Paths of 400-1030 hPa in the table; the others are of 5-400 hPa.

MODELS: Final = ("midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "tropical")

#: Tables of the package whose sources are reported.
TABLES: Final = (
    "aeri",
    "his",
    "iris",
    "modtran_sky",
    "modtran_path",
    "rrtmgp_paths",
    "rrtmgp_skies",
    "cdip_spectrum",
    "cdip_bands",
    "cdip_record",
)

_AZIMUTHS: Final = 360

_STEPS: Final = 64  #: Wavenumbers of a band over which directions are averaged.

_ENERGY: Final = "Waves are drawn from the buoy's spectrum, with other frequency bands than the displacements."
_DIRECTION: Final = "Displacements are along magnetic axes; 11.7 deg of declination is added."
_SLOPE: Final = "Only waves up to 0.58 Hz are included; glint depends on shorter waves, which a buoy does not measure."

_REASONS: Final = {
    "lowtran7": "Lines and continua date from the 1980s: too opaque at 3.1-4.2 um, carbon dioxide at 12.2-14.3 um.",
    "lblrtm": "One power of the amount for a gas and band cannot follow a line-by-line model from thin paths to thick ones.",
}

_COLD_CM: Final = (2080, 2250)
_COLD: Final = "At 4.4-4.8 um ours has nitrogen, which RRTMGP leaves out there: a hundredth of transmittance."

_SKY_REASONS: Final = {
    "lowtran7": "Water's continuum by air is too strong at 3.1-4.2 um, its self continuum by a fifth to a half at 8-9.6 um.",
    "lblrtm": "RRTMGP's layers are plane and 50 m thick at the sea, ours are spherical and continuous; the rest comes from the paths.",
}

_UNCERTAINTY: Final = "about 1 % (k-distribution)"

_WIDTHS: Final = (28, 9, 9, 4, 8, 8, 7)


@dataclass(frozen=True, kw_only=True)
class MeasuredScene:
    """Scene of which a spectrum was measured."""

    name: str  #: Name of its tables.
    title: str  #: Words for the scene.
    model: str  #: Model atmosphere above the sounding, and for its gases.
    co2_ppm: float  #: Carbon dioxide of its year.
    bands_um: dict[BandRange, str]  #: Uncertainty of the measurement by band [um].
    reasons: dict[str, str]  #: Sentence on the remaining difference, by spectroscopy.
    #: Height from which the sea is observed [m]; None for the zenith sky from the sounding's lowest level.
    height: float | None = None
    skin: float = 0.0  #: Temperature of the sea's skin [K].

    def profile(self) -> AirProfile:
        """Return the air of the scene."""
        levels = shipped(f"{self.name}_sounding").columns
        names = ("height_m", "pressure_hpa", "temperature_k", "relative_humidity_percent")
        return with_gas(sounding_profile(self.title, self.model, *(levels[name] for name in names)), "CO2", self.co2_ppm)

    def spectrum(self, wavenumber_cm: FloatArray, spectroscopy: Spectroscopy) -> FloatArray:
        """Return the radiance that is computed for the scene [W m-2 sr-1 per cm-1, (n,)]."""
        profile = self.profile()
        air = sums_with(spectroscopy, profile, NO_HAZE, wavenumber_cm)
        if self.height is None:
            return air.along(float(profile.height[0]), 0.0).emitted
        # Zenith angle pi looks straight down; the mirrored sky is the zenith.
        down, sky = air.along(self.height, np.pi), air.along(0.0, 0.0).emitted
        # Slopes change the emissivity at the nadir by less than 1e-3: the sea is a mirror here.
        mirrored = reflectance(1.0, hale_querry_sea().index(wavenumber_cm))
        leaving = (1.0 - mirrored) * planck_wavenumber(wavenumber_cm, self.skin) + mirrored * sky
        return np.asarray(down.emitted + down.transmittance[-1] * leaving)


_AERI = "1 % of radiance"
_IRIS = "2 K (lowest air extrapolated)"

#: Scenes with a sounding: AERI (Knuteson et al. 2004), HIS, IRIS-D.
SCENES: Final = (
    MeasuredScene(
        name="aeri",
        title="AERI, zenith sky, Oklahoma 2001",
        model="midlatitude-summer",
        co2_ppm=360.0,
        bands_um={(8.0, 9.2): _AERI, (8.0, 12.0): _AERI, (10.0, 12.0): _AERI, (13.0, 14.0): _AERI},
        reasons={
            "lowtran7": "LOWTRAN7's water continuum by air is too weak at 10-12 um; haze, left out here, adds about 1 K.",
            "lblrtm": "Inside a band the channels' shape is still LOWTRAN7's; haze, left out here, would make the windows warmer.",
        },
    ),
    MeasuredScene(
        name="his",
        title="HIS, sea from 20 km, Wallops Island 1993",
        model="midlatitude-summer",
        co2_ppm=357.0,
        bands_um={(10.5, 12.5): "0.3-0.7 K (of 24 spectra)", (13.0, 14.0): "0.3-0.7 K (of 24 spectra)"},
        reasons={
            "lowtran7": "The far wing of carbon dioxide is too opaque from above at 13-14 um; the skin's 293.3 K is chosen, not measured.",
            "lblrtm": "At 13-14 um -3 K and +3 K cancel, as a band's shape is LOWTRAN7's; the skin's 293.3 K is chosen, not measured.",
        },
        height=19970.0,
        skin=293.3,
    ),
    MeasuredScene(
        name="iris",
        title="IRIS, sea from space, Guam 1970",
        model="tropical",
        co2_ppm=325.0,
        bands_um={(8.0, 9.2): _IRIS, (10.0, 12.0): _IRIS, (13.0, 14.0): _IRIS},
        reasons={
            "lowtran7": "The far wing of carbon dioxide is too opaque at 13-14 um; skin of 301.2 K and lowest air are not measured.",
            "lblrtm": "Skin and lowest air are not measured; RRTMGP itself is 2 K too warm, ours up to 8 K beyond 13.7 um.",
        },
        height=1e5,
        skin=301.2,
    ),
)


def scene_rows(spectroscopies: tuple[Spectroscopy, ...]) -> tuple[list[MeasuredRow], list[SpectraBeside]]:
    """Return rows and spectra of the three measured scenes."""
    rows: list[MeasuredRow] = []
    spectra: list[SpectraBeside] = []
    for scene in SCENES:
        table = shipped(scene.name).columns
        nu, measured = table["wavenumber_cm"], 1e-3 * table["radiance_mw_m2_sr_cm"]
        light = {name: scene.spectrum(nu, name) for name in spectroscopies}
        rows += _light_rows(scene.title, nu, measured, light, scene.bands_um, scene.reasons)
        spectra.append(_beside(scene.title, nu, measured, light))
    return rows, spectra


def modtran_sky_rows(spectroscopies: tuple[Spectroscopy, ...]) -> tuple[list[MeasuredRow], list[SpectraBeside]]:
    """Return rows and spectrum of MODTRAN 4's zenith through rural haze of 23 km."""
    table = shipped("modtran_sky").columns
    nu, theirs = table["wavenumber_cm"], 1e-3 * table["radiance_mw_m2_sr_cm"]
    profile, haze = model_profile("tropical"), HazeWeather("rural-23km", 23.0)
    title = "MODTRAN 4, zenith sky, tropical, rural haze of 23 km"
    # The table has gaps between its bands; sums over each part need no channels in the gaps.
    parts = np.split(np.arange(nu.size), np.flatnonzero(np.diff(nu) > 20.0) + 1)
    rows: list[MeasuredRow] = []
    light = {
        name: np.concatenate([sums_with(name, profile, haze, nu[part]).along(0.0, 0.0).emitted for part in parts])
        for name in spectroscopies
    }
    for part in parts:
        within = {name: values[part] for name, values in light.items()}
        low, high = nu[part][0], nu[part][-1]
        bands = {band: uncertainty for band, uncertainty in SKY_BANDS.items() if 1e4 / band[1] >= low and 1e4 / band[0] <= high}
        rows += _light_rows(title, nu[part], theirs[part], within, bands, MODEL_REASONS)
    # Rows are grouped by spectroscopy, as in the other tables.
    order = [row for name in spectroscopies for row in rows if row.spectroscopy == name]
    return order, [_beside(title, nu, theirs, light)._replace(reference="MODTRAN 4")]


def modtran_path_rows(spectroscopies: tuple[Spectroscopy, ...]) -> tuple[list[MeasuredRow], list[SpectraBeside]]:
    """Return rows and spectrum of MODTRAN 4's transmittance over 5 km at the sea, its aerosol divided out."""
    table = shipped("modtran_path").columns
    nu, theirs = table["wavenumber_cm"], table["transmittance"]
    title = "MODTRAN 4, 5 km at the sea, tropical, no aerosol"
    profile = model_profile("tropical")
    ours = {name: sums_with(name, profile, NO_HAZE, nu).between(0.0, 0.0, 5000.0)[0] for name in spectroscopies}
    rows = []
    for name, values in ours.items():
        for low, high in PATH_BANDS:
            inside = (nu >= 1e4 / high) & (nu <= 1e4 / low)
            row = _mean_row(title, f"{low:g}-{high:g} um", name, "1", values[inside], theirs[inside])
            rows.append(replace(row, uncertainty="a model", reason=MODEL_REASONS[name]))
    return rows, [SpectraBeside(title, "transmittance", nu, theirs, dict(ours.items()), "1", "MODTRAN 4")]


def _light_rows(
    title: str,
    nu: FloatArray,
    measured: FloatArray,
    light: dict[Spectroscopy, FloatArray],
    bands: dict[BandRange, str],
    reasons: dict[str, str],
) -> Iterator[MeasuredRow]:
    """Yield rows of apparent temperatures in bands."""
    theirs = brightness_temperature(nu, measured)
    for name, ours in light.items():
        kelvin = brightness_temperature(nu, ours), theirs
        for band, uncertainty in bands.items():
            difference = band_difference(nu, ours, measured, band, kelvin)
            yield MeasuredRow(
                case=title,
                quantity=f"{band[0]:g}-{band[1]:g} um",
                spectroscopy=name,
                unit="K",
                ours=difference.ours,
                measured=difference.measured,
                difference_percent=difference.percent,
                difference_k=difference.kelvin,
                rms=difference.rms,
                uncertainty=uncertainty,
                reason=reasons[name],
            )


def _beside(title: str, nu: FloatArray, measured: FloatArray, light: dict[Spectroscopy, FloatArray]) -> SpectraBeside:
    ours: dict[str, FloatArray] = {name: brightness_temperature(nu, values) for name, values in light.items()}
    return SpectraBeside(title, "brightness temperature [K]", nu, brightness_temperature(nu, measured), ours)


def buoy_spectrum() -> MeasuredSpectrum:
    """Return the spectrum that the program makes of the buoy's energy and four moments."""
    table = shipped("cdip_spectrum").columns
    first = -(table["a1"] + 1j * table["b1"])  # directions come from there, waves travel to the other side
    bands = DirectionalMoments(table["frequency_hz"], table["energy_m2_hz"], first, table["a2"] + 1j * table["b2"])
    return spectrum_of(bands, WaveChoice(), 0.0, TITLE)[0]


def buoy_rows() -> list[MeasuredRow]:
    """Return rows of height, slopes, and of energy and direction in bands of frequency."""
    spectrum, bands = buoy_spectrum(), shipped("cdip_bands").columns
    total, error = float(bands["energy_m2"].sum()), float(np.sqrt(np.sum(bands["energy_error_m2"] ** 2)))
    height = 4.0 * np.sqrt(total)
    field = WaveField.create(spectrum, plan_tiles(spectrum, 1.0, 256), 0)
    # The height is proportional to the root of the energy, so its relative error is half as large.
    spread = 0.5 * height * error / total
    rows = [_buoy_row("significant height", "m", field.significant_height, height, f"{spread:.2f} m", _ENERGY)]
    k_low, k_high = (float(wavenumber(2.0 * np.pi * f)) for f in (bands["low_hz"][0], bands["high_hz"][-1]))
    slopes = float(sum(spectrum.mss(k_high, k_low)))
    rows.append(_buoy_row("slope variance below 0.58 Hz", "1", slopes, float(bands["slope_variance"].sum()), "", _SLOPE))
    for i in range(bands["low_hz"].size):
        low, high = float(bands["low_hz"][i]), float(bands["high_hz"][i])
        k = [float(wavenumber(2.0 * np.pi * f)) for f in (low, high)]
        energy, theirs = spectrum.height_variance(k[1], k[0]), float(bands["energy_m2"][i])
        uncertainty = f"{100.0 * bands['energy_error_m2'][i] / theirs:.0f} %"
        rows.append(_buoy_row(f"energy, {low:g}-{high:g} Hz", "m2", energy, theirs, uncertainty, _ENERGY))
    for i in range(bands["low_hz"].size):
        low, high = float(bands["low_hz"][i]), float(bands["high_hz"][i])
        ours, theirs = _mean_direction(spectrum, low, high), float(bands["from_deg"][i])
        # The difference of directions is taken the shorter way around.
        ours = theirs + (ours - theirs + 180.0) % 360.0 - 180.0
        rows.append(_buoy_row(f"direction, {low:g}-{high:g} Hz", "deg", ours, theirs, "2 deg (compass)", _DIRECTION))
    return rows


def _buoy_row(quantity: str, unit: str, ours: float, measured: float, uncertainty: str, reason: str) -> MeasuredRow:
    return MeasuredRow(
        case=TITLE,
        quantity=quantity,
        spectroscopy="",
        unit=unit,
        ours=float(ours),
        measured=float(measured),
        difference_percent=float("nan") if unit == "deg" else 100.0 * (ours / measured - 1.0),
        uncertainty=uncertainty,
        reason=reason,
    )


def _mean_direction(spectrum: MeasuredSpectrum, low: float, high: float) -> float:
    """Return the mean direction that the waves of a band [Hz] come from [deg], by the spectrum's distribution over azimuth."""
    k = np.linspace(float(wavenumber(2.0 * np.pi * low)), float(wavenumber(2.0 * np.pi * high)), _STEPS)
    azimuth = 2.0 * np.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
    moment = spectrum.spreading(k[:, None], azimuth) @ np.exp(1j * azimuth)
    return float(np.degrees(np.angle(-np.sum(spectrum.omnidirectional(k) * moment))) % 360.0)


def path_rows(spectroscopies: tuple[Spectroscopy, ...]) -> list[MeasuredRow]:
    """Return a row a band of the paths near the sea, and of those in the upper air."""
    table = shipped("rrtmgp_paths").columns
    rows = []
    for name in spectroscopies:
        ours = np.array(
            [_path_transmittance(name, {key: float(values[i]) for key, values in table.items()}) for i in range(_path_size(table))]
        )
        for case, paths in (("RRTMGP, paths of 400-1030 hPa", slice(0, NEAR)), ("RRTMGP, paths of 5-400 hPa", slice(NEAR, None))):
            for j, (low, high) in enumerate(BANDS_CM):
                theirs, mine = table[f"transmittance_{low}-{high}"][paths], ours[paths, j]
                comparable = table["pressure_hpa"][paths] > (TOP_HPA if (low, high) in LOWER_CM else 0.0)
                row = _row(case, (low, high), name, "1", mine[comparable], theirs[comparable])
                rows.append(replace(row, reason=_COLD) if (low, high) == _COLD_CM else row)
    return rows


def sky_rows(spectroscopies: tuple[Spectroscopy, ...]) -> list[MeasuredRow]:
    """Return a row a band of the skies: mean apparent temperature, differences of radiance and of temperature."""
    table = shipped("rrtmgp_skies").columns
    rows = []
    # Skies of one model and carbon dioxide share their air.
    cases = np.stack([table["model"], table["co2_ppmv"]], axis=1)
    for name in spectroscopies:
        ours = np.empty((_path_size(table), len(BANDS_CM)))
        for model, co2 in np.unique(cases, axis=0):
            profile = with_gas(model_profile(MODELS[int(model)]), "CO2", float(co2))
            at = np.flatnonzero((cases == (model, co2)).all(axis=1))
            ours[at] = _sky_light(name, profile, np.radians(table["zenith_deg"][at]))
        for j, (low, high) in enumerate(BANDS_CM):
            theirs, mine = table[f"radiance_{low}-{high}_w_m2_sr"], ours[:, j]
            band, grid = Band.rectangular(1e4 / high, 1e4 / low), _grid(low, high)
            kelvin = [apparent_temperature(light, band, grid) for light in (mine, theirs)]
            row = _row("RRTMGP, skies at the sea", (low, high), name, "K", *kelvin)
            percent = float(100.0 * (mine.mean() / theirs.mean() - 1.0))
            warmer = float(np.mean(kelvin[0] - kelvin[1]))
            rows.append(replace(row, difference_percent=percent, difference_k=warmer, reason=_SKY_REASONS[name]))
    return rows


def _path_size(table: dict[str, FloatArray]) -> int:
    return int(next(iter(table.values())).size)


def _grid(low: float, high: float) -> FloatArray:
    return np.arange(low, high + 1.0, 5.0)


def _row(case: str, band: tuple[int, int], name: Spectroscopy, unit: str, ours: FloatArray, theirs: FloatArray) -> MeasuredRow:
    """Return a row of RRTMGP's band [cm-1]."""
    row = _mean_row(case, f"{1e4 / band[1]:.3g}-{1e4 / band[0]:.3g} um", name, unit, ours, theirs)
    return replace(row, uncertainty=_UNCERTAINTY, reason=_REASONS[name])


def _mean_row(case: str, quantity: str, spectroscopy: str, unit: str, ours: FloatArray, theirs: FloatArray) -> MeasuredRow:
    """Return a row of the means of many numbers, still without uncertainty and reason."""
    mean, their = float(ours.mean()), float(theirs.mean())
    percent, rms = 100.0 * (mean / their - 1.0), float(np.sqrt(np.mean((ours - theirs) ** 2)))
    return MeasuredRow(
        case=case, quantity=quantity, spectroscopy=spectroscopy, unit=unit, ours=mean, measured=their, difference_percent=percent, rms=rms
    )


def _bands_by_gases(absent: dict[tuple[int, int], tuple[str, ...]]) -> dict[tuple[str, ...], list[int]]:
    """Return the places of the bands by the gases that are left out in them, so that one sum serves several bands."""
    out: dict[tuple[str, ...], list[int]] = {}
    for j, band in enumerate(BANDS_CM):
        out.setdefault(absent.get(band, ()), []).append(j)
    return out


def _channels(places: list[int]) -> tuple[FloatArray, list[slice]]:
    """Return the channels of some bands [cm-1], shared edges once, and the slice of each band."""
    grids = [_grid(*BANDS_CM[j]) for j in places]
    joined = np.unique(np.concatenate(grids))
    # Grids of bands are contiguous parts of the joined grid.
    starts = [int(np.searchsorted(joined, grid[0])) for grid in grids]
    return joined, [slice(start, start + grid.size) for start, grid in zip(starts, grids, strict=True)]


def _even(grid: FloatArray) -> FloatArray:
    """Return the weights of the trapezoidal rule on even channels [cm-1]."""
    weights = np.full(grid.size, 5.0)
    weights[[0, -1]] = 2.5
    return weights


def _path_transmittance(name: Spectroscopy, path: dict[str, float]) -> FloatArray:
    """Return the band transmittances of a homogeneous path [1, (bands,)]."""
    kelvin, profile = path["temperature_k"], homogeneous_air(path)
    out = np.empty(len(BANDS_CM))
    for gases, places in _bands_by_gases(ABSENT | BELOW).items():
        nu, parts = _channels(places)
        # 30 km up a path of 60 km stays within the air of this profile, whatever the Earth's curvature
        passed = sums_with(name, without_gases(profile, gases), NO_HAZE, nu).between(3e4, 3e4, 1e3 * path["length_km"])[0]
        for j, part in zip(places, parts, strict=True):
            weight = _even(nu[part]) * planck_wavenumber(nu[part], kelvin)
            out[j] = passed[part] @ weight / weight.sum()
    return out


def homogeneous_air(path: dict[str, float]) -> AirProfile:
    """Return air that is the same everywhere, with the gases of a path."""
    ppmv = {gas: path[f"{gas.lower()}_ppmv_dry"] for gas in ("CO2", "O3", "N2O", "CO", "CH4")}
    return even_air(path["temperature_k"], path["pressure_hpa"], path["vapour_pressure_hpa"], ppmv)


def _sky_light(name: Spectroscopy, profile: AirProfile, zenith: FloatArray) -> FloatArray:
    """Return the band radiance of the sky at the sea [W m-2 sr-1, (zeniths, bands)]."""
    out = np.empty((zenith.size, len(BANDS_CM)))
    for gases, places in _bands_by_gases(ABSENT).items():
        nu, parts = _channels(places)
        air = sums_with(name, without_gases(profile, (*NEVER, *gases)), NO_HAZE, nu)
        for i, angle in enumerate(zenith.tolist()):
            emitted = air.along(0.0, angle).emitted
            for j, part in zip(places, parts, strict=True):
                out[i, j] = emitted[part] @ _even(nu[part])
    return out


@dataclass(frozen=True)
class AgainstMeasurements:
    """Measurements beside ours: rows of numbers, and spectra."""

    rows: tuple[MeasuredRow, ...]
    spectra: tuple[SpectraBeside, ...]

    def csv(self) -> str:
        """Return the rows as CSV behind lines that name the sources."""
        head = "".join(f"# {name}: {shipped(name).facts['source']}; {shipped(name).facts['terms']}\n" for name in TABLES)
        names = [field.name for field in fields(MeasuredRow)]
        cells = [[_cell(getattr(row, name)) for name in names] for row in self.rows]
        return head + csv_text([names, *cells])

    def lines(self) -> list[str]:
        """Return the rows as a text table, case by case, each with the sentence on the remaining difference."""
        out = []
        for (case, spectroscopy), group in groupby(self.rows, key=lambda row: (row.case, row.spectroscopy)):
            rows = list(group)
            out.append(f"{case}{f', {spectroscopy}' if spectroscopy else ''}")
            width = max(_WIDTHS[0], *(len(row.quantity) for row in rows))
            out.append(_aligned(("", "ours", "measured", "unit", "diff. %", "diff. K", "rms", "uncertainty"), width))
            for row in rows:
                numbers = (_number(row.ours, row.unit), _number(row.measured, row.unit), row.unit)
                rms = _shown(row.rms, ".3f" if row.unit == "1" else ".2f")
                rest = (_shown(row.difference_percent, "+.1f"), _shown(row.difference_k, "+.2f"), rms)
                out.append(_aligned((row.quantity, *numbers, *rest, row.uncertainty), width))
            out += [f"  {reason}" for reason in dict.fromkeys(row.reason for row in rows)] + [""]
        return out[:-1]


def against_measurements(spectroscopy: str = "both") -> AgainstMeasurements:
    """Compare with all measurements and models, with ``lblrtm``, ``lowtran7`` or ``both``.

    Raises
    ------
    DomainError
        Another name of a spectroscopy.
    """
    chosen = chosen_spectroscopies(spectroscopy)
    rows: list[MeasuredRow] = []
    spectra: list[SpectraBeside] = []
    for compute in (scene_rows, modtran_sky_rows, modtran_path_rows):
        new_rows, new_spectra = compute(chosen)
        rows += new_rows
        spectra += new_spectra
    rows += [*path_rows(chosen), *sky_rows(chosen), *buoy_rows(), *record_rows(buoy_spectrum(), TITLE)]
    return AgainstMeasurements(tuple(rows), tuple(spectra))


def _aligned(cells: Sequence[str], first: int) -> str:
    """Return cells in columns, the first one ``first`` characters wide."""
    middle = (f"{cell:>{width}}" for cell, width in zip(cells[1:-1], _WIDTHS[1:], strict=True))
    return " ".join(["  " + cells[0].ljust(first), *middle, " " + cells[-1]]).rstrip()


def _number(value: float, unit: str) -> str:
    return f"{value:.2f}" if unit == "K" else f"{value:.4g}"


def _shown(value: float | None, form: str) -> str:
    return "-" if value is None or np.isnan(value) else f"{value:{form}}"


def _cell(value: object) -> object:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.6g}"
    return "" if value is None else value
