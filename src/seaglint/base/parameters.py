"""Description of a parameter of a request, from which the command line makes an option and Python a keyword."""

from __future__ import annotations

from typing import Final, NamedTuple

GROUPS: Final = ("Object", "Detector", "Recording", "Scenes", "Design", "Range", "Results", "Run")
"""Headings of the parameters of requests, in the order of a help page."""


class Parameter(NamedTuple):
    """Description of one parameter, beside its type and default in a record.

    Attributes
    ----------
    help : str
        Meaning with unit, in a line; other parameters stand in backticks.
    group : str
        Heading under which a help page has it, one of :data:`GROUPS`.
    form : str
        Form of the text that stands for it on a command line: "numbers" (``1,2,4`` or ``FIRST:LAST:STEP``), "pair" (``X,Y``), "limits"
        (``NEAR:FAR``), "weights" (file of numbers), "raw" (layout of a raw file); empty where the type says it.
    metavar : str
        Stand-in for the value on a help page; the type's own where empty.
    least : int, optional
        Smallest value allowed.
    """

    help: str
    group: str
    form: str = ""
    metavar: str = ""
    least: int | None = None
