"""Files and their provenance."""
