"""The table against LOWTRAN7 itself: cases run by others, in double precision, at random heights, angles and winds.

Columns and definitions: LOWTRAN7 revision 4.2, MODEL 1 to 6, IHAZE=3, ICSTL=3, VIS=0, WSS=WHH=wind, DV=5 cm-1; path ITYPE=2 from
the sensor to the sea by angle, TBOUND=0.001 K; Sun IEMSCT=3, day 93, normal to the beam at sea level; sky ITYPE=3 from the sea.
tau is the flat mean over wavenumber between the band's edges, the rest are integrals [W m-2 sr-1 or W m-2].
"""

import csv

import numpy as np
import pytest

from seaglint.air.lowtran_table import BatchAtmosphere, models
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.conventions import horizon_depression
from seaglint.optics.band import Band
from seaglint.studies.build.profile_air import model_air

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
    ("tropical", 9.99, 335.7, 0.649, 13.02, 83.07, 0.00474225, 1.78049, 7.24168, 0.0689046, 1.56873),
    ("tropical", 1.41, 6, 28.272, 54.73, 33.02, 0.886389, 0.241965, 6.09781, 5.96777, 1.08396),
    ("tropical", 13.26, 20.9, 0.273, 69.35, 60, 0.187232, 1.57007, 3.36964, 1.26128, 1.28452),
    ("midlatitude-winter", 13.95, 36, 0.249, 14.06, 89.18, 0.158312, 0.528608, 10.3337, 2.23462, 0.57594),
    ("midlatitude-winter", 14.37, 1893.8, 9.436, 23.52, 70.68, 0.185919, 0.427408, 10.0344, 2.5428, 0.416496),
    ("midlatitude-winter", 7.25, 151, 0.475, 4.71, 19.64, 0.104449, 0.564081, 11.2616, 1.69591, 0.283449),
    ("subarctic-summer", 10.25, 2099.5, 3.431, 86.32, 18.3, 0.0343228, 0.786975, 0.493009, 0.0435619, 0.587348),
    ("subarctic-summer", 17.35, 6, 1.212, 24.39, 7.44, 0.703117, 0.369151, 7.92595, 6.75081, 0.606273),
    ("subarctic-summer", 16.78, 106.1, 0.448, 65.05, 17.51, 0.0392197, 1.10397, 4.72636, 0.350674, 0.611325),
    ("subarctic-winter", 4.98, 6.5, 0.761, 43.81, 25.58, 0.781363, 0.0840216, 11.8077, 10.5828, 0.148071),
    ("subarctic-winter", 5.15, 8389.4, 3.034, 28.59, 49.15, 0.028704, 0.134021, 12.4674, 0.515716, 0.163713),
    ("subarctic-winter", 15.66, 90.7, 2.498, 5.51, 49.68, 0.535475, 0.154201, 11.3187, 7.18752, 0.18571),
]

ROW_ERROR = 2e-3  # the median it is built for (0.2 %); single cases may reach 1 %, these do not
SMALL = 5e-4  # of the largest value of a column: below it only the absolute error counts


def of_tables(model, wind, height, depression, solar_zenith, sky_zenith, edges):
    """Transmittance, path, sunlight and sky of one case by the tables that serve many."""
    air = BatchAtmosphere.load(model, edges)
    tau, path = air.path([wind], [height], np.radians([depression]))
    sun, sky = air.solar_irradiance([wind], np.radians([solar_zenith])), air.sky_radiance([wind], np.radians([sky_zenith]))
    return air.wavenumber_cm, tau[0], path[0], sun[0], sky[0]


def of_sums(model, wind, height, depression, solar_zenith, sky_zenith, edges):
    """The same by sums along the ray, in LOWTRAN7's layers."""
    sums = AirSums(model_profile(model), HazeWeather(wind=wind, wind_24h=wind), wavenumber_grid(*edges), spectroscopy="lowtran7")
    ray = sums.in_layers(height, 0.5 * np.pi + np.radians(depression))
    sun = sums.laws.source * sums.in_layers(0.0, np.radians(solar_zenith)).transmittance[-1]
    return sums.laws.wavenumber_cm, ray.transmittance[-1], ray.emitted, sun, sums.in_layers(0.0, np.radians(sky_zenith)).emitted


def quantities(*case, by):
    nu, tau, path, sun, sky = by(*case)
    weights = Band.rectangular(*case[-1]).weights(nu)
    return np.array([weights @ tau / weights.sum(), weights @ path, weights @ sun, weights @ (sun * tau), weights @ sky])


both_routes = pytest.mark.parametrize("by", [of_tables, of_sums])


@both_routes
@pytest.mark.parametrize("row", ROWS, ids=lambda r: f"{r[0]}-{r[2]:g}m-{r[3]:g}deg")
def test_single_cases(row, by):
    np.testing.assert_allclose(quantities(*row[:6], (3.0, 5.0), by=by), row[6:], rtol=ROW_ERROR, atol=SMALL)


# Winds beside the one at which LOWTRAN7's visibility falls to 23 km and its aerosol profile is bent:
# model, wind [m/s], height [m], depression [deg], mean transmittance in 8-12 um.
HAZE_ROWS = [
    ("tropical", 13.1, 2500, 12, 0.103591),
    ("midlatitude-summer", 13, 1800, 5, 0.0562269),
    ("midlatitude-winter", 12.8, 1500, 2.5, 0.198471),
    ("subarctic-summer", 13.2, 1700, 3, 0.0521409),
    ("subarctic-winter", 12.2, 1500, 2, 0.244075),
    ("subarctic-winter", 12.5, 1500, 2, 0.2359),
]

