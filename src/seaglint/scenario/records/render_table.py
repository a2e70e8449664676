"""Table ``[render]``: accuracy and cost of the image, and what is written."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, StrictBool, model_validator

from seaglint.base.schema import Layer
from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record, rule


class Render(Record):
    """Accuracy and cost of the image, and what is written."""

    lines_per_column: Annotated[
        Literal[1, 2, 4, 8, 16],
        Field(description="most lines of sight across a pixel column; near the sensor it is one, which splits as the column widens"),
    ] = 16
    variance_error: Annotated[
        float,
        Quantity(ge=0.001, le=1),
        Field(description="relative error allowed in the variance of pixels; larger is faster, with fewer far waves and lines of sight"),
    ] = 0.02
    shortest_wave_columns: Annotated[
        float,
        Quantity(ge=0, le=100),
        Field(description="waves longer than this many columns are always drawn; 0 draws all waves at any range"),
    ] = 2.0
    step_m: Annotated[
        Annotated[float, Quantity("m", gt=0, le=100)] | None,
        Field(description="outward step of the sweep; default: chosen from the shortest wave"),
    ] = None
    tile_size: Annotated[Literal[64, 128, 256, 512, 1024, 2048, 4096], Field(description="points along each side of a wave tile")] = 512
    subpixel_glint: Annotated[
        Literal["auto", "on", "off"],
        Field(description="random fluctuation of glint by sparkles smaller than a pixel; auto: where it matters"),
    ] = "auto"
    gaussian_facets: Annotated[
        StrictBool,
        Field(description="replace the skewness and peakedness of the slope model by a Gaussian of the same variances; images need it"),
    ] = False
    oversampling: Annotated[
        Annotated[int, Quantity(ge=1, le=15, integer=True)] | None,
        Field(description="with a detector: pixels drawn along each side of its pixels; default: what the optics' cut-off needs"),
    ] = None
    object_shadows: Annotated[
        StrictBool, Field(description="objects cast shadows: no glint on the sea behind them as seen from the Sun")
    ] = False
    layers: Annotated[
        tuple[Layer, ...],
        Field(
            description="images written beside the radiance: its four parts, distance and slope of the sea, the share of a pixel that it "
            "fills, that of glint in the radiance, the number of the object in it",
            json_schema_extra={"uniqueItems": True},
        ),
    ] = ()
    apparent_temperature: Annotated[StrictBool, Field(description="write apparent temperature beside radiance")] = False

    @model_validator(mode="after")
    def _each_layer_once(self) -> Self:
        twice = next((name for name in self.layers if self.layers.count(name) > 1), None)
        if twice is not None:
            given = ", ".join(f"'{name}'" for name in self.layers)
            text = f"= [{given}] names '{twice}' {self.layers.count(twice)} times; name each layer once"
            raise rule("render.layers", text, value=self.layers, allowed="each name once")
        return self
