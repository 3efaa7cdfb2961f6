"""Traces: the tool point goes along a path in a frame that may move, at a process speed (equations Q6 and Q7).

The place on the path is a law of time alone: it rises on a straight lead-in, has the process speed over all of the path
and falls on a lead-out. The joints follow from it and from the frame. Where the curvature of the path jumps, as from a
line to an arc, the acceleration would; there knots lie on both sides and none between, and the quintic between them
leaves the path by some micrometres, within the promise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.limits import rates, too_fast
from assur.planner.legs.singular import nearest
from assur.planner.legs.spacing import spaced
from assur.planner.legs.state import Knots, State, TimedLeg
from assur.planner.legs.tilt import PATH_RAD, tilt_off
from assur.planner.legs.tracking import PATH_M, SPACING_S, Tracked, continued
from assur.planner.model.outcome import LegKind, Traced
from assur.planner.model.refusal import (
    RATES,
    BeyondRange,
    MotionLimit,
    Obstacle,
    OutOfReach,
    Quantity,
    Reason,
    Refusal,
    Singular,
    Stage,
    law_ends,
    out_of_reach,
)
from assur.planner.model.scene import Scene, Trace
from assur.planner.robots.facts import Code, Inverse
from assur.planner.trajectory import Trajectory

TRACED_M, SPEED_SHARE = 1e-5, 0.01
"""The promise: how far the tool point may be from its place on the path, m, and how much its speed may differ."""
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
"""Times in each piece at which speed and distance are looked at for the report."""
RESERVE_M, RESERVE_SHARE = 1e-6, 1e-3
"""Added to what is found at these times; the checker bounds what lies between."""
HALVINGS = 20
"""Of a time between two knots, to find where on a path it is that the arm is lost: 20 ms become 20 ns."""
FLAT = 1e-9
"""1/m. A smaller jump of the curvature is none."""


@dataclass(frozen=True, eq=False)
class PathLaw:
    """The place on the path over time: it begins at `begin`, s, with the lead-in (Q6)."""

    step: Trace
    begin: float

    @property
    def lead_in(self) -> float:
        """How long the lead-in takes, s: from rest its mean speed is half of the process speed."""
        return 2.0 * self.step.lead_in_m / self.step.speed_m_s

    @property
    def met(self) -> float:
        """When the path begins, s."""
        return self.begin + self.lead_in

    @property
    def left(self) -> float:
        """When the path ends, s."""
        return self.met + self.step.dwell_s

    @property
    def end(self) -> float:
        """When the lead-out ends, s."""
        return self.left + 2.0 * self.step.lead_out_m / self.step.speed_m_s

    def evaluate(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Arc length (T,) from the path's first point, m, and its two derivatives."""
        v, length = self.step.speed_m_s, self.step.path.length
        s, sd, sdd = v * (t - self.met), np.full(len(t), v), np.zeros(len(t))
        for rows, lasts, sign, edge, place in (
            (t < self.met, self.lead_in, 1.0, self.begin, -self.step.lead_in_m),
            (t > self.left, self.end - self.left, -1.0, self.end, length + self.step.lead_out_m),
        ):
            u = np.clip(sign * (t[rows] - edge) / lasts, 0.0, 1.0)
            s[rows] = place + sign * v * lasts * u**3 * (1.0 - u / 2.0)
            sd[rows] = v * u**2 * (3.0 - 2.0 * u)
            sdd[rows] = sign * v / lasts * 6.0 * u * (1.0 - u)
        return s, sd, sdd

    def place(self, t: float) -> float:
        """Arc length at a time, m; negative on the lead-in."""
        return float(self.evaluate(np.array([t]))[0][0])


def lead(point: ControlPoint) -> float:
    """Seconds from the beginning of the lead-in to that of the path."""
    return PathLaw(_trace(point), 0.0).lead_in


def left_at(point: ControlPoint) -> ControlPoint:
    """The point in the frame at which the flange is when a lead-out has ended."""
    step = _trace(point)
    r, _, _ = step.path.curve.at(np.array([-step.lead_in_m, step.path.length + step.lead_out_m]))
    x, y, z = (r[1] - r[0]).tolist()
    pose = point.pose
    return replace(point, pose=Pose(pose.x + x, pose.y + y, pose.z + z, pose.yaw))


def _trace(point: ControlPoint) -> Trace:
    step = point.facts
    if not isinstance(step, Trace):
        raise FaultError(f"{step.name} is no trace")
    return step


