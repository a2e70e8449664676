"""Tables of numbers: CSV and Parquet files, read with errors by line and column, and written completely or not at all."""
