"""Infrared ocean clutter: what an infrared sensor sees when it looks at the sea."""

__version__ = "0.1.0"
