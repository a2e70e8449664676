"""Weather tables from files: read, select, derive, join and describe."""

from __future__ import annotations

import filecmp
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.climate import table_summary
from seaglint.climate.weather_columns import model_atmosphere
from seaglint.climate.weather_selection import Selection, covered
from seaglint.climate.weather_table import NEEDED, RANGES, TEXTS, TextArray, WeatherTable, stand_ins_told
from seaglint.formats.weather import era5_weather as era5
from seaglint.formats.weather.weather_cells import WeatherSource
from seaglint.formats.weather.weather_file import WeatherFile, WeatherReading, is_grid, read_source, read_weather
from seaglint.version import __version__

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Built:
    """Weather table built from files."""

    table: WeatherTable  #: Rows of all files.
    notes: tuple[str, ...] = field(default_factory=tuple)  #: Rows read, left out, assumed and filled, one sentence each, with counts.

    def dataset(self) -> xr.Dataset:
        """Return the columns as a dataset over ``row``."""
        import xarray as xr

        texts = {name: ("row", self.table.text(name)) for name in TEXTS if name in self.table.texts}
        return xr.Dataset(
            {**{name: ("row", values) for name, values in self.table.columns.items()}, **texts},
            attrs={"title": "Weather table", "notes": "\n".join(self.notes)},
        )


def build(
    paths: Sequence[Path],
    selection: Selection | None = None,
    reading: WeatherReading | None = None,
    *,
    fill: Mapping[str, float] | None = None,
) -> Built:
    """Build one table from files of any kind.

    Parameters
    ----------
    paths : sequence of Path
        Files; grids without winds (waves, sea temperature) are joined to those with winds.
    selection : Selection, optional
        Requested places, times and region. A region selects rows where a file has regions, and names the rows elsewhere.
    reading : WeatherReading, optional
        Properties that the files do not state.
    fill : mapping of str to float, optional
        Values for missing entries of a column; counted.

    Raises
    ------
    DataError
        A file that cannot be used, or a selection without rows.
    BackendError
        A package that is not installed.
    """
    selection, reading = selection or Selection(), reading or WeatherReading()
    paths, copies = _once(paths)
    notes = [f"made by seaglint {__version__} of {', '.join(path.name for path in paths)}", *copies]
    if words := selection.words:
        notes.append("selected: " + "; ".join(words))
    sources = [_of_region(source, selection.region) for source in _sources(paths, selection, reading)]
    for source in sources:
        notes += _record_counts(source)
    with_rows = [source for source in sources if source.rows]
    if not with_rows:
        raise DataError(_nothing(sources, selection))
    columns, texts = _together(with_rows)
    if len(with_rows) > 1:
        notes.append("each row counts alike: the weights of each file are scaled to the mean 1")
    notes += _filled(columns, fill or {})
    if "atmosphere" not in texts:
        known = model_atmosphere(columns.get("latitude_deg", np.nan), columns.get("month", np.full(columns["weight"].size, np.nan)))
        if np.any(known != ""):
            texts["atmosphere"] = known
            notes.append("model atmospheres follow from latitude (tropical to 30 deg, subarctic from 52.5 deg) and month")
    try:
        table = WeatherTable(columns, texts)
    except DomainError as error:
        raise DataError(str(error)) from None
    return Built(table, (*notes, *_lacking(table, selection)))


def _once(paths: Sequence[Path]) -> tuple[list[Path], list[str]]:
    """Return the files without copies of earlier ones, whose rows would count twice, and notes on those."""
    kept: list[Path] = []
    notes = []
    for path in paths:
        same = next((other for other in kept if _same_content(path, other)), None)
        if same is None:
            kept.append(path)
        else:
            notes.append(f"{path.name}: is the same as {same.name} given before, and is used once")
    return kept, notes


def _same_content(path: Path, other: Path) -> bool:
    try:
        return path.samefile(other) or filecmp.cmp(path, other, shallow=False)
    except OSError:  # the reader reports a file that cannot be read
        return False


def _sources(paths: Sequence[Path], selection: Selection, reading: WeatherReading) -> list[WeatherSource]:
    grids = [path for path in paths if is_grid(path)]
    windless = tuple(path for path in grids if not era5.has_wind(path))
    if windless and len(windless) == len(grids):
        raise DataError(f"{windless[0]}: has no wind (u10, v10); give the file with the winds of the same times beside it")
    out = [read_source(path, selection, reading, windless if path in grids else ()) for path in paths if path not in windless]
    notes = " ".join(note for source in out for note in source.notes)
    for path in windless:
        if f"from {path.name}," not in notes:
            raise DataError(
                f"{path}: nothing of it is used: it has no times in common with the winds, or nothing that they lack; leave it out"
            )
    return out


def _of_region(source: WeatherSource, region: str | None) -> WeatherSource:
    """Return the rows of a region; all rows, named after it, where the file has no regions."""
    if region is None or not source.rows:
        return source
    names = source.texts.get("region")
    if names is None or not np.any(names != ""):
        return replace(source, texts={**source.texts, "region": np.full(source.rows, region)})
    good = names == region
    if not good.any():
        raise DataError(f"{source.path}: region '{region}' has no rows; the file has {', '.join(sorted(set(names.tolist()) - {''}))}")
    return replace(
        source,
        columns={name: values[good] for name, values in source.columns.items()},
        texts={name: values[good] for name, values in source.texts.items()},
        left_out={**source.left_out, **({"of other regions": int(np.sum(~good))} if not good.all() else {})},
    )


