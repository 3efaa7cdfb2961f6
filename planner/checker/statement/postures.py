"""Does the claim state how near the arm comes to singular positions, and in which working mode it is?

Of each family of arms there are numbers whose sizes are the margin, and whose signs are the mode: sines of the angles
at which links meet (K10), (K33), and of arms that tilt the share of the reach by which the flange is off the base axis
(K25).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import arms, laws
from assur.planner.checker.statement.differences import Interval
from assur.planner.checker.statement.statement import Statement
from assur.planner.checker.verdict import Code
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import LegKind
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara

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
    places, angles = (each[:, 0] for each in arms.textbook(robot, q[None, :]))
    found = []
    for link, other, along, length in numbers_of(robot):
        if length > 0.0:
            yaw, pitch = angles[other, :2]
            ahead = np.array([math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), math.sin(pitch)])
            found.append(float((places[link] - places[other]) @ ahead) / length)
        else:
            turned = angles[link, along.index(1.0) - 1] - angles[other, along.index(1.0) - 1]
            found.append(math.sin(float(turned)))
    return found


def mode_at(robot: Robot, q: FloatArray) -> str:
    """The working mode of joints q (n,); "" for none."""
    own = values(robot, q)
    if not np.isfinite(own).all():
        return ""
    signs = [1.0 if value > 0.0 or (k == 1 and value == 0.0) else -1.0 for k, value in enumerate(own)]
    fits = [all(x in (0.0, y) for x, y in zip(signs_of(robot, mode), signs, strict=True)) for mode in robot.modes]
    return robot.modes[fits.index(True)]


def require_modes(statement: Statement) -> None:
    """Every control point is met in the working mode that is required; of a via that is missed, that of the pose that
    is missed."""
    robot, required = statement.scene.robot, statement.scene.options.elbow
    if required == "auto":
        return
    mode = mode_at(robot, statement.scene.start.q) if required == "keep" else required
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
    numbers = [*numbers_of(scene.robot), *couplers_of(scene.robot)]
    for number, step in enumerate(scene.task) if least > 0.0 else ():
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
    for name, said, numbers in (
        ("singularity", claims.singularity, numbers_of(robot)),
        ("parallel", claims.parallel, couplers_of(robot)),
    ):
        margin = None if said is None else said[0]
        has_one = said is None or (margin is not None) is bool(numbers)
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
