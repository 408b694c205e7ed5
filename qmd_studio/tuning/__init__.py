"""Size, error and the trade between them."""
