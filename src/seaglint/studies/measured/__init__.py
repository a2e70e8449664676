"""Measured spectra of sky and sea, and outputs of other models, beside ours."""
