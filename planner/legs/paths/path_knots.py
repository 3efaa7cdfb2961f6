"""Knots of the joints along a path: as close as it asks for, and none where its curvature jumps (equation Q7).

Where the curvature jumps, as from a line to an arc, the acceleration would. There knots lie on both sides and none
between, and the quintic between them leaves the path by some micrometres, within the promise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.legs.singular import nearest
from assur.planner.legs.state import State
from assur.planner.legs.tilt import PATH_RAD, tilt_off
from assur.planner.legs.tracking import PATH_M, continued
from assur.planner.model.path import Junction
from assur.planner.model.refusal import (
    LawEnds,
    MotionLimit,
    Obstacle,
    OutOfReach,
    Reason,
    Refusal,
    Singular,
    Spot,
    Stage,
    out_of_reach,
)
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Code, Inverse
from assur.planner.trajectory import Trajectory

BEND_M = 6e-6
"""m. How far the joints' spline may leave the path where its curvature jumps."""
BEND_SHARE = 2.684e-3
"""The quintic over a jump of the second derivative in its middle leaves it by this, times the jump and the square of
its length (Q7)."""
REACH = 0.45
"""Of the shorter part at a jump, how much the piece over it takes at most."""
WIDEST_S = 0.05
"""A piece over a jump lasts no longer, s."""
NARROWER, ROUNDS = 0.7, 14
"""A piece that leaves the path by too much becomes so much shorter; rounds in which pieces are halved or shortened."""
SHARES = (0.25, 0.5, 0.75)
"""Where in a piece its distance from the path is looked at."""
LOOKS = 16
"""Times in each piece at which it is looked at for the report."""
PARTS, ROUNDS_TO_PLACE = 32, 3
"""Of a time between two knots, to find where on a path it is that the arm is lost: 20 ms become 0.6 µs."""
FLAT = 1e-9
"""1/m. A smaller jump of the curvature is none."""
CLOSEST_S = 1e-6
"""Knots are farther apart than this, s."""


@dataclass(frozen=True, eq=False)
class Way:
    """A motion of the flange along a path over time, where on the path it is at a time, and for refusals the stage
    and the step."""

    motion: Callable[[FloatArray], Motion]
    place: Callable[[float], Spot]
    stage: Stage
    step: int


