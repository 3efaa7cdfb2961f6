"""Legs: legs_ of motion from a state of the arm to a control point, and along one."""
