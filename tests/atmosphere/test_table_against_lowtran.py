"""The table against LOWTRAN7 itself: cases run by others, in double precision, at random heights, angles and winds.

Columns and definitions: LOWTRAN7 revision 4.2, MODEL 2 and 6, IHAZE=3, ICSTL=3, VIS=0, WSS=WHH=wind, DV=5 cm-1; path ITYPE=2 from
the sensor to the sea by angle, TBOUND=0.001 K; Sun IEMSCT=3, day 93, normal to the beam at sea level; sky ITYPE=3 from the sea.
tau is the flat mean over wavenumber between the band's edges, the rest are integrals [W m-2 sr-1 or W m-2].
"""

import csv

import numpy as np
import pytest

from seaglint.atmosphere.table import TableAtmosphere, models
from seaglint.optics.band import Band

QUANTITIES = ("tau_mean", "path_radiance_W_m2_sr", "sun_normal_irradiance_W_m2", "sun_times_tau_W_m2", "sky_radiance_W_m2_sr")

# Rows of lowtran7_slant_paths.csv, 3-5 um:
# model, wind [m/s], height [m], depression, solar zenith, sky zenith [deg], then QUANTITIES.
ROWS = [
    ("midlatitude-summer", 2.56, 2.3, 0.237, 36.27, 61.54, 0.604952, 0.637522, 8.02824, 6.52883, 0.987636),
    ("midlatitude-summer", 18.93, 5.3, 0.159, 16.87, 19.74, 0.336406, 1.04252, 7.1237, 3.62954, 0.90197),
    ("midlatitude-summer", 4.34, 29.3, 0.455, 86.09, 84.22, 0.311636, 1.11851, 0.890486, 0.549768, 1.28683),
    ("midlatitude-summer", 5.74, 110.9, 0.421, 39.5, 52.23, 0.0764735, 1.42171, 7.57774, 1.09343, 0.944387),
    ("midlatitude-summer", 17.31, 441.8, 7.148, 84.28, 19.51, 0.249644, 1.13471, 0.381654, 0.182673, 0.89221),
    ("midlatitude-summer", 3.61, 1272.5, 6.766, 78.87, 69.79, 0.197105, 1.11016, 3.28402, 1.38523, 1.06561),
    ("us-standard-1976", 9.54, 2.9, 0.397, 86.33, 81.01, 0.708839, 0.389022, 1.26074, 1.15604, 0.861457),
    ("us-standard-1976", 0.37, 19.0, 2.819, 65.95, 85.67, 0.723864, 0.372014, 7.52602, 6.70562, 0.932354),
    ("us-standard-1976", 10.83, 23.2, 0.431, 76.29, 68.58, 0.420662, 0.743356, 4.76669, 3.1393, 0.713157),
    ("us-standard-1976", 10.81, 202.5, 0.965, 30.76, 63.64, 0.180805, 1.00562, 9.69516, 2.71618, 0.67641),
    ("us-standard-1976", 6.91, 823.3, 1.074, 39.01, 54.31, 0.0388028, 1.06375, 9.54821, 0.636712, 0.616665),
    ("us-standard-1976", 7.9, 2824.0, 4.108, 53.28, 34.91, 0.100702, 0.660819, 8.51064, 1.49278, 0.559895),
]

# Between 2.6 and 3 km LOWTRAN7 integrates the aerosol of its layer 2-3 km exponentially, at 3 km (where it ends) linearly: the optical
# depth of a 4 degree path jumps by 0.05 there. The table is smooth through it and up to 1.5 % off below the level.
JUMP = (2600.0, 3000.0)
JUMP_ERROR = 1.5e-2

ROW_ERROR = 5e-3  # between the median (0.2 %) and the 95th percentile (1 %) that the table is built for
SMALL = 5e-4  # of the largest value of a column: below it only the absolute error counts


def quantities(model, wind, height, depression, solar_zenith, sky_zenith, edges):
    air = TableAtmosphere.load(model, wind, edges)
    weights = Band.rectangular(*edges).weights(air.wavenumber_cm)
    tau, path = air.path(height, air.range_of_depression(height, np.radians(depression)))
    sun = air.solar_irradiance(np.radians(solar_zenith))
    sky = air.sky_radiance(np.radians(sky_zenith))
    return np.array([weights @ tau / weights.sum(), weights @ path, weights @ sun, weights @ (sun * tau), weights @ sky])


@pytest.mark.parametrize("row", ROWS, ids=lambda r: f"{r[0]}-{r[2]:g}m-{r[3]:g}deg")
def test_single_cases(row):
    error = JUMP_ERROR if JUMP[0] < row[2] < JUMP[1] else ROW_ERROR
    np.testing.assert_allclose(quantities(*row[:6], (3.0, 5.0)), row[6:], rtol=error, atol=SMALL)


@pytest.mark.validation
@pytest.mark.parametrize("edges", [(3.0, 5.0), (3.5, 5.0), (8.0, 12.0)])
def test_all_reference_cases(reference_dir, edges):
    """Median error at most 0.2 %, 95th percentile 1 % of the value (or 5e-4 of the column's maximum), each quantity."""
    with (reference_dir / "lowtran7_slant_paths.csv").open() as file:
        cases = [row for row in csv.DictReader(file) if row["atmosphere"] in models()]
    assert len(cases) >= 50
    keys = ("wind_speed_m_s", "sensor_height_m", "depression_deg", "solar_zenith_deg", "sky_zenith_deg")
    ours = np.array([quantities(row["atmosphere"], *(float(row[k]) for k in keys), edges) for row in cases])
    theirs = np.array([[float(row[f"{q}[{edges[0]:.1f}-{edges[1]:.1f}]"]) for q in QUANTITIES] for row in cases])
    absolute = np.abs(ours - theirs)
    error = np.where(absolute < SMALL * theirs.max(axis=0), 0.0, absolute / theirs)
    assert np.all(np.median(absolute / theirs, axis=0) < 2e-3)
    assert np.all(np.percentile(error, 95.0, axis=0) < 1e-2)


@pytest.mark.validation
def test_sky_of_the_older_single_precision_set_without_aerosol_is_darker(reference_dir):
    """Navy maritime aerosol at 7 m/s adds emission: our sky lies above the aerosol-free one and below a blackbody at 294.2 K."""
    with (reference_dir / "lowtran7_spectra_3to5um.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    air = TableAtmosphere.load("midlatitude-summer", 7.0)
    wavenumber = np.array([float(r["wavenumber_cm-1"]) for r in rows])
    theirs = np.array([float(r["sky_L|midlat_summer|none|60"]) for r in rows]) * 1e4 * 1e4 / wavenumber**2
    ours = np.interp(wavenumber, air.wavenumber_cm, air.sky_radiance(np.radians(60.0)))
    assert np.all(ours > 0.99 * theirs)
