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


def convex_groups(hulls: list[Hull]) -> list[list[int]]:
    """The numbers of the hulls in groups, each of which its own hull hardly exceeds; first come, first served."""
    groups = [[i] for i in range(len(hulls))]
    corners = [hull.vertices for hull in hulls]
    volumes = [volume_of_hull(points) for points in corners]
    i = 0
    while i < len(groups):
        partner = _partner(corners, volumes, i)
        if partner is None:
            i += 1
            continue
        groups[i] += groups.pop(partner)
        corners[i] = np.concatenate([corners[i], corners.pop(partner)])
        del volumes[partner]
        volumes[i] = volume_of_hull(corners[i])
        i = 0
    return groups


def _partner(corners: list[FloatArray], volumes: list[float], i: int) -> int | None:
    one = corners[i]
    for k in range(i + 1, len(corners)):
        other = corners[k]
        apart = np.maximum(one.min(0) - other.max(0), other.min(0) - one.max(0)).max()
        if apart > NEAR_M or len(one) + len(other) > MAX_CORNERS:
            continue
        if volume_of_hull(np.concatenate([one, other])) <= (volumes[i] + volumes[k]) * (1 + GAIN_SHARE):
            return k
    return None
