"""Results of a table of cases as a labelled dataset, with bands as an axis."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.files.tables.cases import Cases
from seaglint.studies.mean.evaluate_cases import Columns

if TYPE_CHECKING:
    import xarray as xr

#: Units by the ending of a column's name, longer endings first.
UNITS: Final = {"_W_m2_sr": "W m-2 sr-1", "_W_m2": "W m-2", "_K": "K", "_k": "K", "_deg": "degree", "_m_s": "m s-1", "_um": "um", "_m": "m"}

SHARES: Final = ("emissivity", "tau_mean")  #: Columns without a unit.


def labelled_cases(cases: Cases, results: Columns) -> xr.Dataset:
    """Return cases and their results over ``case``; columns ``name[band]`` become ``name`` over ``case`` and ``band``.

    Parameters
    ----------
    cases : Cases
        The cases.
    results : mapping
        Columns by name, as :mod:`seaglint.studies.mean.evaluate_cases` gives them.
    """
    import xarray as xr

    parts: dict[str, dict[str, Any]] = {}
    variables: dict[str, Any] = {name: ("case", _plain(cases.text(name)), _about(name)) for name in cases.header}
    for name, values in results.items():
        match = re.fullmatch(r"(.+)\[(.+)\]", name)
        if match:
            parts.setdefault(match[1], {})[match[2]] = values
        else:
            variables[name] = ("case", np.asarray(values), _about(name))
    labels = list(next(iter(parts.values()), {}))
    variables |= {
        name: (("case", "band"), np.stack([columns[label] for label in labels], axis=-1), _about(name)) for name, columns in parts.items()
    }
    return xr.Dataset(variables, {"band": ("band", labels, {"units": "um"})} if labels else {})


def _plain(cells: list[str]) -> Any:
    """Return cells as numbers where all are numbers, else as text."""
    try:
        return np.array(cells, np.float64)
    except ValueError:
        return np.array(cells)


def _about(name: str) -> dict[str, str]:
    """Return the attributes of a column, its units by the ending of the name."""
    unit = "1" if name in SHARES else next((unit for ending, unit in UNITS.items() if name.endswith(ending)), None)
    return {} if unit is None else {"units": unit}
