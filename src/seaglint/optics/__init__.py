"""What matter does to light: blackbodies, bands, the index of sea water, Fresnel reflection."""
