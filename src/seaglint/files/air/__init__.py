"""Files of transmittance and radiance that serve as an atmosphere."""
