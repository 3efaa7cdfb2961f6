"""When and how the arm can be at a control point: joint states over a grid of meeting times, branch by branch.

A branch is a working mode and a choice of full turns. The inverse kinematics of the whole grid is one batch of the
dyad; the search for the earliest meeting then only has to ask Ruckig.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.kernels.meetings import (
    FAST,
    LEGAL,
    NO_BOUND,
    NOWHERE,
    meeting_states,
    turn_ranges,
    turned_states,
)
from assur.planner.legs.control_point import ControlPoint, MovingEnd
from assur.planner.legs.forbidden_yaw import allowed_branches
from assur.planner.legs.limits import Margins, nearest
from assur.planner.legs.missed import window_is_missed
from assur.planner.legs.state import Branch
from assur.planner.legs.tool_motion import lift_most
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
)
from assur.planner.model.scene import Scene, beyond_at_nearest_turn
from assur.planner.robots.facts import Code
from assur.planner.robots.kinematics import targets_of
from assur.planner.robots.robot import Robot
from assur.planner.robots.turns import beyond_range
from assur.planner.timing import RawProfile, Solver, TimingRefusal, trajectory_of

GRID_S = 0.004
"""Meeting times are looked for on a grid this fine, s; a plan meets its point a step or two later than it could."""
MOST_TURNS = 2
"""Full turns of one joint, either way from where it is, that are tried."""
MOST_TIMES = 2500
"""... and at most this many times, so a far horizon makes the grid coarser."""
LOOK_AHEAD_S = 20.0
"""Meetings are looked for this long after they become possible, s."""


def every_turn(robot: Robot) -> bool:
    """Whether the turns that are tried are all there are, wherever the joints stand."""
    ranges = (robot.limits.upper - robot.limits.lower)[robot.revolute > 0.0]
    return bool((ranges <= MOST_TURNS * 2.0 * np.pi + 1e-9).all())


@dataclass(frozen=True, eq=False)
class Meetings:
    """All branches of a control point that are legal at some time, and why others are not. `last`: the last time that
    was examined, s, where the end of the frame's law makes it the last one."""

    point: ControlPoint
    branches: tuple[Branch, ...]
    refusals: tuple[Refusal, ...]
    last: float | None = None


def meeting_times(point: ControlPoint, earliest: float, lead: float, *, any_time: bool = False) -> FloatArray:
    """Grid (G,) of meeting times from `earliest` on; tracking begins `lead` seconds after a meeting. `any_time`: the
    point can be met as well at one time as at another."""
    if any_time and point.intervals:
        return np.array([earliest])
    found = [np.zeros(0)]
    for low, high in point.intervals:
        low = max(low - lead, earliest)
        high = min(high - lead, low + LOOK_AHEAD_S)
        if high >= low:
            step = max(GRID_S, (high - low) / MOST_TIMES)
            found.append(np.append(np.arange(low, high, step), high))
    return np.concatenate(found)


def meetings(
    scene: Scene,
    point: ControlPoint,
    earliest: float,
    lead: float,
    modes: tuple[int, ...],
    near: FloatArray | None = None,
) -> Meetings:
    """The branches in which `point` can be met, `point.approach` above it, from `earliest` on.

    A joint that can go round many times is offered `MOST_TURNS` either way from where it is (`near`; None: all).
    """
    step, still, robot = point.facts, point.still, scene.robot
    any_time = still and step.window.time is None
    t = meeting_times(point, earliest, lead, any_time=any_time)
    if not len(t):
        return Meetings(point, (), (window_is_missed(scene, point, earliest + lead),))
    # a margin is required of points that are met with a matched velocity, and not of others
    moving = step.tracks or (step.match == "velocity" and not still and not step.via)
    required = scene.options.singularity_margin if moving else NO_BOUND
    looked = _Evaluated(point, lead, t, targets_of(point.entered(t), 2), required)
    close = np.array([math.nan] * len(robot.joints) if near is None else near)
    branches, refusals = list[Branch](), list[Refusal]()
    for mode in modes:
        here, turned = allowed_branches(scene, point, looked.branches(mode, close, any_time=any_time))
        branches += here
        if not here:
            refusals.append(turned or looked.refused(mode))
    high = point.intervals[-1][1]
    by_law = high == scene.frames[point.frame].law.valid[1] - point.dwell and float(t[-1]) == high - lead
    return Meetings(point, tuple(branches), tuple(refusals), float(t[-1]) if by_law else None)


