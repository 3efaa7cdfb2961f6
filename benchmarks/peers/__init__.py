"""Planners of others, each a program of its own in an environment of its own.

The environment (`benchmarks.peers.running`) has Python 3.11 or 3.12, for which the peers have wheels, and not our
libraries: `ompl_rrtconnect` and `mplib_planner` run there, and import of this repository only `benchmarks.dialogue`,
`benchmarks.translation` and what is here. Problems go in and answers come out as JSON lines; answers are
rechecked here like ours.
"""
