"""Cameras: the image grid, lines of sight in any attitude, and poses of a moving sensor."""
