"""Mean radiance of the sea from slope statistics."""
