"""Requests for sequences: to render one, to put a sensor on recorded radiance, and to write frames for another program.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from seaglint.base.parameters import Parameter
from seaglint.studies.reading_requests import Overwrite, ReadingRequest, WorkRequest


@dataclass(frozen=True)
class RenderRequest(WorkRequest):
    """Request to render the frames of a scenario into a store."""

    frames: Annotated[
        range | None, Parameter("frames to render", form="frames", detail="Counted from 0; all of the scenario's by default.")
    ] = None
    electrons: Annotated[bool, Parameter("with a detector: write electrons beside counts")] = False
    radiance: Annotated[
        bool, Parameter("with a detector: write radiance at the aperture beside counts", detail="It is averaged over pixels.")
    ] = False


@dataclass(frozen=True)
class SenseRequest(ReadingRequest, WorkRequest):
    """Request to put a scenario's sensor on radiance at the aperture."""

    seed: Annotated[int | None, Parameter("of the noise; default: the scenario's", least=0)] = None
    oversampling: Annotated[
        int | None,
        Parameter(
            "pixels of INPUT along each side of the detector's; told by our own files",
            least=1,
            detail="Found from the coordinates of a dataset, else 1.",
        ),
    ] = None
    electrons: Annotated[bool, Parameter("write electrons beside counts")] = False


@dataclass(frozen=True)
class ExportRequest:
    """Request to write frames of a run for another program."""

    variable: Annotated[str | None, Parameter("images to export; signal if there, else radiance")] = None
    frames: Annotated[range | None, Parameter("frames to export", form="every", detail="Counted in the whole sequence.")] = None
    dtype: Annotated[Literal["uint16", "float32"] | None, Parameter("type of the numbers; default: as stored (not of {videos})")] = None
    limits: Annotated[
        tuple[float, float] | None,
        Parameter(
            "values of the first and last count of uint16, or of black and white",
            metavar="LOW HIGH",
            option="--range",
            detail="Those of the frames by default.",
        ),
    ] = None
    colours: Annotated[
        Literal["white-hot", "black-hot", "perceptual"] | None, Parameter("colours of {videos}; white-hot", option="--map")
    ] = None
    rate: Annotated[float | None, Parameter("frames per second shown by {videos}; those of the run", option="--fps")] = None
    scale: Annotated[Literal["auto", "linear", "log"] | None, Parameter("brightness of {videos}; auto")] = None
    overwrite: Overwrite = False
