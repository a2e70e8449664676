"""Inventories of other projects' documentation, cut to the names that the reference links to, so that a build needs no network.

    python tools/inventories.py                          write docs/_inventories from the names below
    python tools/inventories.py numpy objects.inv        take the addresses of these names from a project's own inventory

A name that a build reports as unknown is added to ``NAMES`` with its place in the project's documentation.
"""

from __future__ import annotations

import sys
import zlib
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "_inventories"

NAMES: dict[str, dict[str, str]] = {
    "python": {
        "None py:data": "library/constants.html#None",
        "bool py:class": "library/functions.html#bool",
        "collections.abc.Callable py:class": "library/collections.abc.html#collections.abc.Callable",
        "collections.abc.Iterator py:class": "library/collections.abc.html#collections.abc.Iterator",
        "collections.abc.Mapping py:class": "library/collections.abc.html#collections.abc.Mapping",
        "collections.abc.Sequence py:class": "library/collections.abc.html#collections.abc.Sequence",
        "datetime.datetime py:class": "library/datetime.html#datetime.datetime",
        "dict py:class": "library/stdtypes.html#dict",
        "float py:class": "library/functions.html#float",
        "int py:class": "library/functions.html#int",
        "list py:class": "library/stdtypes.html#list",
        "pathlib.Path py:class": "library/pathlib.html#pathlib.Path",
        "range py:class": "library/stdtypes.html#range",
        "str py:class": "library/stdtypes.html#str",
        "tuple py:class": "library/stdtypes.html#tuple",
    },
    "numpy": {
        "numpy.ndarray py:class": "reference/generated/numpy.ndarray.html#numpy.ndarray",
        "numpy.typing.ArrayLike py:data": "reference/typing.html#numpy.typing.ArrayLike",
    },
    "xarray": {
        "xarray.DataArray py:class": "generated/xarray.DataArray.html#xarray.DataArray",
        "xarray.Dataset py:class": "generated/xarray.Dataset.html#xarray.Dataset",
    },
}
"""Places in the documentation of each project by name and kind."""


def places_in(inventory: bytes) -> dict[str, str]:
    """Return the places of an inventory by name and kind."""
    *_, packed = inventory.split(b"\n", 4)
    result = {}
    for line in zlib.decompress(packed).decode().splitlines():
        name, kind, _, place, _ = line.rsplit(" ", 4)
        result[f"{name} {kind}"] = place.replace("$", name)
    return result


def inventory_of(project: str, places: dict[str, str]) -> bytes:
    """Return an inventory in version 2 of Sphinx's format."""
    head = f"# Sphinx inventory version 2\n# Project: {project}\n# Version: \n# The remainder of this file is compressed using zlib.\n"
    lines = (f"{name} 1 {place} -\n" for name, place in sorted(places.items()))
    return head.encode() + zlib.compress("".join(lines).encode(), 9)


def main(arguments: list[str]) -> None:
    """Write the inventories."""
    projects = arguments[:1] or list(NAMES)
    for project in projects:
        places = NAMES[project]
        if arguments:
            given = places_in(Path(arguments[1]).read_bytes())
            missing = sorted(set(places) - set(given))
            if missing:
                raise SystemExit(f"{arguments[1]} has no {', '.join(missing)}; correct these names in NAMES")
            places = {name: given[name] for name in places}
        (FOLDER / f"{project}.inv").write_bytes(inventory_of(project, places))


if __name__ == "__main__":
    main(sys.argv[1:])
