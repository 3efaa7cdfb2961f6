"""Convex solids and tables of them, in the frame of the body."""
