"""Weather files, solar position and sky models: the sky matrix S and the suns."""
