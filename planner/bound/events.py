"""The points of a task, as the bound of its duration sees them: where the flange must be at each, and for how long."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.bound.fastest import EXACT, FREE, KINDS, STATE, soonest
from assur.planner.bound.guided import RATES
from assur.planner.frames.motion import Motion, Pose, TiltedMotion
from assur.planner.kernels import law_columns as c
from assur.planner.laws import Law
from assur.planner.laws.ramps import Change, ramped
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Move, Pick, Place, Scene, Step, Trace
from assur.planner.robots.facts import Code
from assur.planner.robots.robot import Robot

MOST_TURNS = 8
"""Turns of a symmetric part that are told apart; with more, its yaw counts as free."""
ALONG, STOPS, PASSES = range(3)
"""What is asked when a point is met: to go along with it, to stand still, or nothing but to be there."""


@dataclass(frozen=True, slots=True)
class Event:
    """The tool at a control point. `point`: in `frame`, that whose way along a conveyor a
    window measures; `poses`: of the flange, one of them (empty: not known); `free`: with any
    yaw; `pitch`, `roll`: of an arm that has them, NaN where they are free. `kind`: ALONG, STOPS or PASSES. `opens`: it
    is not met sooner, s. `before`, `after`: the parts in the gripper (None: none). `traced`: so long, s, the tool goes
    on to the next event, and no less."""

    step: Step
    frame: str
    point: Pose
    poses: tuple[Pose, ...]
    free: bool
    pitch: float
    roll: float
    kind: int
    dwell: float
    opens: float
    before: str | None
    after: str | None
    traced: float = 0.0


def events(scene: Scene) -> tuple[Event, ...]:
    """What must be passed, in order. A path that is traced is two events: its first point, and its last."""
    lies = {body.name: (body.frame, body.pose) for body in scene.bodies}
    # the part in the gripper, and the poses that the tool point may have in it
    held, grasps, found = None, tuple[Pose, ...](), list[Event]()
    if scene.start.holding is not None:
        held, grasps = scene.start.holding.part, (scene.start.holding.grasp,)
    for step in scene.task:
        before = held
        if isinstance(step, Pick):
            (frame, point), offsets = lies[step.part], yaw_offsets(scene, step)
            turns = offsets if offsets is not None and len(offsets) <= MOST_TURNS else None
            taken = tuple(Pose(yaw=turn).then(step.grasp) for turn in turns or (0.0, 0.5 * math.pi))
            tools, free = tuple(point.then(grasp) for grasp in taken), turns is None
            held, grasps = step.part, () if turns is None else taken
        elif isinstance(step, Place):
            frame, point = step.to.frame, step.to.pose
            tools, free = tuple(point.then(grasp) for grasp in grasps), False
            lies[step.part], held, grasps = (frame, point), None, ()
        else:
            frame, point = step.target.frame, step.target.pose
            free = step.target.yaw_free
            turns = (0.0, 0.5 * math.pi) if free else (0.0,)
            tools = tuple(Pose(point.x, point.y, point.z, point.yaw + turn) for turn in turns)
        found += _events(scene, step, (frame, point), tools, free, before, held)
    return tuple(found)


def _events(
    scene: Scene,
    step: Step,
    where: tuple[str, Pose],
    tools: tuple[Pose, ...],
    free: bool,
    before: str | None,
    after: str | None,
) -> list[Event]:
    frame, point = where
    poses = tuple(tool.then(scene.tool.tcp.inverse()) for tool in tools)
    if free:
        # with a tool point beside the flange's axis the yaw moves the flange
        one, other = poses[0], poses[-1]
        poses = poses[:1] if math.hypot(one.x - other.x, one.y - other.y) <= ROUNDING_M else ()
    target = step.target
    pitch, roll = (math.nan if each is None else each for each in ((target.pitch, target.roll) if target else (0, 0)))
    window = step.window.time
    opens = max(scene.start.time, scene.frames[frame].law.valid[0], -math.inf if window is None else window[0])
    kind = PASSES if step.via else STOPS if step.match == "position" else ALONG
    if kind == STOPS and not isinstance(step, Move) and not scene.frames[frame].law.is_fixed:
        kind = PASSES  # above the point the tool goes along with it, and stands at the point: nothing holds at both
    lasts = step.dwell_s
    if isinstance(step, Trace):
        ends = (step.path.begin, step.path.end)
        tcp = scene.tool.tcp.inverse()
        both = [tuple(Pose(*end, tool.yaw).then(tcp) for tool in tools if poses) for end in ends]
        spans = ((opens, lasts), (opens + lasts, 0.0))
        return [
            Event(step, frame, point, here, free, pitch, roll, PASSES, 0.0, sooner, before, after, traced)
            for here, (sooner, traced) in zip(both, spans, strict=True)
        ]
    if isinstance(step, Move) and step.via and scene.options.vias_missed:
        poses = ()  # it is not passed exactly
    return [Event(step, frame, point, poses, free, pitch, roll, kind, lasts, opens, before, after)]


ROUNDING_M = 1e-9
"""m. Places that are no farther apart are one."""


def straight_times(scene: Scene, event: Event, before: FloatArray, behind: FloatArray) -> tuple[float, float, float]:
    """The least times, s, that the lift takes for the straight parts before and behind a point that stays at its
    height, in which no other joint may move against it, and for that behind it if the motion ends at rest there.
    `before`, `behind` (3, n): limits of velocity, acceleration and jerk. 0 where the arm has no lift."""
    lift, step = scene.robot.lift, event.step
    if lift is None or not isinstance(step, Pick | Place):
        return 0.0, 0.0, 0.0
    (approach, depart), limits = scene.straight(step), behind[:, lift]
    early = lifted(approach, before[:, lift], stops=step.approach_stop)
    rests = lifted(depart, limits, stops=True) if scene.options.end == "rest" else 0.0
    return early, lifted(depart, limits, stops=step.depart_stop), rests


def lifted(way: float, limits: FloatArray, *, stops: bool) -> float:
    """The least time from rest over a way, to rest again or to any velocity."""
    if not way > 0.0:
        return 0.0
    begin, end = np.zeros((STATE, 1)), np.zeros((STATE, 1))
    end[0], end[KINDS] = way, EXACT if stops else FREE
    return soonest(begin, end, np.zeros(1), np.ascontiguousarray(limits[:, None]), 0.0)


def still(scene: Scene, event: Event) -> bool:
    """Whether the point of an event never moves."""
    return scene.frames[event.frame].law.kind == "fixed"


# All joint positions of an arm at a place: its inverse in every working mode, at every full turn.
#
# Near a singularity a joint may be anywhere while the tool is at its place up to rounding: it is not known there (NaN).

LEAST_MARGIN = 1e-3
"""An arm with a smaller singularity margin has no known angles: 1 µm at its end moves them by 0.001 rad."""
MOST = 64
"""Joint positions at one place, at most: with more, none is known of it."""


class Unplaced(Exception):
    """Nothing is known of the joint positions at a place: there are too many, or none."""


def places(
    robot: Robot, modes: tuple[int, ...], x: float, y: float, z: float, yaw: float, pitch: float, roll: float
) -> FloatArray:
    """Joint positions (N, n) within the joints' ranges that put the flange there, in any of the working modes; NaN in
    what an angle that is not given (NaN) leaves open. Raises `Unplaced` where there are none or more than `MOST`."""
    given = [0.0 if math.isnan(angle) else angle for angle in (yaw, pitch, roll)]
    flange, tilts = Motion.still(Pose(x, y, z, given[0])), "pitch" in robot.coordinates
    if tilts:
        flange = TiltedMotion.of(flange, np.array(given[1:]))
    found: list[tuple[float, ...]] = []
    for mode in modes:
        if tilts and math.isnan(pitch):
            # whatever the pitch, the hand is in the vertical plane of the arm; behind the base in the last two modes
            turn = math.atan2(y - robot.base.y, x - robot.base.x) - robot.base.yaw + (math.pi if mode >= 2 else 0.0)
            q = [turn, math.nan, math.nan, math.nan, roll]
        else:
            inverse = robot.inverse(flange, mode, 0)
            if inverse.code in (Code.OUT_OF_REACH, Code.INDETERMINATE):
                continue
            known = inverse.margin >= LEAST_MARGIN
            q = np.where((robot.revolute == 0.0) | known, inverse.q, np.nan).tolist()
            if math.isnan(roll) if tilts else math.isnan(yaw) and robot.turns_load:
                q[-1] = math.nan
        choices = [turned(robot, k, at) for k, at in enumerate(q)]
        # counted before they are made: joints with 64 turns each have a thousand million positions together
        if len(found) + math.prod(map(len, choices)) > MOST:
            raise Unplaced
        found += product(*choices)
    if not found:
        raise Unplaced
    return np.array(found)


def modes_asked(robot: Robot, elbow: str, q: FloatArray) -> tuple[int, ...]:
    """Numbers of the working modes in which an arm that starts at q (n,) may meet its points."""
    if elbow == "keep" and robot.dyads == 1:
        return (int(robot.mode_of(q)),)
    return tuple(range(len(robot.modes))) if elbow in ("auto", "keep") else (robot.modes.index(elbow),)


def turned(robot: Robot, joint: int, at: float, off: float = 0.0) -> list[float]:
    """Positions of a joint, whole turns from `at`, that are within its range or at most `off` beyond it; NaN stays as
    it is."""
    low, high = (float(edge[joint]) for edge in robot.limits.within)
    slack = 1e-9 * (high - low) + off
    if math.isnan(at):
        return [at]
    if robot.joints[joint].kind != "revolute":
        return [at] if low - slack <= at <= high + slack else []
    first, last = math.ceil((low - slack - at) / math.tau), math.floor((high + slack - at) / math.tau)
    return [at + turn * math.tau for turn in range(first, last + 1)]


# Bounds of how fast a point of a frame moves, over intervals of time, from the numbers of its law.

STEP = 2.1876, 7.5133, 52.51
"""The greatest |x'|, |x''|, |x'''| of the step of an indexer (F3), in steps and moves: 35/16 of them at its middle,
84/(5 √5), and 52.5 at its middle, rounded up."""
EDGE_S = 1e-9
"""s. So near to a change of speed an interval counts as touching it: rounding of times."""


def known(law: Law) -> bool:
    """Whether `rates` knows the law."""
    return law.kind in ("conveyor", "fixed", "indexer", "keyframes", "linear", "oscillation", "swing", "turntable")


def climbs(law: Law) -> bool:
    """Whether the height of the frame may change."""
    if law.kind == "linear":
        return law.numbers.velocity[2] != 0.0
    if law.kind == "oscillation":
        return law.numbers.direction[2] != 0.0
    if law.kind == "turntable":
        return law.numbers.rise != 0.0
    if law.kind == "keyframes":
        return any(pose.z != law.numbers.poses[0].z for pose in law.numbers.poses)
    return law.kind not in ("conveyor", "fixed", "indexer", "swing")


def rates(law: Law, arm_m: float, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Bounds (N, 9) as `assur.planner.bound.guided` has them, of a point `arm_m` metres from a frame's axis,
    over [begin, end] (N,), s: of the velocity, acceleration and jerk of the point in the plane, of its height, and of
    the frame's yaw. Infinite: not bounded."""
    plane, height, yaw = (np.zeros((3, len(begin))) for _ in range(3))
    of = law.numbers
    if law.kind == "linear":
        plane[0], height[0] = math.hypot(*of.velocity[:2]), abs(of.velocity[2])
    elif law.kind == "conveyor":
        plane = _ramps(of.speed, of.changes, of.at_time, begin, end)
    elif law.kind == "turntable":
        yaw = _ramps(of.rate, of.changes, of.at_time, begin, end)
        height[0] = abs(of.rise)
    elif law.kind in ("oscillation", "swing"):
        waves = np.array([abs(of.amplitude) * (math.tau / of.period) ** k for k in (1, 2, 3)])[:, None]
        if law.kind == "swing":
            yaw += waves
        else:
            length = math.hypot(*of.direction)
            plane += waves * math.hypot(*of.direction[:2]) / length
            height += waves * abs(of.direction[2]) / length
    elif law.kind == "indexer":
        steps = np.array([abs(of.step) * STEP[k] / of.move_s ** (k + 1) for k in range(3)])[:, None]
        if of.turns:
            yaw += steps
        else:
            plane += steps
    elif law.kind == "keyframes":
        of_all = _splines(law)
        plane += np.hypot(of_all[:, 0], of_all[:, 1])[:, None]
        height += of_all[:, 2, None]
        yaw += of_all[:, 3, None]
    elif law.kind != "fixed":
        return np.full((len(begin), RATES), math.inf)
    w, dw, ddw = yaw
    plane[0] += arm_m * w
    plane[1] += arm_m * (dw + w**2)
    plane[2] += arm_m * (ddw + 3.0 * w * dw + w**3)
    return np.ascontiguousarray(np.concatenate([plane, height, yaw]).T)


