"""In which ways the control point of a step can be met: how the part sits in the gripper, and where the flange is then.

All of it follows from the request, as the phases of a plan do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from assur.planner.checker.refusals.postures import Goal
from assur.planner.checker.refusals.spans import ANY, around
from assur.planner.checker.refusals.standing import still
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import Spot
from assur.planner.model.scene import Pick, Place, Scene, Step, Trace

TURN_RAD = 1e-9
"""Turns of a part that differ by no more are one, rad."""


@dataclass(frozen=True, slots=True)
class Way:
    """One way to meet the control point of step `number`.

    `turn`: of the part in the gripper, rad; None: any, and then the flange is `spread`, m, off `point`, in any
    direction and with any yaw. `point`: of the part or the target, in `frame`; `flange`: of the flange there, turned by
    `turn`. `before`, `after`: what is attached before and after the step. `known`: pitch and roll that are asked, NaN
    for one that is free.
    """

    number: int
    turn: float | None
    frame: str
    point: Pose
    flange: Pose
    spread: float
    before: Attachments
    after: Attachments
    tilt: tuple[float, float] = (math.nan, math.nan)
    lead_in_m: float | None = None
    """How far before its path a trace is met, m; None: it is no trace."""

    @property
    def on_path(self) -> Spot:
        """Where on its path the point is."""
        if self.lead_in_m is None:
            return {}
        return {
            "path_m": -self.lead_in_m,
            "path_part": "lead-in",
            "path_at_m": (self.point.x, self.point.y, self.point.z),
        }

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
            around(pitch, by_rad) if math.isfinite(pitch) else ANY,
            around(roll, by_rad) if math.isfinite(roll) else ANY,
        )

    def still(self, scene: Scene) -> Pose | None:
        """The pose of the frame, where it never moves."""
        return still(scene, self.frame)


def ways(scene: Scene, number: int) -> tuple[Way, ...]:
    """All ways to meet the control point of a step, one for each turn of the part that its symmetry leaves."""
    holding, step = scene.start.holding, scene.task[number]
    state, picked = at_start(scene), None
    axis, turns = Pose() if holding is None else holding.grasp, _only(0.0)
    for earlier in scene.task[:number]:
        if isinstance(earlier, Pick):
            picked, axis, turns = earlier, earlier.grasp, _turns(scene, earlier)
        elif isinstance(earlier, Place):
            held = state if picked is None else state.after(scene, picked)
            state, picked, turns = held.after(scene, earlier), None, _only(0.0)
    if isinstance(step, Pick):
        axis, turns = step.grasp, _turns(scene, step)
    elif not isinstance(step, Place):
        axis = Pose()
    axis = axis.then(scene.tool.tcp.inverse())
    free = not isinstance(step, Pick | Place) and yaw_offsets(scene, step) is None
    found, lead_in = [], step.lead_in_m if isinstance(step, Trace) else None
    for turn in turns:
        before = state if picked is None else state.after(scene, picked, turn or 0.0)
        frame, point = before.point(scene, step)
        if isinstance(step, Trace):
            x, y, z = step.path.curve.at(np.array([-step.lead_in_m]))[0][0].tolist()
            point = replace(point, x=x, y=y, z=z)
        hands = isinstance(step, Pick | Place)
        flange = point.then(Pose(yaw=turn or 0.0 if hands else 0.0)).then(axis)
        after = before.after(scene, step, turn or 0.0) if hands else before
        any_turn = free or turn is None
        spread, own = math.hypot(axis.x, axis.y) if any_turn else 0.0, None if any_turn else turn
        found.append(Way(number, own, frame, point, flange, spread, before, after, _tilt(step), lead_in))
    return tuple(found)


def is_turn(one: float | None, other: float | None) -> bool:
    """Whether two turns of a part are the same; any turn is the same as any."""
    return one is other if one is None or other is None else abs(one - other) <= TURN_RAD


def _only(turn: float | None) -> tuple[float | None, ...]:
    return (turn,)


def _turns(scene: Scene, step: Pick) -> tuple[float | None, ...]:
    """Turns in which a pick may take its part; None: any."""
    offsets = yaw_offsets(scene, step)
    return (None,) if offsets is None else offsets


def _tilt(step: Step) -> tuple[float, float]:
    target = step.target
    if target is None:
        return math.nan, math.nan
    pitch, roll = target.pitch, target.roll
    return math.nan if pitch is None else pitch, math.nan if roll is None else roll