def flange(point: ControlPoint, law: PathLaw, t: FloatArray) -> Motion:
    """Motion (T,) of the flange along the path, in the world; without jerk."""
    curve = law.step.path.curve
    s, sd, sdd = law.evaluate(t)
    begin, _, _ = curve.at(np.array([-law.step.lead_in_m]))
    r, tangent, bend = curve.at(s)
    place = point.pose.position + r - begin
    rate, pull = sd[:, None] * tangent, sdd[:, None] * tangent + sd[:, None] ** 2 * bend
    motion = point.scene.frames[point.frame].law.motion(t).carrying(place, rate, pull, point.pose.yaw)
    return motion if point.tilt is None else TiltedMotion.of(motion, np.array(point.tilt))


@dataclass(frozen=True, eq=False)
class _Times:
    """Times of knots (T,), and which of the pieces between them reach over a jump (T - 1,): the number of the jump, or
    -1."""

    t: FloatArray
    over: IntArray


class _Jumps:
    """Where the path's curvature jumps: times (J,), and half the length of the piece over each, s."""

    def __init__(self, law: PathLaw) -> None:
        step, junctions = law.step, law.step.path.curve.junctions
        v = step.speed_m_s
        lengths = np.diff([-step.lead_in_m, *(each.at for each in junctions), step.path.length + step.lead_out_m])
        self.smooth = np.array([law.met + each.at / v for each in junctions if each.jump <= FLAT])
        rows = [k for k, each in enumerate(junctions) if each.jump > FLAT]
        self.at = np.array([law.met + junctions[k].at / v for k in rows])
        widest = [np.sqrt(BEND_M / (BEND_SHARE * junctions[k].jump)) / 2 for k in rows]
        room = [REACH * min(lengths[k], lengths[k + 1]) for k in rows]
        self.half = np.array([min(a, b, v * WIDEST_S / 2) / v for a, b in zip(widest, room, strict=True)])

    def free(self, t: FloatArray) -> FloatArray:
        """Those of some times that are in no piece over a jump."""
        inside = (np.abs(t[:, None] - self.at) < self.half * (1 + 1e-6)).any(1)
        return np.asarray(t[~inside])

    def times(self, marks: FloatArray) -> _Times:
        """The knots: `marks`, and the ends of the pieces over jumps."""
        t = np.unique(np.concatenate([self.free(marks), self.at - self.half, self.at + self.half]))
        keep = np.append(True, np.diff(t) > 1e-6)
        keep[-1] = True
        t = t[keep]
        middle, over = (t[1:] + t[:-1]) / 2, np.full(len(t) - 1, -1)
        for k, at in enumerate(self.at):
            i = int(np.searchsorted(t, at)) - 1
            if abs(middle[i] - at) < self.half[k]:
                over[i] = k
        return _Times(t, over)


def trace(scene: Scene, point: ControlPoint, state: State, mode: int) -> Tracked | Refusal:
    """Lead-in, path and lead-out from `state`, in which the flange is where the lead-in begins, moving with the frame.

    Refused, with the place on the path: out of reach, too near a singularity, a joint beyond its range or its rates.
    """
    law = PathLaw(_trace(point), state.time)
    spline = _spline(scene, point, law, state, mode)
    if isinstance(spline, Refusal):
        return spline
    refusal = _refused_rates(scene, point, law, spline)
    if refusal is not None:
        return refusal
    knots = _with_knots(spline, (law.met, law.left))
    legs = []
    for kind, t0, t1 in (
        (LegKind.APPROACH, law.begin, law.met),
        (LegKind.FOLLOW, law.met, law.left),
        (LegKind.DEPART, law.left, law.end),
    ):
        rows = (knots[:, 0] >= t0) & (knots[:, 0] <= t1)
        legs.append(TimedLeg(kind, Knots(knots[rows])))
    return Tracked(tuple(legs), law.met, law.left)


