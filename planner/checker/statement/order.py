"""Does the plan begin and end as the request asks, and does it do the steps of the task one after the other?"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import laws
from assur.planner.checker.statement.differences import MEET, SAME, Difference, Topic, is_same
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.poses import then
from assur.planner.model.outcome import Arrival, Leg, LegKind
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


def order_agrees(handling: Handling) -> Iterator[Difference]:
    """Start, end, and the legs and arrivals of each step."""
    scene, plan = handling.scene, handling.plan
    path, legs, start, options = plan.trajectory, plan.legs, scene.start, scene.options
    first, last = float(path.time[0]), float(path.time[-1])
    state = (path.q[0], start.q), (path.qd[0], start.qd), (path.qdd[0], start.qdd)
    if not (abs(first - start.time) <= SAME and all(is_same(*each) for each in state)):
        yield Difference(Topic.START, "the motion begins in another state")
    if options.end == "rest" and not max(abs(path.qd[-1]).max(), abs(path.qdd[-1]).max()) <= SAME:
        yield Difference(Topic.END, "the motion does not end at rest")
    if options.latest_end_s is not None and not last <= options.latest_end_s + SAME:
        yield Difference(Topic.END, "the motion ends too late")
    if [first, *(leg.t1 for leg in legs)] != [*(leg.t0 for leg in legs), last]:
        yield Difference(Topic.LEGS, "the legs leave out a time, or count one twice")
    steps = [leg.step for leg in legs]
    if steps != sorted(steps) or set(steps) != set(range(len(scene.task))):
        yield Difference(Topic.LEGS, "the legs are not those of the steps, in their order")
    if [arrival.step for arrival in plan.arrivals] != list(range(len(scene.task))):
        yield Difference(Topic.ARRIVAL, "the arrivals are not those of the steps, in their order")
        return
    for number, step in enumerate(scene.task):
        own = [leg for leg in legs if leg.step == number]
        letters = "".join(LETTERS[leg.kind] for leg in own)
        is_last = number == len(scene.task) - 1
        if not re.fullmatch(_pattern(step) + "M?" * is_last, letters):
            kinds = ", ".join(leg.kind for leg in own) or "none"
            yield Difference(Topic.LEGS, f"{step.name} cannot have these legs: {kinds}")
            continue
        yield from _arrival_agrees(handling, number, own, is_last=is_last)


def _pattern(step: Step) -> str:
    """The legs that a step may have, as a regular expression of `LETTERS`."""
    way = "W?[MA]+" if step.arch is None else "W?[MA]*A[MA]*"
    if isinstance(step, Move):
        return way
    if isinstance(step, Trace):
        return f"{way}DFU"
    return f"{way}{'D' * (step.approach_m > 0.0)}F{'U' * (step.depart_m > 0.0)}"


def _arrival_agrees(handling: Handling, number: int, own: list[Leg], *, is_last: bool) -> Iterator[Difference]:
    """A step meets its control point when its legs say so, as long, as exactly and in the window that it asks for."""
    step, arrival = handling.scene.task[number], handling.arrivals[number]
    when = (arrival.time, arrival.until)
    follow = next((leg for leg in own if leg.kind is LegKind.FOLLOW), None)
    ends = [leg.t1 for leg in own if leg.kind is not LegKind.WAIT]
    # the last move may be followed by one to rest
    times = [(follow.t0, follow.t1)] if follow else [(t, t) for t in ends[-2:] if is_last or t == ends[-1]]
    # a motion through other knots may end a rounding of its times later than its last arrival
    if not any(abs(when[0] - a) <= SAME and abs(when[1] - b) <= SAME for a, b in times):
        yield Difference(Topic.ARRIVAL, f"{step.name} is met at another time than its legs say", when)
    if not abs(arrival.until - arrival.time - step.dwell_s) <= SAME:
        yield Difference(Topic.ARRIVAL, f"{step.name} does not last {step.dwell_s:g} s", when)
    if follow is None and not is_last and not abs(own[-1].t1 - arrival.time) <= SAME:
        yield Difference(Topic.ARRIVAL, f"{step.name} goes on behind its control point", when)
    error, most = arrival.error, step.tolerance
    if error is None and not handling.is_exact:
        yield Difference(Topic.ARRIVAL, f"no error is stated at {step.name}, and not everything is exact", when)
    if error is not None and not (error.position_m <= most.position_m and error.within.yaw_rad <= most.yaw_rad):
        what = f"{step.name} may be missed by {error.position_m:g} m and {error.within.yaw_rad:g} rad"
        yield Difference(Topic.ARRIVAL, what, when)
    if not _may_turn(handling, step, arrival.yaw_offset):
        what = f"the tool may not be turned by {arrival.yaw_offset:g} rad at {step.name}"
        yield Difference(Topic.ARRIVAL, what, when)
    yield from _window_agrees(handling, number, arrival)


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


def _window_agrees(handling: Handling, number: int, arrival: Arrival) -> Iterator[Difference]:
    """The control point is in its window, in time and along its belt, over all of the dwell."""
    step, when = handling.scene.task[number], (arrival.time, arrival.until)
    window = step.window
    if window.time is not None:
        first, last = window.time
        if not (first - SAME <= arrival.time and arrival.until <= last + SAME):
            yield Difference(Topic.WINDOW, f"{step.name} is met outside of its window in time", when)
    if window.along is not None:
        frame, pose = handling.point(number)
        law = handling.scene.frames[frame].law
        measured = laws.measured_along(law)
        if measured is None:
            yield Difference(Topic.WINDOW, f"{step.name} has a window in metres, and is on no belt", when)
            return
        direction, zero = np.array(measured[0]), np.array(measured[1][:3])
        formula = laws.formula_of(law, *when)

        def way(times: FloatArray) -> FloatArray:
            places = formula.place(times).tolist()
            return np.asarray([np.array(then(tuple(place), pose)[:3]) - zero for place in places] @ direction)

        times = [arrival.time, *(t for t in formula.ends if arrival.time < t < arrival.until), arrival.until]
        for a, b in pairwise(list(times)):  # between two of them the way is a cubic, which may turn round
            cubic = np.polyfit(np.arange(4.0), way(np.linspace(a, b, 4)), 3)
            times += [a + (b - a) * u / 3.0 for u in np.roots(np.polyder(cubic)).real if 0.0 < u < 3.0]
        ways, (low, high) = way(np.array(times)), window.along
        if not (low - MEET <= ways.min() and ways.max() <= high + MEET):
            yield Difference(Topic.WINDOW, f"{step.name} is met outside of its window along the belt", when)
