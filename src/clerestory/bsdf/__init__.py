"""What a window layer does to light: scattering distributions, read, made, written."""