def _spline(scene: Scene, point: ControlPoint, law: PathLaw, state: State, mode: int) -> Trajectory | Refusal:
    """The spline of the joints, with knots as close as the path asks for."""
    jumps = _Jumps(law)
    ends = np.array([law.begin, law.met, law.left, law.end])
    marks = jumps.free(spaced(np.unique(np.concatenate([ends, jumps.smooth])), SPACING_S))
    worst = law.begin
    for _ in range(ROUNDS):
        grid = jumps.times(marks)
        knots = _joint_states(scene, point, law, state, mode, grid.t)
        if isinstance(knots, Refusal):
            return knots
        trajectory = Trajectory.of_knots(knots.table)
        off = _off(scene, point, law, trajectory, grid)
        if not off.any():
            return trajectory
        worst = float(grid.t[int(off.argmax())])
        wide = grid.over[off]
        jumps.half[wide[wide >= 0]] *= NARROWER
        middle = ((grid.t[1:] + grid.t[:-1]) / 2)[off & (grid.over < 0)]
        marks = np.unique(np.append(marks, middle))
    facts = MotionLimit(obstacle=Obstacle.PROCESS_SPEED, frame=point.frame, path_m=law.place(worst))
    return Refusal(
        stage=Stage.TRACKING,
        reason=Reason.MOTION_LIMIT,
        step=point.step,
        interval=(worst, worst),
        facts=facts,
    )


def _joint_states(
    scene: Scene, point: ControlPoint, law: PathLaw, state: State, mode: int, t: FloatArray
) -> Knots | Refusal:
    motion = flange(point, law, t)
    if not np.isfinite(motion.p).all():
        valid = scene.frames[point.frame].law.valid
        return law_ends(Stage.TRACKING, point.step, point.frame, valid, float(t[-1]), interval=(law.begin, law.end))
    found = scene.robot.inverse(motion, mode, 2)
    refusal = _unreached(scene, point, law, t, mode, found)
    if refusal is not None:
        return refusal
    q, qd, qdd = continued(scene.robot, found.q, state.q), found.qd.copy(), found.qdd.copy()
    q[0], qd[0], qdd[0] = state.q, state.qd, state.qdd
    if point.still:
        # at rest to the bit, not to 1e-17: what follows may wait here
        qd[-1] = qdd[-1] = 0.0
    return Knots.made(t, q, qd, qdd)


def _unreached(
    scene: Scene, point: ControlPoint, law: PathLaw, t: FloatArray, mode: int, found: Inverse
) -> Refusal | None:
    """The first place on the path that the arm does not reach, or where it is too near a singularity."""
    asked, robot = scene.options.singularity_margin, scene.robot
    bad = ~((found.code == Code.ASSEMBLED) & found.keeps(asked))
    if not bad.any():
        return None
    rows = np.flatnonzero(bad)
    low, high = float(t[max(0, rows[0] - 1)]), float(t[rows[0]])
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        there = robot.inverse(flange(point, law, np.array([middle])), mode, 2)
        good = bool(((there.code == Code.ASSEMBLED) & there.keeps(asked))[0])
        low, high = (middle, high) if good else (low, middle)
    there = robot.inverse(flange(point, law, np.array([high])), mode, 2)
    code, span, place = there.code[0], (high, float(t[rows[-1]])), law.place(high)
    if code == Code.OUT_OF_REACH:
        return out_of_reach(Stage.TRACKING, point.step, interval=span, facts=OutOfReach(path_m=place))
    if code not in (Code.ASSEMBLED, Code.PARALLEL):
        return Refusal(
            stage=Stage.TRACKING,
            reason=Reason.NEAR_SINGULARITY,
            step=point.step,
            interval=span,
            facts=Singular(path_m=place),
        )
    refusal = nearest(robot, there, asked, np.zeros(1, dtype=int), best=False).refusal(Stage.TRACKING, point.step, span)
    if not isinstance(refusal.facts, Singular):
        raise FaultError("a singularity without its facts")
    return replace(refusal, facts=replace(refusal.facts, path_m=place))


def _off(scene: Scene, point: ControlPoint, law: PathLaw, trajectory: Trajectory, grid: _Times) -> BoolArray:
    """Which pieces (T - 1,) leave the path by too much."""
    begin, length = grid.t[:-1], np.diff(grid.t)
    off, tilted = np.zeros(len(length)), np.zeros(len(length), dtype=bool)
    for share in SHARES:
        t = begin + share * length
        q, path = trajectory.evaluate(t), flange(point, law, t)
        position, _ = scene.robot.forward(q)
        off = np.maximum(off, np.linalg.norm(position - path.p, axis=1))
        if point.tilt is not None:
            tilted |= np.array([tilt_off(scene.robot, q[k : k + 1], path[k : k + 1]) > PATH_RAD for k in range(len(t))])
    return np.asarray(~(off <= np.where(grid.over >= 0, BEND_M, PATH_M)) | tilted)


