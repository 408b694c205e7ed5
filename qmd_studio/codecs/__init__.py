"""Codecs: motion to compressed bytes and back."""
