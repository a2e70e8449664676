"""Files of weather: one file per family of formats, each with its own missing codes, units and conventions."""
