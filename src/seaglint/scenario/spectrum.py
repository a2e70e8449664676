"""Table ``[sea.spectrum]``: kinds of wave spectra, one record each."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from seaglint.scenario.record import InputFile, Record, Utc, default_tag


class Elfouhaily(Record):
    """Elfouhaily et al. 1997, fully developed, at the scenario's wind."""

    kind: Literal["elfouhaily"] = "elfouhaily"


class PiersonMoskowitz(Record):
    """Pierson and Moskowitz 1964, at the scenario's wind."""

    kind: Literal["pierson-moskowitz"] = "pierson-moskowitz"


class SpectrumFile(Record):
    """A measured directional spectrum (NDBC buoy files)."""

    kind: Literal["file"] = "file"
    path: Annotated[
        InputFile, Field(description="one of a buoy's NDBC files, e.g. 41010.data_spec; its .swdir, .swdir2, .swr1, .swr2 lie beside it")
    ]
    time: Annotated[Utc | None, Field(description="UTC time of the record wanted; that of [time] where nothing is said")] = None


class FlatSea(Record):
    """No waves."""

    kind: Literal["flat"] = "flat"


Spectrum = Annotated[
    Annotated[Elfouhaily | PiersonMoskowitz | SpectrumFile | FlatSea, Field(discriminator="kind")], default_tag("kind", "elfouhaily")
]
