"""Clutter statistics and false alarms of a recording, streamed: survey it, segment it, count it."""

from seaglint.pipeline.analysis.run import Analysis, Options, analyze

__all__ = ["Analysis", "Options", "analyze"]
