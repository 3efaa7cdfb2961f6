"""Does the claim state that each arch goes up and then down, and as high as its step asks?

The lift is a joint, so rows of sums state it: at the begin, the top and the end of an arch, and its rate in between.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from assur.planner.checker.statement.arms import flange_row
from assur.planner.checker.statement.differences import MEET, SAME, Difference, Interval, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.joints import sums_of
from assur.planner.claim import columns as c
from assur.planner.model.outcome import LegKind

BACK_M, BACK = 1e-4, 0.1
"""m, and share of the height to which an arch rises above its ends: so far the lift may go the wrong way in total. A
motion through ticks of a controller, 4 ms apart, sways by some tenths of a millimetre where the lift turns."""
RISE_M = 1e-6
"""m. So far an arch goes above both of its ends at least, or to the end of the lift's range."""


def arches_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Differences of arches."""
    legs = [leg for leg in handling.plan.legs if leg.kind is LegKind.ARCH]
    for leg in legs:
        if not _goes_over(handling, claim, (leg.t0, leg.t1)):
            what = "a leg that is called ARCH is not stated to go up and then down"
            yield Difference(Topic.ARCH, what, (leg.t0, leg.t1))
    for number, step in enumerate(handling.scene.task):
        spans = [leg for leg in legs if leg.step == number]
        if step.arch is None or not spans:
            continue
        rows, tool = claim.axes, [flange_row(handling.scene.robot), 1.0, *handling.tcp[:3], -1.0, 0.0, 0.0, 1.0]
        high = (np.abs(rows[:, c.AXIS_LINK : c.AXIS_LOW] - tool) <= SAME).all(1)
        high &= (spans[0].t0 <= rows[:, c.AXIS_T0]) & (rows[:, c.AXIS_T1] <= spans[-1].t1)
        if not (high & (rows[:, c.AXIS_LOW] >= step.arch.top_m - MEET - SAME)).any():
            yield Difference(Topic.ARCH, f"the arch to {step.name} may be too low", (spans[0].t0, spans[-1].t1))


def _goes_over(handling: Handling, claim: c.Claim, when: Interval) -> bool:
    """The lift goes up and then down, up to `BACK_M` and `BACK`, and higher than both ends."""
    robot, (t0, t1) = handling.scene.robot, when
    if robot.lift is None:
        return False
    lift = np.eye(len(robot.joints))[robot.lift]
    ends = [min((high for _, high in sums_of(claim, 0, lift, (t, t))), default=np.inf) for t in when]
    rows = claim.sums[(np.abs(claim.sums[:, c.SUM_SHARE : c.SUM_LOW][:, : len(lift)] - lift) <= SAME).all(1)]
    rows = rows[(t0 <= rows[:, c.SUM_T0]) & (rows[:, c.SUM_T1] <= t1)]
    instants = rows[(rows[:, c.SUM_ORDER] == 0.0) & (rows[:, c.SUM_T0] == rows[:, c.SUM_T1])]
    if not len(instants):
        return False
    turn, low = instants[np.argmax(instants[:, c.SUM_LOW])][[c.SUM_T0, c.SUM_LOW]].tolist()
    if not low >= min(max(ends) + RISE_M, float(robot.limits.upper[robot.lift]) - RISE_M) - MEET:
        return False
    back = 0.0
    for first, last, sign, column in ((t0, turn, -1.0, c.SUM_LOW), (turn, t1, 1.0, c.SUM_HIGH)):
        own = rows[(rows[:, c.SUM_ORDER] == 1.0) & (rows[:, c.SUM_T0] >= first) & (rows[:, c.SUM_T1] <= last)]
        own = own[np.abs(own[:, column]) < c.GREATEST]
        times = np.sort(own[:, [c.SUM_T0, c.SUM_T1]], axis=0)
        if first < last and not (
            len(own) and times[0, 0] == first and times[-1, 1] == last and (times[1:, 0] == times[:-1, 1]).all()
        ):
            return False
        back += float((np.maximum(sign * own[:, column], 0.0) * (own[:, c.SUM_T1] - own[:, c.SUM_T0])).sum())
    return bool(back <= BACK_M + BACK * (low - max(ends)))
