"""Tables ``[[objects]]``: objects on and above the sea, with their shapes, places and motion.

Shapes are solids, combinations of solids, meshes, plumes and points, one record each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, StrictBool, model_validator

from seaglint.scenario.presets import OBJECTS
from seaglint.scenario.records.quantities import InputFile, Latitude, Longitude, Quantity, Record, about, rule
from seaglint.scenario.records.small_tables import PlaceMetres, TimedPlace

_Length = Annotated[float, Quantity("m", gt=0, le=2000)]
_ShapePlace = Annotated[float, Quantity("m", ge=-5000, le=5000)]
_Angle = Annotated[float, Quantity("deg", ge=-36_000, le=36_000)]

Temperature = Annotated[float, Quantity("K", ge=100, le=4000)]
_Share = Annotated[float, Quantity(ge=0, le=1)]
Emissivity = _Share


class Part(Record):
    """Base of all shapes: place in the object and material."""

    kind: str
    at_m: Annotated[tuple[_ShapePlace, _ShapePlace, _ShapePlace], about("its centre in the object: [starboard, forward, up]")] = (
        0.0,
        0.0,
        0.0,
    )
    heading_deg: Annotated[_Angle, about("its turn in the object about the vertical, clockwise from above")] = 0.0
    pitch_deg: Annotated[_Angle, about("forward end up; 90 lays the axis of a cylinder or cone along the object, tip aft")] = 0.0
    roll_deg: Annotated[_Angle, about("starboard side down")] = 0.0
    temperature_k: Annotated[Temperature | None, about("of its surface; default: that of what it is part of")] = None
    emissivity: Annotated[Emissivity | None, about("of its surface; the rest of 1 is reflected, in all directions alike")] = None


class Sphere(Part):
    """A sphere."""

    kind: Literal["sphere"] = "sphere"
    radius_m: Annotated[_Length, about("radius")]


class Ellipsoid(Part):
    """An ellipsoid."""

    kind: Literal["ellipsoid"] = "ellipsoid"
    semi_axes_m: Annotated[tuple[_Length, _Length, _Length], about("half of its width, length and height")]


class Box(Part):
    """A box."""

    kind: Literal["box"] = "box"
    size_m: Annotated[tuple[_Length, _Length, _Length], about("width, length and height: to starboard, forward, up")]


class Cylinder(Part):
    """A capped cylinder, upright unless turned."""

    kind: Literal["cylinder"] = "cylinder"
    radius_m: Annotated[_Length, about("radius")]
    length_m: Annotated[_Length, about("length along its axis")]


class Cone(Part):
    """A capped cone, tip up unless turned."""

    kind: Literal["cone"] = "cone"
    radius_m: Annotated[_Length, about("radius of its foot")]
    length_m: Annotated[_Length, about("length along its axis")]
    top_radius_m: Annotated[float, Quantity("m", ge=0, le=2000), about("radius of its upper end; 0 is a tip")] = 0.0


class Wedge(Part):
    """Half of a box: full height aft, falling to nothing forward."""

    kind: Literal["wedge"] = "wedge"
    size_m: Annotated[tuple[_Length, _Length, _Length], about("width, length and height of the box")]


class MeshFile(Part):
    """A closed surface of triangles from a file."""

    kind: Literal["mesh"] = "mesh"
    path: Annotated[
        InputFile, about("STL, OBJ, PLY or GLB file; vertices of a PLY file may have the properties temperature [K] and emissivity")
    ]
    units: Annotated[Literal["m", "mm", "cm", "km", "in", "ft"], about("what the file's numbers are in")] = "m"
    scale: Annotated[float, Quantity(gt=0, le=1e6), about("factor on top of the units")] = 1.0
    up: Annotated[
        Literal["auto", "z", "y"],
        about("upward axis of the file: z (y forward) or y (z forward); auto is y for GLB, as that format has it, z for others"),
    ] = "auto"


class Plume(Part):
    """An ellipsoid of gas that emits and lets through."""

    kind: Literal["plume"] = "plume"
    semi_axes_m: Annotated[tuple[_Length, _Length, _Length], about("half of its width, length and height")]
    co2_share: Annotated[_Share | None, about("mole fraction of carbon dioxide at 1 atm, in place of emissivity")] = None
    h2o_share: Annotated[_Share | None, about("mole fraction of water vapour at 1 atm, in place of emissivity")] = None

    @property
    def gases(self) -> bool:
        """True if it is given by its gases, rather than grey."""
        return self.co2_share is not None or self.h2o_share is not None

    @model_validator(mode="after")
    def _lets_through(self) -> Self:
        if not self.gases:
            if self.emissivity is None or self.emissivity >= 1.0:
                given = "is missing" if self.emissivity is None else f"= {self.emissivity:g}"
                text = "a plume lets radiation through; give the emissivity along its middle, below 1, or co2_share and h2o_share"
                raise rule("shape.emissivity", f"{given}: {text}")
            return self
        if self.emissivity is not None:
            raise rule("shape", "of kind 'plume' has an emissivity and shares of gases; give emissivity, or co2_share and h2o_share")
        total = (self.co2_share or 0.0) + (self.h2o_share or 0.0)
        if not 0.0 < total <= 1.0:
            raise rule("shape", f"of kind 'plume' has co2_share + h2o_share = {total:g}; give mole fractions with a sum above 0, up to 1")
        return self


class Point(Record):
    """A source too small to have a shape: its radiant intensity, or its apparent temperature above what is behind it and its area."""

    kind: Literal["point"] = "point"
    intensity_w_sr: Annotated[
        Annotated[float, Quantity("W/sr", ge=-1e9, le=1e9)] | None, about("in-band radiant intensity, before the path")
    ] = None
    temperature_difference_k: Annotated[
        Annotated[float, Quantity("K", ge=-300, le=3000)] | None, about("apparent, to what is behind it; with area_m2")
    ] = None
    area_m2: Annotated[Annotated[float, Quantity("m^2", gt=0, le=1e6)] | None, about("projected area")] = None
    temperature_k: Annotated[Temperature | None, about("of the blackbody with the spectrum of intensity_w_sr; default: no spectrum")] = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        pair = (self.temperature_difference_k is not None, self.area_m2 is not None)
        if (self.intensity_w_sr is None and not all(pair)) or (self.intensity_w_sr is not None and any(pair)):
            raise rule("shape", "of kind 'point' needs intensity_w_sr, or temperature_difference_k and area_m2; give one of the two")
        if self.temperature_k is not None and self.intensity_w_sr is None:
            raise rule("shape", "of kind 'point' has temperature_k without intensity_w_sr, whose spectrum it says; leave it out")
        return self


class Union(Part):
    """All of its parts together."""

    kind: Literal["union"] = "union"
    parts: Annotated[tuple[Shape, ...], about("list of shapes, each a table; plumes stay gas")]


class Intersection(Part):
    """The volume that all of its parts have in common."""

    kind: Literal["intersection"] = "intersection"
    parts: Annotated[tuple[Shape, ...], about("list of shapes, each a table")]


class Difference(Part):
    """Its first part without the others."""

    kind: Literal["difference"] = "difference"
    parts: Annotated[tuple[Shape, ...], about("list of shapes, each a table; the others cut out of the first")]


Shape = Annotated[
    Sphere | Ellipsoid | Box | Cylinder | Cone | Wedge | Union | Intersection | Difference | MeshFile | Plume | Point,
    Field(discriminator="kind"),
]

Union.model_rebuild()
Intersection.model_rebuild()
Difference.model_rebuild()


_Height = Annotated[float, Quantity("m", ge=-1000, le=100_000)]


class ObjectKeyframe(TimedPlace):
    """Where an object is at one time; what is left out stays as the object's own keys say."""

    height_m: Annotated[_Height | None, about("height of its centre above the mean sea")] = None
    latitude_deg: Annotated[Latitude | None, about("latitude, instead of metres")] = None
    longitude_deg: Annotated[Longitude | None, about("longitude, instead of metres")] = None
    heading_deg: Annotated[_Angle | None, about("azimuth of its forward end; default: along its way")] = None
    pitch_deg: Annotated[_Angle | None, about("forward end up")] = None
    roll_deg: Annotated[_Angle | None, about("starboard side down")] = None


