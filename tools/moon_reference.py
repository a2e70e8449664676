"""Places, phases and distances of the Moon by astropy and PyEphem for the tests: 50 places, 20 years, without refraction.

astropy's Moon is the same series as ours with another nutation, sidereal time and observer; PyEphem's is another theory. Run this in an
environment that has both (``pip install astropy ephem``): ``python tools/moon_reference.py tests/climate/data/moon.csv``.
"""

from __future__ import annotations

import csv
import math
import sys
from datetime import UTC, datetime

import numpy as np

FIRST, LAST = datetime(2005, 1, 1, tzinfo=UTC).timestamp(), datetime(2025, 1, 1, tzinfo=UTC).timestamp()
PLACES, TIMES = 50, 5


def main(path: str) -> None:
    """Write the table."""
    import astropy
    import ephem
    from astropy import units
    from astropy.coordinates import AltAz, EarthLocation, get_body
    from astropy.time import Time
    from astropy.utils import iers

    iers.conf.auto_download = False
    rng = np.random.default_rng(47)
    with open(path, "w", newline="", encoding="utf-8") as file:
        file.write(f"# tools/moon_reference.py: astropy {astropy.__version__}, PyEphem {ephem.__version__}; topocentric, no refraction\n")
        rows = csv.writer(file)
        rows.writerow(
            [
                "utc_s",
                "latitude_deg",
                "longitude_deg",
                "zenith_deg",
                "azimuth_deg",
                "phase_deg",
                "distance_km",
                "zenith_2_deg",
                "azimuth_2_deg",
            ]
        )
        for _ in range(PLACES):
            latitude, longitude = math.degrees(math.asin(rng.uniform(-1.0, 1.0))), rng.uniform(-180.0, 180.0)
            latitude, longitude = round(latitude, 4), round(longitude, 4)
            location = EarthLocation.from_geodetic(longitude * units.deg, latitude * units.deg, 0.0 * units.m)
            for second in np.round(rng.uniform(FIRST, LAST, TIMES)):
                time = Time(second, format="unix", scale="utc")
                moon, sun = get_body("moon", time, location), get_body("sun", time, location)
                seen = moon.transform_to(AltAz(obstime=time, location=location))
                away = moon.separation(sun, origin_mismatch="ignore").rad
                phase = math.atan2(sun.distance.km * math.sin(away), moon.distance.km - sun.distance.km * math.cos(away))
                observer = ephem.Observer()
                observer.lat, observer.lon, observer.elevation, observer.pressure = (
                    math.radians(latitude),
                    math.radians(longitude),
                    0.0,
                    0.0,
                )
                observer.date = ephem.Date(datetime.fromtimestamp(second, UTC).replace(tzinfo=None))
                other = ephem.Moon(observer)
                first = f"{90.0 - seen.alt.deg:.5f}", f"{seen.az.deg:.5f}", f"{math.degrees(phase):.5f}", f"{moon.distance.km:.1f}"
                second_place = f"{90.0 - math.degrees(other.alt):.5f}", f"{math.degrees(other.az):.5f}"
                rows.writerow([f"{second:.0f}", latitude, longitude, *first, *second_place])


if __name__ == "__main__":
    main(sys.argv[1])
