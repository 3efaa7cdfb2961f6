"""Necessary conditions: what fails here fails for all times and all candidates."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals import points, start
from assur.planner.checker.refusals.obstructions import obstructions
from assur.planner.checker.refusals.postures import allowed_mode_names
from assur.planner.checker.refusals.stated import Proof, spots
from assur.planner.checker.refusals.ways import GraspOption, is_turn, ways
from assur.planner.checker.refusals.windows import overshoots
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import (
    REACHED,
    WayOfMeeting,
    hit_at_start,
    hits,
    postures_above,
    refusal_of,
    ways_of_meeting,
)
from assur.planner.feasibility.witnesses import refusal_proof
from assur.planner.kernels.dyads import OUT_OF_REACH
from assur.planner.legs.control_point import control_point, span_of
from assur.planner.legs.missed import never_in_window
from assur.planner.legs.tilt import pitch_free, tilts
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.refusal import OutOfReach, Reason, Refusal, Stage, out_of_reach
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import RANGE_SLACK
from assur.planner.robots.turns import beyond_range

# Points where the arm can never be: those that stand still out of reach, or beyond a joint limit, in every allowed
# mode; and those on a frame that repeats its motion which stay out of reach for a whole period.

EDGE_M = 1e-9
"""A point is called out of reach at every pitch, or at all times, from this much on, m: rounding of coordinates of a
few metres, and of times."""
PARTS = 512
"""Parts of a period; the way of a point is bounded over each."""


def out_of_range(scene: Scene, every: list[WayOfMeeting]) -> Refusal | None:
    """Why no joint position meets a control point, or what is required above it, on any of the ways to it, however the
    part is held; None: one does, or nobody knows, for it moves. The kernels decide; the words are the checker's."""
    way = every[0].way
    if not scene.frames[way.frame].law.is_fixed:
        return _never_near(scene, way)  # as all points of the step, which are on one frame
    slack, worst = scene.robot.limits.slack, list[Refusal]()
    for each in chain.from_iterable(each.modes for each in every):
        beyond = (beyond_range(scene.robot, each.q) > slack).any(-1) & np.isfinite(each.q).all(-1)
        if not (beyond | (each.code == OUT_OF_REACH)).any():
            return None
    for mode in allowed_mode_names(scene):
        proofs = (proof for _, stated in obstructions(scene, way, mode) for proof in stated if proof.reason in RANGES)
        refusals = [_of_point(scene, proof).refusal(Stage.CONTROL_POINT, way.number) for proof in proofs]
        if not refusals:
            return None
        # the worst of them: with less, the others would still not be met
        worst.append(max(refusals, key=lambda refusal: refusal.missing))
    return min(worst, key=lambda refusal: refusal.missing)


RANGES = frozenset({Reason.OUT_OF_REACH, Reason.JOINT_LIMIT})
"""What the kernels decide of a point that stands still."""


def _of_point(scene: Scene, proof: Proof) -> Proof:
    """An obstruction in words that are true of all modes: a point out of reach at its height, or else in the plane."""
    facts = proof.facts
    if not isinstance(facts, OutOfReach) or facts.heights_m is None:
        return proof
    if "z" not in scene.robot.coordinates and abs(facts.heights_m[0] - facts.heights_m[1]) > EDGE_M:
        return proof._replace(facts=replace(facts, mode=None, from_axis_m=None, pitch_rad=None))
    return proof._replace(facts=replace(facts, mode=None, heights_m=None))


def _never_near(scene: Scene, way: GraspOption) -> Refusal | None:
    """Why an arm with a lift reaches a point on a frame that repeats its motion at no time. In the middle of each part
    of a period the flange is so far out of reach, and in half a part it comes no nearer than its greatest speed across
    takes it (equation F11)."""
    law, robot = scene.frames[way.frame].law, scene.robot
    period = law.cycle_s
    if period is None or robot.lift is None:
        return None
    edges = scene.start.time + period * np.arange(PARTS + 1) / PARTS
    middle = law.motion((edges[:-1] + edges[1:]) / 2).at(way.flange)
    short = -np.max([robot.reach_margin(middle, mode) for mode in range(len(robot.modes))], axis=0)
    for i in range(PARTS):
        x, y, _ = law.sweep(edges[i], edges[i + 1]).point(1, way.flange.x, way.flange.y, 0.0)
        short[i] -= math.hypot(x, y) * (edges[i + 1] - edges[i]) / 2
    least = float(short.min())
    if not least > EDGE_M:  # nor where the law is not known for a whole period
        return None
    return out_of_reach(Stage.CONTROL_POINT, way.number, short_m=least, facts=OutOfReach())