def with_names(items: Any) -> Any:
    """Return tables of objects in which every object has a name: by default its preset, or the kind of its shape.

    Repeated names are numbered; given names are unchanged.

    Examples
    --------
    >>> [item["name"] for item in with_names([{"preset": "buoy"}, {"preset": "buoy"}, {"name": "buoy-2"}])]
    ['buoy', 'buoy-3', 'buoy-2']
    """
    if not isinstance(items, Sequence) or isinstance(items, str):
        return items
    # Names that are given are reserved first, so that numbered names never collide with them.
    taken = {item["name"] for item in items if isinstance(item, Mapping) and isinstance(item.get("name"), str)}
    out = []
    for item in items:
        if (name := _natural_name(item)) is not None:
            numbered, number = name, 1
            while numbered in taken:
                number += 1
                numbered = f"{name}-{number}"
            taken.add(numbered)
            item = {"name": numbered, **{key: value for key, value in item.items() if key != "name"}}
        out.append(item)
    return out


def _natural_name(item: Any) -> str | None:
    """Return the name that an object without one has; None where it has one."""
    if not isinstance(item, Mapping) or item.get("name") is not None:
        return None
    shape = item.get("shape")
    name = item.get("preset") or (shape.get("kind") if isinstance(shape, Mapping) else getattr(shape, "kind", None))
    return name if isinstance(name, str) else "object"


