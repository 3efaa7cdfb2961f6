"""The search: partial plans, sampled via points, timed candidates, and their census."""
