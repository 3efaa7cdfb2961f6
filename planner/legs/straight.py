"""Straight Cartesian legs between two moving frames: p(s, t) = A(t) + s (B(t) - A(t)), s from 0 to 1 by a phase law.
The tool point is on that line. Yaw, pitch and roll go from end to end by the same s, the short way round.

At s = 0 the flange moves with the frame it leaves, at s = 1 with the one it meets, so velocity and acceleration match
at both ends by construction (equation L1, `assur.planner.legs.line`).

There are two phase laws: one made for the joints' motion along the line (`assur.planner.legs.phase_law`), for which
frames are taken to stand, and Ruckig's with constant limits of s. The faster leg is taken.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.legs.course import PathCourse
from assur.planner.legs.follower import UNIFORM, PathTask, followed
from assur.planner.legs.limits import rates
from assur.planner.legs.line import Along, Line, LineRates
from assur.planner.legs.phase_law import TABLE, faster, quickest
from assur.planner.legs.state import Knots, State, TimedLeg
from assur.planner.model.outcome import Course, LegKind, Route
from assur.planner.model.path import LONGEST_S
from assur.planner.model.refusal import (
    Obstacle,
    OutOfReach,
    Quantity,
    Reason,
    Refusal,
    Singular,
    Stage,
    out_of_reach,
    unmoved,
)
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Limits
from assur.planner.timing import TimingRefusal, fastest_motion
from assur.planner.trajectory import Trajectory

ROUNDS = 12
"""Rounds of scaling the phase law until all joints keep their limits."""
CLOSE_ROUNDS, CLOSE, CLOSE_AIM = 4, 0.985, 0.999
"""In the first rounds a law made for the line is scaled to this share of the limits, and a leg that reaches so much of
them is taken. Between still frames rates scale as the law does, and two rounds do: the thousandth is for knots that
come to lie elsewhere."""
LOOSE, LOOSE_AIM = 0.9, 0.96
"""Likewise in all other rounds: frames in motion have a part in the rates that no scaling changes."""
FIRST = (2.0, 8.0, 80.0)
"""Limits of the constant phase law to begin with, 1/s, 1/s², 1/s³."""
CONSTANT_LOOKS = 201
"""Times at which the constant law is evaluated to compute how long it would take on a line."""
SURELY = 0.95
"""A leg that takes less than this share of what the constant law would take needs no comparison with it ..."""
AS_PREDICTED = 0.05
"""... if its own predicted duration was right to this share. Past a singular position a rate can rise and fall between
two points of the table, and then neither prediction is."""

LOOKS = 201
"""Points of a line at which its distance from a singular position is evaluated."""


def straight(
    scene: Scene, step: int, state: State, mode: int, left: Along, met: Along, held: str | None = None
) -> TimedLeg | Refusal:
    """A straight leg from `state`, in which the flange moves as `left` says, until it moves as `met` says; `held`: the
    part in the gripper.

    The phase law is scaled until velocity, acceleration and jerk of every joint are within limits by the exact extrema
    of the spline. Refused: out of reach, too near a singularity, a joint position beyond its limit.
    """
    start, limits = np.array([state.time]), scene.limits_with(held)
    line = PathTask(scene, Stage.STRAIGHT, step, Line(left, met, scene.tool.tcp), UNIFORM, state.time)

    def by(law: Trajectory, closely: int) -> TimedLeg | Refusal:
        return by_law(line, state, mode, law, closely, limits)

    leg: TimedLeg | Refusal | None = None
    standing = _still(left, start) and _still(met, start)
    if standing:
        law, surely = _made_for(scene, mode, left(start), met(start), limits)
        if law is not None:
            leg = by(law, CLOSE_ROUNDS)
        if law is not None and isinstance(leg, TimedLeg):
            t = leg.knots.time
            predicted = abs(leg.duration / law.duration - 1) <= AS_PREDICTED
            if predicted and leg.duration <= surely and _still(left, t) and _still(met, t):
                return leg
    plain = by(constant_law(), 0)
    if isinstance(plain, Refusal):
        return plain
    if not standing:
        # the line that is gone is rather that from where one frame is left to where the other is met
        law, _ = _made_for(scene, mode, left(start), met(plain.knots.time[-1:]), limits)
        if law is not None:
            leg = by(law, CLOSE_ROUNDS)
    return leg if isinstance(leg, TimedLeg) and leg.duration < plain.duration else plain


@cache
def constant_law() -> Trajectory:
    """Ruckig's law from 0 to 1 with the constant limits `FIRST` of s."""
    v, a, j = FIRST
    law = fastest_motion(([0.0], [0.0], [0.0]), ([1.0], [0.0], [0.0]), ([v], [a], [j]))
    if isinstance(law, TimingRefusal):
        raise FaultError(f"no constant law: {law.detail}")
    return law


