"""Consolidated metadata of all arrays of a Zarr store, which readers look for first."""

from __future__ import annotations

import warnings
from pathlib import Path


def consolidate(store: Path | str) -> None:
    """Copy the arrays' metadata into the store's own: ``xarray.open_zarr`` then reads one file and does not warn."""
    import zarr

    with warnings.catch_warnings():
        # Zarr 3 calls this an extension of its format; readers that do not know it pass it over.
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        zarr.consolidate_metadata(store, zarr_format=3)