def widths(junctions: tuple[Junction, ...], edges: tuple[float, float]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of a path between `edges`, m: places without a jump of the curvature; places with one, (J,), and half of how far
    the piece over each reaches, (J,), m."""
    lengths = np.diff([edges[0], *(each.at for each in junctions), edges[1]])
    rows = [k for k, each in enumerate(junctions) if each.jump > FLAT]
    widest = [np.sqrt(BEND_M / (BEND_SHARE * junctions[k].jump)) / 2 for k in rows]
    room = [REACH * min(lengths[k], lengths[k + 1]) for k in rows]
    smooth = np.array([each.at for each in junctions if each.jump <= FLAT])
    half = np.array([min(one, other) for one, other in zip(widest, room, strict=True)])
    return smooth, np.array([junctions[k].at for k in rows]), half


@dataclass(frozen=True, eq=False)
class _Times:
    """Times of knots (T,), and which jump the pieces between them reach over (T - 1,): its number, or -1."""

    t: FloatArray
    over: IntArray


@dataclass(eq=False)
class Jumps:
    """In time: where junctions are smooth (S,); where the curvature jumps (J,), and half of how long the piece over
    each lasts (J,), s."""

    smooth: FloatArray
    at: FloatArray
    half: FloatArray

    @staticmethod
    def of(
        junctions: tuple[Junction, ...], edges: tuple[float, float], when: Callable[[FloatArray], FloatArray]
    ) -> Jumps:
        """Of the junctions of a path between `edges`, m; `when`: the times, s, of places on it."""
        smooth, at, half = widths(junctions, edges)
        before, behind, times = when(at - half), when(at + half), when(at)
        shorter = np.minimum(times - before, behind - times)
        open_ = shorter > CLOSEST_S
        return Jumps(when(smooth), times[open_], np.minimum(shorter, WIDEST_S / 2)[open_])

    def free(self, t: FloatArray) -> FloatArray:
        """Those of some times that are in no piece over a jump."""
        inside = (np.abs(t[:, None] - self.at) < self.half * (1 + 1e-6)).any(1)
        return np.asarray(t[~inside])

    def times(self, marks: FloatArray) -> _Times:
        """The knots: `marks`, and the ends of the pieces over jumps."""
        t = np.unique(np.concatenate([self.free(marks), self.at - self.half, self.at + self.half]))
        keep = np.append(True, np.diff(t) > CLOSEST_S)
        last, t = t[-1], t[keep]
        t[-1] = last
        middle, over = (t[1:] + t[:-1]) / 2, np.full(len(t) - 1, -1)
        for k, at in enumerate(self.at):
            i = int(np.searchsorted(t, at)) - 1
            if abs(middle[i] - at) < self.half[k]:
                over[i] = k
        return _Times(t, over)


def fitted(scene: Scene, way: Way, state: State, mode: int, marks: FloatArray, jumps: Jumps) -> Trajectory | Refusal:
    """The spline of the joints from `state`, with knots at `marks` (T,), the first and last of which are the ends, and
    as close as the path asks for. Refused, with the place on the path: out of reach, too near a singularity."""
    worst = float(marks[0])
    for _ in range(ROUNDS):
        grid = jumps.times(marks)
        made = _joints(scene, way, state, mode, grid.t)
        if isinstance(made, Refusal):
            return made
        off = _off(scene, way, made, grid)
        if not off.any():
            return made
        worst = float(grid.t[int(off.argmax())])
        wide = grid.over[off]
        jumps.half[wide[wide >= 0]] *= NARROWER
        middle = ((grid.t[1:] + grid.t[:-1]) / 2)[off & (grid.over < 0)]
        marks = np.unique(np.append(marks, middle))
    obstacle = Obstacle.PROCESS_SPEED if way.stage is Stage.TRACKING else Obstacle.NOT_SMOOTH
    facts = MotionLimit(obstacle=obstacle, **way.place(worst))
    span = (worst, worst)
    return Refusal(stage=way.stage, reason=Reason.MOTION_LIMIT, step=way.step, interval=span, facts=facts)


def _joints(scene: Scene, way: Way, state: State, mode: int, t: FloatArray) -> Trajectory | Refusal:
    motion = way.motion(t)
    if not np.isfinite(motion.p).all():
        span, facts = (float(t[0]), float(t[-1])), LawEnds(needed_s=float(t[-1]))
        return Refusal(stage=way.stage, reason=Reason.LAW_ENDS, step=way.step, interval=span, facts=facts)
    found = scene.robot.inverse(motion, mode, 2)
    refusal = _unreached(scene, way, t, mode, found)
    if refusal is not None:
        return refusal
    q, qd, qdd = continued(scene.robot, found.q, state.q), found.qd.copy(), found.qdd.copy()
    q[0], qd[0], qdd[0] = state.q, state.qd, state.qdd
    return Trajectory.of_knots(np.concatenate([t[:, None], q, qd, qdd], 1))


def _unreached(scene: Scene, way: Way, t: FloatArray, mode: int, found: Inverse) -> Refusal | None:
    """The first place on the path that the arm does not reach, and how far the path goes out of reach; or else the
    first where it is too near a singularity, and how near it comes."""
    asked, robot = scene.options.singularity_margin, scene.robot

    def lost(there: Inverse) -> BoolArray:
        return np.asarray(~((there.code == Code.ASSEMBLED) & there.keeps(asked)))

    def outside(there: Inverse) -> BoolArray:
        return np.asarray(there.code == Code.OUT_OF_REACH)

    bad = lost(found)
    if not bad.any():
        return None
    far = outside(found)
    rows = np.flatnonzero(far if far.any() else bad)
    when = _first(scene, way, t, mode, rows[0], outside if far.any() else lost)
    span = (when, float(t[rows[-1]]))
    if far.any():
        short = float(-np.nanmin(robot.reach_margin(way.motion(t[rows]), mode)))
        outer = OutOfReach(**way.place(when))
        return out_of_reach(way.stage, way.step, short_m=short if short > 0.0 else math.nan, interval=span, facts=outer)
    there = robot.inverse(way.motion(np.array([when])), mode, 2)
    if there.code[0] not in (Code.ASSEMBLED, Code.PARALLEL):
        facts = Singular(**way.place(when))
        return Refusal(stage=way.stage, reason=Reason.NEAR_SINGULARITY, step=way.step, interval=span, facts=facts)
    # the kind of singularity is that of the first place; how near the arm comes is looked for among all
    first = nearest(robot, there, asked, np.zeros(1, dtype=int), best=False)
    known = rows[(found.code[rows] == Code.ASSEMBLED) & np.isfinite(found.margin[rows])]
    if len(known):
        worst = nearest(robot, found, asked, known, best=False)
        first = worst if worst.reason is first.reason and worst.missing > first.missing else first
    refusal = first.refusal(way.stage, way.step, span)
    if not isinstance(refusal.facts, Singular):
        raise FaultError("a singularity without its facts")
    return replace(refusal, facts=replace(refusal.facts, **way.place(when)))


def _first(scene: Scene, way: Way, t: FloatArray, mode: int, row: int, lost: Callable[[Inverse], BoolArray]) -> float:
    """When the arm is lost first, s: it is so at `row` of times `t` (T,), and not one before."""
    low, high = float(t[max(0, row - 1)]), float(t[row])
    for _ in range(ROUNDS_TO_PLACE):
        inner = np.linspace(low, high, PARTS + 1)
        there = lost(scene.robot.inverse(way.motion(inner), mode, 2))
        there[-1] = True
        first = int(there.argmax())
        low, high = float(inner[max(0, first - 1)]), float(inner[first])
    return high


def _off(scene: Scene, way: Way, trajectory: Trajectory, grid: _Times) -> BoolArray:
    """Which pieces (T - 1,) leave the path by too much."""
    begin, length = grid.t[:-1], np.diff(grid.t)
    off, tilted = np.zeros(len(length)), np.zeros(len(length), dtype=bool)
    for share in SHARES:
        t = begin + share * length
        q, path = trajectory.evaluate(t), way.motion(t)
        position, _ = scene.robot.forward(q)
        off = np.maximum(off, np.linalg.norm(position - path.p, axis=1))
        if isinstance(path, TiltedMotion):
            tilted |= np.array([tilt_off(scene.robot, q[k : k + 1], path[k : k + 1]) > PATH_RAD for k in range(len(t))])
    return np.asarray(~(off <= np.where(grid.over >= 0, BEND_M, PATH_M)) | tilted)


def first_beyond(scene: Scene, spline: Trajectory, joint: int) -> float:
    """When a joint is beyond its range first, s, or comes nearest to that."""
    limits, t = scene.robot.limits, looks(spline.time)
    q = spline.evaluate(t)[:, joint]
    over = np.maximum(limits.lower[joint] - q, q - limits.upper[joint])
    return float(t[int((over > min(0.0, 0.999 * float(over.max()))).argmax())])


def looks(time: FloatArray) -> FloatArray:
    """Times (T,) in all pieces, away from the knots."""
    shares = (np.arange(LOOKS) + 0.5) / LOOKS
    return np.asarray((time[:-1, None] + np.diff(time)[:, None] * shares).ravel())
