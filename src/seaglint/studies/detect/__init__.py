"""Probabilities of detection and false alarm, on recordings and in rendered scenes."""
