"""Labelled data sets for detectors: pictures with a scale, masks, boxes and tables, in the layouts that training programs read."""
