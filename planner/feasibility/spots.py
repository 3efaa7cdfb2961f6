"""Where the flange is on every way through a control point, and what is in its way there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.places import Spot
from assur.planner.collision.at_rest import TooNear, Within, closest, enclosed
from assur.planner.collision.proof import Prover
from assur.planner.legs.control_point import ControlPoint
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Code


@dataclass(frozen=True, slots=True)
class Hit:
    """What is in the way at a spot, in a phase, with the joints q (n,)."""

    found: TooNear | Within
    phase: Phase
    q: FloatArray


def posture(scene: Scene, point: ControlPoint, spot: Spot, mode: int) -> FloatArray | None:
    """Joints (n,) at a spot in one working mode, the frame of the point being where it is at the start; None: the arm
    does not reach it."""
    flange = point.flange(np.array([scene.start.time]), spot.above).at_rest()
    solution = scene.robot.inverse(flange, mode, 0)
    return solution.q[0] if solution.code[0] in (Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED) else None


def in_the_way(scene: Scene, prover: Prover, point: ControlPoint, spot: Spot, mode: int) -> Hit | None:
    """What is in the way of the flange's bodies at one spot and in one working mode; None: nothing, or it is not known,
    as the spot may be reached at another time."""
    t, attached, q = scene.start.time, spot.attached, posture(scene, point, spot, mode)
    if q is None:
        return None
    fixed = scene.frames[point.frame].law.is_fixed
    frames = {body.name: attached.pose_of(scene, body.name)[0] for body in scene.bodies}
    among = frozenset(
        name for name, frame in frames.items() if frame == point.frame or (fixed and scene.frames[frame].law.is_fixed)
    )
    tracked = None if spot.kind is LegKind.MOVE else point.frame
    phase = Phase(t, t, spot.kind, point.step, attached, tracked=tracked)
    within = enclosed(scene, prover, attached, q, t, spot.contacts, among) if fixed else None
    if within is not None:
        return Hit(within, phase, q)
    near = closest(scene, prover, phase, q, spot.contacts, among)
    return None if near is None else Hit(near, phase, q)
