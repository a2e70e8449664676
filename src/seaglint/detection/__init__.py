"""Detectors to judge: frames in, a statistic per pixel out, all counted by the same false-alarm bookkeeping."""
