"""A cell that runs: a clock, the parts that are known, and one committed motion that is proved for every second."""
