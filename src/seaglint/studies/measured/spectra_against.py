"""Measured spectra of the sky, and of the sea from above, and MODTRAN 4's, beside ours.

Both are compared at LOWTRAN7's resolution: averages by a triangle of 20 cm-1 full width at half maximum, every 5 cm-1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import AirProfile, model_profile, sounding_profile
from seaglint.air.profile.band_numbers import Spectroscopy
from seaglint.air.profile.hazes import HazeWeather
from seaglint.air.sky_spline import brightness_temperature
from seaglint.base.conventions import FloatArray
from seaglint.files.tables.spectra_beside import SpectraBeside
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.studies.measured.measured_row import MeasuredRow, band_difference
from seaglint.studies.measured.shipped import shipped
from seaglint.studies.measured.spectroscopies import sums_with, with_gas

NO_HAZE: Final = HazeWeather("none")

BandRange = tuple[float, float]  #: Shortest and longest wavelength of a band [um].


@dataclass(frozen=True, kw_only=True)
class MeasuredScene:
    """Scene of which a spectrum was measured."""

    #: ``name``, ``title``: Name of its tables, and words for it.
    name: str
    title: str
    model: str  #: Model atmosphere above the sounding, and for its gases.
    co2_ppm: float  #: Carbon dioxide of its year.
    bands_um: dict[BandRange, str]  #: Uncertainty of the measurement by band [um].
    reasons: dict[str, str]  #: Sentence on what is left, by spectroscopy.
    #: Height from which the sea is looked at [m]; None for the zenith sky seen from the sounding's lowest level.
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

#: Bands in which MODTRAN 4's zenith is compared [um].
SKY_BANDS: Final[dict[BandRange, str]] = {(3.6, 4.0): "a model", (4.0, 4.4): "a model", (8.2, 9.2): "a model", (10.0, 11.6): "a model"}

MODEL_REASONS: Final = {
    "lowtran7": "LOWTRAN7's water continuum by air is many times today's at 3.7-4.2 um; MODTRAN 4 has lines of 1996 and CKD 2.",
    "lblrtm": "MODTRAN 4 has lines of 1996 and the continuum CKD 2; measurements at 3.7-4.2 um lie above MT_CKD's.",
}

PATH_BANDS: Final = ((3.5, 4.15), (3.5, 5.0), (8.0, 12.0), (10.0, 12.0))  #: Bands in which MODTRAN 4's path is compared [um].


def scene_rows(spectroscopies: tuple[Spectroscopy, ...]) -> tuple[list[MeasuredRow], list[SpectraBeside]]:
    """Return rows and spectra of the three measured scenes."""
    rows: list[MeasuredRow] = []
    spectra: list[SpectraBeside] = []
    for scene in SCENES:
        held = shipped(scene.name).columns
        nu, measured = held["wavenumber_cm"], 1e-3 * held["radiance_mw_m2_sr_cm"]
        light = {name: scene.spectrum(nu, name) for name in spectroscopies}
        made = _light_rows(scene.title, nu, measured, light, scene.bands_um, scene.reasons)
        rows += made
        spectra.append(_beside(scene.title, nu, measured, light))
    return rows, spectra


def modtran_sky_rows(spectroscopies: tuple[Spectroscopy, ...]) -> tuple[list[MeasuredRow], list[SpectraBeside]]:
    """Return rows and spectrum of MODTRAN 4's zenith through rural haze of 23 km."""
    held = shipped("modtran_sky").columns
    nu, theirs = held["wavenumber_cm"], 1e-3 * held["radiance_mw_m2_sr_cm"]
    profile, haze = model_profile("tropical"), HazeWeather("rural-23km", 23.0)
    title = "MODTRAN 4, zenith sky, tropical, rural haze of 23 km"
    parts = np.split(np.arange(nu.size), np.flatnonzero(np.diff(nu) > 20.0) + 1)
    rows: list[MeasuredRow] = []
    light: dict[Spectroscopy, FloatArray] = {}
    for name in spectroscopies:
        light[name] = np.concatenate([sums_with(name, profile, haze, nu[part]).along(0.0, 0.0).emitted for part in parts])
    for part in parts:
        within = {name: values[part] for name, values in light.items()}
        bands = {band: said for band, said in SKY_BANDS.items() if 1e4 / band[1] >= nu[part][0] and 1e4 / band[0] <= nu[part][-1]}
        rows += _light_rows(title, nu[part], theirs[part], within, bands, MODEL_REASONS)
    order = [row for name in spectroscopies for row in rows if row.spectroscopy == name]
    return order, [_beside(title, nu, theirs, light)._replace(reference="MODTRAN 4")]


def modtran_path_rows(spectroscopies: tuple[Spectroscopy, ...]) -> tuple[list[MeasuredRow], list[SpectraBeside]]:
    """Return rows and spectrum of MODTRAN 4's transmittance over 5 km at the sea, its aerosol divided out."""
    held = shipped("modtran_path").columns
    nu, theirs = held["wavenumber_cm"], held["transmittance"]
    title = "MODTRAN 4, 5 km at the sea, tropical, no aerosol"
    profile = model_profile("tropical")
    ours = {name: sums_with(name, profile, NO_HAZE, nu).between(0.0, 0.0, 5000.0)[0] for name in spectroscopies}
    rows = []
    for name, values in ours.items():
        for low, high in PATH_BANDS:
            inside = (nu >= 1e4 / high) & (nu <= 1e4 / low)
            mean, their = float(values[inside].mean()), float(theirs[inside].mean())
            rms = float(np.sqrt(np.mean((values - theirs)[inside] ** 2)))
            percent = 100.0 * (mean / their - 1.0)
            row = MeasuredRow(
                case=title,
                quantity=f"{low:g}-{high:g} um",
                spectroscopy=name,
                unit="1",
                ours=mean,
                measured=their,
                difference_percent=percent,
                rms=rms,
                uncertainty="a model",
                reason=MODEL_REASONS[name],
            )
            rows.append(row)
    return rows, [SpectraBeside(title, "transmittance", nu, theirs, dict(ours.items()), "1", "MODTRAN 4")]


def _light_rows(
    title: str,
    nu: FloatArray,
    measured: FloatArray,
    light: dict[Spectroscopy, FloatArray],
    bands: dict[BandRange, str],
    reasons: dict[str, str],
) -> Iterator[MeasuredRow]:
    """Rows of apparent temperatures in bands."""
    theirs = brightness_temperature(nu, measured)
    for name, ours in light.items():
        kelvin = brightness_temperature(nu, ours), theirs
        for band, uncertainty in bands.items():
            found = band_difference(nu, ours, measured, band, kelvin)
            yield MeasuredRow(
                case=title,
                quantity=f"{band[0]:g}-{band[1]:g} um",
                spectroscopy=name,
                unit="K",
                ours=found.ours,
                measured=found.measured,
                difference_percent=found.percent,
                difference_k=found.kelvin,
                rms=found.rms,
                uncertainty=uncertainty,
                reason=reasons[name],
            )


def _beside(title: str, nu: FloatArray, measured: FloatArray, light: dict[Spectroscopy, FloatArray]) -> SpectraBeside:
    ours: dict[str, FloatArray] = {name: brightness_temperature(nu, values) for name, values in light.items()}
    return SpectraBeside(title, "brightness temperature [K]", nu, brightness_temperature(nu, measured), ours)
