"""Cartesian legs along a path: lines, arcs and splines in a frame, corners rounded, without a stop in between.

The tool point is at r(s L) of a path of length L in the frame, its yaw, pitch and roll go from end to end by the same
s, and s goes from 0 to 1 by a phase law, as on a straight leg (`assur.planner.legs.straight`). At s = 0 and s = 1 the
tool moves with the frame.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import Tilt, TiltedMotion
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.line import Phase, Uniform
from assur.planner.legs.paths.corner_law import SAMPLES, STEEPER, Bends, faster, slowed_at_bends
from assur.planner.legs.paths.path_knots import Jumps, Way, first_beyond, fitted, widths
from assur.planner.legs.phase_law import TABLE, quickest
from assur.planner.legs.spacing import spaced
from assur.planner.legs.state import State, TimedLeg
from assur.planner.legs.straight import CLOSE_ROUNDS, Paced, as_fast, by_law, constant_law
from assur.planner.legs.tilt import tilt_of
from assur.planner.legs.tracking import SPACING_S
from assur.planner.model.outcome import Course
from assur.planner.model.path import LONGEST_S, Path
from assur.planner.model.refusal import BeyondRange, Obstacle, Refusal, Spot, Stage, unmoved
from assur.planner.model.scene import Move, Scene
from assur.planner.robots.facts import Code, Limits
from assur.planner.trajectory import Trajectory

FINE = 4001
"""Times at which a phase law is looked at to find when the tool is where."""


@dataclass(frozen=True, eq=False)
class PathWay:
    """The way of the flange along a path under a phase law that begins at `begin`, s; `turn`: yaw of the tool in the
    frame at its beginning, and by how much it turns; `tilts`: pitch and roll at both ends, of a hand that has them."""

    scene: Scene
    frame: str
    path: Path
    turn: tuple[float, float]
    tilts: tuple[Tilt, Tilt] | None
    phase: Phase | Uniform
    begin: float
    stands: bool = False
    """Whether the frame is taken to stand as it does at `begin`."""

    def motion(self, t: FloatArray) -> Motion:
        """Motion (T,) of the flange; without jerk."""
        clock = np.clip(t - self.begin, 0.0, self.phase.duration)
        s, sd, sdd = (x[:, 0] for x in self.phase.states(clock))
        length = self.path.length
        r, tangent, bend = self.path.curve.at(length * s)
        rate = (length * sd)[:, None] * tangent
        pull = (length * sdd)[:, None] * tangent + ((length * sd) ** 2)[:, None] * bend
        yaw, turn = self.turn
        law = self.scene.frames[self.frame].law
        frame = law.motion(np.full(len(t), self.begin)).at_rest() if self.stands else law.motion(t)
        motion = frame.carrying(r, rate, pull, yaw + s * turn, sd * turn, sdd * turn).at(self.scene.tool.tcp.inverse())
        if self.tilts is None:
            return motion
        one = np.array(self.tilts[0])
        gone = np.array(self.tilts[1]) - one
        gone -= 2 * np.pi * np.round(gone / (2 * np.pi))
        rows = (one + s[:, None] * gone, sd[:, None] * gone, sdd[:, None] * gone)
        return TiltedMotion.of(motion, *rows, np.zeros_like(rows[0]))

    def place(self, t: float) -> Spot:
        """Where on the path the tool is at a time."""
        clock = np.clip(np.array([t]) - self.begin, 0.0, self.phase.duration)
        length = float(self.path.length * self.phase.states(clock)[0][0, 0])
        x, y, z = self.path.curve.at(np.array([length]))[0][0].tolist()
        return {"path_m": length, "path_part": "path", "path_at_m": (x, y, z)}

    def when(self, places: FloatArray) -> FloatArray:
        """Times at which the tool is at some places of the path, m, to within a part of `FINE`."""
        clock = np.linspace(0.0, self.phase.duration, FINE)
        s = np.maximum.accumulate(self.phase.states(clock)[0][:, 0])
        return np.asarray(self.begin + np.interp(places / self.path.length, s, clock))


def along_path(
    scene: Scene, point: ControlPoint, state: State, modes: tuple[int, int], tracked: ControlPoint | None
) -> TimedLeg | Refusal:
    """A leg along the path of a move from `state`, at rest or while `tracked` is tracked, until the tool is at `point`.

    Refused: another frame or working mode than it begins in, points from which there is no path, and, with the place on
    the path, out of reach, too near a singularity, a joint beyond its range.
    """
    way = _way(scene, point, state, modes, tracked)
    if isinstance(way, Refusal):
        return way
    step, mode = point.step, modes[0]

    def fit(phase: Phase) -> Trajectory | Refusal:
        if phase.duration > LONGEST_S:
            return unmoved(Stage.STRAIGHT, step, Obstacle.NO_PROFILE)
        here = replace(way, phase=phase)
        jumps = Jumps.of(way.path.curve.junctions, (0.0, way.path.length), here.when)
        ends = [state.time, state.time + phase.duration]
        marks = np.unique(np.concatenate([state.time + phase.time, jumps.smooth, ends]))
        marks = marks[(marks >= ends[0]) & (marks <= ends[1])]
        looked = Way(here.motion, here.place, Stage.STRAIGHT, step)
        made = fitted(scene, looked, state, mode, spaced(marks, SPACING_S), jumps)
        if isinstance(made, Refusal) or not point.still:
            return made
        table = made.knots.copy()
        table[-1, 1 + made.n :] = 0.0  # at rest to the bit
        return Trajectory.of_knots(table)

    def placed(leg: TimedLeg | Refusal) -> TimedLeg | Refusal:
        """A refusal of a joint's range with where on the path it is beyond."""
        if not (isinstance(leg, Refusal) and isinstance(leg.facts, BeyondRange) and leg.joint is not None):
            return leg
        law = constant_law(1.0)
        made = fit(law) if isinstance(law, Trajectory) else leg
        if isinstance(made, Refusal) or not isinstance(law, Trajectory):
            return leg
        joint = [each.name for each in scene.robot.joints].index(leg.joint)
        when = first_beyond(scene, made, joint)
        return replace(leg, facts=replace(leg.facts, **replace(way, phase=law).place(when)))

    found: list[TimedLeg] = []
    for paced in _laws(scene, way, mode, point.limits):
        leg = by_law(scene, step, fit, paced, CLOSE_ROUNDS, Course.PATH, point.limits)
        found += [leg] if isinstance(leg, TimedLeg) else []
    if found and point.still:
        return min(found, key=lambda leg: leg.knots.end)
    plain = placed(by_law(scene, step, fit, constant_law, 0, Course.PATH, point.limits))
    found += [plain] if isinstance(plain, TimedLeg) else []
    return min(found, key=lambda leg: leg.knots.end, default=plain)


