"""Transmittance, path radiance, sunlight and sky between the sea and a sensor."""
