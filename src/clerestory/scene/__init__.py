"""The scene as plain values: surfaces, materials, windows, sensors, views."""
