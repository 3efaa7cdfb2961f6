"""Does the claim state how near the arm comes to singular positions, and in which working mode it is?

Of each family of arms there are numbers whose sizes are the margin, and whose signs are the mode: sines of the angles
at which links meet (K10), (K33), and of arms that tilt the share of the reach by which the flange is off the base axis
(K25).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import arms
from assur.planner.checker.statement.differences import SAME, Difference, Interval, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.claim import columns as c
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import LegKind
from assur.planner.model.scene import Move
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara

MARGIN = 1e-3
"""By how much a margin may be missed between the instants at which a planner evaluates it, 1 ms apart."""
AHEAD, LEFT, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
LINK1, LINK2, LINK3, LINK4 = 1, 2, 3, 4
Row = list[float]


class Number(NamedTuple):
    """The x axis of a link (for a `length` that is not 0, m: the way to its origin from that of the other link, divided
    by the length) times an axis of another link; links by their numbers in a claim."""

    link: int
    other: int
    along: tuple[float, float, float]
    length: float = 0.0


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


def modes_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Every control point is met in the working mode that is asked for; of a via that is missed, that of the pose that
    is missed."""
    scene, asked = handling.scene, handling.scene.options.elbow
    if asked == "auto":
        return
    mode = mode_at(scene.robot, scene.start.q) if asked == "keep" else asked
    for arrival in handling.plan.arrivals:
        when = (arrival.time, arrival.time)
        if arrival.missed_by is None:
            stated = is_in_mode(scene.robot, mode, claim, when)
        else:
            q = arms.states_at(handling.plan.trajectory, arrival.time)[0] - np.array(arrival.missed_by.joints)
            stated = mode_at(scene.robot, q) == mode
        if not stated:
            what = f"{arrival.control_point} is not stated to be met in mode {mode or 'none'}, which is asked for"
            yield Difference(Topic.MODE, what, when)


def is_in_mode(robot: Robot, mode: str, claim: c.Claim, when: Interval) -> bool:
    """Whether the claim states that the arm is in a working mode."""
    pairs = zip(numbers_of(robot), signs_of(robot, mode) if mode in robot.modes else [], strict=False)
    own = [_keeps(claim, number, -SAME, when, sign) for number, sign in pairs if sign]
    return bool(own) and all(own)


def margins_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """The margin is kept in legs that track a point or go along a line or a path, and where the velocity of a moving
    point is matched."""
    scene, legs = handling.scene, handling.plan.legs
    least = scene.options.singularity_margin - MARGIN
    if not least > 0.0:
        return
    for number, step in enumerate(scene.task):
        arrival = handling.arrivals[number]
        own = [(leg, tracks) for leg, tracks in zip(legs, handling.tracks, strict=True) if leg.step == number]
        if isinstance(step, Move) and step.leg == "cartesian":
            guided = [leg for leg, _ in own if leg.kind is not LegKind.WAIT and leg.t1 <= arrival.time]
        else:
            guided = [leg for leg, tracks in own if tracks]
        spans = [(leg.t0, leg.t1) for leg in guided]
        if not spans and isinstance(step, Move) and step.match == "velocity" and not step.via:
            moves = scene.frames[step.target.frame].law.kind != "fixed"
            spans += [(arrival.time, arrival.time)] * moves
        for when in spans:
            for kept in (numbers_of(scene.robot), couplers_of(scene.robot)):
                if not all(_keeps(claim, each, least, when) for each in kept):
                    what = f"the arm may come nearer to a singular position at {step.name} than is asked for"
                    yield Difference(Topic.MARGIN, what, when)


def postures_agree(handling: Handling, claims: Claims, claim: c.Claim) -> Iterator[Difference]:
    """Working modes of arrivals and least margins are what the answer states: the arm comes no nearer to a singular
    position, and once as near."""
    robot, arrivals, path = handling.scene.robot, handling.plan.arrivals, handling.plan.trajectory
    for arrival, mode in zip(arrivals, claims.modes or (), strict=False):
        if mode is not None and not is_in_mode(robot, mode, claim, (arrival.time, arrival.time)):
            what = f"{arrival.control_point} is not stated to be met in mode {mode:.40}"
            yield Difference(Topic.MODE, what, (arrival.time, arrival.time))
    whole = (float(path.time[0]), float(path.time[-1]))
    for name, said, numbers in (
        ("singularity", claims.singularity, numbers_of(robot)),
        ("parallel", claims.parallel, couplers_of(robot)),
    ):
        if said is None:
            continue
        margin = said[0]
        if margin is None or not numbers:
            if (margin is not None) is not bool(numbers):
                yield Difference(Topic.MARGIN, f"whether the arm has a {name} margin is stated wrongly")
            continue
        least = margin - MARGIN
        if not (least <= 0.0 or all(_keeps(claim, each, least, whole) for each in numbers)):
            yield Difference(Topic.MARGIN, f"the arm may come nearer to a singular position ({name}) than is stated")
        if not any(_reaches(claim, each, margin + MARGIN, whole) for each in numbers):
            yield Difference(
                Topic.MARGIN, f"the arm does not come as near to a singular position ({name}) as is stated"
            )


def _rows(claim: c.Claim, number: Number) -> Iterator[tuple[Row, float]]:
    """The rows about a number, and what it is multiplied by in them."""
    on = (0.0, 0.0, 0.0) if number.length > 0.0 else AHEAD
    own = [number.link, number.length > 0.0, *on, number.other, *number.along]
    for row in claim.axes.tolist():
        if all(abs(x - y) <= SAME for x, y in zip(row[c.AXIS_LINK : c.AXIS_LOW], own, strict=True)):
            yield row, number.length or 1.0


def _keeps(claim: c.Claim, number: Number, least: float, when: Interval, sign: float = 0.0) -> bool:
    """Whether a row states that a number is no smaller in size than `least` all the time, with a sign (0: any)."""
    return any(
        row[c.AXIS_T0] <= when[0]
        and when[1] <= row[c.AXIS_T1]
        and (
            (sign >= 0.0 and row[c.AXIS_LOW] >= (least - SAME) * size)
            or (sign <= 0.0 and row[c.AXIS_HIGH] <= (SAME - least) * size)
        )
        for row, size in _rows(claim, number)
    )


def _reaches(claim: c.Claim, number: Number, most: float, within: Interval) -> bool:
    """Whether a row states that a number is once no larger in size than `most`."""
    return any(
        within[0] <= row[c.AXIS_T0] <= row[c.AXIS_T1] <= within[1]
        and row[c.AXIS_LOW] >= -(most + SAME) * size
        and row[c.AXIS_HIGH] <= (most + SAME) * size
        for row, size in _rows(claim, number)
    )