class _Evaluated:
    """The joint states over a grid of times (T,), s, of one mode after the other, and why one has no branch."""

    def __init__(self, point: ControlPoint, lead: float, t: FloatArray, targets: FloatArray, required: float) -> None:
        self.robot, self.limits, self.point, self.lead = point.scene.robot, point.limits, point, lead
        self.t, self.targets, self.required = t, targets, required
        self.states, self.margins = np.empty((len(t), 1 + 3 * len(self.robot.joints))), np.empty((len(t), 2))
        self.codes, self.verdicts = np.empty((2, len(t)), dtype=np.int64)

    def branches(self, mode: int, near: FloatArray, *, any_time: bool) -> list[Branch]:
        """The mode's branches: choices of full turns of the revolute joints that are within limits at some time."""
        robot, limits, n = self.robot, self.limits, len(self.robot.joints)
        legal = meeting_states(
            robot.row, mode, self.targets, limits.table, self.required, self.t, self.states, self.margins, self.codes,
            self.verdicts,
        )  # fmt: skip
        if not legal:
            return []
        turns, found = np.empty((n, 2), dtype=np.int64), list[Branch]()
        turn_ranges(self.states, self.verdicts, limits.within, robot.revolute, near, MOST_TURNS, turns)
        for choice in itertools.product(*[range(first, last + 1) for first, last in turns.tolist()]):
            rows, numbers = np.empty((legal, 1 + 3 * n)), np.empty(legal, dtype=np.int64)
            turned = np.array(choice, dtype=np.float64)
            many = turned_states(robot.row, self.states, self.verdicts, limits.within, turned, rows, numbers)
            if many:
                found.append(Branch(rows[:many], mode, numbers[:many], any_time))
        return found

    def joints(self, order: int) -> FloatArray:
        """q, q̇ or q̈ (T, n)."""
        n = len(self.robot.joints)
        return self.states[:, 1 + order * n : 1 + (order + 1) * n]

    def refused(self, mode: int) -> Refusal:
        """Why a mode has no branch: what ends all times, or else what ends those that came furthest."""
        verdicts, name = self.verdicts, self.robot.modes[mode]
        assembled, safe, slow = verdicts != NOWHERE, (verdicts == FAST) | (verdicts == LEGAL), verdicts == LEGAL
        if not assembled.any():
            return self._unreachable(mode, np.asarray(np.isfinite(self.targets[:, 0, :3]).all(-1)))
        if not safe.any():
            return self._singular(assembled, self.required, name)
        return self._beyond_limits(slow, mode) if slow.any() else self._too_fast(safe, name)

    def _refusal(
        self,
        reason: Reason,
        facts: OutOfReach | Singular | MotionLimit | BeyondRange,
        amount: Quantity | None,
        joint: int | None = None,
        span: BoolArray | slice = slice(None),
    ) -> Refusal:
        """The refusal for what holds over a part of the times, of a joint by its number."""
        t = self.t[span]
        return Refusal(
            stage=Stage.INVERSE,
            reason=reason,
            step=self.point.step,
            subject=None if joint is None else JointName(self.robot.joints[joint].name),
            interval=(float(t[0]), float(t[-1])),
            amount=amount,
            facts=facts,
        )

    def _singular(self, rows: BoolArray, required: float, mode: str) -> Refusal:
        """The singularity that is nearest in the best of some rows."""
        parallel = self.margins[:, 1] if self.robot.parallel_least > 0.0 else None
        margins = Margins(self.codes, self.margins[:, 0], parallel)
        best = nearest(self.robot, margins, required, np.flatnonzero(rows), best=True)
        return best.refusal(Stage.INVERSE, self.point.step, (float(self.t[0]), float(self.t[-1])), mode=mode)

    def _unreachable(self, number: int, known: BoolArray) -> Refusal:
        """No position, or none with derivatives, at the times at which the motion of the frame is `known`."""
        t, robot, point = self.t, self.robot, self.point
        mode = robot.modes[number]
        if not known.any():
            span, law = (float(t[0]), float(t[-1])), point.scene.frames[point.frame].law
            return law_ends(Stage.INVERSE, point.step, point.frame, law.valid, float(t[0]), interval=span)
        worst = self.codes[known]
        if (worst == Code.OUT_OF_REACH).all():
            short = math.nan
            if "z" in robot.coordinates:  # else what is missing may be the height
                short = -float(robot.reach_margin(point.entered(t[known]), number).max())
            amount = Quantity.of(short if short > 0.0 else math.nan, "m")
            return self._refusal(Reason.OUT_OF_REACH, OutOfReach(mode=mode), amount)
        parallel = self.codes == Code.PARALLEL
        if parallel.any():
            return self._singular(parallel, 0.0, mode)
        positions = tuple(code.name.lower() for code in UNDIFFERENTIABLE if code in worst)
        return self._refusal(Reason.NEAR_SINGULARITY, Singular(mode=mode, positions=positions), Quantity(0.0, "1"))

    def _too_fast(self, safe: BoolArray, mode: str) -> Refusal:
        """The joint that would have to be faster than it can be even when the point is slowest for it, in a share of
        its limit of velocity or acceleration."""
        limits = self.limits.velocity, self.limits.acceleration
        over = np.stack([np.abs(self.joints(k + 1)[safe]) / limit for k, limit in enumerate(limits)])
        row = int(np.argmin(over.max((0, 2))))
        kind, joint = (int(k) for k in np.unravel_index(int(over[:, row].argmax()), over[:, row].shape))
        share, limit = float(over[kind, row, joint]), float(limits[kind][joint])
        facts = MotionLimit(
            obstacle=Obstacle.FRAME_TOO_FAST,
            rate=RATES[kind],
            mode=mode,
            frame=self.point.frame,
            value=share * limit,
            limit=limit,
        )
        return self._refusal(Reason.MOTION_LIMIT, facts, Quantity.of(share - 1, "1"), joint, safe)

    def _beyond_limits(self, slow: BoolArray, mode: int) -> Refusal:
        """The joint that is nearest to being legal, over all turns, and by how much it is not: of the point itself and
        the height `point.approach` over it, whichever asks for more."""
        robot, point, mode_name = self.robot, self.point, self.robot.modes[mode]
        heights, q = [point.approach], [self.joints(0)[slow]]
        if point.approach:
            at_point = robot.inverse(point.flange(self.t[slow] + self.lead).at_rest(), mode, 0).q
            heights, q = [0.0, *heights], [at_point, *q]
        over = beyond_range(robot, np.array(q))
        known = np.isfinite(top := over.max(-1))
        # a time after which the point is out of reach counts only where it is so after all of them
        top = np.where(known, top, math.inf if known[0].any() else -math.inf)
        row = int(top.max(0).argmin())
        k = int(top[:, row].argmax())
        most = int(over[k, row].argmax())
        facts = replace(beyond_at_nearest_turn(point.scene, most, q[k][row]), mode=mode_name, above_m=heights[k])
        amount = of_joint(robot.joints[most].kind, float(over[k, row, most]))
        return self._refusal(Reason.JOINT_LIMIT, facts, amount, most, slow)


