"""A control point that can be met in no way, as facts alone show: at no pitch, at no time of a period, with no yaw,
with no lift; or with a path that cannot begin, or a part that nothing is near enough to."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from assur.planner.checker.refusals.obstructions import STATED
from assur.planner.checker.refusals.postures import (
    Goal,
    allowed_mode_names,
    beyond_every_pitch,
    flange_at,
    forbidden,
    posture_in_mode,
    still,
)
from assur.planner.checker.refusals.spans import ANY, Span, around, sine
from assur.planner.checker.refusals.stated import NotShownError, Proof, exceeded, same
from assur.planner.checker.refusals.ways import GraspOption, ways
from assur.planner.checker.statement import laws
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws import Law
from assur.planner.model.refusal import (
    MotionLimit,
    Obstacle,
    OutOfReach,
    Quantity,
    Reason,
    Refusal,
)
from assur.planner.model.scene import Move, Scene, beyond
from assur.planner.model.witness import PROVED_M, PeriodicReach

PARTS, DEEPEST = 64, 12
"""Into so many parts a period is cut, and each is halved so often at most."""


def _out_of_reach(short: float, facts: OutOfReach) -> Proof:
    return Proof(Reason.OUT_OF_REACH, facts, Quantity(short, "m"))


def every_pitch(scene: Scene, number: int) -> Iterator[Proof]:
    """A point that a hand reaches at no pitch."""
    way = ways(scene, number)[0]
    at = way.still(scene)
    if at is None:
        return
    point = at.then(way.flange)
    short = beyond_every_pitch(scene.robot, point.x, point.y, point.z)
    if short is not None and short > PROVED_M:
        yield _out_of_reach(short, OutOfReach(every_pitch=True))


def arch(scene: Scene, number: int) -> Iterator[Proof]:
    """An arch that is above the range of the lift: the flange is as high above the base as the lift is extended."""
    robot, of = scene.robot, scene.task[number].arch
    if robot.lift is None or of is None:
        return
    top, high = of.top_m - scene.tool.tcp.z - robot.base.z, float(robot.limits.upper[robot.lift])
    if top - high > PROVED_M:
        facts = replace(beyond(scene, robot.lift, top), arch_top_m=of.top_m)
        yield exceeded(scene, Reason.JOINT_LIMIT, robot.lift, top - high, facts)


def no_path(scene: Scene, number: int = 0) -> Iterator[Proof]:
    """A path of the first step that cannot begin where the tool is."""
    move = scene.task[0]
    if number != 0 or not isinstance(move, Move) or not move.path:
        return
    frame = still(scene, move.target.frame)
    if frame is None:
        return
    flange = flange_at(scene, scene.start.q)
    tool = Pose(*(flange.place + flange.rotation @ scene.tool.tcp.position).tolist())
    at = frame.inverse().then(tool).position
    near = np.array([np.zeros(3), *(PROVED_M * np.eye(3)), *(-PROVED_M * np.eye(3))])
    if not any(_begins(move, (x, y, z)) for x, y, z in (at + near).tolist()):
        yield Proof(Reason.MOTION_LIMIT, MotionLimit(obstacle=Obstacle.NO_PATH))


def _begins(move: Move, point: tuple[float, float, float]) -> bool:
    """Whether the path of a move can begin at a point of its frame."""
    try:
        move.path_from(point).curve  # noqa: B018 - what is wrong is found when it is made
    except InputError:
        return False
    return True


def yaws_forbidden(scene: Scene, number: int) -> Iterator[Proof]:
    """A forbidden range in which the tool is at a control point, however the part is turned."""
    if scene.options.vias_missed and scene.task[number].via:
        return
    inside = []
    for way in ways(scene, number):
        law = scene.frames[way.frame].law
        if way.turn is None or not laws.keeps_yaw(law):
            return
        yaw = laws.place_at(law, scene.start.time)[3] + way.flange.yaw + scene.tool.tcp.yaw
        inside.append(forbidden(scene, yaw))
    yield from (each for found in inside for each in found if all(inside))


def orbit(scene: Scene, refusal: Refusal, witness: PeriodicReach) -> Iterator[Proof]:
    """A point on a frame that repeats its motion and is never within reach. Raises `NotShownError` where it may be."""
    number, t0, short = refusal.step, scene.start.time, witness.short_m
    found = ways(scene, number)
    lasts = laws.period_of(scene.frames[found[0].frame].law)
    if lasts is None or not same(witness.span_s[0], t0) or not same(witness.span_s[1], t0 + lasts):
        raise NotShownError("the witness is not about a period")
    first, last = laws.known(scene.frames[found[0].frame].law)
    if not (short > PROVED_M and first <= t0 and t0 + lasts <= last):
        raise NotShownError("the point is not out of reach by as much, or its motion is not known")
    edges = np.linspace(t0, t0 + lasts, PARTS + 1).tolist()
    for way in found:
        for mode in allowed_mode_names(scene):
            if not all(_is_far(scene, way, mode, (a, b), short, 0) for a, b in pairwise(edges)):
                raise NotShownError("the point is not shown to stay so far out of reach")
    yield _out_of_reach(short, OutOfReach())


def _is_far(scene: Scene, way: GraspOption, mode: str, when: tuple[float, float], short: float, depth: int) -> bool:
    """Whether the flange is at least `short`, m, out of reach over an interval (up to `STATED`)."""
    if posture_in_mode(scene.robot, mode, _swept(scene, way, when)).short.low >= short - STATED:
        return True
    middle = (when[0] + when[1]) / 2.0
    halves = ((when[0], middle), (middle, when[1]))
    return depth < DEEPEST and all(_is_far(scene, way, mode, half, short, depth + 1) for half in halves)


def _swept(scene: Scene, way: GraspOption, when: tuple[float, float]) -> Goal:
    """Where the flange is over an interval, by bounds of the frame's motion."""
    x, y, z, yaw = frame_ranges(scene.frames[way.frame].law, when)
    c, s = sine(yaw + math.pi / 2), sine(yaw)
    local, spread = way.flange if way.turn is not None else way.point, around(0.0, way.spread)
    east, north = x + c * local.x - s * local.y + spread, y + s * local.x + c * local.y + spread
    return Goal(east, north, z + way.flange.z, ANY, ANY, ANY)


def frame_ranges(law: Law, when: tuple[float, float]) -> list[Span]:
    """Between which values x, y, z and yaw of a frame are over an interval. Each piece of its law is a polynomial: its
    coefficients of Chebyshev bound how far it is from its middle."""
    formula = laws.formula_of(law, *when)
    cuts = sorted({*when, *(t for t in formula.ends if when[0] < t < when[1])})
    found = [Span(math.inf, -math.inf)] * 4
    for a, b in pairwise(cuts):
        nodes = chebyshev.chebpts1(formula.degree + 1)
        values = formula.place((a + b) / 2.0 + (b - a) / 2.0 * nodes)
        for k, series in enumerate(chebyshev.chebfit(nodes, values, formula.degree).T):
            own = around(float(series[0]), float(np.abs(series[1:]).sum()))
            found[k] = Span(min(found[k].low, own.low), max(found[k].high, own.high))
    for k, amplitude, rate, phase in formula.sines:
        found[k] = found[k] + sine(Span(*when) * rate + phase) * amplitude
    return found
