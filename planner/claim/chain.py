"""Arms as rows: their links, the distinct angles of these, their loops, and their motion as knots."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.errors import InputError
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory


class Arms:
    """The arms of a cell, the robot first."""

    def __init__(self) -> None:
        self._arms: list[tuple[float, ...]] = []
        self._links: list[tuple[float, ...]] = []
        self._angles: list[tuple[float, ...]] = []
        self._loops: list[tuple[float, ...]] = []

    def add(self, robot: Robot) -> int:
        """Adds the chain of an arm; the row of its base in `links`. Raises `InputError` for too many joints."""
        first, start, n = len(self._links), len(self._angles), len(robot.joints)
        if n > c.MOST_JOINTS:
            raise unstated(f"an arm with {n} joints")
        rows = robot.chain_rows
        links, loops = rows.links.copy(), rows.loops.copy()
        links[:, c.LINK_PARENT] += np.where(links[:, c.LINK_PARENT] >= 0.0, first, 0)
        turns = links[:, c.LINK_YAW : c.LINK_COUPLER]
        turns += np.where(turns >= 0.0, start, 0)
        loops[:, c.LOOP_CRANK : c.LOOP_LENGTH] += first
        loops[:, c.LOOP_BETWEEN] += start
        loop = len(self._loops) if len(loops) else -1
        self._arms.append((first, len(links), n, 0, 0, start, len(rows.angles), loop))
        self._links += links.tolist()
        self._angles += rows.angles.tolist()
        self._loops += loops.tolist()
        return first

    def tables(self) -> dict[str, FloatArray]:
        """Arms (without their knots), links, angles and loops."""
        rows = {"arms": self._arms, "links": self._links, "angles": self._angles, "loops": self._loops}
        return {name: c.table(name, each) for name, each in rows.items()}


def knots_at_rest(path: Trajectory) -> FloatArray:
    """Knots (K, c.KNOT) of an arm that follows a trajectory, and of its rest before and after it for all times that a
    claim may have. Where it does not begin or end at rest its motion is stated no farther."""
    begins, ends = (not (path.qd[k].any() or path.qdd[k].any()) for k in (0, -1))
    begin = -c.LATEST_S if begins else float(path.time[0])
    return knots_of(path, min(begin, float(path.time[0])), c.LATEST_S if ends else float(path.time[-1]))


def knots_of(path: Trajectory, begin: float, until: float) -> FloatArray:
    """Knots (K, c.KNOT) of an arm that follows a trajectory and rests before and after it, from `begin` to `until`, s.

    Raises `InputError` for a trajectory that does not rest at an end beyond which it is required.
    """
    before, after, count, n = int(begin < path.time[0]), int(until > path.time[-1]), len(path.time), path.n
    found = np.zeros((count + before + after, c.KNOT))
    own = found[before : before + count]
    own[:, c.KNOT_TIME] = path.time
    for first, states in ((c.KNOT_Q, path.q), (c.KNOT_QD, path.qd), (c.KNOT_QDD, path.qdd)):
        own[:, first : first + n] = states
    for needed, end, t in ((before, 0, begin), (after, -1, until)):
        if needed:
            if path.qd[end].any() or path.qdd[end].any():
                when = "begins, and is needed before" if end == 0 else "ends, and is needed after"
                raise unstated(f"a motion that is not at rest when it {when}")
            found[end, c.KNOT_TIME], found[end, c.KNOT_Q : c.KNOT_Q + n] = t, path.q[end]
    return found


def unstated(what: str) -> InputError:
    """The refusal of a plan with something that no claim can state."""
    return InputError("plan", what, "an answer without it: a proof bundle cannot state it yet")
