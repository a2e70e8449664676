"""Scenarios: one TOML file, read and validated."""
