"""Sweeps: one quantity over every combination of some values of a scenario's keys."""
