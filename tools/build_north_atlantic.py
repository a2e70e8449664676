"""Make src/seaglint/climate/data/north-atlantic.csv: weather over the open North Atlantic by month, a region of the climatology.

    python tools/build_north_atlantic.py

Monthly means are those of the climatology ``world.csv`` (Esbensen and Kushnir 1981) over the cells of 40-60 N, 10-50 W, weighted by their
areas. The laws of wind and cloud about them, and what is estimated in them, are those of ``seaglint.climate.weather_laws``.

Rows are the means of classes of the Weibull law, finest among light winds, by the nine oktas. Months weigh as their days. The table has no
places: it serves wherever another one has no data.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from seaglint.climate.weather_laws import class_means, joint_shares, wind_shape
from seaglint.climate.weather_table import WeatherTable
from seaglint.climate.world_weather import DAYS, MeanConditions, model_atmospheres, world_weather
from seaglint.formats.weather.weather_file import NORTH_ATLANTIC, shipped, write_weather

SOUTH, NORTH, WEST, EAST = 40.0, 60.0, -50.0, -10.0  #: Borders of the region [deg].

NOTES = (
    "North Atlantic, open sea of 40-60 N, 10-50 W, by month: the region's means of the climatology 'world'",
    "made by tools/build_north_atlantic.py from ships' observations (Esbensen and Kushnir 1981)",
    "wind at 10 m: Weibull law (Pavia and O'Brien 1986; Monahan 2006) of shape 2.1, an estimate",
    "cloud cover: beta law in oktas (Falls 1974); share of overcast skies, and correlation of wind and cloud (0.15), are estimates",
    "no wind direction, place or hour",
)


def means() -> MeanConditions:
    """Monthly means over the region [(12,) each]."""
    north, east, area = world_weather().cells()
    inside = (north >= SOUTH) & (north <= NORTH) & (east >= WEST) & (east <= EAST)
    of_cells = world_weather().of_month(np.arange(1, 13)[:, None], north[inside], east[inside])
    return MeanConditions(*(np.average(values, axis=1, weights=area[inside]) for values in of_cells))


def build() -> WeatherTable:
    """Return the table."""
    of_month = means()
    winds = class_means(of_month.wind_speed_m_s, wind_shape(0.5 * (SOUTH + NORTH), of_month.wind_speed_m_s))
    shares = joint_shares(of_month.cloud_cover)
    weight = shares * (np.array(DAYS) / sum(DAYS))[:, None, None]

    def spread(values: np.ndarray) -> np.ndarray:
        return np.broadcast_to(values[:, None, None], weight.shape).ravel()

    columns = {
        "weight": (weight / weight.sum()).ravel().round(9),
        "wind_speed_m_s": np.broadcast_to(winds[..., None], weight.shape).ravel().round(3),
        "cloud_cover": np.broadcast_to(np.arange(9) / 8.0, weight.shape).ravel(),
        "sea_temperature_k": spread(of_month.sea_temperature_k).round(2),
        "air_temperature_k": spread(of_month.air_temperature_k).round(2),
        "relative_humidity": spread(of_month.relative_humidity).round(3),
        "month": spread(np.arange(1.0, 13.0)),
    }
    names = np.array([name for name, _ in model_atmospheres()])[of_month.model]
    return WeatherTable(columns, {"region": np.full(weight.size, NORTH_ATLANTIC), "atmosphere": spread(names)})


def main(output: Path) -> None:
    """Write the table."""
    table = build()
    write_weather(table, output, notes=NOTES, overwrite=True)
    print(f"{output}: {len(table)} rows")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else shipped(NORTH_ATLANTIC))
