"""At which instants a plan may be left for another one, and until when the arm may stand at its end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from assur.scenes.faults import DocumentError

if TYPE_CHECKING:
    from assur.planner.model.attachments import Attachments
    from assur.planner.model.outcome import Arrival, Leg
    from assur.planner.model.phases import GraspUncertainty, LegPhases
    from assur.planner.model.scene import Scene
    from assur.planner.trajectory import Trajectory

AT = "at_s"
"""The argument that names an instant."""


def stands_until(scene: Scene, attached: Attachments, end_s: float) -> float:
    """Until when, s, standing at the end of a plan is proved: for `stay_safe_s`; infinite where nothing moves, for the
    distances at the end are then those of all later times. `attached`: where the parts are at the end."""
    if scene.options.end != "rest":
        return end_s
    frames = [scene.frames[attached.pose_of(scene, body.name)[0]] for body in scene.bodies]
    if all(frame.law.is_fixed and frame.uncertainty.speed_m_s == 0.0 for frame in frames):
        return math.inf
    return end_s + scene.options.stay_safe_s


def left_at(
    scene: Scene,
    trajectory: Trajectory,
    legs: Sequence[Leg],
    arrivals: Sequence[Arrival],
    of_legs: LegPhases,
    at_s: float,
) -> tuple[Attachments, GraspUncertainty]:
    """What the gripper holds, where parts are and how well they are known at an instant at which the plan may be left:
    on the way between control points, waiting, or standing at the end. `of_legs`: the phases of its legs.

    Raises `DocumentError` for any other: before the start, while the tool tracks a control point, before a robot that
    is late has put down its part, where the acceleration jumps on the way, where standing is not proved, and where a
    belt correction may shift the arm by what is not known in advance.
    """
    from assur.planner.model.outcome import TRACKING
    from assur.planner.model.phases import on_way

    if not trajectory.start <= at_s < math.inf:
        raise DocumentError(AT, at_s, f"a time of the plan, {trajectory.start:.6g} s or later")
    begun, over = max(1, sum(leg.t0 <= at_s for leg in legs)), at_s >= trajectory.end
    last = legs[begun - 1]
    if not over and last.kind in TRACKING:
        tracks = [leg for leg in legs if leg.step == last.step and leg.kind in TRACKING]
        around = f"before {tracks[0].t0:.6g} s, or {tracks[-1].t1:.6g} s or later"
        raise DocumentError(AT, at_s, f"{around}: in between the tool tracks {scene.task[last.step].name}")
    if not over and trajectory.jumps:
        raise DocumentError(AT, at_s, f"{trajectory.end:.6g} s or later: on the way the acceleration may jump")
    for arrival in arrivals:
        free_s = arrival.until + scene.execution.start_tolerance_s
        if scene.task[arrival.step].part is not None and arrival.until <= at_s < free_s:
            raise DocumentError(AT, at_s, f"{free_s:.6g} s or later: until then a robot that is late handles a part")
    phases, attached, known = of_legs
    now = phases[begun - 1]
    if on_way(scene, len(scene.task)) if over else now.corrected:
        raise DocumentError(AT, at_s, "none, with belt_correction: nobody knows by how much the arm is shifted then")
    until_s = stands_until(scene, attached, trajectory.end)
    if over and at_s > until_s:
        raise DocumentError(AT, at_s, f"up to {until_s:.6g} s, until when standing is proved (stay_safe_s)")
    return (attached, known) if over else (now.attached, now.handled)
