"""Straight Cartesian legs between two moving frames: p(s, t) = A(t) + s (B(t) - A(t)), s from 0 to 1 timed by Ruckig.
Yaw, pitch and roll go from end to end by the same s, the short way round.

At s = 0 the flange moves with the frame it leaves, at s = 1 with the one it meets, so velocity and acceleration match
at both ends by construction. With Δ = B - A (equation L1):

    ṗ = Ȧ + s Δ̇ + ṡ Δ        p̈ = Ä + s Δ̈ + 2 ṡ Δ̇ + s̈ Δ
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planner.arrays import FloatArray
from planner.frames.motion import Motion
from planner.frames.tilted import TiltedMotion, like
from planner.legs.glued import PATH_M, REFINEMENTS, SPACING_S, continued
from planner.legs.limits import rates
from planner.legs.singular import nearest
from planner.legs.state import Knots, State, Stretch
from planner.legs.tilt import PATH_RAD, tilt_off
from planner.outcome import LegKind, Reason, Refusal
from planner.robots.protocol import Code, Inverse
from planner.scene import Scene
from planner.timing import Profile, TimingRefusal, time_joints
from planner.trajectory import Trajectory

ROUNDS = 12
"""Rounds of scaling the phase law until all joints keep their limits."""
FIRST = (2.0, 8.0, 80.0)
"""First guess of the phase law's limits, 1/s, 1/s², 1/s³."""

LOOKS = 201
"""Points of a line at which its distance from a singular position is looked at."""

Along = Callable[[FloatArray], Motion]


@dataclass(frozen=True, slots=True)
class _Line:
    """The way between two frames under one phase profile that begins at `begin`."""

    left: Along
    met: Along
    phase: Profile
    begin: float

    @property
    def end(self) -> float:
        return self.begin + self.phase.duration

    def motion(self, t: FloatArray) -> Motion:
        """Equation L1 at times t (T,)."""
        a, b = self.left(t), self.met(t)
        clock = np.clip(t - self.begin, 0.0, self.phase.duration)
        s, sd, sdd = (self.phase.evaluate(clock, order)[:, 0] for order in range(3))
        turn = np.round((b.yaw[0] - a.yaw[0]) / (2 * np.pi)) * 2 * np.pi
        p, v, acceleration = _blend(a.p, a.v, a.a, b.p, b.v, b.a, s[:, None], sd[:, None], sdd[:, None])
        yaw, yaw_d, yaw_dd = _blend(a.yaw, a.yaw_d, a.yaw_dd, b.yaw - turn, b.yaw_d, b.yaw_dd, s, sd, sdd)
        motion = Motion(p, v, acceleration, np.zeros_like(p), yaw, yaw_d, yaw_dd, np.zeros_like(yaw))
        if not (isinstance(a, TiltedMotion) and isinstance(b, TiltedMotion)):
            return motion
        turns = np.round((b.tilt[0] - a.tilt[0]) / (2 * np.pi)) * 2 * np.pi
        rates = a.tilt_d, a.tilt_dd, b.tilt - turns, b.tilt_d, b.tilt_dd
        tilt = _blend(a.tilt, *rates, s[:, None], sd[:, None], sdd[:, None])
        return TiltedMotion.of(motion, *tilt, np.zeros_like(tilt[0]))