def _record_counts(source: WeatherSource) -> list[str]:
    """Return how many records of one file were used and lost."""
    line = f"{source.path.name}: {source.kind}, {source.read} records, {source.rows} rows"
    if source.left_out:
        line += "; left out: " + ", ".join(f"{count} {reason}" for reason, count in source.left_out.items())
    if source.set_missing:
        line += "; set missing: " + ", ".join(f"{count} {reason}" for reason, count in source.set_missing.items())
    return [line, *(f"{source.path.name}: {note}" for note in source.notes)]


def _nothing(sources: Sequence[WeatherSource], selection: Selection) -> str:
    selected = " and ".join(selection.words) or "the files"
    lost = "; ".join(_record_counts(source)[0] for source in sources)
    place = "; give a source without places its own with --place LAT,LON" if any("without a place" in s.left_out for s in sources) else ""
    return f"no rows in {selected} ({lost}){place}; choose inside what the files cover"


def _together(sources: Sequence[WeatherSource]) -> tuple[dict[str, FloatArray], dict[str, TextArray]]:
    """Return the columns of all files one after the other; the mean weight of each file is 1, so that each row counts alike."""
    names = [name for name in RANGES if name != "weight" and any(name in source.columns for source in sources)]
    columns = {n: np.concatenate([s.columns.get(n, np.full(s.rows, np.nan)) for s in sources]) for n in {*names, *NEEDED}}
    weights = []
    for source in sources:
        weight = np.asarray(source.columns.get("weight", np.ones(source.rows)))
        if not weight.sum() > 0.0:
            raise DataError(f"{source.path}: all rows selected have the weight 0; select others, or correct the column weight")
        weights.append(weight / weight.mean() if len(sources) > 1 else weight)
    ordered = {"weight": np.concatenate(weights)} | {n: columns[n] for n in RANGES if n in columns}
    present = [n for n in TEXTS if any(n in source.texts for source in sources)]
    return ordered, {n: np.concatenate([s.texts.get(n, np.full(s.rows, "")) for s in sources]) for n in present}


def _filled(columns: dict[str, FloatArray], fill: Mapping[str, float]) -> list[str]:
    notes = []
    for name, value in fill.items():
        if name not in RANGES or name == "weight":
            raise DataError(
                f"fill {name} = {value:g}: '{name}' cannot be filled; allowed are {', '.join(n for n in RANGES if n != 'weight')}"
            )
        low, high = RANGES[name]
        if not low <= value <= high:
            raise DataError(f"fill {name} = {value:g} is outside the range allowed: {low:g} to {high:g}")
        values = columns.get(name, np.full(columns["weight"].size, np.nan))
        lacks = np.isnan(values)
        columns[name] = np.where(lacks, value, values)
        notes.append(f"{name}: {int(lacks.sum())} missing values filled with {value:g}, as asked")
    return notes


def _lacking(table: WeatherTable, selection: Selection) -> list[str]:
    """Return the gaps of a table: rows without wind or cloud, months without rows."""
    counts = {name: int(np.sum(np.isnan(table[name]))) for name in NEEDED}
    notes = [f"{n} of {len(table)} rows have no {name}: kept here, left out by what needs it" for name, n in counts.items() if n]
    present = table.months
    if not present:
        notes.append("no months: every row serves all the year")
        return notes
    if any(m not in present for m in selection.months or range(1, 13)):
        notes.append(stand_ins_told(table.stand_ins))
    return notes


def describe(path: str | Path) -> tuple[WeatherFile, table_summary.WeatherFacts]:
    """Read a table and return it with its facts.

    Raises
    ------
    DataError
        A file that cannot be read.
    """
    file = read_weather(path)
    table = file.table
    rose, joint = table_summary.wind_rose(table), table_summary.joint_density(table)
    speeds = [_plain(edge) for edge in table_summary.SPEED_EDGES]
    facts = table_summary.WeatherFacts(
        path=str(path),
        rows=len(table),
        effective_rows=table.effective_rows,
        weight_sum=table.weight_sum,
        covers=covered(table.columns),
        months=list(table.months),
        missing_months=table.stand_ins,
        regions=sorted({str(name) for name in table.text("region")} - {""}),
        atmospheres=_shares(table, "atmosphere"),
        columns={name: _numbers(table, name) for name in table.columns if name != "weight"},
        missing_share=table_summary.missing_shares(table),
        wind_cloud_correlation=_plain(table_summary.correlation(table)),
        by_month=table_summary.month_means(table),
        wind_rose=table_summary.WindRose([360.0 * k / table_summary.SECTORS for k in range(table_summary.SECTORS)], speeds, rose.tolist()),
        wind_cloud=table_summary.WindCloud(speeds, [float(edge) for edge in table_summary.CLOUD_EDGES], joint.tolist()),
        notes=[*file.notes, *file.remarks],
    )
    return file, facts


def _plain(value: float) -> float | None:
    """Return a number for JSON; None for NaN and infinity."""
    return float(value) if np.isfinite(value) else None


def _numbers(table: WeatherTable, name: str) -> table_summary.ColumnFacts:
    values = table[name]
    known = values[~np.isnan(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (float("nan"), float("nan"))
    # The mean of directions, months and hours says nothing: they go around.
    mean = float("nan") if name in ("wind_from_deg", "month", "hour_utc", "longitude_deg") else table.mean(name)
    return table_summary.ColumnFacts(_plain(mean), _plain(low), _plain(high), table.missing_share(name))


def _shares(table: WeatherTable, name: str) -> dict[str, float]:
    names = table.text(name)
    return {str(n): float(table.probability[names == n].sum()) for n in np.unique(names) if n}
