"""Air of one temperature and pressure, without a scenario: ``sg.homogeneous_path``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, overload

from seaglint.air.profile.band_numbers import Spectroscopy

if TYPE_CHECKING:
    import xarray as xr


@overload
def homogeneous_path(
    *,
    temperature_k: float,
    pressure_hpa: float,
    vapour_pressure_hpa: float,
    length_km: float,
    band_um: tuple[float, float],
    co2_ppmv: float = ...,
    o3_ppmv: float = ...,
    n2o_ppmv: float = ...,
    co_ppmv: float = ...,
    ch4_ppmv: float = ...,
    spectroscopy: Spectroscopy = ...,
    haze: str = ...,
    return_spectrum: Literal[False] = ...,
) -> float: ...


@overload
def homogeneous_path(
    *,
    temperature_k: float,
    pressure_hpa: float,
    vapour_pressure_hpa: float,
    length_km: float,
    band_um: tuple[float, float],
    co2_ppmv: float = ...,
    o3_ppmv: float = ...,
    n2o_ppmv: float = ...,
    co_ppmv: float = ...,
    ch4_ppmv: float = ...,
    spectroscopy: Spectroscopy = ...,
    haze: str = ...,
    return_spectrum: Literal[True],
) -> tuple[float, xr.DataArray]: ...


def homogeneous_path(
    *,
    temperature_k: float,
    pressure_hpa: float,
    vapour_pressure_hpa: float,
    length_km: float,
    band_um: tuple[float, float],
    co2_ppmv: float = 0.0,
    o3_ppmv: float = 0.0,
    n2o_ppmv: float = 0.0,
    co_ppmv: float = 0.0,
    ch4_ppmv: float = 0.0,
    spectroscopy: Spectroscopy = "lblrtm",
    haze: str = "none",
    return_spectrum: bool = False,
) -> float | tuple[float, xr.DataArray]:
    """Compute the mean transmittance of a path through air of one temperature and pressure.

    Parameters
    ----------
    temperature_k, pressure_hpa, vapour_pressure_hpa : float
        Temperature [K], pressure of the air and of its water vapour [hPa].
    length_km : float
        Length of the path [km].
    band_um : (float, float)
        Shortest and longest wavelength [um], within 0.7-14.7.
    co2_ppmv, o3_ppmv, n2o_ppmv, co_ppmv, ch4_ppmv : float
        Gases [1e-6 of the volume of dry air]. Besides them the air is nitrogen, oxygen and water vapour.
    spectroscopy : {"lblrtm", "lowtran7"}
        Absorption of today's line-by-line model, or LOWTRAN7's of 1988.
    haze : str
        Aerosol of the scenario key ``atmosphere.haze``, at calm wind and its own visibility.
    return_spectrum : bool
        True for the spectrum besides the mean.

    Returns
    -------
    float, or (float, xarray.DataArray)
        Mean transmittance [1], weighted with the blackbody at the temperature of the path, and the transmittance over ``wavenumber_cm``
        in channels 20 cm-1 wide, 5 cm-1 apart, which reach up to 5 cm-1 beyond the band.

    Raises
    ------
    DomainError
        A number outside its range.

    Notes
    -----
    Mean transmittances of RRTMGP's bands between 700 and 3250 cm-1 differ from it by 0.002 to 0.007 on the average, in the ozone band of
    the upper air by 0.016; 95 of 100 by less than 0.02 and 0.04 (docs, validation). Nitrogen absorbs in 2390-2680 cm-1 and oxygen in
    1480-1800 cm-1, as RRTMGP's tables have them; the air of scenes has LOWTRAN7's nitrogen in 2080-2390 cm-1 too. Temperatures, humidities
    and gases that air does not have are reported in a line.

    Examples
    --------
    Five kilometres of moist air at the sea:

    >>> import seaglint as sg
    >>> air = dict(temperature_k=300.0, pressure_hpa=1013.0, vapour_pressure_hpa=26.0, length_km=5.0, co2_ppmv=425.0)
    >>> round(sg.homogeneous_path(band_um=(10.2, 12.2), **air), 2)
    0.1
    """
    from seaglint.air.profile.hazes import HazeWeather
    from seaglint.air.profile.homogeneous_path import homogeneous_spectrum

    found = homogeneous_spectrum(
        temperature_k=temperature_k,
        pressure_hpa=pressure_hpa,
        vapour_pressure_hpa=vapour_pressure_hpa,
        length_km=length_km,
        band_um=band_um,
        ppmv={"CO2": co2_ppmv, "O3": o3_ppmv, "N2O": n2o_ppmv, "CO": co_ppmv, "CH4": ch4_ppmv},
        spectroscopy=spectroscopy,
        haze=HazeWeather(haze),
    )
    if not return_spectrum:
        return found.mean
    import xarray as xr

    axis = xr.Variable("wavenumber_cm", found.wavenumber_cm, {"units": "cm-1", "long_name": "wavenumber"})
    values = xr.DataArray(found.transmittance, {"wavenumber_cm": axis}, ("wavenumber_cm",), "transmittance", {"units": "1"})
    return found.mean, values
