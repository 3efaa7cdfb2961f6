"""What no plan can do: points out of reach, windows that never open, a start that collides."""
