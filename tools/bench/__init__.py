"""Benchmarks: frame times, memory, a profile, and the same sea rendered by Mitsuba 3. Run them with ``./run bench``."""
