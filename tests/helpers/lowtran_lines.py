"""Random lines of sight through random air for comparisons with LOWTRAN7's program: model atmospheres, soundings of our own, all hazes."""

from dataclasses import dataclass

import numpy as np

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile, sounding_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.profile_scattering import scattering_air
from seaglint.air.scattering.scattering_laws import scattering_angle
from seaglint.formats.lowtran.deck import HAZES, MODELS, Aerosol, LowtranAir, LowtranCase, ProfileLevel

BANDS = ((2000, 2860), (2000, 3335), (770, 1250), (830, 1000), (1380, 1780), (1815, 5005), (5000, 9000))
"""Wavenumbers [cm-1]: 3.5-5, 3-5, 8-13, 10-12, 5.6-7.2, 2-5.5, 1.1-2 um."""

SOLAR = 2000
"""Bands from here on are asked for scattered sunlight [cm-1]."""


@dataclass(frozen=True)
class Line:
    """A case as LOWTRAN7 takes it, and the same for our sums."""

    case: LowtranCase
    profile: object
    haze: HazeWeather

    @property
    def channels(self):
        return np.arange(self.case.air.v1, self.case.air.v2 + 1, 5.0)


def own_sounding(rng, model):
    """Levels [km, hPa, K, %] of an ascent with inversions and dry and moist layers, hydrostatic, to 12-25 km, as cards hold them."""
    count = int(rng.integers(8, 22))
    top = rng.uniform(12.0, 25.0)
    z = np.unique(np.round(np.concatenate([[0.0], np.sort(top * rng.random(count) ** 2), [top]]), 2))
    base = model_profile(model)
    kelvin = np.interp(1e3 * z, base.height, base.temperature) + rng.normal(0.0, 3.0, z.size) * np.exp(-z / 5.0) + rng.normal(0.0, 3.0)
    humidity = np.clip(np.interp(1e3 * z, base.height, base.relative_humidity) * np.exp(rng.normal(0.0, 0.4, z.size)), 0.5, 99.5)
    mean = 0.5 * (kelvin[1:] + kelvin[:-1])
    pressure = rng.uniform(990.0, 1035.0) * np.exp(-np.concatenate([[0.0], np.cumsum(1e3 * np.diff(z) * 9.81 / (287.05 * mean))]))
    return z, np.round(pressure, 4), np.round(kelvin, 3), np.round(humidity, 3)


def on_card(value):
    """A number as ten columns of a card hold it."""
    return float(f"{value:10.8f}"[:10])


def draw(seed):
    """Line number ``seed``: a tenth to a fifth of all of every kind of air, haze, band, height and view."""
    rng = np.random.default_rng([19970, seed])
    model = list(MODELS)[rng.integers(6)]
    haze = "navy-maritime" if rng.random() < 0.4 else list(HAZES)[rng.integers(len(HAZES))]
    visibility = None if haze == "none" or rng.random() < 0.5 else float(np.round(rng.uniform(1.0, 60.0), 2))
    winds = np.round(rng.uniform(0.1, 20.0, 2), 3)
    mass = int(rng.integers(1, 11))
    levels, profile = (), model_profile(model)
    if seed % 5 == 0:
        z, p, t, u = own_sounding(rng, model)
        above = [float(k) for k in (*range(1, 26), 30, 35, 40, 45, 50, 70, 100) if k > z[-1] + 0.2]
        above = [above[i] for i in np.unique(np.linspace(0, len(above) - 1, min(33 - z.size, len(above))).astype(int))]
        levels = (*(ProfileLevel(*map(float, row)) for row in zip(z, p, t, u, strict=True)), *(ProfileLevel(k) for k in above))
        profile = sounding_profile("own", model, 1e3 * z, p, t, u, 1e3 * np.array(above))
    v1, v2 = BANDS[rng.integers(len(BANDS))]
    height = on_card(np.exp(rng.uniform(np.log(2e-3), np.log(10.0))))
    air = LowtranAir(model, Aerosol(haze, visibility, mass, *map(float, winds)), v1, v2, levels)
    weather = HazeWeather(haze, visibility, mass, *map(float, winds))
    dip = AirSums(profile, weather, np.array([v1, v2], dtype=float)).air.dip(1e3 * height)
    kind = ("path", "sky", "sun")[int(rng.choice(3, p=(0.45, 0.45, 0.1)))]
    if kind == "path":
        zenith = 0.5 * np.pi + dip + (0.5 * np.pi - dip) * rng.random() ** 4 + 1e-4
    elif kind == "sky":
        zenith = 0.5 * np.pi - (-0.99 * dip + (0.5 * np.pi + 0.99 * dip) * rng.random() ** 3)
    else:
        height, zenith = 0.0, 0.5 * np.pi * (1.0 - rng.random() ** 3) * 0.9999
    sun = None
    if kind != "sun" and v1 >= SOLAR:
        sun = (on_card(rng.uniform(0.0, 180.0)), on_card(rng.uniform(0.0, 85.0)))
    case = LowtranCase(air, kind, height, float(f"{np.degrees(zenith):10.7f}"[:10]), sun=sun)
    return Line(case, profile, weather)


def of_program(spectrum):
    """Mean transmittance, thermal radiance and scattered sunlight, or direct sunlight, summed over the band."""
    last = spectrum.irradiance.sum() if spectrum.irradiance.any() else spectrum.scattered.sum()
    return np.array([spectrum.transmittance.mean(), spectrum.radiance.sum(), last])


def ours(line):
    """The same by our sums in LOWTRAN7's layers; NaN where not asked for."""
    case, nu = line.case, line.channels
    sums = AirSums(line.profile, line.haze, nu, spectroscopy="lowtran7")
    height, zenith = 1e3 * case.height_km, np.radians(case.zenith_deg)
    spectra = sums.in_layers(height, zenith)
    tau = spectra.transmittance[-1]
    if case.kind == "sun":
        return np.array([tau.mean(), np.nan, (tau * sums.laws.source).sum()])
    if case.sun is None:
        return np.array([tau.mean(), spectra.emitted.sum(), np.nan])
    air = scattering_air(line.profile, line.haze, nu, humidity=sums.layer_humidity(height, zenith), spectroscopy="lowtran7")
    azimuth, solar = np.radians(case.sun)
    amplitude, _ = air.amplitudes(height, np.array([[zenith, azimuth, solar]]))
    phase = air.phase(scattering_angle(zenith, azimuth, air.apparent_zenith(solar, height)))
    return np.array([tau.mean(), spectra.emitted.sum(), (air.source * (phase * amplitude[0]).sum(axis=0)).sum()])


def differences(found, truth):
    """Relative differences of the three quantities [(cases, 3)], NaN where there is none.

    Transmittances below 0.01 are left out: LOWTRAN7 ends its sum where a layer adds less than 1e-5 and says the transmittance up to there.
    So is sunlight below 1e-8 W m-2 (sr-1), and through air that passes less than 1e-20, where LOWTRAN7 divides numbers that it cut off.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        out = np.abs(found / truth - 1.0)
    out[:, 0][truth[:, 0] < 0.01] = np.nan
    out[:, 2][(truth[:, 2] < 1e-8) | (truth[:, 0] < 1e-20)] = np.nan
    out[~np.isfinite(out)] = np.nan
    return out
