"""Scenarios as text and pictures: TOML files, templates, and HTML for notebooks."""
