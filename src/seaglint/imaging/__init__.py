"""Images of a wavy sea: camera, the sweep over the wave field."""
