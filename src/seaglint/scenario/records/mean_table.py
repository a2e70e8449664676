"""Table ``[mean]``: how the mean radiance is computed."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from seaglint.scenario.records.record import Record, rule


class Mean(Record):
    """How the mean radiance is computed."""

    mode: Annotated[
        Literal["spectral", "article"],
        Field(
            description="spectral: per wavenumber, sky and sea apart; article: band means, isotropic slopes at the wind as given, "
            "sky and sea one blackbody, as in the source article"
        ),
    ] = "spectral"
    shadowing: Annotated[
        Literal["nested", "both", "viewer"] | None,
        Field(
            description="legs that waves shadow: nested (viewer and Sun, wave band by wave band), both (the same by Smith's law, too "
            "bright near the horizon under a low Sun), or viewer (alone, Saunders' law); default: nested, viewer in the "
            "mode article"
        ),
    ] = None

    @model_validator(mode="after")
    def _article_shadows_the_viewer(self) -> Self:
        if self.mode == "article" and self.shadowing not in (None, "viewer"):
            text = "shadows the viewer's leg alone; leave it out or set mean.mode = 'spectral'"
            raise rule("mean.shadowing", f"= '{self.shadowing}' with mean.mode = 'article', which {text}")
        return self
