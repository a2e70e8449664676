"""Make src/seaglint/climate/data/north-atlantic.csv: wind and cloud over the open North Atlantic by month, a table to begin with.

    python tools/build_north_atlantic.py

What is published and what is assumed, number by number:

wind, Weibull law
    Published: Pavia and O'Brien, J. Climate Appl. Meteor. 25, 1324-1332 (1986); Monahan, J. Climate 19, 497-520 (2006). A good, not a
    perfect law of winds over the sea.
WIND_MEAN_M_S
    Estimates, rounded to 0.5 m/s, of the size that atlases map for 40-60 N, 10-50 W (Young, Int. J. Climatol. 19, 931-950, 1999). NOT read
    from those maps: taken for within 1 m/s.
WIND_SHAPE
    Estimate inside the range of shapes of midlatitude oceans, about 1.8 to 2.4 (Pavia and O'Brien 1986). NOT read from their maps.
cloud, beta law
    Published: Falls, J. Geophys. Res. 79, 1261-1264 (1974), for cloud cover at any place; most of its mass is at clear and overcast.
CLOUD_MEAN
    Estimates, rounded to 0.05, of the size that ship reports show for midlatitude oceans (Warren et al., NCAR/TN-317+STR, 1988; Eastman,
    Warren and Hahn, J. Climate 24, 5914-5934, 2011). NOT read from those atlases: taken for within 0.05.
CLOUD_SUM
    Assumption: a + b of the beta law; with 1.2 a third to two fifths of skies are overcast, 3-4 % clear.
wind and cloud together
    Assumption: independent within a month. They are not; only a table of observations has their joint law.

Rows are the means of classes of the Weibull law, finest among light winds, by the nine oktas. Months weigh as their days.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.special import betainc, gammainc

from seaglint.climate.weather_columns import model_atmosphere
from seaglint.climate.weather_table import WeatherTable
from seaglint.formats.weather.weather_file import shipped, write_weather

WIND_MEAN_M_S = (11.5, 11.0, 10.5, 9.0, 8.0, 7.5, 7.0, 7.0, 8.5, 9.5, 10.5, 11.0)
"""Mean wind at 10 m, January to December; an estimate, see above."""

WIND_SHAPE = 2.1
"""Shape of the Weibull law in all months; an estimate, see above."""

CLOUD_MEAN = (0.75, 0.75, 0.75, 0.70, 0.70, 0.70, 0.70, 0.70, 0.70, 0.70, 0.75, 0.75)
"""Mean cloud cover, January to December; an estimate, see above."""

CLOUD_SUM = 1.2
"""Sum of the two parameters of the beta law; an assumption, see above."""

LATITUDE_DEG = 45.0
"""Latitude for which the model atmosphere is named; the table has no places."""

DAYS = (31, 28.25, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)

CLASSES = (0.01, 0.02, 0.03, 0.04, 0.10, 0.15, 0.20, 0.20, 0.15, 0.07, 0.03)
"""Probabilities of the classes of wind speed, from calm to strong."""

NOTES = (
    "North Atlantic, open sea of about 40-60 N, 10-50 W, by month: a table to begin with, not a measurement",
    "made by tools/build_north_atlantic.py, which has source and standing of each number",
    "wind at 10 m: Weibull law (Pavia and O'Brien 1986; Monahan 2006) of shape 2.1; monthly means are estimates within 1 m/s, not read "
    "from an atlas",
    "cloud cover: beta law (Falls 1974); monthly means are estimates within 0.05, not read from an atlas; overcast share assumed",
    "wind and cloud are taken as independent within a month, which they are not; no wind direction, place, temperature or hour",
    "use a table made with 'seaglint weather build' of ERA5 or ICOADS for any number that matters",
)


def wind_classes(mean: float, shape: float = WIND_SHAPE) -> np.ndarray:
    """Mean wind of each class of :data:`CLASSES` of the Weibull law [m/s]."""
    edges = np.r_[0.0, np.cumsum(CLASSES)[:-1]]
    # Up to a wind v the law has the share 1 - exp(-x), x = (v / scale)^shape, and of its mean the share P(1 + 1/shape, x).
    x = np.r_[-np.log1p(-edges), np.inf]
    return mean * np.diff(gammainc(1.0 + 1.0 / shape, x)) / np.array(CLASSES)


def okta_shares(mean: float, total: float = CLOUD_SUM) -> np.ndarray:
    """Share of each of the nine oktas of the beta law; eighths are rounded, so that clear and overcast take half a step."""
    edges = np.r_[0.0, (np.arange(8) + 0.5) / 8.0, 1.0]
    return np.diff(betainc(mean * total, (1.0 - mean) * total, edges))


def build() -> WeatherTable:
    """The table."""
    wind, cloud, weight, month = [], [], [], []
    for m in range(12):
        speeds, shares = wind_classes(WIND_MEAN_M_S[m]), okta_shares(CLOUD_MEAN[m])
        joint = np.outer(CLASSES, shares) * DAYS[m] / sum(DAYS)
        wind.append(np.repeat(speeds, shares.size))
        cloud.append(np.tile(np.arange(9) / 8.0, speeds.size))
        weight.append(joint.ravel())
        month.append(np.full(joint.size, m + 1.0))
    moon = np.concatenate(month)
    columns = {
        "weight": np.concatenate(weight),
        "wind_speed_m_s": np.concatenate(wind).round(3),
        "cloud_cover": np.concatenate(cloud),
        "month": moon,
    }
    columns["weight"] = (columns["weight"] / columns["weight"].sum()).round(9)
    texts = {"region": np.full(moon.size, "north-atlantic"), "atmosphere": model_atmosphere(LATITUDE_DEG, moon)}
    return WeatherTable(columns, texts)


def main(output: Path) -> None:
    """Write the table."""
    table = build()
    write_weather(table, output, notes=NOTES, overwrite=True)
    print(f"{output}: {len(table)} rows")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else shipped("north-atlantic"))
