"""The claim checker: whether everything that a claim says is shown, in doubles with one stated slack.

It reads the tables of a claim and nothing else of the planner. docs/bundle.md has the equations, docs/claim-check.md
the bounds of rounding.
"""
