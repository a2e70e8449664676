"""Presets of scenes, sensors and objects, each with the source of its numbers."""
