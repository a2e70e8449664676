"""Request to fit a texture to a recording.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from seaglint.base.parameters import Parameter


@dataclass(frozen=True)
class FitRequest:
    """Request to fit a texture.

    ``product`` is None where the tails decide, else whether a slow field multiplies the fast one.
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
        Parameter("multiply fine structure by a slow gamma field where the tails ask for it, always or never", form="switch"),
    ] = None
    order: Annotated[int, Parameter("order of the neighbourhood (autobinomial)", least=1)] = 2
    isotropic: Annotated[bool, Parameter("one weight for each distance (autobinomial)")] = False
    levels: Annotated[int, Parameter("grey levels (autobinomial)", least=2)] = 16
    method: Annotated[
        Literal["auto", "pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"],
        Parameter("how it is fitted (autobinomial); auto: as its regime asks for"),
    ] = "auto"
    keep_histogram: Annotated[bool, Parameter("draw samples with exactly the picture's histogram (autobinomial)")] = False
    seed: Annotated[int, Parameter("of the random numbers: the same seed gives the same bytes", least=0)] = 0
