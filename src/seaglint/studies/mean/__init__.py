"""Maps of mean radiance, and cases of spreadsheets."""
