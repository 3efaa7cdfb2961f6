"""What the checker holds paths to: its own curves, and whether the tool follows them."""
