"""Files of weather: one family of formats per file, each with its own missing codes, units and conventions."""
