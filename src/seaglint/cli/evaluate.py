"""Commands ``seaglint evaluate ...``: columns of results for a CSV file of cases, and slope variances of a scenario's sea by band."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.cli.terminal.messages import log, naming_file, print_json, print_lines, show_logs
from seaglint.cli.terminal.options import AsJson, LateProgressOption
from seaglint.cli.terminal.progress import ProgressMode, patient_progress
from seaglint.cli.terminal.record_options import takes_records
from seaglint.studies.study_requests import AirRequest, EvaluationRequest, MeanCasesRequest, SlopesRequest

if TYPE_CHECKING:
    from seaglint.studies.mean.evaluate_cases import Columns

evaluate = typer.Typer(
    help="Results for many cases, and slope variances of a sea.\n\nEach row of a CSV file gets columns, and further columns pass through; "
    "slopes reads a scenario.",
    no_args_is_help=True,
)

CasesFile = Annotated[Path, typer.Argument(metavar="CASES.csv", help="one case a row; the first line names the columns")]
Output = Annotated[Path, typer.Option("-o", "--output", help="CSV file to write")]


def _one_thread() -> None:
    """Limit matrix products to one thread, unless NumPy is loaded already or the user has set a number.

    The products are small: threads that wait for each other take twice the processor time, and on a busy machine more time too.
    """
    if "numpy" not in sys.modules:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def _run(path: Path, output: Path, request: EvaluationRequest, show: ProgressMode, compute: Callable[..., Columns]) -> None:
    """Read cases, compute and write; errors in names of files are raised before the work."""
    from seaglint.formats.tables.input_tables import read_cases, write_cases
    from seaglint.store.outputs import refuse_existing, require_ending
    from seaglint.studies.mean.evaluate_cases import widest_sea_lines

    # The output may replace the cases: it contains all their rows and columns.
    require_ending(output, (".csv", ".txt"), "the results are a CSV file")
    refuse_existing(output, overwrite=request.overwrite)
    cases = read_cases(path)
    with patient_progress(show, "rows x bands") as report:
        columns = compute(cases, extrapolate=request.extrapolate, progress=report)
    replaced = write_cases(cases, columns, output, overwrite=request.overwrite)
    more = ", ..." if len(replaced) > 3 else ""
    note = f"; {len(replaced)} columns of {path} computed anew: {', '.join(replaced[:3])}{more}" if replaced else ""
    log(f"{output}: {len(cases)} rows written{note}")
    for line in widest_sea_lines(columns):
        log(line)


@evaluate.command()
@takes_records(order="cases output bands levels")
def atmosphere(cases: CasesFile, output: Output, request: AirRequest, show: LateProgressOption = ProgressMode.AUTO) -> None:
    """Transmittance, path, sunlight and sky of LOWTRAN7's models.

    Columns needed: atmosphere (a model's name), wind_speed_m_s, sensor_height_m, depression_deg (of the refracted ray at the sensor; it
    must end on the sea), solar_zenith_deg, sky_zenith_deg. Columns made, per band: tau_mean (flat over wavenumber),
    path_radiance_W_m2_sr, sun_normal_irradiance_W_m2 (at the sea, Sun at 1 au), sun_times_tau_W_m2, sky_radiance_W_m2_sr (from the sea).
    """
    _one_thread()
    from seaglint.studies.mean.evaluate_cases import evaluate_atmosphere, parse_bands

    _run(cases, output, request, show, partial(evaluate_atmosphere, bands=parse_bands(request.bands), levels=request.levels))


@evaluate.command()
@takes_records()
def emissivity(cases: CasesFile, output: Output, request: EvaluationRequest, show: LateProgressOption = ProgressMode.AUTO) -> None:
    """Emissivity of the wind-roughened sea.

    Isotropic Cox-Munk slopes, salt water, sea-to-sea reflection on.

    Columns needed: wavelength_um, wind_speed_m_s (at 12.5 m, as the slope fit has it), zenith_deg. Column made: emissivity.
    """
    _one_thread()
    from seaglint.studies.mean.evaluate_cases import evaluate_emissivity

    _run(cases, output, request, show, evaluate_emissivity)


@evaluate.command()
@takes_records(order="cases output bands sea_draws")
def mean(cases: CasesFile, output: Output, request: MeanCasesRequest, show: LateProgressOption = ProgressMode.AUTO) -> None:
    """Mean radiance of the sea, and standard deviation of glint.

    Columns needed: atmosphere (a model's name), wind_speed_m_s (at 10 m), sensor_height_m, depression_deg, solar_zenith_deg,
    relative_azimuth_deg (0 looks towards the Sun), sea_temperature_k, ifov_mrad (side of the square pixel). Columns made, per band:
    radiance_W_m2_sr, apparent_temperature_K, std_W_m2_sr. Cox-Munk slopes, shadowed towards viewer and Sun: isotropic, or with the
    column wind_from_deg (where the wind comes from, clockwise from the Sun's azimuth) along and across the wind, or as a column slopes
    specifies (cox-munk-isotropic, cox-munk-anisotropic, cox-munk-gram-charlier); salt water; Sun at 1 au; glint
    fluctuates with the waves shorter than 2 m.
    With --sea-draws N also ..._sea_unknown_low and ..._sea_unknown_high of each column, over N seas at the wind of the row, and sea_draws.
    """
    _one_thread()
    from seaglint.studies.mean.evaluate_cases import evaluate_mean, parse_bands

    _run(cases, output, request, show, partial(evaluate_mean, bands=parse_bands(request.bands), sea_draws=request.sea_draws))


@evaluate.command()
@takes_records(order="cases output bands levels")
def scattered(cases: CasesFile, output: Output, request: AirRequest, show: LateProgressOption = ProgressMode.AUTO) -> None:
    """Sunlight scattered into paths to the sea and the clear sky.

    Columns needed: kind (path or sky), atmosphere (a model's name), wind_speed_m_s, sensor_height_m (0 for sky seen from the sea),
    elevation_deg (of the refracted ray at the sensor; below 0 for paths, which must end on the sea), azimuth_from_sun_deg,
    solar_zenith_deg (at the sensor, without refraction). Columns made, per band: scattered_W_m2_sr, thermal_W_m2_sr. Single scattering
    as LOWTRAN7's, Sun at 1 au; a Sun 6 deg below the horizon scatters nothing.
    """
    _one_thread()
    from seaglint.studies.mean.evaluate_cases import evaluate_scattered, parse_bands

    _run(cases, output, request, show, partial(evaluate_scattered, bands=parse_bands(request.bands), levels=request.levels))


@evaluate.command()
@takes_records(order="scenario bands")
def slopes(request: SlopesRequest, as_json: AsJson = False) -> None:
    """Slope variance of a scenario's sea by bands of the wavenumber.

    Columns, up and across the wind: drawn (waves that are geometry), facets (slope law minus drawn), spectrum (all waves of sea.spectrum).
    A spectrum may have waves outside the bands: the last line has the whole sea.
    """
    _one_thread()
    from seaglint.scenario.load import load_scenario
    from seaglint.studies.mean.slope_bands import slope_bands

    show_logs()
    loaded = load_scenario(request.scenario)
    with naming_file(request.scenario, loaded):
        result = slope_bands(loaded, request.bands)
    if as_json:
        print_json(result.as_dict())
    else:
        print_lines(result.lines())
