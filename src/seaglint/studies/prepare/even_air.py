"""Paths through air of one temperature and pressure as datasets, and the choice between them and those of a scenario."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

from seaglint.air.profile.hazes import HazeWeather
from seaglint.air.profile.homogeneous_path import homogeneous_spectrum
from seaglint.base.errors import DataError

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.air.profile.band_numbers import Spectroscopy


def require_one_kind(scenario: bool, ranges: bool, even: Mapping[str, Any]) -> None:
    """Refuse parameters of both kinds of path, or of neither.

    Raises
    ------
    DataError
        A scenario without ranges, ranges without a scenario, numbers of even air beside a scenario, or too few of them.
    """
    given, missing = ([name for name, value in even.items() if (value is not None) == there] for there in (True, False))
    if scenario and given:
        raise DataError(f"{', '.join(given)}: describe even air, and a scenario is given; leave them out, or leave the scenario out")
    if scenario != ranges:
        raise DataError(
            "range_m is missing: the distances of a scenario's paths in metres; give it, e.g. 1000,5000"
            if scenario
            else "range_m needs a scenario, whose air the paths go through; give one, or describe even air"
        )
    if not scenario and missing:
        raise DataError(f"{', '.join(missing)} missing: a path through even air needs them; give them, or a scenario with range_m")


def even_path(
    numbers: Mapping[str, float | None],
    band_um: tuple[float, float] | None,
    ppmv: Mapping[str, float],
    spectroscopy: Spectroscopy,
    haze: str,
) -> xr.Dataset:
    """Transmittance of a path through even air.

    Parameters
    ----------
    numbers : mapping
        ``temperature_k`` [K], ``pressure_hpa``, ``vapour_pressure_hpa`` [hPa] and ``length_km`` [km].
    band_um : (float, float)
        Shortest and longest wavelength [um].
    ppmv : mapping
        Gases [1e-6 of the volume of dry air].
    spectroscopy, haze : str
        Absorption, and aerosol at the sea.

    Returns
    -------
    xarray.Dataset
        ``transmittance`` [1], weighted with the blackbody at the temperature, and ``spectral_transmittance`` over ``wavenumber_cm``.

    Raises
    ------
    DomainError
        A number outside its range.
    """
    import xarray as xr

    path = cast("Mapping[str, float]", numbers)
    band = cast("tuple[float, float]", band_um)
    found = homogeneous_spectrum(**path, band_um=band, ppmv=dict(ppmv), spectroscopy=spectroscopy, haze=HazeWeather(haze))
    return xr.Dataset(
        {
            "transmittance": ((), found.mean, {"units": "1", "long_name": "mean transmittance, weighted with the blackbody"}),
            "spectral_transmittance": ("wavenumber_cm", found.transmittance, {"units": "1"}),
        },
        {"wavenumber_cm": ("wavenumber_cm", found.wavenumber_cm, {"units": "cm-1"})},
        {**path, "band_um": list(band), **{f"{gas.lower()}_ppmv": amount for gas, amount in ppmv.items()}, "spectroscopy": spectroscopy},
    )
