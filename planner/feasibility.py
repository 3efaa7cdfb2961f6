"""Necessary conditions, tried before anything is sampled: what fails here fails for all times and all candidates."""

from __future__ import annotations

import math

import numpy as np

from planner.arrays import FloatArray, IntArray
from planner.certificate import Prover
from planner.containment import inside
from planner.frames import Fixed
from planner.frames.motion import Pose
from planner.gjk import separate
from planner.legs.control_point import ControlPoint, control_point
from planner.outcome import LegKind, Reason, Refusal
from planner.phases import Carried, Phase, held, initial_rides, pair, resting_on, yaw_offsets
from planner.requirement import SLACK_M, clearance, uncertainty
from planner.robots.protocol import Code
from planner.scene import Pick, Place, Scene
from planner.separation import likely_gaps, place, rough_gaps
from planner.solids import Carriers, Solids, carriers

START_RATIO = 1e-9
"""A start velocity or acceleration may exceed its limit by this share: rounding of unit conversions."""


def impossible(scene: Scene, prover: Prover) -> Refusal | None:
    """The first necessary condition that does not hold, or None."""
    return _start_beyond_limits(scene) or _laws_over(scene) or _start_collides(scene, prover) or _points(scene, prover)


def _start_beyond_limits(scene: Scene) -> Refusal | None:
    limits, start = scene.robot.limits, scene.start
    over = np.maximum(limits.lower - start.q, start.q - limits.upper)
    for i, joint in enumerate(scene.robot.joints):
        unit = "rad" if joint.kind == "revolute" else "m"
        if not over[i] <= 0:
            return Refusal(
                "start",
                Reason.JOINT_LIMIT,
                0,
                (joint.name,),
                None,
                float(over[i]),
                unit,
                f"{joint.name} starts beyond its limit",
            )
        for what, value, limit in (
            ("velocity", start.qd[i], limits.velocity[i]),
            ("acceleration", start.qdd[i], limits.acceleration[i]),
        ):
            if not abs(value) <= limit * (1 + START_RATIO):
                detail = f"the start {what} of {joint.name} is beyond its limit"
                return Refusal(
                    "start",
                    Reason.MOTION_LIMIT,
                    0,
                    (joint.name,),
                    None,
                    float(abs(value) - limit),
                    unit + "/s..",
                    detail,
                )
    return None


def _laws_over(scene: Scene) -> Refusal | None:
    start = scene.start.time
    for frame in scene.frames.values():
        low, high = frame.law.valid
        if not low <= start <= high:
            detail = f"the law of {frame.name} is known from {low:g} s to {high:g} s, the start is at {start:g} s"
            return Refusal(
                "start", Reason.LAW_ENDS, 0, (frame.name,), (low, high), max(low - start, start - high), "s", detail
            )
    return None


def _start_collides(scene: Scene, prover: Prover) -> Refusal | None:
    """The arm as it stands at the start, against everything, at the clearance that travel asks for."""
    t = scene.start.time
    phase = Phase(t, t, LegKind.WAIT, 0, None, (), frozenset(), None, ())
    solids = prover.solids(None, ())
    found = _closest(scene, prover, solids, phase, scene.start.q, frozenset())
    if found is not None:
        names, short, detail = found
        return Refusal("start", Reason.START_IN_COLLISION, 0, names, (t, t), short, "m", detail)
    within = _enclosed(scene, prover, solids, scene.start.q, t, frozenset())
    if within is not None:
        return Refusal(
            "start", Reason.START_IN_COLLISION, 0, within, (t, t), math.nan, "m", f"{within[0]} is inside {within[1]}"
        )
    return None


def _closest(
    scene: Scene,
    prover: Prover,
    solids: Solids,
    phase: Phase,
    q: FloatArray,
    exempt: frozenset[tuple[str, str]],
    among: frozenset[str] | None = None,
) -> tuple[tuple[str, str], float, str] | None:
    """The first pair nearer than required at the phase's beginning; `among`: only these bodies of the surroundings,
    against what hangs on the flange."""
    t = np.array([phase.t0])
    where = carriers(scene, q[None], t)
    a, b = prover.asked(solids)
    need = _required(scene, phase, solids, b)
    for i in np.flatnonzero(~(rough_gaps(solids, where, a, b)[0] - SLACK_M > need)):
        x, y = int(a[i]), int(b[i])
        names = (solids.names[solids.body[x]], solids.names[solids.body[y]])
        own = bool(solids.body[y] < solids.robot_bodies)
        if pair(*names) in exempt or (among is not None and (own or names[1] not in among)):
            continue
        if among is not None and scene.robot.links[solids.carrier[x]] not in ("flange", "quill"):
            continue
        found = _pair(prover, solids, where, (x, y), float(need[i]))
        if found is not None:
            return names, *found
    return None


def _required(scene: Scene, phase: Phase, solids: Solids, b: IntArray) -> FloatArray:
    """Metres (P,) asked between the arm and units `b` at the beginning of a phase."""
    asked = clearance(scene, phase)
    extra = [
        scene.execution.tracking_m + float(uncertainty(scene, phase, name, np.array(phase.t0))) for name in scene.frames
    ]
    frame = solids.carrier[b] - solids.links
    found: FloatArray = np.where(frame >= 0, asked + np.array(extra)[np.maximum(frame, 0)], asked)
    return found


