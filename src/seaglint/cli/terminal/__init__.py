"""Parts that the commands share: options, messages, progress, tables and the help page."""