def _made_for(scene: Scene, mode: int, a: Motion, b: Motion, limits: Limits) -> tuple[Trajectory | None, float]:
    """The law made for the line between two poses (1,) that stand, if there is one, and the time below which a leg is
    surely faster than one of the constant law.

    By another scale the constant law is the same shape in another time, so one look tells what it needs (L4).
    """
    s = np.linspace(0.0, 1.0, TABLE)
    row = np.zeros(TABLE, dtype=int)
    line = Line(lambda _: a.at_rest()[row], lambda _: b.at_rest()[row], scene.tool.tcp)
    along = scene.robot.inverse(line.motion(s, s, np.ones(TABLE), np.zeros(TABLE)), mode, 3)
    derivatives = along.qd, along.qdd, along.qddd
    law, plain = quickest(derivatives, limits), constant_law()
    if law is None:
        return None, 0.0
    t = np.linspace(0.0, plain.duration, CONSTANT_LOOKS)
    shape = np.concatenate([plain.evaluate(t, order) * plain.duration**order for order in range(4)], 1)
    needed = float(LineRates.of(derivatives, limits).times(shape).max())
    return law, SURELY * needed


def _still(along: Along, t: FloatArray) -> bool:
    """Whether a frame stands still at all times t (T,)."""
    motion = along(t)
    return not (motion.v.any() or motion.a.any() or motion.yaw_d.any() or motion.yaw_dd.any())


def by_law(way: PathTask, state: State, mode: int, law: Trajectory, closely: int, limits: Limits) -> TimedLeg | Refusal:
    """The leg on the course of `way` by a phase law, as fast as keeps the joints' `limits`; in so many rounds to begin
    with, closely so."""
    scale, on_path = 1.0, isinstance(way.course, PathCourse)
    kept: TimedLeg | None = None
    for number in range(ROUNDS):
        close = number < closely
        if kept is not None and not close:
            break
        phase = faster(law, scale)
        if phase.duration > LONGEST_S:
            return unmoved(way.stage, way.step, Obstacle.NO_PROFILE)
        spline = followed(replace(way, phase=phase), state, mode)
        if isinstance(spline, Refusal):
            return spline
        fast = rates(way.scene, way.stage, way.step, spline, limits)
        if isinstance(fast, Refusal):
            return fast
        ratio = fast.ratio
        if LOOSE <= ratio <= 1.0:
            if kept is None or spline.duration < kept.duration:
                kept = TimedLeg(LegKind.MOVE, Knots.of(spline), Route(Course.PATH if on_path else Course.STRAIGHT))
            if ratio >= CLOSE:
                break
        if not ratio > 0 or (ratio < LOOSE and scale > 1e3):
            break
        scale *= (CLOSE_AIM if close else LOOSE_AIM) / ratio
    return kept or unmoved(way.stage, way.step, Obstacle.NO_PATH_LAW)


def mode_changes(scene: Scene, step: int, state: State, modes: tuple[int, int], left: Along, met: Along) -> Refusal:
    """Why a straight leg cannot begin in one working mode and end in another, with how near it comes to where the
    modes meet (frames as they are when it begins)."""
    robot, t = scene.robot, np.array([state.time])
    begin, end = left(t), met(t)
    s = np.linspace(0.0, 1.0, LOOKS)
    line = begin.at_rest().table.repeat(LOOKS, axis=0)
    line[:, 0, :3] = begin.p + s[:, None] * (end.p - begin.p)
    found = robot.inverse(Motion(line), modes[0], 0)
    change = (robot.modes[modes[0]], robot.modes[modes[1]])
    if not np.isfinite(found.q).all():
        return out_of_reach(Stage.STRAIGHT, step, facts=OutOfReach(modes=change))
    left_over = float(robot.singular_distance(found.q).min())
    return Refusal(
        stage=Stage.STRAIGHT,
        reason=Reason.NEAR_SINGULARITY,
        step=step,
        amount=Quantity.of(left_over, "m"),
        facts=Singular(distance_m=left_over, modes=change),
    )
