"""Does the claim state that joints rest where the task requires it, go on at vias, and give the tool its pitch and
roll?

Rows of sums bound a sum of shares of the joints, or a derivative of it. Pitch and roll are such sums (H2).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import arms, laws
from assur.planner.checker.statement.arms import hand_shares
from assur.planner.checker.statement.differences import MEET, SAME, TRACKED_RAD, Interval
from assur.planner.checker.statement.statement import JOINT, Statement
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import LegKind
from assur.planner.model.scene import Scene
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.robots.tilting import PolarArm

STANDS = 2e-8
"""A joint that stays within this of its value stands, rad or m: the claim checker keeps a tenth of it for rounding."""
STRAIGHT_RAD, HALF_RAD = 1e-4, 1e-6
"""How far pitch and roll may be off the way along a straight leg; ways so near to half a turn may go round either
way."""
BESIDE_S, WAY = 0.01, 1e-9
"""How long before and behind a via its joints are evaluated, s; a joint that goes a shorter way stands, rad or m."""


def require_joints(statement: Statement) -> None:
    """The arm stands while it waits, rests where a step matches the position, and goes on at vias."""
    for leg in statement.plan.legs:
        if leg.kind is LegKind.WAIT:
            when = (leg.t0, leg.t1)
            stands = _are_near(statement, 0, statement.state_at(leg.t0)[0].tolist(), STANDS, when)
            statement.require(stands, Code.JOINTS, "the arm is not stated to stand while it waits", when)
    for number, step in enumerate(statement.scene.task):
        time = statement.arrivals[number].time
        if step.via:
            goes_on = step.leg != "joint" or _is_flown_by(statement, time)
            what = f"the arm may stop at {step.name}, which is to be flown by"
            statement.require(goes_on, Code.JOINTS, what, (time, time))
        elif step.match == "position":
            rests = _are_near(statement, 1, [0.0] * statement.plan.trajectory.n, MEET, (time, time))
            what = f"the arm is not stated to rest at {step.name}"
            statement.require(rests, Code.JOINTS, what, (time, time))


def _are_near(statement: Statement, order: float, values: list[float], off: float, when: Interval) -> bool:
    """Whether each joint, or its derivative of that order, is stated to be within `off` of its value."""
    for joint, value in zip(JOINT, values, strict=False):
        if not statement.keeps("sums", (order, *joint), value - off, value + off, when):
            return False
    return True


def _is_flown_by(statement: Statement, time: float) -> bool:
    """The arm does not wait at a via; and a joint goes on, or each joint that moves turns round there."""
    if any(leg.kind is LegKind.WAIT and abs(leg.t0 - time) <= SAME for leg in statement.plan.legs):
        return False
    least = MEET + 2.0 * SAME  # what is slower may rest
    signed = np.concatenate([np.array(JOINT), -np.array(JOINT)])[:, : statement.plan.trajectory.n].tolist()
    if any(statement.sum_keeps(1, joint, least, math.inf, (time, time)) for joint in signed):
        return True
    if not statement.whole[0] < time < statement.whole[1]:
        return True
    before, there, behind = (statement.state_at(time + off)[0] for off in (-BESIDE_S, 0.0, BESIDE_S))
    ways = there - before, behind - there
    goes_on = (np.minimum(np.abs(ways[0]), np.abs(ways[1])) > WAY) & (ways[0] * ways[1] > 0.0)
    return not goes_on.any()


def require_hands(statement: Statement) -> None:
    """Pitch and roll of the tool: those of the request, or, where it leaves them free, of the arrival."""
    has_hand = "pitch" in statement.scene.robot.coordinates
    for number, step in enumerate(statement.scene.task):
        arrival = statement.arrivals[number]
        angles, when = (arrival.pitch, arrival.roll), (arrival.time, arrival.until)
        if not has_hand:
            what = f"{step.name} is met with a pitch, which the arm has not"
            statement.require(angles == (None, None), Code.ARRIVAL, what, when)
            continue
        if step.target is None or arrival.pitch is None or arrival.roll is None:
            what = f"it is not stated with what pitch and roll {step.name} is met"
            statement.require(False, Code.ARRIVAL, what, when)
            continue
        pairs = zip((arrival.pitch, arrival.roll), (step.target.pitch, step.target.roll), strict=True)
        same = all(y is None or abs(math.remainder(x - y, math.tau)) <= MEET for x, y in pairs)
        statement.require(same, Code.ARRIVAL, f"{step.name} is met with another pitch or roll", when)
        directed = arrival.missed_by is not None or _is_directed(statement, number, (arrival.pitch, arrival.roll))
        what = f"the tool is not stated to have the pitch and roll of {step.name}"
        statement.require(directed, Code.JOINTS, what, when)
        straight = step.leg != "cartesian" or _goes_straight(statement, number)
        what = f"pitch and roll are not stated to go straight on the way to {step.name}"
        statement.require(straight, Code.JOINTS, what, when)


def _is_directed(statement: Statement, number: int, angles: tuple[float, float]) -> bool:
    """Pitch and roll are these when the control point is met and while it is tracked, and do not change where its
    velocity is matched."""
    arrival, tracked = statement.arrivals[number], statement.legs(number, tracked=True)
    met = (arrival.time, arrival.time)
    spans = [(MEET, met)] + ([(TRACKED_RAD, (tracked[0].t0, tracked[-1].t1))] if tracked else [])
    for shares, angle in zip(hand_shares(statement.scene.robot), angles, strict=True):
        # whatever full turns they differ by
        value = float(shares @ statement.state_at(arrival.time)[0])
        goal = angle + math.tau * round((value - angle) / math.tau)
        if not all(statement.sum_keeps(0, shares, goal - off, goal + off, when) for off, when in spans):
            return False
        if arrival.matched and not statement.sum_keeps(1, shares, -MEET, MEET, met):
            return False
    return True


def _goes_straight(statement: Statement, number: int) -> bool:
    """Pitch and roll go from those at the begin of a straight leg to those at its end, both by one share, the short way
    round: a row bounds them across that way, and one along it."""
    when, hand = statement.way(number), hand_shares(statement.scene.robot)
    begin, end = (hand @ statement.state_at(t)[0] for t in when)
    way, length = end - begin, float(np.hypot(*(end - begin)))
    if not (np.abs(way) <= math.pi + HALF_RAD).all():
        return False
    ahead = way / length if length > HALF_RAD else np.array([1.0, 0.0])
    across = np.array([-ahead[1], ahead[0]])
    return all(
        statement.sum_keeps(
            0, direction @ hand, direction @ begin - STRAIGHT_RAD, direction @ begin + far + STRAIGHT_RAD, when
        )
        for direction, far in ((ahead, length), (across, 0.0))
    )


# Does the claim state that each arch goes up and then down, and as high as its step requires?
#
# The lift is a joint, so rows of sums state it: at the begin, the top and the end of an arch, and its rate in between.

BACK_M, BACK = 1e-4, 0.1
"""m, and share of the height to which an arch rises above its ends: so far the lift may go the wrong way in total. A
motion through ticks of a controller, 4 ms apart, sways by some tenths of a millimetre where the lift turns."""
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
    lift = JOINT[robot.lift]
    heights = [(t, low, high) for t, until, low, high in statement.bounds("sums", (0.0, *lift)) if t == until]
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
        own = ((a, b, -least if is_up else most) for a, b, least, most in statement.bounds("sums", (1.0, *lift)))
        rates = sorted((a, b, rate) for a, b, rate in own if first <= a < b <= last and rate < c.GREATEST)
        if [first, *(b for _, b, _ in rates)] != [*(a for a, _, _ in rates), last]:
            return False
        back += sum(max(rate, 0.0) * (b - a) for a, b, rate in rates)
    return back <= BACK_M + BACK * (low - highest)


# Does the claim state how near the arm comes to singular positions, and in which working mode it is?
#
# Of each family of arms there are numbers whose sizes are the margin, and whose signs are the mode: sines of the angles
# at which links meet (K10), (K33), and of arms that tilt the share of the reach by which the flange is off the base
# axis (K25).

MARGIN = 1e-3
"""By how much a margin may be missed between the instants at which a planner evaluates it, 1 ms apart."""
AHEAD, LEFT, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
LINK1, LINK2, LINK3, LINK4 = 1, 2, 3, 4


class Number(NamedTuple):
    """The x axis of a link (for a `length` that is not 0, m: the way to its origin from that of the other link, divided
    by the length) times an axis of another link; links by their numbers in a claim."""

    link: int
    other: int
    along: tuple[float, float, float]
    length: float = 0.0

    @property
    def about(self) -> tuple[float, ...]:
        """The columns of a row of axes between times and bounds."""
        on = (0.0, 0.0, 0.0) if self.length > 0.0 else AHEAD
        return self.link, self.length > 0.0, *on, self.other, *self.along

    @property
    def size(self) -> float:
        """What the number is multiplied by in a row."""
        return self.length or 1.0


def numbers_of(robot: Robot) -> list[Number]:
    """What the singularity margin of an arm is the least size of."""
    if isinstance(robot, Scara):
        return [Number(LINK2, LINK1, LEFT)]  # sin θ2
    if isinstance(robot, FiveBar):  # of each crank and its coupler
        return [Number(3, 1, LEFT), Number(4, 2, LEFT)]
    if isinstance(robot, PolarArm):
        longest = float(robot.limits.upper[2])
        return [Number(LINK3, LINK2, AHEAD, longest), Number(LINK3, LINK1, AHEAD, longest)]
    lengths = [robot.l1, robot.l2] + ([robot.l3] if isinstance(robot, FiveAxisArm) else [])  # type: ignore[attr-defined]
    return [Number(LINK3, LINK2, UP), Number(len(robot.links) - 1, LINK1, AHEAD, sum(lengths))]


def couplers_of(robot: Robot) -> list[Number]:
    """What the parallel margin is the size of: the sine of the angle between both couplers, if there are any."""
    return [Number(4, 3, LEFT)] if isinstance(robot, FiveBar) else []


def signs_of(robot: Robot, mode: str) -> list[float]:
    """The signs of `numbers_of` in a working mode; 0: any."""
    words = mode.split("-")
    if isinstance(robot, Scara | FiveBar):  # to the left is clockwise
        return [-1.0 if word == "left" else 1.0 for word in words]
    over = words[0] == "back"  # the arm reaches over its base
    radius = -1.0 if over else 1.0
    if isinstance(robot, PolarArm):
        return [0.0, radius]
    return [1.0 if (words[-1] == "down") is not over else -1.0, radius]


def values(robot: Robot, q: FloatArray) -> list[float]:
    """The numbers of an arm with joints at q (n,)."""
    links, found = arms.textbook(robot, q.tolist()), list[float]()
    for link, other, along, length in numbers_of(robot):
        if length > 0.0:
            yaw, pitch, _ = links[other][1]
            ahead = (math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), math.sin(pitch))
            way = zip(links[link][0], links[other][0], ahead, strict=True)
            found.append(sum((x - y) * u for x, y, u in way) / length)
        else:
            k = along.index(1.0) - 1
            found.append(math.sin(links[link][1][k] - links[other][1][k]))
    return found


def mode_at(robot: Robot, q: FloatArray) -> str:
    """The working mode of joints q (n,); "" for none."""
    own = values(robot, q)
    if not all(map(math.isfinite, own)):
        return ""
    signs = [1.0 if value > 0.0 or (k == 1 and value == 0.0) else -1.0 for k, value in enumerate(own)]
    fits = [all(x in (0.0, y) for x, y in zip(signs_of(robot, mode), signs, strict=True)) for mode in robot.modes]
    return robot.modes[fits.index(True)]


@lru_cache(maxsize=4)
def _mode_at_start(scene: Scene) -> str:
    return mode_at(scene.robot, scene.start.q)


def require_modes(statement: Statement) -> None:
    """Every control point is met in the working mode that is required; of a via that is missed, that of the pose that
    is missed."""
    robot, required = statement.scene.robot, statement.scene.options.elbow
    if required == "auto":
        return
    mode = _mode_at_start(statement.scene) if required == "keep" else required
    for arrival in statement.plan.arrivals:
        when = (arrival.time, arrival.time)
        if arrival.missed_by is None:
            stated = _is_in_mode(statement, mode, when)
        else:
            q = statement.state_at(arrival.time)[0] - np.array(arrival.missed_by.joints)
            stated = mode_at(robot, q) == mode
        what = f"{arrival.control_point} is not stated to be met in mode {mode or 'none'}, which is required"
        statement.require(stated, Code.ELBOW, what, when)


def require_margins(statement: Statement) -> None:
    """The margin is kept in legs that track a point or go along a line or a path, and where the velocity of a moving
    point is matched."""
    scene, least = statement.scene, statement.scene.options.singularity_margin - MARGIN
    if not least > 0.0:
        return
    numbers = [*numbers_of(scene.robot), *couplers_of(scene.robot)]
    for number, step in enumerate(scene.task):
        arrival, straight = statement.arrivals[number], step.leg == "cartesian"
        legs = statement.legs(number, tracked=not straight)
        if straight:
            legs = [leg for leg in legs if leg.kind is not LegKind.WAIT and leg.t1 <= arrival.time]
        spans = [(leg.t0, leg.t1) for leg in legs]
        if not spans and step.target is not None and step.match == "velocity" and not step.via:
            moves = not laws.stands(scene.frames[step.target.frame].law)
            spans += [(arrival.time, arrival.time)] * moves
        for when in spans:
            kept = all(_is_beyond(statement, each, least, when) for each in numbers)
            what = f"the arm may come nearer to a singular position at {step.name} than is required"
            statement.require(kept, Code.SINGULARITY, what, when)


def require_postures(statement: Statement, claims: Claims) -> None:
    """Working modes of arrivals and least margins are what the answer states: the arm comes no nearer to a singular
    position, and once as near."""
    robot, whole = statement.scene.robot, statement.whole
    for arrival, mode in zip(statement.plan.arrivals, claims.modes or (), strict=False):
        met = (arrival.time, arrival.time)
        stated = mode is None or _is_in_mode(statement, mode, met)
        what = f"{arrival.control_point} is not stated to be met in mode {mode or '':.40}"
        statement.require(stated, Code.ELBOW, what, met)
    for name, claimed, numbers in (
        ("singularity", claims.singularity, numbers_of(robot)),
        ("parallel", claims.parallel, couplers_of(robot)),
    ):
        margin = None if claimed is None else claimed[0]
        has_one = claimed is None or (margin is not None) is bool(numbers)
        statement.require(has_one, Code.SINGULARITY, f"whether the arm has a {name} margin is stated wrongly")
        if margin is None or not numbers:
            continue
        least = margin - MARGIN
        kept = least <= 0.0 or all(_is_beyond(statement, each, least, whole) for each in numbers)
        what = f"the arm may come nearer to a singular position ({name}) than is stated"
        statement.require(kept, Code.SINGULARITY, what)
        most = margin + MARGIN
        reached = any(
            statement.keeps("axes", each.about, -most * each.size, most * each.size, whole, once=True)
            for each in numbers
        )
        what = f"the arm does not come as near to a singular position ({name}) as is stated"
        statement.require(reached, Code.SINGULARITY, what)


def _is_in_mode(statement: Statement, mode: str, when: Interval) -> bool:
    """Whether the claim states that the arm is in a working mode."""
    robot = statement.scene.robot
    pairs = zip(numbers_of(robot), signs_of(robot, mode) if mode in robot.modes else [], strict=False)
    own = [_is_beyond(statement, number, 0.0, when, sign) for number, sign in pairs if sign]
    return bool(own) and all(own)


def _is_beyond(statement: Statement, number: Number, least: float, when: Interval, sign: float = 0.0) -> bool:
    """Whether a number is no smaller in size than `least` all the time, with a sign (0: any)."""
    size = least * number.size
    return (sign >= 0.0 and statement.keeps("axes", number.about, size, math.inf, when)) or (
        sign <= 0.0 and statement.keeps("axes", number.about, -math.inf, -size, when)
    )
