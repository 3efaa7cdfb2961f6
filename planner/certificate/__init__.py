"""Proves a plan's phases free of collision in continuous time, and writes the proof down (docs/guarantees.md, C1-C5).

A pair over an interval is proved by one normal that stays fixed: the support gaps at both ends, and how fast, or with
how much acceleration, the two can approach along it. What is not proved is halved; bounding boxes that are not apart
are replaced by the convex pieces inside. One NumPy batch a round. A pair that no likely normal parts is put to FCL:
if it says they touch, the phase is refused; if not, GJK gives the distance and a normal to go on with.
"""

from planner.certificate.proof import Prover
from planner.certificate.rows import Rows, Unproved, written

__all__ = ["Prover", "Rows", "Unproved", "written"]
