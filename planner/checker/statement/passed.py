"""Does a plan by parabolic blends move along parabolas, and miss its vias by what it states?

In such a plan the acceleration of every piece of the motion is constant, or zero. A via is due in the middle of a piece
that accelerates, or in one without acceleration where nothing bends. From the velocities v1, v2 at both ends of that
piece, 2τ long, follows the pose that is blended past,

    B = q(t) − τ (v2 − v1)/4                                                                                (V4)

and the tool must be at the control point in B. Knots are compared, and no row of a claim: B is not on the motion.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker.statement.arms import hand_shares, link_at
from assur.planner.checker.statement.differences import MEET, SAME
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.poses import then
from assur.planner.checker.verdict import Code
from assur.planner.model.outcome import Arrival, Missed

BENT = 1e-6
"""How much the acceleration may change over a piece, of its limit; or, if that is more, by what `UNITS` in the last
place of a position do to a short piece: an acceleration is 20 times a difference of positions over h²."""
UNITS = 64


def require_parabolas(handling: Handling) -> None:
    """Parabolas, acceleration times and missed vias; without blends, that none is missed."""
    scene, path = handling.scene, handling.plan.trajectory
    blended = not scene.options.jerk_limited
    if path.jumps is not blended:
        what = "accelerations jump, or do not, against the timing that is requested"
        handling.require(False, Code.BLEND, what)
        return
    pieces = _Pieces(handling) if blended else None
    if pieces is not None:
        pieces.require(handling, scene.options.acceleration_time_s)
    for number, step in enumerate(scene.task):
        arrival = handling.arrivals[number]
        missed = scene.options.vias_missed and step.via
        stated = missed is (arrival.missed_by is not None)
        handling.require(stated, Code.BLEND, f"{step.name} is missed, and it is not stated, or the opposite")
        if stated and pieces is not None and arrival.missed_by is not None:
            _require_miss(handling, pieces, arrival, arrival.missed_by)


class _Pieces:
    """Of each piece (P,): begin, length, velocities (P, 2, n) at both ends, and by how much its acceleration changes
    over it, in parts of what it may, (P,)."""

    def __init__(self, handling: Handling) -> None:
        path, most = handling.plan.trajectory, handling.scene.robot.limits.acceleration
        k = np.flatnonzero(path.time[1:] > path.time[:-1])
        self.begin, self.length = path.time[k], path.time[k + 1] - path.time[k]
        self.rates = np.stack([path.qd[k], path.qd[k + 1]], 1)
        h, (a, b) = self.length[:, None], (path.qdd[k], path.qdd[k + 1])
        # a quintic is a parabola if both accelerations are the same, and fit to velocities and positions
        mean = (path.qd[k + 1] - path.qd[k]) / h
        far = 20.0 * (path.q[k + 1] - path.q[k] - h * (path.qd[k] + path.qd[k + 1]) / 2.0) / h**2
        off = np.max([np.abs(b - a), np.abs(a - mean), np.abs(b - mean), np.abs(far)], 0)
        size = np.maximum(np.abs(path.q[k]), np.abs(path.q[k + 1]))
        allowed = np.maximum(BENT * most, UNITS * np.finfo(np.float64).eps * size / h**2)
        self.bent: FloatArray = (off / allowed).max(1)
        self.accelerates: BoolArray = np.asarray((np.maximum(np.abs(a), np.abs(b)) > allowed).any(1))

    def require(self, handling: Handling, lasts: float | None) -> None:
        """Each piece is a parabola, and if it accelerates it lasts as long as is required."""
        off = np.where(self.accelerates, np.abs(self.length - (lasts or 0.0)), 0.0) * (lasts is not None)
        for bad, what in (
            (~(self.bent <= 1.0), "a piece is no parabola"),
            (~(off <= SAME), f"a blend does not last {lasts or 0.0:g} s"),
        ):
            for k in np.flatnonzero(bad).tolist():
                begin = float(self.begin[k])
                handling.require(False, Code.BLEND, what, (begin, begin + float(self.length[k])))


def _require_miss(handling: Handling, pieces: _Pieces, arrival: Arrival, stated: Missed) -> None:
    """A via is missed by what its arrival states, and what is blended past is at the control point."""
    robot, t = handling.scene.robot, arrival.time
    k = int(np.clip(np.searchsorted(pieces.begin, t, side="right") - 1, 0, len(pieces.begin) - 1))
    tau = float(pieces.length[k]) / 2.0
    late = abs(t - float(pieces.begin[k]) - tau) if pieces.accelerates[k] else 0.0
    miss = tau * (pieces.rates[k, 1] - pieces.rates[k, 0]) / 4.0
    past = handling.state_at(t)[0] - miss
    tool = then(link_at(robot, past, int(handling.flange)), handling.tcp)
    goal = handling.in_world(handling.tool_point(arrival.step), t)
    turned = abs(math.remainder(tool[3] - goal[3], math.tau)) if "yaw" in robot.coordinates else 0.0
    if "pitch" in robot.coordinates:
        pairs = zip(hand_shares(robot) @ past, (arrival.pitch, arrival.roll), strict=True)
        turned = max(math.inf if y is None else abs(math.remainder(x - y, math.tau)) for x, y in pairs)
    distance = math.dist(handling.tool_at(t)[:3], goal[:3])
    same = len(stated.joints) == len(miss) and bool((np.abs(np.array(stated.joints) - miss) <= SAME).all())
    name, met = handling.scene.task[arrival.step].name, math.dist(tool[:3], goal[:3]) <= MEET and turned <= MEET
    same = same and abs(stated.distance_m - distance) <= MEET
    handling.require(late <= SAME, Code.BLEND, f"{name} is not due in the middle of its blend", (t, t))
    handling.require(met, Code.BLEND, f"what is blended past is not {name}", (t, t))
    handling.require(same, Code.BLEND, f"{name} is missed by another amount", (t, t))
