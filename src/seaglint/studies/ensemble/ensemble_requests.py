"""Requests for many scenes: to render an ensemble, and to write a data set of its pictures.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from seaglint.base.parameters import Parameter
from seaglint.studies.study_requests import WorkRequest, require_sea_draws

if TYPE_CHECKING:
    from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions


@dataclass(frozen=True)
class ScenesRequest(WorkRequest):
    """Parameters of the rendering of many scenes."""

    threads: Annotated[
        int | None, Parameter("processor threads of each process; default: all", "Run", least=1, detail="The bytes do not depend on them.")
    ] = None


@dataclass(frozen=True)
class EnsembleRequest(ScenesRequest):
    """Request to draw scenes from laws of a scenario's keys, and to render them."""

    resume: Annotated[bool, Parameter("render the scenes that are missing", "Run")] = False
    draw_only: Annotated[bool, Parameter("write scenario files and tables, and render nothing")] = False
    sea_draws: Annotated[
        int | None,
        Parameter(
            "table sea_unknown.csv of mean radiance, brightest pixel and standard deviation of glint of each scene, with the interval 'sea "
            "unknown': 5 to 95 % of N seas between two measured campaigns and Elfouhaily's model",
            metavar="N",
            detail="Scenes are rendered with their own sea; drawn seas have the slopes of their waves, whatever ``sea.slopes`` says.",
        ),
    ] = None

    def __post_init__(self) -> None:
        """Refuse numbers that are not allowed."""
        require_sea_draws(self.sea_draws)


@dataclass(frozen=True)
class DatasetRequest(ScenesRequest):
    """Request to write labelled pictures of an ensemble."""

    resume: Annotated[bool, Parameter("go on with an unfinished data set", "Run")] = False
    format: Annotated[str, Parameter("{formats}")] = "coco"
    bits: Annotated[
        int | str | None,
        Parameter("8, 16 or both: bits of a pixel; default: 8", form="name", detail="Both: folders that end in 16 beside those of 8."),
    ] = None
    image: Annotated[str | None, Parameter("png or tiff; default: png")] = None
    scale: Annotated[
        str | None, Parameter("frames that share a relation of level and radiance in 8 bits: scene or frame; default: scene")
    ] = None
    limits: Annotated[
        tuple[float, float] | None,
        Parameter(
            "counts of levels 0 and 255 in all pictures, or radiance where there is no detector; default: those of `scale`",
            metavar="LOW HIGH",
            option="--range",
        ),
    ] = None
    clip: Annotated[float | None, Parameter("share of pixels clipped at each end of the range of 8 bits [%]; default: 0")] = None
    masks: Annotated[
        str, Parameter("masks and boxes: response, of an object after the optics, or geometric: pixels that it touches at the aperture")
    ] = "response"
    min_snr: Annotated[
        float | None,
        Parameter(
            "signal-to-noise ratio below which objects are marked ignore; default: dataset.min_snr of the ensemble, else 1", least=0.0
        ),
    ] = None

    def options(self) -> DatasetOptions:
        """Return the checked format and pictures of the data set."""
        from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions

        pictures = {"scale": self.scale, "limits": self.limits, "clip": self.clip}
        return DatasetOptions.of(self.format, self.bits, self.image, masks=self.masks, min_snr=self.min_snr, **pictures)