def _pair(
    prover: Prover, solids: Solids, where: Carriers, units: tuple[int, int], need: float
) -> tuple[float, str] | None:
    """By how much two bodies are nearer than `need`, and in words; None: they are not."""
    one, other = (np.array(solids.pieces[int(solids.body[unit])]) for unit in units)
    row = np.zeros(len(one) * len(other), dtype=np.int64)
    p, r = place(solids, where, row, np.repeat(one, len(other))), place(solids, where, row, np.tile(other, len(one)))
    gap = likely_gaps(p, r)
    first, second = (solids.names[solids.body[unit]] for unit in units)
    for k in np.argsort(gap, kind="stable"):
        if gap[k] - SLACK_M > need:
            return None
        if prover.collider.touch(p, r, int(k)):
            return max(0.0, need - float(gap[k])), f"{first} touches {second}"
        distance, _ = separate(p, r, int(k))
        if not distance - SLACK_M > need:
            return (
                need - distance,
                f"{first} is {1e3 * distance:.2f} mm from {second} where {1e3 * need:.2f} mm are asked",
            )
    return None


def _enclosed(
    scene: Scene, prover: Prover, solids: Solids, q: FloatArray, t: float, exempt: frozenset[tuple[str, str]]
) -> tuple[str, str] | None:
    """A body of the arm and the mesh whose surface encloses its centre (a mesh is hollow to FCL and to support gaps)."""
    where = carriers(scene, q[None], np.array([t]))
    for world in scene.bodies:
        if world.body.surface is None or world.name not in solids.names:
            continue
        number = solids.names.index(world.name)
        carrier = int(solids.carrier[solids.roots[number]])
        turn, origin = where.rotation[0, carrier], where.position[0, carrier]
        c, s = math.cos(world.pose.yaw), math.sin(world.pose.yaw)
        yaw = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        for mine in range(solids.robot_bodies):
            if pair(solids.names[mine], world.name) in exempt:
                continue
            units = np.array(solids.pieces[mine])
            points = place(solids, where, np.zeros(len(units), dtype=np.int64), units).centre
            local = ((points - origin) @ turn - world.pose.position) @ yaw
            if inside(world.body.surface, local).any():
                return solids.names[mine], world.name
    return None


def _points(scene: Scene, prover: Prover) -> Refusal | None:
    """Control points that can never be met: what hangs on the flange would be inside what stands still around them."""
    rides, carried = initial_rides(scene), None
    for number, step in enumerate(scene.task):
        offsets = yaw_offsets(scene, step)
        if isinstance(step, Place) and (carried is None or carried.part != step.part):
            return None  # the scene's constructor has refused this already
        found = [
            _point(scene, prover, control_point(scene, number, rides, carried, o), rides, carried)
            for o in offsets or ()
        ]
        if found and all(refusal is not None for refusal in found):
            return found[0]
        if isinstance(step, Pick):
            carried = held(scene, step, (offsets or (0.0,))[0])
        if isinstance(step, Place):
            carried, rides = None, {**rides, step.part: (step.to.frame, step.to.pose)}
    return None


def _point(
    scene: Scene,
    prover: Prover,
    point: ControlPoint,
    rides: dict[str, tuple[str, Pose]],
    carried: Carried | None,
) -> Refusal | None:
    """Whether the flange's bodies at the point touch, in every working mode, a body that never moves against it."""
    t = scene.start.time
    if not point.still and not _known(scene, point.frame, t):
        return None
    fixed = isinstance(scene.frames[point.frame].law, Fixed)
    among = frozenset(
        body.name
        for body in scene.bodies
        if rides[body.name][0] == point.frame or (fixed and isinstance(scene.frames[rides[body.name][0]].law, Fixed))
    )
    moved = tuple((name, *rides[name]) for name in sorted(rides) if rides[name] != initial_rides(scene)[name])
    solids = prover.solids(carried, moved)
    kind = LegKind.FOLLOW if point.glued else LegKind.MOVE
    phase = Phase(t, t, kind, point.step, carried, moved, frozenset(), point.frame if point.glued else None, ())
    exempt = _contacts(scene, point, rides)
    refusals = []
    for mode in range(len(scene.robot.modes)):
        solution = scene.robot.inverse(point.flange(np.array([t])).at_rest(), mode, 0)
        if solution.code[0] not in (Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED):
            # seen at another time it may be reached, and collide in the same way; here nothing can be said
            return None
        q = solution.q[0]
        found = _closest(scene, prover, solids, phase, q, exempt, among)
        enclosed = _enclosed(scene, prover, solids, q, t, exempt) if fixed else None
        if found is None and enclosed is None:
            return None
        names, short, detail = found or (enclosed or ("", ""), math.nan, "")
        if enclosed is not None:
            names, detail = enclosed, f"{enclosed[0]} would be inside {enclosed[1]}"
        refusals.append(
            Refusal("control point", Reason.CONTROL_POINT_IN_COLLISION, point.step, names, None, short, "m", detail)
        )
    return refusals[0] if refusals else None


def _known(scene: Scene, frame: str, t: float) -> bool:
    low, high = scene.frames[frame].law.valid
    return low <= t <= high


def _contacts(scene: Scene, point: ControlPoint, rides: dict[str, tuple[str, Pose]]) -> frozenset[tuple[str, str]]:
    step = scene.task[point.step]
    if isinstance(step, Pick):
        return frozenset(pair(body.name, step.part) for body in scene.tool.bodies)
    if isinstance(step, Place):
        names = resting_on(scene, step.part, step.to.frame, step.to.pose, step.contact_with)
        return frozenset(pair(name, step.part) for name in names)
    return frozenset()
