"""Mean and variance of the sea's radiance from slope statistics."""
