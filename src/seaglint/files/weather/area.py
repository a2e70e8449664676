"""Parsers of areas from text and files: boxes, polygons as text, CSV or GeoJSON."""

from __future__ import annotations

from pathlib import Path

from seaglint.base.errors import DataError, DomainError
from seaglint.climate.select import GeographicBox, Polygon
from seaglint.files.tables.table_text import plain_number
from seaglint.files.text_file import read_json
from seaglint.files.weather.weather_cells import read_cells


def parse_box(text: str) -> GeographicBox:
    """Parse a box from a text ``west,south,east,north`` [deg].

    Raises
    ------
    DataError
        Another number of numbers, or borders that are none.
    """
    try:
        numbers = [plain_number(part) for part in text.split(",")]
        if len(numbers) != 4:
            raise ValueError
    except ValueError:
        raise DataError(f"box='{text}' is not four numbers; write west,south,east,north in degrees, e.g. -60,30,-10,60") from None
    try:
        return GeographicBox(*numbers)
    except DomainError as error:
        raise DataError(f"box='{text}': {error}") from None


def read_polygon(text: str) -> Polygon:
    """Read a polygon from a text ``lon,lat lon,lat lon,lat``, or from a CSV or GeoJSON file.

    Raises
    ------
    DataError
        A text or file of another form.
    """
    path = Path(text)
    if path.suffix.lower() in (".json", ".geojson"):
        corners = _geojson(path)
    elif path.suffix.lower() == ".csv":
        cells = read_cells(path)
        pairs = [(lon, lat) for lon, lat in (("longitude_deg", "latitude_deg"), ("lon", "lat")) if {lon, lat} <= set(cells.header)]
        if not pairs:
            raise DataError(
                f"{path}: columns are {', '.join(cells.header)}; a polygon has longitude_deg and latitude_deg, a corner each row"
            )
        corners = list(zip(*(cells.numbers(name).tolist() for name in pairs[0]), strict=True))
    else:
        try:
            corners = [(plain_number(lon), plain_number(lat)) for lon, lat in (pair.split(",") for pair in text.split())]
        except ValueError:
            raise DataError(f"polygon='{text}' is neither 'lon,lat lon,lat lon,lat' in degrees nor a .csv or .geojson file") from None
    if len(corners) > 3 and corners[0] == corners[-1]:
        corners = corners[:-1]
    try:
        return Polygon(tuple(corners))
    except DomainError as error:
        raise DataError(f"polygon='{text}': {error}") from None


def _geojson(path: Path) -> list[tuple[float, float]]:
    geometry = read_json(path, "give a GeoJSON file of one polygon")
    try:
        if geometry["type"] == "FeatureCollection":
            (geometry,) = geometry["features"]
        if geometry["type"] == "Feature":
            geometry = geometry["geometry"]
        if geometry["type"] != "Polygon":
            raise ValueError
        (ring,) = geometry["coordinates"]
        return [(float(corner[0]), float(corner[1])) for corner in ring]
    except (KeyError, TypeError, ValueError, IndexError):
        raise DataError(f"{path}: is not one GeoJSON polygon without holes; give one, or corners as 'lon,lat lon,lat lon,lat'") from None


def parse_cycle(text: str, name: str, low: int, high: int) -> tuple[int, ...]:
    """Parse whole numbers from a text such as ``6,7,8``, ``6-8`` or, around the end of the year or day, ``12-2``.

    Raises
    ------
    DataError
        A text of another form, or numbers outside ``low`` to ``high``.

    Examples
    --------
    >>> parse_cycle("12-2,6", "months", 1, 12)
    (12, 1, 2, 6)
    """
    out: list[int] = []
    try:
        for part in text.split(","):
            first, dash, last = part.partition("-")
            a = int(first)
            b = int(last) if dash else a
            if not (low <= a <= high and low <= b <= high):
                raise ValueError
            count = (b - a) % (high - low + 1)
            out += [low + (a - low + step) % (high - low + 1) for step in range(count + 1)]
    except ValueError:
        raise DataError(
            f"{name}='{text}' is not whole numbers {low} to {high}; write e.g. {low + 5},{low + 6} or {low + 5}-{low + 7}"
        ) from None
    return tuple(dict.fromkeys(out))
