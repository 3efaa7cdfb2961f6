"""Does the claim state that each arch goes up and then down, and as high as its step requires?

The lift is a joint, so rows of sums state it: at the begin, the top and the end of an arch, and its rate in between.
"""

from __future__ import annotations

import math

from assur.planner.checker.statement.differences import MEET, Interval
from assur.planner.checker.statement.statement import Statement
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.model.outcome import LegKind

BACK_M, BACK = 1e-4, 0.1
"""m, and share of the height to which an arch rises above its ends: so far the lift may go the wrong way in total. A
motion through ticks of a controller, 4 ms apart, sways by some tenths of a millimetre where the lift turns."""
UP = (0.0, 0.0, 1.0)
RISE_M = 1e-6
"""m. So far an arch goes above both of its ends at least, or to the end of the lift's range."""


def require_arches(statement: Statement) -> None:
    """Each arch goes up and then down, and those of a step go as high as it requires."""
    legs = [leg for leg in statement.plan.legs if leg.kind is LegKind.ARCH]
    for leg in legs:
        what = "a leg that is called ARCH is not stated to go up and then down"
        statement.require(_goes_over(statement, (leg.t0, leg.t1)), Code.ARCH, what, (leg.t0, leg.t1))
    for number, step in enumerate(statement.scene.task):
        spans = [leg for leg in legs if leg.step == number]
        if step.arch is not None and spans:
            about, when = (statement.flange, 1.0, *statement.tcp[:3], -1.0, *UP), (spans[0].t0, spans[-1].t1)
            high = statement.keeps("axes", about, step.arch.top_m - MEET, math.inf, when, once=True)
            statement.require(high, Code.ARCH, f"the arch to {step.name} may be too low", when)


def _goes_over(statement: Statement, when: Interval) -> bool:
    """The lift goes up and then down, up to `BACK_M` and `BACK`, and higher than both ends."""
    robot, (t0, t1) = statement.scene.robot, when
    if robot.lift is None:
        return False
    lift = [float(joint == robot.lift) for joint in range(c.MOST_JOINTS)]
    heights = [(t, low, high) for t, until, low, high in statement.bounds("sums", 0.0, *lift) if t == until]
    ends = [[high for t, _, high in heights if t == end] for end in when]
    if not all(ends):
        return False
    highest = max(min(end) for end in ends)
    low, turn = max((low, t) for t, low, _ in heights if t0 <= t <= t1)
    if not low >= min(highest + RISE_M, float(robot.limits.upper[robot.lift]) - RISE_M) - MEET:
        return False
    back = 0.0
    for first, last, is_up in ((t0, turn, True), (turn, t1, False)):
        # how fast the lift may go back: down on the way up, and up on the way down
        own = ((a, b, -least if is_up else most) for a, b, least, most in statement.bounds("sums", 1.0, *lift))
        rates = sorted((a, b, rate) for a, b, rate in own if first <= a < b <= last and rate < c.GREATEST)
        if [first, *(b for _, b, _ in rates)] != [*(a for a, _, _ in rates), last]:
            return False
        back += sum(max(rate, 0.0) * (b - a) for a, b, rate in rates)
    return back <= BACK_M + BACK * (low - highest)
