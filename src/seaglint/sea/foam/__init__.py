"""Foam of breaking waves: coverage against wind speed, and the crests that leave it."""
