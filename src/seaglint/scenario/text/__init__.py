"""Scenarios as text and pictures: TOML files, templates, and what notebooks show."""
