"""Necessary conditions: what fails here fails for all times and all candidates."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals import points, start
from assur.planner.checker.refusals.postures import allowed_modes
from assur.planner.checker.refusals.stated import Proof, exceeded, spots
from assur.planner.checker.refusals.ways import is_turn, ways
from assur.planner.checker.refusals.windows import overshoots
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import hit_at_start, hits, point_of, posture, refusal_of
from assur.planner.feasibility.witnesses import shown
from assur.planner.frames.motion import Motion
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.missed import never_in_window, too_high
from assur.planner.legs.path_leg import lead_in_begin
from assur.planner.legs.tilt import pitch_free, tilts
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.phases import Attachments, at_start
from assur.planner.model.refusal import (
    OutOfReach,
    Reason,
    Refusal,
    Stage,
    out_of_reach,
)
from assur.planner.model.scene import Scene, beyond_at_nearest_turn
from assur.planner.robots.facts import RANGE_SLACK, Code
from assur.planner.robots.turns import beyond_range, equivalents

# Points where the arm can never be: those that stand still out of reach, or beyond a joint limit, in every allowed
# mode; and those on a frame that repeats its motion which stay out of reach for a whole period.

EDGE_M = 1e-9
"""A point is called out of reach at every pitch, or at all times, from this much on, m: rounding of coordinates of a
few metres, and of times."""
PARTS = 512
"""Parts of a period; the way of a point is bounded over each."""


def out_of_range(scene: Scene, number: int) -> Refusal | None:
    """Why no joint position meets the control point of a step, or what is required above it, however the part is held;
    None: one does, or nobody knows, for it moves."""
    refusal = None
    for way in ways(scene, number):
        point = point_of(scene, way)
        if not point.still:
            return _never_near(scene, point)  # as all points of the step, which are on one frame
        beyond = _in_no_mode(scene, point)
        if beyond is None:
            return None
        refusal = refusal or beyond
    return refusal


def _in_no_mode(scene: Scene, point: ControlPoint) -> Refusal | None:
    """Why a point is met in no working mode that is allowed; None: it is in one."""
    refusals = []
    for mode in map(scene.robot.modes.index, allowed_modes(scene)):
        heights = dict.fromkeys((0.0, point.approach, point.depart))
        here = [_refused(scene, point, above, mode) for above in heights]
        refused = [refusal for refusal in here if refusal is not None]
        if not refused:
            return None
        # the worst of them: with less, the others would still not be met
        refusals.append(max(refused, key=lambda refusal: refusal.missing))
    return min(refusals, key=lambda refusal: refusal.missing, default=None)


def _refused(scene: Scene, point: ControlPoint, above: float, mode: int) -> Refusal | None:
    robot = scene.robot
    motion = point.flange(np.array([scene.start.time]), above).at_rest()
    found = robot.inverse(motion, mode, 0)
    if found.code[0] == Code.OUT_OF_REACH:
        return _far(scene, point, motion, mode)
    q = found.q[0]
    limits = robot.limits
    if not np.isfinite(q).all() or len(equivalents(robot, q, limits.lower - limits.slack, limits.upper + limits.slack)):
        return None
    over, lead_in = beyond_range(robot, q), lead_in_begin(point)
    worst = int(np.argmax(over))
    facts = replace(beyond_at_nearest_turn(scene, worst, q), mode=robot.modes[mode], above_m=above, **lead_in)
    beyond = exceeded(scene, Reason.JOINT_LIMIT, worst, float(over[worst]), facts)
    return beyond.refusal(Stage.CONTROL_POINT, point.step)


def _far(scene: Scene, point: ControlPoint, motion: Motion, mode: int) -> Refusal:
    """By how much a point is out of reach."""
    robot, target, lead_in = scene.robot, motion.p[0], lead_in_begin(point)
    has = float(target[2]) if "z" in robot.coordinates else float(robot.forward(scene.start.q)[0][2])
    short = abs(float(target[2]) - has)
    if short > EDGE_M:
        facts = OutOfReach(heights_m=(float(target[2]), has), **lead_in)
    else:
        distance = float(np.hypot(target[0] - robot.base.x, target[1] - robot.base.y))
        short = float(np.maximum(-robot.reach_margin(motion, mode)[0], 0.0))
        pitch = float(motion.tilt[0, 0]) if motion.tilted else None
        facts = OutOfReach(from_axis_m=distance, pitch_rad=pitch, **lead_in)
    return out_of_reach(Stage.CONTROL_POINT, point.step, short_m=short, facts=facts)


def _never_near(scene: Scene, point: ControlPoint) -> Refusal | None:
    """Why an arm with a lift reaches a point on a frame that repeats its motion at no time. In the middle of each part
    of a period the flange is so far out of reach, and in half a part it comes no nearer than its greatest speed across
    takes it (equation F11)."""
    law, robot = scene.frames[point.frame].law, scene.robot
    period = law.cycle_s
    if period is None or robot.lift is None:
        return None
    edges = scene.start.time + period * np.arange(PARTS + 1) / PARTS
    middle = point.flange((edges[:-1] + edges[1:]) / 2)
    short = -np.max([robot.reach_margin(middle, mode) for mode in range(len(robot.modes))], axis=0)
    for i in range(PARTS):
        x, y, _ = law.sweep(edges[i], edges[i + 1]).point(1, point.pose.x, point.pose.y, 0.0)
        short[i] -= math.hypot(x, y) * (edges[i + 1] - edges[i]) / 2
    least = float(short.min())
    if not least > EDGE_M:  # nor where the law is not known for a whole period
        return None
    return out_of_reach(Stage.CONTROL_POINT, point.step, short_m=least, facts=OutOfReach())


HEIGHT_M = 1e-9
"""An arch is proved to be above the range of the lift from this much on, m: rounding of heights."""
SUMS = 1e-12
"""By this share a load may exceed its limit: two masses whose sum is the limit may round to more."""


def start_impossible(scene: Scene, prover: Prover) -> Refusal | None:
    """The first necessary condition of the start that does not hold, or None: loads, joints, frames, meshes around the
    arm, and a path that begins there. What is compared is the same as in the checker, up to rounding.

    Whether it collides there with anything else is `start_collides`: the proof of any candidate shows that it does not.
    """
    found = chain(
        start.beyond_limits(scene, 0, RANGE_SLACK),
        start.unassembled(scene, 0, RANGE_SLACK),
        overshoots(scene),
        start.law_over(scene, 0, 0.0),
    )
    return (
        overloaded(scene)
        or _stated(found, Stage.START, 0)
        or start_collides(scene, prover, hollow=True)
        or _stated(points.no_path(scene), Stage.STRAIGHT, 0)
    )


def _stated(found: Iterator[Proof], stage: Stage, step: int) -> Refusal | None:
    """The refusal that states the first of what was found."""
    return next((each.refusal(stage, step) for each in found), None)


def overloaded(scene: Scene) -> Refusal | None:
    """The first load of the task that the robot may not carry: too heavy, or of too much inertia about the wrist."""
    limits, tool = scene.load_limits, scene.loads[0]
    most, own = limits.most_kg, tool.inertia_kgm2 or 0.0
    by_table = limits.shares and most is not None and (limits.max_kg is None or most < limits.max_kg)
    for load in scene.loads:
        stage, step = (Stage.START, 0) if load.step < 0 else (Stage.CONTROL_POINT, load.step)
        heavy = start.too_much(load.part, "table" if by_table else "max_load", load.mass_kg, most, tool.mass_kg, SUMS)
        inertia = load.inertia_kgm2 or 0.0
        wide = start.too_much(load.part, "max_inertia", inertia, limits.max_inertia_kgm2, own, SUMS)
        found = _stated(chain(heavy, wide), stage, step)
        if found is not None:
            return found
    return None


def start_collides(scene: Scene, prover: Prover, *, hollow: bool = False) -> Refusal | None:
    """The arm where it is at the start, against everything, at the clearance that travel requires; `hollow`: only
    whether it is inside a mesh."""
    hit = hit_at_start(scene, prover, hollow=hollow)
    return None if hit is None else refusal_of(scene, prover, hit)


def points_impossible(scene: Scene, prover: Prover, *, start_is_free: bool = False) -> Refusal | None:
    """A start that collides, or a control point that can never be met: it is out of range, or what hangs on the flange
    would be too near what never moves against it, there or where a straight part ends; and the checker is shown it.
    `start_is_free`: the start is known not to collide.

    Called only when the first candidates have failed: where they have not, the arm can leave and the points can be met.
    """
    never = (each for number in range(len(scene.task)) for each in _never(scene, prover, number))
    colliding = None if start_is_free else start_collides(scene, prover)
    for refusal in chain([] if colliding is None else [colliding], never):
        if shown(scene, prover, refusal):
            return refusal
    return None


def _never(scene: Scene, prover: Prover, number: int) -> Iterator[Refusal]:
    """Why the control point of a step can perhaps be met at no time: what the checker is to be shown."""
    step = scene.task[number]
    if pitch_free(scene, step):
        # which pitches that reach it are free of bodies is a matter of search
        yield from (each.refusal(Stage.CONTROL_POINT, number) for each in points.every_pitch(scene, number))
        return
    beyond = out_of_range(scene, number)
    if beyond is not None:
        yield beyond
    if scene.options.vias_missed and step.via:
        return  # its pose is missed: that it collides there proves nothing
    found = hits(scene, prover, number)
    if found:
        yield refusal_of(scene, prover, found[0])


def yaw_impossible(scene: Scene) -> Refusal | None:
    """The start, or the first step, at which the tool cannot but be in a forbidden range of yaw; None: there is none.

    Not evaluated: points whose yaw is free or kept, or on a frame that turns, and places of parts that were picked in
    any yaw. The search decides about them.
    """
    if not scene.forbidden_yaw:
        return None
    found = _stated(start.turned_into_range(scene), Stage.START, 0)
    for number in range(len(scene.task)):
        raise_if_late()
        found = found or _stated(points.yaws_forbidden(scene, number), Stage.CONTROL_POINT, number)
    return found


def arches_impossible(scene: Scene) -> Refusal | None:
    """The first step whose arch is above the range of the lift."""
    tops = (too_high(scene, number, scene.start.q, HEIGHT_M) for number in range(len(scene.task)))
    return next((refusal for refusal in tops if refusal is not None), None)


def windows_impossible(scene: Scene) -> Refusal | None:
    """A step whose window, or what is known of whose frame's motion, is too short for it whenever the arm comes.

    Where along its frame a point is does not depend on how the tool is turned: one way to hold the parts is evaluated.
    """
    attached = at_start(scene)
    for number, step in enumerate(scene.task):
        tilt = tilts(scene, step, scene.start.q)[0]
        never = never_in_window(scene, control_point(scene, number, attached, 0.0, tilt))
        if never is not None:
            return never
        attached = attached.after(scene, step)
    return None


# Where the arm is, and what sits where, when two bodies meet at a control point: for who shows a refusal.


def met_posture(
    scene: Scene, number: int, mode: str, turn: float | None, place: str
) -> tuple[FloatArray, Attachments] | None:
    """Joints (n,) and attachments at a `place` of the control point of step `number`, in a working mode and with the
    part turned by `turn`, rad (None: any), as a witness names them; None: there is no such place."""
    if not 0 <= number < len(scene.task) or mode not in scene.robot.modes:
        return None
    for way in (each for each in ways(scene, number) if is_turn(each.turn, turn)):
        for spot in (each for each in spots(scene, number, way.before, way.after) if each.place == place):
            q = posture(scene, way, mode, spot)
            if q is not None:
                return q, spot.attached
    return None
