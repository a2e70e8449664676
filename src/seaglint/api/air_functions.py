"""Functions ``sg.atmosphere``: soundings, the air along paths and of the sky, files of it, and MODTRAN's files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from seaglint.api.inputs_and_results import ResultRecord, paths_of, scenario_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from seaglint.air.profile.band_laws import Spectroscopy
    from seaglint.api.inputs_and_results import SceneInput

__all__ = ["export", "info", "path", "read", "sky", "write"]


def info(
    source: str | Path,
    *,
    sea_temperature: float = 288.15,
    model: str = "midlatitude-summer",
    place: tuple[float, float] | None = None,
    time: datetime | str | None = None,
) -> ResultRecord:
    """Levels, water vapour and refraction of a sounding.

    Parameters
    ----------
    source : str or path
        File of a sounding, or the name of a model atmosphere such as ``midlatitude-summer``.
    sea_temperature : float
        Temperature of the sea to compare with [K].
    model : str
        Model atmosphere that continues a sounding.
    place : (float, float), optional
        Latitude and longitude [deg] in a file that holds several places.
    time : datetime or str, optional
        Time in a file that holds several, such as ``"2024-07-01T06:00Z"``; UTC where it has no zone.

    Returns
    -------
    ResultRecord
        Levels, water vapour, hydrostatic misfit, the lowest air, refraction and ducts; ``plot()`` draws temperature, humidity and
        refractivity.

    Raises
    ------
    SeaglintError
        No such model, a file that cannot be read, a temperature outside 200 to 350 K.

    Examples
    --------
    >>> import seaglint as sg
    >>> round(sg.atmosphere.info("tropical")["air_minus_sea_k"], 1)
    11.5
    """
    from seaglint.formats.soundings.air_summary import moment_of, place_of_air, summarise_air

    summary = summarise_air(str(source), sea_temperature, model, place_of_air(place), moment_of(time))

    def draw() -> Figure:
        from seaglint.plot.environment_charts import draw_air

        return draw_air(summary)

    return ResultRecord(summary.as_dict(), draw=draw, title=f"air of {source}")


def path(
    scenario: SceneInput | None = None,
    *,
    range_m: ArrayLike | None = None,
    target_height_m: ArrayLike = 0.0,
    temperature_k: float | None = None,
    pressure_hpa: float | None = None,
    vapour_pressure_hpa: float | None = None,
    length_km: float | None = None,
    band_um: tuple[float, float] | None = None,
    co2_ppmv: float = 0.0,
    o3_ppmv: float = 0.0,
    n2o_ppmv: float = 0.0,
    co_ppmv: float = 0.0,
    ch4_ppmv: float = 0.0,
    spectroscopy: Spectroscopy = "lblrtm",
    haze: str = "none",
) -> xr.Dataset:
    """Transmittance of paths through the air.

    Parameters
    ----------
    scenario : Scenario, path or mapping, optional
        Scenario whose air, band and sensor height are taken; it needs ``range_m``. Without it the path goes through even air.
    range_m : array_like, optional
        Arcs along the sea from the foot of the sensor to the foot of each point [m].
    target_height_m : array_like
        Heights of the points above the mean sea [m]; 0 is the sea.
    temperature_k, pressure_hpa, vapour_pressure_hpa : float, optional
        Even air: its temperature [K], pressure and pressure of the water vapour [hPa].
    length_km : float, optional
        Even air: length of the path [km].
    band_um : (float, float), optional
        Even air: shortest and longest wavelength [um], within 0.7-14.7.
    co2_ppmv, o3_ppmv, n2o_ppmv, co_ppmv, ch4_ppmv : float
        Even air: gases [1e-6 of the volume of dry air].
    spectroscopy : {"lblrtm", "lowtran7"}
        Even air: absorption of the line-by-line model LBLRTM, or LOWTRAN7's of 1988.
    haze : str
        Even air: aerosol, as the scenario key ``atmosphere.haze``.

    Returns
    -------
    xarray.Dataset
        ``transmittance`` [1], the mean over the band weighted with the blackbody at the temperature of the water or of the even air, and
        ``spectral_transmittance`` over ``wavenumber_cm``; of a scenario ``path_radiance`` [W m-2 sr-1], ``slant_range`` [m] and
        ``lowest_height`` [m] as well, all over ``target_height_m`` and ``range_m``. Where ``lowest_height`` is below 0, the sea hides the
        point.

    Raises
    ------
    SeaglintError
        Numbers that are missing, outside their range, or of the other kind of path.

    Examples
    --------
    >>> import seaglint as sg
    >>> long_wave = {"band": {"min_um": 8.0, "max_um": 12.0}}
    >>> air = sg.atmosphere.path(long_wave, range_m=[1000.0, 10000.0], target_height_m=10.0)
    >>> air.transmittance.dims
    ('target_height_m', 'range_m')
    """
    from seaglint.studies.air_paths import even_path, path_air, require_one_kind

    even = {"temperature_k": temperature_k, "pressure_hpa": pressure_hpa}
    even |= {"vapour_pressure_hpa": vapour_pressure_hpa, "length_km": length_km}
    # Numbers of both kinds of path are refused, because one kind would be ignored silently.
    require_one_kind(scenario is not None, range_m is not None, {**even, "band_um": band_um})
    if scenario is not None and range_m is not None:
        return path_air(scenario_of(scenario), range_m, target_height_m)
    gases = {"CO2": co2_ppmv, "O3": o3_ppmv, "N2O": n2o_ppmv, "CO": co_ppmv, "CH4": ch4_ppmv}
    return even_path(even, band_um, gases, spectroscopy, haze)


def sky(scenario: SceneInput, *, zenith_deg: ArrayLike, azimuth_deg: ArrayLike | None = None) -> xr.Dataset:
    """Radiance and apparent temperature of the clear sky.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        Scenario whose air, band, Sun and sensor height are taken.
    zenith_deg : array_like
        Zenith angles looked at from the sensor [deg], from 0 to the horizon.
    azimuth_deg : array_like, optional
        Azimuths looked at, clockwise from north [deg]; by default the sensor's azimuth.

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1], its parts ``thermal_radiance`` and ``scattered_radiance``, ``apparent_temperature`` [K], all over
        ``zenith_deg`` and ``azimuth_deg``; ``spectral_thermal_radiance`` over ``wavenumber_cm`` too.

    Raises
    ------
    SeaglintError
        A direction below the horizon, or a scenario that cannot be computed.

    Examples
    --------
    >>> import seaglint as sg
    >>> long_wave = {"band": {"min_um": 8.0, "max_um": 12.0}}
    >>> sky = sg.atmosphere.sky(long_wave, zenith_deg=[0.0, 60.0, 85.0])
    >>> bool((sky.apparent_temperature.diff("zenith_deg") > 0.0).all())
    True
    """
    from seaglint.studies.air_paths import sky_air

    return sky_air(scenario_of(scenario), zenith_deg, azimuth_deg)


def export(scenario: SceneInput, output: str | Path | None = None, *, overwrite: bool = False) -> xr.Dataset:
    """Write the air of a scenario's sensor height and band.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        Scenario whose sensor height and band are taken.
    output : path, optional
        File to write too: ``.nc`` NetCDF or ``.csv`` text, which ``atmosphere.source = "file"`` reads.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    xarray.Dataset
        Transmittance and radiance of paths, sunlight and sky at nodes, over ``wavenumber_cm``.

    Raises
    ------
    SeaglintError
        A scenario whose air is a file already, or an output that cannot be written.

    Examples
    --------
    >>> import seaglint as sg
    >>> air = sg.atmosphere.export({"band": {"min_um": 3.9, "max_um": 4.0}})
    >>> air.path_transmittance.dims
    ('range_m', 'wavenumber_cm')
    """
    from seaglint.studies.air_files import export_air

    loaded = scenario_of(scenario)
    return _written(lambda: export_air(loaded), output, overwrite)


def write(
    scenario: SceneInput,
    output: str | Path,
    *,
    form: Literal["tape5", "tape5-lowtran7", "modtran6-json"] = "tape5",
    scattered: bool = True,
    overwrite: bool = False,
) -> Path:
    """Write a MODTRAN deck of a scenario's lines of sight.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        Scenario whose sensor height, band, wind, Sun and atmosphere are taken.
    output : path
        Folder for the deck and its manifest; it is made.
    form : str
        ``tape5`` (MODTRAN 4 and 5), ``tape5-lowtran7`` or ``modtran6-json``.
    scattered : bool
        Request sunlight scattered by the air, where the Sun is up.
    overwrite : bool
        Replace files that are there.

    Returns
    -------
    Path
        The deck.

    Raises
    ------
    SeaglintError
        Air that no such code could compute, or a folder that cannot be written.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> scene = {"atmosphere": {"source": "lowtran"}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.atmosphere.write(scene, f"{folder}/deck").name
    'lines.tp5'
    """
    from seaglint.studies.air_files import write_decks

    return write_decks(scenario_of(scenario), Path(output), form, scattered=scattered, overwrite=overwrite).deck


def read(files: str | Path | Sequence[str | Path], output: str | Path | None = None, *, overwrite: bool = False) -> xr.Dataset:
    """Make a file of air from what MODTRAN or LOWTRAN7 computed.

    Parameters
    ----------
    files : path or sequence of path
        tape7, ``.tp7``, ``.7sc``, CSV or JSON of LOWTRAN7 or MODTRAN 4-6, or the folder that :func:`write` made.
    output : path, optional
        File to write too: ``.nc`` NetCDF or ``.csv`` text, which ``atmosphere.source = "file"`` reads.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    xarray.Dataset
        Transmittance and radiance of paths, sky, sunlight and scattered sunlight, as far as the files hold them.

    Raises
    ------
    SeaglintError
        A file, case or line that cannot be used; it is named.

    Examples
    --------
    >>> import seaglint as sg
    >>> air = sg.atmosphere.read("deck", "air.nc")  # doctest: +SKIP
    """
    from seaglint.formats.modtran.modtran_air import read_air

    paths = paths_of(files, "files")
    return _written(lambda: read_air(paths), output, overwrite, [path for path in paths if path.is_file()])


def _written(compute: Callable[[], xr.Dataset], output: str | Path | None, overwrite: bool, inputs: Sequence[Path] = ()) -> xr.Dataset:
    """Return computed air, and write it to a file if one is requested, whose name is checked before the computation."""
    from seaglint.formats.air_file import require_kind, write_atmosphere
    from seaglint.store.outputs import refuse_existing

    if output is None:
        return compute()
    require_kind(Path(output))
    refuse_existing(Path(output), overwrite=overwrite, inputs=inputs)
    air = compute()
    write_atmosphere(air, Path(output), overwrite=overwrite)
    return air
