"""Blackbodies, bands, the refractive index of sea water, Fresnel reflection and foam."""
