"""Soundings of the air: readers of their formats, and checks of their content."""
