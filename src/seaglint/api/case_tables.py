"""Functions ``sg.evaluate``: results for many cases at once, a case a row of a table, and slope variances of a sea by band."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.base.errors import DataError
from seaglint.base.parameters import documented
from seaglint.studies.study_requests import AirRequest, EvaluationRequest, MeanCasesRequest, SlopesRequest

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.api.inputs_and_results import SceneInput
    from seaglint.base.conventions import Progress

    CasesInput = str | Path | Mapping[str, Sequence[Any]] | xr.Dataset | Any

__all__ = ["atmosphere", "emissivity", "mean", "scattered", "slopes"]


@documented(AirRequest)
def atmosphere(
    cases: CasesInput,
    *,
    bands: Sequence[str | tuple[float, float]],
    levels: Literal["lowtran", "continuous"] = "lowtran",
    extrapolate: bool = False,
    output: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Transmittance, path, sunlight and sky of LOWTRAN7's models.

    Parameters
    ----------
    cases : path, mapping, DataFrame or Dataset
        CSV file, or columns by name: ``atmosphere`` (a model's name), ``wind_speed_m_s``, ``sensor_height_m``, ``depression_deg`` (of the
        refracted ray at the sensor; it must end on the sea), ``solar_zenith_deg``, ``sky_zenith_deg``.
    {request}
    output : path, optional
        CSV file to write too.
    progress : callable, optional
        Called with (rows and bands done, all of them).

    Returns
    -------
    xarray.Dataset
        Over ``case`` and ``band``: ``tau_mean`` [1], ``path_radiance_W_m2_sr``, ``sun_normal_irradiance_W_m2`` (at the sea, Sun at 1 au),
        ``sun_times_tau_W_m2``, ``sky_radiance_W_m2_sr`` (from the sea); the columns of the cases over ``case``.

    Raises
    ------
    SeaglintError
        A column missing, or a value that cannot be used; its row and column are named.

    Examples
    --------
    >>> import seaglint as sg
    >>> case = dict(atmosphere=["tropical"], wind_speed_m_s=[5.0], sensor_height_m=[20.0])
    >>> case |= dict(depression_deg=[1.0], solar_zenith_deg=[60.0], sky_zenith_deg=[30.0])
    >>> result = sg.evaluate.atmosphere(case, bands=["3.5-4.1"])
    >>> result.tau_mean.dims
    ('case', 'band')
    """
    from seaglint.studies.mean.evaluate_cases import evaluate_atmosphere

    return _evaluated(cases, partial(evaluate_atmosphere, bands=_bands(bands), levels=levels), extrapolate, output, overwrite, progress)


