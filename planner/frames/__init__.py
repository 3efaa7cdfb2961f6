"""Poses and motions of frames."""
