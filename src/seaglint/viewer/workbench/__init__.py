"""Scenario workbench: a form, and pictures of its scenario."""

from __future__ import annotations

from pathlib import Path


def page(path: str | Path | None = None) -> None:
    """Fill the current page with the workbench of a scenario file, or of a preset that is chosen on it."""
    from seaglint.viewer.workbench.bench import fill  # NiceGUI takes a second, and the process of the pictures needs none

    fill(path)
