"""Named arrays of one case of a sweep."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from seaglint.base.free_form import Attributes


@dataclass(frozen=True, eq=False)
class NamedArray:
    """Array with the names of its dimensions and its attributes."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attributes: Attributes = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class CaseResult:
    """Result of one case."""

    #: ``variables``, ``coordinates``: Arrays by name.
    variables: dict[str, NamedArray]
    coordinates: dict[str, NamedArray] = field(default_factory=dict)
    attributes: Attributes = field(default_factory=dict)  #: Attributes of the whole.

    @property
    def size(self) -> int:
        """Bytes of all arrays."""
        return sum(array.values.nbytes for arrays in (self.variables, self.coordinates) for array in arrays.values())
