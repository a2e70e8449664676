"""Foundations of all rooms: constants, errors, ranges, units, random numbers, compiled kernels and threads."""
