"""Transfer matrices with labelled axes, and their files."""
