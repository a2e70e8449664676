"""Choice of a file's record, and tolerances of its time and place."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError

_EARTH_RADIUS_KM = 6371.0
_LISTED = 8  # sites that an error lists by name


@dataclass(frozen=True)
class WaveChoice:
    """Requested time and place, and directions for a file that lacks them."""

    time: str | datetime | np.datetime64 | None = None  #: Time wanted, UTC where no zone is said; None where the file has one record.
    #: ``latitude_deg``, ``longitude_deg``: Place wanted, both or none [deg].
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    site: str | None = None  #: Name of a site, as the file calls it, or its number from 1.
    time_tolerance: float = 3600.0  #: Farthest the record may be from the time wanted [s].
    distance_tolerance_km: float = 50.0  #: Farthest it may be from the place wanted [km].
    #: ``from_deg``, ``spreading_deg``: Mean direction FROM and circular width, for files that have energy over frequency alone [deg].
    from_deg: float | None = None
    spreading_deg: float | None = None

    def require_time(self, what: str) -> np.datetime64:
        """Return the requested time, where a file can only be read with one."""
        if self.time is None:
            raise DomainError(f"is missing: give the UTC time of the record wanted of {what}, or [time] utc", name="time")
        return as_utc(self.time)

    def nearest_time(self, times: NDArray[np.datetime64], what: str) -> tuple[int, float | None]:
        """Return the index of the record nearest in time, and its difference from the requested time [s]."""
        dated = np.flatnonzero(~np.isnat(times))  # what has no time is the nearest to NumPy
        if dated.size == 0:
            raise DataError(f"{what} holds no record" + (" with a time" if times.size else ""))
        if self.time is None and dated.size == 1:
            return int(dated[0]), None
        first, last = _text(times[dated].min()), _text(times[dated].max())
        requested = self.require_time(f"{what}, which has {dated.size} from {first} to {last}")
        index = int(dated[np.argmin(np.abs(times[dated] - requested))])
        off = float((times[index] - requested) / np.timedelta64(1, "s"))
        if abs(off) > self.time_tolerance:
            raise DataError(
                f"{what} has no record within {self.time_tolerance:g} s of {_text(requested)}; it covers {first} to "
                f"{last}, nearest is {_text(times[index])}: give one of its times or a larger time_tolerance_s"
            )
        return index, off

    def nearest_site(
        self, names: tuple[str, ...], latitude_deg: FloatArray | None, longitude_deg: FloatArray | None, what: str
    ) -> tuple[int, float | None]:
        """Return the index of the requested site, and its distance from the requested place [km]."""
        if self.site is not None:
            if self.site.isdecimal() and 1 <= int(self.site) <= len(names) and self.site not in names:
                return int(self.site) - 1, None
            if self.site not in names:
                shown = f"{', '.join(names[:_LISTED])}{', ...' if len(names) > _LISTED else ''}"
                raise DomainError(
                    f"= '{self.site}' is not a site of {what}; allowed: {shown}", name="site", value=self.site, allowed=", ".join(names)
                )
            return names.index(self.site), None
        if self.latitude_deg is None or self.longitude_deg is None or latitude_deg is None or longitude_deg is None:
            if len(names) > 1:
                raise DomainError(
                    f"is missing: {what} has {len(names)} sites ({', '.join(names[:_LISTED])}{', ...' if len(names) > _LISTED else ''}); "
                    "give the name of one" + ("" if latitude_deg is None else ", or latitude_deg and longitude_deg"),
                    name="site",
                    allowed=", ".join(names),
                )
            return 0, None
        away = distance_km(self.latitude_deg, self.longitude_deg, latitude_deg, longitude_deg)
        index = int(np.argmin(np.where(np.isfinite(away), away, np.inf)))
        if not away[index] <= self.distance_tolerance_km:
            raise DataError(
                f"{what} has no site within {self.distance_tolerance_km:g} km of {self.latitude_deg:g}, {self.longitude_deg:g}; nearest is "
                f"{names[index]} at {latitude_deg[index]:g}, {longitude_deg[index]:g}, {away[index]:.0f} km away: give another place or a "
                "larger distance_tolerance_km"
            )
        return index, float(away[index])


def as_utc(time: str | datetime | np.datetime64) -> np.datetime64:
    """Return a time as datetime64 in UTC; text and datetimes without a zone are UTC."""
    if isinstance(time, np.datetime64):
        return time
    try:
        moment = datetime.fromisoformat(time) if isinstance(time, str) else time
    except ValueError as error:
        raise DataError(f"time {time!r} is not an ISO date and time such as 2020-06-08T03:50Z") from error
    if moment.tzinfo is not None:
        moment = moment.astimezone(UTC).replace(tzinfo=None)
    return np.datetime64(moment)


def distance_km(latitude: float, longitude: float, latitudes: FloatArray, longitudes: FloatArray) -> FloatArray:
    """Return the distance along the Earth from one place to others, all in degrees [km] (haversine).

    Examples
    --------
    >>> import numpy as np
    >>> distance_km(0.0, 359.5, np.array([0.0]), np.array([0.5])).round(1)
    array([111.2])
    """
    here, there = np.radians(latitude), np.radians(latitudes)
    turn = np.radians(np.asarray(longitudes) - longitude)
    h = np.sin(0.5 * (there - here)) ** 2 + np.cos(here) * np.cos(there) * np.sin(0.5 * turn) ** 2
    return np.asarray(2.0 * _EARTH_RADIUS_KM * np.arcsin(np.sqrt(np.clip(h, 0.0, 1.0))))


def _text(time: Any) -> str:
    return str(np.datetime_as_string(np.datetime64(time), unit="s")) + "Z"
