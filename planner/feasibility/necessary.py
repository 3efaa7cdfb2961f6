"""Necessary conditions: what fails here fails for all times and all candidates."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.checker.refusals.overshoot import overshoots
from assur.planner.checker.refusals.places import Spot, spots
from assur.planner.collision.at_rest import Within, closest, enclosed
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.reach import beyond_every_pitch, out_of_range, whatever_the_yaw
from assur.planner.feasibility.spots import in_the_way
from assur.planner.feasibility.witnesses import shown
from assur.planner.kernels.solids import REACH
from assur.planner.legs.arched import too_high
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.missed import never_in_window
from assur.planner.legs.paths.path_leg import path_from, tool_in
from assur.planner.legs.tilt import pitch_free, roll_free, tilts
from assur.planner.model.assembly_mode import lost_at
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.deadline import look
from assur.planner.model.joint_range import beyond
from assur.planner.model.load import SUMS
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase, yaw_offsets
from assur.planner.model.refusal import (
    RATES,
    Bodies,
    Enclosed,
    JointName,
    MotionLimit,
    Obstacle,
    Overload,
    Quantity,
    Reason,
    Refusal,
    Separation,
    Stage,
    law_ends,
    of_joint,
)
from assur.planner.model.scene import Move, Pick, Scene

MOST_WAYS = 64
"""Ways in which parts may sit in the gripper and where they were put down that are looked at, all together."""
ROOM_M = 1e-4
"""A straight part that is told to be long enough is so by this, m."""
HEIGHT_M = 1e-9
"""An arch is proved to be above the range of the lift from this much on, m: rounding of heights."""
START_RATIO = 1e-9
"""A start velocity or acceleration may exceed its limit by this share: rounding of unit conversions."""


def start_impossible(scene: Scene, prover: Prover) -> Refusal | None:
    """The first necessary condition of the start that does not hold, or None.

    Whether the arm collides where it stands is `start_collides`: the proof of any candidate shows that it does not.
    """
    return (
        overloaded(scene)
        or _start_beyond_limits(scene)
        or next(overshoots(scene), None)
        or _laws_over(scene)
        or _start_enclosed(scene, prover)
        or _no_path(scene)
    )


def overloaded(scene: Scene) -> Refusal | None:
    """The first load of the task that the robot may not carry: too heavy, or of too much inertia about the wrist."""
    limits, tool = scene.load_limits, scene.loads[0]
    most = math.inf if limits.most_kg is None else limits.most_kg
    most_inertia = math.inf if limits.max_inertia_kgm2 is None else limits.max_inertia_kgm2
    own = tool.inertia_kgm2 or 0.0
    for load in scene.loads:
        inertia = load.inertia_kgm2 or 0.0
        over: Quantity | None
        if not load.mass_kg <= SUMS * most:
            by_table = bool(limits.shares) and (limits.max_kg is None or most < limits.max_kg)
            facts = Overload(
                of="table" if by_table else "max_load",
                value=load.mass_kg,
                limit=most,
                tool=tool.mass_kg,
                part=load.part,
                part_value=load.mass_kg - tool.mass_kg,
            )
            over = Quantity.of(load.mass_kg - most, "kg")
        elif not inertia <= SUMS * most_inertia:
            facts = Overload(
                of="max_inertia",
                value=inertia,
                limit=most_inertia,
                tool=own,
                part=load.part,
                part_value=inertia - own,
            )
            over = Quantity.of(inertia - most_inertia, "kg·m²")
        else:
            continue
        stage, step = (Stage.START, 0) if load.step < 0 else (Stage.CONTROL_POINT, load.step)
        subject = None if load.part is None else Bodies((load.part,))
        return Refusal(stage=stage, reason=Reason.LOAD_LIMIT, step=step, subject=subject, amount=over, facts=facts)
    return None


def points_impossible(scene: Scene, prover: Prover) -> Refusal | None:
    """A start that collides, or a control point that can never be met: it is out of range, or what hangs on the flange
    would be too near what stands still around it, there or where a straight part ends; and the checker is shown it.

    Asked only when the first candidates have failed: where they have not, the arm can leave and the points can be met.
    """
    colliding = start_collides(scene, prover)
    if colliding is not None and shown(scene, prover, colliding):
        return colliding
    # all ways in which parts may sit by then; `turned`: the part is held in some yaw or other
    ways: tuple[Attachments, ...] = (at_start(scene),)
    turned = False
    for number, step in enumerate(scene.task):
        offsets, tilt = yaw_offsets(scene, step), tilts(scene, step, scene.start.q)[0]
        if pitch_free(scene, step):
            never = beyond_every_pitch(scene, control_point(scene, number, ways[0], 0.0, tilt))
            if never is not None and shown(scene, prover, never):
                return never
            continue  # some pitch reaches it; which of them are free of bodies is a matter of search
        any_yaw = turned or offsets is None
        points = [
            (attached, control_point(scene, number, attached, turn, tilt))
            for attached in ways
            for turn in ((0.0,) if offsets is None else offsets)
        ]
        beyond = [out_of_range(scene, point) for _, point in points]
        out = beyond[0] if all(r is not None and (not any_yaw or whatever_the_yaw(scene, r)) for r in beyond) else None
        if out is not None and shown(scene, prover, out):
            return out
        if roll_free(scene, step):
            continue  # at another roll a body on the flange may be elsewhere
        if scene.options.vias_missed and step.via:
            continue  # its pose is missed: that it collides there proves nothing
        found = [_point(scene, prover, point, attached) for attached, point in points]
        hits = [each for each in found if each is not None]
        always = not any_yaw or all(_whatever_the_yaw(scene, prover, *each) for each in hits)
        if len(hits) == len(found) and always and shown(scene, prover, hits[0][0]):
            return hits[0][0]
        ways = tuple(dict.fromkeys(attached.after(scene, step, point.yaw_offset) for attached, point in points))
        if len(ways) > MOST_WAYS:
            return None
        if step.part is not None:
            turned = offsets is None and isinstance(step, Pick)
    return None


def arches_impossible(scene: Scene) -> Refusal | None:
    """The first step whose arch is above the range of the lift."""
    tops = (too_high(scene, number, scene.start.q, HEIGHT_M) for number in range(len(scene.task)))
    return next((refusal for refusal in tops if refusal is not None), None)


def windows_impossible(scene: Scene) -> Refusal | None:
    """A step whose window, or what is known of whose frame's motion, is too short for it whenever the arm comes.

    Where along its frame a point is does not depend on how the tool is turned: one way to hold the parts is looked at.
    """
    attached = at_start(scene)
    for number, step in enumerate(scene.task):
        point = control_point(scene, number, attached, 0.0, tilts(scene, step, scene.start.q)[0])
        never = never_in_window(scene, point)
        if never is not None:
            return never
        attached = attached.after(scene, step)
    return None


def _start_beyond_limits(scene: Scene) -> Refusal | None:
    limits, start = at_start(scene).limits(scene), scene.start
    over = np.maximum(limits.lower - start.q, start.q - limits.upper)
    for i, joint in enumerate(scene.robot.joints):
        if not over[i] <= 0:
            return Refusal(
                stage=Stage.START,
                reason=Reason.JOINT_LIMIT,
                step=0,
                subject=JointName(joint.name),
                amount=of_joint(joint.kind, float(over[i])),
                facts=beyond(scene, i, float(start.q[i])),
            )
        rates = (start.qd[i], limits.velocity[i]), (start.qdd[i], limits.acceleration[i])
        for order, (value, limit) in enumerate(rates, start=1):
            if not abs(value) <= limit * (1 + START_RATIO):
                return Refusal(
                    stage=Stage.START,
                    reason=Reason.MOTION_LIMIT,
                    step=0,
                    subject=JointName(joint.name),
                    amount=of_joint(joint.kind, float(abs(value) - limit), order),
                    facts=MotionLimit(
                        obstacle=Obstacle.RATE, rate=RATES[order - 1], value=abs(float(value)), limit=float(limit)
                    ),
                )
    at, robot = start.q[None], scene.robot
    if not robot.assembled(at, at).all():
        return lost_at(robot, Stage.START, 0, np.array([start.time]), robot.parallel_margin(at))
    return None


def _laws_over(scene: Scene) -> Refusal | None:
    """Whether the motion of a frame that bears a body is not known at the start."""
    start = scene.start.time
    for name in {body.frame: None for body in scene.bodies}:
        low, high = scene.frames[name].law.valid
        if not low <= start <= high:
            return law_ends(Stage.START, 0, name, (low, high), start, interval=(low, high))
    return None


def start_collides(scene: Scene, prover: Prover) -> Refusal | None:
    """The arm as it stands at the start, against everything, at the clearance that travel asks for."""
    t = scene.start.time
    phase = Phase(t, t, LegKind.WAIT, 0, at_start(scene))
    found = closest(scene, prover, phase, scene.start.q, frozenset())
    if found is None:
        return None
    return _hit(Stage.START, Reason.START_IN_COLLISION, 0, found.names, found.facts, interval=(t, t))


def _hit(
    stage: Stage,
    reason: Reason,
    step: int,
    names: tuple[str, str],
    facts: Separation | Enclosed,
    interval: tuple[float, float] | None = None,
) -> Refusal:
    """A collision of two bodies of these names."""
    short = None
    if isinstance(facts, Separation) and facts.gap_m is not None and facts.required_m is not None:
        short = Quantity.of(facts.required_m - facts.gap_m, "m")
    subject = Bodies(names)
    return Refusal(stage=stage, reason=reason, step=step, subject=subject, interval=interval, amount=short, facts=facts)


def _start_enclosed(scene: Scene, prover: Prover) -> Refusal | None:
    """Whether the arm stands inside a mesh, which is hollow to the proof."""
    if all(world.body.surface is None for world in scene.bodies):
        return None
    t = scene.start.time
    within = enclosed(scene, prover, at_start(scene), scene.start.q, t, frozenset())
    if within is None:
        return None
    return _hit(Stage.START, Reason.START_IN_COLLISION, 0, within.names, Enclosed(), interval=(t, t))


def _no_path(scene: Scene) -> Refusal | None:
    """Whether the first step goes along a path that cannot be, from where the tool stands at the start."""
    move, start = scene.task[0], scene.start
    if not isinstance(move, Move) or not move.path or not scene.frames[move.target.frame].law.is_fixed:
        return None
    made = path_from(move, 0, tool_in(scene, move.target.frame, start.q, start.time))
    return made if isinstance(made, Refusal) else None


def _point(
    scene: Scene, prover: Prover, point: ControlPoint, attached: Attachments
) -> tuple[Refusal, Attachments] | None:
    """Whether the flange's bodies at the point, or at the outer ends of its straight parts, are too near a body that
    never moves against it, in every working mode; and where bodies sit then."""
    look()
    t = scene.start.time
    if not point.still and not _known(scene, point.frame, t):
        return None
    around = spots(scene, point.step, attached, attached.after(scene, point.facts, point.yaw_offset))
    found = list[tuple[Refusal, Attachments]]()
    for mode in range(len(scene.robot.modes)):
        hit = next((hit for spot in around if (hit := _in_the_way(scene, prover, point, spot, mode))), None)
        if hit is None:
            return None
        found.append(hit)
    return found[0] if found else None


def _in_the_way(
    scene: Scene, prover: Prover, point: ControlPoint, spot: Spot, mode: int
) -> tuple[Refusal, Attachments] | None:
    """What is in the way of the flange's bodies at one spot and in one working mode; None: nothing, or it is not
    known, as the spot may be reached at another time."""
    hit = in_the_way(scene, prover, point, spot, mode)
    if hit is None:
        return None
    reason, attached = Reason.CONTROL_POINT_IN_COLLISION, spot.attached
    if isinstance(hit.found, Within):
        return _hit(Stage.CONTROL_POINT, reason, point.step, hit.found.names, Enclosed()), attached
    facts = hit.found.facts
    if spot.end is not None:
        facts = replace(facts, end=spot.end, straight_m=spot.above)
        gap, required = facts.gap_m, facts.required_m
        if gap is not None and required is not None:
            longer = replace(spot, above=spot.above + required - max(gap, 0.0) + ROOM_M, end=None)
            if _in_the_way(scene, prover, point, longer, mode) is None:
                facts = replace(facts, least_m=longer.above)
    return _hit(Stage.CONTROL_POINT, reason, point.step, hit.found.names, facts), attached


def _whatever_the_yaw(scene: Scene, prover: Prover, refusal: Refusal, attached: Attachments) -> bool:
    """Whether turning the tool about its axis changes nothing for the body that is in the way."""
    tcp = scene.tool.tcp
    arrangement = prover.arrangement(attached)
    units = np.array(arrangement.pieces(arrangement.number[refusal.bodies[0]]))
    on_quill = scene.robot.links[arrangement.carrier[units[0]]] == "quill"
    return tcp.x == 0.0 and tcp.y == 0.0 and (on_quill or bool((arrangement.rows[units, REACH] == 0.0).all()))


def _known(scene: Scene, frame: str, t: float) -> bool:
    low, high = scene.frames[frame].law.valid
    return low <= t <= high
