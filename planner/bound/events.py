"""The points of a task, as the bound of its duration sees them: where the flange must be at each, and for how long."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.bound.fastest import EXACT, FREE, KINDS, STATE, soonest
from assur.planner.frames.motion import Pose
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Move, Pick, Place, Scene, Step, Trace

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
