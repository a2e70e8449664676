"""Sensor from the radiance at the aperture to the detector's signal: optics, detector, scan, noise."""
