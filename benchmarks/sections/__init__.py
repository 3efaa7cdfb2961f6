"""The sections of the benchmark, one module each."""