SUMS = 1e-12
"""By this share a load may exceed its limit: two masses whose sum is the limit may round to more."""


def start_impossible(scene: Scene, prover: Prover) -> Refusal | None:
    """The first necessary condition of the start that does not hold, or None: loads, joints, frames, meshes around the
    arm, and a path that begins there. What is compared is the same as in the checker, up to rounding.

    Whether it collides there with anything else is `start_collides`: the proof of any candidate shows that it does not.
    """
    found = overloaded(scene)
    if found is None and not _starts_well(scene):
        stated = chain(
            start.beyond_limits(scene, 0, RANGE_SLACK),
            start.unassembled(scene, 0, RANGE_SLACK),
            overshoots(scene),
            start.law_over(scene, 0, 0.0),
        )
        found = _stated(stated, Stage.START, 0)
    found = found or start_collides(scene, prover, hollow=True)
    if found is None and scene.task[0].leg == "cartesian":
        return _stated(points.no_path(scene), Stage.STRAIGHT, 0)
    return found


def _starts_well(scene: Scene) -> bool:
    """Whether an arm without a loop rests within its ranges, and the motion of all bodies is known, at the start: then
    nothing of it needs a proof."""
    begin, limits = scene.start, scene.robot.limits
    if scene.robot.parallel_least > 0.0 or begin.moving:
        return False
    for body in scene.bodies:
        first, last = scene.frames[body.frame].law.valid
        if not first <= begin.time <= last:
            return False
    return bool(((limits.lower <= begin.q) & (begin.q <= limits.upper)).all())


def _stated(found: Iterator[Proof], stage: Stage, step: int) -> Refusal | None:
    """The refusal that states the first of what was found."""
    return next((each.refusal(stage, step) for each in found), None)


def overloaded(scene: Scene) -> Refusal | None:
    """The first load of the task that the robot may not carry: too heavy, or of too much inertia about the wrist."""
    limits = scene.load_limits
    if limits.nothing_known:
        return None
    tool = scene.loads[0]
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
    colliding = None if start_is_free else start_collides(scene, prover)
    if colliding is not None and refusal_proof(scene, prover, colliding):
        return colliding
    for number in range(len(scene.task)):
        for refusal in _never(scene, prover, number):
            if refusal_proof(scene, prover, refusal):
                return refusal
    return None


def _never(scene: Scene, prover: Prover, number: int) -> Iterator[Refusal]:
    """Why the control point of a step can perhaps be met at no time: what the checker is to be shown."""
    step = scene.task[number]
    if pitch_free(scene, step):
        # which pitches that reach it are free of bodies is a matter of search
        yield from (each.refusal(Stage.CONTROL_POINT, number) for each in points.every_pitch(scene, number))
        return
    every = ways_of_meeting(scene, number)
    beyond = out_of_range(scene, every)
    if beyond is not None:
        yield beyond
    if scene.options.vias_missed and step.via:
        return  # its pose is missed: that it collides there proves nothing
    found = hits(scene, prover, every)
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
    for number, step in enumerate(scene.task):
        refusal = None if step.arch is None else _stated(points.arch(scene, number), Stage.INVERSE, number)
        if refusal is not None:
            return refusal
    return None


def windows_impossible(scene: Scene) -> Refusal | None:
    """A step whose window, or what is known of whose frame's motion, is too short for it whenever the arm comes.

    Where along its frame a point is does not depend on how the tool is turned: one way to hold the parts is evaluated.
    """
    attached = at_start(scene)
    for number, step in enumerate(scene.task):
        low, high = span_of(scene, attached.frame(scene, step), step.window)
        if step.window.along is not None or not high - step.dwell_s >= low:
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
    if not 0 <= number < len(scene.task) or mode not in allowed_mode_names(scene):
        return None
    for way in (each for each in ways(scene, number) if is_turn(each.turn, turn)):
        for spot in (each for each in spots(scene, number, way.before, way.after) if each.place == place):
            inverse = postures_above(scene, way, spot.above)[allowed_mode_names(scene).index(mode)]
            if int(inverse.code[0]) in REACHED:
                return inverse.q[0], spot.attached
    return None
