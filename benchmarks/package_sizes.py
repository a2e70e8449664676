"""Print the packages and the megabytes that the base needs, and those that each extra adds to it.

``python benchmarks/package_sizes.py`` reads the metadata of what is installed beside it, so that every extra to be counted has to be
installed (``./run install``); one that is not is named with the package that is missing. Compiled bytes (``__pycache__``) are left out.
"""

from __future__ import annotations

from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name


def needed(name: str, extras: frozenset[str] = frozenset(), known: dict[str, Distribution] | None = None) -> dict[str, Distribution]:
    """Return the packages that ``name`` with these extras needs, itself included, however indirectly."""
    known = {} if known is None else known
    todo, seen = [(canonicalize_name(name), extras)], set()
    while todo:
        package, wanted = todo.pop()
        if (package, wanted) in seen:
            continue
        seen.add((package, wanted))
        known[package] = distribution(package)
        for line in known[package].requires or ():
            requirement = Requirement(line)
            markers = [requirement.marker.evaluate({"extra": extra}) for extra in (wanted or {""})] if requirement.marker else [True]
            if any(markers):
                todo.append((canonicalize_name(requirement.name), frozenset(requirement.extras)))
    return known


def megabytes(package: Distribution) -> float:
    """Return the size of a package's files on disk [MB]."""
    files = (Path(str(package.locate_file(path))) for path in package.files or () if "__pycache__" not in path.parts)
    return sum(file.stat().st_size for file in files if file.is_file()) / 1e6


def main() -> None:
    """Print the table."""
    base = needed("seaglint")
    del base["seaglint"]
    print("| extra | packages | MB | largest |\n| --- | --- | --- | --- |")
    rows = {"base": base}
    for extra in distribution("seaglint").metadata.get_all("Provides-Extra", []):
        try:
            rows[f"`{extra}`"] = {k: v for k, v in needed("seaglint", frozenset({extra})).items() if k not in base and k != "seaglint"}
        except PackageNotFoundError as missing:
            print(f"| `{extra}` | not installed: {missing.name} | | |")
    for name, packages in rows.items():
        sizes = {package: megabytes(found) for package, found in packages.items()}
        largest = sorted(sizes, key=sizes.__getitem__, reverse=True)[:3]
        print(f"| {name} | {len(sizes)} | {sum(sizes.values()):.0f} | {', '.join(f'{p} {sizes[p]:.0f}' for p in largest)} |")


if __name__ == "__main__":
    main()
