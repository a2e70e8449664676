"""A number of the source article beside ours."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

from seaglint.base.free_form import JsonObject


@dataclass(frozen=True)
class ArticleRow:
    """Number of the source article beside ours."""

    #: ``article``, ``ours``: Both values; None where one does not exist.
    article: float | None
    ours: float | None
    unit: str  #: Their unit.
    settings: JsonObject = field(default_factory=dict)  #: Settings and conditions, plain numbers and text by name.

    @property
    def numbers(self) -> dict[str, float | None]:
        """Return the values by the heads of their columns."""
        return {"article": self.article, "ours": self.ours}

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)


@dataclass(frozen=True)
class SensedRow(ArticleRow):
    """Number of the source article beside ours of pictures as rendered (``ours``) and of the same pictures through a detector."""

    through_detector: float | None = None  #: Value of the pictures through the detector; None where it does not exist.

    @property
    def numbers(self) -> dict[str, float | None]:
        """Return the values by the heads of their columns."""
        return {"article": self.article, "as rendered": self.ours, "detector": self.through_detector}
