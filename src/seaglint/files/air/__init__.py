"""Files of transmittance and radiance as an atmosphere."""
