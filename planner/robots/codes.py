"""How an inverse solution came out."""

from __future__ import annotations

from enum import IntEnum


class Code(IntEnum):
    """How an inverse solution came out, one per row of a batch (docs/kinematics.md, table of cases).

    ASSEMBLED is the only one that may be followed. OUT_OF_REACH also answers a question that is not finite (NaN or
    infinity in a position or in a derivative that was asked for): what cannot be answered is refused.
    """

    ASSEMBLED = 0
    OUT_OF_REACH = 1
    STRETCHED = 2
    FOLDED = 3
    INDETERMINATE = 4
    ALIGNED = 5
    """Inside the workspace: the tool point is on the axis of the base, whose angle may be any."""
    PARALLEL = 6
    """Of closed chains: nearer to a type 2 singularity than the robot may be, or beyond it, in the other assembly."""
