"""Does the claim state the peaks of the joints and of the tool as the answer does: never more, and once as much?"""

from __future__ import annotations

import math

from assur.planner.checker.statement.differences import SAME, Interval
from assur.planner.checker.statement.limits import loads_of
from assur.planner.checker.statement.statement import JOINT, Statement
from assur.planner.checker.verdict import Code
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import JointPeak
from assur.planner.model.scene import WORLD

KINDS = ("velocity", "acceleration", "jerk")
WITHIN = (1e-6, 1e-6, 1e-3)
"""By how much a peak of each kind may be off, as a share of the joint's limit: rounding of knots."""
BETWEEN, REACHED = 0.01, 1e-3
"""Shares by which a peak of the tool, which is evaluated at instants, may be exceeded between them; and by which the
largest acceleration with a part may be missed, whose instant is not stated."""
AT_ITS_TIME, OFF, STANDS = 5e-4, (1e-6, 1e-3), 1e-6
"""A share by which a peak may be off at its instant, and m/s and m/s² in addition (the acceleration of a closed chain
is known to 0.5 mm/s², and to 0.03 % near the edge of its reach); m/s or m/s²: what is no faster stands."""
BESIDE_S = 2e-9
"""A jump of the acceleration is evaluated at most so far before and behind it, s."""


def require_peaks(statement: Statement, stated: tuple[JointPeak, ...]) -> None:
    """The peaks of the joints, and their shares of the limits that each load leaves."""
    robot, limited = statement.scene.robot, statement.scene.options.jerk_limited
    same = [peak.joint for peak in stated] == [joint.name for joint in robot.joints]
    statement.require(same, Code.PEAK, "the peaks are not those of the joints, in their order")
    spans = [((load.t0, load.t1), load.share) for load in loads_of(statement) if load.t1 > load.t0]
    spans = spans or [(statement.whole, 1.0)]
    for joint, peak in enumerate(stated if same else ()):
        for order, kind in enumerate(KINDS, start=1):
            size, ratio = getattr(peak, kind), getattr(peak, f"{kind}_ratio")
            what, is_limited = f"the peak {kind} of {peak.joint}", order < 3 or limited
            if size is None or ratio is None or not is_limited:
                none = size is None and ratio is None and not is_limited
                statement.require(none, Code.PEAK, f"whether there is {what} is stated wrongly")
                continue
            limit = float(getattr(robot.limits, kind)[joint])
            slack = WITHIN[order - 1] * limit
            shares = [(when, ratio * limit * (share if order > 1 else 1.0)) for when, share in spans]
            _require_peak(statement, order, joint, [(statement.whole, size)], slack, what)
            _require_peak(statement, order, joint, shares, slack, f"the share of the limit that is {what}")


def _require_peak(
    statement: Statement, order: int, joint: int, sizes: list[tuple[Interval, float]], slack: float, what: str
) -> None:
    """A derivative of a joint is never larger than the size over each interval, and once as large in one of them."""
    one = JOINT[joint]
    never = all(statement.sum_keeps(order, one, -size - slack, size + slack, when) for when, size in sizes)
    statement.require(never, Code.PEAK, f"{what} may be larger than is stated")
    once = any(
        size - slack <= 0.0
        or statement.sum_keeps(order, one, size - slack, math.inf, when, once=True)
        or statement.sum_keeps(order, one, -math.inf, slack - size, when, once=True)
        for when, size in sizes
    )
    statement.require(once, Code.PEAK, f"{what} is not reached")


def require_tool(statement: Statement, claims: Claims) -> None:
    """The peaks of the tool point over all of the motion, and its largest acceleration while a part is held."""
    stated, pull, whole = claims.tool, claims.tool_acceleration, statement.whole
    if stated is not None:
        for order, name, size, time in (
            (1, "speed", stated.speed, stated.speed_time),
            (2, "acceleration", stated.acceleration, stated.acceleration_time),
        ):
            most, beside = size * (1.0 + BETWEEN) + STANDS, BESIDE_S if order == 2 else SAME
            kept = _is_rate(statement, order, -1.0, most, whole)
            statement.require(kept, Code.PEAK, f"the {name} of the tool may be larger than is stated")
            off = AT_ITS_TIME * size + OFF[order - 1]
            when = (max(time - beside, whole[0]), min(time + beside, whole[1]))
            reached = _is_rate(statement, order, size - off, size + off, when, once=True)
            statement.require(reached, Code.PEAK, f"the {name} of the tool is not what is stated then", (time, time))
    if pull is not None:
        legs = statement.stages[: len(statement.plan.legs)]
        held = [stage.when for stage in legs if stage.held is not None and stage.when[1] > stage.when[0]]
        spans, least = held or [whole], pull * (1.0 - REACHED) - OFF[1]
        kept = all(_is_rate(statement, 2, -1.0, pull * (1.0 + BETWEEN) + STANDS, when) for when in spans)
        statement.require(kept, Code.PEAK, "the tool may accelerate harder with a part than is stated")
        once = least <= 0.0 or any(_is_rate(statement, 2, least, math.inf, when, once=True) for when in spans)
        statement.require(once, Code.PEAK, "the tool never accelerates as hard with a part as is stated")


def _is_rate(
    statement: Statement, order: int, least: float, most: float, when: Interval, *, once: bool = False
) -> bool:
    """Whether rows state the tool point's speed or acceleration in the world."""
    worlds = [-1, statement.frames[WORLD]] if WORLD in statement.frames and order == 1 else [-1]
    return any(statement.tool_keeps(world, order, least, most, when, once=once) for world in worlds)
