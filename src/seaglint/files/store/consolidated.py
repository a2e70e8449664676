"""Metadata of all arrays of a Zarr store in one place, where readers look first."""

from __future__ import annotations

import warnings
from pathlib import Path


def consolidate(store: Path | str) -> None:
    """Repeat the arrays' metadata in the store's own: ``xarray.open_zarr`` then reads one file and warns of nothing."""
    import zarr

    with warnings.catch_warnings():
        # Zarr 3 calls this an extension of its format; readers that do not know it pass it over.
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        zarr.consolidate_metadata(store, zarr_format=3)
