"""Results of the source article, reproduced with this program's models."""
