"""Joint moves with parabolic blends (source 004): the acceleration jumps, and vias are missed by a stated amount.

A wing of the planner: `BlendSearch` is its entry, and nothing else of it is used elsewhere. Its plans are knots, which
are proved, checked and reported as all others are. Equations B1 to B7 are in docs/kinematics.md.
"""

from assur.planner.blends.search import BlendSearch

__all__ = ["BlendSearch"]
