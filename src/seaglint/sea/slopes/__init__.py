"""Slope statistics of the sea against wind speed: one model per file."""