HAZE_ERROR = 5e-4  # a spline across the corner misses these by 1e-3 to 1.5e-2


@both_routes
@pytest.mark.parametrize("row", HAZE_ROWS, ids=lambda r: f"{r[0]}-{r[1]:g}")
def test_the_corner_of_the_haze_between_two_winds(row, by):
    model, wind, height, depression, expected = row
    assert quantities(model, wind, height, depression, 45.0, 45.0, (8.0, 12.0), by=by)[0] == pytest.approx(expected, rel=HAZE_ERROR)


# Sky from a height: model, wind [m/s], height [m], depression of the sea horizon seen as 1 (0 is that horizon, 1 the horizontal),
# elevation above the horizontal [deg], 3-5 um, 8-12 um [W m-2 sr-1]. Cards as above, ITYPE=3.
SKY_ROWS = [
    ("tropical", 1.8522, 2786.67, 0.73540, -0.41535, 1.05017, 29.7625),
    ("tropical", 13.5166, 785.20, 0.53717, -0.38395, 1.5903, 35.8213),
    ("midlatitude-summer", 12.4122, 1025.67, 0.29862, -0.66047, 1.29581, 32.8935),
    ("midlatitude-summer", 4.3435, 3542.73, 2.16612, 2.06188, 0.545805, 11.8261),
    ("midlatitude-winter", 1.3280, 3602.35, 0.28726, -1.24920, 0.373665, 18.583),
    ("midlatitude-winter", 18.5246, 416.40, 1.11698, 0.06836, 0.561572, 22.373),
    ("subarctic-summer", 11.4053, 859.40, 0.67034, -0.28369, 0.965223, 28.5918),
    ("subarctic-summer", 12.7188, 2591.98, 1.11338, 0.17049, 0.602684, 21.5646),
    ("subarctic-winter", 12.9055, 384.85, 0.57274, -0.23120, 0.32027, 17.3184),
    ("subarctic-winter", 8.7949, 1353.61, 0.22346, -0.80121, 0.331504, 17.4979),
    ("us-standard-1976", 8.6616, 340.51, 0.27527, -0.39236, 1.1301, 30.6968),
    ("us-standard-1976", 7.8849, 903.27, 2.35550, 1.19831, 0.862072, 24.0156),
]

SKY_ERROR = 1.5e-2  # LOWTRAN7's layers, met almost along, jump where a ray's lowest point crosses a level


@pytest.mark.parametrize("row", SKY_ROWS, ids=lambda r: f"{r[0]}-{r[2]:g}m-{r[4]:.2f}deg")
@pytest.mark.parametrize(("edges", "column"), [((3.0, 5.0), 5), ((8.0, 12.0), 6)], ids=["3-5um", "8-12um"])
def test_sky_near_the_horizon_from_a_height(row, edges, column):
    air = model_air(row[0], row[1], edges, "lowtran", "lowtran7")
    # Below the horizontal both count in parts of their own dip: refraction makes LOWTRAN7's a little another.
    below = horizon_depression(row[2]) * (1.0 - row[3]) if row[4] < 0.0 else -np.radians(row[4])
    sky = air.sky_radiance(0.5 * np.pi + below, 0.0, row[2]) @ Band.rectangular(*edges).weights(air.wavenumber_cm)
    assert sky == pytest.approx(row[column], rel=SKY_ERROR)


@both_routes
@pytest.mark.validation
@pytest.mark.parametrize("edges", [(3.0, 5.0), (3.5, 5.0), (8.0, 12.0)])
def test_all_reference_cases(reference_dir, edges, by):
    """Median error at most 0.2 %, 95th percentile 1 % of the value (or 5e-4 of the column's maximum), each quantity."""
    with (reference_dir / "lowtran7_slant_paths.csv").open() as file:
        cases = [row for row in csv.DictReader(file) if row["atmosphere"] in models()]
    assert len(cases) == 150
    keys = ("wind_speed_m_s", "sensor_height_m", "depression_deg", "solar_zenith_deg", "sky_zenith_deg")
    ours = np.array([quantities(row["atmosphere"], *(float(row[k]) for k in keys), edges, by=by) for row in cases])
    theirs = np.array([[float(row[f"{q}[{edges[0]:.1f}-{edges[1]:.1f}]"]) for q in QUANTITIES] for row in cases])
    absolute = np.abs(ours - theirs)
    relative = absolute / np.maximum(theirs, 1e-30)  # one path lets nothing through at all
    error = np.where(absolute < SMALL * theirs.max(axis=0), 0.0, relative)
    assert np.all(np.median(relative, axis=0) < 2e-3)
    assert np.all(np.percentile(error, 95.0, axis=0) < 1e-2)


@pytest.mark.validation
def test_sky_of_the_older_single_precision_set_without_aerosol_is_darker(reference_dir):
    """Navy maritime aerosol at 7 m/s adds emission: our sky lies above the aerosol-free one and below a blackbody at 294.2 K."""
    with (reference_dir / "lowtran7_spectra_3to5um.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    air = model_air("midlatitude-summer", 7.0, (3.0, 5.0), "lowtran", "lowtran7")
    wavenumber = np.array([float(r["wavenumber_cm-1"]) for r in rows])
    theirs = np.array([float(r["sky_L|midlat_summer|none|60"]) for r in rows]) * 1e4 * 1e4 / wavenumber**2
    ours = np.interp(wavenumber, air.wavenumber_cm, air.sky_radiance(np.radians(60.0), 0.0))
    assert np.all(ours > 0.99 * theirs)
