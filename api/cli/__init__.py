"""What the command line reads and prints."""

import gc

gc.set_threshold(50_000)
"""What imports and the compiler make lasts: with Python's 700 a tenth of a command is spent on looking through it."""
