"""The joints follow a motion of the flange: knots as close as it requires, on both sides where it jumps (equation Q7).

Legs that track a point, straight legs, legs along a path and traces are followed alike. Each has a course, on which the
place of the flange at a time depends on a phase s, and a law of this phase. Where the curvature of a path jumps, as
from a line to an arc, the acceleration would. There knots lie on both sides and none between, and the quintic between
them leaves the path by some micrometres, within the promise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.legs.course import BEND_M, PathCourse
from assur.planner.legs.limits import nearest
from assur.planner.legs.state import State
from assur.planner.legs.tilt import PATH_RAD, tilt_off
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.refusal import (
    FrameName,
    LawEnds,
    MotionLimit,
    Obstacle,
    OutOfReach,
    Reason,
    Refusal,
    Singular,
    Spot,
    Stage,
    law_ends,
    out_of_reach,
)
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Code, Inverse
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

SPACING_S = 0.02
"""Knots are at most this far apart to begin with, s."""
MOST_KNOTS = 20_000
"""Knots of one leg, about: a longer or slower one has them further apart. Whether its spline then keeps to the path is
measured, as it always is. A document has room for 50,000 knots."""
PATH_M = 1e-6
"""Between knots the flange leaves its course by less than this, m; the promise is 10 µm."""
WIDEST_S = 0.05
"""A piece over a jump lasts no longer, s."""
NARROWER, ROUNDS = 0.7, 14
"""A piece that leaves the course by too much becomes so much shorter; rounds of halving or shortening pieces."""
SHARES = np.array([[0.25], [0.5], [0.75]])
"""Where in a piece its distance from the course is evaluated."""
LOOKS = 16
"""Times in each piece at which it is evaluated for the report."""
PARTS, ROUNDS_TO_PLACE = 32, 3
"""Of a time between two knots, to find where it is that the arm is lost: 20 ms become 0.6 µs."""
CLOSEST_S, MERGED_S = 1e-6, 1e-5
"""Knots are farther apart than the first, s; switches of a law that are no farther apart than the second are one."""
RESTS, RESTS_2 = 1e-12, 1e-9
"""A flange whose rates, m/s or rad/s, and accelerations are no more than this rests: its law was rounded."""
FINE = 4001
"""Times at which a phase law is evaluated to find when the tool is where."""


UNIFORM = Trajectory(np.array([0.0, 1.0]), np.array([[0.0], [1.0]]), np.ones((2, 1)), np.zeros((2, 1)))
"""The phase s = t, by which derivatives by time are those by s."""


class FlangeCourse(Protocol):
    """Where the flange is at a time in a phase."""

    def motion(self, t: FloatArray, s: FloatArray, sd: FloatArray, sdd: FloatArray) -> Motion:
        """Motion (T,) of the flange in the world at times t (T,) in these phases (T,); without jerk."""


@dataclass(frozen=True, eq=False)
class PathTask:
    """A motion of the flange: a course under the law of its `phase` s, whose time counts from `begin`, s; `frame`: that
    whose law has to be known for it (None: there are several). Refusals have the stage and the step."""

    scene: Scene
    stage: Stage
    step: int
    course: FlangeCourse
    phase: Trajectory
    begin: float
    frame: str | None = None

    @property
    def end(self) -> float:
        return self.begin + self.phase.duration

    def phases(self, t: FloatArray) -> list[FloatArray]:
        """s, ṡ, s̈ (T,) at times t (T,), those of the ends before and after."""
        clock = np.clip(t - self.begin, 0.0, self.phase.duration)
        return [x[:, 0] for x in self.phase.states(clock)]

    def motion(self, t: FloatArray) -> Motion:
        """Motion (T,) of the flange at times t (T,)."""
        return self.course.motion(t, *self.phases(t))

    def spot(self, t: float) -> Spot:
        """Where on a path the tool is at a time; nothing on a course that is none."""
        if not isinstance(self.course, PathCourse):
            return {}
        return self.course.spot(float(self.phases(np.array([t]))[0][0]))

    def when(self, s: FloatArray) -> FloatArray:
        """Times at which the phase is s, to within a part of `FINE`."""
        clock = np.union1d(np.linspace(0.0, self.phase.duration, FINE), self.phase.time)
        return np.asarray(self.begin + np.interp(s, np.maximum.accumulate(self.phase.states(clock)[0][:, 0]), clock))


@dataclass(eq=False)
class Jumps:
    """In time: where junctions of a path are smooth (S,); where the curvature jumps (J,), and half of how long the
    piece over each lasts (J,), s."""

    smooth: FloatArray
    at: FloatArray
    half: FloatArray

    @staticmethod
    def of(way: PathTask) -> Jumps:
        """Of a motion; a course that is no path has none."""
        course = way.course
        if not isinstance(course, PathCourse):
            return Jumps(*np.zeros((3, 0)))
        smooth, at, half = course.widths
        before, behind, times, smooth_t = (
            way.when(place / course.unit) for place in (at - half, at + half, at, smooth)
        )
        shorter = np.minimum(times - before, behind - times)
        open_ = shorter > CLOSEST_S
        return Jumps(smooth_t, times[open_], np.minimum(shorter, WIDEST_S / 2)[open_])

    def free(self, t: FloatArray) -> FloatArray:
        """Those of some times that are in no piece over a jump."""
        inside = (np.abs(t[:, None] - self.at) < self.half * (1 + 1e-6)).any(1)
        return np.asarray(t[~inside])

    def times(self, marks: FloatArray) -> tuple[FloatArray, IntArray]:
        """Times of knots (T,): `marks`, and the ends of the pieces over jumps; and which jump the pieces between them
        reach over (T - 1,): its number, or -1."""
        t = _apart(np.concatenate([self.free(marks), self.at - self.half, self.at + self.half]), CLOSEST_S)
        middle, over = (t[1:] + t[:-1]) / 2, np.full(len(t) - 1, -1)
        for k, at in enumerate(self.at):
            i = int(np.searchsorted(t, at)) - 1
            if abs(middle[i] - at) < self.half[k]:
                over[i] = k
        return t, over


def _apart(times: FloatArray, least: float) -> FloatArray:
    """The different ones of some times, in order, without those that are no more than `least` behind another; the last
    one is kept."""
    t = np.unique(times)
    kept: FloatArray = t[np.append(True, np.diff(t) > least)]
    kept[-1] = t[-1]
    return kept


def marks_of(way: PathTask, jumps: Jumps) -> FloatArray:
    """Times of knots (T,) to begin with: all switches, and enough between."""
    switches = np.concatenate([way.begin + way.phase.time, jumps.smooth, [way.begin, way.end]])
    return spaced(_apart(switches[(way.begin <= switches) & (switches <= way.end)], MERGED_S), SPACING_S)


def spaced(marks: FloatArray, spacing: float) -> FloatArray:
    """Times (T,) from the first of `marks` (M,), which increase, to the last: all marks, and evenly between two of
    them as many as it takes for steps of `spacing` s at most, or for `MOST_KNOTS` steps in all."""
    length = marks[1:] - marks[:-1]
    spacing = max(spacing, float(marks[-1] - marks[0]) / MOST_KNOTS)
    count = np.maximum(1, np.ceil(length / spacing)).astype(int)
    number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return np.append(np.repeat(marks[:-1], count) + number * np.repeat(length / count, count), marks[-1])


def followed(way: PathTask, state: State, mode: int, rests: tuple[float, float] | None = None) -> Trajectory | Refusal:
    """The spline of the joints from `state`, with knots as close as the motion requires: at rest to the bit where the
    flange is, and without knots within `rests`, s, in which it stays at rest.

    Refused, with the place on a path: the law of a frame ends, out of reach, too near a singularity, not smooth.
    """
    jumps = Jumps.of(way)
    marks, worst = marks_of(way, jumps), way.begin
    if rests is not None:
        marks = marks[(marks <= rests[0] + MERGED_S) | (marks >= rests[1] - MERGED_S)]
    for _ in range(ROUNDS):
        raise_if_late()
        t, over = jumps.times(marks)
        made = _joints(way, state, mode, t)
        if isinstance(made, Refusal):
            return made
        off = _off(way, made, t, over)
        if not off.any():
            return made
        worst = float(t[int(off.argmax())])
        wide = over[off]
        jumps.half[wide[wide >= 0]] *= NARROWER
        middle = ((t[1:] + t[:-1]) / 2)[off & (over < 0)]
        marks = np.unique(np.append(marks, middle))
    traced = way.stage is Stage.TRACKING and isinstance(way.course, PathCourse)
    obstacle = Obstacle.PROCESS_SPEED if traced else Obstacle.NOT_SMOOTH
    return Refusal(
        stage=way.stage,
        reason=Reason.MOTION_LIMIT,
        step=way.step,
        subject=None if way.frame is None or traced else FrameName(way.frame),
        interval=(worst, worst),
        facts=MotionLimit(obstacle=obstacle, frame=way.frame, **way.spot(worst)),
    )


def _joints(way: PathTask, state: State, mode: int, t: FloatArray) -> Trajectory | Refusal:
    motion, robot = way.motion(t), way.scene.robot
    if not np.isfinite(motion.p).all():
        needed, span = float(t[-1]), (float(t[0]), float(t[-1]))
        if way.frame is not None:
            valid = way.scene.frames[way.frame].law.valid
            return law_ends(way.stage, way.step, way.frame, valid, needed, interval=span)
        facts = LawEnds(needed_s=needed)
        return Refusal(stage=way.stage, reason=Reason.LAW_ENDS, step=way.step, interval=span, facts=facts)
    found = robot.inverse(motion, mode, 2)
    refusal = _lost(way, t, mode, found)
    if refusal is not None:
        return refusal
    q, qd, qdd = continued(robot, found.q, state.q), found.qd.copy(), found.qdd.copy()
    rests = _rests(motion)
    qd[rests] = qdd[rests] = 0.0
    # the leg begins in the arm's own state, to the bit
    q[0], qd[0], qdd[0] = state.q, state.qd, state.qdd
    return Trajectory.of_knots(np.concatenate([t[:, None], q, qd, qdd], 1))


def _rests(motion: Motion) -> BoolArray:
    """Whether the flange is at rest (T,)."""
    rates, pulls = np.abs(motion.table[:, 1:3]).max(-1).T
    return np.asarray((rates <= RESTS) & (pulls <= RESTS_2))


def continued(robot: Robot, q: FloatArray, first: FloatArray) -> FloatArray:
    """q (T, n) with full turns added to revolute joints so that it begins near `first` and never jumps."""
    result, turning = q.copy(), robot.revolute > 0.0
    unwrapped = np.unwrap(q[:, turning], axis=0)
    result[:, turning] = unwrapped + 2 * np.pi * np.round((first[turning] - unwrapped[0]) / (2 * np.pi))
    return result


def _lost(way: PathTask, t: FloatArray, mode: int, found: Inverse) -> Refusal | None:
    """The first time at which the arm does not reach, and how far the course goes out of reach; or else the first at
    which it is too near a singularity, and how near it comes."""
    least, robot = way.scene.options.singularity_margin, way.scene.robot

    def lost(there: Inverse) -> BoolArray:
        return np.asarray(~((there.code == Code.ASSEMBLED) & there.keeps(least)))

    def outside(there: Inverse) -> BoolArray:
        return np.asarray(there.code == Code.OUT_OF_REACH)

    bad = lost(found)
    if not bad.any():
        return None
    far = outside(found)
    rows = np.flatnonzero(far if far.any() else bad)
    when = _first(way, t, mode, rows[0], outside if far.any() else lost)
    span, spot = (when, float(t[rows[-1]])), way.spot(when)
    if far.any():
        short = float(-np.nanmin(robot.reach_margin(way.motion(t[rows]), mode)))
        outer = OutOfReach(**spot)
        return out_of_reach(way.stage, way.step, short_m=short if short > 0.0 else math.nan, interval=span, facts=outer)
    if way.stage is Stage.STRAIGHT and not spot:
        near = nearest(robot, found, least, rows, best=False)
        if near.reason is Reason.NEAR_PARALLEL_SINGULARITY:
            return near.refusal(way.stage, way.step, span)
        left = float(robot.singular_distance(found.q[near.row]))
        kind = Code(int(robot.singularity(found.q[near.row]))).name.lower()
        return near.refusal(way.stage, way.step, span, distance_m=left, positions=(kind,))
    there = robot.inverse(way.motion(np.array([when])), mode, 2)
    if there.code[0] not in (Code.ASSEMBLED, Code.PARALLEL):
        facts = Singular(**spot)
        return Refusal(stage=way.stage, reason=Reason.NEAR_SINGULARITY, step=way.step, interval=span, facts=facts)
    # the kind of singularity is that of the first place; how near the arm comes is looked for among all
    first = nearest(robot, there, least, np.zeros(1, dtype=int), best=False)
    known = rows[(found.code[rows] == Code.ASSEMBLED) & np.isfinite(found.margin[rows])]
    if len(known):
        worst = nearest(robot, found, least, known, best=False)
        first = worst if worst.reason is first.reason and worst.missing > first.missing else first
    refusal = first.refusal(way.stage, way.step, span)
    if not isinstance(refusal.facts, Singular):
        raise FaultError("a singularity without its facts")
    return replace(refusal, facts=replace(refusal.facts, **spot))


def _first(way: PathTask, t: FloatArray, mode: int, row: int, lost: Callable[[Inverse], BoolArray]) -> float:
    """When the arm is lost first, s: it is so at `row` of times `t` (T,), and not one before."""
    low, high = float(t[max(0, row - 1)]), float(t[row])
    for _ in range(ROUNDS_TO_PLACE):
        inner = np.linspace(low, high, PARTS + 1)
        there = lost(way.scene.robot.inverse(way.motion(inner), mode, 2))
        there[-1] = True
        first = int(there.argmax())
        low, high = float(inner[max(0, first - 1)]), float(inner[first])
    return high


def _off(way: PathTask, trajectory: Trajectory, knots: FloatArray, over: IntArray) -> BoolArray:
    """Which pieces (T - 1,) between `knots` (T,), s, which reach `over` jumps, leave the course by too much."""
    t = (knots[:-1] + SHARES * np.diff(knots)).ravel()
    q, path, robot = trajectory.evaluate(t), way.motion(t), way.scene.robot
    off = np.linalg.norm(robot.forward(q)[0] - path.p, axis=1).reshape(len(SHARES), -1).max(0)
    turned = tilt_off(robot, q, path).reshape(len(SHARES), -1).max(0)
    return np.asarray(~((off <= np.where(over >= 0, BEND_M, PATH_M)) & (turned <= PATH_RAD)))


def first_beyond(scene: Scene, spline: Trajectory, joint: str | None) -> float:
    """When the joint of this name is beyond its range first, s, or comes nearest to that."""
    number = [each.name for each in scene.robot.joints].index(joint or "")
    limits, t = scene.robot.limits, looks(spline.time)
    q = spline.evaluate(t)[:, number]
    over = np.maximum(limits.lower[number] - q, q - limits.upper[number])
    return float(t[int((over > min(0.0, 0.999 * float(over.max()))).argmax())])


def looks(time: FloatArray) -> FloatArray:
    """Times (T,) in all pieces, away from the knots."""
    shares = (np.arange(LOOKS) + 0.5) / LOOKS
    return np.asarray((time[:-1, None] + np.diff(time)[:, None] * shares).ravel())
