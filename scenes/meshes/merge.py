"""Hulls that together are convex become one: fewer pieces, and nothing more is covered."""

from __future__ import annotations

import numpy as np

from planner.shapes import Hull
from scenes.meshes.hull import MAX_CORNERS, hull_of, volume_of_hull

GAIN_SHARE = 1e-4
"""Share of their own volumes by which the hull of two hulls may be larger than they are, for them to become one."""
NEAR_M = 1e-6
"""Boxes of two hulls that are further apart than this do not touch, m."""


def merged(hulls: list[Hull]) -> list[Hull]:
    """The hulls, with neighbours put together while the hull of two holds no more than the two.

    Each hull of the result contains every point of those it was made from, so what they covered stays covered.
    """
    volumes = [volume_of_hull(hull.vertices) for hull in hulls]
    found = list(hulls)
    i = 0
    while i < len(found):
        partner = _partner(found, volumes, i)
        if partner is None:
            i += 1
            continue
        found[i] = hull_of(np.concatenate([found[i].vertices, found[partner].vertices]))
        volumes[i] = volume_of_hull(found[i].vertices)
        del found[partner], volumes[partner]
        i = 0
    return found


def _partner(hulls: list[Hull], volumes: list[float], i: int) -> int | None:
    one = hulls[i].vertices
    for k in range(i + 1, len(hulls)):
        other = hulls[k].vertices
        apart = np.maximum(one.min(0) - other.max(0), other.min(0) - one.max(0)).max()
        if apart > NEAR_M or len(one) + len(other) > MAX_CORNERS:
            continue
        if volume_of_hull(np.concatenate([one, other])) <= (volumes[i] + volumes[k]) * (1 + GAIN_SHARE):
            return k
    return None
