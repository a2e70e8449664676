"""The commands ``seaglint weather build`` and ``seaglint weather info``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.cli.terminal.messages import log, print_json, print_lines

if TYPE_CHECKING:
    from seaglint.climate.table_summary import WeatherFacts

weather = typer.Typer(help="Tables of weather: how often which conditions come.", no_args_is_help=True)


@weather.command()
def build(
    sources: Annotated[
        list[Path],
        typer.Argument(
            metavar="SOURCES...", help="ERA5 NetCDF or GRIB, ICOADS IMMA1 or CSV, NDBC text, weather tables, CSV with --map; or world"
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="table to write: .csv, or .parquet where PyArrow is installed")],
    box: Annotated[str | None, typer.Option("--box", metavar="W,S,E,N", help="places inside [deg]; west beyond east crosses 180")] = None,
    polygon: Annotated[
        str | None, typer.Option("--polygon", help="places inside: 'lon,lat lon,lat lon,lat', or a .csv or .geojson file")
    ] = None,
    months: Annotated[str | None, typer.Option("--months", help="e.g. 6,7,8 or 12-2")] = None,
    hours: Annotated[str | None, typer.Option("--hours", help="hours of UTC, e.g. 0,6,12,18 or 6-18")] = None,
    region: Annotated[
        str | None, typer.Option("--region", help="name of the rows; where a source names regions, the one that is taken")
    ] = None,
    columns: Annotated[
        list[str] | None, typer.Option("--map", metavar="NAME=COLUMN:UNIT", help="column of a CSV file, e.g. wind_speed_m_s=ws:kn; repeat")
    ] = None,
    fill: Annotated[
        list[str] | None, typer.Option("--fill", metavar="NAME=VALUE", help="value where one is missing, e.g. cloud_cover=0.6; repeat")
    ] = None,
    utc: Annotated[bool, typer.Option("--utc", help="times of CSV files without a zone are UTC")] = False,
    place: Annotated[
        str | None, typer.Option("--place", metavar="LAT,LON", help="place of a source that has none, or of rows of world [deg]")
    ] = None,
    anemometer: Annotated[
        float | None, typer.Option("--anemometer-height", help="of NDBC buoys [m]; winds are brought from there to 10 m")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an existing output")] = False,
) -> None:
    """Make a table of weather from reanalysis, ships, buoys or CSV.

    Omissions and assumptions are reported with counts.
    """
    from seaglint.climate.weather_selection import Selection
    from seaglint.formats.weather.weather_cells import parse_box, parse_cycle, read_polygon
    from seaglint.formats.weather.weather_file import WeatherReading, check_output, write_weather
    from seaglint.scenario.text.option_texts import parse_fill, parse_map, parse_place
    from seaglint.studies.likelihood.weather_files import build as build_table

    check_output(output, overwrite=overwrite, inputs=sources)
    selection = Selection(
        None if box is None else parse_box(box),
        None if polygon is None else read_polygon(polygon),
        None if months is None else parse_cycle(months, "months", 1, 12),
        None if hours is None else parse_cycle(hours, "hours", 0, 23),
        region,
    )
    reading = WeatherReading(parse_map(columns or []), utc, anemometer, None if place is None else parse_place(place))
    built = build_table(sources, selection, reading, fill=parse_fill(fill or []))
    write_weather(built.table, output, notes=built.notes, overwrite=overwrite)
    for note in built.notes:
        log(note)
    log(f"{output}: {len(built.table)} rows written")


@weather.command()
def info(
    table: Annotated[str, typer.Argument(metavar="FILE", help="weather table, or one of the package: world, north-atlantic")],
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    plot: Annotated[Path | None, typer.Option("--plot", help="picture to write: wind rose, joint density, months, missing values")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the picture")] = False,
) -> None:
    """Describe the contents of a weather table.

    Means, months, wind rose, wind and cloud together, share of missing values.
    """
    from seaglint.base.errors import DataError
    from seaglint.store.outputs import refuse_existing
    from seaglint.studies.likelihood.weather_files import describe

    if plot is not None:
        if plot.suffix.lower() not in (".png", ".pdf", ".svg"):
            raise DataError(f"{plot}: a picture is .png, .pdf or .svg; give a name that ends so")
        refuse_existing(plot, overwrite=overwrite, inputs=[table])
    _, facts = describe(table)
    if as_json:
        print_json(facts.as_dict())
    else:
        print_lines(lines(facts))
    if plot is not None:
        from seaglint.plot.environment_charts import write_weather_plot

        write_weather_plot(facts, plot)
        log(f"{plot} written")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


def lines(facts: WeatherFacts) -> list[str]:
    """Return the facts of a weather table as lines of text."""
    from seaglint.climate.weather_table import stand_ins_told

    out = [f"{facts.path}: {facts.rows} rows, effectively {facts.effective_rows:.0f}, weights sum to {facts.weight_sum:.6g}"]
    out.append(f"  covers {facts.covers}")
    if facts.regions:
        out.append(f"  regions {', '.join(facts.regions)}")
    if facts.missing_months:
        out.append(f"  {stand_ins_told(facts.missing_months)}")
    out.append(f"  {'column':22} {'mean':>9} {'min':>9} {'max':>9} {'missing %':>10}")
    for name, column in facts.columns.items():
        numbers = " ".join(f"{_number(value):>9}" for value in (column.mean, column.min, column.max))
        out.append(f"  {name:22} {numbers} {100 * column.missing_share:>10.3g}")
    absent = [name for name, share in facts.missing_share.items() if share == 1.0 and name not in facts.columns]
    if absent:
        out.append(f"  not in the table: {', '.join(absent)}")
    if facts.atmospheres:
        out.append("  atmospheres " + ", ".join(f"{name} {100 * share:.3g} %" for name, share in facts.atmospheres.items()))
    if facts.wind_cloud_correlation is not None:
        out.append(f"  correlation of wind speed and cloud cover {facts.wind_cloud_correlation:.3f}")
    if facts.by_month:
        out.append(f"  {'month':>5} {'rows':>9} {'weight %':>9} {'wind m/s':>9} {'cloud':>9}")
        for m in facts.by_month:
            numbers = f"{100 * m.probability:>9.3g} {_number(m.wind_speed_m_s):>9} {_number(m.cloud_cover):>9}"
            out.append(f"  {m.month:>5} {m.rows:>9} {numbers}")
    rose = facts.wind_rose
    share = [sum(classes) for classes in rose.probability]
    if sum(share) > 0.0:
        best = max(range(len(share)), key=lambda k: share[k])
        out.append(f"  most frequent wind from {rose.sector_centre_deg[best]:g} deg, {100 * share[best]:.3g} % of the weight")
    return out + [f"  # {note}" for note in facts.notes]