def _way(
    scene: Scene, point: ControlPoint, state: State, modes: tuple[int, int], tracked: ControlPoint | None
) -> PathWay | Refusal:
    move = point.facts
    if not isinstance(move, Move) or modes[0] != modes[1]:
        return unmoved(Stage.STRAIGHT, point.step, Obstacle.OTHER_MODE)
    if tracked is None and not state.resting:
        return unmoved(Stage.STRAIGHT, point.step, Obstacle.STRAIGHT_FROM_MOTION)
    still = scene.frames[point.frame].law.is_fixed
    if not (still if tracked is None else tracked.frame == point.frame):
        return unmoved(Stage.STRAIGHT, point.step, Obstacle.OTHER_FRAME)
    begin = tool_in(scene, point.frame, state.q, state.time)
    path = path_from(move, point.step, begin)
    if isinstance(path, Refusal):
        return path
    end = point.pose.then(scene.tool.tcp)
    turn = float(np.remainder(end.yaw - begin.yaw + np.pi, 2 * np.pi) - np.pi)
    before = tilt_of(scene.robot, state.q)
    tilts = None if before is None or point.tilt is None else (before, point.tilt)
    return PathWay(scene, point.frame, path, (begin.yaw, turn), tilts, Uniform(), state.time)


def tool_in(scene: Scene, frame: str, q: FloatArray, t: float) -> Pose:
    """The pose of the tool in a frame with the joints `q` (n,) at a time."""
    position, yaw = scene.robot.forward(q)
    flange = Pose(float(position[0]), float(position[1]), float(position[2]), float(yaw))
    at = scene.frames[frame].law.motion(np.array(t))
    there = Pose(float(at.p[0]), float(at.p[1]), float(at.p[2]), float(at.yaw))
    return there.inverse().then(flange.then(scene.tool.tcp))


def path_from(move: Move, step: int, begin: Pose) -> Path | Refusal:
    """The path of a move, which is step number `step`, from a pose of the tool in its frame, if there is one."""
    try:
        path = move.path_from((begin.x, begin.y, begin.z))
        path.curve  # noqa: B018 - what is wrong with a path is found when it is made
    except InputError:
        return unmoved(Stage.STRAIGHT, step, Obstacle.NO_PATH)
    return path


def _laws(scene: Scene, way: PathWay, mode: int, limits: Limits) -> list[Paced]:
    """Laws made for the path in the frame as it stands when the leg begins: one that slows down where the path bends,
    and the quickest that is found without parts."""
    stands, curve = replace(way, stands=True), way.path.curve
    _, places, half = widths(curve.junctions, (0.0, curve.length))
    over = dict(zip(places.tolist(), (2 * half).tolist(), strict=True))
    bends = list[Bends]()
    for begin, end in pairwise(curve.edges.tolist()):
        # not at the ends: there the next part counts
        inner = begin + (end - begin) * np.clip(np.linspace(0.0, 1.0, SAMPLES), 1e-9, 1 - 1e-9)
        found = scene.robot.inverse(stands.motion(way.begin + inner / curve.length), mode, 2)
        if not (found.code == Code.ASSEMBLED).all():
            return []
        bends.append(Bends(end - begin, found.qd / curve.length, found.qdd / curve.length**2, over.get(begin, 0.0)))
    laws = list[Paced]()
    slow = slowed_at_bends(bends, limits.velocity, limits.acceleration, limits.jerk)
    if slow is not None:
        laws.append(lambda scale: faster(slow, scale))
    s = np.linspace(0.0, 1.0, TABLE)
    found = scene.robot.inverse(stands.motion(way.begin + s), mode, 2)
    if not (found.code == Code.ASSEMBLED).all():
        return laws
    bend = found.qdd.copy()
    # where the curvature jumps q'' does: it is taken to change over as much of the path as the quintic is steep on
    for place, reach in zip(places / curve.length, half / curve.length / STEEPER, strict=True):
        i, k = int(np.floor((place - reach) * (TABLE - 1))), int(np.ceil((place + reach) * (TABLE - 1)))
        if 0 <= i < k < TABLE:
            bend[i : k + 1] = np.linspace(bend[i], bend[k], k - i + 1)
    quick = quickest((found.qd, bend, np.gradient(bend, s, axis=0)), limits)
    return laws if quick is None else [*laws, as_fast(quick)]
