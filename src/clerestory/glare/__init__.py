"""Detection of glare sources in pictures, and glare indices."""
