"""Detectors and their evaluation: frames in, a statistic per pixel out, all counted by the same false-alarm accumulator."""
