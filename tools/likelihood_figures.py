"""Make the figure of three sea regions of the guide to the likelihood of glint: ``python tools/likelihood_figures.py docs/images``."""

from __future__ import annotations

import sys
from pathlib import Path

from seaglint.plot.environment_charts import write_regions
from seaglint.studies.likelihood.chance_map import regions


def main(folder: Path) -> None:
    """Compute, draw and print the numbers."""
    found = regions()
    write_regions(found, folder / "likelihood_regions.png")
    for name, columns in found.items():
        print(name, *(f"{t:g}: {p:.4f}" for t, p in zip(columns["threshold"], columns["probability"], strict=True)))
        print("  by month", *(f"{p:.4f}" for p in columns["by_month"]))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images"))