def _ramps(speed: float, changes: tuple[Change, ...], at_time: float, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Bounds (3, N) of what has a speed that changes (R1). In each piece the acceleration has one sign, so that the
    speed is greatest at an end."""
    found = np.zeros((3, len(begin)))
    if not changes:
        found[0] = abs(speed)
        return found
    ways = ramped(speed, changes, at_time, "law")
    ends = [*(since for since, *_ in ways[1:]), math.inf]
    for number, ((since, _, v, a, j), until) in enumerate(zip(ways, ends, strict=True)):
        low, high = np.maximum(begin, since - EDGE_S) if number else begin, np.minimum(end, until + EDGE_S)
        among = low <= high
        for t in (low - since, high - since):
            found[0] = np.where(among, np.maximum(found[0], np.abs(v + t * (a + t * (j / 2.0)))), found[0])
            found[1] = np.where(among, np.maximum(found[1], np.abs(a + t * j)), found[1])
        found[2] = np.where(among, np.maximum(found[2], abs(j)), found[2])
    for change in changes:
        if change.jerk == math.inf:
            # its acceleration jumps: at its begin, and at its end, which comes within this time
            over = change.time + 2.0 * _fastest(speed, changes) / change.acceleration
            found[2] = np.where((begin <= over + EDGE_S) & (end >= change.time - EDGE_S), math.inf, found[2])
    return found


def _fastest(speed: float, changes: tuple[Change, ...]) -> float:
    return max(abs(each) for each in (speed, *(change.speed for change in changes)))


def _splines(law: Law) -> FloatArray:
    """Bounds (3, 4) of the rates of x, y, z, yaw over all of a spline (F5): the velocity of a piece is a parabola."""
    pieces = law.side[: int(law.row[c.COUNT])]
    h, v = (pieces[:, c.PIECE_END] - pieces[:, c.PIECE_BEGIN])[:, None], pieces[:, c.RATE : c.CORNER]
    a, j = (pieces[:, c.POWER + k :: c.MOST_POWERS] for k in (0, 1))
    most_a = np.maximum(np.abs(a), np.abs(a + j * h))
    most_v = np.maximum(np.abs(v), np.abs(v + h * (a + j * h / 2.0))) + 0.125 * np.abs(j) * h * h
    return np.array([most_v.max(axis=0), most_a.max(axis=0), np.abs(j).max(axis=0)])
