"""File formats: bytes to motion or body and back, one module a format."""
