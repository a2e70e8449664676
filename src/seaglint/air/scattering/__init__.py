"""Sunlight that the air scatters, once, into paths and sky."""
