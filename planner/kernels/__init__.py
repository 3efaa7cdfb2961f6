"""Compiled loops over flat tables. A kernel imports math, numpy, the door to the compiler, and other kernels."""
