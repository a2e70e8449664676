"""Functions of measurements: ``sg.analyze``, ``sg.apparent_temperature``, ``sg.compare`` and ``sg.homogeneous_path``.

The first two take recordings, the third takes a measured spectrum (:func:`compare_spectrum` is its full name), and the last one computes
the transmittance of air of one temperature and pressure, without a scenario.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NotRequired, TypedDict, Unpack, overload

from seaglint.air.profile.band_laws import Spectroscopy
from seaglint.base.parameters import documented
from seaglint.studies.study_requests import AnalysisRequest

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Analysis, Recording
    from seaglint.api.inputs_and_results import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.clutter.filters import Filter
    from seaglint.formats.recording import RawLayout
    from seaglint.optics.band import Band
    from seaglint.studies.measured.compare_spectrum import SpectrumComparison


@documented(AnalysisRequest)
def analyze(
    recording: xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    *,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    missing: Sequence[float] = (),
    saturation: float | None = None,
    raw: RawLayout | None = None,
    filter: str | Filter = "laplacian",
    kernel: ArrayLike | None = None,
    signature: ArrayLike | None = None,
    thresholds: Sequence[float] = (),
    scope: Literal["frame", "sequence", "local"] = "frame",
    rows: tuple[float, float] = (0.0, 1.0),
    mask: ArrayLike | None = None,
    no_glint: bool = False,
    regions: ArrayLike | Mapping[str, str | ArrayLike] | str | Path | None = None,
    border: Literal["auto", "keep", "drop"] = "auto",
    detectors: str | Callable[[NDArray[Any]], Any] | Sequence[str | Callable[[NDArray[Any]], Any]] = (),
    time_limit: float = 60.0,
    seed: int = 0,
    progress: Progress | None = None,
) -> Analysis:
    """Clutter statistics and false alarms of a recording, by region.

    Parameters
    ----------
    recording : xarray.Dataset, xarray.DataArray, ndarray, path or Recording
        Result of :func:`render` or a part of it, an array (rows, columns) or (frames, rows, columns), or a file of any format that
        ``seaglint.formats.recording.open_recording`` reads.
    {request}
    progress : callable, optional
        Called with (frames read, frames to read in all).

    Returns
    -------
    Analysis
        The regions' numbers, ``as_dict()`` of them for a file, and what ``seaglint.plot.analysis_report`` writes a report of.

    Raises
    ------
    DataError
        An unknown filter, detector or word, regions that do not fit, or a recording without images or finite values.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> frames = np.random.default_rng(1).normal(1.0, 0.1, (20, 32, 32))
    >>> result = sg.analyze(frames, frame_rate=25.0, thresholds=[4.0], filter="none")
    >>> round(result.regions["all"].moments.std, 2)
    0.1
    """
    from seaglint.analysis import analyze as analysed
    from seaglint.api.inputs_and_results import recording_of, request_of

    several = tuple(detectors) if isinstance(detectors, list | tuple) else (detectors,)
    request = request_of(AnalysisRequest, locals(), thresholds=tuple(thresholds), detectors=several, missing=tuple(missing))
    with request.ready() as resolved:
        opened = recording_of(recording, request)
        return analysed(opened, resolved) if progress is None else analysed(opened, resolved, progress)


def apparent_temperature(radiance: xr.Dataset | xr.DataArray | ArrayLike, band: Band | tuple[float, float] | None = None) -> xr.DataArray:
    """Return the temperature of the blackbody with the radiance of each pixel in the band.

    Parameters
    ----------
    radiance : xarray.Dataset, xarray.DataArray or array_like
        In-band radiance [W m-2 sr-1], or a dataset that holds it as ``radiance``, or counts as ``signal``.
    band : Band or (float, float), optional
        Spectral band that it is integrated over, or the edges of a rectangular one [um]; from the attributes by default.

    Returns
    -------
    xarray.DataArray
        Kelvin, same shape, coordinates and other attributes; NaN for radiances of no temperature between 100 and 6500 K.

    Raises
    ------
    DataError
        No band given, and none in the attributes.

    Examples
    --------
    >>> import seaglint as sg
    >>> round(float(sg.apparent_temperature(1.45, band=(3.0, 5.0))), 1)
    293.2
    """
    from seaglint.api.inputs_and_results import kelvin_of

    return kelvin_of(radiance, band)


def compare_spectrum(
    spectrum: str | Path | Mapping[str, ArrayLike],
    scenario: SceneInput,
    *,
    resolution_cm: float | None = None,
    zenith_deg: float | None = None,
    depression_deg: float | None = None,
    spectroscopy: Literal["lblrtm", "lowtran7"] | None = None,
) -> SpectrumComparison:
    """Compare a measured spectrum with a scenario's spectrum.

    Parameters
    ----------
    spectrum : path or mapping
        CSV file, or its columns: ``wavenumber_cm`` or ``wavelength_um``, and one of ``radiance_w_m2_sr_cm``, ``radiance_mw_m2_sr_cm``,
        ``radiance_w_cm2_sr_cm`` (per cm-1), the same with ``_um`` (per um), ``brightness_temperature_k``; ``resolution_cm`` if it is known.
    scenario : Scenario, path or mapping
        See :func:`load`; its band is left aside.
    resolution_cm : float, optional
        Full width at half maximum of the spectrum [cm-1]; by default from the file, else the spacing of its samples.
    zenith_deg, depression_deg : float, optional
        Direction looked at: the sky at a zenith angle, or the sea at an angle below the horizontal [deg]; by default the camera's axis.
    spectroscopy : str, optional
        Absorption of the air, ``lblrtm`` or ``lowtran7``; by default the scenario's.

    Returns
    -------
    SpectrumComparison
        Both spectra [W m-2 sr-1 per cm-1, (n,)] at one resolution, temperatures by band [K], and notes of what was averaged or left out.

    Raises
    ------
    SeaglintError
        A spectrum without a unit, with negative or missing numbers, or outside 0.7-14.7 um; a direction or resolution that cannot be.

    Examples
    --------
    >>> import seaglint as sg
    >>> sky = {"wavelength_um": [8.5, 8.7, 8.9, 9.1], "resolution_cm": 20.0}
    >>> sky["brightness_temperature_k"] = [262, 259, 257, 254]
    >>> scene = sg.load({"sensor": {"height_m": 20}})
    >>> result = sg.compare_spectrum(sky, scene, zenith_deg=30.0)
    >>> result.resolution_cm, len(result.bands)
    (20.0, 1)
    """
    from seaglint.api.inputs_and_results import arguments_of, scenario_of
    from seaglint.studies.measured.compare_spectrum import compare_spectrum as compared

    return compared(**arguments_of(compared, locals(), scenario=scenario_of(scenario)))


compare = compare_spectrum


class EvenAir(TypedDict):
    """Parameters of :func:`homogeneous_path` besides the kind of its result."""

    temperature_k: float
    pressure_hpa: float
    vapour_pressure_hpa: float
    length_km: float
    band_um: tuple[float, float]
    co2_ppmv: NotRequired[float]
    o3_ppmv: NotRequired[float]
    n2o_ppmv: NotRequired[float]
    co_ppmv: NotRequired[float]
    ch4_ppmv: NotRequired[float]
    spectroscopy: NotRequired[Spectroscopy]
    haze: NotRequired[str]


@overload
def homogeneous_path(*, return_spectrum: Literal[False] = ..., **air: Unpack[EvenAir]) -> float: ...


@overload
def homogeneous_path(*, return_spectrum: Literal[True], **air: Unpack[EvenAir]) -> tuple[float, xr.DataArray]: ...


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
    >>> air = dict(temperature_k=300.0, pressure_hpa=1013.0, vapour_pressure_hpa=26.0)
    >>> air |= dict(length_km=5.0, co2_ppmv=425.0)
    >>> round(sg.homogeneous_path(band_um=(10.2, 12.2), **air), 2)
    0.1
    """
    from seaglint.air.profile.aerosols import HazeWeather
    from seaglint.air.profile.homogeneous_path import homogeneous_spectrum
    from seaglint.api.inputs_and_results import arguments_of

    gases = {"CO2": co2_ppmv, "O3": o3_ppmv, "N2O": n2o_ppmv, "CO": co_ppmv, "CH4": ch4_ppmv}
    spectrum = homogeneous_spectrum(**arguments_of(homogeneous_spectrum, locals(), ppmv=gases, haze=HazeWeather(haze)))
    if not return_spectrum:
        return spectrum.mean
    import xarray as xr

    axis = xr.Variable("wavenumber_cm", spectrum.wavenumber_cm, {"units": "cm-1", "long_name": "wavenumber"})
    values = xr.DataArray(spectrum.transmittance, {"wavenumber_cm": axis}, ("wavenumber_cm",), "transmittance", {"units": "1"})
    return spectrum.mean, values
