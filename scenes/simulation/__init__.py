"""Simulation: a session runs against the streams of its cell, on a clock of its own, as fast as it can."""
