"""Who is solid against whom, and how far apart, in each leg of a plan: derived from request and legs alone.

A pick attaches its part at the end of its follow, a place detaches it; so the set of the robot's bodies, the frame on
which a part rides and the contacts that are allowed change at the ends of legs and nowhere else. Maker and checker of
the certificate both derive them here; the tests hold this module to a second implementation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import radius, support
from assur.planner.model.outcome import GLUED, Arrival, Leg, LegKind
from assur.planner.model.scene import Move, Pick, Place, Scene, Step

CONTACT_M = 1e-4
"""Bodies in an allowed contact may overlap by this much, m: rounding of poses and a part that is not quite flat."""


@dataclass(frozen=True, slots=True)
class Carried:
    """The part in the gripper and the pose of its frame in the flange frame."""

    part: str
    in_flange: Pose


@dataclass(frozen=True, slots=True)
class Phase:
    """[t0, t1] of one leg (or the standstill after the last, whose step is -1).

    `rides`: for each part that was moved, the frame and the pose it now rides on; `exempt`: pairs of names, sorted,
    that may touch (down to -CONTACT_M); `glued`: the frame that a glued leg follows; `beside`: the frames that the
    glued legs before and behind this way follow.
    """

    t0: float
    t1: float
    kind: LegKind
    step: int
    carried: Carried | None
    rides: tuple[tuple[str, str, Pose], ...]
    exempt: frozenset[tuple[str, str]]
    glued: str | None
    beside: tuple[str, ...]

    @property
    def near(self) -> bool:
        return self.kind in GLUED


def pair(first: str, second: str) -> tuple[str, str]:
    """Two names in the one order in which a pair is stored."""
    return (first, second) if first <= second else (second, first)


def frame_of(step: Step, rides: dict[str, tuple[str, Pose]]) -> str:
    """The frame in which the control point of a step sits, parts being where `rides` says."""
    if isinstance(step, Pick):
        return rides[step.part][0]
    if isinstance(step, Place):
        return step.to.frame
    return step.target.frame


def grasp_in_part(step: Pick, yaw_offset: float) -> Pose:
    """Tool point in the part's frame when the part is taken turned by `yaw_offset` about its own vertical axis."""
    return Pose(yaw=yaw_offset).then(step.grasp)


def held(scene: Scene, step: Pick, yaw_offset: float) -> Carried:
    """The part as the gripper holds it after this pick."""
    return Carried(step.part, scene.tool.tcp.then(grasp_in_part(step, yaw_offset).inverse()))


def flange_target(
    scene: Scene, step: Step, rides: dict[str, tuple[str, Pose]], carried: Carried | None, yaw_offset: float = 0.0
) -> tuple[str, Pose]:
    """Frame, and pose in it, that the flange takes when the control point of `step` is met."""
    to_flange = scene.tool.tcp.inverse()
    if isinstance(step, Pick):
        frame, part = rides[step.part]
        return frame, part.then(grasp_in_part(step, yaw_offset)).then(to_flange)
    if isinstance(step, Place):
        if carried is None or carried.part != step.part:
            raise InputError("task", step.part, "a place only of the part that an earlier pick holds")
        return step.to.frame, step.to.pose.then(carried.in_flange.inverse())
    pose = step.target.pose
    return step.target.frame, Pose(pose.x, pose.y, pose.z, pose.yaw + yaw_offset).then(to_flange)


def resting_on(
    scene: Scene,
    part: str,
    frame: str,
    pose: Pose,
    names: tuple[str, ...] | None,
    rides: dict[str, tuple[str, Pose]] | None = None,
    time: float | None = None,
) -> frozenset[str]:
    """What a part at `pose` in `frame` touches from above: the named bodies, or those under it with their top at its
    bottom.

    Looked at when the part is taken or let go: `time` (None: the start) and `rides`, where each body sits by then
    (None: where it was at the start), so that parts can be stacked. A body counts as under the part when the circles
    about both overlap; an exempted pair must still be proved not to overlap by more than CONTACT_M.
    """
    if names is not None:
        return frozenset(names)
    at, sits = np.array(scene.start.time if time is None else time), rides or initial_rides(scene)
    x, y, z = _where(scene, frame, pose, at)
    bottom = z + _extent(scene, part)[0]
    found = set()
    for body in scene.bodies:
        if body.name == part:
            continue
        bx, by, bz = _where(scene, *sits[body.name], at)
        near = math.hypot(bx - x, by - y) <= _radius(scene, part) + _radius(scene, body.name)
        if near and abs(bz + _extent(scene, body.name)[1] - bottom) <= CONTACT_M:
            found.add(body.name)
    return frozenset(found)


def _where(scene: Scene, frame: str, pose: Pose, t: FloatArray) -> tuple[float, float, float]:
    x, y, z = scene.frames[frame].law.motion(t).at(pose).p.tolist()
    return x, y, z


def _radius(scene: Scene, name: str) -> float:
    """Horizontal distance, m, of a body's points from its own origin at most."""
    return max(radius(piece) for piece in scene.index[name].body.pieces)


