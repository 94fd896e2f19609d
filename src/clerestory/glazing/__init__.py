"""BSDF, U-value and SHGC of stacks of panes, gaps and shades, as in WINDOW."""
