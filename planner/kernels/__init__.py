"""Compiled loops over flat tables. A kernel imports math, numpy, the entry to the compiler, and other kernels."""
