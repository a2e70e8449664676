"""Tables of the view: Sun, Moon, platform, band, and the computation of mean maps and images.

``[time]``, ``[place]`` and ``[sun]`` give the Sun's position, ``[moon]`` the Moon's, ``[platform]`` the motion of the sensor, ``[band]``
the spectral band, ``[mean]`` the method of the mean radiance, and ``[render]`` accuracy, cost and written arrays of the image.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import StrictBool, model_validator

from seaglint.base.limits import TABLE_BANDS_UM
from seaglint.base.schema import Layer
from seaglint.scenario.records.quantities import Azimuth, InputFile, Latitude, Longitude, Quantity, Record, Utc, about, rule
from seaglint.scenario.records.sensor_table import HIGHEST_SENSOR


class Time(Record):
    """When: with ``[place]`` it gives the Sun's position and distance."""

    utc: Annotated[Utc, about("UTC date and time of the first frame, e.g. 2026-06-21T17:30:00Z")]


class Place(Record):
    """Where: with ``[time]`` it gives the Sun's position."""

    latitude_deg: Annotated[Latitude, about("latitude, north positive")]
    longitude_deg: Annotated[Longitude, about("longitude, east positive")]


class Sun(Record):
    """The Sun's position given directly, at 1 au; instead of ``[time]`` and ``[place]``."""

    zenith_deg: Annotated[
        float,
        Quantity("deg", ge=0, le=180),
        about("zenith angle of the Sun's centre; above 90 it is below the horizontal; places nearer to it may still see it"),
    ] = 75.0
    azimuth_deg: Annotated[Azimuth, about("azimuth of the Sun, clockwise from north")] = 180.0


class Moon(Record):
    """A Moon in the night sky: an empty table takes its position and phase from ``[time]`` and ``[place]``; or give the three angles."""

    zenith_deg: Annotated[
        Annotated[float, Quantity("deg", ge=0, le=180)] | None,
        about("zenith angle of the Moon's centre; above 90 it is below the horizontal; places nearer to it may still see it"),
    ] = None
    azimuth_deg: Annotated[Azimuth | None, about("azimuth of the Moon, clockwise from north")] = None
    phase_deg: Annotated[
        Annotated[float, Quantity("deg", ge=0, le=180)] | None,
        about("phase angle, the angle at the Moon between Sun and observer: 0 is full Moon, 90 a half Moon, 180 new Moon"),
    ] = None
    distance_km: Annotated[
        Annotated[float, Quantity("km", ge=340_000, le=420_000)] | None,
        about("distance of the Moon's centre; default: from date and place, or 384400 with the three angles"),
    ] = None

    @property
    def given(self) -> bool:
        """Return true where the angles are given, instead of date and place."""
        return self.zenith_deg is not None

    @model_validator(mode="after")
    def _all_angles_or_none(self) -> Self:
        angles = {"zenith_deg": self.zenith_deg, "azimuth_deg": self.azimuth_deg, "phase_deg": self.phase_deg}
        missing = [name for name, angle in angles.items() if angle is None]
        if 0 < len(missing) < len(angles):
            given = [name for name in angles if name not in missing]
            here = f"{' and '.join(given)} {'is' if len(given) == 1 else 'are'} given"
            text = f"is missing, but {here}; give zenith_deg, azimuth_deg and phase_deg, or none of them with [time] and [place]"
            raise rule(f"moon.{missing[0]}", text)
        if missing and self.distance_km is not None:
            text = f"= {self.distance_km:g} is given without angles; leave it out, or give zenith_deg, azimuth_deg and phase_deg"
            raise rule("moon.distance_km", text, value=self.distance_km)
        return self


PlaceMetres = Annotated[float, Quantity("m", ge=-1e6, le=1e6)]  #: Position towards east or north.


