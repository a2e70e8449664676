"""Table ``[dataset]`` of an ensemble's file: what a labelled data set of it is called, and how its scenes are split."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record, rule

_Fraction = Annotated[float, Quantity(ge=0, le=1)]
_Name = Annotated[str, Field(min_length=1, max_length=100)]


class Dataset(Record):
    """Description of a labelled data set of the ensemble."""

    title: Annotated[str | None, Field(description="title of the data card; default: the file's name")] = None
    description: Annotated[str, Field(description="what the data set is for, in the data card")] = ""
    licence: Annotated[str | None, Field(description="licence of the pictures and labels; default: CC-BY-4.0")] = None
    split: Annotated[
        tuple[_Fraction, _Fraction, _Fraction], Field(description="shares of the scenes that train, validate and test; 1 in all")
    ] = (0.7, 0.15, 0.15)
    classes: Annotated[
        dict[_Name, _Name],
        Field(
            description="category of objects by their name, or by that of the template that drew them; else their preset or kind of shape"
        ),
    ] = {}  # noqa: RUF012 (pydantic copies it)

    @model_validator(mode="after")
    def _is_a_whole(self) -> Self:
        total = math.fsum(self.split)
        if abs(total - 1.0) > 1e-6:
            given = ", ".join(f"{fraction:g}" for fraction in self.split)
            text = f"= [{given}] adds up to {total:g}; give shares of training, validation and test that add up to 1"
            raise rule("split", text, value=self.split)
        return self
