"""Clutter statistics and false alarms of a recording, read in blocks: survey, segmentation, counting."""

from seaglint.analysis.recording import Recording
from seaglint.analysis.region import Region
from seaglint.analysis.run import Analysis, AnalysisOptions, analyze

__all__ = ["Analysis", "AnalysisOptions", "Recording", "Region", "analyze"]
