"""Does the plan begin and end as the request asks, and does it do the steps of the task one after the other?"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker.statement import laws
from assur.planner.checker.statement.arms import hand_shares, link_at
from assur.planner.checker.statement.differences import MEET, SAME, Interval, then
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.verdict import Code
from assur.planner.model.outcome import Arrival, Leg, LegKind, Missed
from assur.planner.model.scene import Move, Pick, Step, Trace

LETTERS = {
    LegKind.WAIT: "W",
    LegKind.MOVE: "M",
    LegKind.ARCH: "A",
    LegKind.APPROACH: "D",
    LegKind.FOLLOW: "F",
    LegKind.DEPART: "U",
}
"""Legs as letters: the legs of a step are compared with a pattern."""


def require_order(handling: Handling) -> None:
    """Start, end, and the legs and arrivals of each step."""
    scene, plan, options = handling.scene, handling.plan, handling.scene.options
    (first, last), every, knots = handling.whole, list(range(len(scene.task))), plan.trajectory.knots
    start = scene.start
    state = [start.time, *start.q.tolist(), *start.qd.tolist(), *start.qdd.tolist()]
    begins = math.dist(knots[0].tolist(), state) <= SAME
    handling.require(begins, Code.START, "the motion begins in another state")
    rests = options.end != "rest" or math.hypot(*knots[-1, 1 + len(knots[0]) // 3 :].tolist()) <= SAME
    ends = options.latest_end_s is None or last <= options.latest_end_s + SAME
    late = "the motion ends too late"
    handling.require_all(Code.END, None, (rests, "the motion does not end at rest"), (ends, late))
    steps, gaps, reached = list[int](), False, first
    for leg in plan.legs:
        steps.append(leg.step)
        gaps, reached = gaps or leg.t0 != reached, leg.t1
    in_order = steps == sorted(steps) and sorted(set(steps)) == every
    handling.require_all(
        Code.LEGS,
        None,
        (not gaps and reached == last, "the legs leave out a time, or count one twice"),
        (in_order, "the legs are not those of the steps, in their order"),
    )
    known = list(handling.arrivals) == every and len(plan.arrivals) == len(every)
    handling.require(known, Code.ARRIVAL, "the arrivals are not those of the steps, in their order")
    for number in every if known else ():
        step, own, is_last = scene.task[number], handling.legs(number), number == every[-1]
        letters = "".join([LETTERS[leg.kind] for leg in own])
        fits = re.fullmatch(_pattern(step) + "M?" * is_last, letters)
        if fits:
            _require_arrival(handling, number, own, is_last=is_last)
        else:
            kinds = ", ".join(leg.kind for leg in own) or "none"
            handling.require(False, Code.LEGS, f"{step.name} cannot have these legs: {kinds}")


def _pattern(step: Step) -> str:
    """The legs that a step may have, as a regular expression of `LETTERS`."""
    # an arm in motion stops before it waits
    way = "(M?W)?[MA]+" if step.arch is None else "(M?W)?[MA]*A[MA]*"
    if isinstance(step, Move):
        return way
    if isinstance(step, Trace):
        return f"{way}DFU"
    return f"{way}{'D' * (step.approach_m > 0.0)}F{'U' * (step.depart_m > 0.0)}"


def _require_arrival(handling: Handling, number: int, own: list[Leg], *, is_last: bool) -> None:
    """A step meets its control point when its legs state it, as long, as exactly and in the window that it requires."""
    step, arrival = handling.scene.task[number], handling.arrivals[number]
    name, when, follow, times = step.name, (arrival.time, arrival.until), None, list[Interval]()
    for leg in own:
        if leg.kind is LegKind.FOLLOW:
            follow = leg
        if leg.kind is not LegKind.WAIT:
            times.append((leg.t1, leg.t1))
    # the last move may be followed by one to rest
    times = [(follow.t0, follow.t1)] if follow else times[-2 if is_last else -1 :]
    met = False
    for begin, end in times:
        # a motion through other knots may end a rounding of its times later than its last arrival
        met |= abs(arrival.time - begin) <= SAME and abs(arrival.until - end) <= SAME
    error, most, turn = arrival.error, step.tolerance, arrival.yaw_offset
    far, turned = (0.0, 0.0) if error is None else (error.position_m, error.within.yaw_rad)
    handling.require_all(
        Code.ARRIVAL,
        when,
        (met, f"{name} is met at another time than its legs state"),
        (abs(arrival.until - arrival.time - step.dwell_s) <= SAME, f"{name} does not last {step.dwell_s:g} s"),
        (
            follow is not None or is_last or abs(own[-1].t1 - arrival.time) <= SAME,
            f"{name} goes on behind its control point",
        ),
        (
            error is not None or handling.is_exact,
            f"no error is stated at {name}, and not everything is exact",
        ),
        (
            far <= most.position_m and turned <= most.yaw_rad,
            f"{name} may be missed by {far:g} m and {turned:g} rad",
        ),
        (_may_turn(handling, step, turn), f"the tool may not be turned by {turn:g} rad at {name}"),
    )
    _require_window(handling, number, arrival)


def _may_turn(handling: Handling, step: Step, turn: float) -> bool:
    """Whether a step leaves this turn of the tool to choose: by the symmetry of the part, or by a yaw that is free."""
    if "yaw" not in handling.scene.robot.coordinates:
        # the heading follows from the position
        return math.isfinite(turn) and abs(math.remainder(turn, math.tau)) <= SAME
    if isinstance(step, Pick):
        fold = handling.scene.index[step.part].yaw_symmetry
        return math.isfinite(turn) and (fold == 0 or abs(math.remainder(turn, math.tau / fold)) <= SAME)
    free = step.part is None and step.target.yaw_free
    return math.isfinite(turn) and (free or abs(math.remainder(turn, math.tau)) <= SAME)


def _require_window(handling: Handling, number: int, arrival: Arrival) -> None:
    """The control point is in its window, in time and along its belt, over all of the dwell."""
    step, when = handling.scene.task[number], (arrival.time, arrival.until)
    first, last = step.window.time or (-math.inf, math.inf)
    inside = first - SAME <= arrival.time and arrival.until <= last + SAME
    handling.require(inside, Code.WINDOW, f"{step.name} is met outside of its window in time", when)
    if step.window.along is None:
        return
    frame, _ = handling.point(number)
    if laws.measured_along(handling.scene.frames[frame].law) is None:
        handling.require(False, Code.WINDOW, f"{step.name} has a window in metres, and is on no belt", when)
        return

    def way(times: Sequence[float]) -> FloatArray:
        return np.asarray(handling.along(number, times))

    begins = handling.given.motion(frame).begins  # what goes along a line has no period
    times = edges = [arrival.time, *(t for t in begins if arrival.time < t < arrival.until), arrival.until]
    for a, b in pairwise(edges):  # between two of them the way is a cubic, which may turn round
        first, second, third, fourth = way([a, a + (b - a) / 3.0, b - (b - a) / 3.0, b]).tolist()
        rise, bend, turn = second - first, third - 2.0 * second + first, fourth - 3.0 * (third - second) - first
        # its derivative is p u² + q u + r, with u from 0 to 3 (Newton's forward differences)
        p, q, r = turn / 2.0, bend - turn, rise - bend / 2.0 + turn / 3.0
        if not math.isfinite(p + q + r):
            times = [math.nan]
            break
        half = -(q + math.copysign(math.sqrt(max(q * q - 4.0 * p * r, 0.0)), q)) / 2.0
        turns = (x / y for x, y in ((half, p), (r, half)) if y != 0.0)
        times = [*times, *(a + (b - a) * u / 3.0 for u in turns if 0.0 < u < 3.0)]
    ways, (low, high) = way(times), step.window.along
    inside = low - MEET <= ways.min() and ways.max() <= high + MEET
    handling.require(inside, Code.WINDOW, f"{step.name} is met outside of its window along the belt", when)


# Does a plan by parabolic blends move along parabolas, and miss its vias by what it states?
#
# In such a plan the acceleration of every piece of the motion is constant, or zero. A via is due in the middle of a
# piece that accelerates, or in one without acceleration where nothing bends. From the velocities v1, v2 at both ends of
# that piece, 2τ long, follows the pose that is blended past,
#
# B = q(t) − τ (v2 − v1)/4 (V4)
#
# and the tool must be at the control point in B. Knots are compared, and no row of a claim: B is not on the motion.

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
    tool = then(link_at(robot, past.tolist(), int(handling.flange)), handling.tcp)
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
