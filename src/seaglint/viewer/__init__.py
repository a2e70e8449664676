"""Viewer of sequences, maps, recordings and scenarios in a browser: ``seaglint view``."""
