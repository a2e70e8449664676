"""Tables of measurements and of other models' outputs that come with the package."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray


class ShippedTable(NamedTuple):
    """Columns of numbers by name, and the facts of the lines before them: source, terms, processing."""

    columns: dict[str, FloatArray]
    facts: dict[str, str]


@cache
def shipped(name: str) -> ShippedTable:
    """Return the table ``measured_<name>.csv`` of the package.

    Examples
    --------
    >>> shipped("modtran_path").facts["terms"]
    'MIT licence of pyradi'
    """
    lines = files("seaglint.studies").joinpath("data", f"measured_{name}.csv").read_text(encoding="utf-8").splitlines()
    facts = dict(line.removeprefix("# ").split(": ", 1) for line in lines if line.startswith("#"))
    head, *rows = (line for line in lines if not line.startswith("#"))
    numbers = np.loadtxt(rows, delimiter=",", ndmin=2)
    return ShippedTable(dict(zip(head.split(","), numbers.T, strict=True)), facts)
