"""Which of the two ways of light, to the viewer and from the Sun, waves shadow, and by which law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

from seaglint.errors import DomainError
from seaglint.sea.nested import BANDS
from seaglint.sea.slopes import SlopeStatistics

Law = Literal["smith", "nested"]
"""Smith's law (Saunders' for the viewer alone), or the same wave band by wave band (:mod:`seaglint.sea.nested`)."""


@dataclass(frozen=True)
class Shadowing:
    """Legs that waves shadow, and how. The constants of this module and :meth:`of` name the usual ones.

    Attributes
    ----------
    law : {"smith", "nested"}
        Law of the viewer's leg; the Sun's is Smith's in both.
    sun : bool
        Whether the Sun's leg is shadowed too; the source article shadows the viewer's alone.
    bands : int
        Bands of equal slope variance of the nested law; 1 is Smith's. Facets of images have them whatever the law of mean maps.
    """

    law: Law = "smith"
    sun: bool = True
    bands: int = BANDS

    @classmethod
    def of(cls, word: str, bands: int = BANDS) -> Shadowing:
        """By the word of scenario files.

        Raises
        ------
        DomainError
            For an unknown word.

        >>> Shadowing.of("viewer").sun
        False
        """
        if word not in _WORDS:
            raise DomainError(f"shadowing = {word!r} is unknown; choose {', '.join(map(repr, _WORDS))}")
        return replace(_WORDS[word], bands=bands)

    @property
    def word(self) -> str:
        """The word of :meth:`of`."""
        return next(word for word, known in _WORDS.items() if (known.law, known.sun) == (self.law, self.sun))

    @property
    def law_bands(self) -> int:
        """Bands of the law: 1 for Smith's."""
        return self.bands if self.law == "nested" else 1

    def require(self, slopes: SlopeStatistics) -> None:
        """Refuse slopes that the law does not cover.

        Raises
        ------
        DomainError
            The nested law for slopes that are not Gaussian.
        """
        if self.law == "nested" and not slopes.is_gaussian:
            raise DomainError(
                f"shadowing = {self.word!r} needs Gaussian slopes and these have Gram-Charlier coefficients; "
                "choose shadowing = 'both' or a Gaussian slope model such as cox-munk-anisotropic"
            )


BOTH: Final = Shadowing()
VIEWER: Final = Shadowing(sun=False)
NESTED: Final = Shadowing("nested")
NESTED_VIEWER: Final = Shadowing("nested", sun=False)

_WORDS: Final = {"both": BOTH, "viewer": VIEWER, "nested": NESTED, "nested-viewer": NESTED_VIEWER}
