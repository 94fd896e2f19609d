"""Studies: a whole annual simulation described by one TOML file."""
