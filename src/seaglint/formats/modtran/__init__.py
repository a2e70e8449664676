"""Files of MODTRAN and LOWTRAN7: decks of the lines of sight that a scenario needs, and readers of results, one file a format."""
