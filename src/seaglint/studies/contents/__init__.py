"""Descriptions of files: sequences, maps, scenarios and recordings."""
