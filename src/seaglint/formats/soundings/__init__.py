"""Soundings of the air: readers of their formats, and what they are checked for."""