def _blend(
    a: FloatArray,
    ad: FloatArray,
    add: FloatArray,
    b: FloatArray,
    bd: FloatArray,
    bdd: FloatArray,
    s: FloatArray,
    sd: FloatArray,
    sdd: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    gap, gap_d, gap_dd = b - a, bd - ad, bdd - add
    return a + s * gap, ad + s * gap_d + sd * gap, add + s * gap_dd + 2 * sd * gap_d + sdd * gap


def straight(scene: Scene, step: int, state: State, mode: int, left: Along, met: Along) -> Stretch | Refusal:
    """A straight leg from `state`, in which the flange moves as `left` says, until it moves as `met` says.

    The phase law's limits are scaled until velocity, acceleration and jerk of every joint are within limits by the
    exact extrema of the spline. Refused: out of reach, too near a singularity, a joint position beyond its limit.
    """
    scale = 1.0
    for _ in range(ROUNDS):
        v, a, j = (np.array([FIRST[order] * scale ** (order + 1)]) for order in range(3))
        none = np.zeros(1)
        phase = time_joints(none, none, none, np.ones(1), none, none, v, a, j)
        if isinstance(phase, TimingRefusal):
            return Refusal("straight", Reason.MOTION_LIMIT, step, detail=phase.detail)
        line = _Line(left, met, phase, state.time)
        knots = _knots(scene, step, state, mode, line)
        if isinstance(knots, Refusal):
            return knots
        fast = rates(scene, "straight", step, knots)
        if isinstance(fast, Refusal):
            return fast
        ratio = max(fast.velocity, fast.acceleration**0.5, fast.jerk ** (1 / 3))
        if 0.9 <= ratio <= 1.0:
            return Stretch(LegKind.MOVE, knots, "straight")
        if ratio < 0.9 and scale > 1e3:
            break
        scale *= 0.96 / ratio
    return Refusal("straight", Reason.MOTION_LIMIT, step, detail="no phase law keeps the limits of all joints")


def _knots(scene: Scene, step: int, state: State, mode: int, line: _Line) -> Knots | Refusal:
    spacing, robot = SPACING_S, scene.robot
    for _ in range(REFINEMENTS):
        marks = np.unique(np.append(line.begin + line.phase.switches(), line.end))
        count = np.maximum(1, np.ceil(np.diff(marks) / spacing)).astype(int)
        parts = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(marks[:-1], marks[1:], count, strict=True)]
        t = np.concatenate([*parts, marks[-1:]])
        motion = line.motion(t)
        found = robot.inverse(motion, mode, 2)
        refusal = _refused(scene, step, t, motion, found)
        if refusal is not None:
            return refusal
        q = continued(robot, found.q, state.q)
        # the leg begins in the arm's own state, to the bit
        qd, qdd = found.qd.copy(), found.qdd.copy()
        q[0], qd[0], qdd[0] = state.q, state.qd, state.qdd
        last = line.met(t[-1:])
        if not (last.v.any() or last.a.any() or last.yaw_d.any() or last.yaw_dd.any()):
            # ... and ends at rest to the bit where the frame it meets stands still
            qd[-1] = qdd[-1] = 0.0
        knots = Knots(t, q, qd, qdd)
        middle = (t[1:] + t[:-1]) / 2
        between, path = Trajectory(t, q, qd, qdd).evaluate(middle), line.motion(middle)
        position, _ = robot.forward(between)
        off = float(np.sqrt(((position - path.p) ** 2).sum(-1)).max())
        if off <= PATH_M and tilt_off(robot, between, path) <= PATH_RAD:
            return knots
        spacing /= 2
    return Refusal("straight", Reason.MOTION_LIMIT, step, detail="the joints' motion along the line is not smooth")


def _refused(scene: Scene, step: int, t: FloatArray, motion: Motion, found: Inverse) -> Refusal | None:
    if not np.isfinite(motion.p).all():
        return Refusal("straight", Reason.LAW_ENDS, step, (), (float(t[0]), float(t[-1])))
    asked = scene.options.singularity_margin
    bad = ~(found.keeps(asked) & (found.code == Code.ASSEMBLED))
    if not bad.any():
        return None
    rows = np.flatnonzero(bad)
    span = (float(t[rows[0]]), float(t[rows[-1]]))
    if (found.code[rows] == Code.OUT_OF_REACH).any():
        return Refusal("straight", Reason.OUT_OF_REACH, step, (), span, detail="the line leaves the workspace")
    near = nearest(scene.robot, found, asked, rows, best=False)
    if near.reason is Reason.NEAR_PARALLEL_SINGULARITY:
        verb = "leads" if near.margin < 0 else "comes to a"
        return Refusal("straight", near.reason, step, (), span, near.missing, "1", f"the line {verb} {near.words}")
    left = scene.robot.singular_distance(found.q[near.row])
    kind = Code(int(scene.robot.singularity(found.q[near.row]))).name.lower()
    near_to = f"{1e3 * float(left):.1f} mm of a singular position ({kind}; margin {near.margin:.3f})"
    return Refusal("straight", near.reason, step, (), span, near.missing, "1", f"the line comes within {near_to}")


def mode_changes(scene: Scene, step: int, state: State, modes: tuple[int, int], left: Along, met: Along) -> Refusal:
    """Why a straight leg cannot begin in one working mode and end in another, with how near it comes to where the
    modes meet (frames as they are when it begins)."""
    robot, t = scene.robot, np.array([state.time])
    begin, end = left(t), met(t)
    s = np.linspace(0.0, 1.0, LOOKS)
    p = begin.p + s[:, None] * (end.p - begin.p)
    still = np.zeros_like(p)
    none = np.zeros(LOOKS)
    line = like(Motion(p, still, still, still, np.full(LOOKS, begin.yaw[0]), none, none, none), begin)
    found = robot.inverse(line, modes[0], 0)
    change = f"a straight leg cannot change from {robot.modes[modes[0]]} to {robot.modes[modes[1]]}"
    if not np.isfinite(found.q).all():
        return Refusal("straight", Reason.OUT_OF_REACH, step, detail=f"{change}, and the line leaves the workspace")
    left_over = float(robot.singular_distance(found.q).min())
    detail = f"{change}: the line comes no nearer than {1e3 * left_over:.1f} mm to a singular position"
    return Refusal("straight", Reason.NEAR_SINGULARITY, step, (), None, left_over, "m", detail)
