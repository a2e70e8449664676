"""Blackbodies, bands, the refractive index of sea water and Fresnel reflection."""
