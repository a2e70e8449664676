"""Functions ``sg.weather``: tables of how often which conditions come, made and described."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.api.inputs_and_results import ResultRecord, path_of, paths_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from seaglint.climate.table_summary import WeatherFacts

__all__ = ["build", "info"]


def build(
    sources: str | Path | Sequence[str | Path],
    output: str | Path | None = None,
    *,
    box: tuple[float, float, float, float] | None = None,
    polygon: Sequence[tuple[float, float]] | str | Path | None = None,
    months: Sequence[int] | str | None = None,
    hours: Sequence[int] | str | None = None,
    region: str | None = None,
    columns: Mapping[str, str] | None = None,
    fill: Mapping[str, float | str] | None = None,
    utc: bool = False,
    place: tuple[float, float] | None = None,
    anemometer: float | None = None,
    overwrite: bool = False,
) -> xr.Dataset:
    r"""Make a table of weather from reanalysis, ships, buoys or CSV.

    Parameters
    ----------
    sources : path or sequence of path
        ERA5 NetCDF or GRIB, ICOADS IMMA1 or CSV, NDBC text, weather tables, CSV with ``columns``; or ``world``, the climatology in the
        package.
    output : path, optional
        Table to write too: ``.csv``, or ``.parquet`` where PyArrow is installed.
    box : (float, float, float, float), optional
        West, south, east and north border of the places [deg]; west beyond east crosses 180.
    polygon : sequence of (float, float), or path, optional
        Corners of the area of the places, longitude and latitude [deg], or a ``.csv`` or ``.geojson`` file of them.
    months, hours : sequence of int, or str, optional
        Months 1 to 12, and hours of UTC 0 to 23, of the rows; or text such as ``12-2``.
    region : str, optional
        Name of the rows; where a source names regions, the one that is taken.
    columns : mapping, optional
        Columns of CSV files with their units by name, e.g. ``{"wind_speed_m_s": "ws:kn"}``.
    fill : mapping, optional
        Values by column where one is missing, e.g. ``{"cloud_cover": 0.6}``, or text with a unit.
    utc : bool
        Times of CSV files without a zone are UTC.
    place : (float, float), optional
        Latitude and longitude of a source that has none [deg].
    anemometer : float, optional
        Height of the anemometer of NDBC buoys [m]; winds are brought from there to 10 m.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    xarray.Dataset
        Columns of the table over ``row``; ``notes`` among the attributes report omissions and assumptions with counts.

    Raises
    ------
    SeaglintError
        A file that cannot be used, nothing left of the selection, an output that cannot be written.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     source = Path(folder, "ships.csv")
    ...     _ = source.write_text("wind,wave\n12,0.5\n15,1.0\n")
    ...     table = sg.weather.build(source, columns={"wind_speed_m_s": "wind:kn"})
    >>> table.wind_speed_m_s.values.round(2).tolist()
    [6.17, 7.72]
    """
    from seaglint.climate.weather_selection import GeographicBox, Polygon, Selection
    from seaglint.formats.weather.weather_cells import parse_cycle, read_polygon
    from seaglint.formats.weather.weather_file import WeatherReading, check_output, write_weather
    from seaglint.scenario.text.option_texts import parse_fill, parse_map, parse_place
    from seaglint.studies.likelihood.weather_files import build as built_of

    paths = paths_of(sources, "sources")
    if output is not None:
        check_output(Path(output), overwrite=overwrite, inputs=paths)
    area = read_polygon(str(polygon)) if isinstance(polygon, str | Path) else None if polygon is None else Polygon(tuple(polygon))
    selection = Selection(
        None if box is None else GeographicBox(*box),
        area,
        parse_cycle(months, "months", 1, 12) if isinstance(months, str) else None if months is None else tuple(months),
        parse_cycle(hours, "hours", 0, 23) if isinstance(hours, str) else None if hours is None else tuple(hours),
        region,
    )
    mapped = parse_map([f"{name}={column}" for name, column in (columns or {}).items()])
    filled = parse_fill([f"{name}={value}" for name, value in (fill or {}).items()])
    where = None if place is None else parse_place(f"{place[0]},{place[1]}")
    built = built_of(paths, selection, WeatherReading(mapped, utc, anemometer, where), fill=filled)
    if output is not None:
        write_weather(built.table, Path(output), notes=built.notes, overwrite=overwrite)
    return built.dataset()


def info(table: str | Path = "north-atlantic") -> ResultRecord:
    """Describe the contents of a weather table.

    Parameters
    ----------
    table : str or path
        Weather table, or one of the package: ``world``, ``north-atlantic``.

    Returns
    -------
    ResultRecord
        Values that ``seaglint weather info --json`` prints; ``plot()`` draws wind rose, joint density, months and missing values.

    Raises
    ------
    DataError
        A file that cannot be read.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.weather.info()["columns"]["wind_speed_m_s"]["mean"] > 5.0
    True
    """
    from seaglint.studies.likelihood.weather_files import describe

    _, facts = describe(table if isinstance(table, str) else path_of(table, "table"))

    def draw() -> Figure:
        from seaglint.plot.environment_charts import draw_weather

        return draw_weather(facts)

    return ResultRecord(facts.as_dict(), draw=draw, html=lambda: _shown(facts), title=f"weather table {table}")


def _shown(facts: WeatherFacts) -> str:
    """Return the table of a notebook: the columns with mean, limits and share of missing values."""
    from seaglint.base.representation import card, notes
    from seaglint.base.representation import table as html

    rows: list[Any] = [(name, part.mean, part.min, part.max, f"{100 * part.missing_share:.3g} %") for name, part in facts.columns.items()]
    return card(f"{facts.path}: {facts.rows} rows", html(("column", "mean", "min", "max", "missing"), rows) + notes(facts.notes))
