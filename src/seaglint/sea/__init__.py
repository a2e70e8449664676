"""The sea surface: wind, wave spectra, synthesised waves, slopes, shadowing."""
