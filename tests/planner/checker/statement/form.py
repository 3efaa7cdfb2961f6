"""Whether the tables of a claim fit together: a plain statement of what the claim checker requires before all else."""

from __future__ import annotations

import numpy as np

from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from tests.planner.claim.bounds import outside

SPANS = (
    ("arms", c.ARM_LINK, "links"),
    ("arms", c.ARM_KNOT, "knots"),
    ("arms", c.ARM_ANGLE, "angles"),
    ("frames", c.FRAME_PIECE, "laws"),
    ("frames", c.FRAME_WAVE, "waves"),
    ("bodies", c.BODY_PIECE, "pieces"),
    ("bodies", c.BODY_TRIANGLE, "triangles"),
    ("pieces", c.PIECE_VERTEX, "vertices"),
)
"""Table, the column with the first row of another table (the next one has how many), and that table."""


def is_formed(claim: Claim) -> bool:
    """Whether spans follow each other and share out their tables, numbers are within `BOUNDS`, and links and seats
    refer to something."""
    return all(_spans(claim, *each) for each in SPANS) and not outside(claim) and _chained(claim) and _seated(claim)


def _spans(claim: Claim, table: str, column: int, of: str) -> bool:
    first, count = getattr(claim, table)[:, [column, column + 1]].T
    return bool(
        (first == np.cumsum(count) - count).all() and (count >= 0.0).all() and count.sum() == len(getattr(claim, of))
    )


def _chained(claim: Claim) -> bool:
    """Links have earlier links of their arm as parents, and joints and angles of their arm; loops have the angle of
    their cranks."""
    for loop in claim.loops:
        one, other = claim.links[loop[c.LOOP_CRANK : c.LOOP_CRANK + 2].astype(int), c.LINK_YAW].astype(int)
        if not (claim.angles[int(loop[c.LOOP_BETWEEN])] == claim.angles[other] - claim.angles[one]).all():
            return False
    for first, links, joints, _, _, angle, angles, _ in claim.arms.astype(int).tolist():
        for row, link in enumerate(claim.links[first : first + links].tolist(), start=first):
            turns = link[c.LINK_YAW : c.LINK_COUPLER]
            if turns[1:] == [-1.0, -1.0]:
                del turns[1:]
            parent, slide = link[c.LINK_PARENT], link[c.LINK_SLIDE]
            if not ((parent == -1.0) == (row == first) and parent < row and (parent == -1.0 or parent >= first)):
                return False
            if slide not in range(-1, joints) or not all(turn in range(angle, angle + angles) for turn in turns):
                return False
    return True


def _seated(claim: Claim) -> bool:
    """Each seat is on a link or on a frame, and each body has one of its own. Pieces of a law follow each other."""
    bodies = claim.seats[claim.seated.astype(int), c.SEAT_BODY]
    on = (claim.seats[:, c.SEAT_LINK] >= 0.0) != (claim.seats[:, c.SEAT_FRAME] >= 0.0)
    for frame in claim.frames:
        pieces = claim.laws[int(frame[c.FRAME_PIECE]) :][: int(frame[c.FRAME_PIECES])]
        begins, ends = pieces[:, c.LAW_BEGIN], pieces[:, c.LAW_END]
        if not (frame[c.FRAME_SHIFT] <= frame[c.FRAME_SHIFT + 1] and (begins < ends).all()):
            return False
        if not (begins[1:] == ends[:-1]).all():
            return False
    return bool(on.all() and (bodies == np.arange(len(claim.bodies))).all())
