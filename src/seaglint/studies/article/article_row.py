"""A number of the source article beside ours."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

from seaglint.base.free_form import JsonObject


@dataclass(frozen=True)
class ArticleRow:
    """Number of the source article beside ours.

    Attributes
    ----------
    article, ours : float or None
        Both values; None where one does not exist.
    unit : str
        Their unit.
    settings : JsonObject
        Settings and conditions, plain numbers and text by name.
    """

    article: float | None
    ours: float | None
    unit: str
    settings: JsonObject = field(default_factory=dict)

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)
