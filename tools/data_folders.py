"""Folders of data that are not in the repository: named by environment variables, or found beside the repository.

    python tools/data_folders.py    prints them

Beside the repository means ``../shared/reference`` and ``../shared/data``. Variables go before.
"""

from __future__ import annotations

import os
from pathlib import Path

BESIDE = Path(__file__).resolve().parents[2] / "shared"

FOLDERS = {"SEAGLINT_REFERENCE_DIR": ("reference", "reference tables"), "SEAGLINT_DATA_DIR": ("data", "measured waves and imagery")}
"""Variable: its folder in ``../shared``, and what is in it."""


def data_folder(variable: str) -> Path | None:
    """Return the folder that a variable names, else the one beside the repository, else nothing.

    A folder that a variable names need not exist: a mistyped name must not be replaced silently.
    """
    if value := os.environ.get(variable):
        return Path(value)
    beside = BESIDE / FOLDERS[variable][0]
    return beside if beside.is_dir() else None


def name_folders() -> None:
    """Set the variables of folders that lie beside the repository, for what reads variables and for child processes."""
    for variable in FOLDERS:
        if folder := data_folder(variable):
            os.environ[variable] = str(folder)


if __name__ == "__main__":
    for variable, (_, content) in FOLDERS.items():
        print(f"{content}: {data_folder(variable) or f'none ({variable} names no folder)'}")
