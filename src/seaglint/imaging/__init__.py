"""Images of a wavy sea: camera, facets, the sweep over the wave field."""
