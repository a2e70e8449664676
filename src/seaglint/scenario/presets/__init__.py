"""Scenes, sensors and objects to begin with, each with where its numbers come from."""
