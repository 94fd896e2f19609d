"""Built-in BSDFs of glazings, blinds, screens, louvres and films, by name."""
