"""Studies: annual simulations described by a TOML file."""
