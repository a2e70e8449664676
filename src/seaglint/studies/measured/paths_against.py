"""Band transmittances of homogeneous paths and skies of RRTMGP, which stands for today's line-by-line models, beside ours.

RRTMGP's mixing ratios are those in dry air, and its band means are weighted by the blackbody at the path's temperature. It leaves some
gases out of some bands: so do ours here.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import AirProfile, model_profile
from seaglint.air.profile.band_numbers import Spectroscopy
from seaglint.air.profile.homogeneous_path import even_air
from seaglint.base.conventions import FloatArray
from seaglint.optics.band import Band, apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.studies.measured.measured_row import MeasuredRow
from seaglint.studies.measured.shipped import shipped
from seaglint.studies.measured.spectra_against import NO_HAZE
from seaglint.studies.measured.spectroscopies import sums_with, with_gas, without_gases

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

#: Gases that it has in a band above :data:`TOP_HPA` only, where paths of the band are not compared.
BELOW: Final[dict[tuple[int, int], tuple[str, ...]]] = {(2080, 2250): ("O3",)}

#: Bands in which RRTMGP leaves out the gases of the lower air above :data:`TOP_HPA`: paths there are not compared.
LOWER_CM: Final = ((820, 980), (1800, 2080), (2080, 2250), (2390, 2680))

TOP_HPA: Final = 100.0  #: Pressure above which RRTMGP has other gases [hPa]: 99.5, where its troposphere ends.

NEAR: Final = 60  #: Paths of 400-1030 hPa in the table; the others are of 5-400 hPa.

MODELS: Final = ("midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "tropical")

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


def path_rows(spectroscopies: tuple[Spectroscopy, ...]) -> list[MeasuredRow]:
    """Return a row a band of the paths near the sea, and of those in the upper air."""
    held = shipped("rrtmgp_paths").columns
    rows = []
    for name in spectroscopies:
        ours = np.array([_path_transmittance(name, {key: float(values[i]) for key, values in held.items()}) for i in range(_size(held))])
        for case, some in (("RRTMGP, paths of 400-1030 hPa", slice(0, NEAR)), ("RRTMGP, paths of 5-400 hPa", slice(NEAR, None))):
            for j, (low, high) in enumerate(BANDS_CM):
                theirs, mine = held[f"transmittance_{low}-{high}"][some], ours[some, j]
                there = held["pressure_hpa"][some] > (TOP_HPA if (low, high) in LOWER_CM else 0.0)
                row = _row(case, (low, high), name, "1", mine[there], theirs[there])
                rows.append(replace(row, reason=_COLD) if (low, high) == _COLD_CM else row)
    return rows


def sky_rows(spectroscopies: tuple[Spectroscopy, ...]) -> list[MeasuredRow]:
    """Return a row a band of the skies: mean apparent temperature, differences of radiance and of temperature."""
    held = shipped("rrtmgp_skies").columns
    rows = []
    cases = np.stack([held["model"], held["co2_ppmv"]], axis=1)
    for name in spectroscopies:
        ours = np.empty((_size(held), len(BANDS_CM)))
        for model, co2 in np.unique(cases, axis=0):
            profile = with_gas(model_profile(MODELS[int(model)]), "CO2", float(co2))
            at = np.flatnonzero((cases == (model, co2)).all(axis=1))
            ours[at] = _sky_light(name, profile, np.radians(held["zenith_deg"][at]))
        for j, (low, high) in enumerate(BANDS_CM):
            theirs, mine = held[f"radiance_{low}-{high}_w_m2_sr"], ours[:, j]
            band, grid = Band.rectangular(1e4 / high, 1e4 / low), _grid(low, high)
            kelvin = [apparent_temperature(light, band, grid) for light in (mine, theirs)]
            row = _row("RRTMGP, skies at the sea", (low, high), name, "K", *kelvin)
            percent = float(100.0 * (mine.mean() / theirs.mean() - 1.0))
            warmer = float(np.mean(kelvin[0] - kelvin[1]))
            rows.append(replace(row, difference_percent=percent, difference_k=warmer, reason=_SKY_REASONS[name]))
    return rows


def _size(held: dict[str, FloatArray]) -> int:
    return int(next(iter(held.values())).size)


def _grid(low: float, high: float) -> FloatArray:
    return np.arange(low, high + 1.0, 5.0)


def _row(case: str, band: tuple[int, int], name: Spectroscopy, unit: str, ours: FloatArray, theirs: FloatArray) -> MeasuredRow:
    """Row of the means of many numbers."""
    mean, their = float(ours.mean()), float(theirs.mean())
    return MeasuredRow(
        case=case,
        quantity=f"{1e4 / band[1]:.3g}-{1e4 / band[0]:.3g} um",
        spectroscopy=name,
        unit=unit,
        ours=mean,
        measured=their,
        difference_percent=100.0 * (mean / their - 1.0),
        rms=float(np.sqrt(np.mean((ours - theirs) ** 2))),
        uncertainty=_UNCERTAINTY,
        reason=_REASONS[name],
    )


def _bands_by_gases(absent: dict[tuple[int, int], tuple[str, ...]]) -> dict[tuple[str, ...], list[int]]:
    """Places of the bands by the gases that are left out in them, so that one sum serves several bands."""
    out: dict[tuple[str, ...], list[int]] = {}
    for j, band in enumerate(BANDS_CM):
        out.setdefault(absent.get(band, ()), []).append(j)
    return out


def _channels(places: list[int]) -> tuple[FloatArray, list[slice]]:
    """Channels of some bands [cm-1], those at a shared edge once in each, and the slice of each band."""
    grids = [_grid(*BANDS_CM[j]) for j in places]
    joined = np.unique(np.concatenate(grids))
    starts = [int(np.searchsorted(joined, grid[0])) for grid in grids]
    return joined, [slice(start, start + grid.size) for start, grid in zip(starts, grids, strict=True)]


def _even(grid: FloatArray) -> FloatArray:
    """Weights of a trapezoid on even channels [cm-1]."""
    weights = np.full(grid.size, 5.0)
    weights[[0, -1]] = 2.5
    return weights


def _path_transmittance(name: Spectroscopy, path: dict[str, float]) -> FloatArray:
    """Band transmittances of a homogeneous path [1, (bands,)]."""
    kelvin, profile = path["temperature_k"], homogeneous_air(path)
    out = np.empty(len(BANDS_CM))
    for gases, places in _bands_by_gases(ABSENT | BELOW).items():
        nu, parts = _channels(places)
        air = sums_with(name, without_gases(profile, gases), NO_HAZE, nu)
        # 30 km up a path of 60 km stays within the air of this profile, whatever the Earth's curvature
        passed = air.between(3e4, 3e4, 1e3 * path["length_km"])[0]
        for j, part in zip(places, parts, strict=True):
            weight = _even(nu[part]) * planck_wavenumber(nu[part], kelvin)
            out[j] = passed[part] @ weight / weight.sum()
    return out


def homogeneous_air(path: dict[str, float]) -> AirProfile:
    """Return air that is the same everywhere, with the gases of a path."""
    ppmv = {gas: path[f"{gas.lower()}_ppmv_dry"] for gas in ("CO2", "O3", "N2O", "CO", "CH4")}
    return even_air(path["temperature_k"], path["pressure_hpa"], path["vapour_pressure_hpa"], ppmv)


def _sky_light(name: Spectroscopy, profile: AirProfile, zenith: FloatArray) -> FloatArray:
    """Band radiance of the sky at the sea [W m-2 sr-1, (zeniths, bands)]."""
    out = np.empty((zenith.size, len(BANDS_CM)))
    for gases, places in _bands_by_gases(ABSENT).items():
        nu, parts = _channels(places)
        air = sums_with(name, without_gases(profile, (*NEVER, *gases)), NO_HAZE, nu)
        for i, angle in enumerate(zenith.tolist()):
            emitted = air.along(0.0, angle).emitted
            for j, part in zip(places, parts, strict=True):
                out[i, j] = emitted[part] @ _even(nu[part])
    return out
