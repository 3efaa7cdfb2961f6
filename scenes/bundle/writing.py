"""A planned answer as a proof bundle."""

from __future__ import annotations

from typing import Any

from assur.planner.model.outcome import Plan
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory
from assur.scenes.bundle.arms import arm_of, link_number
from assur.scenes.bundle.claims import axes_of, limits_of, points_of, pulls_of
from assur.scenes.bundle.laws import law_of
from assur.scenes.bundle.phases import frame_of, phases_of, required_of
from assur.scenes.bundle.rows import rows_of
from assur.scenes.bundle.solids import bodies_in, body_of, seats_of

Document = dict[str, Any]
FORM = "assur-bundle/2"
BEYOND_S = 1e-3
"""Motions around the robot are stated for so long before and after they count, s: sums of times are rounded."""


def bundle_of(scene: Scene, plan: Plan) -> Document:
    """The bundle of a plan for a scene. Raises `InputError` for what a bundle cannot state."""
    of_plan = phases(scene, plan.legs, plan.arrivals)
    until, start = of_plan[-1].t1, plan.trajectory.start
    shifts = [frame.uncertainty.shift_s for frame in scene.frames.values()]
    begin = start - max((high for _, high in shifts), default=0.0) - BEYOND_S
    end = until + scene.execution.start_tolerance_s - min((low for low, _ in shifts), default=0.0) + BEYOND_S
    arms = [arm_of(scene.robot, plan.trajectory, start, max(phase.t1 for phase in of_plan if phase.robot))]
    followed: list[tuple[Robot, Trajectory]] = []
    frames = []
    for name, frame in scene.frames.items():
        law, on, link = frame.law, -1, -1
        if law.link is not None:
            robot, path = law.link.robot, law.link.trajectory
            same = [k for k, (a, b) in enumerate(followed) if a is robot and b is path]
            if not same:
                followed.append((robot, path))
                arms.append(arm_of(robot, path, begin, end))
            on, link = (same or [len(followed) - 1])[0] + 1, link_number(robot, law.link.link)
            moved = {"pose": [0.0] * 4, "rate": [0.0] * 4, "edges": [], "acceleration": [], "waves": []}
        else:
            moved = law_of(law, begin, end)
        frames.append({"name": name, "arm": on, "link": link, **moved, **frame_of(frame)})
    seats, seat = seats_of(scene, of_plan)
    return {
        "schema": FORM,
        "request_digest": scene.digest,
        "plan_digest": plan.certificate.digest,
        "arms": arms,
        "frames": frames,
        "bodies": [body_of(body) for body in bodies_in(scene)],
        "seats": seats,
        "phases": phases_of(scene, of_plan, seat),
        "required": required_of(scene, until),
        "limits": limits_of(scene, plan, of_plan),
        "points": points_of(scene, plan),
        "pulls": pulls_of(scene, plan, of_plan),
        "axes": axes_of(scene, plan),
        "rows": rows_of(scene, plan, of_plan, seats, seat),
    }
