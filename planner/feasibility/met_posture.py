"""Where the arm is, and what sits where, when two bodies meet at a control point: for who shows a refusal."""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.places import spots
from assur.planner.checker.refusals.ways import is_turn, ways
from assur.planner.feasibility.hits import posture
from assur.planner.model.attachments import Attachments
from assur.planner.model.scene import Scene


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
