"""One frozen record for each table of a scenario file, and the numbers and texts in them."""
