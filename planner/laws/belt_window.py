"""When a point on a conveyor is within a stretch of its way, for windows in millimetres."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Pose
from assur.planner.kernels import law_columns as c
from assur.planner.laws.law import Law

HORIZON_S = 60.0
"""Windows along a conveyor are looked for this long after the start, s."""
WINDOW_STEP_S = 0.005
"""Sampling of a control point's way along its conveyor, s. Ends are then found by parting a step of it, and the part
with the end again."""
PARTS, ROUNDS = 64, 7
"""A step of the grid, parted as often, is below what doubles know of a time."""
KEPT = 256
"""Windows whose times are kept: a search asks about the same ones for each of its candidates."""

Stretch = tuple[float, float]
"""From where to where along the conveyor, m."""


def travelled(law: Law, point: Pose, t: FloatArray) -> FloatArray:
    """Way (...) m of a point that is fixed in the frame, along the law's direction of travel, from the law's pose; NaN
    where the law is not known. The frame does not turn, so the point's own part of the way is constant."""
    if law.way is None:
        raise FaultError(f"no way is measured along a frame of the kind {law.kind}")
    moved = law.motion(t).p - law.numbers.pose.position
    return np.asarray(moved @ law.row[c.LINE : c.LINE + 3] + point.position @ np.array(law.way))


@lru_cache(maxsize=KEPT)
def inside(law: Law, point: Pose, stretch: Stretch, start: float) -> tuple[tuple[float, float], ...]:
    """When a point that is fixed in the frame is within `stretch` in the `HORIZON_S` after `start`, s; closed intervals
    in order."""
    grid = np.arange(start, start + HORIZON_S + WINDOW_STEP_S, WINDOW_STEP_S)
    way = travelled(law, point, grid)
    # what passes the whole window between two times of the grid gets a third one, inside
    side = np.sign(way - np.clip(way, *stretch))
    passed = [_passed(law, point, stretch, grid[i], grid[i + 1]) for i in np.flatnonzero(side[1:] * side[:-1] < 0)]
    grid = np.sort(np.concatenate([grid, passed]))
    way = travelled(law, point, grid)
    within = (way >= stretch[0]) & (way <= stretch[1])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], within, [False]]).astype(int)))
    ends = edges.reshape(-1, 2).tolist()
    return tuple((_edge(law, point, stretch, grid, a, -1), _edge(law, point, stretch, grid, b - 1, 1)) for a, b in ends)


def outside_for_good(law: Law, point: Pose, stretch: Stretch, start: float) -> bool:
    """Whether a point stays outside `stretch` after the time that is searched: its law is over then, or does not change
    any more and leads away from the stretch, or nowhere."""
    until = start + HORIZON_S
    if law.valid[1] <= until:
        return True
    if law.changes_until > until:
        return False
    last, later = travelled(law, point, np.array([until, min(until + 1.0, law.valid[1])])).tolist()
    return bool((last > stretch[1] and later >= last) or (last < stretch[0] and later <= last))


def _passed(law: Law, point: Pose, stretch: Stretch, before: float, after: float) -> float:
    """A time inside the stretch, which is passed between the two; if no double is in it, one beside it."""
    for _ in range(ROUNDS):
        times = np.linspace(before, after, PARTS + 1)
        way = travelled(law, point, times)
        within = (way >= stretch[0]) & (way <= stretch[1])
        if within.any():
            return float(times[within.argmax()])
        side = np.sign(way - stretch[0])
        last = int(np.flatnonzero(side[1:] * side[0] < 0)[0])
        before, after = float(times[last]), float(times[last + 1])
    return before


def _edge(law: Law, point: Pose, stretch: Stretch, grid: FloatArray, index: int, side: int) -> float:
    """The last time inside the stretch between grid point `index`, inside, and its neighbour at `side`, outside."""
    inner, neighbour = float(grid[index]), index + side
    if not 0 <= neighbour < len(grid):
        return inner
    outer = float(grid[neighbour])
    for _ in range(ROUNDS):
        times = np.linspace(inner, outer, PARTS + 1)
        way = travelled(law, point, times)
        outside = ~((way >= stretch[0]) & (way <= stretch[1]))
        outside[0], outside[-1] = False, True
        first = int(outside.argmax())
        inner, outer = float(times[first - 1]), float(times[first])
    return inner
