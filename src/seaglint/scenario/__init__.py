"""One TOML file, validated: what the user asked for."""