UNDIFFERENTIABLE = (Code.STRETCHED, Code.FOLDED, Code.INDETERMINATE, Code.ALIGNED)
"""Codes of positions without derivatives."""


# Corners that overlap: where the straight part of an approach or depart ends, the tool moves on along the vertical.
#
# The straight part is then the first part of a fastest motion of the lift from rest at the point to a stop far above it
# (of an approach: the last part of such a motion downwards). What the joint leg behind it begins with is the state in
# which that motion is cut. So no state is handed over from which the lift could not stop within its range.

FARTHER, FARTHER_M = 3.0, 0.02
"""A straight part is cut from a motion that goes so many times as far, but at most so much farther, m, unless an arch
says how far it goes, ..."""
LEAST_FARTHER = 1.2
"""... and at least so many times as far: with less room the tool stops where the straight part ends."""
RANGE_M = 1e-3
"""From the end of the lift's range such a motion stays this far away, m."""
CUTS = 100
"""Halvings of the time in which the height of a cut is looked for: more than a double has digits."""


def entering(scene: Scene, point: ControlPoint, q: FloatArray) -> MovingEnd | None:
    """How the tool comes into the straight part of an approach without a stop; None: it stops there.

    `q` (n,): any joint position; the lift moves the flange one to one, so it tells what heights the lift reaches.
    """
    step = point.facts
    if not point.approach > 0.0 or step.approach_stop or not (point.matched or point.still):
        return None
    z = float(point.flange(np.array(scene.start.time)).p[2])
    top = None if step.arch is None else step.arch.top_m
    return _moving_end(scene, point, z, top, q, up=False)


