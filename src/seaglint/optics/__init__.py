"""Blackbodies, bands, light of Sun and Moon, the refractive index of sea water, Fresnel reflection and foam."""