class TimedPlace(Record):
    """Time and place that keyframes of the sensor and of objects share."""

    time_s: Annotated[float, Quantity("s", ge=-1e7, le=1e7), about("time from the first frame")]
    east_m: Annotated[PlaceMetres | None, about("position towards east")] = None
    north_m: Annotated[PlaceMetres | None, about("position towards north")] = None


_Turn = Annotated[float, Quantity("deg", ge=-36_000, le=36_000)]


class Keyframe(TimedPlace):
    """Where a moving sensor is at one time; what is left out stays as [sensor] says (east and north: 0)."""

    height_m: Annotated[Annotated[float, Quantity("m", gt=0, le=HIGHEST_SENSOR)] | None, about("height above the mean sea")] = None
    azimuth_deg: Annotated[_Turn | None, about("azimuth of the image centre")] = None
    elevation_deg: Annotated[Annotated[float, Quantity("deg", ge=-90, le=90)] | None, about("elevation of the image centre")] = None
    roll_deg: Annotated[_Turn | None, about("turn about the line of sight, right side down")] = None


class Platform(Record):
    """A sensor that moves: keyframes, here or in a file, and straight lines between them (angles the short way round)."""

    track: Annotated[
        InputFile | None,
        about(
            "CSV file with a column time_s and any of east_m, north_m, height_m, azimuth_deg, elevation_deg, roll_deg; instead of keyframes"
        ),
    ] = None
    keyframes: Annotated[tuple[Keyframe, ...] | None, about("list of keyframes, the columns of the file as keys")] = None

    floats: Annotated[
        StrictBool, about("true: the sensor heaves, pitches and rolls with the waves under its vessel, about the keyframes if any")
    ] = False
    waterline_m: Annotated[
        tuple[Annotated[float, Quantity("m", gt=0, le=100)], Annotated[float, Quantity("m", gt=0, le=500)]],
        about("waterline [width, length] over which waves are averaged where it floats; the sensor stands above its middle"),
    ] = (3.0, 10.0)
    heading_deg: Annotated[
        Azimuth | None, about("azimuth of the vessel's forward end where it floats; along its way, else the sensor's azimuth")
    ] = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.floats and self.track is None and self.keyframes is None:
            return self
        if (self.track is None) == (self.keyframes is None):
            both = "are both given" if self.track is not None else "are both missing"
            raise rule("platform", f"track and keyframes {both}; give one of the two, or leave [platform] out")
        # Interpolation needs each column at every keyframe.
        for name in Keyframe.model_fields if self.keyframes else ():
            given = [getattr(keyframe, name) is not None for keyframe in self.keyframes or ()]
            if any(given) and not all(given):
                raise rule(
                    f"platform.keyframes[{given.index(False)}]", f"lacks {name}, which other keyframes have; give it in all or in none"
                )
        return self


#: Bands of the air tables, for error messages.
TABLE_BANDS_TEXT = " or ".join(f"{low:g} to {high:g} um" for low, high in TABLE_BANDS_UM) + " (no band across the gap)"


_Edge = Annotated[float, Quantity("um", gt=0, le=100)]


