"""Requests for textures: to fit one to a recording, to compare two, to sample one, and to lay it on the sea of a scenario.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from seaglint.base.parameters import Parameter, documented
from seaglint.studies.reading_requests import Overwrite

Seed = Annotated[int, Parameter("of the random numbers: the same seed gives the same bytes", least=0)]  #: Seed of fits and samples.


@documented()
@dataclass(frozen=True)
class FitRequest:
    """Request to fit a texture.

    Parameters
    ----------
    {request}
    """

    model: Annotated[Literal["autobinomial", "gauss-markov"], Parameter("field of the texture")] = "gauss-markov"
    tails: Annotated[
        Literal["gaussian", "gamma", "lognormal", "k", "empirical"], Parameter("distribution of the pixels (gauss-markov)")
    ] = "gaussian"
    region: Annotated[str | None, Parameter("part of the picture in pixels, e.g. 120:248,64:192", metavar="ROWS,COLUMNS")] = None
    any_region: Annotated[bool, Parameter("fit also where the picture is not stationary")] = False
    detrend: Annotated[bool, Parameter("take slow changes of mean and contrast off first")] = False
    product: Annotated[
        bool | None,
        Parameter(
            "multiply fine structure by a slow gamma field where the tails ask for it, always or never",
            form="switch",
            python="Multiply fine structure by a slow gamma field; None where the tails decide.",
        ),
    ] = None
    order: Annotated[int, Parameter("order of the neighbourhood (autobinomial)", least=1)] = 2
    isotropic: Annotated[bool, Parameter("one weight for each distance (autobinomial)")] = False
    levels: Annotated[int, Parameter("grey levels (autobinomial)", least=2)] = 16
    method: Annotated[
        Literal["auto", "pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"],
        Parameter("how it is fitted (autobinomial); auto: as its regime asks for"),
    ] = "auto"
    keep_histogram: Annotated[bool, Parameter("draw samples with exactly the picture's histogram (autobinomial)")] = False
    seed: Seed = 0
    overwrite: Overwrite = False


@documented()
@dataclass(frozen=True)
class CompareRequest:
    """Request to compare two textures.

    Parameters
    ----------
    {request}
    """

    regions: Annotated[
        tuple[str, ...],
        Parameter(
            "part of A; given twice, of A and of B",
            metavar="ROWS,COLUMNS",
            option="--region",
            python="Part of the first, and of the second.",
        ),
    ] = ()
    seed: Seed = 0
    overwrite: Overwrite = False


@documented()
@dataclass(frozen=True)
class SampleRequest:
    """Request to sample a texture, periodic in rows, columns and time.

    Parameters
    ----------
    {request}
    """

    size: Annotated[
        tuple[int, int],
        Parameter("of the picture, e.g. 512x512", form="size", metavar="COLUMNSxROWS", python="Columns and rows of the picture."),
    ] = (512, 512)
    frames: Annotated[int, Parameter("of the loop: the frame after the last is the first", least=1)] = 1
    seed: Seed = 0
    overwrite: Overwrite = False


@documented()
@dataclass(frozen=True)
class PlaceRequest:
    """Request to lay a texture on the sea of a scenario; the loop is as long as the scenario.

    Parameters
    ----------
    {request}
    """

    frames: Annotated[range | None, Parameter("frames to write", form="frames", detail="All of the scenario by default.")] = None
    size: Annotated[
        tuple[int, int],
        Parameter(
            "of the periodic field on the sea",
            form="size",
            metavar="COLUMNSxROWS",
            python="Columns and rows of the periodic field on the sea.",
        ),
    ] = (512, 512)
    cell: Annotated[
        tuple[float, float] | None,
        Parameter("of its pixels along and across the range in metres; nearest footprint", metavar="LENGTH WIDTH"),
    ] = None
    contrast: Annotated[
        Literal["auto", "glint", "model"],
        Parameter(
            "standard deviation of glint in the mean map, or of the model; auto: glint where there is any",
            detail="Glint also has the mean of that map; model has the texture's ratio to the mean, averaged over the footprint, of all "
            "that comes from the sea.",
        ),
    ] = "auto"
    seed: Annotated[int | None, Parameter("of the field; default: the scenario's", least=0)] = None
    overwrite: Overwrite = False
