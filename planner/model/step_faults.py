"""What a step of a task cannot be in its scene: where it names what is not there, or what the arm cannot do."""

from __future__ import annotations

import math
from collections.abc import Iterator, Set
from typing import TYPE_CHECKING

from assur.planner.model.task import Pick, Place, Step, Target, Trace

if TYPE_CHECKING:
    from assur.planner.model.scene import Scene

TAKEN = "a body that no earlier place has taken away (gone_after_s)"
"""What a step may name."""


def wrong(scene: Scene, step: Step, held: str | None, gone: Set[str]) -> Iterator[tuple[str, object, str]]:
    """What of a step cannot be where the gripper holds the part `held` (None: none) and other parts are taken away
    (`gone`): the field, its value, and what is allowed. One part at a time: a pick needs an empty gripper, a place
    the part that was picked."""
    robot, target = scene.robot, step.target
    if target is not None:
        yield from _wrong_target(scene, step, target)
    if step.arch is not None and robot.lift is None:
        yield (
            ".arch",
            step.arch.top_m,
            f"no arch: {robot.name} has no joint that lifts (cartesian legs go up and over)",
        )
    if not isinstance(step, Pick | Place):
        return
    if step.part not in scene.index:
        yield ".part", step.part, f"one of {sorted(scene.index)}"
    if step.part in gone:
        yield ".part", step.part, TAKEN
    for name in step.contact_with or ():
        if name not in scene.index:
            yield ".contact_with", name, f"one of {sorted(scene.index)}"
        if name in gone:
            yield ".contact_with", name, TAKEN
    frame = scene.index[step.part].frame if target is None else target.frame
    if step.match == "position" and not scene.frames[frame].law.is_fixed:
        yield (
            ".match",
            step.match,
            "velocity: a part is picked from, and placed on, a moving frame with its velocity",
        )
    if isinstance(step, Pick) and math.isfinite(step.grip_within_m) and not scene.tool.bodies:
        yield ".grip_within_m", step.grip_within_m, "none: the tool has no bodies from which it could be measured"
    if isinstance(step, Pick) and held is not None:
        yield "", step.part, f"an empty gripper; it still holds {held}"
    if isinstance(step, Place) and held != step.part:
        yield ".part", step.part, f"the part in the gripper ({held or 'none'})"
    if "pitch" in robot.coordinates:
        yield (
            "",
            step.name,
            f"move and follow: {robot.name} turns and tilts its tool as it goes, and a part with it",
        )
    elif "yaw" not in robot.coordinates:
        # an arm that cannot turn its tool at will cannot lay down a part as it should lie
        yield "", step.name, f"move and follow: {robot.name} has no wrist, so parts would turn as the arm goes"


def _wrong_target(scene: Scene, step: Step, target: Target) -> Iterator[tuple[str, object, str]]:
    """What of a step's target cannot be. A yaw that is kept has to be one in the frame, whenever it is met; pitch
    and roll are for arms that have them."""
    if target.frame not in scene.frames:
        yield ".frame", target.frame, f"one of {sorted(scene.frames)}"
    frame, robot = scene.frames[target.frame], scene.robot
    for name, value in (("pitch", target.pitch), ("roll", target.roll)):
        if value is not None and name not in robot.coordinates:
            yield f".{name}", value, f"no {name}: {robot.name} cannot tilt its tool at will"
        if value is not None and not math.isfinite(value):
            yield f".{name}", value, "a finite angle"
    if step.leg == "cartesian" and step.match == "position" and not frame.law.is_fixed:
        yield ".match", "position", "velocity: a straight leg meets a moving frame with its velocity"
    if target.yaw_keep and not isinstance(step, Place) and frame.law.yaw is None:
        allowed = f"false, with yaw_free: true or a yaw_deg: {frame.name} turns, so the yaw there depends"
        allowed += " on when it is met"
        yield f".{'start' if isinstance(step, Trace) else 'to'}.yaw_keep", True, allowed
