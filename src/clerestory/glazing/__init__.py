"""Layer stacks of panes, gaps and shades: BSDF, U-value and SHGC (as WINDOW)."""
