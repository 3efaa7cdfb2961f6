"""When a point on a conveyor is within a stretch of its way, for windows in millimetres."""

from __future__ import annotations

import math
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
SIDES = np.greater_equal, np.less_equal
"""What a way inside a stretch is, compared with its first and with its last end; a way that is not known is neither."""
LEAST_STEP_M, NEXT = 1e-6, 1
"""A way that goes so far, m, in a step of the grid is surely on one side of an end at all times but those of the step
in which it passes, and of so many steps before and behind that."""
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
def times_inside(law: Law, point: Pose, stretch: Stretch, start: float) -> tuple[tuple[float, float], ...]:
    """When a point that is fixed in the frame is within `stretch` in the `HORIZON_S` after `start`, s; closed intervals
    in order."""
    grid = _sampled(law, point, stretch, np.arange(start, start + HORIZON_S + WINDOW_STEP_S, WINDOW_STEP_S))
    way, edges = travelled(law, point, grid), list[float]()
    for is_on, end in zip(SIDES, stretch, strict=True):
        side = is_on(way, end)
        for k in np.flatnonzero(side[1:] != side[:-1]):
            before, after = float(grid[k]), float(grid[k + 1])
            for _ in range(ROUNDS):
                times = np.linspace(before, after, PARTS + 1)
                others = is_on(travelled(law, point, times), end) != side[k]
                others[0], others[-1] = False, True
                first = int(others.argmax())
                before, after = float(times[first - 1]), float(times[first])
            edges += [before, after]
    grid = np.unique(np.concatenate([grid, edges]))
    way = travelled(law, point, grid)
    within = np.logical_and(*(is_on(way, end) for is_on, end in zip(SIDES, stretch, strict=True)))
    runs = np.flatnonzero(np.diff(np.concatenate([[False], within, [False]]).astype(int))).reshape(-1, 2).tolist()
    return tuple((float(grid[first]), float(grid[behind - 1])) for first, behind in runs)


def _sampled(law: Law, point: Pose, stretch: Stretch, grid: FloatArray) -> FloatArray:
    """The times of a grid at which a way has to be known: of a constant velocity, its ends and those next to where the
    way is at an end of the stretch. In between, the way is farther from both ends than it is rounded by."""
    begin, last = float(grid[0]), float(grid[-1])
    row, known = law.row, bool(law.knows(grid[[0, -1]]).all())
    many = row[c.COUNT] != 1.0 or row[c.POWERS] > 0.0 or row[c.WAVES] > 0.0 or row[c.PERIOD] > 0.0
    if law.link is not None or many or not known:
        return grid
    first, final = travelled(law, point, grid[[0, -1]]).tolist()
    step = (final - first) / (last - begin) * WINDOW_STEP_S
    if not abs(step) > LEAST_STEP_M:
        return grid
    chosen = {0, len(grid) - 1}
    for end in stretch:
        k = math.floor(min(max((end - first) / step, -NEXT), len(grid) + NEXT))
        chosen.update(range(max(0, k - NEXT), min(len(grid), k + NEXT + 2)))
    return grid[sorted(chosen)]


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