class BandSettings(Record):
    """Spectral band: a rectangle, or a measured response; inside 2-5.5 or 7.5-14 um with the table atmosphere."""

    min_um: Annotated[_Edge | None, about("short-wave edge of a rectangular band (default 3.5)")] = None
    max_um: Annotated[_Edge | None, about("long-wave edge of a rectangular band (default 5.0)")] = None
    response: Annotated[InputFile | None, about("CSV file with columns wavelength_um, response; instead of the two edges")] = None

    @model_validator(mode="before")
    @classmethod
    def _edges(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and raw.get("response") is None:
            # The default edges apply only without a response file, which has its own edges.
            return {"min_um": 3.5, "max_um": 5.0} | {k: v for k, v in raw.items() if v is not None}
        return raw

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.response is not None and (self.min_um is not None or self.max_um is not None):
            raise rule("band.response", "is given together with band.min_um or band.max_um; give the file or the two edges, not both")
        if self.min_um is not None and self.max_um is not None and not self.min_um < self.max_um:
            raise rule("band.min_um", f"= {self.min_um:g} is not below band.max_um = {self.max_um:g}; swap them", value=self.min_um)
        return self


class Mean(Record):
    """How the mean radiance is computed."""

    mode: Annotated[
        Literal["spectral", "article"],
        about(
            "spectral: per wavenumber, sky and sea apart; article: band means, isotropic slopes at the wind as given, "
            "sky and sea one blackbody, as in the source article"
        ),
    ] = "spectral"
    shadowing: Annotated[
        Literal["nested", "both", "viewer"] | None,
        about(
            "legs that waves shadow: nested (viewer and Sun, wave band by wave band), both (the same by Smith's law, too "
            "bright near the horizon under a low Sun), or viewer (alone, Saunders' law); default: nested, viewer in the "
            "mode article"
        ),
    ] = None

    @model_validator(mode="after")
    def _article_shadows_the_viewer(self) -> Self:
        if self.mode == "article" and self.shadowing not in (None, "viewer"):
            text = "shadows the viewer's leg alone; leave it out or set mean.mode = 'spectral'"
            raise rule("mean.shadowing", f"= '{self.shadowing}' with mean.mode = 'article', which {text}")
        return self


class Render(Record):
    """Accuracy and cost of the image, and what is written."""

    lines_per_column: Annotated[
        Literal[1, 2, 4, 8, 16],
        about("most lines of sight across a pixel column; near the sensor it is one, which splits as the column widens"),
    ] = 16
    variance_error: Annotated[
        float,
        Quantity(ge=0.001, le=1),
        about("relative error allowed in the variance of pixels; larger is faster, with fewer far waves and lines of sight"),
    ] = 0.02
    shortest_wave_columns: Annotated[
        float, Quantity(ge=0, le=100), about("waves longer than this many columns are always drawn; 0 draws all waves at any range")
    ] = 2.0
    step_m: Annotated[
        Annotated[float, Quantity("m", gt=0, le=100)] | None, about("outward step of the sweep; default: chosen from the shortest wave")
    ] = None
    tile_size: Annotated[Literal[64, 128, 256, 512, 1024, 2048, 4096], about("points along each side of a wave tile")] = 512
    subpixel_glint: Annotated[
        Literal["auto", "on", "off"], about("random fluctuation of glint by sparkles smaller than a pixel; auto: where it matters")
    ] = "auto"
    gaussian_facets: Annotated[
        StrictBool, about("replace the skewness and peakedness of the slope model by a Gaussian of the same variances; images need it")
    ] = False
    oversampling: Annotated[
        Annotated[int, Quantity(ge=1, le=15, integer=True)] | None,
        about("with a detector: pixels drawn along each side of its pixels; default: as fine as its optics and pixels need"),
    ] = None
    object_shadows: Annotated[StrictBool, about("objects cast shadows: no glint on the sea behind them as seen from the Sun")] = False
    mask_share: Annotated[
        float,
        Quantity(gt=0, le=1),
        about("with a detector: share of an object's largest change of counts from which a pixel belongs to the mask of its response"),
    ] = 0.05
    layers: Annotated[
        tuple[Layer, ...],
        about(
            "images written beside the radiance: its four parts, distance and slope of the sea, the share of a pixel that it "
            "fills, that of glint in the radiance, the number of the object in it",
            json_schema_extra={"uniqueItems": True},
        ),
    ] = ()
    apparent_temperature: Annotated[StrictBool, about("write apparent temperature beside radiance")] = False

    @model_validator(mode="after")
    def _each_layer_once(self) -> Self:
        twice = next((name for name in self.layers if self.layers.count(name) > 1), None)
        if twice is not None:
            given = ", ".join(f"'{name}'" for name in self.layers)
            text = f"= [{given}] names '{twice}' {self.layers.count(twice)} times; name each layer once"
            raise rule("render.layers", text, value=self.layers, allowed="each name once")
        return self
