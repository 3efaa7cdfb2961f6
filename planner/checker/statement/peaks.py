"""Does the claim state the peaks of the joints and of the tool as the answer does: never more, and once as much?"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from assur.planner.checker.statement.arms import flange_row
from assur.planner.checker.statement.differences import SAME, Difference, Interval, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.phases import Stage
from assur.planner.claim import columns as c
from assur.planner.model.claims import Claims
from assur.planner.model.load import Carried
from assur.planner.model.outcome import JointPeak
from assur.planner.model.scene import WORLD

KINDS = ("velocity", "acceleration", "jerk")
WITHIN = (1e-6, 1e-6, 1e-3)
"""By how much a peak of each kind may be off, as a share of the joint's limit: rounding of knots."""
BETWEEN, REACHED = 0.01, 1e-3
"""Shares by which a peak of the tool, which is evaluated at instants, may be exceeded between them; and by which the
largest acceleration with a part may be missed, whose instant is not stated."""
AT_ITS_TIME, OFF, STANDS = 1e-4, (1e-6, 1e-3), 1e-6
"""A share by which a peak may be off at its instant, and m/s and m/s² in addition (bounds of a closed chain round the
acceleration by 0.5 mm/s²); m/s or m/s²: what is no faster stands."""
BESIDE_S = 2e-9
"""A jump of the acceleration is evaluated at most so far before and behind it, s."""
ROUNDING = 1e-12
"""Of sums and products in another order, as a share."""


def peaks_agree(
    handling: Handling, loads: list[Carried], stated: tuple[JointPeak, ...] | None, claim: c.Claim
) -> Iterator[Difference]:
    """The peaks of the joints, and their shares of the limits that each load leaves."""
    robot, path = handling.scene.robot, handling.plan.trajectory
    if stated is None:
        return
    if [peak.joint for peak in stated] != [joint.name for joint in robot.joints]:
        yield Difference(Topic.PEAK, "the peaks are not those of the joints, in their order")
        return
    whole = (float(path.time[0]), float(path.time[-1]))
    spans = [((load.t0, load.t1), load.share) for load in loads if load.t1 > load.t0] or [(whole, 1.0)]
    for order, kind in enumerate(KINDS, start=1):
        is_limited = order < 3 or handling.scene.options.jerk_limited
        for joint, peak in enumerate(stated):
            size, ratio = getattr(peak, kind), getattr(peak, f"{kind}_ratio")
            what = f"the peak {kind} of {peak.joint}"
            if size is None or ratio is None or not is_limited:
                if is_limited or size is not None or ratio is not None:
                    yield Difference(Topic.PEAK, f"whether there is {what} is stated wrongly")
                continue
            limit = float(getattr(robot.limits, kind)[joint])
            slack = WITHIN[order - 1] * limit
            shares = [(when, ratio * limit * (share if order > 1 else 1.0)) for when, share in spans]
            for sizes, of in (([(whole, size)], what), (shares, f"the share of the limit that is {what}")):
                if not all(_never_more(claim, order, joint, most + slack, when) for when, most in sizes):
                    yield Difference(Topic.PEAK, f"{of} may be larger than is stated")
                if not any(_as_much(claim, order, joint, most - slack, when) for when, most in sizes):
                    yield Difference(Topic.PEAK, f"{of} is not reached")


def _sums(claim: c.Claim, order: int, joint: int) -> Iterator[list[float]]:
    """The rows about a derivative of one joint."""
    shares = [float(k == joint) for k in range(c.MOST_JOINTS)]
    for row in claim.sums.tolist():
        if row[c.SUM_ORDER] == order and row[c.SUM_SHARE : c.SUM_LOW] == shares:
            yield row


def _never_more(claim: c.Claim, order: int, joint: int, most: float, when: Interval) -> bool:
    most *= 1.0 + ROUNDING
    return any(
        row[c.SUM_T0] <= when[0] and when[1] <= row[c.SUM_T1] and -most <= row[c.SUM_LOW] and row[c.SUM_HIGH] <= most
        for row in _sums(claim, order, joint)
    )