def _extent(scene: Scene, name: str) -> tuple[float, float]:
    """Lowest and highest z of a body in its own frame, m."""
    up = np.array([0.0, 0.0, 1.0])
    pieces = scene.index[name].body.pieces
    return -max(support(piece, -up) for piece in pieces), max(support(piece, up) for piece in pieces)


def initial_rides(scene: Scene) -> dict[str, tuple[str, Pose]]:
    """Where every body of the surroundings sits at the start."""
    return dict(scene.seats)


def moved_parts(scene: Scene, rides: dict[str, tuple[str, Pose]]) -> tuple[tuple[str, str, Pose], ...]:
    """The bodies that no longer ride where they did at the start, by name, and where they ride now."""
    names = sorted(name for name, ride in rides.items() if ride != scene.seats[name])
    return tuple((name, *rides[name]) for name in names)


def phases(scene: Scene, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> tuple[Phase, ...]:
    """The phases of a plan with these legs, with the standstill for `stay_safe_s` behind the last one."""
    rides = initial_rides(scene)
    moved: tuple[tuple[str, str, Pose], ...] = ()
    offsets = {arrival.step: arrival.yaw_offset for arrival in arrivals}
    ends = {arrival.step: arrival.until for arrival in arrivals}
    followed = _followed(scene)
    carried: Carried | None = None
    found: list[Phase] = []
    tool = tuple(body.name for body in scene.tool.bodies)
    exempt: frozenset[tuple[str, str]] = frozenset()
    supports: frozenset[str] = frozenset()
    for leg in legs:
        step = scene.task[leg.step]
        glued = leg.kind in GLUED
        frame = frame_of(step, rides) if glued and not isinstance(step, Pick) else None
        exempt = frozenset()
        if isinstance(step, Pick) and glued:
            if carried is None:
                supports = resting_on(scene, step.part, *rides[step.part], step.contact_with, rides, ends.get(leg.step))
                frame = rides[step.part][0]
                exempt = frozenset(pair(name, step.part) for name in tool)
            else:
                frame = _frame_before(found)
                exempt = frozenset(pair(name, step.part) for name in supports)
        if isinstance(step, Place) and glued:
            if carried is not None:
                supports = resting_on(
                    scene, step.part, step.to.frame, step.to.pose, step.contact_with, rides, ends.get(leg.step)
                )
                exempt = frozenset(pair(name, step.part) for name in supports)
            else:
                exempt = frozenset(pair(name, step.part) for name in tool)
        found.append(Phase(leg.t0, leg.t1, leg.kind, leg.step, carried, moved, exempt, frame, ()))
        if leg.kind is LegKind.FOLLOW and isinstance(step, Pick):
            carried = held(scene, step, offsets.get(leg.step, 0.0))
        if leg.kind is LegKind.FOLLOW and isinstance(step, Place):
            rides[step.part] = (step.to.frame, step.to.pose)
            carried, moved = None, moved_parts(scene, rides)
    if scene.options.end == "rest" and scene.options.stay_safe_s > 0 and legs:
        last = legs[-1]
        stay = scene.options.stay_safe_s
        found.append(Phase(last.t1, last.t1 + stay, LegKind.WAIT, -1, carried, moved, frozenset(), None, ()))
    return tuple(_with_neighbours(found, followed))


def _frame_before(found: list[Phase]) -> str | None:
    """The frame that the glued leg before follows: a depart stays in the frame it was picked from."""
    return found[-1].glued if found else None


def _followed(scene: Scene) -> list[str | None]:
    """For each step the frame that its glued legs follow; None: it has none. The task alone says it."""
    rides, found = initial_rides(scene), []
    for step in scene.task:
        found.append(None if isinstance(step, Move) else frame_of(step, rides))
        if isinstance(step, Place):
            rides[step.part] = (step.to.frame, step.to.pose)
    return found


def _with_neighbours(found: list[Phase], followed: list[str | None]) -> list[Phase]:
    """On all of the way between two glued legs, however many legs it has, the arm may be shifted for either."""
    result = []
    for phase in found:
        beside: set[str] = set()
        if phase.glued is None:
            step = phase.step if phase.step >= 0 else len(followed)
            before = [frame for frame in followed[:step] if frame is not None]
            behind = [frame for frame in followed[step:] if frame is not None]
            # the way to rest behind the last glued leg belongs to the step of that leg
            if (
                phase.step >= 0
                and followed[step] is not None
                and any(p.glued for p in found if p.step == step and p.t1 <= phase.t0)
            ):
                before, behind = [*before, str(followed[step])], behind[1:]
            beside = {*before[-1:], *behind[:1]}
        result.append(replace(phase, beside=tuple(sorted(beside))))
    return result


def yaw_offsets(scene: Scene, step: Step) -> tuple[float, ...] | None:
    """Turns of the tool that a control point leaves to choose from, rad; None: any."""
    if "pitch" in scene.robot.coordinates:
        return (0.0,)  # the heading of such an arm follows from the position
    if isinstance(step, Pick):
        fold = scene.index[step.part].yaw_symmetry
        return tuple(2 * np.pi * k / fold for k in range(fold)) if fold > 0 else None
    if not isinstance(step, Place) and step.target.yaw_free:
        return None
    return (0.0,)
