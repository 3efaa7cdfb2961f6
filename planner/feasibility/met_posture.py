"""Where the arm is, and what sits where, when two bodies meet at a control point: for who shows a refusal."""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.places import spots
from assur.planner.checker.refusals.ways import is_turn, ways
from assur.planner.feasibility.spots import posture
from assur.planner.legs.control_point import control_point
from assur.planner.legs.tilt import tilts
from assur.planner.model.attachments import Attachments
from assur.planner.model.scene import Scene


def met_posture(
    scene: Scene, number: int, mode: str, turn: float | None, place: str
) -> tuple[FloatArray, Attachments] | None:
    """Joints (n,) and attachments at a `place` of the control point of step `number`, in a working mode and with the
    part turned by `turn`, rad (None: any), as a witness names them; None: there is no such place."""
    if not 0 <= number < len(scene.task) or mode not in scene.robot.modes:
        return None
    tilt = tilts(scene, scene.task[number], scene.start.q)[0]
    for way in ways(scene, number):
        if not is_turn(way.turn, turn):
            continue
        point = control_point(scene, number, way.before, way.turn or 0.0, tilt)
        for spot in spots(scene, number, way.before, way.after):
            q = posture(scene, point, spot, scene.robot.modes.index(mode)) if spot.place == place else None
            if q is not None:
                return q, spot.attached
    return None
