"""Table ``[render]``: accuracy and cost of the image, and what is written."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictBool

from seaglint.scenario.quantity import Quantity
from seaglint.scenario.record import Record


class Render(Record):
    """Accuracy and cost of the image, and what is written."""

    lines_per_column: Annotated[
        Literal[1, 2, 4, 8, 16],
        Field(description="most lines of sight across a pixel column; one begins and parts in two as the column widens with range"),
    ] = 2
    shortest_wave_columns: Annotated[
        float,
        Quantity(ge=0, le=100),
        Field(description="columns that waves must span to be geometry: far away, shorter ones go to the facets; 0 keeps all at any range"),
    ] = 2.0
    step_m: Annotated[
        Annotated[float, Quantity("m", gt=0, le=100)] | None,
        Field(description="outward step of the sweep; chosen from the shortest wave where nothing is said"),
    ] = None
    tile_size: Annotated[Literal[64, 128, 256, 512, 1024, 2048, 4096], Field(description="points along each side of a wave tile")] = 512
    subpixel_glint: Annotated[
        Literal["auto", "on", "off"],
        Field(description="sparkles that are smaller than a pixel make its sunlight fluctuate; auto: where that is not negligible"),
    ] = "auto"
    apparent_temperature: Annotated[StrictBool, Field(description="write apparent temperature beside radiance")] = False
