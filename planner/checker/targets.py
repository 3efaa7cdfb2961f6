"""Where the tool point must be for each step: derived from the request and the turns that the arrivals claim."""

from __future__ import annotations

import math
from dataclasses import dataclass

from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Move, Pick, Place, Scene, Step
from assur.planner.model.scene import Target as Asked

TURN = 1e-9
"""A turn that a symmetry allows is recognised up to this, rad."""
Tilt = tuple[float, float]
"""Pitch and roll, rad."""


@dataclass(frozen=True, slots=True)
class Target:
    """`tool`: pose of the tool point in `frame` when the control point of `step` is met; `point`: of the part, or of
    the target as it was given, whose way along a conveyor is what a window measures."""

    number: int
    step: Step
    frame: str
    tool: Pose
    point: Pose
    turns: bool
    """Whether the tool's yaw is asked for."""
    tilt: Tilt | None = None
    """Pitch and roll of the tool: as asked or, where that is free, as its arrival says; NaN where it says nothing. None
    for an arm without."""


def targets(scene: Scene, arrivals: tuple[Arrival, ...]) -> tuple[Target, ...]:
    """One target a step. A part is taken turned by its arrival's offset and put down in the pose that is asked."""
    claims = {arrival.step: arrival for arrival in arrivals}
    lies = {body.name: (body.frame, body.pose) for body in scene.bodies}
    has_yaw, has_tilt = ("yaw" in scene.robot.coordinates, "pitch" in scene.robot.coordinates)
    holding = scene.start.holding
    taken = Pose() if holding is None else holding.grasp
    found = []
    for number, step in enumerate(scene.task):
        claim = claims.get(number)
        turn = Pose(yaw=0.0 if claim is None else claim.yaw_offset)
        if isinstance(step, Pick):
            frame, point = lies[step.part]
            taken = turn.then(step.grasp)
            found.append(Target(number, step, frame, point.then(taken), point, True))
        elif isinstance(step, Place):
            frame, point = step.to.frame, step.to.pose
            lies[step.part] = (frame, point)
            found.append(Target(number, step, frame, point.then(taken), point, True))
        else:
            point = step.target.pose
            tool = Pose(point.x, point.y, point.z, point.yaw + turn.yaw)
            tilt = _tilt(step.target, claim) if has_tilt else None
            found.append(Target(number, step, step.target.frame, tool, point, has_yaw, tilt))
    return tuple(found)


def _tilt(asked: Asked, claim: Arrival | None) -> Tilt:
    """What is asked, or else what is claimed."""
    free = (None, None) if claim is None else (claim.pitch, claim.roll)
    pitch, roll = (
        one if one is not None else other for one, other in zip((asked.pitch, asked.roll), free, strict=True)
    )
    return math.nan if pitch is None else pitch, math.nan if roll is None else roll


def may_turn(scene: Scene, step: Step, offset: float) -> bool:
    """Whether a step leaves the tool the choice to be turned by `offset`."""
    choices = yaw_offsets(scene, step)
    return choices is None or any(abs(math.remainder(offset - choice, 2 * math.pi)) <= TURN for choice in choices)


def asks_velocity(step: Step) -> bool:
    """Whether the tool must have the velocity of its control point when it meets it."""
    if isinstance(step, Move):
        return step.match == "velocity" and not step.via
    return not isinstance(step, Pick | Place) or step.match == "velocity"


def asks_rest(step: Step) -> bool:
    """Whether the arm must stand still when it meets its control point."""
    if isinstance(step, Move):
        return step.match == "position" and not step.via
    return isinstance(step, Pick | Place) and step.match == "position"


def asks_passing(step: Step) -> bool:
    """Whether the tool passes its control point without stopping."""
    return isinstance(step, Move) and step.via
