"""Ways to cut a hemisphere into patches."""
