"""Results of the source article, computed anew."""
