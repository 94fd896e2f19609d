"""HTML report of a study, in one self-contained file."""
