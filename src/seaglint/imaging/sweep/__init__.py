"""The sweep along each azimuth over the wave field, which makes an image of it."""
