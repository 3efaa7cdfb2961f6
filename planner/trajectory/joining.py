"""Trajectories put together where they meet, and parts cut out of one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError

if TYPE_CHECKING:
    from assur.planner.trajectory.trajectory import Trajectory

Knots = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Times (K,), q, q̇, q̈ (K, n)."""

MEETING_TIME = 1e-9
"""s. Trajectories that are joined end and begin at the same time up to this; 1 ns is below any controller's clock."""
MEETING_POSITION = 1e-9
"""rad or m. ... in the same place: rounding of inverse kinematics, a thousandth of a servo's resolution."""
MEETING_VELOCITY = 1e-8
"""rad/s or m/s. ... with the same velocity."""
MEETING_ACCELERATION = 1e-6
"""rad/s² or m/s². ... with the same acceleration."""


def meet(number: int, a: Trajectory, b: Trajectory) -> None:
    """Accept two trajectories that meet; raise `FaultError` otherwise."""
    if a.n != b.n:
        raise FaultError(f"trajectory {number} has {a.n} joints, trajectory {number + 1} has {b.n}")
    gaps = {
        "time": (abs(a.end - b.start), MEETING_TIME),
        "position": (np.abs(a.q[-1] - b.q[0]).max(), MEETING_POSITION),
        "velocity": (np.abs(a.qd[-1] - b.qd[0]).max(), MEETING_VELOCITY),
    }
    if not (a.jumps or b.jumps):
        gaps["acceleration"] = (np.abs(a.qdd[-1] - b.qdd[0]).max(), MEETING_ACCELERATION)
    for name, (gap, allowed) in gaps.items():
        if not gap <= allowed:
            raise FaultError(f"trajectories {number} and {number + 1} differ in {name} by {gap:.3g} where they meet")


def joined(one: Knots, other: Knots) -> Knots:
    """Knots of two motions that meet; at the meeting what ends the first and begins the second, once if they agree.

    Where either may jump the meeting may have three or four knots: those in the middle last no time, and go. Time and
    place of the meeting are the first one's.
    """
    last, first = len(one[0]) - 1, 0
    while last > 0 and one[0][last - 1] == one[0][last]:
        last -= 1
    while first + 1 < len(other[0]) and other[0][first + 1] == other[0][first]:
        first += 1
    parts = [tuple(column[: last + 1] for column in one)]
    if (np.abs(other[3][first] - one[3][last]) > MEETING_ACCELERATION).any():
        parts.append((*(column[last : last + 1] for column in one[:3]), other[3][first : first + 1]))
    parts.append(tuple(column[first + 1 :] for column in other))
    time, q, qd, qdd = (np.concatenate(column) for column in zip(*parts, strict=True))
    return time, q, qd, qdd


def clipped(path: Trajectory, t0: float, t1: float) -> Knots:
    """Knots of a trajectory over [t0, t1]; see `Trajectory.clip`."""
    inner = (path.time > t0) & (path.time < t1)
    if t0 == path.start:
        inner |= path.time == t0
    if t1 == path.end:
        inner |= path.time == t1
    columns = [[path.time[inner]], [path.q[inner]], [path.qd[inner]], [path.qdd[inner]]]
    if t0 > path.start:
        for column, value in zip(columns, (np.array(t0), *path.state(t0)), strict=True):
            column.insert(0, value[None])
    if t1 < path.end:
        # where the acceleration jumps, what comes from the left: the first of the knots
        k = int(path.time.searchsorted(t1, "left"))
        states = (path.q[k], path.qd[k], path.qdd[k]) if path.time[k] == t1 else path.state(t1)
        for column, value in zip(columns, (np.array(t1), *states), strict=True):
            column.append(value[None])
    time, q, qd, qdd = map(np.concatenate, columns)
    return time, q, qd, qdd
