"""Image sequences on disk: a Zarr store, whole or plainly unfinished, that one process writes or many."""
