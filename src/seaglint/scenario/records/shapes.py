"""Shapes of ``[[objects]]``: kinds of solids, what several of them make together, meshes, plumes and points, one record each."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import InputFile, Record, rule

_Length = Annotated[float, Quantity("m", gt=0, le=2000)]
_Place = Annotated[float, Quantity("m", ge=-5000, le=5000)]
_Angle = Annotated[float, Quantity("deg", ge=-36_000, le=36_000)]

Temperature = Annotated[float, Quantity("K", ge=100, le=4000)]
Emissivity = Annotated[float, Quantity(ge=0, le=1)]


class Part(Record):
    """Base of all shapes: place in the object and material."""

    kind: str
    at_m: Annotated[tuple[_Place, _Place, _Place], Field(description="its centre in the object: [starboard, forward, up]")] = (
        0.0,
        0.0,
        0.0,
    )
    heading_deg: Annotated[_Angle, Field(description="its turn in the object about the vertical, clockwise from above")] = 0.0
    pitch_deg: Annotated[_Angle, Field(description="forward end up; 90 lays the axis of a cylinder or cone along the object, tip aft")] = (
        0.0
    )
    roll_deg: Annotated[_Angle, Field(description="starboard side down")] = 0.0
    temperature_k: Annotated[Temperature | None, Field(description="of its surface; default: that of what it is part of")] = None
    emissivity: Annotated[Emissivity | None, Field(description="of its surface; the rest of 1 is reflected, in all directions alike")] = (
        None
    )


class Sphere(Part):
    """A sphere."""

    kind: Literal["sphere"] = "sphere"
    radius_m: Annotated[_Length, Field(description="radius")]


class Ellipsoid(Part):
    """An ellipsoid."""

    kind: Literal["ellipsoid"] = "ellipsoid"
    semi_axes_m: Annotated[tuple[_Length, _Length, _Length], Field(description="half of its width, length and height")]


class Box(Part):
    """A box."""

    kind: Literal["box"] = "box"
    size_m: Annotated[tuple[_Length, _Length, _Length], Field(description="width, length and height: to starboard, forward, up")]


class Cylinder(Part):
    """A capped cylinder, upright unless turned."""

    kind: Literal["cylinder"] = "cylinder"
    radius_m: Annotated[_Length, Field(description="radius")]
    length_m: Annotated[_Length, Field(description="length along its axis")]


class Cone(Part):
    """A capped cone, tip up unless turned."""

    kind: Literal["cone"] = "cone"
    radius_m: Annotated[_Length, Field(description="radius of its foot")]
    length_m: Annotated[_Length, Field(description="length along its axis")]
    top_radius_m: Annotated[float, Quantity("m", ge=0, le=2000), Field(description="radius of its upper end; 0 is a tip")] = 0.0


class Wedge(Part):
    """Half of a box: full height aft, falling to nothing forward."""

    kind: Literal["wedge"] = "wedge"
    size_m: Annotated[tuple[_Length, _Length, _Length], Field(description="width, length and height of the box")]


class MeshFile(Part):
    """A closed surface of triangles from a file."""

    kind: Literal["mesh"] = "mesh"
    path: Annotated[
        InputFile,
        Field(description="STL, OBJ, PLY or GLB file; vertices of a PLY file may have the properties temperature [K] and emissivity"),
    ]
    units: Annotated[Literal["m", "mm", "cm", "km", "in", "ft"], Field(description="what the file's numbers are in")] = "m"
    scale: Annotated[float, Quantity(gt=0, le=1e6), Field(description="factor on top of the units")] = 1.0
    up: Annotated[
        Literal["auto", "z", "y"],
        Field(
            description="upward axis of the file: z (y forward) or y (z forward); auto is y for GLB, as that format has it, z for others"
        ),
    ] = "auto"


class Plume(Part):
    """An ellipsoid of gas that emits and lets through."""

    kind: Literal["plume"] = "plume"
    semi_axes_m: Annotated[tuple[_Length, _Length, _Length], Field(description="half of its width, length and height")]
    co2_share: Annotated[
        Annotated[float, Quantity(ge=0, le=1)] | None,
        Field(description="mole fraction of carbon dioxide at 1 atm, in place of emissivity"),
    ] = None
    h2o_share: Annotated[
        Annotated[float, Quantity(ge=0, le=1)] | None,
        Field(description="mole fraction of water vapour at 1 atm, in place of emissivity"),
    ] = None

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
        Annotated[float, Quantity("W/sr", ge=-1e9, le=1e9)] | None, Field(description="in-band radiant intensity, before the path")
    ] = None
    temperature_difference_k: Annotated[
        Annotated[float, Quantity("K", ge=-300, le=3000)] | None, Field(description="apparent, to what is behind it; with area_m2")
    ] = None
    area_m2: Annotated[Annotated[float, Quantity("m^2", gt=0, le=1e6)] | None, Field(description="projected area")] = None
    temperature_k: Annotated[
        Temperature | None,
        Field(description="of the blackbody with the spectrum of intensity_w_sr; default: no spectrum"),
    ] = None

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
    parts: Annotated[tuple[Shape, ...], Field(description="list of shapes, each a table; plumes stay gas")]


class Intersection(Part):
    """The volume that all of its parts have in common."""

    kind: Literal["intersection"] = "intersection"
    parts: Annotated[tuple[Shape, ...], Field(description="list of shapes, each a table")]


class Difference(Part):
    """Its first part without the others."""

    kind: Literal["difference"] = "difference"
    parts: Annotated[tuple[Shape, ...], Field(description="list of shapes, each a table; the others cut out of the first")]


Shape = Annotated[
    Sphere | Ellipsoid | Box | Cylinder | Cone | Wedge | Union | Intersection | Difference | MeshFile | Plume | Point,
    Field(discriminator="kind"),
]

Union.model_rebuild()
Intersection.model_rebuild()
Difference.model_rebuild()
