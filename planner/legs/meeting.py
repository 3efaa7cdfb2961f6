"""When and how the arm can be at a control point: joint states over a grid of meeting times, branch by branch.

A branch is a working mode and a choice of full turns. The inverse kinematics of the whole grid is one batch of the
dyad; the search for the earliest meeting then only has to ask Ruckig.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray, every
from assur.planner.legs.branch import Branch
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.missed import window_is_missed
from assur.planner.legs.singular import nearest
from assur.planner.model.refusal import (
    RATES,
    BeyondRange,
    JointName,
    MotionLimit,
    Obstacle,
    OutOfReach,
    Quantity,
    Reason,
    Refusal,
    Singular,
    Stage,
    law_ends,
    of_joint,
    out_of_reach,
)
from assur.planner.model.scene import Scene
from assur.planner.robots.protocol import Code, Inverse, Robot
from assur.planner.robots.turns import beyond_range

GRID_S = 0.004
"""Meeting times are looked for on a grid this fine, s; a plan meets its point a step or two later than it could."""
MOST_TURNS = 2
"""Full turns of one joint, either way from where it is, that are tried."""
MOST_TIMES = 2500
"""... and at most this many times, so a far horizon makes the grid coarser."""
LOOK_AHEAD_S = 20.0
"""Meetings are looked for this long after they become possible, s."""


@dataclass(frozen=True, eq=False)
class Meetings:
    """All branches of a control point that are legal at some time, and why others are not."""

    point: ControlPoint
    above: float
    branches: tuple[Branch, ...]
    refusals: tuple[Refusal, ...]


def times(point: ControlPoint, earliest: float, lead: float) -> FloatArray:
    """Grid (G,) of meeting times from `earliest` on; the glue begins `lead` seconds after a meeting."""
    if _any_time(point) and point.intervals:
        return np.array([earliest])
    found = []
    for low, high in point.intervals:
        low = max(low - lead, earliest)
        high = min(high - lead, low + LOOK_AHEAD_S)
        if high >= low:
            step = max(GRID_S, (high - low) / MOST_TIMES)
            found.append(np.append(np.arange(low, high, step), high))
    return np.concatenate(found) if found else np.zeros(0)


def _any_time(point: ControlPoint) -> bool:
    """Whether it does not matter when the point is met: it stands still and has no window."""
    return point.still and point.window.time is None


def meetings(
    scene: Scene,
    point: ControlPoint,
    earliest: float,
    lead: float,
    modes: tuple[int, ...],
    near: FloatArray | None = None,
) -> Meetings:
    """The branches in which `point` can be met, `point.approach` above it, from `earliest` on."""
    robot = scene.robot
    above = point.approach
    t = times(point, earliest, lead)
    if not len(t):
        return Meetings(point, above, (), (window_is_missed(scene, point, earliest + lead),))
    motion = point.flange(t, above)
    if not point.matched or point.via:
        motion = motion.at_rest()
    branches: list[Branch] = []
    refusals: list[Refusal] = []
    for mode in modes:
        found = robot.inverse(motion, mode, 2)
        assembled = _assembled(found.code, found.qd, found.qdd)
        if not assembled.any():
            known = np.asarray(np.isfinite(motion.p).all(-1))
            refusals.append(_unreachable(scene, point, found, t, robot.modes[mode], known))
            continue
        safe = _safe(scene, point, found) & assembled
        if not safe.any():
            best = nearest(robot, found, scene.options.singularity_margin, np.flatnonzero(assembled), best=True)
            refusals.append(best.refusal(Stage.INVERSE, point.step, _span(t), mode=robot.modes[mode]))
            continue
        over = np.stack([np.abs(found.qd) / robot.limits.velocity, np.abs(found.qdd) / robot.limits.acceleration])
        slow = safe & every(over.max(0) <= 1.0)
        if not slow.any():
            refusals.append(_too_fast(robot, point, t[safe], over[:, safe], robot.modes[mode]))
            continue
        safe = slow
        here = list(_turned(robot, mode, t, found.q, found.qd, found.qdd, safe, _any_time(point), near))
        if not here:
            refusals.append(_beyond_limits(robot, point, t[safe], found.q[safe], lead, mode))
        branches += here
    return Meetings(point, above, tuple(branches), tuple(refusals))


def _assembled(code: IntArray, qd: FloatArray, qdd: FloatArray) -> BoolArray:
    """Rows that are assembled; a stretched arm will do where the point is met at rest and no margin is asked."""
    return np.asarray((code == Code.ASSEMBLED) & every(np.isfinite(qd) & np.isfinite(qdd)))


def _safe(scene: Scene, point: ControlPoint, found: Inverse) -> BoolArray:
    """The margin is asked of points met with a matched velocity or along a Cartesian leg, and not of others."""
    moving = point.tracks or (point.matched and not point.still and not point.via)
    return found.keeps(scene.options.singularity_margin) if moving else np.ones(found.code.shape, dtype=bool)


def _turned(
    robot: Robot,
    mode: int,
    t: FloatArray,
    q: FloatArray,
    qd: FloatArray,
    qdd: FloatArray,
    safe: BoolArray,
    still: bool,
    near: FloatArray | None,
) -> list[Branch]:
    """The mode's branches: choices of full turns of the revolute joints that are within limits at some time.

    A joint that can go round many times is offered `MOST_TURNS` either way from where it is (`near`; None: all).
    """
    met, slack = q[safe], robot.limits.slack
    lower, upper = robot.limits.lower - slack, robot.limits.upper + slack
    choices = []
    for i, joint in enumerate(robot.joints):
        if joint.kind != "revolute":
            choices.append([0])
            continue
        first = int(np.ceil((lower[i] - met[:, i].max()) / (2 * np.pi)))
        last = int(np.floor((upper[i] - met[:, i].min()) / (2 * np.pi)))
        if near is not None:
            here = round((near[i] - float(met[0, i])) / (2 * np.pi))
            first, last = max(first, here - MOST_TURNS), min(last, here + MOST_TURNS)
        choices.append(list(range(first, last + 1)))
    found = []
    for turns in itertools.product(*choices):
        turned = q + 2 * np.pi * np.array(turns)
        legal = safe & robot.within(turned)
        if legal.any():
            found.append(Branch(mode, t, turned, qd, qdd, legal, still))
    return found


def _span(t: FloatArray) -> tuple[float, float]:
    return float(t[0]), float(t[-1])


def _unreachable(
    scene: Scene, point: ControlPoint, found: Inverse, t: FloatArray, mode: str, known: BoolArray
) -> Refusal:
    if not known.any():
        law = scene.frames[point.frame].law
        return law_ends(Stage.INVERSE, point.step, point.frame, law.valid, float(t[0]), interval=_span(t))
    worst = found.code[known]
    if (worst == Code.OUT_OF_REACH).all():
        return out_of_reach(Stage.INVERSE, point.step, interval=_span(t), facts=OutOfReach(mode=mode))
    parallel = np.flatnonzero(found.code == Code.PARALLEL)
    if len(parallel):
        best = nearest(scene.robot, found, 0.0, parallel, best=True)
        return best.refusal(Stage.INVERSE, point.step, _span(t), mode=mode)
    return Refusal(
        stage=Stage.INVERSE,
        reason=Reason.NEAR_SINGULARITY,
        step=point.step,
        interval=_span(t),
        amount=Quantity(0.0, "1"),
        facts=Singular(mode=mode, positions=tuple(code.name.lower() for code in UNDIFFERENTIABLE if code in worst)),
    )


UNDIFFERENTIABLE = (Code.STRETCHED, Code.FOLDED, Code.INDETERMINATE, Code.ALIGNED)
"""Codes of positions without derivatives."""


def _too_fast(robot: Robot, point: ControlPoint, t: FloatArray, over: FloatArray, mode: str) -> Refusal:
    """The joint that would have to be faster than it can be even when the point is slowest for it; a share of its
    limit of velocity or acceleration, `over` (2, T, n)."""
    row = int(np.argmin(over.max((0, 2))))
    kind, joint = (int(k) for k in np.unravel_index(int(over[:, row].argmax()), over[:, row].shape))
    return Refusal(
        stage=Stage.INVERSE,
        reason=Reason.MOTION_LIMIT,
        step=point.step,
        subject=JointName(robot.joints[joint].name),
        interval=_span(t),
        amount=Quantity.of(float(over[kind, row, joint]) - 1, "1"),
        facts=MotionLimit(obstacle=Obstacle.FRAME_TOO_FAST, rate=RATES[kind], mode=mode, frame=point.frame),
    )


def _beyond_limits(robot: Robot, point: ControlPoint, t: FloatArray, q: FloatArray, lead: float, mode: int) -> Refusal:
    """The joint that is nearest to being legal, over all turns, and by how much it is not: of the point itself and
    the height `point.approach` over it, where q (T, n) is, whichever asks for more."""
    worst, where = beyond_range(robot, q), np.full(len(t), point.approach)
    if point.approach:
        there = robot.inverse(point.flange(t + lead).at_rest(), mode, 0).q
        known = np.asarray(np.isfinite(there).all(-1))
        at_point = beyond_range(robot, np.where(known[:, None], there, q))
        if known.any():
            worst[~known] = np.inf  # the point is out of reach by then
        more = known & (at_point.max(1) >= worst.max(1))
        worst, where = np.where(more[:, None], at_point, worst), np.where(more, 0.0, where)
    row = int(np.argmin(worst.max(1)))
    most = int(np.argmax(worst[row]))
    return Refusal(
        stage=Stage.INVERSE,
        reason=Reason.JOINT_LIMIT,
        step=point.step,
        subject=JointName(robot.joints[most].name),
        interval=_span(t),
        amount=of_joint(robot.joints[most].kind, float(worst[row, most])),
        facts=BeyondRange(mode=robot.modes[mode], above_m=float(where[row])),
    )
