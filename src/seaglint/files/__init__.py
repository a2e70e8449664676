"""Files, and where they came from."""
