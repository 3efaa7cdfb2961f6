"""Which hulls are convex together, and may become one: fewer pieces, and nothing more is covered."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.geometry.shapes import Hull
from assur.scenes.meshes.hull import MAX_CORNERS, volume_of_hull

GAIN_SHARE = 1e-4
"""Share of their own volumes by which the hull of two hulls may be larger than they are, for them to become one."""
NEAR_M = 1e-6
"""Boxes of two hulls that are further apart than this do not touch, m."""


class _Group:
    """Hulls that are convex together: their numbers, corners, and the volume of their hull."""

    def __init__(self, members: list[int], corners: FloatArray) -> None:
        self.members, self.corners = members, corners
        self.volume = volume_of_hull(corners)
        self.low, self.high = corners.min(0), corners.max(0)


def convex_groups(hulls: list[Hull]) -> list[list[int]]:
    """The numbers of the hulls in groups, each of which its own hull hardly exceeds; first come, first served."""
    groups = [_Group([i], hull.vertices) for i, hull in enumerate(hulls)]
    asked: set[tuple[_Group, _Group]] = set()
    i = 0
    while i < len(groups):
        partner = _partner(groups, i, asked)
        if partner is None:
            i += 1
            continue
        one, other = groups[i], groups.pop(partner)
        groups[i] = _Group(one.members + other.members, np.concatenate([one.corners, other.corners]))
        i = 0
    return [group.members for group in groups]


def _partner(groups: list[_Group], i: int, asked: set[tuple[_Group, _Group]]) -> int | None:
    """The next group that is convex together with group i. Those in `asked` were found not to be, and are not asked
    again."""
    for k in range(i + 1, len(groups)):
        pair = groups[i], groups[k]
        if pair not in asked:
            if _convex(*pair):
                return k
            asked.add(pair)
    return None


def _convex(one: _Group, other: _Group) -> bool:
    if np.maximum(one.low - other.high, other.low - one.high).max() > NEAR_M:
        return False
    if len(one.corners) + len(other.corners) > MAX_CORNERS:
        return False
    together = volume_of_hull(np.concatenate([one.corners, other.corners]))
    return together <= (one.volume + other.volume) * (1 + GAIN_SHARE)
