"""Which state the shades are in at each step, by rule."""
