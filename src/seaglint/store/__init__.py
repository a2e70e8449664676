"""Image sequences on disk: a Zarr store, complete or marked as unfinished, written by one process or several."""