def may_stop(scene: Scene, number: int) -> bool:
    """Whether behind the depart of step `number` the tool may move on, so that a stop there is a choice."""
    step, behind = scene.task[number], scene.task[number + 1 : number + 2]
    departs = step.depart_m > 0.0 and not step.depart_stop
    return departs and scene.robot.lift is not None and bool(behind) and behind[0].leg != "cartesian"


def leaving(scene: Scene, point: ControlPoint, q: FloatArray) -> MovingEnd | None:
    """How the tool goes on behind the straight part of a depart without a stop; None: it stops there, as it does at
    the end of the task and before a straight leg. `q` (n,): joints where the tool leaves the point."""
    if not may_stop(scene, point.step):
        return None
    after = scene.task[point.step + 1]
    z, top = float(scene.robot.forward(q)[0][2]), None if after.arch is None else after.arch.top_m
    return _moving_end(scene, point, z, top, q, up=True)


def _moving_end(
    scene: Scene, point: ControlPoint, z: float, top: float | None, q: FloatArray, *, up: bool
) -> MovingEnd | None:
    """`z`: height of the flange at the point, m; `top`: of the tool point where an arch is highest; `up`: of a depart.

    Before a place and behind a pick a part is in the gripper.
    """
    lift, limits = scene.robot.lift, point.limits_after if up else point.limits
    height = point.depart if up else point.approach
    if lift is None or not height > 0.0 or not np.isfinite(z):
        return None
    flange = float(scene.robot.forward(q)[0][2])
    room = float(limits.upper[lift]) - RANGE_M - (float(q[lift]) + z - flange)
    far = min(FARTHER * height, height + FARTHER_M) if top is None else top - scene.tool.tcp.z - z
    far = min(far, room)
    if not far >= LEAST_FARTHER * height:
        return None
    v, a, j = (float(rate[lift]) for rate in (limits.velocity, limits.acceleration, limits.jerk))
    return _cut(v, min(a, lift_most(scene, carried=point.carries(up=up))), j, height, far, up=up)


@lru_cache(maxsize=256)
def _cut(v: float, a: float, j: float, height: float, far: float, *, up: bool) -> MovingEnd | None:
    """The part up to `height` of the fastest motion up to `far`, m, at these limits; or its reverse, downwards."""
    whole = Solver([v], [a], [j]).raw_profile(([0.0], [0.0], [0.0]), ([far], [0.0], [0.0]))
    if isinstance(whole, TimingRefusal):
        return None
    kept, state = list[tuple[float, float]](), (0.0, 0.0, 0.0)
    for duration, jerk in whole.phases[0].T.tolist():
        low, high = 0.0, duration
        for _ in range(0 if _later(state, jerk, duration)[0] < height else CUTS):
            middle = (low + high) / 2
            low, high = (middle, high) if _later(state, jerk, middle)[0] < height else (low, middle)
        kept.append((high, jerk))
        state = _later(state, jerk, high)
        if not state[0] < height:
            break
    if not state[1] > 0.0:
        return None
    speed, acceleration = state[1], state[2]
    rest, moving = ([0.0], [0.0], [0.0]), ([height], [speed if up else -speed], [acceleration])
    phases = kept if up else [(duration, -jerk) for duration, jerk in reversed(kept)]
    total = sum(duration for duration, _ in phases)
    begin, goal = (rest, moving) if up else (moving, rest)
    profile = RawProfile(total, begin, goal, np.array([list(zip(*phases, strict=True))]))
    return MovingEnd(height, moving[1][0], acceleration, far, trajectory_of([profile], [0.0, total]))


def _later(state: tuple[float, float, float], jerk: float, t: float) -> tuple[float, float, float]:
    """A state of constant jerk, t seconds on."""
    x, v, a = state
    return x + t * (v + t * (a / 2 + t * jerk / 6)), v + t * (a + t * jerk / 2), a + t * jerk