def _name_not_required(schema: dict[str, Any]) -> None:
    """Take the name out of the keys that a file must have: it is filled in."""
    schema["required"] = [key for key in schema.get("required", []) if key != "name"]
    if not schema["required"]:
        del schema["required"]


class Object(Record):
    """Something on or above the sea: a shape of a material, a place or a way."""

    model_config = ConfigDict(json_schema_extra=_name_not_required)

    name: Annotated[
        str,
        Field(
            min_length=1,
            max_length=100,
            description="what labels and errors call it; each name once; default: that of its preset or shape, numbered where repeated",
        ),
    ]
    preset: Annotated[
        Literal[
            "buoy", "swimmer", "small-boat", "sailing-yacht", "container-ship", "fishing-vessel", "drone", "light-aircraft", "bird-flock"
        ]
        | None,
        about("shape, material and draught of public dimensions; instead of shape"),
    ] = None
    shape: Annotated[Shape | None, about("its shape")] = None
    temperature_k: Annotated[Temperature | None, about("of its surface; needed unless all parts or the mesh have their own")] = None
    emissivity: Annotated[Emissivity, about("of its surface; the rest of 1 is reflected, in all directions alike")] = 0.95
    east_m: Annotated[PlaceMetres | None, about("position east of the sensor's start")] = None
    north_m: Annotated[PlaceMetres | None, about("position north of the sensor's start")] = None
    latitude_deg: Annotated[Latitude | None, about("latitude, instead of metres; needs [place], where the sensor starts")] = None
    longitude_deg: Annotated[Longitude | None, about("longitude, instead of metres")] = None
    height_m: Annotated[_Height | None, about("height of its centre above the mean sea; default: 0 for what floats")] = None
    draught_m: Annotated[
        Annotated[float, Quantity("m", gt=0, le=100)] | None, about("depth of its lowest point under water, instead of height_m")
    ] = None
    heading_deg: Annotated[_Angle | None, about("azimuth of its forward end, clockwise from north; default: along its way")] = None
    pitch_deg: Annotated[_Angle, about("forward end up")] = 0.0
    roll_deg: Annotated[_Angle, about("starboard side down")] = 0.0
    course_deg: Annotated[_Angle | None, about("azimuth of its motion; with speed_m_s")] = None
    speed_m_s: Annotated[Annotated[float, Quantity("m/s", ge=0, le=1000)] | None, about("speed on its course")] = None
    track: Annotated[
        InputFile | None,
        about(
            "CSV file with a column time_s and any of east_m, north_m, height_m, latitude_deg, longitude_deg, heading_deg, "
            "pitch_deg, roll_deg"
        ),
    ] = None
    keyframes: Annotated[tuple[ObjectKeyframe, ...] | None, about("list of keyframes, the columns of the file as keys")] = None
    path: Annotated[Literal["spline", "straight"], about("between keyframes: a smooth curve through them, or straight lines")] = "spline"
    floats: Annotated[StrictBool, about("true: it heaves, pitches and rolls with the waves at its place")] = False

    @model_validator(mode="before")
    @classmethod
    def _from_preset(cls, raw: Any) -> Any:
        raw = with_names([raw])[0]
        if not isinstance(raw, dict) or not isinstance(raw.get("preset"), str) or raw["preset"] not in OBJECTS:
            return raw
        chosen = dict(OBJECTS[raw["preset"]].values)
        if raw.get("shape") is not None and not _is_of_preset(raw["shape"], chosen.get("shape")):
            raise rule(f"objects ('{raw.get('name')}')", "has preset and shape; give one of them")
        if raw.get("draught_m") is not None:
            # A draught replaces the height of the preset; both together would contradict.
            chosen.pop("height_m", None)
        return {**chosen, **{key: value for key, value in raw.items() if value is not None}}

    @model_validator(mode="after")
    def _whole(self) -> Self:
        where = f"objects ('{self.name}')"
        if self.shape is None:
            raise rule(f"{where}.shape", 'is missing; give preset = "small-boat" or another one, or a table shape with its kind')
        moves = {"track": self.track, "keyframes": self.keyframes, "course_deg and speed_m_s": self.course_deg}
        given = [name for name, value in moves.items() if value is not None]
        if len(given) > 1:
            raise rule(where, f"has {' and '.join(given)}; give one of them")
        if (self.course_deg is None) != (self.speed_m_s is None):
            missing = "speed_m_s" if self.speed_m_s is None else "course_deg"
            raise rule(f"{where}.{missing}", "is missing; a course needs both course_deg and speed_m_s")
        if self.height_m is not None and self.draught_m is not None:
            raise rule(where, "has height_m and draught_m; give one of them")
        _require_place(self, where)
        for i, keyframe in enumerate(self.keyframes or ()):
            _require_place(keyframe, f"{where}.keyframes[{i}]")
            # Interpolation needs each column at every keyframe.
            if keyframe.model_fields_set != (self.keyframes or ())[0].model_fields_set:
                other = sorted(keyframe.model_fields_set ^ (self.keyframes or ())[0].model_fields_set)
                raise rule(f"{where}.keyframes[{i}]", f"and keyframes[0] do not both have {', '.join(other)}; give them in all or in none")
        return self


