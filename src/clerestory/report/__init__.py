"""The report of a study: one HTML page that explains itself, without a network."""
