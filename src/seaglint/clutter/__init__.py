"""Statistics of clutter: moments, distributions, correlation, segmentation, false alarms. Arrays in, numbers out."""
