"""Weather files, solar position, sky models, sky matrix S and sun matrix."""
