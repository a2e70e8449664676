"""Sequences of images of a scenario: radiance, and counts of its sensor."""
