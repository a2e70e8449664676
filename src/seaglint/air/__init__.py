"""Air between the sea and the sensor: transmittance, path radiance, sunlight at the sea and thermal sky."""