def _refused_rates(scene: Scene, point: ControlPoint, law: PathLaw, spline: Trajectory) -> Refusal | None:
    """Which joint breaks a limit, and where on the path it does most."""
    fast = rates(scene, Stage.TRACKING, point.step, spline)
    if isinstance(fast, Refusal):
        joint = [each.name for each in scene.robot.joints].index(fast.joint or "")
        limits = scene.robot.limits
        t = _looks(spline.time)
        q = spline.evaluate(t)[:, joint]
        over = np.maximum(limits.lower[joint] - q, q - limits.upper[joint])
        when = float(t[int((over > min(0.0, float(over.max()) * 0.999)).argmax())])
        return replace(fast, interval=(when, when), facts=BeyondRange(path_m=law.place(when)))
    if fast.ok:
        return None
    kind, joint = (int(k) for k in np.unravel_index(int(fast.ratios.argmax()), fast.ratios.shape))
    t = _looks(spline.time)
    when = float(t[int(np.abs(spline.evaluate(t, kind + 1)[:, joint]).argmax())])
    refusal = too_fast(scene, Stage.TRACKING, point.step, fast, point.frame)
    facts = MotionLimit(obstacle=Obstacle.FRAME_TOO_FAST, rate=RATES[kind], frame=point.frame, path_m=law.place(when))
    return replace(refusal, interval=(when, when), facts=facts)


def _looks(time: FloatArray) -> FloatArray:
    """Times (T,) in all pieces, away from the knots."""
    shares = (np.arange(LOOKS) + 0.5) / LOOKS
    return np.asarray((time[:-1, None] + np.diff(time)[:, None] * shares).ravel())


def _with_knots(spline: Trajectory, times: tuple[float, ...]) -> FloatArray:
    """The knots of a spline (K, 1 + 3n) with some more on it: the motion stays the same."""
    table = spline.knots
    for time in times:
        if not (table[:, 0] == time).any():
            q, qd, qdd = (spline.evaluate(np.array([time]), order)[0] for order in range(3))
            row = int(np.searchsorted(table[:, 0], time))
            table = np.insert(table, row, np.concatenate([[time], q, qd, qdd]), axis=0)
    return table


def traced(scene: Scene, point: ControlPoint, trajectory: Trajectory, begin: float, until: float) -> Traced | Refusal:
    """What is said of a path that is traced from `begin` to `until`, s; a refusal where the promise is not kept."""
    step = _trace(point)
    law = PathLaw(step, begin - lead(point))
    t = np.clip(_looks(trajectory.time[(trajectory.time >= begin) & (trajectory.time <= until)]), begin, until)
    robot, none = scene.robot, np.zeros((len(t), len(scene.robot.joints)))
    q, qd, _ = trajectory.states(t)
    motion = robot.link_motion(len(robot.links) - 1, q, qd, none, none).at(scene.tool.tcp)
    frame = scene.frames[point.frame].law.motion(t)
    place, velocity = motion.p - frame.p, motion.v - frame.v
    velocity[:, 0] += frame.yaw_d * place[:, 1]
    velocity[:, 1] -= frame.yaw_d * place[:, 0]
    speed = np.linalg.norm(velocity, axis=1)
    r, _, _ = step.path.curve.at(law.evaluate(t)[0])
    goal = frame.carrying(r, np.zeros_like(r), np.zeros_like(r))
    v, error = step.speed_m_s, float(np.linalg.norm(motion.p - goal.p, axis=1).max()) + RESERVE_M
    slowest, fastest = float(speed.min()) - RESERVE_SHARE * v, float(speed.max()) + RESERVE_SHARE * v
    if slowest >= (1 - SPEED_SHARE) * v and fastest <= (1 + SPEED_SHARE) * v and error <= TRACED_M:
        return Traced(step.path.length, slowest, fastest, error)
    worst = float(t[int(np.abs(speed - v).argmax())])
    return Refusal(
        stage=Stage.TRACKING,
        reason=Reason.MOTION_LIMIT,
        step=point.step,
        interval=(worst, worst),
        amount=Quantity.of(max(v - slowest, fastest - v) / v - SPEED_SHARE, "1"),
        facts=MotionLimit(obstacle=Obstacle.PROCESS_SPEED, frame=point.frame, path_m=law.place(worst)),
    )