def _as_much(claim: c.Claim, order: int, joint: int, least: float, when: Interval) -> bool:
    least *= 1.0 - ROUNDING
    return least <= 0.0 or any(
        when[0] - SAME <= row[c.SUM_T0] <= row[c.SUM_T1] <= when[1] + SAME
        and (row[c.SUM_LOW] >= least or row[c.SUM_HIGH] <= -least)
        for row in _sums(claim, order, joint)
    )


def tool_agrees(handling: Handling, stages: list[Stage], claims: Claims, claim: c.Claim) -> Iterator[Difference]:
    """The peaks of the tool point over all of the motion, and its largest acceleration while a part is held."""
    path, said = handling.plan.trajectory, claims.tool
    whole = (float(path.time[0]), float(path.time[-1]))
    if said is not None:
        for order, name, size, time in (
            (1, "speed", said.speed, said.speed_time),
            (2, "acceleration", said.acceleration, said.acceleration_time),
        ):
            most, beside = size * (1.0 + BETWEEN) + STANDS, BESIDE_S if order == 2 else SAME
            if not is_rate_stated(handling, claim, order, (-1.0, most), whole):
                yield Difference(Topic.PEAK, f"the {name} of the tool may be larger than is stated")
            off = AT_ITS_TIME * size + OFF[order - 1]
            bounds = (size - off, size + off)
            within = (max(time - beside, whole[0]), min(time + beside, whole[1]))
            if not is_rate_stated(handling, claim, order, bounds, within, inside=True):
                yield Difference(Topic.PEAK, f"the {name} of the tool is not what is stated then", (time, time))
    pull = claims.tool_acceleration
    if pull is not None:
        legs = stages[: len(handling.plan.legs)]
        held = [stage.when for stage in legs if stage.held is not None and stage.when[1] > stage.when[0]]
        spans = held or [whole]
        if not all(is_rate_stated(handling, claim, 2, (-1.0, pull * (1.0 + BETWEEN) + STANDS), when) for when in spans):
            yield Difference(Topic.PEAK, "the tool may accelerate harder with a part than is stated")
        bounds = (pull * (1.0 - REACHED) - OFF[1], float("inf"))
        once = any(is_rate_stated(handling, claim, 2, bounds, when, inside=True) for when in spans)
        if not (bounds[0] <= 0.0 or once):
            yield Difference(Topic.PEAK, "the tool never accelerates as hard with a part as is stated")


def is_rate_stated(
    handling: Handling, claim: c.Claim, order: int, bounds: Interval, when: Interval, *, inside: bool = False
) -> bool:
    """Whether rows state that the tool point's speed or acceleration in the world is within bounds over an interval, or
    a row that it is once within it (`inside`)."""
    frames, flange = list(handling.scene.frames), flange_row(handling.scene.robot)
    worlds: Iterable[float] = (-1.0, float(frames.index(WORLD))) if WORLD in frames else (-1.0,)
    low, high = bounds[0] - ROUNDING * abs(bounds[0]), bounds[1] + ROUNDING * abs(bounds[1])
    own = list[Interval]()
    for row in claim.rates.tolist():
        about = row[c.RATE_ORDER] == order and row[c.RATE_LINK] == flange and row[c.RATE_FRAME] in worlds
        point = zip(row[c.RATE_POINT : c.RATE_FRAME], handling.tcp[:3], strict=True)
        within = low <= row[c.RATE_LEAST] and row[c.RATE_MOST] <= high
        if about and within and all(abs(x - y) <= SAME for x, y in point):
            own.append((row[c.RATE_T0], row[c.RATE_T1]))
    if inside:
        return any(when[0] - SAME <= first <= last <= when[1] + SAME for first, last in own)
    reached = when[0]
    for first, last in sorted(own):
        reached = max(reached, last) if first <= reached else reached
    return bool(own) and min(own)[0] <= when[0] and reached >= when[1]
