"""Units of work on other machines; see `engine.work` for what they are."""
