"""Units of work on other machines; see `engine.work_units` for what they are."""
