"""What is between the radiance at the aperture and the detector's signal: optics, detector, scan, noise."""
