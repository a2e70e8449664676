"""Pictures with axes, units and scales."""
