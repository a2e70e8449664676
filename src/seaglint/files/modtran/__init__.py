"""MODTRAN's and LOWTRAN7's files: decks of the lines of sight that a scenario needs, readers of their results, one file a format."""
