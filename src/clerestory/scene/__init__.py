"""Scene description: surfaces, materials, windows, sensors and views."""
