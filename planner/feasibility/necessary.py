"""Necessary conditions: what fails here fails for all times and all candidates."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from assur.planner.checker.refusals import points, start
from assur.planner.checker.refusals.overshoot import overshoots
from assur.planner.checker.refusals.stated import Shown as Stated
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import hit_at_start, hits, refusal_of
from assur.planner.feasibility.reach import out_of_range
from assur.planner.feasibility.witnesses import shown
from assur.planner.legs.arched import too_high
from assur.planner.legs.control_point import control_point
from assur.planner.legs.missed import never_in_window
from assur.planner.legs.tilt import pitch_free, tilts
from assur.planner.model.attachments import at_start
from assur.planner.model.deadline import look
from assur.planner.model.refusal import Refusal, Stage
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import RANGE_SLACK

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


def _stated(found: Iterator[Stated], stage: Stage, step: int) -> Refusal | None:
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


def points_impossible(scene: Scene, prover: Prover) -> Refusal | None:
    """A start that collides, or a control point that can never be met: it is out of range, or what hangs on the flange
    would be too near what never moves against it, there or where a straight part ends; and the checker is shown it.

    Called only when the first candidates have failed: where they have not, the arm can leave and the points can be met.
    """
    never = (each for number in range(len(scene.task)) for each in _never(scene, prover, number))
    colliding = start_collides(scene, prover)
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
        look()
        found = found or _stated(points.yaws_forbidden(scene, number), Stage.CONTROL_POINT, number)
    return found


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
        tilt = tilts(scene, step, scene.start.q)[0]
        never = never_in_window(scene, control_point(scene, number, attached, 0.0, tilt))
        if never is not None:
            return never
        attached = attached.after(scene, step)
    return None
