"""An independent recheck of answers to the benchmark problems.

Written from `benchmarks/problems/README.md` alone: nothing here imports the planner or the scenes, so an error in
their kinematics, their spline, their collision geometry or their proof is not repeated here. It samples where they
prove, and it computes distances in closed form where they reason about supports.
"""
