"""Whether tool or support are too far from the part of a step, however the part is turned and whenever it is taken."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

from assur.planner.checker.refusals.meetings import about_vertical
from assur.planner.checker.refusals.nearest import distance
from assur.planner.checker.refusals.standing import still
from assur.planner.checker.refusals.stated import Shown
from assur.planner.checker.refusals.ways import Way, ways
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Piece
from assur.planner.model.proofs.witness import PROVED_M
from assur.planner.model.refusal import Bodies, NotTouching, Quantity, Reason, Refusal
from assur.planner.model.scene import Pick, Place, Scene

WITHIN_M = 5e-5
"""By how much a distance that is stated may be off, m."""


def never_touching(scene: Scene, refusal: Refusal) -> Iterator[Shown]:
    """The part of a step is too far from the tool that takes it, or from what it is put down on: by the distance in the
    turn in which it is least."""
    step = scene.task[refusal.step]
    if not isinstance(step, Pick | Place):
        return
    allowed = step.grip_within_m if isinstance(step, Pick) else step.support_within_m
    found = dict[str, float]()
    for way in ways(scene, refusal.step):
        others = _others(scene, step, way)
        if way.turn is None or not others:
            return  # where the part is then is not known for all turns and times
        part = scene.index[step.part].body.pieces
        for other, pose in others:
            low, high = distance(part, _placed(other, pose))
            if not low > allowed + PROVED_M:
                return
            found[other.name] = min(found.get(other.name, math.inf), high)
    least, given = min(found.values(), default=math.inf), refusal.facts
    if isinstance(given, NotTouching) and abs(given.distance_m - least) <= WITHIN_M:
        least = given.distance_m
    of: Literal["grip", "support"] = "grip" if isinstance(step, Pick) else "support"
    facts = NotTouching(of=of, distance_m=least, allowed_m=allowed)
    for name in (name for name, high in found.items() if high <= least + WITHIN_M):
        for bodies in ((name, step.part), (step.part, name)):
            yield Shown(Reason.TOLERANCE, facts, Quantity(least - allowed, "m"), Bodies(bodies))


def _others(scene: Scene, step: Pick | Place, way: Way) -> list[tuple[Body, Pose]]:
    """What counts, with its pose in the part's frame: of a pick the tool's bodies; of a place what the part is put down
    on, where it never moves against the part."""
    held = way.after.held
    if isinstance(step, Pick):
        return [(body, held.in_flange.inverse()) for body in scene.tool.bodies] if held is not None else []
    found = []
    frame, pose = way.after.pose_of(scene, step.part)
    for name in step.contact_with or ():
        own, there = way.after.pose_of(scene, name)
        first, second = (Pose(), Pose()) if own == frame else (still(scene, frame), still(scene, own))
        if first is None or second is None:
            return []
        found.append((scene.index[name].body, first.then(pose).inverse().then(second.then(there))))
    return found


def _placed(body: Body, pose: Pose) -> list[Piece]:
    """The pieces of a body at a pose."""
    turn = about_vertical(pose.yaw)
    return [Piece(each.shape, pose.position + turn @ each.position, turn @ each.rotation) for each in body.pieces]
