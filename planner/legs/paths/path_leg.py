"""Cartesian legs along a path: lines, arcs and splines in a frame, corners rounded, without a stop in between.

The tool point is at r(s L) of a path of length L in the frame, its yaw, pitch and roll go from end to end by the same
s, and s goes from 0 to 1 by a phase law, as on a straight leg (`assur.planner.legs.straight`). At s = 0 and s = 1 the
tool moves with the frame.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.follower import Uniform, Way, first_beyond, followed
from assur.planner.legs.paths.corner_law import SAMPLES, STEEPER, Bends, faster, slowed_at_bends
from assur.planner.legs.paths.course import PathCourse
from assur.planner.legs.phase_law import TABLE, quickest
from assur.planner.legs.state import State, TimedLeg
from assur.planner.legs.straight import CLOSE_ROUNDS, Paced, as_fast, by_law, constant_law
from assur.planner.legs.tilt import tilt_of
from assur.planner.model.path import Path
from assur.planner.model.refusal import BeyondRange, Obstacle, Refusal, Stage, unmoved
from assur.planner.model.scene import Move, Scene
from assur.planner.robots.facts import Code, Limits
from assur.planner.timing import TimingRefusal


def along_path(
    scene: Scene, point: ControlPoint, state: State, modes: tuple[int, int], tracked: ControlPoint | None
) -> TimedLeg | Refusal:
    """A leg along the path of a move from `state`, at rest or while `tracked` is tracked, until the tool is at `point`.

    Refused: another frame or working mode than it begins in, points from which there is no path, and, with the place on
    the path, out of reach, too near a singularity, a joint beyond its range.
    """
    course = _course(scene, point, state, modes, tracked)
    if isinstance(course, Refusal):
        return course
    way = Way(scene, Stage.STRAIGHT, point.step, course, Uniform(), state.time, point.frame)
    mode, limits = modes[0], point.limits
    found = [by_law(way, state, mode, paced, CLOSE_ROUNDS, limits) for paced in _laws(way, course, mode, limits)]
    if not (point.still and any(isinstance(leg, TimedLeg) for leg in found)):
        plain = by_law(way, state, mode, constant_law, 0, limits)
        found.append(_placed(way, state, mode, plain) if isinstance(plain, Refusal) else plain)
    legs = [leg for leg in found if isinstance(leg, TimedLeg)]
    return min(legs, key=lambda leg: leg.knots.end) if legs else found[-1]


def _placed(way: Way, state: State, mode: int, refusal: Refusal) -> Refusal:
    """A refusal of a joint's range with where on the path it is beyond."""
    law = constant_law(1.0)
    if not isinstance(refusal.facts, BeyondRange) or refusal.joint is None or isinstance(law, TimingRefusal):
        return refusal
    way = replace(way, phase=law)
    made = followed(way, state, mode)
    if isinstance(made, Refusal):
        return refusal
    return replace(refusal, facts=replace(refusal.facts, **way.spot(first_beyond(way.scene, made, refusal.joint))))


def _course(
    scene: Scene, point: ControlPoint, state: State, modes: tuple[int, int], tracked: ControlPoint | None
) -> PathCourse | Refusal:
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
    end, length = point.pose.then(scene.tool.tcp), path.length
    turn = float(np.remainder(end.yaw - begin.yaw + np.pi, 2 * np.pi) - np.pi)
    before = tilt_of(scene.robot, state.q)
    tilts = None if before is None or point.tilt is None else (before, point.tilt)
    tcp, none = scene.tool.tcp, np.zeros(3)
    return PathCourse(scene, point.frame, path, (0.0, length), length, tcp, none, (begin.yaw, turn), tilts)


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


def _laws(way: Way, course: PathCourse, mode: int, limits: Limits) -> list[Paced]:
    """Laws made for the path in the frame as it stands when the leg begins: one that slows down where the path bends,
    and the quickest that is found without parts."""
    stands, curve, robot = replace(way, course=replace(course, stands=way.begin)), course.path.curve, way.scene.robot
    _, places, half = course.widths
    over = dict(zip(places.tolist(), (2 * half).tolist(), strict=True))
    bends = list[Bends]()
    for begin, end in pairwise(curve.edges.tolist()):
        # not at the ends: there the next part counts
        inner = begin + (end - begin) * np.clip(np.linspace(0.0, 1.0, SAMPLES), 1e-9, 1 - 1e-9)
        found = robot.inverse(stands.motion(way.begin + inner / curve.length), mode, 2)
        if not (found.code == Code.ASSEMBLED).all():
            return []
        bends.append(Bends(end - begin, found.qd / curve.length, found.qdd / curve.length**2, over.get(begin, 0.0)))
    laws = list[Paced]()
    slow = slowed_at_bends(bends, limits.velocity, limits.acceleration, limits.jerk)
    if slow is not None:
        laws.append(lambda scale: faster(slow, scale))
    s = np.linspace(0.0, 1.0, TABLE)
    found = robot.inverse(stands.motion(way.begin + s), mode, 2)
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