def _is_of_preset(shape: Any, preset: Any) -> bool:
    """Return true for the shape of a preset, which a scenario that was loaded and written out has beside the preset's name."""
    if isinstance(preset, Mapping):
        return isinstance(shape, Mapping) and all(_is_of_preset(shape.get(name), value) for name, value in preset.items())
    if isinstance(preset, list | tuple):
        return isinstance(shape, list | tuple) and len(shape) == len(preset) and all(map(_is_of_preset, shape, preset))
    return bool(shape == preset)


def _require_place(place: Object | ObjectKeyframe, where: str) -> None:
    """Check that a place is given either in metres or in degrees, and in degrees with both numbers."""
    degrees = (place.latitude_deg is not None, place.longitude_deg is not None)
    if any(degrees) and (place.east_m is not None or place.north_m is not None):
        raise rule(where, "has metres and degrees; give east_m and north_m, or latitude_deg and longitude_deg")
    if any(degrees) and not all(degrees):
        missing = "longitude_deg" if degrees[0] else "latitude_deg"
        raise rule(f"{where}.{missing}", "is missing; give latitude_deg and longitude_deg, or east_m and north_m")


def in_degrees(item: Object) -> bool:
    """Return true where any of an object's places is given by latitude and longitude in the scenario."""
    return item.latitude_deg is not None or any(keyframe.latitude_deg is not None for keyframe in item.keyframes or ())


def parts_of(shape: Shape) -> tuple[Shape, ...]:
    """Return the parts of a combined shape; empty for a single shape."""
    return tuple(getattr(shape, "parts", ())) if isinstance(shape, Part) else ()
