"""Table ``[mean]``: how the mean radiance is computed."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from seaglint.scenario.record import Record, rule


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
        Literal["both", "viewer", "nested"] | None,
        Field(
            description="legs that waves shadow: both (viewer and Sun, Smith's law), viewer alone, or nested (the viewer's leg wave band "
            "by wave band, for Gaussian slopes; the Sun's by Smith); both where nothing is said, viewer in the mode article"
        ),
    ] = None

    @model_validator(mode="after")
    def _article_shadows_the_viewer(self) -> Self:
        if self.mode == "article" and self.shadowing not in (None, "viewer"):
            text = "shadows the viewer's leg alone; leave it out or set mean.mode = 'spectral'"
            raise rule("mean.shadowing", f"= '{self.shadowing}' with mean.mode = 'article', which {text}")
        return self
