"""What stands in the scene: surfaces, materials, windows, sensors; plain values."""
