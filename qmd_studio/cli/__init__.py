"""The studio's verbs without a window."""
