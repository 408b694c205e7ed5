"""The body that a motion moves."""
