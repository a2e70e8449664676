"""Clutter statistics and false alarms of a recording, read in blocks: survey, segmentation, counting."""

from seaglint.analysis.analyze_recording import Analysis, AnalysisOptions, analyze
from seaglint.analysis.recording import Recording
from seaglint.analysis.region import Region

__all__ = ["Analysis", "AnalysisOptions", "Recording", "Region", "analyze"]
