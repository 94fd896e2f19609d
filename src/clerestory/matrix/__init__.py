"""Transfer matrices with labelled axes and standard errors, and their files."""
