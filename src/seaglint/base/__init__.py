"""What every room stands on: constants, errors, ranges, units, random numbers, compiled kernels and threads."""
