"""Table ``[likelihood]``: how often glint matters, over weather, Sun and geometry."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import StrictBool, model_validator

from seaglint.scenario.records.quantities import (
    PACKAGED,
    Azimuth,
    InputFile,
    Latitude,
    Longitude,
    Quantity,
    Record,
    WeatherInput,
    about,
    rule,
)

Case = Literal["single-look", "trajectory", "field-of-view"]

MOST_SAMPLES = 2**26  #: Largest number of looks of one run [1]; some 5 GB.


_FieldSide = Annotated[float, Quantity("deg", ge=0, le=60)]
_Height = Annotated[float, Quantity("m", ge=2, le=10_000)]
_Hour = Annotated[float, Quantity("h", ge=0, le=24)]


class Likelihood(Record):
    """How often the mirrored Sun is brighter than thresholds: for the command likelihood."""

    weather: Annotated[
        WeatherInput | None,
        about(
            "weather table, CSV or Parquet ('seaglint weather build' makes one), or one of the package: world, north-atlantic; default: "
            "world where it has the place, else north-atlantic"
        ),
    ] = None
    threshold_w_m2_sr: Annotated[
        tuple[Annotated[float, Quantity("W/m2/sr", ge=0)], ...], about("radiances at the sensor that glint is compared with", min_length=1)
    ] = (0.25, 2.5)
    case: Annotated[Case, about("one look; any depression on the way of a target; the same with all of a field of view about it")] = (
        "single-look"
    )
    depression_deg: Annotated[
        tuple[Annotated[float, Quantity("deg", ge=-10, le=90)], Annotated[float, Quantity("deg", ge=0, le=90)]],
        about("lowest and highest depression of looks, uniform between, or of the trajectory"),
    ] = (1.5, 6.0)
    azimuth_from_sun_deg: Annotated[tuple[Azimuth, Azimuth], about("azimuths of looks, clockwise from the Sun's")] = (0.0, 360.0)
    field_deg: Annotated[tuple[_FieldSide, _FieldSide], about("width and height of the field of view that case = 'field-of-view' adds")] = (
        4.0,
        4.0,
    )
    height_m: Annotated[tuple[_Height, _Height] | None, about("lowest and highest sensor, uniform between; default: sensor.height_m")] = (
        None
    )
    looks: Annotated[InputFile | None, about("CSV of looks drawn whole: any of depression_deg, azimuth_from_sun_deg, height_m, weight")] = (
        None
    )
    samples: Annotated[int, Quantity(ge=256, le=MOST_SAMPLES, integer=True), about("draws, rounded up to powers of two")] = 65_536
    azimuths: Annotated[
        Literal["auto", "integrated", "drawn"],
        about(
            "integrated: each draw brings the share of the azimuths above the threshold (mean of single looks); drawn: one "
            "azimuth; auto: integrated where that goes, up to 131072 draws"
        ),
    ] = "auto"
    place: Annotated[
        tuple[Latitude, Longitude] | None,
        about("place of the weather and of the Sun: latitude and longitude, instead of [place] and a region"),
    ] = None
    latitudes_deg: Annotated[tuple[Latitude, Latitude] | None, about("region: southern and northern border")] = None
    longitudes_deg: Annotated[tuple[Azimuth, Azimuth] | None, about("region: western and eastern border")] = None
    place_from_weather: Annotated[StrictBool, about("take place, month and hour from the rows of the weather table")] = False
    year: Annotated[int, Quantity(ge=1800, le=2200, integer=True), about("year of the ephemeris where [time] is not given")] = 2025
    months: Annotated[
        tuple[Annotated[int, Quantity(ge=1, le=12, integer=True)], ...] | None, about("months that count; all", min_length=1)
    ] = None
    hours_utc: Annotated[tuple[_Hour, _Hour], about("hours of the day that count, UTC; [22, 4] goes through midnight")] = (0.0, 24.0)
    clouds: Annotated[
        Literal["auto", "cover", "overcast", "line-of-sight"],
        about(
            "cover: the Sun is hidden with the chance of the cover; overcast: only when overcast; line-of-sight: by cover and "
            "elevation; auto: cover for a single look, else overcast"
        ),
    ] = "auto"
    overcast_cover: Annotated[float, Quantity(gt=0, le=1), about("cover from which the sky is overcast")] = 0.99
    cloud_aspect: Annotated[float, Quantity(ge=0, le=10), about("height of clouds over their width, for line-of-sight")] = 0.5
    smooth: Annotated[StrictBool, about("smooth bootstrap: wind and cover of drawn rows vary about the table's")] = False
    quantity: Annotated[
        Literal["mean", "mean-plus-sigma", "false-alarms", "detection"],
        about(
            "mean of the mirrored Sun; the same plus sigmas standard deviations in a pixel; chance that a pixel passes the "
            "threshold; chance of detection of a target whose contrast is the threshold"
        ),
    ] = "mean"
    sigmas: Annotated[float, Quantity(ge=0, le=100), about("k of mean plus k standard deviations")] = 3.0
    detection_curve: Annotated[
        InputFile | None, about("CSV of contrast_w_m2_sr and pd, what is detected of a target by its contrast to the glint")
    ] = None

    @model_validator(mode="after")
    def _ranges_ascend(self) -> Self:
        for name in ("depression_deg", "azimuth_from_sun_deg", "height_m", "latitudes_deg"):
            pair = getattr(self, name)
            # Longitudes may descend: such a region crosses the date line. Hours may: they go through midnight.
            if pair is not None and pair[0] > pair[1]:
                text = f"= [{pair[0]:g}, {pair[1]:g}] goes down; give the lower number first"
                raise rule(f"likelihood.{name}", text, value=pair)
        if self.depression_deg[1] <= 0.0:
            text = f"= [{self.depression_deg[0]:g}, {self.depression_deg[1]:g}] is above the horizontal; give depressions above 0 deg"
            raise rule("likelihood.depression_deg", text, value=self.depression_deg)
        if self.azimuth_from_sun_deg[1] - self.azimuth_from_sun_deg[0] > 360.0:
            raise rule("likelihood.azimuth_from_sun_deg", "spans more than 360 deg; give [0, 360] for all", value=self.azimuth_from_sun_deg)
        return self

    @model_validator(mode="after")
    def _region_has_both(self) -> Self:
        if (self.latitudes_deg is None) != (self.longitudes_deg is None):
            missing = "longitudes_deg" if self.longitudes_deg is None else "latitudes_deg"
            raise rule(f"likelihood.{missing}", "is missing: a region needs likelihood.latitudes_deg and likelihood.longitudes_deg")
        if self.place_from_weather and self.latitudes_deg is not None:
            raise rule("likelihood.place_from_weather", "= true with a region; leave one of both out")
        if self.hours_utc[1] - self.hours_utc[0] in (0.0, -24.0):
            raise rule("likelihood.hours_utc", "is empty; give two different hours", value=self.hours_utc)
        return self

    @model_validator(mode="after")
    def _detection_has_a_curve(self) -> Self:
        if (self.quantity == "detection") != (self.detection_curve is not None):
            text = "needs a curve: quantity = 'detection' and detection_curve go together"
            raise rule("likelihood.detection_curve", text)
        if self.azimuths == "integrated" and not self.integrates:
            text = (
                "= 'integrated' is for quantity = 'mean', case = 'single-look' and a range of azimuths; set likelihood.azimuths = 'drawn'"
            )
            raise rule("likelihood.azimuths", text)
        if self.quantity == "false-alarms" and self.case != "single-look":
            raise rule("likelihood.quantity", "= 'false-alarms' counts pixels of one look; set likelihood.case = 'single-look'")
        return self

    @property
    def integrates(self) -> bool:
        """Return true where azimuths can be integrated instead of drawn."""
        wide = self.azimuth_from_sun_deg[0] < self.azimuth_from_sun_deg[1]
        return self.case == "single-look" and self.quantity == "mean" and wide

    @property
    def places_itself(self) -> bool:
        """Return true where the places are drawn, and not the single one of ``[place]``."""
        return self.place is None and (self.latitudes_deg is not None or self.place_from_weather)

    @property
    def of_the_world(self) -> bool:
        """Return true where the weather is the climatology of the world's seas, by name."""
        return str(self.weather) == PACKAGED[0]
