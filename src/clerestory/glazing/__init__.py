"""A stack of panes, gaps and shades becomes a Bsdf, with thermal figures."""
