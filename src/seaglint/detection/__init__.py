"""Detectors to judge by their false alarms: frames in, a statistic per pixel out."""
