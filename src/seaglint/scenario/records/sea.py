"""Tables ``[sea]`` and ``[sea.glint]``: the water and its shape."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictBool

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record
from seaglint.scenario.records.sea_slopes import CoxMunkAnisotropic, Slopes
from seaglint.scenario.records.sea_spectrum import Elfouhaily, Spectrum


class Glint(Record):
    """Correlation of the Sun's glint in time and over the sea, which sets how much glint fluctuates in a pixel."""

    correlation_time_s: Annotated[
        float, Quantity("s", ge=0.001, le=10), Field(description="correlation time of glint at a point (reported: 0.03 to 0.3 s)")
    ] = 0.07
    dispersion: Annotated[
        Literal["full", "article"],
        Field(description="waves behind the correlation length: full: gravity and surface tension; article: surface tension alone"),
    ] = "full"
    cell_m: Annotated[
        Annotated[float, Quantity("m", ge=1e-4, le=100)] | None,
        Field(description="size of the sea's cells that glint independently; default: from the correlation time"),
    ] = None


class Sea(Record):
    """The water and its shape."""

    temperature_k: Annotated[float, Quantity("K", ge=260, le=320), Field(description="skin temperature of the sea")] = 288.15
    water: Annotated[Literal["hale-querry-sea", "segelstein", "article"], Field(description="table of the complex refractive index")] = (
        "hale-querry-sea"
    )
    resolve_waves: Annotated[
        StrictBool, Field(description="true: long waves are geometry; false: all slopes are facet density, the mean picture")
    ] = True
    shortest_wave_m: Annotated[
        float,
        Quantity("m", ge=0.02, le=1000),
        Field(description="length of the shortest wave that is geometry; shorter ones are facet density"),
    ] = 2.0
    slopes: Annotated[Slopes, Field(description="slope statistics of the whole sea")] = CoxMunkAnisotropic()
    spectrum: Annotated[Spectrum, Field(description="spectrum of the waves that are geometry")] = Elfouhaily()
    glint: Annotated[Glint, Field(description="correlation of glint")] = Glint()
