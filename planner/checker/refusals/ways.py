"""In which ways the control point of a step can be met: how the part sits in the gripper, and where the flange is then.

All of it follows from the request, as the phases of a plan do.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from assur.planner.checker.refusals.postures import Goal, allowed_mode_names, still
from assur.planner.checker.refusals.spans import ANY, around
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import Spot
from assur.planner.model.scene import Pick, Place, Scene, Step, Trace
from assur.planner.model.witness import Meeting, Obstruction

TURN_RAD = 1e-9
"""Turns of a part that differ by no more are one, rad."""
Turns = tuple[float | None, ...]
Stated = TypeVar("Stated", Obstruction, Meeting)
NOT_TURNED: Turns = (0.0,)
ANY_TURN: Turns = (None,)


@dataclass(frozen=True, slots=True)
class GraspOption:
    """One way to meet the control point of step `number`.

    `turn`: of the part in the gripper, rad; None: any, and then the flange is `spread`, m, off `point`, in any
    direction and with any yaw. `point`: of the part or the target, in `frame`; `flange`: of the flange there, turned by
    `turn`. `before`, `after`: what is attached before and after the step. `tilt`: pitch and roll, None for
    one that is free.
    """

    number: int
    turn: float | None
    frame: str
    point: Pose
    flange: Pose
    spread: float
    before: Attachments
    after: Attachments
    tilt: tuple[float | None, float | None]
    lead_in_m: float | None
    """How far before its path a trace is met, m; None: it is no trace."""

    @property
    def on_path(self) -> Spot:
        """Where on its path the point is."""
        if self.lead_in_m is None:
            return {}
        here = self.point.x, self.point.y, self.point.z
        return {"path_m": -self.lead_in_m, "path_part": "lead-in", "path_at_m": here}

    def goal(self, scene: Scene, at: Pose, above: float, by_m: float, by_rad: float) -> Goal:
        """Where the flange is in the world while the frame is at `at`, so far above the point, m, each known up to
        `by_m` and `by_rad`."""
        centre = at.then(self.flange if self.turn is not None else self.point)
        wide, pitch, roll = by_m + self.spread, *self.tilt
        has_yaw = self.turn is not None and scene.robot.turns_load
        return Goal(
            around(centre.x, wide),
            around(centre.y, wide),
            around(at.then(self.flange).z + above, by_m),
            around(centre.yaw, by_rad) if has_yaw else ANY,
            ANY if pitch is None else around(pitch, by_rad),
            ANY if roll is None else around(roll, by_rad),
        )

    def still(self, scene: Scene) -> Pose | None:
        """The pose of the frame, where it never moves."""
        return still(scene, self.frame)


def ways(scene: Scene, number: int) -> tuple[GraspOption, ...]:
    """All ways to meet the control point of a step, one for each turn of the part that its symmetry leaves."""
    step, state, picked, turns = scene.task[number], at_start(scene), None, NOT_TURNED
    hands, target = isinstance(step, Pick | Place), step.target
    for earlier in scene.task[:number]:
        if isinstance(earlier, Pick):
            picked, turns = earlier, yaw_offsets(scene, earlier) or ANY_TURN
        elif isinstance(earlier, Place):
            held = state if picked is None else state.after(scene, picked)
            state, picked, turns = held.after(scene, earlier), None, NOT_TURNED
            if earlier.gone_after_s is not None:
                state = state.without(scene, earlier.part)  # it may be gone by then
    if isinstance(step, Pick):
        turns = yaw_offsets(scene, step) or ANY_TURN
    free, found = not hands and yaw_offsets(scene, step) is None, []
    tilt = (None, None) if target is None else (target.pitch, target.roll)
    for turn in turns:
        before = state if picked is None else state.after(scene, picked, turn or 0.0)
        (frame, point), (_, flange) = before.point(scene, step), before.flange(scene, step, _own(step, turn))
        if isinstance(step, Trace):
            x, y, z = step.path.curve.at(np.array([-step.lead_in_m]))[0][0].tolist()
            point = replace(point, x=x, y=y, z=z)
            flange = point.then(scene.tool.tcp.inverse())
        any_turn = free or turn is None
        found.append(
            GraspOption(
                number=number,
                turn=None if any_turn else turn,
                frame=frame,
                point=point,
                flange=flange,
                spread=math.hypot(flange.x - point.x, flange.y - point.y) if any_turn else 0.0,
                before=before,
                after=before.after(scene, step, turn or 0.0),
                tilt=tilt,
                lead_in_m=step.lead_in_m if isinstance(step, Trace) else None,
            )
        )
    return tuple(found)


def _own(step: Step, turn: float | None) -> float:
    """By how much the tool is turned at a step by the turn of a part; a part that is held already turns with it."""
    return turn or 0.0 if isinstance(step, Pick) else 0.0


def each_way(scene: Scene, number: int, stated: Sequence[Stated]) -> Iterator[tuple[GraspOption, str, list[Stated]]]:
    """All ways to the control point of a step in all working modes that are allowed, with what a witness states of
    each."""
    for way in ways(scene, number):
        for mode in allowed_mode_names(scene):
            yield way, mode, [each for each in stated if each.mode == mode and is_turn(each.turn_rad, way.turn)]


def is_turn(one: float | None, other: float | None) -> bool:
    """Whether two turns of a part are the same; any turn is the same as any."""
    return one is other if one is None or other is None else abs(one - other) <= TURN_RAD
