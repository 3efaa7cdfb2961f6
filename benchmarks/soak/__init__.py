"""A Monte Carlo test of the promises of plans under the stated uncertainties: ``make soak``.

Random cells are planned, and each plan is run many times by a simulation in which belts, parts, joints and the start
are off by what the request allows. Nothing here but `campaign`, which asks for the plans, imports the planner or the
scenes: the simulation is written from `docs/request.md`, `docs/conventions.md` and `docs/guarantees.md`, and it works
on the two documents alone. docs/soak.md states what it covers and how finely it samples.
"""