@documented(EvaluationRequest)
def emissivity(
    cases: CasesInput,
    *,
    extrapolate: bool = False,
    output: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Emissivity of the wind-roughened sea.

    Isotropic Cox-Munk slopes, salt water, sea-to-sea reflection on.

    Parameters
    ----------
    cases : path, mapping, DataFrame or Dataset
        CSV file, or columns by name: ``wavelength_um``, ``wind_speed_m_s`` (at 12.5 m, the height of the slope fit), ``zenith_deg``.
    {request}
    output : path, optional
        CSV file to write too.
    progress : callable, optional
        Called with (rows done, all of them).

    Returns
    -------
    xarray.Dataset
        ``emissivity`` [1] and the columns of the cases over ``case``.

    Raises
    ------
    SeaglintError
        A column missing, or a value that cannot be used; its row and column are named.

    Examples
    --------
    >>> import seaglint as sg
    >>> case = {"wavelength_um": [10.0], "wind_speed_m_s": [5.0], "zenith_deg": [0.0]}
    >>> result = sg.evaluate.emissivity(case)
    >>> round(float(result.emissivity[0]), 2)
    0.99
    """
    from seaglint.studies.mean.evaluate_cases import evaluate_emissivity

    return _evaluated(cases, evaluate_emissivity, extrapolate, output, overwrite, progress)


@documented(MeanCasesRequest)
def mean(
    cases: CasesInput,
    *,
    bands: Sequence[str | tuple[float, float]],
    extrapolate: bool = False,
    sea_draws: int | None = None,
    output: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Mean radiance of the sea, and standard deviation of glint.

    Cox-Munk slopes, shadowed towards viewer and Sun; salt water; Sun at 1 au; glint
    fluctuates with the waves shorter than 2 m.

    Parameters
    ----------
    cases : path, mapping, DataFrame or Dataset
        CSV file, or columns by name: ``atmosphere`` (a model's name), ``wind_speed_m_s`` (at 10 m), ``sensor_height_m``,
        ``depression_deg``, ``solar_zenith_deg``, ``relative_azimuth_deg`` (0 looks towards the Sun), ``sea_temperature_k``, ``ifov_mrad``
        (side of the square pixel); optional ``wind_from_deg`` (clockwise from the Sun's azimuth) and ``slopes``.
    {request}
    output : path, optional
        CSV file to write too.
    progress : callable, optional
        Called with (rows and bands done, all of them).

    Returns
    -------
    xarray.Dataset
        Over ``case`` and ``band``: ``radiance_W_m2_sr``, ``apparent_temperature_K``, ``std_W_m2_sr``, with ``sea_draws`` of each also
        ``..._sea_unknown_low`` and ``..._sea_unknown_high``; the columns of the cases over ``case``.

    Raises
    ------
    SeaglintError
        A column missing, or a value that cannot be used; its row and column are named.

    Examples
    --------
    >>> import seaglint as sg
    >>> case = dict(atmosphere=["tropical"], wind_speed_m_s=[5.0], sensor_height_m=[20.0])
    >>> case |= dict(depression_deg=[2.0], solar_zenith_deg=[60.0], ifov_mrad=[0.5])
    >>> case |= dict(relative_azimuth_deg=[90.0], sea_temperature_k=[300.0])
    >>> sg.evaluate.mean(case, bands=["3.5-4.1", "8-12"]).radiance_W_m2_sr.shape
    (1, 2)
    """
    from seaglint.studies.mean.evaluate_cases import evaluate_mean

    MeanCasesRequest(sea_draws=sea_draws)
    compute = partial(evaluate_mean, bands=_bands(bands), sea_draws=sea_draws)
    return _evaluated(cases, compute, extrapolate, output, overwrite, progress)


@documented(AirRequest)
def scattered(
    cases: CasesInput,
    *,
    bands: Sequence[str | tuple[float, float]],
    levels: Literal["lowtran", "continuous"] = "lowtran",
    extrapolate: bool = False,
    output: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Sunlight scattered into paths to the sea and the clear sky.

    Single scattering as LOWTRAN7's, Sun at 1 au; a Sun 6 deg below the horizon scatters nothing.

    Parameters
    ----------
    cases : path, mapping, DataFrame or Dataset
        CSV file, or columns by name: ``kind`` (path or sky), ``atmosphere`` (a model's name), ``wind_speed_m_s``, ``sensor_height_m`` (0
        for sky seen from the sea), ``elevation_deg`` (below 0 for paths, which must end on the sea), ``azimuth_from_sun_deg``,
        ``solar_zenith_deg`` (at the sensor, without refraction).
    {request}
    output : path, optional
        CSV file to write too.
    progress : callable, optional
        Called with (rows and bands done, all of them).

    Returns
    -------
    xarray.Dataset
        Over ``case`` and ``band``: ``scattered_W_m2_sr``, ``thermal_W_m2_sr``; the columns of the cases over ``case``.

    Raises
    ------
    SeaglintError
        A column missing, or a value that cannot be used; its row and column are named.

    Examples
    --------
    >>> import seaglint as sg
    >>> case = dict(kind=["sky"], atmosphere=["tropical"], wind_speed_m_s=[5.0])
    >>> case |= dict(sensor_height_m=[0.0], elevation_deg=[30.0])
    >>> case |= dict(azimuth_from_sun_deg=[40.0], solar_zenith_deg=[50.0])
    >>> result = sg.evaluate.scattered(case, bands=["3.5-4.1"])
    >>> round(float(result.scattered_W_m2_sr[0, 0]), 3)
    0.047
    """
    from seaglint.studies.mean.evaluate_cases import evaluate_scattered

    return _evaluated(cases, partial(evaluate_scattered, bands=_bands(bands), levels=levels), extrapolate, output, overwrite, progress)


@documented(SlopesRequest)
def slopes(scenario: SceneInput, *, bands: Sequence[float] | str = (1.0, 5.0, 10.0, 20.0, 50.0, 100.0, 300.0, 1000.0)) -> xr.Dataset:
    """Slope variance of a scenario's sea by bands of the wavenumber.

    Parameters
    ----------
    {request}

    Returns
    -------
    xarray.Dataset
        Over ``band``, with ``k_min_rad_m`` and ``k_max_rad_m``: ``drawn_up``, ``drawn_cross`` (waves that are geometry), ``facets_up``,
        ``facets_cross`` (slope law minus drawn), ``spectrum_up``, ``spectrum_cross`` [1]; attributes with the same of the whole sea.

    Raises
    ------
    SeaglintError
        Edges that are fewer than two, negative or not ascending; a scenario that cannot be used.

    Examples
    --------
    >>> import seaglint as sg
    >>> scene = {"wind": {"speed_m_s": 8}, "sea": {"spectrum": {"kind": "asit-2019"}}}
    >>> bands = sg.evaluate.slopes(scene, bands=[20, 100, 1000])
    >>> bands.facets_up.round(4).values.tolist()
    [0.0055, 0.0026]
    """
    from seaglint.api.inputs_and_results import scenario_of
    from seaglint.studies.mean.slope_bands import slope_bands

    return slope_bands(scenario_of(scenario), bands).dataset()


def _bands(bands: Sequence[str | tuple[float, float]]) -> Any:
    """Return bands of texts such as ``3.0-5.0`` or of pairs of wavelengths [um]."""
    from seaglint.studies.mean.evaluate_cases import parse_bands

    try:
        given = [bands] if isinstance(bands, str) else bands
        texts = [band if isinstance(band, str) else f"{band[0]:g}-{band[1]:g}" for band in given]
    except (TypeError, ValueError, IndexError):
        raise DataError(f"bands = {bands} are no bands; give a list of texts such as '3-5' or of pairs of wavelengths [um]") from None
    return parse_bands(texts)


def _evaluated(
    given: CasesInput, compute: Callable[..., Any], extrapolate: bool, output: str | Path | None, overwrite: bool, progress: Progress | None
) -> xr.Dataset:
    """Read the cases, compute, write the CSV file where one is requested, and label the results."""
    import xarray as xr

    from seaglint.formats.tables.input_tables import cases_of_columns, read_cases, write_cases
    from seaglint.store.outputs import refuse_existing, require_ending
    from seaglint.studies.mean.evaluate_cases import labelled_cases

    if output is not None:
        refuse_existing(require_ending(Path(output), (".csv", ".txt"), "the results are a CSV file"), overwrite=overwrite)
    if isinstance(given, str | Path):
        cases = read_cases(given)
    else:
        if not isinstance(given, Mapping) and not hasattr(given, "columns"):
            raise DataError(f"cases are of type {type(given).__name__}; give a CSV file, a mapping of columns, a DataFrame or a Dataset")
        columns: Any = given
        names = columns.data_vars if isinstance(columns, xr.Dataset) else columns
        cases = cases_of_columns({str(name): columns[name] for name in names})
    results = compute(cases, extrapolate=extrapolate, progress=progress)
    if output is not None:
        write_cases(cases, results, output, overwrite=overwrite)
    return labelled_cases(cases, results)
