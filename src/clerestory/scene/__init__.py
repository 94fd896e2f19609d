"""Plain values of a scene: surfaces, materials, windows, sensors, views."""
